//! A rig at the instant that the importer names: what it computes there, and its modes.

use super::super::notice::{Notice, What};
use super::super::state::{read_mode, write_mode};
use super::super::variables::{CHANNELS, Channel, Friction, Signal};
use super::sensitivities::Sensitivities;
use crate::cosim::exchange::EventOutcome;
use crate::cosim::exchange_component::{self, Seeds};
use crate::cosim::part::{read_parameters, write_parameters};
use crate::cosim::{self, ModelError, StateError, StateReader, StateWriter};
use crate::plant::{
    Coupling, Indicators, MOST_INDICATORS, Rig, RigInputs, RigJet, RigMode, RigState, STATES,
};
use crate::series::Scalar;

/// The equations of a rig with the modes that hold.
pub(in crate::cosim) struct Run {
    rig: Rig<f64>,
    indicators: Indicators,
    jet: Box<RigJet<f64>>,
    /// Derivatives with respect to a direction, once they were asked for.
    pub(super) sensitivities: Option<Box<Sensitivities>>,
    pub(super) mode: RigMode,
    /// The mode that is evaluated: the one above, unless the state contradicts it.
    acting: RigMode,
    pub(super) time: f64,
    pub(super) state: RigState<f64>,
    inputs: [f64; CHANNELS],
    /// Whether the jet holds the present instant.
    pub(super) evaluated: bool,
    /// Whether inputs or parameters have jumped since the modes were looked at.
    pub(super) jumped: bool,
    values: [f64; MOST_INDICATORS],
    pub(super) notices: Vec<Notice>,
}

impl Run {
    /// The run that was in `mode`.
    fn resume(
        rig: Rig<f64>,
        mode: RigMode,
        time: f64,
        state: RigState<f64>,
        inputs: [f64; CHANNELS],
    ) -> Self {
        Self {
            rig,
            indicators: Indicators::new(&rig),
            jet: Box::new(RigJet::new(&rig)),
            sensitivities: None,
            mode,
            acting: mode,
            time,
            state,
            inputs,
            evaluated: false,
            jumped: false,
            values: [1.0; MOST_INDICATORS],
            notices: Vec::new(),
        }
    }

    /// Everything at the present instant.
    fn evaluate(&mut self) -> &RigJet<f64> {
        if !self.evaluated {
            let inputs = held(self.inputs, self.time);
            self.acting = self.mode;
            self.rig.let_move(&mut self.acting, &self.state);
            self.rig
                .evaluate(&self.acting, self.time, &self.state, &inputs, &mut self.jet);
            self.evaluated = true;
        }
        &self.jet
    }

    fn stuck(&self) -> [(Friction, bool); 3] {
        stuck_of(&self.mode)
    }
}

impl exchange_component::Run<CHANNELS, STATES> for Run {
    type Part = Rig<f64>;

    fn places(rig: &Rig<f64>) -> Vec<usize> {
        rig.state_places()
    }

    fn start(
        rig: &Rig<f64>,
        time: f64,
        mut state: RigState<f64>,
        inputs: [f64; CHANNELS],
    ) -> Result<Self, ModelError> {
        rig.check().map_err(ModelError::from_display)?;
        let mut jet = Box::new(RigJet::new(rig));
        let mode = rig.mode_at_start(time, &mut state, &held(inputs, time), &mut jet);
        let mut run = Self::resume(*rig, mode, time, state, inputs);
        run.jumped = true;
        run.update()?;
        run.notices.clear();
        Ok(run)
    }

    fn part(&self) -> &Rig<f64> {
        &self.rig
    }

    fn set_part(&mut self, rig: &Rig<f64>) -> Result<(), ModelError> {
        rig.check().map_err(ModelError::from_display)?;
        self.rig = *rig;
        *self.jet = RigJet::new(rig);
        self.sensitivities = None;
        (self.evaluated, self.jumped) = (false, true);
        Ok(())
    }

    fn set_time(&mut self, time: f64) {
        self.evaluated &= self.time == time;
        self.time = time;
    }

    fn set_input(&mut self, place: usize, value: f64, at_event: bool) {
        if self.inputs[place].to_bits() == value.to_bits() {
            return;
        }
        self.inputs[place] = value;
        self.evaluated = false;
        self.jumped |= at_event;
        if place != Channel::Voltage as usize && !at_event {
            self.indicators.set_stepwise(true);
        }
    }

    fn states(&self) -> &RigState<f64> {
        &self.state
    }

    fn states_mut(&mut self) -> &mut RigState<f64> {
        self.evaluated = false;
        &mut self.state
    }

    fn rates(&mut self) -> RigState<f64> {
        self.evaluate().rates()
    }

    fn indicators(&mut self) -> &[f64] {
        self.evaluate();
        let inputs = held(self.inputs, self.time);
        let values = &mut self.values[..self.indicators.count()];
        self.indicators
            .evaluate(&self.rig, &self.acting, &inputs, &self.jet, values);
        values
    }

    fn real(&mut self, signal: Signal) -> Option<f64> {
        match signal {
            Signal::State(place) => self.state.get(place).copied(),
            Signal::Rate(place) => self.evaluate().rates().get(place).copied(),
            Signal::Indicator(place) => self.indicators().get(place).copied(),
            Signal::Friction(friction) => friction_of(self.evaluate(), friction),
            Signal::Stuck(_) | Signal::CouplingFree => None,
        }
    }

    fn flag(&self, signal: Signal) -> Option<bool> {
        match signal {
            Signal::Stuck(Friction::Disc) => Some(self.mode.disc.is_stuck()),
            Signal::Stuck(Friction::Disc1) => Some(self.mode.disc1.is_stuck()),
            Signal::Stuck(Friction::Motor) => Some(self.mode.motor.is_stuck()),
            Signal::CouplingFree => Some(self.mode.coupling == Coupling::Free),
            _ => None,
        }
    }

    fn update(&mut self) -> Result<EventOutcome, ModelError> {
        let (before, stuck) = (self.state, self.stuck());
        let inputs = held(self.inputs, self.time);
        let changes = self
            .rig
            .settle(
                &self.indicators,
                &mut self.mode,
                self.time,
                &mut self.state,
                &inputs,
                !self.jumped,
                &mut self.jet,
            )
            .map_err(ModelError::from_display)?;
        (self.evaluated, self.jumped) = (false, false);
        let time = self.time;
        for ((contact, was), (_, is)) in stuck.into_iter().zip(self.stuck()) {
            if was != is {
                let what = if is {
                    What::Sticks(contact)
                } else {
                    What::Slips(contact)
                };
                self.notices.push(Notice { time, what });
            }
        }
        if changes.branch {
            let what = What::BranchJump;
            self.notices.push(Notice { time, what });
        }
        let same = |(a, b): (&f64, &f64)| a.to_bits() == b.to_bits();
        Ok(EventOutcome {
            states_changed: !before.iter().zip(&self.state).all(same),
        })
    }

    fn complete_step(&mut self) -> bool {
        self.evaluate();
        let contradicted = self.stuck() != stuck_of(&self.acting);
        let due = contradicted
            || self
                .indicators
                .is_event_due(&self.rig, &self.mode, &self.jet);
        if !due {
            self.mode = self.rig.follow(&self.mode, &self.jet);
        }
        due
    }

    fn directional(
        &mut self,
        unknowns: &[Signal],
        seeds: &Seeds<CHANNELS, STATES>,
    ) -> Result<Vec<f64>, ModelError> {
        self.evaluate();
        let held = held(self.inputs, self.time);
        let work = match &mut self.sensitivities {
            Some(work) if seeds.parameters.is_empty() => work,
            slot => slot.insert(Box::new(Sensitivities::new(&self.rig, seeds)?)),
        };
        let values = work.along(
            &self.acting,
            self.time,
            &self.state,
            &held,
            &self.indicators,
            unknowns,
            seeds,
        );
        if !seeds.parameters.is_empty() {
            self.sensitivities = None;
        }
        Ok(values)
    }

    fn drain_notices(&mut self, tell: &mut dyn FnMut(&dyn cosim::Notice)) {
        self.notices.drain(..).for_each(|notice| tell(&notice));
    }

    fn save(&self, state: &mut StateWriter) {
        write_parameters(&self.rig, state);
        let numbers = self.state.iter().chain(&self.inputs);
        numbers.for_each(|value| state.real(*value));
        state.real(self.time);
        state.flag(self.jumped);
        state.flag(self.indicators.is_stepwise());
        write_mode(&self.mode, state);
    }

    fn restore(original: &Rig<f64>, state: &mut StateReader<'_>) -> Result<Self, StateError> {
        let rig = read_parameters(original, state)?;
        let (mut values, mut inputs) = ([0.0; STATES], [0.0; CHANNELS]);
        for value in values.iter_mut().chain(&mut inputs) {
            *value = state.real()?;
        }
        let (time, jumped, force_moves) = (state.real()?, state.flag()?, state.flag()?);
        let mut run = Self::resume(rig, read_mode(state)?, time, values, inputs);
        run.jumped = jumped;
        run.indicators.set_stepwise(force_moves);
        Ok(run)
    }
}

/// Which contacts stick.
fn stuck_of(mode: &RigMode) -> [(Friction, bool); 3] {
    [
        (Friction::Disc, mode.disc.is_stuck()),
        (Friction::Disc1, mode.disc1.is_stuck()),
        (Friction::Motor, mode.motor.is_stuck()),
    ]
}

/// Inputs that are held, for the plant.
fn held(inputs: [f64; CHANNELS], time: f64) -> RigInputs<f64> {
    RigInputs {
        time,
        ..RigInputs::held(
            inputs[Channel::Voltage as usize],
            inputs[Channel::NormalForce as usize],
            inputs[Channel::NormalForce1 as usize],
        )
    }
}

/// A friction torque where `jet` was evaluated.
pub(super) fn friction_of<S: Scalar>(jet: &RigJet<S>, friction: Friction) -> Option<S> {
    let (disc, disc1, motor) = jet.torques();
    match friction {
        Friction::Disc => disc.first().copied(),
        Friction::Disc1 => disc1?.first().copied(),
        Friction::Motor => motor.first().copied(),
    }
}
