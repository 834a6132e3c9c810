//! The inertia that an FMU's port shows to noise.
//!
//! Noise of the measured motion passes for a force, which the plant's inertia makes of it. What hangs on the port by a spring takes part in
//! slow motion and not in fast one, and most of the noise is at the highest frequencies that are compared, since acceleration grows with
//! the frequency's square. So the motion swings a little more at one of them, and how much more force that takes is the inertia.

use std::f64::consts::PI;

use super::pursuit::{PursuedPort, Pursuit};
use inference::body::motion::{Motion, root_mean_square};

/// Root mean square of the speed over which the speed swings more.
const SIZE: f64 = 0.01;

/// Lets the motion at a port swing more, at an angular frequency [rad/s].
pub fn add(port: &mut PursuedPort, frequency: f64, interval: f64) {
    let size = SIZE * root_mean_square(&port.measured_velocity);
    let motion = port
        .measured_position
        .iter_mut()
        .zip(&mut port.measured_velocity);
    for (at, (position, velocity)) in motion.enumerate() {
        let angle = frequency * at as f64 * interval;
        *position += size / frequency * angle.sin();
        *velocity += size * angle.cos();
    }
}

/// Inertia that a port shows to a swing at an angular frequency [kg or kg m²], over the moments that tell something of the forces: how
/// much more force it took over how much more acceleration.
#[must_use]
pub fn inertia(motion: &Motion, calm: &Pursuit, swung: &Pursuit, frequency: f64) -> f64 {
    let count = swung.force.len();
    let amplitude = |calm: &[f64], swung: &[f64]| -> f64 {
        let (mut cosine, mut sine) = (0.0, 0.0);
        let more = calm.iter().zip(swung).map(|(calm, swung)| swung - calm);
        for (at, more) in more.enumerate().filter(|(at, _)| motion.tells[*at]) {
            // The swing fades in and out, so that neither end of the record counts.
            let part = (PI * at as f64 / count as f64).sin();
            let angle = frequency * at as f64 * motion.interval;
            cosine += part * part * more * angle.cos();
            sine += part * part * more * angle.sin();
        }
        cosine.hypot(sine)
    };
    amplitude(&calm.force, &swung.force) / amplitude(&calm.acceleration, &swung.acceleration)
}
