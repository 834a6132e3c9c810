//! Segments on the slow manifold: Taylor series of the slow motion, which the motor side follows.

use super::Rig;
use super::index::{self, OMEGA, OMEGA1, OMEGA3, THETA, THETA1, THETA3};
use super::jet::RigJet;
use super::linear_parts::LinearParts;
use super::plain_motion::Pin;
use super::slow_manifold::{
    CURRENT, DISC, DISC_1, DiscMotion, Feedback, MOTOR, Regimes, SlowManifold, TWIST, TWIST_1, dot,
};
use super::tangent::SlowTangent;
use super::{INPUT_TERMS, RigInputs, RigMode, RigState};
use crate::friction::{ContactMode, Regime};
use crate::integrator::step_from_last_terms;
use crate::series::{RECIPROCAL, Scalar, Series, TERMS};

/// Numbers of orders after which a motion far from the manifold, and one close to it, shows that it is
/// not on it: what is left out is then below the transients that the check is to find.
const EARLY: [usize; 2] = [3, 7];
/// Lowest order at which the fast variables can be told well enough.
pub(super) const LOWEST_ORDER: usize = 14;
/// Share of the tolerance that the fast variables may still change in a further pass.
const SHARE: f64 = 0.01;

/// The transformations of a rig, computed when they are first needed, and series to work on.
#[derive(Clone, Debug)]
pub(super) struct SlowMotion<S, const N: usize> {
    /// For numbers with derivatives.
    tangent: Option<Box<SlowTangent<S, N>>>,
    found: Vec<(Regimes, Option<SlowManifold<S, N>>)>,
    /// Coefficients of the transformed slow and fast variables and of the forcing of the fast ones.
    pub slow: [[S; N]; TERMS],
    pub fast: [[S; 2]; TERMS],
    pub forcing: [[S; 2]; TERMS],
}

/// What drives a segment beside the friction.
struct Drive<S> {
    /// Torques from outside and the motor's friction over inertia, at order 0.
    disc: S,
    motor: S,
    /// Whether each disc answers to its friction torque.
    driven: [bool; 2],
}

impl<S: Scalar, const N: usize> SlowMotion<S, N> {
    pub fn new() -> Self {
        Self {
            tangent: S::HAS_DERIVATIVES.then(|| Box::new(SlowTangent::new())),
            // A run meets three or four: disc and motor stuck and sliding.
            found: Vec::with_capacity(4),
            slow: [[S::ZERO; N]; TERMS],
            fast: [[S::ZERO; 2]; TERMS],
            forcing: [[S::ZERO; 2]; TERMS],
        }
    }

    fn manifold(&mut self, parts: &LinearParts<S>, regimes: Regimes) -> Option<SlowManifold<S, N>> {
        if let Some((_, manifold)) = self.found.iter().find(|(known, _)| *known == regimes) {
            return manifold.clone();
        }
        let found = SlowManifold::new(parts, &regimes, [Feedback::NONE; 2]);
        let manifold = found.map(|(manifold, _)| manifold);
        self.found.push((regimes, manifold.clone()));
        manifold
    }

    /// The polynomial solution of dq̃/dt = A_f q̃ + f, from order `top` (whose successor is known)
    /// downwards.
    #[inline(always)]
    fn follow(&mut self, manifold: &SlowManifold<S, N>, top: usize) {
        let inverse = &manifold.fast_inverse;
        let mut next = self.fast[top + 1];
        for k in (0..=top).rev() {
            let forcing = &self.forcing[k];
            let scale = (k + 1) as f64;
            next = std::array::from_fn(|j| {
                (inverse[j][0] * scale * next[0] + inverse[j][1] * scale * next[1])
                    - (inverse[j][0] * forcing[0] + inverse[j][1] * forcing[1])
            });
            self.fast[k] = next;
        }
    }
}

/// Largest derivative of the fast variables' misses, relative to those of the state.
pub(super) fn derivatives_missed<S: Scalar>(missed: &[S; 2], state: &RigState<S>) -> f64 {
    let (mut size, mut whole) = (S::ZERO, S::ZERO);
    for x in missed {
        size.enlarge(1.0, x);
    }
    for x in state {
        whole.enlarge(1.0, x);
    }
    size.largest_share(&whole)
}

fn regimes(mode: &RigMode) -> Regimes {
    Regimes {
        discs: [disc_motion(mode.disc), disc_motion(mode.disc1)],
        motor_rests: mode.motor.is_stuck(),
    }
}

fn disc_motion(mode: ContactMode) -> DiscMotion {
    match mode {
        ContactMode::Stuck => DiscMotion::Stuck,
        ContactMode::Slipping(_, Regime::Holding) => DiscMotion::Kept,
        ContactMode::Slipping(..) | ContactMode::Breaking(_) => DiscMotion::Driven,
    }
}

impl<S: Scalar> Rig<S> {
    /// As [`Self::expand_slow_motion`], the derivatives by variational equations where that is possible.
    #[allow(clippy::too_many_arguments)]
    pub(super) fn expand_settled<const N: usize>(
        &self,
        mode: &RigMode,
        time: S,
        state: &RigState<S>,
        inputs: &RigInputs<S>,
        order: usize,
        tolerance: f64,
        work: &mut SlowMotion<S, N>,
        jet: &mut RigJet<S>,
    ) -> bool {
        let (Some(mut tangent), Some(slow)) = (jet.tangent.take(), work.tangent.as_mut()) else {
            return self.expand_slow_motion(mode, state, inputs, order, tolerance, work, jet);
        };
        tangent.set_tolerance(tolerance);
        let mut found = tangent.rig.expand_without_transients(
            mode,
            time.value(),
            &state.map(S::value),
            &inputs.to_scalar(),
            order,
            tolerance,
            &mut tangent.jet,
        );
        if found {
            for top in tangent.orders(order) {
                tangent.linearise(mode, inputs, (top, order), jet);
                found = slow.expand(regimes(mode), state, top, tolerance, &mut tangent, jet);
                if !found || tangent.judge(top, order, jet) {
                    tangent.rest(top, order, jet);
                    break;
                }
            }
        }
        jet.tangent = Some(tangent);
        found
    }

    /// Fills `jet`, whose inputs are in place, with the motion on the slow manifold if `state` lies on
    /// it within `tolerance` (absolute, relative to 1 + |x|); whether it does.
    #[allow(clippy::too_many_arguments)]
    pub(super) fn expand_slow_motion<const N: usize>(
        &self,
        mode: &RigMode,
        state: &RigState<S>,
        inputs: &RigInputs<S>,
        order: usize,
        tolerance: f64,
        work: &mut SlowMotion<S, N>,
        jet: &mut RigJet<S>,
    ) -> bool {
        let parts = jet.parts;
        let motor_sign = match mode.motor {
            ContactMode::Stuck => None,
            ContactMode::Breaking(direction) | ContactMode::Slipping(direction, _) => {
                Some(direction.sign())
            }
        };
        let regimes = regimes(mode);
        let Some(manifold) = work.manifold(&parts, regimes) else {
            return false;
        };
        let motor_friction = motor_sign.map(|sign| parts.motor_coulomb * sign);
        let drive = Drive {
            disc: inputs.disc_torque * parts.inverse_inertia,
            motor: motor_friction.map_or(S::ZERO, |friction| {
                (inputs.motor_torque - friction) * parts.inverse_motor_inertia
            }),
            driven: regimes.discs.map(|motion| motion == DiscMotion::Driven),
        };

        let mut s = [S::ZERO; N];
        (s[TWIST], s[DISC]) = (state[THETA] - state[THETA3], state[OMEGA]);
        if N > DISC_1 {
            (s[TWIST_1], s[DISC_1]) = (state[THETA1] - state[THETA], state[OMEGA1]);
        }
        let q = [state[OMEGA3], state[index::CURRENT]];
        let (slow, fast) = manifold.transformed(&s, &q);
        let allowed = q.map(|x| tolerance * (1.0 + x.value().abs()));

        let (disc, disc1) = self.pins(mode, jet);
        let pins = [Some(&disc), disc1.as_ref()];
        work.slow[0] = slow;
        work.fast = [[S::ZERO; 2]; TERMS];
        let guess = self.guess(&manifold, &parts, fast, work, jet);
        work.fast[..INPUT_TERMS].copy_from_slice(&guess);
        let mut known = 0;
        for reach in EARLY {
            self.pass(&manifold, &drive, pins, known..reach, work, jet);
            known = reach;
            work.fast[reach - 1..=reach].fill([S::ZERO; 2]);
            work.follow(&manifold, reach - 2);
            let shorter = work.fast[0];
            work.follow(&manifold, reach - 1);
            let early = work.fast[0];
            let off = |j: usize| {
                let left_out = (early[j] - shorter[j]).value().abs();
                (early[j] - fast[j]).value().abs() > 3.0 * left_out + 2.0 * allowed[j]
            };
            if off(0) || off(1) {
                return false;
            }
            work.fast[..reach].fill([S::ZERO; 2]);
            work.fast[..INPUT_TERMS].copy_from_slice(&guess);
        }
        self.pass(&manifold, &drive, pins, known..order + 1, work, jet);
        work.follow(&manifold, order);

        jet.corrected = 0;
        if drive.driven[0] || (N > DISC_1 && drive.driven[1]) {
            let again = if !S::HAS_DERIVATIVES
                && pins.iter().flatten().all(|pin| pin.is_free_of_torques())
            {
                correction_terms(&manifold, &guess, tolerance, order, work, jet)
            } else {
                order + 1
            };
            jet.corrected = again;
            self.pass(&manifold, &drive, pins, 0..again, work, jet);
            work.follow(&manifold, again - 1);
        }
        let found = work.fast[0];
        let missed = [found[0] - fast[0], found[1] - fast[1]];
        let within = |j: usize| missed[j].value().abs() <= allowed[j];
        if !(within(0) && within(1) && derivatives_missed(&missed, state) <= tolerance) {
            return false;
        }
        self.assemble(&manifold, motor_friction, inputs, pins, order, work, jet);
        true
    }

    /// The fast variables as far as they are known before the friction: what the inputs alone make of
    /// them, started at the present values.
    fn guess<const N: usize>(
        &self,
        manifold: &SlowManifold<S, N>,
        parts: &LinearParts<S>,
        present: [S; 2],
        work: &mut SlowMotion<S, N>,
        jet: &RigJet<S>,
    ) -> [[S; 2]; INPUT_TERMS] {
        let mut guess = [[S::ZERO; 2]; INPUT_TERMS];
        if !jet.voltage_is_constant {
            for k in 0..INPUT_TERMS {
                work.forcing[k] = [S::ZERO, jet.voltage[k] * parts.inverse_inductance];
            }
            work.fast[INPUT_TERMS] = [S::ZERO; 2];
            work.follow(manifold, INPUT_TERMS - 1);
            guess.copy_from_slice(&work.fast[..INPUT_TERMS]);
        }
        guess[0] = present;
        guess
    }

    /// Orders `range` of the friction and of the slow variables, with the fast ones as they are known.
    #[inline(always)]
    fn pass<const N: usize>(
        &self,
        manifold: &SlowManifold<S, N>,
        drive: &Drive<S>,
        pins: [Option<&Pin<'_, S>>; 2],
        range: std::ops::Range<usize>,
        work: &mut SlowMotion<S, N>,
        jet: &mut RigJet<S>,
    ) {
        let full = N > DISC_1;
        let parts = jet.parts;
        let (l, h) = (&manifold.fast_from_slow, &manifold.slow_from_fast);
        // How the slow variables answer to the accelerations of D2 and D1: e + H L e.
        let answer = |disc: usize| -> [S; N] {
            std::array::from_fn(|j| {
                let direct = if j == disc { S::constant(1.0) } else { S::ZERO };
                direct + (h[j][0] * l[0][disc] + h[j][1] * l[1][disc])
            })
        };
        let from_disc = answer(DISC);
        let from_disc1 = if full { answer(DISC_1) } else { [S::ZERO; N] };
        let x = &mut jet.states;
        let mut slow = work.slow[range.start];
        for k in range {
            let per_next = RECIPROCAL[k + 1];
            let (s, q) = manifold.physical(&slow, &work.fast[k]);
            x[OMEGA][k] = s[DISC];
            x[THETA][k + 1] = s[DISC] * per_next;
            let mut resisting = parts.damping * (s[DISC] - q[MOTOR]) + parts.stiffness * s[TWIST];
            let mut forcing = [S::ZERO; 2];
            let mut next: [S; N] =
                std::array::from_fn(|j| dot(&manifold.slow[j], &slow) * per_next);
            if full {
                x[OMEGA1][k] = s[DISC_1];
                x[THETA1][k + 1] = s[DISC_1] * per_next;
                let torque1 =
                    parts.damping_1 * (s[DISC_1] - s[DISC]) + parts.stiffness_1 * s[TWIST_1];
                resisting -= torque1;
                if let (true, Some(pin), Some(pin_jet)) =
                    (drive.driven[1], pins[1], jet.disc1.as_mut())
                {
                    pin.next_velocity(k, torque1, &x[THETA1], &x[OMEGA1], pin_jet);
                    let acceleration = pin_jet.torque[k] * parts.inverse_inertia_1;
                    for j in 0..N {
                        next[j] -= from_disc1[j] * per_next * acceleration;
                    }
                    for j in 0..2 {
                        forcing[j] += l[j][DISC_1] * acceleration;
                    }
                }
            }
            if k == 0 {
                resisting -= drive.disc * parts.inertia;
            }
            if let (true, Some(pin)) = (drive.driven[0], pins[0]) {
                pin.next_velocity(k, resisting, &x[THETA], &x[OMEGA], &mut jet.disc);
                let mut acceleration = jet.disc.torque[k] * parts.inverse_inertia;
                if k == 0 {
                    acceleration -= drive.disc;
                }
                for j in 0..N {
                    next[j] -= from_disc[j] * per_next * acceleration;
                }
                for j in 0..2 {
                    forcing[j] += l[j][DISC] * acceleration;
                }
            }
            if k < INPUT_TERMS {
                let mut outside = [S::ZERO, jet.voltage[k] * parts.inverse_inductance];
                if k == 0 {
                    outside[MOTOR] = drive.motor;
                }
                for j in 0..N {
                    next[j] -= (h[j][0] * outside[0] + h[j][1] * outside[1]) * per_next;
                }
                for j in 0..2 {
                    forcing[j] += outside[j];
                }
            }
            work.forcing[k] = forcing;
            slow = next;
            work.slow[k + 1] = next;
        }
    }

    /// Puts all series into `jet` once the transformed variables are known. Reactions follow from the
    /// very series of the angles, so that they agree to the last digit with those at a switch.
    #[allow(clippy::too_many_arguments)]
    #[inline(always)]
    fn assemble<const N: usize>(
        &self,
        manifold: &SlowManifold<S, N>,
        motor_friction: Option<S>,
        inputs: &RigInputs<S>,
        pins: [Option<&Pin<'_, S>>; 2],
        order: usize,
        work: &mut SlowMotion<S, N>,
        jet: &mut RigJet<S>,
    ) {
        let full = N > DISC_1;
        let parts = jet.parts;
        let x = &mut jet.states;
        for k in 0..=order {
            let per_next = RECIPROCAL[k + 1];
            let (s, q) = manifold.physical(&work.slow[k], &work.fast[k]);
            x[OMEGA][k] = s[DISC];
            x[OMEGA3][k] = q[MOTOR];
            x[index::CURRENT][k] = q[CURRENT];
            if k == 0 {
                x[THETA3][0] = x[THETA][0] - s[TWIST];
            }
            x[THETA][k + 1] = s[DISC] * per_next;
            x[THETA3][k + 1] = q[MOTOR] * per_next;
            let shaft_torque = parts.damping * (s[DISC] - q[MOTOR])
                + parts.stiffness * (x[THETA][k] - x[THETA3][k]);
            let mut resisting = shaft_torque;
            if full {
                x[OMEGA1][k] = s[DISC_1];
                if k == 0 {
                    x[THETA1][0] = x[THETA][0] + s[TWIST_1];
                }
                x[THETA1][k + 1] = s[DISC_1] * per_next;
                let torque1 = parts.damping_1 * (s[DISC_1] - s[DISC])
                    + parts.stiffness_1 * (x[THETA1][k] - x[THETA][k]);
                resisting -= torque1;
                if let (Some(pin), Some(pin_jet)) = (pins[1], jet.disc1.as_mut()) {
                    pin.reaction(k, torque1, &x[THETA1], &x[OMEGA1], pin_jet);
                }
            }
            if k == 0 {
                resisting -= inputs.disc_torque;
            }
            if let Some(pin) = pins[0] {
                pin.reaction(k, resisting, &x[THETA], &x[OMEGA], &mut jet.disc);
            }
            jet.motor_torque[k] = match motor_friction {
                Some(friction) if k == 0 => friction,
                Some(_) => S::ZERO,
                None => {
                    let outside = if k == 0 { inputs.motor_torque } else { S::ZERO };
                    parts.current_to_torque * q[CURRENT] + shaft_torque + outside
                }
            };
        }
    }
}

/// Number of leading orders at which the fast variables move the discs enough to tell in the friction.
fn correction_terms<S: Scalar, const N: usize>(
    manifold: &SlowManifold<S, N>,
    guess: &[[S; 2]; INPUT_TERMS],
    tolerance: f64,
    order: usize,
    work: &SlowMotion<S, N>,
    jet: &RigJet<S>,
) -> usize {
    let size = |series: &Series<S>, k: usize| series[k].value().abs() / tolerance;
    let mut last = [0.0_f64; 2];
    for series in [&jet.states[OMEGA], &jet.states[OMEGA1]] {
        last[0] = last[0].max(size(series, order));
        last[1] = last[1].max(size(series, order - 1));
    }
    let step = step_from_last_terms(last[0], last[1], order).min(1.0);
    let moved = |j: usize| {
        let row = &manifold.slow_from_fast[j];
        guess
            .iter()
            .zip(&work.fast)
            .map(|(guess, fast)| {
                let by_fast = row[0] * (fast[0] - guess[0]) + row[1] * (fast[1] - guess[1]);
                by_fast.value().abs()
            })
            .fold((0.0, 1.0), |(sum, power), x| {
                (sum + x * power, power * step)
            })
            .0
    };
    // A shift of the slip speed changes all coefficients of the friction in proportion.
    let shift = if N > DISC_1 {
        moved(DISC).max(moved(DISC_1))
    } else {
        moved(DISC)
    };
    let mut power = 1.0;
    for k in 0..order {
        let largest = size(&jet.states[OMEGA], k).max(size(&jet.states[OMEGA1], k));
        if largest * power * shift <= SHARE {
            return k.max(2);
        }
        power *= step;
    }
    order + 1
}
