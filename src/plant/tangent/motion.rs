//! The motion without derivatives, and the coefficients of the variational equations along it.

use super::parameter_forcing::{
    Along, Forcing, KINDS, ON_CIRCUIT, ON_DISC, ON_DISC_1, ON_MOTOR, ParameterForcings, ROWS,
};
use super::pin::{PinSegment, PinTangent};
use crate::friction::ContactMode;
use crate::integrator::{SETTLED_SHARE, step_from_last_terms};
use crate::plant::index::{CURRENT, OMEGA, OMEGA1, OMEGA3, THETA, THETA1, THETA3};
use crate::plant::linear_parts::LinearParts;
use crate::plant::{INPUT_TERMS, Rig, RigInputs, RigJet, RigMode};
use crate::series::{Scalar, Series, TERMS};

/// Lowest order that is worth two sets of series.
pub(super) const LOWEST_ORDER: usize = 4;

/// Best relative accuracy of the derivatives in one segment. With less of it than the motion has, fewer
/// orders do, and derivatives count as free of transients about where the motion does.
const BEST_ACCURACY: f64 = 1e-9;
/// The same over the tolerance of a coarser run.
const OVER_TOLERANCE: f64 = 10.0;

/// Terms of a derivative's series by which its size is judged.
const FIRST_TERMS: usize = 4;
/// Most times that the reach of a series is judged anew by its size within the reach found before. Each time the logarithm of what is
/// too long shrinks by the order of the largest term over that of the last: where that is a half, 4000 times in all.
const MOST_LOOKS: usize = 12;

/// A motion and the equations of its derivatives.
#[derive(Clone, Debug)]
pub(in crate::plant) struct Tangent<S> {
    pub rig: Rig<f64>,
    pub jet: RigJet<f64>,
    pub(super) pins: [PinTangent; 2],
    pub(super) forcing: Box<Forcing<S>>,
    /// Derivatives of the accelerations of D2 and D1: laws that look at them need them.
    pub(super) accelerations: Box<[Series<S>; 2]>,
    parameter_forcings: ParameterForcings,
    motion: Box<[Series<f64>; KINDS]>,
    /// Tolerance of the run as far as it is known: zero at first.
    tolerance: f64,
    /// About the length of the segment at hand [s], by its motion.
    step: f64,
    /// Order up to which the derivatives tell if they are as smooth as the motion.
    expected: usize,
    /// Whether the derivatives of the last segment took more orders than its motion let expect.
    lively: bool,
    /// The longest segment [s] at which the derivatives hold.
    pub reach: f64,
}

impl<S: Scalar> Tangent<S> {
    /// The plain counterpart of `rig`, whose effects must not act on the motion.
    pub fn new(rig: &Rig<S>, parts: &LinearParts<S>) -> Self {
        let plain = rig.to_scalar();
        let disc1 = rig.disc1.as_ref().map_or(&rig.law, |disc1| &disc1.law);
        Self {
            jet: RigJet::new(&plain),
            rig: plain,
            pins: [
                PinTangent::new(&rig.law, rig.bearing_torque()),
                PinTangent::new(disc1, S::ZERO),
            ],
            forcing: Box::new([[S::ZERO; TERMS]; ROWS]),
            accelerations: Box::new([[S::ZERO; TERMS]; 2]),
            parameter_forcings: ParameterForcings::new(parts),
            motion: Box::new([[0.0; TERMS]; KINDS]),
            tolerance: 0.0,
            step: 0.0,
            expected: 0,
            lively: false,
            reach: f64::INFINITY,
        }
    }

    /// Drops what is remembered of the run so far.
    pub fn forget(&mut self) {
        self.tolerance = 0.0;
        self.lively = false;
    }

    /// Relative accuracy wanted of the derivatives in one segment.
    pub(super) fn accuracy(&self) -> f64 {
        BEST_ACCURACY.max(OVER_TOLERANCE * self.tolerance)
    }

    /// Notes the tolerance of the run.
    pub fn set_tolerance(&mut self, tolerance: f64) {
        self.tolerance = tolerance;
    }

    /// Orders of the derivatives to try in the segment just expanded: that up to which they tell if they
    /// are as smooth as the motion, and the last one, `order`, if need be.
    pub fn orders(&mut self, order: usize) -> impl Iterator<Item = usize> + use<S> {
        self.expected = self.expected_order(order, SETTLED_SHARE);
        (!self.lively && self.expected < order)
            .then_some(self.expected)
            .into_iter()
            .chain([order])
    }

    /// Number of the last order whose derivatives tell if they are as smooth as the motion, which
    /// is followed for as long as its terms stay below `share` of the tolerance.
    fn expected_order(&mut self, order: usize, share: f64) -> usize {
        let mut sizes = [0.0_f64; TERMS];
        for index in [OMEGA, OMEGA3, CURRENT, OMEGA1] {
            let series = &self.jet.states[index];
            let unit = 1.0 / (1.0 + series[0].abs());
            for (size, c) in sizes.iter_mut().zip(&series[..=order]) {
                *size = size.max(c.abs() * unit);
            }
        }
        let (last, before) = (sizes[order], sizes[order - 1]);
        let known = self.tolerance > 0.0;
        let scale = 1.0
            / if known {
                share * self.tolerance
            } else {
                self.accuracy()
            };
        self.step = step_from_last_terms(last * scale, before * scale, order).min(1.0);
        let accuracy = self.accuracy();
        let (mut power, mut wanted) = (1.0, LOWEST_ORDER);
        for (k, size) in sizes[..=order].iter().enumerate() {
            // A derivative of (t/T)^k by T is k times as large.
            if size * power * k as f64 > accuracy {
                wanted = wanted.max(k);
            }
            power *= self.step;
        }
        wanted
    }

    /// Finds how far the derivatives up to order `top` in `jet` reach; whether that is as far as the motion.
    pub fn judge(&mut self, top: usize, order: usize, jet: &RigJet<S>) -> bool {
        if top == order && self.expected < order {
            self.lively = self.reach_of(self.expected, FIRST_TERMS, self.step, jet) < self.step;
        }
        self.reach = self.reach_of(top, FIRST_TERMS, self.step, jet);
        self.reach >= self.step
    }

    /// Time [s] in which the last terms of the derivatives up to order `top` stay below [`Self::accuracy`], their size
    /// judged by the first `terms` at time `step`.
    fn reach_of(&self, top: usize, terms: usize, step: f64, jet: &RigJet<S>) -> f64 {
        let (rates, angles): (&[usize], &[usize]) = if self.rig.disc1.is_some() {
            (&[OMEGA, OMEGA3, CURRENT, OMEGA1], &[THETA, THETA3, THETA1])
        } else {
            (&[OMEGA, OMEGA3, CURRENT], &[THETA, THETA3])
        };
        let (mut whole, mut last) = (S::ZERO, S::ZERO);
        for &place in angles {
            whole.enlarge(1.0, &jet.states[place][0]);
        }
        for &place in rates {
            let series = &jet.states[place];
            let mut power = 1.0;
            for c in &series[..terms] {
                whole.enlarge(power, c);
                power *= step;
            }
            last.enlarge(1.0, &series[top - 1]);
            last.enlarge(step, &series[top]);
        }
        if let Some(fading) = &jet.fading {
            for c in fading.amplitude() {
                whole.enlarge(1.0, c);
            }
        }
        let share = last.largest_share(&whole);
        libm::exp(-libm::log(share / self.accuracy()) / (top - 1) as f64)
    }

    /// As [`Self::judge`] for a series of all orders, which carries the fast modes: the derivatives' may be much livelier than
    /// the motion, and right behind a switch any number of their terms may vanish, so that their size is that of their largest
    /// term within the reach itself.
    pub fn judge_full(&mut self, order: usize, jet: &RigJet<S>) {
        self.expected = self.expected_order(order, 1.0);
        let mut reach = self.step;
        for _ in 0..MOST_LOOKS {
            let within = self.reach_of(order, order - 1, reach, jet);
            if within >= reach {
                break;
            }
            reach = within;
        }
        self.reach = reach;
    }

    /// Finds the coefficients of the variational equations up to order `top` of the motion in `self.jet`,
    /// whose states are known up to order `known`; `jet` holds inputs and loads with their derivatives.
    pub fn linearise(
        &mut self,
        mode: &RigMode,
        inputs: &RigInputs<S>,
        (top, known): (usize, usize),
        jet: &RigJet<S>,
    ) {
        self.collect(mode, top, known);
        let used = if self.rig.disc1.is_some() {
            &[ON_DISC, ON_MOTOR, ON_CIRCUIT, ON_DISC_1][..]
        } else {
            &[ON_DISC, ON_MOTOR, ON_CIRCUIT][..]
        };
        for &row in used {
            self.forcing[row][..=top].fill(S::ZERO);
        }
        let x = &self.jet.states;
        let parts = &self.jet.parts;
        let [disc, disc_1] = &mut self.pins;
        let segment = PinSegment {
            mode: mode.disc,
            law: &self.rig.law,
            inverse_inertia: parts.inverse_inertia,
            theta: &x[THETA],
            omega: &x[OMEGA],
            plain: &self.jet.disc,
            load: &jet.disc,
        };
        disc.follow(&segment, ON_DISC, top, &mut self.forcing);
        if disc.is_driven() {
            self.parameter_forcings
                .add_to(ON_DISC, top, &self.motion, &mut self.forcing);
            self.forcing[ON_DISC][0] += S::combined([(parts.inverse_inertia, &inputs.disc_torque)]);
        }
        if let (Some(disc1), Some(plain), Some(load)) =
            (&self.rig.disc1, &self.jet.disc1, &jet.disc1)
        {
            let segment = PinSegment {
                mode: mode.disc1,
                law: &disc1.law,
                inverse_inertia: parts.inverse_inertia_1,
                theta: &x[THETA1],
                omega: &x[OMEGA1],
                plain,
                load,
            };
            disc_1.follow(&segment, ON_DISC_1, top, &mut self.forcing);
            if disc_1.is_driven() {
                self.parameter_forcings
                    .add_to(ON_DISC_1, top, &self.motion, &mut self.forcing);
            }
        }
        if !mode.motor.is_stuck() {
            self.parameter_forcings
                .add_to(ON_MOTOR, top, &self.motion, &mut self.forcing);
            self.forcing[ON_MOTOR][0] +=
                S::combined([(parts.inverse_motor_inertia, &inputs.motor_torque)]);
        }
        self.parameter_forcings
            .add_to(ON_CIRCUIT, top, &self.motion, &mut self.forcing);
        for k in 0..INPUT_TERMS.min(top + 1) {
            if jet.voltage[k].varies() {
                self.forcing[ON_CIRCUIT][k] +=
                    S::combined([(parts.inverse_inductance, &jet.voltage[k])]);
            }
        }
    }

    /// Collects the series with which parameters enter.
    fn collect(&mut self, mode: &RigMode, top: usize, known: usize) {
        let x = &self.jet.states;
        let differences = [
            (Along::Twist, THETA, THETA3),
            (Along::Rate, OMEGA, OMEGA3),
            (Along::Twist1, THETA1, THETA),
            (Along::Rate1, OMEGA1, OMEGA),
        ];
        for (along, a, b) in differences {
            if self.parameter_forcings.uses(along) {
                let series = &mut self.motion[along.position()];
                for k in 0..=top {
                    series[k] = x[a][k] - x[b][k];
                }
            }
        }
        for (along, place) in [(Along::MotorSpeed, OMEGA3), (Along::Current, CURRENT)] {
            if self.parameter_forcings.uses(along) {
                self.motion[along.position()] = x[place];
            }
        }
        for (row, place) in [
            (ON_DISC, OMEGA),
            (ON_DISC_1, OMEGA1),
            (ON_MOTOR, OMEGA3),
            (ON_CIRCUIT, CURRENT),
        ] {
            let along = Along::Rates(row);
            if self.parameter_forcings.uses(along) {
                let series = &mut self.motion[along.position()];
                series[top] = 0.0;
                for k in 0..known.min(top + 1) {
                    series[k] = (k + 1) as f64 * x[place][k + 1];
                }
            }
        }
        self.motion[Along::MotorDirection.position()][0] = match mode.motor {
            ContactMode::Stuck => 0.0,
            ContactMode::Breaking(direction) | ContactMode::Slipping(direction, _) => {
                direction.sign()
            }
        };
    }

    /// Puts the orders beyond `top` into `jet`, where the derivatives no longer tell.
    pub fn rest(&self, top: usize, order: usize, jet: &mut RigJet<S>) {
        for k in top + 1..=order {
            for (series, plain) in jet.states.iter_mut().zip(&self.jet.states) {
                series[k] = S::constant(plain[k]);
            }
        }
    }
}
