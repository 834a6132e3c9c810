//! A run of a hybrid system: segment after segment, each a polynomial that holds until the next switch.

use super::step_size::from_last_terms;
use super::{HybridSystem, IntegrationError, Statistics};
use crate::series::{
    Scalar, Series, TERMS, evaluate, evaluate_derivative, first_loss_of_sign, lower_bound,
};

use std::ops::RangeInclusive;

/// Switches at one instant (within [`INSTANT`]) that count as chattering.
const CHATTERING: u32 = 200;
/// Time [s] below which switches count as simultaneous.
const INSTANT: f64 = 1e-10;
/// Relative size below which a leading coefficient of the guard that was just crossed is rounding.
const ROUNDING: f64 = 1e-11;
/// The same for a negative coefficient: what a switch leaves behind is a small difference of large
/// terms, such as the torque of a shaft whose two angles have grown for minutes. Taken at its word it
/// would undo the switch, and the next rounding would do it again.
const NEGATIVE_ROUNDING: f64 = 1e-8;

/// Depth, in tolerances, to which a guard has to dip below zero to have been crossed and not just
/// touched: whether such a switch happens is beyond the accuracy of the run.
const GRAZING: f64 = 10.0;

/// Share of the tolerance for segments without fast transients: they are as long as it allows, where
/// the others are kept short, and so more accurate, by the fast modes.
pub(crate) const SETTLED_SHARE: f64 = 0.01;

/// Orders that the recurrences can carry: they write one coefficient beyond the last.
const ORDERS: RangeInclusive<usize> = 4..=TERMS - 2;

/// How a run is computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Local error of a segment, absolute for angles (rad), relative to 1 + |x| for the rest.
    pub tolerance: f64,
    /// Order of the Taylor polynomials, 4 to `TERMS` − 2.
    pub order: usize,
    /// Longest segment [s].
    pub longest_step: f64,
    /// Segments that one call may spend.
    pub budget: u64,
}

impl Options {
    /// The tolerance of a run that asks for none; the FMUs state it in their default experiment.
    pub const DEFAULT_TOLERANCE: f64 = 1e-10;
}

impl Default for Options {
    fn default() -> Self {
        Self {
            tolerance: Self::DEFAULT_TOLERANCE,
            order: 21,
            longest_step: 1.0,
            budget: 50_000_000,
        }
    }
}

/// Why a segment ends.
#[derive(Clone, Copy, Debug, PartialEq)]
enum End<K> {
    /// The polynomial is used up.
    Step,
    /// A guard is lost.
    Switch(K),
    /// A branch of the right-hand side ends.
    Fold,
}

/// One polynomial piece of the motion.
#[derive(Clone, Debug)]
pub struct Segment<S, J> {
    /// Start [s]; carries derivatives if the switch before it does.
    pub start: S,
    /// Length [s].
    pub length: S,
    /// Its series.
    pub jet: J,
}

/// A switch that happened or is about to happen at the end of the present segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SwitchEvent<K> {
    /// When [s].
    pub time: f64,
    /// Which guard is lost; `None` for a jump between branches.
    pub guard: Option<K>,
}

/// Everything that a run needs to go on, as values.
#[derive(Clone, Debug)]
pub struct Snapshot<S, M, X, U> {
    /// Start of the present segment [s].
    pub start: S,
    /// State at the start of the segment.
    pub state: X,
    /// Mode in the segment.
    pub mode: M,
    /// Inputs in force.
    pub inputs: U,
    /// Whether the segment begins right behind a switch.
    pub departing: bool,
    /// Counters.
    pub statistics: Statistics,
}

/// A run of the system `P` over numbers `S`.
#[derive(Clone, Debug)]
pub struct Simulation<S: Scalar, P: HybridSystem<S>> {
    system: P,
    options: Options,
    inputs: P::Inputs,
    mode: P::Mode,
    state: P::State,
    start: S,
    length: S,
    end: End<P::GuardKind>,
    departing: bool,
    jet: P::Jet,
    /// For what guards depend on; only with derivatives.
    spare: Option<Box<P::Jet>>,
    statistics: Statistics,
    instant: f64,
    simultaneous: u32,
    expanded: bool,
}

impl<S: Scalar, P: HybridSystem<S>> Simulation<S, P> {
    /// A run that starts at `time` [s] from `state`.
    pub fn new(
        system: P,
        options: Options,
        time: f64,
        state: P::State,
        inputs: P::Inputs,
    ) -> Result<Self, IntegrationError> {
        if !ORDERS.contains(&options.order) {
            return Err(IntegrationError::OrderOutOfRange {
                order: options.order,
                lowest: *ORDERS.start(),
                highest: *ORDERS.end(),
            });
        }
        let mut jet = system.new_jet();
        let spare = S::HAS_DERIVATIVES.then(|| Box::new(system.new_jet()));
        let mut state = state;
        let start = S::constant(time);
        let mode = system.initial_mode(start, &mut state, &inputs, &mut jet);
        let mut simulation = Self {
            system,
            options,
            inputs,
            mode,
            state,
            start,
            length: S::ZERO,
            end: End::Step,
            departing: false,
            jet,
            spare,
            statistics: Statistics::default(),
            instant: time,
            simultaneous: 0,
            expanded: false,
        };
        simulation.expand()?;
        Ok(simulation)
    }

    /// The system.
    pub fn system(&self) -> &P {
        &self.system
    }

    /// Inputs in force.
    pub fn inputs(&self) -> &P::Inputs {
        &self.inputs
    }

    /// Mode within the present segment.
    pub fn mode(&self) -> &P::Mode {
        &self.mode
    }

    /// Series of the present segment.
    pub fn jet(&self) -> &P::Jet {
        &self.jet
    }

    /// Start of the present segment [s].
    pub fn segment_start(&self) -> S {
        self.start
    }

    /// End of the present segment [s].
    #[inline(always)]
    pub fn segment_end(&self) -> f64 {
        self.start.value() + self.length.value()
    }

    /// Counters of the run.
    pub fn statistics(&self) -> Statistics {
        self.statistics
    }

    /// The switch that ends the present segment, if one does.
    pub fn pending_switch(&self) -> Option<SwitchEvent<P::GuardKind>> {
        let time = self.segment_end();
        match self.end {
            End::Step => None,
            End::Switch(guard) => Some(SwitchEvent {
                time,
                guard: Some(guard),
            }),
            End::Fold => Some(SwitchEvent { time, guard: None }),
        }
    }

    /// Runs on until the present segment covers `time` [s].
    pub fn advance_to(&mut self, time: f64) -> Result<(), IntegrationError> {
        let first = self.statistics.segments;
        while self.segment_end() < time {
            if self.statistics.segments - first >= self.options.budget {
                return Err(IntegrationError::BudgetExhausted {
                    segments: self.options.budget,
                    target: time,
                    time: self.segment_end(),
                    mode: self.system.describe(&self.mode),
                });
            }
            self.next_segment()?;
        }
        Ok(())
    }

    /// Goes to the next segment, through the switch that ends the present one if there is one.
    pub fn next_segment(&mut self) -> Result<(), IntegrationError> {
        let tau = self.length;
        let end = self.end;
        let state = self.state_after(tau);
        self.mode = self.system.carry(&self.mode, &self.jet, tau.value());
        self.state = state;
        self.start += tau;
        self.departing = false;
        match end {
            End::Step => {}
            End::Switch(guard) => {
                self.mode = self.system.switch(
                    &self.mode,
                    guard,
                    self.start,
                    &mut self.state,
                    &self.inputs,
                    // The segment in it is used up: its state and its memory were carried over above.
                    &mut self.jet,
                );
                self.statistics.switches += 1;
                self.departing = true;
                self.count_simultaneous()?;
            }
            End::Fold => {
                self.mode = self.system.leave_fold(&self.mode, &self.jet);
                self.statistics.switches += 1;
                self.statistics.branch_jumps += 1;
                self.count_simultaneous()?;
            }
        }
        self.expand()
    }

    fn count_simultaneous(&mut self) -> Result<(), IntegrationError> {
        let now = self.start.value();
        if now - self.instant > INSTANT {
            self.instant = now;
            self.simultaneous = 0;
        }
        self.simultaneous += 1;
        if self.simultaneous > CHATTERING {
            return Err(IntegrationError::Chattering {
                time: now,
                mode: self.system.describe(&self.mode),
                switches: self.simultaneous,
                span: now - self.instant,
            });
        }
        Ok(())
    }

    /// State at `time` [s], which the present segment must cover.
    #[inline]
    pub fn state_at(&self, time: f64) -> P::State {
        self.state_after(S::constant(time) - self.start)
    }

    /// Component `index` of the state at `time` [s], which the present segment must cover.
    #[inline]
    pub fn component_at(&self, index: usize, time: f64) -> S {
        let order = self.options.order;
        evaluate(
            &self.system.states(&self.jet)[index][..=order],
            S::constant(time) - self.start,
        )
    }

    fn state_after(&self, tau: S) -> P::State {
        let mut state = self.state;
        let order = self.options.order;
        evaluate_all(self.system.states(&self.jet), order, tau, state.as_mut());
        state
    }

    /// Replaces the inputs from `time` [s] on; what was computed beyond is discarded.
    pub fn set_inputs(&mut self, time: f64, inputs: P::Inputs) -> Result<(), IntegrationError> {
        self.cut(time)?;
        self.inputs = inputs;
        self.expand()
    }

    /// Goes on from `time` [s] in the same mode with other inputs and with the state that `change`
    /// makes of the present one; what was computed beyond is discarded.
    pub fn continue_from(
        &mut self,
        time: f64,
        inputs: P::Inputs,
        change: impl FnOnce(&mut P::State),
    ) -> Result<(), IntegrationError> {
        self.cut(time)?;
        self.inputs = inputs;
        change(&mut self.state);
        self.expand()
    }

    /// Replaces the system from `time` [s] on, for example after a parameter changed; what was
    /// computed beyond is discarded.
    pub fn set_system(&mut self, time: f64, system: P) -> Result<(), IntegrationError> {
        self.cut(time)?;
        self.jet = system.new_jet();
        self.spare = S::HAS_DERIVATIVES.then(|| Box::new(system.new_jet()));
        self.system = system;
        self.expand()
    }

    /// Replaces the state at `time` [s] and finds its mode anew.
    pub fn set_state(&mut self, time: f64, state: P::State) -> Result<(), IntegrationError> {
        self.state = state;
        self.start = S::constant(time);
        self.departing = false;
        self.mode =
            self.system
                .initial_mode(self.start, &mut self.state, &self.inputs, &mut self.jet);
        self.expand()
    }

    /// Begins a new segment at `time` within the present one, in the same mode.
    fn cut(&mut self, time: f64) -> Result<(), IntegrationError> {
        self.advance_to(time)?;
        let tau = S::constant(time) - self.start;
        if tau.value() < -1e-9 {
            return Err(IntegrationError::BackInTime {
                time,
                start: self.start.value(),
            });
        }
        if tau.value() < self.length.value() {
            self.statistics.discarded += 1;
        }
        let state = self.state_after(tau);
        self.mode = self.system.carry(&self.mode, &self.jet, tau.value());
        self.state = state;
        self.start = S::constant(time);
        self.departing = false;
        Ok(())
    }

    /// Goes on from the start of the present segment in another mode, for a caller who knows more
    /// than the state tells: which of several branches the motion is on.
    pub fn set_mode(&mut self, mode: P::Mode) -> Result<(), IntegrationError> {
        self.mode = mode;
        self.expand()
    }

    /// What is needed to go on from here.
    pub fn snapshot(&self) -> Snapshot<S, P::Mode, P::State, P::Inputs> {
        Snapshot {
            start: self.start,
            state: self.state,
            mode: self.mode,
            inputs: self.inputs.clone(),
            departing: self.departing,
            statistics: self.statistics,
        }
    }

    /// Goes back (or on) to a snapshot: the segment is computed again, bit for bit the same.
    pub fn restore(
        &mut self,
        snapshot: &Snapshot<S, P::Mode, P::State, P::Inputs>,
    ) -> Result<(), IntegrationError> {
        self.start = snapshot.start;
        self.state = snapshot.state;
        self.mode = snapshot.mode;
        self.inputs = snapshot.inputs.clone();
        self.departing = snapshot.departing;
        self.instant = snapshot.start.value();
        self.simultaneous = 0;
        self.expand()?;
        self.statistics = snapshot.statistics;
        Ok(())
    }

    /// Computes the segment that starts at `start` and finds its end.
    fn expand(&mut self) -> Result<(), IntegrationError> {
        let order = self.options.order;
        let settled = !self.departing
            && self.system.expand_without_transients(
                &self.mode,
                self.start,
                &self.state,
                &self.inputs,
                order,
                self.options.tolerance,
                &mut self.jet,
            );
        if !settled {
            self.system.expand(
                &self.mode,
                self.start,
                &self.state,
                &self.inputs,
                order,
                &mut self.jet,
            );
        }
        self.statistics.segments += 1;
        let mut step = self.step_length(if settled { SETTLED_SHARE } else { 1.0 });
        if step.is_nan() {
            return Err(self.overflow());
        }
        step = step.min(self.system.reach(&self.jet));
        self.end = End::Step;
        if let Some(tau) = self.system.fold(&self.jet) {
            if tau <= step {
                step = tau;
                self.end = End::Fold;
            } else {
                // The series does not converge beyond; which root comes next must stay certain.
                step = step.min(0.5 * tau);
            }
        }
        let reach = step;
        let mut lost = None;
        for (position, guard) in self.system.guards(&self.jet).iter().enumerate() {
            if lower_bound(&guard.series[..=order], step) > 0.0 && !self.departing {
                continue;
            }
            let series = &guard.series[..=order];
            // Bounds that are not finite would exclude nothing, and the search would never end.
            if !evaluate(&guard.series.map(f64::abs)[..=order], reach).is_finite() {
                return Err(self.overflow());
            }
            // Of guards that are lost together the first counts: the next segment looks at the others.
            if let Some(tau) = loss(series, reach, step, self.departing)
                && (tau < step || lost.is_none())
            {
                step = tau;
                lost = Some(position);
            }
        }
        let floor = 4.0 * f64::EPSILON * self.start.value().abs().max(1e-3);
        if step < floor && lost.is_none() && self.end == End::Step {
            return Err(IntegrationError::StepTooSmall {
                time: self.start.value(),
                step,
                mode: self.system.describe(&self.mode),
            });
        }
        self.length = S::constant(step);
        if let Some(position) = lost {
            let guard = &self.system.guards(&self.jet)[position];
            let kind = guard.kind;
            self.end = End::Switch(kind);
            let series = &guard.series[..=order];
            let slope = evaluate_derivative(series, step);
            let size = series[0].abs().max(1e-3);
            let bend = second_derivative(series, step).max(0.0);
            // It dips below zero by slope²/(2 bend) before it rises again.
            let depth = GRAZING * self.options.tolerance * size;
            if slope * slope > 2.0 * bend * depth && slope.abs() > 1e-9 * size {
                self.move_switch(kind, step, slope);
            } else {
                self.statistics.grazing += 1;
            }
        }
        self.expanded = true;
        Ok(())
    }

    /// Lets the instant of the switch at local time `tau` depend on whatever its guard, which falls with
    /// `slope`, depends on.
    fn move_switch(&mut self, guard: P::GuardKind, tau: f64, slope: f64) {
        let state = self.state_after(S::constant(tau));
        let Some(spare) = &mut self.spare else {
            return;
        };
        let value = self.system.guard_at(
            &self.mode,
            guard,
            &self.jet,
            tau,
            self.start + tau,
            &state,
            &self.inputs,
            spare,
        );
        self.length = S::constant(tau) - (value - value.value()) * (1.0 / slope);
    }

    /// Coefficients overflow where a time constant is extremely short or an input absurdly large.
    #[cold]
    fn overflow(&self) -> IntegrationError {
        let (time, mode) = (self.start.value(), self.system.describe(&self.mode));
        if self.state.as_ref().iter().all(|x| x.value().is_finite()) {
            IntegrationError::StepTooSmall {
                time,
                step: 0.0,
                mode,
            }
        } else {
            IntegrationError::NotFinite { time, mode }
        }
    }

    fn step_length(&self, share: f64) -> f64 {
        let order = self.options.order;
        let (mut last, mut before) = (0.0_f64, 0.0_f64);
        for (index, series) in self.system.states(&self.jet).iter().enumerate() {
            let size = if self.system.is_coordinate(index) {
                1.0
            } else {
                1.0 + series[0].value().abs()
            };
            last = larger(last, series[order].value().abs() / size);
            before = larger(before, series[order - 1].value().abs() / size);
        }
        if last.is_nan() || before.is_nan() {
            return f64::NAN;
        }
        let tolerance = share * self.options.tolerance;
        from_last_terms(last / tolerance, before / tolerance, order).min(self.options.longest_step)
    }
}

/// Values at `tau` of several polynomials of the same order, computed side by side.
#[inline]
fn evaluate_all<S: Scalar>(series: &[Series<S>], order: usize, tau: S, values: &mut [S]) {
    let (blocks, rest) = series.as_chunks::<5>();
    let mut left = values;
    for block in blocks {
        let Some((now, later)) = left.split_first_chunk_mut::<5>() else {
            return;
        };
        *now = std::array::from_fn(|j| evaluate(&block[j][..=order], tau));
        left = later;
    }
    for (value, series) in left.iter_mut().zip(rest) {
        *value = evaluate(&series[..=order], tau);
    }
}

/// Second derivative of the polynomial with these coefficients at `tau`.
fn second_derivative(coefficients: &[f64], tau: f64) -> f64 {
    let mut sum = 0.0;
    for (k, c) in coefficients.iter().enumerate().skip(2).rev() {
        sum = sum * tau + c * (k * (k - 1)) as f64;
    }
    sum
}

/// The larger of two numbers; not a number if either is not.
#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() {
        f64::NAN
    } else {
        a.max(b)
    }
}

/// Local time within `width` at which a guard is lost. Right behind a switch (`departing`) a guard may
/// start at zero: leading coefficients that are only rounding over the length `reach`, on which the
/// series is good, are divided out. A guard that is lost by more than that is lost at once.
fn loss(series: &[f64], reach: f64, width: f64, departing: bool) -> Option<f64> {
    let mut series = series;
    if departing || series[0] == 0.0 {
        let mut size = 0.0;
        let mut power = 1.0;
        for c in series {
            size += c.abs() * power;
            power *= reach;
        }
        let mut power = 1.0;
        let is_rounding = |c: f64, power: f64| {
            let limit = if c < 0.0 && departing {
                NEGATIVE_ROUNDING
            } else {
                ROUNDING
            };
            c.abs() * power <= limit * size
        };
        while series.len() > 1 && is_rounding(series[0], power) {
            series = &series[1..];
            power *= reach;
        }
        if series.len() == 1 && series[0] == 0.0 {
            return None;
        }
    }
    first_loss_of_sign(series, width)
}
