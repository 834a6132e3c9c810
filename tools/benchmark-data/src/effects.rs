//! What can be hidden in a rig, with the names and units that `ANSWERS.json` uses.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Values of the hidden effects; neutral by default. Field names are the keys of `effects` in
/// `ANSWERS.json`; the records' README gives the equations of the first block.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[expect(non_snake_case, reason = "the keys of the answers file are these")]
pub struct Effects {
    /// Coulomb torque of the disc's bearing [N m].
    pub bearing_T: f64,
    /// Relative amplitude of the normal force over one turn [-].
    pub wobble_a: f64,
    /// Phase of the wobble [rad].
    pub wobble_ph: f64,
    /// Unbalance torque [N m].
    pub unbal_T: f64,
    /// Phase of the unbalance [rad].
    pub unbal_ph: f64,
    /// Cubic stiffness of the shaft [N m/rad³].
    pub k3: f64,
    /// Motor torque ripple, motor side [N m].
    pub cog_T: f64,
    /// Viscous drag on the disc [N m s/rad].
    pub visc: f64,
    /// Quadratic drag on the disc [N m s²/rad²].
    pub quad: f64,
    /// Width of the dead band in the coupling [rad].
    pub backlash: f64,
    /// Reading of the load cell minus true force [N].
    pub cell_bias: f64,
    /// Relative growth of friction per minute [1/min].
    pub dmudt: f64,
    /// Relative growth of the resistance per minute [1/min].
    pub dRdt: f64,
    /// Voltage at the motor over voltage commanded [-].
    pub uscale: f64,
    /// Exponent of the normal force [-].
    pub load_exp: f64,
    /// Normal force at which the exponent changes nothing [N].
    pub load_ref: f64,
    /// Extra viscous damping, motor side [N m s/rad].
    pub motor_visc: f64,
    /// Lag of the disc's channels [s].
    pub delay: f64,
    /// Stiffness of the pin's bristles [N m/rad]; infinite = too stiff to be seen.
    pub bristle_k: f64,
    /// Standard deviation of the random friction factor [-].
    pub stoch_std: f64,
    /// Correlation time of the random friction factor [s].
    pub stoch_tau: f64,

    /// Amplitude of a torque on the disc that is periodic in time [N m] (outside any catalogue,
    /// like all that follow).
    pub periodic_T: f64,
    /// Its frequency [Hz].
    pub periodic_f: f64,
    /// Its phase [rad].
    pub periodic_ph: f64,
    /// Inertia that hangs on the disc by a spring of its own [kg m²].
    pub absorber_J: f64,
    /// Its natural frequency [Hz].
    pub absorber_f: f64,
    /// Its damping ratio [-].
    pub absorber_zeta: f64,
    /// Current above which the motor gives no more torque [A]; infinite = never.
    pub saturation_i: f64,
    /// Share of the shaft stiffness lost when warm [-].
    pub softening: f64,
    /// Time constant of warming [s].
    pub softening_tau: f64,
    /// Relative amplitude of an inertia that changes with time [-].
    pub breathing_J: f64,
    /// Its period [s].
    pub breathing_period: f64,
    /// Its phase [rad].
    pub breathing_ph: f64,
    /// Height of a bump of the friction torque around one speed, relative [-].
    pub bump_height: f64,
    /// Speed of the bump [rad/s].
    pub bump_centre: f64,
    /// Width of the bump [rad/s].
    pub bump_width: f64,
    /// Relative growth of the breakaway torque over a dwell of e times `dwell_tau` at rest [-].
    pub dwell_gain: f64,
    /// Dwell from which it grows [s].
    pub dwell_tau: f64,
    /// Time by which the friction torque lags behind its law [s].
    pub memory_tau: f64,
    /// Time by which the drive's voltage lags behind the command [s].
    pub drive_tau: f64,
    /// Amplitude by which the disc's encoder errs over one turn [rad].
    pub eccentricity: f64,
    /// Its phase [rad].
    pub eccentricity_ph: f64,
    /// Reading of the disc's tachometer over its speed [-].
    pub tacho_gain: f64,
    /// Relative amplitude of a normal force that varies three times per turn [-].
    pub lobes_a: f64,
    /// Its phase [rad].
    pub lobes_ph: f64,
    /// Share of the normal force that a speed of 1 rad/s lifts off, growing with its square [s²/rad²].
    pub lifting: f64,
    /// Share of the torque constant lost when warm [-].
    pub fading: f64,
    /// Time constant of warming [s].
    pub fading_tau: f64,
    /// Amplitude of a torque with several cycles per turn of the disc [N m].
    pub harmonic_T: f64,
    /// Its cycles per turn [-].
    pub harmonic_n: f64,
    /// Its phase [rad].
    pub harmonic_ph: f64,
    /// Relative height of the friction on a patch of the disc [-].
    pub patch_height: f64,
    /// Angle of the patch [rad].
    pub patch_centre: f64,
    /// Width of the patch [rad].
    pub patch_width: f64,
    /// Relative jump of the friction at one time [-].
    pub jump: f64,
    /// Time of the jump [s].
    pub jump_time: f64,
    /// Relative amplitude by which friction sways with time [-].
    pub sway: f64,
    /// Its period [s].
    pub sway_period: f64,
    /// Its phase [rad].
    pub sway_ph: f64,
    /// Friction backward over friction forward, less one [-].
    pub asymmetry: f64,
    /// Normal force that the contact never exceeds [N]; infinite = none.
    pub load_limit: f64,
}

impl Default for Effects {
    fn default() -> Self {
        Self {
            bearing_T: 0.0,
            wobble_a: 0.0,
            wobble_ph: 0.0,
            unbal_T: 0.0,
            unbal_ph: 0.0,
            k3: 0.0,
            cog_T: 0.0,
            visc: 0.0,
            quad: 0.0,
            backlash: 0.0,
            cell_bias: 0.0,
            dmudt: 0.0,
            dRdt: 0.0,
            uscale: 1.0,
            load_exp: 1.0,
            load_ref: 50.0,
            motor_visc: 0.0,
            delay: 0.0,
            bristle_k: f64::INFINITY,
            stoch_std: 0.0,
            stoch_tau: 0.1,
            periodic_T: 0.0,
            periodic_f: 1.0,
            periodic_ph: 0.0,
            absorber_J: 0.0,
            absorber_f: 1.0,
            absorber_zeta: 0.0,
            saturation_i: f64::INFINITY,
            softening: 0.0,
            softening_tau: 1.0,
            breathing_J: 0.0,
            breathing_period: 1.0,
            breathing_ph: 0.0,
            bump_height: 0.0,
            bump_centre: 1.0,
            bump_width: 1.0,
            dwell_gain: 0.0,
            dwell_tau: 1.0,
            memory_tau: 0.0,
            drive_tau: 0.0,
            eccentricity: 0.0,
            eccentricity_ph: 0.0,
            tacho_gain: 1.0,
            lobes_a: 0.0,
            lobes_ph: 0.0,
            lifting: 0.0,
            fading: 0.0,
            fading_tau: 1.0,
            harmonic_T: 0.0,
            harmonic_n: 1.0,
            harmonic_ph: 0.0,
            patch_height: 0.0,
            patch_centre: 0.0,
            patch_width: 1.0,
            jump: 0.0,
            jump_time: 0.0,
            sway: 0.0,
            sway_period: 1.0,
            sway_ph: 0.0,
            asymmetry: 0.0,
            load_limit: f64::INFINITY,
        }
    }
}

impl Effects {
    /// The values that differ from neutral, as `ANSWERS.json` lists them.
    pub fn answers(&self) -> BTreeMap<String, f64> {
        let listed = |effects: &Self| match serde_json::to_value(effects) {
            Ok(serde_json::Value::Object(values)) => values,
            _ => serde_json::Map::new(),
        };
        let neutral = listed(&Self::default());
        listed(self)
            .into_iter()
            .filter(|(name, value)| neutral.get(name) != Some(value))
            .filter_map(|(name, value)| Some((name, value.as_f64()?)))
            .chain((self.stoch_std > 0.0).then(|| ("stoch_tau".to_owned(), self.stoch_tau)))
            .collect()
    }

    /// The effects of an entry of `ANSWERS.json`.
    pub fn from_answers(values: &BTreeMap<String, f64>) -> Result<Self, serde_json::Error> {
        serde_json::to_value(values).and_then(serde_json::from_value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn answers_carry_only_what_is_hidden_and_come_back() {
        let hidden = Effects {
            wobble_a: 0.25,
            wobble_ph: 1.0,
            stoch_std: 0.04,
            ..Effects::default()
        };
        let answers = hidden.answers();
        let names: Vec<&str> = answers.keys().map(String::as_str).collect();
        assert_eq!(names, ["stoch_std", "stoch_tau", "wobble_a", "wobble_ph"]);
        assert_eq!(Effects::from_answers(&answers).unwrap(), hidden);
    }
}
