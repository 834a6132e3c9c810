//! The rig as a component for co-simulation.

use super::identity::Identity;
use super::input_signals::InputSignals;
use super::model::{CoSimulationModel, ModelError, StepEnd};
use super::notice::Notice;
use super::rig_identity::identity;
use super::rig_state::{read_rig, read_snapshot, write_rig, write_snapshot};
use super::rig_variables::{Channel, Friction, Quantity, rig_table};
use super::state::{StateError, StateReader, StateWriter};
use super::token::Token;
use super::variables::{TableError, VariableTable};
use crate::integrator::{HybridSystem, Options, Simulation};
use crate::plant::{Coupling, Rig, RigInputs, RigJet, RigMode, RigState, STATES};
use crate::series::{Dual, Scalar, evaluate};
use std::fmt;
use std::sync::Arc;

type Run = Simulation<f64, Rig<f64>>;

/// A rig with its place in time, its inputs and the run that computes it.
///
/// The run goes ahead of the communication points; the present is read from its polynomials. Inputs
/// and parameters that the importer sets are collected here and reach the run with the next step, or
/// when a quantity that depends on them is read: setting a value that is already in force costs
/// nothing.
pub struct RigModel {
    table: Arc<VariableTable>,
    quantities: Vec<Quantity>,
    token: Token,
    /// The rig of `model.toml`.
    original: Rig<f64>,
    /// The rig with the parameters that are set.
    rig: Rig<f64>,
    signals: InputSignals,
    initial_state: RigState<f64>,
    tolerance: Option<f64>,
    time: f64,
    initialised: bool,
    /// Whether something was set that the run does not know yet.
    pending: bool,
    /// Whether what was set at the present point made a contact stick or slip at once.
    switched_at_once: bool,
    run: Option<Box<Run>>,
    notices: Vec<Notice>,
}

impl RigModel {
    /// The component that `rig`, read from `model_toml`, is.
    ///
    /// # Errors
    /// A parameter's unit cannot be expressed in SI base units.
    pub fn new(rig: Rig<f64>, model_toml: &str) -> Result<Self, TableError> {
        let (table, quantities) = rig_table(&rig)?;
        let token = Token::new(&table, model_toml);
        Ok(Self {
            table: Arc::new(table),
            quantities,
            token,
            original: rig,
            rig,
            signals: InputSignals::default(),
            initial_state: [0.0; STATES],
            tolerance: None,
            time: identity(rig.kind()).default_experiment.start_time,
            initialised: false,
            pending: false,
            switched_at_once: false,
            run: None,
            notices: Vec::new(),
        })
    }

    fn quantity(&self, value_reference: u32) -> Result<Quantity, ModelError> {
        self.quantities
            .get(value_reference as usize)
            .copied()
            .ok_or_else(|| ModelError(format!("there is no value reference {value_reference}")))
    }

    fn options(&self) -> Options {
        let default = Options::default();
        Options {
            tolerance: self.tolerance.unwrap_or(default.tolerance),
            ..default
        }
    }

    /// The run with everything that was set.
    fn run(&mut self) -> Result<&mut Run, ModelError> {
        if self.pending {
            self.catch_up()?;
        }
        if self.run.is_none() {
            self.rig.check().map_err(ModelError::from_display)?;
            let inputs = self.signals.rig_inputs(self.time);
            let run = Run::new(
                self.rig,
                self.options(),
                self.time,
                self.initial_state,
                inputs,
            )
            .map_err(ModelError::from_display)?;
            self.run = Some(Box::new(run));
        }
        self.run
            .as_deref_mut()
            .ok_or_else(|| ModelError("the run did not start".into()))
    }

    /// Tells the run what was set since the last step.
    fn catch_up(&mut self) -> Result<(), ModelError> {
        let now = self.time;
        let Some(run) = self.run.as_deref_mut() else {
            self.pending = false;
            return Ok(());
        };
        if !self.initialised {
            // Nothing has moved yet: start afresh, so that modes fit the new values.
            self.run = None;
            self.pending = false;
            return Ok(());
        }
        let mut changed = false;
        if self.rig != *run.system() {
            self.rig.check().map_err(ModelError::from_display)?;
            run.set_system(now, self.rig)
                .map_err(ModelError::from_display)?;
            changed = true;
        }
        if !self.signals.agree_with(run.inputs(), now) {
            run.set_inputs(now, self.signals.rig_inputs(now))
                .map_err(ModelError::from_display)?;
            changed = true;
        }
        // What was set may make a contact stick or slip at this very instant.
        while changed && run.segment_end() <= now {
            let before = Contacts::of(run.mode());
            run.next_segment().map_err(ModelError::from_display)?;
            self.switched_at_once |= before.note_change(run, self.notices.as_mut());
        }
        self.pending = false;
        Ok(())
    }

    /// Advances beyond the present segment, see [`CoSimulationModel::step`].
    #[cold]
    fn advance(&mut self, until: f64, stop_at_switch: bool) -> Result<StepEnd, ModelError> {
        let begin = self.time;
        let budget = self.options().budget;
        let mut switched = false;
        let mut segments = 0;
        let Some(run) = self.run.as_deref_mut() else {
            return Err(ModelError("the run did not start".into()));
        };
        while run.segment_end() < until {
            segments += 1;
            if segments > budget {
                self.time = run.segment_start();
                return Err(ModelError(format!(
                    "{budget} segments did not reach t = {until} s; now at t = {} s",
                    self.time
                )));
            }
            let before = Contacts::of(run.mode());
            let outcome = run.next_segment();
            if let Err(error) = outcome {
                self.time = run.segment_start();
                return Err(ModelError::from_display(error));
            }
            if before.note_change(run, &mut self.notices) {
                switched = true;
                let now = run.segment_start();
                if stop_at_switch && now > begin && run.segment_end() > now {
                    self.time = now;
                    return Ok(StepEnd {
                        time: now,
                        switched,
                    });
                }
            }
        }
        self.time = until;
        Ok(StepEnd {
            time: until,
            switched,
        })
    }

    /// Series of a quantity over the present segment; `None` for what has none.
    fn series<'a, S: Scalar>(
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

    fn no_series(&self, value_reference: u32) -> ModelError {
        let name = self
            .table
            .get(value_reference)
            .map_or("", |variable| &variable.name);
        ModelError(format!(
            "\"{name}\" is neither a state nor a friction torque"
        ))
    }
}

/// Which contacts stick.
#[derive(Clone, Copy, PartialEq)]
struct Contacts {
    stuck: [bool; 3],
}

impl Contacts {
    fn of(mode: &RigMode) -> Self {
        Self {
            stuck: [
                mode.disc.is_stuck(),
                mode.disc1.is_stuck(),
                mode.motor.is_stuck(),
            ],
        }
    }

    /// Notes what is different now at the start of the run's segment; whether a contact is.
    fn note_change(self, run: &Run, notices: &mut Vec<Notice>) -> bool {
        let (time, now) = (run.segment_start(), Self::of(run.mode()));
        for (place, (before, after)) in self.stuck.into_iter().zip(now.stuck).enumerate() {
            if before != after {
                let contact = [Friction::Disc, Friction::Disc1, Friction::Motor][place];
                notices.push(Notice {
                    time,
                    contact,
                    sticks: after,
                });
            }
        }
        self != now
    }
}

impl CoSimulationModel for RigModel {
    fn identity(&self) -> &'static Identity {
        identity(self.original.kind())
    }

    fn table(&self) -> &Arc<VariableTable> {
        &self.table
    }

    fn token(&self) -> Token {
        self.token
    }

    fn time(&self) -> f64 {
        self.time
    }

    fn set_up(&mut self, start_time: f64, tolerance: Option<f64>) {
        self.time = start_time;
        self.tolerance = tolerance;
        self.run = None;
    }

    fn initialise(&mut self) -> Result<(), ModelError> {
        self.run()?;
        self.initialised = true;
        self.signals.begin_step();
        Ok(())
    }

    fn real(&mut self, value_reference: u32) -> Result<f64, ModelError> {
        match self.quantity(value_reference)? {
            Quantity::Time => Ok(self.time),
            Quantity::Input(channel) => Ok(self.signals.value(channel, self.time)),
            Quantity::State(place) if !self.initialised => Ok(self.initial_state[place]),
            Quantity::Parameter(position) => self
                .rig
                .parameter_at(position)
                .ok_or_else(|| ModelError(format!("there is no parameter {position}"))),
            quantity => {
                // No further than the run itself goes: what lies beyond would break the steadiness at switches.
                let order = self.options().order;
                let time = self.time;
                let run = match (&self.run, quantity) {
                    // No input moves a state at once: no need to catch up.
                    (Some(run), Quantity::State(_)) => run,
                    _ => &*self.run()?,
                };
                let tau = time - run.segment_start();
                Self::series(run.system(), run.jet(), quantity)
                    .map(|series| evaluate(&series[..=order], tau))
                    .ok_or_else(|| self.no_series(value_reference))
            }
        }
    }

    fn boolean(&mut self, value_reference: u32) -> Result<bool, ModelError> {
        let quantity = self.quantity(value_reference)?;
        let mode = *self.run()?.mode();
        match quantity {
            Quantity::Stuck(Friction::Disc) => Ok(mode.disc.is_stuck()),
            Quantity::Stuck(Friction::Disc1) => Ok(mode.disc1.is_stuck()),
            Quantity::Stuck(Friction::Motor) => Ok(mode.motor.is_stuck()),
            Quantity::CouplingFree => Ok(mode.coupling == Coupling::Free),
            _ => Err(ModelError(format!(
                "value reference {value_reference} is not a Boolean"
            ))),
        }
    }

    fn set_real(&mut self, value_reference: u32, value: f64) -> Result<(), ModelError> {
        match self.quantity(value_reference)? {
            Quantity::Input(channel) => self.signals.set_value(channel, value, self.time),
            Quantity::State(place) => self.initial_state[place] = value,
            Quantity::Parameter(position) => {
                self.rig
                    .set_parameter_at(position, value)
                    .map_err(ModelError::from_display)?;
            }
            _ => {
                return Err(ModelError(format!(
                    "value reference {value_reference} is computed"
                )));
            }
        }
        self.pending = true;
        Ok(())
    }

    fn set_input_derivative(
        &mut self,
        value_reference: u32,
        order: u32,
        value: f64,
    ) -> Result<(), ModelError> {
        let Quantity::Input(channel) = self.quantity(value_reference)? else {
            return Err(ModelError(format!(
                "value reference {value_reference} is not an input"
            )));
        };
        self.signals
            .set_derivative(channel, order, value, self.time);
        self.pending = true;
        Ok(())
    }

    fn output_derivative(&mut self, value_reference: u32, order: u32) -> Result<f64, ModelError> {
        let quantity = self.quantity(value_reference)?;
        let time = self.time;
        let run = &*self.run()?;
        let tau = time - run.segment_start();
        Self::series(run.system(), run.jet(), quantity)
            .map(|series| derivative(series, order as usize, tau))
            .ok_or_else(|| self.no_series(value_reference))
    }

    fn partial_derivative(&mut self, unknown: u32, known: u32) -> Result<f64, ModelError> {
        let (unknown_quantity, known) = (self.quantity(unknown)?, self.quantity(known)?);
        let (time, signals) = (self.time, self.signals);
        let mut rig = self.rig.lift::<Dual<1>>();
        let run = &*self.run()?;
        let mut inputs = lift_inputs(&signals.rig_inputs(time));
        match known {
            Quantity::Input(channel) => {
                let value = match channel {
                    Channel::Voltage => &mut inputs.voltage[0],
                    Channel::NormalForce => &mut inputs.normal_force[0],
                    Channel::NormalForce1 => &mut inputs.normal_force_1[0],
                };
                *value = Dual::variable(value.value, 0);
            }
            Quantity::Parameter(position) => {
                let value = rig.parameter_at(position).map_or(0.0, Scalar::value);
                rig.set_parameter_at(position, Dual::variable(value, 0))
                    .map_err(ModelError::from_display)?;
            }
            _ => return Err(ModelError("only inputs and parameters can be known".into())),
        }
        let tau = time - run.segment_start();
        let mode = run.system().carry(run.mode(), run.jet(), tau);
        let state = run.state_at(time).map(Dual::constant);
        let mut jet = RigJet::new(&rig);
        rig.expand_motion(&mode, Dual::constant(time), &state, &inputs, 1, &mut jet);
        Self::series(&rig, &jet, unknown_quantity)
            .and_then(|series| series.first())
            .map(|coefficient| coefficient.derivative[0])
            .ok_or_else(|| self.no_series(unknown))
    }

    #[inline]
    fn step(&mut self, until: f64, stop_at_switch: bool) -> Result<StepEnd, ModelError> {
        if self.pending || self.run.is_none() {
            self.run()?;
            self.signals.begin_step();
        }
        let switched_at_once = std::mem::take(&mut self.switched_at_once);
        let covered = self
            .run
            .as_ref()
            .is_some_and(|run| until <= run.segment_end());
        let mut end = if until <= self.time || covered {
            self.time = self.time.max(until);
            StepEnd {
                time: self.time,
                switched: false,
            }
        } else {
            self.advance(until, stop_at_switch)?
        };
        end.switched |= switched_at_once;
        Ok(end)
    }

    fn drain_notices(&mut self, tell: &mut dyn FnMut(&dyn fmt::Display)) {
        self.notices.drain(..).for_each(|notice| tell(&notice));
    }

    fn save(&self, state: &mut StateWriter) {
        state.real(self.time);
        state.flag(self.initialised);
        state.flag(self.pending);
        state.flag(self.switched_at_once);
        state.flag(self.tolerance.is_some());
        state.real(self.tolerance.unwrap_or(0.0));
        self.initial_state
            .iter()
            .for_each(|value| state.real(*value));
        write_rig(&self.rig, state);
        self.signals.save(state);
        state.flag(self.run.is_some());
        if let Some(run) = &self.run {
            write_rig(run.system(), state);
            write_snapshot(&run.snapshot(), state);
        }
    }

    fn restore(&mut self, state: &mut StateReader<'_>) -> Result<(), StateError> {
        let mut restored = Self {
            table: Arc::clone(&self.table),
            quantities: self.quantities.clone(),
            time: state.real()?,
            initialised: state.flag()?,
            pending: state.flag()?,
            switched_at_once: state.flag()?,
            tolerance: state.flag()?.then_some(state.real()?),
            run: None,
            notices: Vec::new(),
            ..*self
        };
        for value in &mut restored.initial_state {
            *value = state.real()?;
        }
        restored.rig = read_rig(&self.original, state)?;
        restored.signals = InputSignals::restore(state)?;
        if state.flag()? {
            let system = read_rig(&self.original, state)?;
            let snapshot = read_snapshot(state)?;
            let content = |error| StateError::Content(format!("{error}"));
            let mut run = Run::new(
                system,
                restored.options(),
                snapshot.start,
                snapshot.state,
                snapshot.inputs,
            )
            .map_err(content)?;
            run.restore(&snapshot).map_err(content)?;
            restored.run = Some(Box::new(run));
        }
        *self = restored;
        Ok(())
    }

    fn reset(&mut self) {
        self.rig = self.original;
        self.signals = InputSignals::default();
        self.initial_state = [0.0; STATES];
        self.tolerance = None;
        self.time = self.identity().default_experiment.start_time;
        self.initialised = false;
        self.pending = false;
        self.switched_at_once = false;
        self.run = None;
        self.notices.clear();
    }
}

/// Derivative of this order of a polynomial.
fn derivative(coefficients: &[f64], order: usize, tau: f64) -> f64 {
    (order..coefficients.len()).rev().fold(0.0, |sum, power| {
        let factor: f64 = (power - order + 1..=power)
            .map(|factor| factor as f64)
            .product();
        sum * tau + factor * coefficients[power]
    })
}

fn lift_inputs(inputs: &RigInputs<f64>) -> RigInputs<Dual<1>> {
    RigInputs {
        time: inputs.time,
        voltage: inputs.voltage.map(Dual::constant),
        normal_force: inputs.normal_force.map(Dual::constant),
        normal_force_1: inputs.normal_force_1.map(Dual::constant),
        ..RigInputs::held(Dual::ZERO, Dual::ZERO, Dual::ZERO)
    }
}
