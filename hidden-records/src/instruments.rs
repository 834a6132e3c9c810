//! The instruments of the rig: encoders that round down, noisy tachometers and load cell.

use crate::effects::Effects;
use crate::excitation::{Excitation, SAMPLE_INTERVAL};
use crate::random::Stream;
use crate::simulator::Sample;
use core::f64::consts::TAU;
use libm::sin;
use std::fmt::Write;

/// Angle of one step of the disc encoder [rad].
pub const DISC_ENCODER_STEP: f64 = TAU / 1000.0;
/// Angle of one step of the motor encoder, seen at the gearbox output [rad].
pub const MOTOR_ENCODER_STEP: f64 = TAU / 8000.0;

/// Noise of the instruments (one standard deviation).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Disc tachometer [rad/s].
    pub disc_speed: f64,
    /// Tachometer seen at the gearbox output [rad/s].
    pub gearbox_speed: f64,
    /// Load cell [N].
    pub normal_force: f64,
}

impl Noise {
    /// The rig's instruments with their noise times `factor`.
    pub fn scaled(factor: f64) -> Self {
        Self {
            disc_speed: 0.05 * factor,
            gearbox_speed: 0.05 / 8.0 * factor,
            normal_force: 0.2 * factor,
        }
    }
}

/// Rounds `angle` down to a whole encoder step, both [rad].
pub fn encoder(angle: f64, step: f64) -> f64 {
    (angle / step).floor() * step
}

/// The text of a record. The load cell gives the mean force plus its bias; without the pin
/// (zero force) it is switched off and reads zero.
pub fn record_csv(
    excitation: &Excitation,
    samples: &[Sample],
    hidden: &Effects,
    noise: Noise,
    stream: &mut Stream,
) -> String {
    let mut text = String::with_capacity(64 * samples.len());
    text.push_str("time,u,N2,theta,theta_dot,theta3,theta3_dot\n");
    for (index, sample) in samples.iter().enumerate() {
        let force = excitation.normal_force[index];
        let force_noise = noise.normal_force * stream.normal();
        let reading = if force == 0.0 {
            0.0
        } else {
            force + hidden.cell_bias + force_noise
        };
        let disc_speed =
            hidden.tacho_gain * sample.seen_disc_speed + noise.disc_speed * stream.normal();
        let gearbox_speed = sample.state.gearbox_speed + noise.gearbox_speed * stream.normal();
        let off = sample.seen_disc_angle - hidden.eccentricity_ph;
        let disc_angle =
            sample.seen_disc_angle + hidden.eccentricity * (sin(off) + sin(hidden.eccentricity_ph));
        // Writing into a String cannot fail.
        let _ = writeln!(
            text,
            "{:.2},{:.5},{:.3},{:.6},{:.4},{:.6},{:.5}",
            index as f64 * SAMPLE_INTERVAL,
            excitation.voltage[index],
            reading,
            encoder(disc_angle, DISC_ENCODER_STEP) + 0.0,
            disc_speed,
            encoder(sample.state.gearbox_angle, MOTOR_ENCODER_STEP) + 0.0,
            gearbox_speed,
        );
    }
    text
}
