//! Normal forces on the pins: what presses, and what the effects make of it before the disc turns.

use super::inputs::recentre;
use super::jet::RigJet;
use super::{Rig, RigInputs};
use crate::series::{RECIPROCAL, Scalar, Series, TERMS};

/// Seconds over which the drifts of wear and of resistance are stated.
pub(super) const MINUTE: f64 = 60.0;
/// Normal force [N] at which a load exponent changes nothing.
const REFERENCE_LOAD: f64 = 50.0;
/// Normal force [N] below which a load exponent sees none: a power is not analytic at zero.
const SMALLEST_POWER_LOAD: f64 = 1e-6;
/// Normal force [N] that is rounding where a moving force passes through zero.
const ROUNDING_OF_FORCE: f64 = 1e-9;

impl<S: Scalar> Rig<S> {
    /// Puts the normal force × radius before any factor that varies with angle or time into the
    /// jet; whether it is constant.
    pub(super) fn start_load(
        &self,
        inputs: &RigInputs<S>,
        time: S,
        offset: S,
        jet: &mut RigJet<S>,
    ) -> bool {
        let pin = &mut jet.disc;
        let mut constant = true;
        if self.law.is_torque() {
            pin.load = [S::ZERO; TERMS];
            pin.load[0] = S::constant(1.0);
            if let Some(work) = &mut jet.effects
                && let Some(equations) = &mut work.equations
            {
                let force = &mut equations.loads[0];
                let constant = recentre(&inputs.normal_force, offset, false, force);
                lift_off(force, constant, 0.0);
            }
        } else {
            constant = recentre(
                &inputs.normal_force,
                offset,
                pin.load_is_constant,
                &mut pin.load,
            );
            if let Some(bias) = &self.effects.load_cell_bias {
                // A lifted pin reads zero whatever the offset is.
                if !constant || pin.load[0].value() != 0.0 {
                    pin.load[0] -= bias.bias;
                }
            }
            if let Some(work) = &mut jet.effects
                && let Some(equations) = &mut work.equations
            {
                equations.loads[0] = pin.load;
                lift_off(&mut equations.loads[0], constant, 0.0);
            }
            match &self.effects.load_exponent {
                Some(exponent) => {
                    pin.moving[0] = lift_off(&mut pin.load, constant, SMALLEST_POWER_LOAD);
                    if pin.load[0].value() > 0.0 {
                        power(exponent.exponent, constant, &mut pin.load);
                    }
                }
                None => pin.moving[0] = lift_off(&mut pin.load, constant, 0.0),
            }
            scale(&mut pin.load, constant, self.contact.radius);
        }
        if let Some(wear) = &self.effects.friction_wear {
            let rate = wear.rate_per_minute * (1.0 / MINUTE);
            let mut factor = [S::ZERO; TERMS];
            (factor[0], factor[1]) = (rate * time + 1.0, rate);
            pin.moving[1] = lift_off(&mut factor, false, 0.0);
            for k in (0..TERMS).rev() {
                let earlier = if k > 0 { pin.load[k - 1] } else { S::ZERO };
                pin.load[k] = pin.load[k] * factor[0] + earlier * factor[1];
            }
            constant = false;
        }
        if let Some(work) = &mut jet.effects {
            work.base_load = pin.load;
        }
        constant
    }
}

/// Makes a force (or a factor of it) that is not above `threshold` vanish: a pin cannot pull. Gives
/// what has to be watched if it is not constant.
pub(super) fn lift_off<S: Scalar>(
    force: &mut Series<S>,
    constant: bool,
    threshold: f64,
) -> Option<Box<Series<S>>> {
    if constant {
        if force[0].value() <= threshold + ROUNDING_OF_FORCE {
            force[0] = S::ZERO;
        }
        return None;
    }
    let mut watched = *force;
    watched[0] = watched[0] + -threshold;
    if watched[0].value().abs() <= ROUNDING_OF_FORCE {
        // At the instant of touching or lifting the sign is that of what comes next.
        watched[0] = S::ZERO;
        force[0] = S::constant(threshold);
    }
    let next = watched.iter().map(|c| c.value()).find(|c| *c != 0.0);
    if next.is_none_or(|c| c < 0.0) {
        *force = [S::ZERO; TERMS];
    }
    Some(Box::new(watched))
}

pub(super) fn scale<S: Scalar>(series: &mut Series<S>, constant: bool, factor: S) {
    let used = if constant { 1 } else { TERMS };
    for c in series.iter_mut().take(used) {
        *c = *c * factor;
    }
}

/// Replaces a positive load by 50 N (N/50 N)^exponent.
fn power<S: Scalar>(exponent: S, constant: bool, load: &mut Series<S>) {
    let first = load[0];
    let scaled = (first * (1.0 / REFERENCE_LOAD)).powf(exponent) * REFERENCE_LOAD;
    if constant {
        load[0] = scaled;
        return;
    }
    let mut powers = [S::ZERO; TERMS];
    powers[0] = scaled;
    // k y_k x_0 = Σ_{j=1..k} (p j − (k − j)) x_j y_{k−j} for y = x^p.
    for k in 1..TERMS {
        let mut sum = S::ZERO;
        for j in 1..=k {
            let weight = exponent * j as f64 - (k - j) as f64;
            sum += weight * load[j] * powers[k - j];
        }
        powers[k] = sum * RECIPROCAL[k] / first;
    }
    *load = powers;
}
