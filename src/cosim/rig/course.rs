//! The course of a rig: the run that computes it, what it tells the log and what its sensors remember.

use super::delay_line::DelayLine;
use super::derivatives::{indicator, partial_derivative};
use super::input_signals::InputSignals;
use super::notice::{Notice, What};
use super::state::{read_snapshot, write_snapshot};
use super::variables::{CHANNELS, Friction, Signal};
use crate::cosim;
use crate::cosim::part::{self, Known, read_parameters, write_parameters};
use crate::cosim::segments::{self, Segments, time_derivative};
use crate::cosim::{ModelError, StateError, StateReader, StateWriter, StepEnd};
use crate::integrator::{HybridSystem, IntegrationError, Options, Simulation};
use crate::plant::{Coupling, Rig, RigInputs, RigJet, RigMode, RigState, STATES, index};
use crate::series::{Scalar, evaluate};
use std::fmt;

/// The run of a rig.
pub(super) type Run = Simulation<f64, Rig<f64>>;

/// A run with its notices and its past.
pub(in crate::cosim) struct Course {
    run: Run,
    notices: Vec<Notice>,
    /// Present where the disc's sensors lag.
    delay_line: Option<DelayLine>,
}

impl Course {
    fn new(
        rig: Rig<f64>,
        tolerance: Option<f64>,
        time: f64,
        state: RigState<f64>,
        inputs: RigInputs<f64>,
    ) -> Result<Self, ModelError> {
        let default = Options::default();
        let options = Options {
            tolerance: tolerance.unwrap_or(default.tolerance),
            ..default
        };
        let delay_line = rig
            .effects
            .sensor_delay
            .map(|sensor| DelayLine::new(sensor.delay));
        let run = Run::new(rig, options, time, state, inputs).map_err(ModelError::from_display)?;
        Ok(Self {
            run,
            notices: Vec::new(),
            delay_line,
        })
    }

    fn remember(&mut self) {
        if let Some(line) = &mut self.delay_line {
            line.keep(&self.run);
        }
    }

    /// What `read` makes of the polynomial of a signal and the local time that `time` [s] is.
    fn polynomial<R>(
        &self,
        signal: Signal,
        time: f64,
        read: impl FnOnce(&[f64], f64) -> R,
    ) -> Option<R> {
        if let (Some(line), Signal::State(place @ (index::THETA | index::OMEGA))) =
            (&self.delay_line, signal)
        {
            return Some(line.read(&self.run, place, time, read));
        }
        let series = series(self.run.system(), self.run.jet(), signal)?;
        Some(read(series, time - self.run.segment_start()))
    }
}

impl Segments for Course {
    fn begin(&self) -> f64 {
        self.run.segment_start()
    }

    #[inline]
    fn end(&self) -> f64 {
        self.run.segment_end()
    }

    fn next(&mut self) -> Result<bool, IntegrationError> {
        self.remember();
        let before = stuck(self.run.mode());
        let jumps = self.run.statistics().branch_jumps;
        self.run.next_segment()?;
        let time = self.run.segment_start();
        let after = stuck(self.run.mode());
        for ((contact, before), (_, after)) in before.into_iter().zip(after) {
            if before != after {
                let what = if after {
                    What::Sticks(contact)
                } else {
                    What::Slips(contact)
                };
                self.notices.push(Notice { time, what });
            }
        }
        if self.run.statistics().branch_jumps > jumps {
            self.notices.push(Notice {
                time,
                what: What::BranchJump,
            });
        }
        Ok(before != after)
    }
}

impl part::Course<CHANNELS, STATES> for Course {
    type Part = Rig<f64>;

    fn start(
        rig: &Rig<f64>,
        tolerance: Option<f64>,
        time: f64,
        values: &RigState<f64>,
        signals: &InputSignals,
    ) -> Result<Self, ModelError> {
        Self::new(*rig, tolerance, time, *values, signals.rig_inputs(time))
    }

    fn change(
        &mut self,
        rig: &Rig<f64>,
        signals: &InputSignals,
        now: f64,
    ) -> Result<bool, ModelError> {
        let other_rig = rig != self.run.system();
        let other_inputs = !signals.agree_with(self.run.inputs(), now);
        if !other_rig && !other_inputs {
            return Ok(false);
        }
        if other_rig {
            rig.check().map_err(ModelError::from_display)?;
        }
        self.remember();
        if other_rig {
            self.run
                .set_system(now, *rig)
                .map_err(ModelError::from_display)?;
        }
        if other_inputs {
            self.run
                .set_inputs(now, signals.rig_inputs(now))
                .map_err(ModelError::from_display)?;
        }
        let mut switched = false;
        while self.run.segment_end() <= now {
            switched |= self.next().map_err(ModelError::from_display)?;
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
        let hint = "inertias, inductance and stiffness";
        segments::advance(self, begin, until, stop_at_switch, hint)
    }

    fn reached(&self) -> f64 {
        self.run.segment_start()
    }

    fn signal(&self, signal: Signal, order: u32, time: f64) -> Option<f64> {
        let (signal, order) = match signal {
            Signal::Rate(place) => (Signal::State(place), order + 1),
            Signal::Indicator(place) if order == 0 => return indicator(&self.run, time, place),
            _ => (signal, order),
        };
        self.polynomial(signal, time, |series, tau| match order {
            0 => evaluate(series, tau),
            order => time_derivative(series, order as usize, tau),
        })
    }

    fn flag(&self, signal: Signal) -> Option<bool> {
        let mode = self.run.mode();
        match signal {
            Signal::Stuck(Friction::Disc) => Some(mode.disc.is_stuck()),
            Signal::Stuck(Friction::Disc1) => Some(mode.disc1.is_stuck()),
            Signal::Stuck(Friction::Motor) => Some(mode.motor.is_stuck()),
            Signal::CouplingFree => Some(mode.coupling == Coupling::Free),
            _ => None,
        }
    }

    fn partial(&self, unknown: Signal, known: Known, time: f64) -> Result<Option<f64>, ModelError> {
        partial_derivative(&self.run, time, unknown, known)
    }

    fn drain_notices(&mut self, tell: &mut dyn FnMut(&dyn cosim::Notice)) {
        self.notices.drain(..).for_each(|notice| tell(&notice));
    }

    fn save(&self, state: &mut StateWriter) {
        write_parameters(self.run.system(), state);
        write_snapshot(&self.run.snapshot(), state);
        if let Some(line) = &self.delay_line {
            line.save(state);
        }
    }

    fn restore(
        original: &Rig<f64>,
        tolerance: Option<f64>,
        state: &mut StateReader<'_>,
    ) -> Result<Self, StateError> {
        let content = |error: &dyn fmt::Display| StateError::Content(error.to_string());
        let rig = read_parameters(original, state)?;
        let snapshot = read_snapshot(state)?;
        let (start, inputs) = (snapshot.start, snapshot.inputs);
        let mut course = Self::new(rig, tolerance, start, snapshot.state, inputs)
            .map_err(|error| content(&error))?;
        course
            .run
            .restore(&snapshot)
            .map_err(|error| content(&error))?;
        if let Some(sensor) = rig.effects.sensor_delay {
            course.delay_line = Some(DelayLine::restore(sensor.delay, state)?);
        }
        Ok(course)
    }
}

/// Series of a signal over one segment; `None` for what is neither a state nor a torque.
pub(super) fn series<'a, S: Scalar>(
    system: &Rig<S>,
    jet: &'a RigJet<S>,
    signal: Signal,
) -> Option<&'a [S]> {
    let (disc, disc_1, motor) = jet.torques();
    match signal {
        // The torque has the terms that count; a state's array goes on beyond them.
        Signal::State(place) => system.states(jet).get(place)?.get(..disc.len()),
        Signal::Friction(Friction::Disc) => Some(disc),
        Signal::Friction(Friction::Disc1) => disc_1,
        Signal::Friction(Friction::Motor) => Some(motor),
        _ => None,
    }
}

/// Which contacts stick.
fn stuck(mode: &RigMode) -> [(Friction, bool); 3] {
    [
        (Friction::Disc, mode.disc.is_stuck()),
        (Friction::Disc1, mode.disc1.is_stuck()),
        (Friction::Motor, mode.motor.is_stuck()),
    ]
}
