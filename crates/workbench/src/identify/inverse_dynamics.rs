//! Friction torque from encoder records by inverse dynamics (Eq. 4-5 put right).

use stickslip::plant::Rig;

use super::local_polynomial::smooth;

/// What inverse dynamics recovers from a record of the reduced rig.
#[derive(Debug, Clone, PartialEq)]
pub struct RecoveredFriction {
    /// Velocity of disc D2 [rad/s].
    pub velocity: Vec<f64>,
    /// Acceleration of disc D2 [rad/s²].
    pub acceleration: Vec<f64>,
    /// Friction torque on disc D2 [N m].
    pub torque: Vec<f64>,
}

/// T_f = −J2 dω2/dt − c2 (ω2 − ω3) − k2 (θ2 − θ3), from the angles [rad] of disc and gearbox output sampled every `step`
/// [s], smoothed over `half_width` samples on either side. `None` where the records are too short or of unequal length.
#[must_use]
pub fn recover_friction(
    rig: &Rig<f64>,
    theta: &[f64],
    theta3: &[f64],
    step: f64,
    half_width: usize,
) -> Option<RecoveredFriction> {
    if theta.len() != theta3.len() {
        return None;
    }
    let disc = smooth(theta, step, half_width)?;
    let output = smooth(theta3, step, half_width)?;
    let torque = (0..theta.len())
        .map(|index| {
            -rig.disc.inertia * disc.second[index]
                - rig.shaft.damping * (disc.first[index] - output.first[index])
                - rig.shaft.stiffness * (disc.value[index] - output.value[index])
        })
        .collect();
    Some(RecoveredFriction {
        velocity: disc.first,
        acceleration: disc.second,
        torque,
    })
}
