//! The course of a controller as a component has it, with what it tells the log.

use super::notice::Notice;
use super::part::{FILTERED_TORQUE, INTEGRAL, STARTS};
use super::state::{read_start, write_start};
use super::variables::{Signal, signal_at};
use crate::controller::{self, ControlLaw, INPUTS, Start};
use crate::cosim;
use crate::cosim::input_signals::InputSignals;
use crate::cosim::part::{self, Known, read_parameters, write_parameters};
use crate::cosim::{ModelError, StateError, StateReader, StateWriter, StepEnd};

/// A controller's course with its notices.
pub(in crate::cosim) struct Course {
    course: controller::Course,
    notices: Vec<Notice>,
}

impl Course {
    fn new(law: ControlLaw<f64>, start: Start) -> Self {
        Self {
            course: controller::Course::new(law, start),
            notices: Vec::new(),
        }
    }

    /// Goes over to another course; whether the voltage reaches or leaves a limit by that.
    fn replace(&mut self, after: controller::Course, time: f64) -> bool {
        let before = std::mem::replace(&mut self.course, after);
        let notice = Notice::of(
            &self.course.law().gains(),
            before.mode(),
            after.mode(),
            time,
        );
        let switched = notice.is_some();
        self.notices.extend(notice);
        switched
    }
}

impl part::Course<INPUTS, STARTS> for Course {
    type Part = ControlLaw<f64>;

    fn start(
        law: &ControlLaw<f64>,
        _tolerance: Option<f64>,
        time: f64,
        values: &[f64; STARTS],
        signals: &InputSignals<INPUTS>,
    ) -> Result<Self, ModelError> {
        let start = Start {
            time,
            integral: values[INTEGRAL],
            filtered_torque: values[FILTERED_TORQUE],
            inputs: signals.centred(time).polynomials,
            mode: None,
        };
        Ok(Self::new(*law, start))
    }

    fn change(
        &mut self,
        law: &ControlLaw<f64>,
        signals: &InputSignals<INPUTS>,
        now: f64,
    ) -> Result<bool, ModelError> {
        let inputs = signals.centred(now).polynomials;
        let start = self.course.start();
        let in_force = InputSignals::new(start.time, start.inputs).centred(now);
        if law == self.course.law() && in_force.polynomials == inputs {
            return Ok(false);
        }
        law.check().map_err(ModelError::from_display)?;
        Ok(self.replace(self.course.changed(*law, inputs, now), now))
    }

    fn covers(&mut self, until: f64) -> bool {
        !self.course.has_event_until(until)
    }

    fn advance(
        &mut self,
        begin: f64,
        until: f64,
        stop_at_switch: bool,
    ) -> Result<StepEnd, ModelError> {
        let mut switched = false;
        while self.course.has_event_until(until) {
            let mut next = self.course;
            let time = next.next_stretch().map_err(ModelError::from_display)?;
            let switch = self.replace(next, time);
            switched |= switch;
            if switch && stop_at_switch && time > begin {
                return Ok(StepEnd { time, switched });
            }
        }
        Ok(StepEnd {
            time: until,
            switched,
        })
    }

    fn reached(&self) -> f64 {
        self.course.start().time
    }

    fn signal(&self, signal: Signal, order: u32, time: f64) -> Option<f64> {
        match signal {
            Signal::Voltage => Some(self.course.voltage(order, time)),
            Signal::Integral => Some(self.course.integral(order, time)),
            Signal::FilteredTorque => Some(self.course.filtered_torque(order, time)),
            Signal::IntegralRate => Some(self.course.integral(order + 1, time)),
            Signal::FilteredTorqueRate => Some(self.course.filtered_torque(order + 1, time)),
            Signal::Indicator(place) if order == 0 => {
                let (instant, mode) = self.course.instant(time);
                instant.indicators(mode).get(place).copied()
            }
            Signal::Indicator(_) | Signal::Saturated => None,
        }
    }

    fn flag(&self, signal: Signal) -> Option<bool> {
        (signal == Signal::Saturated).then(|| self.course.mode().limit().is_some())
    }

    fn partial(&self, unknown: Signal, known: Known, time: f64) -> Result<Option<f64>, ModelError> {
        let known = match known {
            Known::Input(place) => controller::Known::Input(place),
            Known::Parameter(position) => controller::Known::Parameter(position),
        };
        let instant = self
            .course
            .partial(known, time)
            .map_err(ModelError::from_display)?;
        let number = signal_at(&instant, self.course.mode(), unknown);
        Ok(number.map(|number| number.derivative[0]))
    }

    fn drain_notices(&mut self, tell: &mut dyn FnMut(&dyn cosim::Notice)) {
        self.notices.drain(..).for_each(|notice| tell(&notice));
    }

    fn save(&self, state: &mut StateWriter) {
        write_parameters(self.course.law(), state);
        write_start(self.course.start(), state);
    }

    fn restore(
        original: &ControlLaw<f64>,
        _tolerance: Option<f64>,
        state: &mut StateReader<'_>,
    ) -> Result<Self, StateError> {
        let law = read_parameters(original, state)?;
        Ok(Self::new(law, read_start(state)?))
    }
}
