//! Parameters of the reduced rig and what the analyst believes about them.

use crate::random::Stream;
use std::collections::BTreeMap;

/// Parameters of the reduced rig, SI, shaft side of the gearbox unless named motor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RigParameters {
    /// Inertia of disc D2, J2 [kg m²].
    pub disc_inertia: f64,
    /// Torsional stiffness k2 [N m/rad].
    pub shaft_stiffness: f64,
    /// Torsional damping c2 [N m s/rad].
    pub shaft_damping: f64,
    /// Gear ratio η [-].
    pub gear_ratio: f64,
    /// Inertia of the motor, motor side, J_m [kg m²].
    pub motor_inertia: f64,
    /// Armature resistance R [Ω].
    pub resistance: f64,
    /// Armature inductance L [H].
    pub inductance: f64,
    /// Torque constant K_T [N m/A].
    pub torque_constant: f64,
    /// Back-EMF constant K_E [V s/rad].
    pub back_emf_constant: f64,
    /// Coulomb torque in the motor, motor side, T_fm [N m].
    pub motor_coulomb_torque: f64,
    /// Viscous damping of the motor, motor side, C_m [N m s/rad].
    pub motor_viscous_damping: f64,
    /// Distance from pin to rotation centre r [m].
    pub contact_radius: f64,
}

/// The numbers every `model.toml` of the practice records carries.
pub const NOMINAL: RigParameters = RigParameters {
    disc_inertia: 0.0149,
    shaft_stiffness: 0.3482,
    shaft_damping: 0.0022,
    gear_ratio: 8.0,
    motor_inertia: 5.18e-5,
    resistance: 0.33,
    inductance: 0.0008437,
    torque_constant: 0.126,
    back_emf_constant: 0.0602,
    motor_coulomb_torque: 0.1196,
    motor_viscous_damping: 0.0001784,
    contact_radius: 0.075,
};

/// One standard deviation of truth over belief at a spread of 0.02.
const UNCERTAINTY_AT_TWO_PERCENT: [(&str, f64); 8] = [
    ("J2", 0.006),
    ("k2", 0.02),
    ("c2", 0.06),
    ("R", 0.02),
    ("KT", 0.02),
    ("KE", 0.01),
    ("Tfm", 0.04),
    (FRICTION_LEVEL, 0.02),
];

/// Key of the ratio of the true friction level over the believed one.
pub const FRICTION_LEVEL: &str = "mu";

/// One standard deviation of truth over belief of the parameter `name` at `spread` (see
/// [`draw_ratios`]); 0 for a parameter that is as given.
pub fn relative_uncertainty(name: &str, spread: f64) -> f64 {
    UNCERTAINTY_AT_TWO_PERCENT
        .iter()
        .find(|(known, _)| *known == name)
        .map_or(0.0, |(_, sigma)| sigma * spread / 0.02)
}

/// Draws truth/belief for every uncertain parameter. `spread` 0.02 gives the analyst's stated
/// standard deviations, 0.01 half of them; 0 gives an empty map (the analyst is right). Draws
/// beyond 2.5 standard deviations are drawn again: an analyst's statement, not a wild guess.
pub fn draw_ratios(stream: &mut Stream, spread: f64) -> BTreeMap<String, f64> {
    if spread == 0.0 {
        return BTreeMap::new();
    }
    UNCERTAINTY_AT_TWO_PERCENT
        .iter()
        .map(|&(name, sigma)| {
            let deviation = loop {
                let draw = stream.normal();
                if draw.abs() <= 2.5 {
                    break draw;
                }
            };
            let ratio = 1.0 + sigma * spread / 0.02 * deviation;
            (name.to_owned(), (ratio * 1e5).round() / 1e5)
        })
        .collect()
}

impl RigParameters {
    /// The true rig: each uncertain parameter times its ratio (absent = 1).
    pub fn scaled(&self, ratios: &BTreeMap<String, f64>) -> Self {
        let ratio = |name: &str| ratios.get(name).copied().unwrap_or(1.0);
        Self {
            disc_inertia: self.disc_inertia * ratio("J2"),
            shaft_stiffness: self.shaft_stiffness * ratio("k2"),
            shaft_damping: self.shaft_damping * ratio("c2"),
            resistance: self.resistance * ratio("R"),
            torque_constant: self.torque_constant * ratio("KT"),
            back_emf_constant: self.back_emf_constant * ratio("KE"),
            motor_coulomb_torque: self.motor_coulomb_torque * ratio("Tfm"),
            ..*self
        }
    }
}
