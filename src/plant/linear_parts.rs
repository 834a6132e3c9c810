//! The rig's numbers as the recurrences want them: reciprocals and gear ratios multiplied out.

use super::Rig;
use crate::series::Scalar;

/// Coefficients of the linear part of the equations of motion, all on the shaft side.
#[derive(Clone, Copy, Debug)]
pub(super) struct LinearParts<S> {
    /// k2 [N m/rad].
    pub stiffness: S,
    /// c2 [N m s/rad].
    pub damping: S,
    /// J2 and its reciprocal [kg m²].
    pub inertia: S,
    pub inverse_inertia: S,
    /// η K_T [N m/A].
    pub current_to_torque: S,
    /// η² C_m [N m s/rad].
    pub motor_damping: S,
    /// η T_fm [N m].
    pub motor_coulomb: S,
    /// 1/(η² J_m).
    pub inverse_motor_inertia: S,
    /// R [Ω].
    pub resistance: S,
    /// η K_E [V s/rad].
    pub back_emf: S,
    /// 1/L.
    pub inverse_inductance: S,
    /// Rate at which a velocity that counts as zero decays while D2 sticks [1/s].
    pub decay: S,
    /// The same of disc D1 and its shaft; zero in the reduced rig.
    pub stiffness_1: S,
    pub damping_1: S,
    pub inertia_1: S,
    pub inverse_inertia_1: S,
    pub decay_1: S,
}

impl<S: Scalar> LinearParts<S> {
    /// The numbers of `rig`, without the effects that have series of their own.
    pub fn new(rig: &Rig<S>) -> Self {
        let one = S::constant(1.0);
        let ratio = rig.gearbox.ratio;
        let disc1 = rig.disc1.as_ref();
        Self {
            stiffness: rig.shaft.stiffness,
            damping: rig.shaft.damping,
            inertia: rig.disc.inertia,
            inverse_inertia: one / rig.disc.inertia,
            current_to_torque: ratio * rig.motor.torque_constant,
            motor_damping: ratio * ratio * rig.motor_viscous_damping(),
            motor_coulomb: ratio * rig.motor.coulomb_torque,
            inverse_motor_inertia: one / (ratio * ratio * rig.motor.inertia),
            resistance: rig.motor.resistance,
            back_emf: ratio * rig.motor.back_emf_constant,
            inverse_inductance: one / rig.motor.inductance,
            decay: rig.law.band().1,
            decay_1: disc1.map_or(S::ZERO, |disc1| disc1.law.band().1),
            stiffness_1: disc1.map_or(S::ZERO, |disc1| disc1.shaft.stiffness),
            damping_1: disc1.map_or(S::ZERO, |disc1| disc1.shaft.damping),
            inertia_1: disc1.map_or(S::ZERO, |disc1| disc1.disc.inertia),
            inverse_inertia_1: disc1.map_or(S::ZERO, |disc1| one / disc1.disc.inertia),
        }
    }
}
