//! A rig behind both model interfaces, for an importer that brings the solver.

use super::super::state::{read_mode, write_mode};
use super::super::variables::{CHANNELS, Signal, is_exchangeable};
use super::run::{PLACES, Run};
use super::sensitivities::Seeds;
use crate::cosim::exchange::{EventOutcome, ModelExchange};
use crate::cosim::part::{Part, Quantity, read_parameters, write_parameters};
use crate::cosim::{
    CoSimulationModel, Identity, ModelError, Notice, StateError, StateReader, StateWriter, StepEnd,
    Token, VariableTable,
};
use crate::parameter;
use crate::plant::Rig;
use std::mem;
use std::sync::Arc;

/// A rig for model exchange.
pub(in crate::cosim) struct RigExchange {
    table: Arc<VariableTable>,
    quantities: Vec<Quantity<Signal>>,
    token: Token,
    original: Rig<f64>,
    /// The rig with the parameters that are set.
    rig: Rig<f64>,
    inputs: [f64; CHANNELS],
    start_values: [f64; PLACES],
    time: f64,
    /// Places of the continuous states in the rig's state, and their nominal values.
    places: Vec<usize>,
    nominals: Vec<f64>,
    initialised: bool,
    /// Whether parameters were set that the run does not know yet; before the start also inputs and start values.
    pending: bool,
    in_event: bool,
    run: Option<Box<Run>>,
    shown: [f64; PLACES],
}

impl RigExchange {
    /// The component that `rig`, read from `model_toml`, is.
    ///
    /// # Errors
    /// A unit that is none, or a rig that needs its past.
    pub(in crate::cosim) fn new(rig: Rig<f64>, model_toml: &str) -> Result<Self, ModelError> {
        if !is_exchangeable(&rig) {
            return Err(ModelError(
                "a rig with [sensor_delay] is for co-simulation only: what its sensors show is no function of its state"
                    .into(),
            ));
        }
        let (table, quantities) = rig.rows().map_err(ModelError::from_display)?;
        let token = Token::new(&table, model_toml);
        let nominals = table.states().map(|state| state.nominal.unwrap_or(1.0));
        Ok(Self {
            nominals: nominals.collect(),
            table: Arc::new(table),
            quantities,
            token,
            original: rig,
            rig,
            inputs: [0.0; CHANNELS],
            start_values: [0.0; PLACES],
            time: rig.identity().default_experiment.start_time,
            places: rig.state_places(),
            initialised: false,
            pending: false,
            in_event: false,
            run: None,
            shown: [0.0; PLACES],
        })
    }

    fn quantity(&self, value_reference: u32) -> Result<Quantity<Signal>, ModelError> {
        self.quantities
            .get(value_reference as usize)
            .copied()
            .ok_or_else(|| ModelError(format!("there is no value reference {value_reference}")))
    }

    /// The run with everything that was set.
    fn run(&mut self) -> Result<&mut Run, ModelError> {
        let afresh = self.run.is_none() || (self.pending && !self.initialised);
        if afresh {
            let run = Run::start(self.rig, self.time, self.start_values, self.inputs)?;
            self.run = Some(Box::new(run));
        } else if self.pending
            && let Some(run) = &mut self.run
            && *run.rig() != self.rig
        {
            run.set_rig(self.rig)?;
        }
        self.pending = false;
        self.run
            .as_deref_mut()
            .ok_or_else(|| ModelError("the run did not start".into()))
    }

    /// The refusal of what only some kinds of variables can.
    fn not(&self, value_reference: u32, kind: &str) -> ModelError {
        let variable = self.table.get(value_reference);
        let name = variable.map_or("", |variable| &variable.name);
        ModelError(format!("\"{name}\" is not {kind}"))
    }

    fn only_for_co_simulation(what: &str) -> ModelError {
        ModelError(format!(
            "{what} is for co-simulation; this instance is for model exchange"
        ))
    }
}

impl ModelExchange for RigExchange {
    fn state_count(&self) -> usize {
        self.places.len()
    }

    fn indicator_count(&self) -> usize {
        self.table.event_indicators().count()
    }

    fn set_time(&mut self, time: f64) {
        self.time = time;
        if let Some(run) = &mut self.run
            && run.time != time
        {
            run.time = time;
            run.evaluated = false;
        }
    }

    fn set_states(&mut self, states: &[f64]) {
        if let Some(run) = &mut self.run {
            for (place, value) in self.places.iter().zip(states) {
                run.state[*place] = *value;
            }
            run.evaluated = false;
        }
    }

    fn states(&mut self) -> Result<&[f64], ModelError> {
        let state = self.run()?.state;
        for (shown, place) in self.shown.iter_mut().zip(&self.places) {
            *shown = state[*place];
        }
        Ok(&self.shown[..self.places.len()])
    }

    fn nominals(&self) -> &[f64] {
        &self.nominals
    }

    fn derivatives(&mut self) -> Result<&[f64], ModelError> {
        let rates = self.run()?.evaluate().rates();
        for (shown, place) in self.shown.iter_mut().zip(&self.places) {
            *shown = rates[*place];
        }
        Ok(&self.shown[..self.places.len()])
    }

    fn indicators(&mut self) -> Result<&[f64], ModelError> {
        Ok(self.run()?.indicators())
    }

    fn enter_event_mode(&mut self) {
        self.in_event = true;
    }

    fn enter_continuous_time_mode(&mut self) {
        self.in_event = false;
    }

    fn update_discrete_states(&mut self) -> Result<EventOutcome, ModelError> {
        self.run()?.update()
    }

    fn complete_step(&mut self) -> Result<bool, ModelError> {
        Ok(self.run()?.complete_step())
    }
}

impl CoSimulationModel for RigExchange {
    fn identity(&self) -> &'static Identity {
        self.original.identity()
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

    fn set_up(&mut self, start_time: f64, _tolerance: Option<f64>) {
        self.time = start_time;
        self.run = None;
    }

    fn initialise(&mut self) -> Result<(), ModelError> {
        self.run()?;
        (self.initialised, self.in_event) = (true, true);
        Ok(())
    }

    fn real(&mut self, value_reference: u32) -> Result<f64, ModelError> {
        match self.quantity(value_reference)? {
            Quantity::Time => Ok(self.time),
            Quantity::Input(place) => Ok(self.inputs[place]),
            Quantity::Parameter(position) => parameter::value_at(&self.rig.sections(), position)
                .ok_or_else(|| self.not(value_reference, "a parameter")),
            Quantity::Signal(Signal::State(place)) if !self.initialised => {
                Ok(self.start_values[place])
            }
            Quantity::Signal(signal) => {
                let value = self.run()?.real(signal);
                value.ok_or_else(|| self.not(value_reference, "a real"))
            }
        }
    }

    fn boolean(&mut self, value_reference: u32) -> Result<bool, ModelError> {
        let flag = match self.quantity(value_reference)? {
            Quantity::Signal(signal) => self.run()?.flag(signal),
            _ => None,
        };
        flag.ok_or_else(|| self.not(value_reference, "a Boolean"))
    }

    fn set_real(&mut self, value_reference: u32, value: f64) -> Result<(), ModelError> {
        match self.quantity(value_reference)? {
            Quantity::Input(place) => {
                self.inputs[place] = value;
                self.pending |= !self.initialised;
                if let Some(run) = &mut self.run {
                    run.set_input(place, value, self.in_event || !self.initialised);
                }
            }
            Quantity::Parameter(position) => {
                self.rig
                    .set_parameter_at(position, value)
                    .map_err(ModelError::from_display)?;
                self.pending = true;
            }
            Quantity::Signal(signal) => match <Rig<f64> as Part>::start_place(signal) {
                Some(place) if !self.initialised => {
                    self.start_values[place] = value;
                    self.pending = true;
                }
                Some(place) => {
                    let run = self.run()?;
                    run.state[place] = value;
                    run.evaluated = false;
                }
                None => return Err(self.not(value_reference, "to be set: it is computed")),
            },
            Quantity::Time => return Err(self.not(value_reference, "to be set")),
        }
        Ok(())
    }

    fn set_input_derivative(&mut self, _: u32, _: u32, _: f64) -> Result<(), ModelError> {
        Err(Self::only_for_co_simulation("a derivative of an input"))
    }

    fn output_derivative(&mut self, _: u32, _: u32) -> Result<f64, ModelError> {
        Err(Self::only_for_co_simulation(
            "a time derivative of an output",
        ))
    }

    fn partial_derivative(&mut self, unknown: u32, known: u32) -> Result<f64, ModelError> {
        let values = self.directional_derivatives(&[unknown], &[(known, 1.0)])?;
        values
            .first()
            .copied()
            .ok_or_else(|| self.not(unknown, "a real"))
    }

    fn directional_derivatives(
        &mut self,
        unknowns: &[u32],
        direction: &[(u32, f64)],
    ) -> Result<Vec<f64>, ModelError> {
        let mut seeds = Seeds::default();
        for (known, seed) in direction {
            match self.quantity(*known)? {
                Quantity::Time => seeds.time += seed,
                Quantity::Input(place) => seeds.inputs[place] += seed,
                Quantity::Signal(Signal::State(place)) => seeds.state[place] += seed,
                Quantity::Parameter(position) => seeds.parameters.push((position, *seed)),
                Quantity::Signal(_) => {
                    return Err(self.not(*known, "time, a state, an input or a parameter"));
                }
            }
        }
        let mut signals = Vec::with_capacity(unknowns.len());
        for unknown in unknowns {
            match self.quantity(*unknown)? {
                Quantity::Signal(signal) => signals.push(signal),
                _ => return Err(self.not(*unknown, "computed")),
            }
        }
        self.run()?.directional(&signals, &seeds)
    }

    fn step(&mut self, _: f64, _: bool) -> Result<StepEnd, ModelError> {
        Err(Self::only_for_co_simulation("a step"))
    }

    fn drain_notices(&mut self, tell: &mut dyn FnMut(&dyn Notice)) {
        if let Some(run) = &mut self.run {
            mem::take(&mut run.notices)
                .iter()
                .for_each(|notice| tell(notice));
        }
    }

    fn save(&self, state: &mut StateWriter) {
        state.real(self.time);
        for flag in [self.initialised, self.pending, self.in_event] {
            state.flag(flag);
        }
        let numbers = self.start_values.iter().chain(&self.inputs);
        numbers.for_each(|value| state.real(*value));
        write_parameters(&self.rig, state);
        state.flag(self.run.is_some());
        if let Some(run) = &self.run {
            write_parameters(run.rig(), state);
            let numbers = run.state.iter().chain(run.inputs());
            numbers.for_each(|value| state.real(*value));
            state.real(run.time);
            state.flag(run.jumped);
            state.flag(run.force_moves());
            write_mode(&run.mode, state);
        }
    }

    fn restore(&mut self, state: &mut StateReader<'_>) -> Result<(), StateError> {
        let time = state.real()?;
        let [initialised, pending, in_event] = [state.flag()?, state.flag()?, state.flag()?];
        let (mut start_values, mut inputs) = ([0.0; PLACES], [0.0; CHANNELS]);
        for value in start_values.iter_mut().chain(&mut inputs) {
            *value = state.real()?;
        }
        let rig = read_parameters(&self.original, state)?;
        let run = if state.flag()? {
            let rig = read_parameters(&self.original, state)?;
            let (mut values, mut inputs) = ([0.0; PLACES], [0.0; CHANNELS]);
            for value in values.iter_mut().chain(&mut inputs) {
                *value = state.real()?;
            }
            let (time, jumped, force_moves) = (state.real()?, state.flag()?, state.flag()?);
            let mode = read_mode(state)?;
            let mut run = Run::resume(rig, mode, time, values, inputs);
            run.jumped = jumped;
            run.set_force_moves(force_moves);
            Some(Box::new(run))
        } else {
            None
        };
        (self.time, self.rig, self.inputs) = (time, rig, inputs);
        (self.start_values, self.run) = (start_values, run);
        (self.initialised, self.pending, self.in_event) = (initialised, pending, in_event);
        Ok(())
    }

    fn reset(&mut self) {
        self.rig = self.original;
        (self.inputs, self.start_values) = ([0.0; CHANNELS], [0.0; PLACES]);
        self.time = self.identity().default_experiment.start_time;
        (self.initialised, self.pending, self.in_event) = (false, false, false);
        self.run = None;
    }

    fn exchange(&mut self) -> Option<&mut dyn ModelExchange> {
        Some(self)
    }
}
