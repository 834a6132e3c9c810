//! What can be hidden in a rig, with the names and units that `ANSWERS.json` uses.

use libm::sin;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Declares [`Effects`]: names and neutral values.
macro_rules! effects {
    ($($(#[$doc:meta])* $name:ident = $neutral:expr;)*) => {
        /// Values of the hidden effects; neutral by default. Field names are the keys of `effects` in
        /// `ANSWERS.json`; the records' README gives the equations of the first block.
        #[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
        #[serde(default, deny_unknown_fields)]
        #[expect(non_snake_case, reason = "the keys of the answers file are these")]
        pub struct Effects {
            $($(#[$doc])* pub $name: f64,)*
        }

        impl Default for Effects {
            fn default() -> Self {
                Self { $($name: $neutral,)* }
            }
        }
    };
}

effects! {
    /// Coulomb torque of the disc's bearing [N m].
    bearing_T = 0.0;
    /// Relative amplitude of the normal force over one turn [-].
    wobble_a = 0.0;
    /// Phase of the wobble [rad].
    wobble_ph = 0.0;
    /// Unbalance torque [N m].
    unbal_T = 0.0;
    /// Phase of the unbalance [rad].
    unbal_ph = 0.0;
    /// Cubic stiffness of the shaft [N m/rad³].
    k3 = 0.0;
    /// Motor torque ripple, motor side [N m].
    cog_T = 0.0;
    /// Viscous drag on the disc [N m s/rad].
    visc = 0.0;
    /// Quadratic drag on the disc [N m s²/rad²].
    quad = 0.0;
    /// Width of the dead band in the coupling [rad].
    backlash = 0.0;
    /// Reading of the load cell minus true force [N].
    cell_bias = 0.0;
    /// Relative growth of friction per minute [1/min].
    dmudt = 0.0;
    /// Relative growth of the resistance per minute [1/min].
    dRdt = 0.0;
    /// Voltage at the motor over voltage commanded [-].
    uscale = 1.0;
    /// Exponent of the normal force [-].
    load_exp = 1.0;
    /// Normal force at which the exponent changes nothing [N].
    load_ref = 50.0;
    /// Extra viscous damping, motor side [N m s/rad].
    motor_visc = 0.0;
    /// Lag of the disc's channels [s].
    delay = 0.0;
    /// Stiffness of the pin's bristles [N m/rad]; infinite = too stiff to be seen.
    bristle_k = f64::INFINITY;
    /// Standard deviation of the random friction factor [-].
    stoch_std = 0.0;
    /// Correlation time of the random friction factor [s].
    stoch_tau = 0.1;

    /// Amplitude of a torque on the disc that is periodic in time [N m] (outside any catalogue,
    /// like all that follow).
    periodic_T = 0.0;
    /// Its frequency [Hz].
    periodic_f = 1.0;
    /// Its phase [rad].
    periodic_ph = 0.0;
    /// Inertia that hangs on the disc by a spring of its own [kg m²].
    absorber_J = 0.0;
    /// Its natural frequency [Hz].
    absorber_f = 1.0;
    /// Its damping ratio [-].
    absorber_zeta = 0.0;
    /// Current above which the motor gives no more torque [A]; infinite = never.
    saturation_i = f64::INFINITY;
    /// Share of the shaft stiffness lost when warm [-].
    softening = 0.0;
    /// Time constant of warming [s].
    softening_tau = 1.0;
    /// Relative amplitude of an inertia that changes with time [-].
    breathing_J = 0.0;
    /// Its period [s].
    breathing_period = 1.0;
    /// Its phase [rad].
    breathing_ph = 0.0;
    /// Height of a bump of the friction torque around one speed, relative [-].
    bump_height = 0.0;
    /// Speed of the bump [rad/s].
    bump_centre = 1.0;
    /// Width of the bump [rad/s].
    bump_width = 1.0;
    /// Relative growth of the breakaway torque over a dwell of e times `dwell_tau` at rest [-].
    dwell_gain = 0.0;
    /// Dwell from which it grows [s].
    dwell_tau = 1.0;
    /// Time by which the friction torque lags behind its law [s].
    memory_tau = 0.0;
    /// Time by which the drive's voltage lags behind the command [s].
    drive_tau = 0.0;
    /// Amplitude by which the disc's encoder errs over one turn [rad].
    eccentricity = 0.0;
    /// Its phase [rad].
    eccentricity_ph = 0.0;
    /// Reading of the disc's tachometer over its speed [-].
    tacho_gain = 1.0;
    /// Relative amplitude of a normal force that varies three times per turn [-].
    lobes_a = 0.0;
    /// Its phase [rad].
    lobes_ph = 0.0;
    /// Share of the normal force that a speed of 1 rad/s lifts off, growing with its square [s²/rad²].
    lifting = 0.0;
    /// Share of the torque constant lost when warm [-].
    fading = 0.0;
    /// Time constant of warming [s].
    fading_tau = 1.0;
    /// Amplitude of a torque with several cycles per turn of the disc [N m].
    harmonic_T = 0.0;
    /// Its cycles per turn [-].
    harmonic_n = 1.0;
    /// Its phase [rad].
    harmonic_ph = 0.0;
    /// Relative height of the friction on a patch of the disc [-].
    patch_height = 0.0;
    /// Angle of the patch [rad].
    patch_centre = 0.0;
    /// Width of the patch [rad].
    patch_width = 1.0;
    /// Relative jump of the friction at one time [-].
    jump = 0.0;
    /// Time of the jump [s].
    jump_time = 0.0;
    /// Relative amplitude by which friction sways with time [-].
    sway = 0.0;
    /// Its period [s].
    sway_period = 1.0;
    /// Its phase [rad].
    sway_ph = 0.0;
    /// Friction backward over friction forward, less one [-].
    asymmetry = 0.0;
    /// Normal force that the contact never exceeds [N]; infinite = none.
    load_limit = f64::INFINITY;
}

impl Effects {
    /// The angle of the disc's encoder where the disc's is `angle`, both [rad].
    pub(crate) fn encoder_angle(&self, angle: f64) -> f64 {
        let off = sin(angle - self.eccentricity_ph);
        angle + self.eccentricity * (off + sin(self.eccentricity_ph))
    }

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
