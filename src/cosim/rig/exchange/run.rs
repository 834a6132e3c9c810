//! A rig at the instant that the importer names: what it computes there, and its modes.

use super::super::notice::{Notice, What};
use super::super::variables::{CHANNELS, Channel, Friction, Signal};
use super::sensitivities::Sensitivities;
use crate::cosim::ModelError;
use crate::cosim::exchange::EventOutcome;
use crate::plant::{
    Coupling, Indicators, MOST_INDICATORS, Rig, RigInputs, RigJet, RigMode, RigState, STATES,
};
use crate::series::Scalar;

/// The equations of a rig with the modes that hold.
pub(super) struct Run {
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
    /// The run that starts at `time` \[s\] from `state`, in the modes that it wants.
    ///
    /// # Errors
    /// Parameters that contradict each other.
    pub(super) fn start(
        rig: Rig<f64>,
        time: f64,
        state: RigState<f64>,
        inputs: [f64; CHANNELS],
    ) -> Result<Self, ModelError> {
        rig.check().map_err(ModelError::from_display)?;
        let mut jet = Box::new(RigJet::new(&rig));
        let mut state = state;
        let mode = rig.mode_at_start(time, &mut state, &held(inputs, time), &mut jet);
        let mut run = Self::resume(rig, mode, time, state, inputs);
        run.jumped = true;
        run.update()?;
        run.notices.clear();
        Ok(run)
    }

    /// The run that was in `mode`.
    pub(super) fn resume(
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

    /// Puts another value of an input in force.
    pub(super) fn set_input(&mut self, place: usize, value: f64, at_event: bool) {
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

    /// Whether a normal force has moved between events.
    pub(super) fn force_moves(&self) -> bool {
        self.indicators.is_stepwise()
    }

    pub(super) fn set_force_moves(&mut self, moves: bool) {
        self.indicators.set_stepwise(moves);
    }

    /// The rig in force.
    pub(super) fn rig(&self) -> &Rig<f64> {
        &self.rig
    }

    /// Puts other parameters in force.
    ///
    /// # Errors
    /// Parameters that contradict each other.
    pub(super) fn set_rig(&mut self, rig: Rig<f64>) -> Result<(), ModelError> {
        rig.check().map_err(ModelError::from_display)?;
        self.rig = rig;
        *self.jet = RigJet::new(&rig);
        self.sensitivities = None;
        (self.evaluated, self.jumped) = (false, true);
        Ok(())
    }

    /// Everything at the present instant.
    pub(super) fn evaluate(&mut self) -> &RigJet<f64> {
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

    /// The inputs in force.
    pub(super) fn inputs(&self) -> &[f64; CHANNELS] {
        &self.inputs
    }

    pub(super) fn indicators(&mut self) -> &[f64] {
        self.evaluate();
        let inputs = held(self.inputs, self.time);
        let values = &mut self.values[..self.indicators.count()];
        self.indicators
            .evaluate(&self.rig, &self.acting, &inputs, &self.jet, values);
        values
    }

    /// A real signal; `None` for a flag.
    pub(super) fn real(&mut self, signal: Signal) -> Option<f64> {
        match signal {
            Signal::State(place) => self.state.get(place).copied(),
            Signal::Rate(place) => self.evaluate().rates().get(place).copied(),
            Signal::Indicator(place) => self.indicators().get(place).copied(),
            Signal::Friction(friction) => friction_of(self.evaluate(), friction),
            Signal::Stuck(_) | Signal::CouplingFree => None,
        }
    }

    /// A Boolean signal; `None` for a real one.
    pub(super) fn flag(&self, signal: Signal) -> Option<bool> {
        match signal {
            Signal::Stuck(Friction::Disc) => Some(self.mode.disc.is_stuck()),
            Signal::Stuck(Friction::Disc1) => Some(self.mode.disc1.is_stuck()),
            Signal::Stuck(Friction::Motor) => Some(self.mode.motor.is_stuck()),
            Signal::CouplingFree => Some(self.mode.coupling == Coupling::Free),
            _ => None,
        }
    }

    /// Brings the modes to what holds now.
    ///
    /// # Errors
    /// Modes that change without end.
    pub(super) fn update(&mut self) -> Result<EventOutcome, ModelError> {
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

    /// Lets the followed roots go along; whether an event is due.
    pub(super) fn complete_step(&mut self) -> bool {
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

    fn stuck(&self) -> [(Friction, bool); 3] {
        stuck_of(&self.mode)
    }

    /// Derivatives of the `unknowns` in the direction that `seeds` of knowns give, states and mode held.
    ///
    /// # Errors
    /// A parameter that is out of range.
    pub(super) fn directional(
        &mut self,
        unknowns: &[Signal],
        seeds: &super::sensitivities::Seeds,
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

/// Number of state components that exist in memory.
pub(super) const PLACES: usize = STATES;
