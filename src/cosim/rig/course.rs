//! The course of a rig: the run that computes it, what it tells the log and what its sensors remember.

use super::delay_line::DelayLine;
use super::notice::{Notice, What};
use super::state::{read_rig, read_snapshot, write_rig, write_snapshot};
use super::variables::{Friction, Quantity};
use crate::cosim::{ModelError, StateError, StateReader, StateWriter, StepEnd};
use crate::integrator::{HybridSystem, IntegrationError, Options, Simulation};
use crate::plant::{Rig, RigInputs, RigJet, RigMode, RigState, index};
use crate::series::{Scalar, evaluate};

/// The run of a rig.
pub(super) type Run = Simulation<f64, Rig<f64>>;

/// A run with its notices and its past.
pub(super) struct Course {
    pub(super) run: Run,
    pub(super) notices: Vec<Notice>,
    /// Present where the disc's sensors lag.
    delay_line: Option<DelayLine>,
}

impl Course {
    /// Starts at `time` [s] from `state`.
    pub(super) fn start(
        rig: Rig<f64>,
        options: Options,
        time: f64,
        state: RigState<f64>,
        inputs: RigInputs<f64>,
    ) -> Result<Self, ModelError> {
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

    /// Puts other parameters and inputs in force from `now` [s] on, where they are other ones;
    /// whether a contact sticks or slips at once because of them.
    pub(super) fn change(
        &mut self,
        rig: &Rig<f64>,
        inputs: Option<RigInputs<f64>>,
        now: f64,
    ) -> Result<bool, ModelError> {
        let other_rig = rig != self.run.system();
        if !other_rig && inputs.is_none() {
            return Ok(false);
        }
        self.remember();
        if other_rig {
            rig.check().map_err(ModelError::from_display)?;
            self.run
                .set_system(now, *rig)
                .map_err(ModelError::from_display)?;
        }
        if let Some(inputs) = inputs {
            self.run
                .set_inputs(now, inputs)
                .map_err(ModelError::from_display)?;
        }
        let mut switched = false;
        while self.run.segment_end() <= now {
            switched |= self.next_segment().map_err(ModelError::from_display)?;
        }
        Ok(switched)
    }

    /// Advances from `begin` [s] until the run covers `until`, or with `stop_at_switch` to the first
    /// switch of a contact after `begin`.
    pub(super) fn advance(
        &mut self,
        begin: f64,
        until: f64,
        stop_at_switch: bool,
        budget: u64,
    ) -> Result<StepEnd, ModelError> {
        let mut switched = false;
        let mut stop = false;
        for _ in 0..budget {
            if self.run.segment_end() >= until {
                return Ok(StepEnd {
                    time: until,
                    switched,
                });
            }
            let switch = self.next_segment().map_err(ModelError::from_display)?;
            let now = self.run.segment_start();
            switched |= switch;
            stop |= switch && stop_at_switch && now > begin;
            // Several switches may fall on one instant.
            if stop && self.run.segment_end() > now {
                return Ok(StepEnd {
                    time: now,
                    switched,
                });
            }
        }
        Err(ModelError(format!(
            "{budget} segments did not reach t = {until} s; now at t = {} s. Take shorter steps, or check \
             inertias, inductance and stiffness: a time constant is extremely short",
            self.run.segment_start()
        )))
    }

    /// Goes to the next segment; whether a contact began to stick or to slip.
    fn next_segment(&mut self) -> Result<bool, IntegrationError> {
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

    fn remember(&mut self) {
        if let Some(line) = &mut self.delay_line {
            line.keep(&self.run);
        }
    }

    /// Value of a quantity at `time` [s], which the present segment covers; `None` for what is
    /// neither a state nor a torque.
    pub(super) fn value(&self, quantity: Quantity, time: f64) -> Option<f64> {
        self.polynomial(quantity, time, evaluate)
    }

    /// What `read` makes of the polynomial of a quantity and the local time that `time` [s] is.
    pub(super) fn polynomial<R>(
        &self,
        quantity: Quantity,
        time: f64,
        read: impl FnOnce(&[f64], f64) -> R,
    ) -> Option<R> {
        if let (Some(line), Quantity::State(place @ (index::THETA | index::OMEGA))) =
            (&self.delay_line, quantity)
        {
            let (series, tau) = line.read(&self.run, place == index::OMEGA, time);
            return Some(read(&series, tau));
        }
        let series = series(self.run.system(), self.run.jet(), quantity)?;
        Some(read(series, time - self.run.segment_start()))
    }

    /// Writes the course into a state.
    pub(super) fn save(&self, state: &mut StateWriter) {
        write_rig(self.run.system(), state);
        write_snapshot(&self.run.snapshot(), state);
        if let Some(line) = &self.delay_line {
            line.save(state);
        }
    }

    /// The opposite of [`save`](Self::save), for a rig built like `original`.
    pub(super) fn restore(
        original: &Rig<f64>,
        options: Options,
        state: &mut StateReader<'_>,
    ) -> Result<Self, StateError> {
        let content = |error: &dyn std::fmt::Display| StateError::Content(error.to_string());
        let rig = read_rig(original, state)?;
        let snapshot = read_snapshot(state)?;
        let mut course = Self::start(
            rig,
            options,
            snapshot.start,
            snapshot.state,
            snapshot.inputs,
        )
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

/// Series of a quantity over one segment; `None` for what is neither a state nor a torque.
pub(super) fn series<'a, S: Scalar>(
    system: &Rig<S>,
    jet: &'a RigJet<S>,
    quantity: Quantity,
) -> Option<&'a [S]> {
    match quantity {
        // The torque has the terms that count; a state's array goes on beyond them.
        Quantity::State(place) => system
            .states(jet)
            .get(place)?
            .get(..jet.friction_torque().len()),
        Quantity::Friction(Friction::Disc) => Some(jet.friction_torque()),
        Quantity::Friction(Friction::Disc1) => jet.friction_torque_1(),
        Quantity::Friction(Friction::Motor) => Some(jet.motor_friction_torque()),
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
