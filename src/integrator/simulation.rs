//! A run of a hybrid system: segment after segment, each a polynomial that holds until the next switch.

use super::options::ORDERS;
use super::piece::End;
use super::{HybridSystem, IntegrationError, Options, Snapshot, Statistics, SwitchEvent};
use crate::series::{Scalar, Series, evaluate};

/// Switches at one instant (within [`INSTANT`]) that count as chattering.
const CHATTERING: u32 = 200;
/// Time [s] below which switches count as simultaneous.
const INSTANT: f64 = 1e-10;

/// A run of the system `P` over numbers `S`.
#[derive(Clone, Debug)]
pub struct Simulation<S: Scalar, P: HybridSystem<S>> {
    pub(super) system: P,
    pub(super) options: Options,
    pub(super) inputs: P::Inputs,
    pub(super) mode: P::Mode,
    pub(super) state: P::State,
    pub(super) start: S,
    pub(super) length: S,
    pub(super) end: End<P::GuardKind>,
    pub(super) departing: bool,
    pub(super) jet: P::Jet,
    /// For what guards depend on; only with derivatives.
    pub(super) spare: Option<Box<P::Jet>>,
    pub(super) statistics: Statistics,
    pub(super) instant: f64,
    pub(super) simultaneous: u32,
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
        };
        simulation.expand()?;
        Ok(simulation)
    }

    /// Begins another run of the same system, the same to the last bit as a new one but without what that costs before its
    /// first segment.
    pub fn start_over(
        &mut self,
        time: f64,
        state: P::State,
        inputs: P::Inputs,
    ) -> Result<(), IntegrationError> {
        self.system.forget(&mut self.jet);
        if let Some(spare) = &mut self.spare {
            self.system.forget(spare);
        }
        self.inputs = inputs;
        self.statistics = Statistics::default();
        self.instant = time;
        self.simultaneous = 0;
        self.set_state(time, state)
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
                self.mode = self
                    .system
                    .leave_fold(&self.mode, &mut self.state, &self.jet);
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
        self.component_after(index, S::constant(time) - self.start)
    }

    /// Component `index` of the state at local time `tau` [s] of the present segment.
    #[inline]
    pub fn component_after(&self, index: usize, tau: S) -> S {
        let order = self.options.order;
        let series = &self.system.states(&self.jet)[index];
        let mut component = evaluate(&series[..=order], tau);
        if let Some(beside) = self.system.beside_series(&self.jet, index, tau.value()) {
            component += beside;
        }
        component
    }

    pub(super) fn state_after(&self, tau: S) -> P::State {
        let mut state = self.state;
        let order = self.options.order;
        evaluate_all(self.system.states(&self.jet), order, tau, state.as_mut());
        if S::HAS_DERIVATIVES {
            for (index, component) in state.as_mut().iter_mut().enumerate() {
                if let Some(beside) = self.system.beside_series(&self.jet, index, tau.value()) {
                    *component += beside;
                }
            }
        }
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
        // Where nothing has passed, the segment is not asked: inputs that are taken back may have made it overflow.
        if S::HAS_DERIVATIVES || tau.value() != 0.0 {
            let state = self.state_after(tau);
            self.mode = self.system.carry(&self.mode, &self.jet, tau.value());
            self.state = state;
        }
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
