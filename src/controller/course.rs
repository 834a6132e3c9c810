//! The course of a controller over time, from event to event.

use super::gains::{Gains, INPUTS};
use super::instant::Instant;
use super::law::ControlLaw;
use super::limited::{Inputs, Mode, Next, Signals, at_start};
use super::signal::Signal;
use crate::parameter::ParameterError;
use crate::series::{Dual, Scalar, shifted};
use thiserror::Error;

/// Events at one instant after which the modes are taken to chase each other.
const EVENTS_AT_ONE_INSTANT: u32 = 32;

/// A controller that cannot go on.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum CourseError {
    /// Modes follow each other without time going on.
    #[error(
        "the controller changed between modes {EVENTS_AT_ONE_INSTANT} times at t = {time} s, now {mode:?}; \
         check its gains and limits"
    )]
    Chattering {
        /// Time [s].
        time: f64,
        /// The present mode.
        mode: Mode,
    },
}

impl CourseError {
    /// Refuses that many events at one instant, `time` [s], the last of them in `mode`.
    pub(crate) fn check(events: u32, time: f64, mode: Mode) -> Result<(), Self> {
        match events {
            EVENTS_AT_ONE_INSTANT.. => Err(Self::Chattering { time, mode }),
            _ => Ok(()),
        }
    }
}

/// Where a course begins, or where it is: all that its future depends on besides its law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    /// Time [s].
    pub time: f64,
    /// Integral [V].
    pub integral: f64,
    /// Filtered torque [N m]; 0 in a law without filter.
    pub filtered_torque: f64,
    /// Inputs from then on: coefficients of powers of the time since `time`.
    pub inputs: [[f64; 4]; INPUTS],
    /// Mode, where it is known; `None`: the one that the values want.
    pub mode: Option<Mode>,
}

/// The course of a controller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Course {
    law: ControlLaw<f64>,
    gains: Gains<f64>,
    start: Start,
    signals: Signals,
    /// Windows that were searched for an event since the start.
    searched: u32,
    /// The first event after the start [s since then], once it is found.
    event: Option<(f64, Next)>,
    /// Events at the instant of the start.
    at_once: u32,
}

impl Course {
    /// The course of a controller with this `law` from `start` on.
    pub fn new(law: ControlLaw<f64>, start: Start) -> Self {
        let gains = law.gains();
        let signals = Signals::new(
            &gains,
            &start.inputs,
            start.integral,
            start.filtered_torque,
            start.mode,
        );
        Self {
            law,
            gains,
            start: Start {
                mode: Some(signals.mode),
                ..start
            },
            signals,
            searched: 0,
            event: None,
            at_once: 0,
        }
    }

    /// The law in force.
    pub fn law(&self) -> &ControlLaw<f64> {
        &self.law
    }

    /// Where the present stretch began; a course from there is this one.
    pub fn start(&self) -> &Start {
        &self.start
    }

    /// The present mode.
    pub fn mode(&self) -> Mode {
        self.signals.mode
    }

    /// Voltage [V], and its time derivative of the given order, at `time` [s] of the present stretch.
    pub fn voltage(&self, order: u32, time: f64) -> f64 {
        self.read(self.signals.output(), order, time)
    }

    /// Integral [V], and its time derivative of the given order.
    pub fn integral(&self, order: u32, time: f64) -> f64 {
        self.read(self.signals.integral(), order, time)
    }

    /// Filtered torque [N m], and its time derivative of the given order.
    pub fn filtered_torque(&self, order: u32, time: f64) -> f64 {
        self.read(self.signals.filtered, order, time)
    }

    fn read(&self, signal: Signal, order: u32, time: f64) -> f64 {
        let derived = (0..order).fold(signal, |signal, _| signal.derivative());
        derived.value(time - self.start.time)
    }

    /// The same controller with another `law` and other `inputs` from `time` [s] on, which is in the
    /// present stretch.
    pub fn changed(&self, law: ControlLaw<f64>, inputs: Inputs, time: f64) -> Self {
        let start = Start {
            time,
            integral: self.integral(0, time),
            filtered_torque: self.filtered_torque(0, time),
            inputs,
            mode: None,
        };
        Self::new(law, start)
    }

    /// Whether an event comes up to `until` [s].
    pub fn has_event_until(&mut self, until: f64) -> bool {
        let rate = self.gains.filter_time.map_or(0.0, |time| 1.0 / time);
        while self.event.is_none()
            && self.start.time + Signal::window(rate, self.searched).0 <= until
        {
            self.event = self.signals.event_in_window(self.searched);
            self.searched += 1;
        }
        self.event
            .is_some_and(|(tau, _)| self.start.time + tau <= until)
    }

    /// Goes to the next event, which [`has_event_until`](Self::has_event_until) has found; the
    /// time [s] at which it is. Without an event nothing happens.
    ///
    /// # Errors
    /// Modes change without end.
    pub fn next_stretch(&mut self) -> Result<f64, CourseError> {
        let Some((tau, next)) = self.event else {
            return Ok(self.start.time);
        };
        let time = self.start.time + tau;
        let at_once = if time > self.start.time {
            0
        } else {
            self.at_once + 1
        };
        CourseError::check(at_once, time, self.mode())?;
        let mut start = Start {
            time,
            // At the event itself, which lies within a rounding error of `time`.
            integral: self.signals.integral().value(tau),
            filtered_torque: self.signals.filtered.value(tau),
            inputs: self
                .start
                .inputs
                .map(|polynomial| shifted(&polynomial, tau)),
            mode: Some(Mode::Within),
        };
        start.mode = Some(Self::new(self.law, start).signals.after(next));
        *self = Self {
            at_once,
            ..Self::new(self.law, start)
        };
        Ok(time)
    }

    /// The instant `time` [s] of the present stretch, and the mode.
    pub fn instant(&self, time: f64) -> (Instant<f64>, Mode) {
        let (integral, filtered) = (self.integral(0, time), self.filtered_torque(0, time));
        let inputs = self.inputs(time);
        (
            Instant::new(&self.gains, inputs, integral, filtered),
            self.mode(),
        )
    }

    fn inputs(&self, time: f64) -> [f64; INPUTS] {
        let tau = time - self.start.time;
        at_start(
            &self
                .start
                .inputs
                .map(|polynomial| shifted(&polynomial, tau)),
        )
    }

    /// The instant `time` [s] of the present stretch with partial derivatives with respect to input or parameter, the controller's
    /// own state held.
    ///
    /// # Errors
    /// No such parameter.
    pub fn partial(&self, known: Known, time: f64) -> Result<Instant<Dual<1>>, ParameterError> {
        let mut inputs = self.inputs(time).map(Dual::constant);
        let mut law = self.law.to_scalar::<Dual<1>>();
        match known {
            Known::Input(place) => {
                if let Some(input) = inputs.get_mut(place) {
                    input.derivative = [1.0];
                }
            }
            Known::Parameter(position) => {
                let value = self.law.parameter_at(position).unwrap_or(0.0);
                law.set_parameter_at(position, Dual::variable(value, 0))?;
            }
        }
        let [integral, filtered] =
            [self.integral(0, time), self.filtered_torque(0, time)].map(Dual::constant);
        Ok(Instant::new(&law.gains(), inputs, integral, filtered))
    }
}

/// What a controller is differentiated by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Known {
    /// The input at this place.
    Input(usize),
    /// The parameter at this position of the law's list.
    Parameter(usize),
}
