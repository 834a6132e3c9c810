//! A controller at the instant that the importer names: what it computes there, and its mode.

use super::notice::Notice;
use super::part::{FILTERED_TORQUE, INTEGRAL, STARTS};
use super::state::{read_start, write_start};
use super::variables::{Signal, signal_at};
use crate::controller::{
    ControlLaw, CourseError, Gains, INPUTS, Input, Instant, MOST_INDICATORS, Mode, Start,
};
use crate::cosim::exchange::EventOutcome;
use crate::cosim::exchange_component::{self, Seeds};
use crate::cosim::part::{read_parameters, write_parameters};
use crate::cosim::{self, ModelError, StateError, StateReader, StateWriter};
use crate::series::{Dual, Scalar};

type States = [f64; STARTS];
type Number = Dual<1>;

/// The law with the mode that holds.
pub(in crate::cosim) struct Run {
    law: ControlLaw<f64>,
    gains: Gains<f64>,
    mode: Mode,
    time: f64,
    states: States,
    inputs: [f64; INPUTS],
    /// Whether inputs or parameters have jumped since the mode was looked at.
    jumped: bool,
    values: [f64; MOST_INDICATORS],
    notices: Vec<Notice>,
}

impl Run {
    fn instant(&self) -> Instant<f64> {
        instant(&self.gains, self.inputs, self.states)
    }
}

/// The instant of these inputs and states.
fn instant<S: Scalar>(gains: &Gains<S>, inputs: [S; INPUTS], states: [S; STARTS]) -> Instant<S> {
    Instant::new(gains, inputs, states[INTEGRAL], states[FILTERED_TORQUE])
}

impl exchange_component::Run<INPUTS, STARTS> for Run {
    type Part = ControlLaw<f64>;

    fn places(law: &ControlLaw<f64>) -> Vec<usize> {
        let filter = law.has(Input::Current).then_some(FILTERED_TORQUE);
        std::iter::once(INTEGRAL).chain(filter).collect()
    }

    fn start(
        law: &ControlLaw<f64>,
        time: f64,
        states: States,
        inputs: [f64; INPUTS],
    ) -> Result<Self, ModelError> {
        law.check().map_err(ModelError::from_display)?;
        let mut run = Self {
            law: *law,
            gains: law.gains(),
            mode: Mode::Within,
            time,
            states,
            inputs,
            jumped: true,
            values: [1.0; MOST_INDICATORS],
            notices: Vec::new(),
        };
        run.update()?;
        run.notices.clear();
        Ok(run)
    }

    fn part(&self) -> &ControlLaw<f64> {
        &self.law
    }

    fn set_part(&mut self, law: &ControlLaw<f64>) -> Result<(), ModelError> {
        law.check().map_err(ModelError::from_display)?;
        (self.law, self.gains, self.jumped) = (*law, law.gains(), true);
        Ok(())
    }

    fn set_time(&mut self, time: f64) {
        self.time = time;
    }

    fn set_input(&mut self, place: usize, value: f64, at_event: bool) {
        self.jumped |= at_event && self.inputs[place].to_bits() != value.to_bits();
        self.inputs[place] = value;
    }

    fn states(&self) -> &States {
        &self.states
    }

    fn states_mut(&mut self) -> &mut States {
        &mut self.states
    }

    fn rates(&mut self) -> States {
        self.instant().rates(self.mode)
    }

    fn indicators(&mut self) -> &[f64] {
        self.values = self.instant().indicators(self.mode);
        &self.values[..self.gains.indicator_descriptions().count()]
    }

    fn real(&mut self, signal: Signal) -> Option<f64> {
        signal_at(&self.instant(), self.mode, signal)
    }

    fn flag(&self, signal: Signal) -> Option<bool> {
        (signal == Signal::Saturated).then(|| self.mode.limit().is_some())
    }

    fn update(&mut self) -> Result<EventOutcome, ModelError> {
        let (was, before) = (self.mode, self.states[INTEGRAL]);
        if std::mem::take(&mut self.jumped) {
            let [integral, filtered] = self.states;
            self.mode = Instant::wanted_mode(&self.gains, self.inputs, integral, filtered);
        }
        let mut changes = 0;
        loop {
            let (mode, integral) = self.instant().next(self.mode);
            if mode == self.mode {
                break;
            }
            (self.mode, self.states[INTEGRAL]) = (mode, integral);
            changes += 1;
            CourseError::check(changes, self.time, mode).map_err(ModelError::from_display)?;
        }
        self.notices
            .extend(Notice::of(&self.gains, was, self.mode, self.time));
        let states_changed = before.to_bits() != self.states[INTEGRAL].to_bits();
        Ok(EventOutcome { states_changed })
    }

    fn complete_step(&mut self) -> bool {
        self.indicators().iter().any(|indicator| *indicator <= 0.0)
    }

    fn directional(
        &mut self,
        unknowns: &[Signal],
        seeds: &Seeds<INPUTS, STARTS>,
    ) -> Result<Vec<f64>, ModelError> {
        let mut law = self.law.to_scalar::<Number>();
        for (position, seed) in &seeds.parameters {
            let value = self.law.parameter_at(*position).unwrap_or(0.0);
            law.set_parameter_at(*position, number(value, *seed))
                .map_err(ModelError::from_display)?;
        }
        let inputs = std::array::from_fn(|place| number(self.inputs[place], seeds.inputs[place]));
        let states = std::array::from_fn(|place| number(self.states[place], seeds.state[place]));
        let instant = instant(&law.gains(), inputs, states);
        let derivative = |signal: &Signal| {
            let number = signal_at(&instant, self.mode, *signal);
            number.map_or(0.0, |number| number.derivative[0])
        };
        Ok(unknowns.iter().map(derivative).collect())
    }

    fn drain_notices(&mut self, tell: &mut dyn FnMut(&dyn cosim::Notice)) {
        self.notices.drain(..).for_each(|notice| tell(&notice));
    }

    fn save(&self, state: &mut StateWriter) {
        write_parameters(&self.law, state);
        let start = Start {
            time: self.time,
            integral: self.states[INTEGRAL],
            filtered_torque: self.states[FILTERED_TORQUE],
            inputs: self.inputs.map(|value| [value, 0.0, 0.0, 0.0]),
            mode: Some(self.mode),
        };
        write_start(&start, state);
        state.flag(self.jumped);
    }

    fn restore(
        original: &ControlLaw<f64>,
        state: &mut StateReader<'_>,
    ) -> Result<Self, StateError> {
        let law = read_parameters(original, state)?;
        let start = read_start(state)?;
        Ok(Self {
            law,
            gains: law.gains(),
            mode: start.mode.unwrap_or(Mode::Within),
            time: start.time,
            states: [start.integral, start.filtered_torque],
            inputs: start.inputs.map(|polynomial| polynomial[0]),
            jumped: state.flag()?,
            values: [1.0; MOST_INDICATORS],
            notices: Vec::new(),
        })
    }
}

fn number(value: f64, derivative: f64) -> Number {
    Number {
        value,
        derivative: [derivative],
    }
}
