//! The course of a body as a component has it, with what it tells the log.

use super::part::STARTS;
use super::state::{read_snapshot, write_snapshot};
use super::variables::Signal;
use crate::body::{Body, INPUTS, Inputs, Motion};
use crate::cosim;
use crate::cosim::input_signals::InputSignals;
use crate::cosim::part::{self, Known, read_parameters, write_parameters};
use crate::cosim::segments::{self, Segments, time_derivative};
use crate::cosim::{ModelError, StateError, StateReader, StateWriter, StepEnd};
use crate::integrator::{HybridSystem, IntegrationError, Options, Simulation};
use crate::series::{Dual, Scalar, evaluate};
use std::fmt;

/// What a body tells the log.
struct Notice {
    time: f64,
    sticks: bool,
}

impl cosim::Notice for Notice {
    fn time(&self) -> f64 {
        self.time
    }

    fn what(&self) -> String {
        if self.sticks {
            "the body sticks"
        } else {
            "the body breaks away"
        }
        .to_owned()
    }
}

impl fmt::Display for Notice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "t = {} s: {}", self.time, cosim::Notice::what(self))
    }
}

/// A body's run with its notices.
pub(in crate::cosim) struct Course {
    run: Simulation<f64, Body<f64>>,
    notices: Vec<Notice>,
}

impl Course {
    fn new(
        body: Body<f64>,
        tolerance: Option<f64>,
        time: f64,
        state: [f64; STARTS],
        inputs: Inputs,
    ) -> Result<Self, IntegrationError> {
        let default = Options::default();
        let options = Options {
            tolerance: tolerance.unwrap_or(default.tolerance),
            ..default
        };
        Ok(Self {
            run: Simulation::new(body, options, time, state, inputs)?,
            notices: Vec::new(),
        })
    }

    fn sticks(&self) -> bool {
        self.run.mode().motion == Motion::Sticks
    }

    fn series(&self, signal: Signal) -> Option<&[f64]> {
        let jet = self.run.jet();
        let series = match signal {
            Signal::Position => &self.run.system().states(jet)[0],
            Signal::Velocity => &self.run.system().states(jet)[1],
            Signal::Friction => &jet.friction,
            Signal::Acceleration => &jet.acceleration,
            Signal::Stuck => return None,
        };
        series.get(..=Options::default().order)
    }
}

impl Segments for Course {
    fn begin(&self) -> f64 {
        self.run.segment_start()
    }

    fn end(&self) -> f64 {
        self.run.segment_end()
    }

    fn next(&mut self) -> Result<bool, IntegrationError> {
        let before = self.sticks();
        self.run.next_segment()?;
        let sticks = self.sticks();
        if sticks != before {
            let time = self.run.segment_start();
            self.notices.push(Notice { time, sticks });
        }
        Ok(sticks != before)
    }
}

/// The inputs that the signals are from `now` [s] on.
fn inputs(signals: &InputSignals<INPUTS>, now: f64) -> Inputs {
    Inputs {
        time: now,
        polynomials: signals.centred(now).polynomials,
    }
}

impl part::Course<INPUTS, STARTS> for Course {
    type Part = Body<f64>;

    fn start(
        body: &Body<f64>,
        tolerance: Option<f64>,
        time: f64,
        values: &[f64; STARTS],
        signals: &InputSignals<INPUTS>,
    ) -> Result<Self, ModelError> {
        Self::new(*body, tolerance, time, *values, inputs(signals, time))
            .map_err(|error| refused(&error, body))
    }

    fn change(
        &mut self,
        body: &Body<f64>,
        signals: &InputSignals<INPUTS>,
        now: f64,
    ) -> Result<bool, ModelError> {
        let explained = |error: IntegrationError| refused(&error, body);
        let in_force = self.run.inputs();
        let in_force = InputSignals::new(in_force.time, in_force.polynomials);
        let next = inputs(signals, now);
        let other_inputs = inputs(&in_force, now) != next;
        let other_body = body != self.run.system();
        if other_body {
            body.check().map_err(ModelError::from_display)?;
            self.run.set_system(now, *body).map_err(explained)?;
        }
        if other_inputs {
            self.run.set_inputs(now, next).map_err(explained)?;
        }
        let mut switched = false;
        while (other_body || other_inputs) && self.run.segment_end() <= now {
            switched |= self.next().map_err(explained)?;
        }
        Ok(switched)
    }

    #[inline]
    fn covers(&mut self, until: f64) -> bool {
        until <= self.run.segment_end()
    }

    fn advance(
        &mut self,
        begin: f64,
        until: f64,
        stop_at_switch: bool,
    ) -> Result<StepEnd, ModelError> {
        segments::advance(
            self,
            begin,
            until,
            stop_at_switch,
            "inertia, stiffness and drag",
        )
    }

    fn reached(&self) -> f64 {
        self.run.segment_start()
    }

    fn signal(&self, signal: Signal, order: u32, time: f64) -> Option<f64> {
        let (series, tau) = (self.series(signal)?, time - self.run.segment_start());
        Some(match order {
            0 => evaluate(series, tau),
            order => time_derivative(series, order as usize, tau),
        })
    }

    fn flag(&self, signal: Signal) -> Option<bool> {
        (signal == Signal::Stuck).then(|| self.sticks())
    }

    fn partial(&self, unknown: Signal, known: Known, time: f64) -> Result<Option<f64>, ModelError> {
        let mut body = self.run.system().to_scalar::<Dual<1>>();
        let held = self.run.inputs();
        let signals = InputSignals::new(held.time, held.polynomials);
        let mut inputs: [Dual<1>; INPUTS] =
            std::array::from_fn(|place| Dual::constant(signals.value(place, time)));
        match known {
            Known::Input(place) => inputs[place].derivative = [1.0],
            Known::Parameter(position) => {
                let value = body.parameter_at(position).map_or(0.0, Scalar::value);
                body.set_parameter_at(position, Dual::variable(value, 0))
                    .map_err(ModelError::from_display)?;
            }
        }
        let state = self.run.state_at(time).map(Dual::constant);
        let jet = body.instant(self.run.mode(), time, state, inputs);
        Ok(match unknown {
            // Its states, which are held.
            Signal::Position | Signal::Velocity => Some(0.0),
            Signal::Friction => Some(jet.friction[0].derivative[0]),
            Signal::Acceleration => Some(jet.acceleration[0].derivative[0]),
            Signal::Stuck => None,
        })
    }

    fn drain_notices(&mut self, tell: &mut dyn FnMut(&dyn cosim::Notice)) {
        self.notices.drain(..).for_each(|notice| tell(&notice));
    }

    fn save(&self, state: &mut StateWriter) {
        write_parameters(self.run.system(), state);
        write_snapshot(&self.run.snapshot(), state);
    }

    fn restore(
        original: &Body<f64>,
        tolerance: Option<f64>,
        state: &mut StateReader<'_>,
    ) -> Result<Self, StateError> {
        let content = |error: IntegrationError| StateError::Content(error.to_string());
        let body = read_parameters(original, state)?;
        let snapshot = read_snapshot(state)?;
        let (start, inputs) = (snapshot.start, snapshot.inputs);
        let mut course =
            Self::new(body, tolerance, start, snapshot.state, inputs).map_err(content)?;
        course.run.restore(&snapshot).map_err(content)?;
        Ok(course)
    }
}

/// Why a run cannot begin or go on.
fn refused(error: &IntegrationError, body: &Body<f64>) -> ModelError {
    let reacting: Vec<&str> = body.reacting().collect();
    if reacting.is_empty() {
        return ModelError::from_display(error);
    }
    ModelError(format!(
        "{error}; the inertia must outweigh what grows with the acceleration: {}",
        reacting.join(", ")
    ))
}
