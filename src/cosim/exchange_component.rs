//! A rig or a controller behind both model interfaces, for an importer that brings the solver.

use super::exchange::{EventOutcome, ModelExchange};
use super::identity::Identity;
use super::model::{CoSimulationModel, ModelError, Notice, StepEnd};
use super::part::{Part, Quantity, read_parameters, write_parameters};
use super::state::{StateError, StateReader, StateWriter};
use super::token::Token;
use super::variables::VariableTable;
use crate::parameter;
use std::sync::Arc;

/// A direction: how much of each known.
#[derive(Clone, Debug)]
pub(super) struct Seeds<const INPUTS: usize, const STATES: usize> {
    pub(super) time: f64,
    pub(super) state: [f64; STATES],
    pub(super) inputs: [f64; INPUTS],
    /// Position in the list of parameters and share.
    pub(super) parameters: Vec<(usize, f64)>,
}

/// A part at the instant that the importer names: what it computes there, and its modes.
pub(super) trait Run<const INPUTS: usize, const STATES: usize>: Sized + Send {
    /// What runs.
    type Part: Part;

    /// Places of the continuous states among the start values, in the order of the table.
    fn places(part: &Self::Part) -> Vec<usize>;

    /// The run that starts at `time` [s] from `states`, in the modes that they want.
    ///
    /// # Errors
    /// Parameters that contradict each other.
    fn start(
        part: &Self::Part,
        time: f64,
        states: [f64; STATES],
        inputs: [f64; INPUTS],
    ) -> Result<Self, ModelError>;

    /// The part in force.
    fn part(&self) -> &Self::Part;

    /// Puts other parameters in force.
    ///
    /// # Errors
    /// Parameters that contradict each other.
    fn set_part(&mut self, part: &Self::Part) -> Result<(), ModelError>;

    /// Puts the present time [s] in force.
    fn set_time(&mut self, time: f64);

    /// Puts another value of an input in force, `at_event` where it may jump.
    fn set_input(&mut self, place: usize, value: f64, at_event: bool);

    /// The present states.
    fn states(&self) -> &[f64; STATES];

    /// The same, to be changed.
    fn states_mut(&mut self) -> &mut [f64; STATES];

    /// Time derivatives of the states.
    fn rates(&mut self) -> [f64; STATES];

    /// The event indicators.
    fn indicators(&mut self) -> &[f64];

    /// A real signal; `None` for a flag.
    fn real(&mut self, signal: <Self::Part as Part>::Signal) -> Option<f64>;

    /// A Boolean signal; `None` for a real one.
    fn flag(&self, signal: <Self::Part as Part>::Signal) -> Option<bool>;

    /// Brings the modes to what holds now.
    ///
    /// # Errors
    /// Modes that change without end.
    fn update(&mut self) -> Result<EventOutcome, ModelError>;

    /// Takes the present point as one of the solution; whether an event is due.
    fn complete_step(&mut self) -> bool;

    /// Derivatives of the `unknowns` along `seeds`, states and modes held.
    ///
    /// # Errors
    /// A parameter that is out of range.
    fn directional(
        &mut self,
        unknowns: &[<Self::Part as Part>::Signal],
        seeds: &Seeds<INPUTS, STATES>,
    ) -> Result<Vec<f64>, ModelError>;

    /// Hands on, and forgets, what happened.
    fn drain_notices(&mut self, tell: &mut dyn FnMut(&dyn Notice));

    /// Writes all that its future depends on.
    fn save(&self, state: &mut StateWriter);

    /// The opposite of [`save`](Self::save), for a part built like `original`.
    ///
    /// # Errors
    /// The state is not that of such a run.
    fn restore(original: &Self::Part, state: &mut StateReader<'_>) -> Result<Self, StateError>;
}

/// A part for model exchange.
pub(super) struct ExchangeComponent<
    R: Run<INPUTS, STATES>,
    const INPUTS: usize,
    const STATES: usize,
> {
    table: Arc<VariableTable>,
    quantities: Vec<Quantity<<R::Part as Part>::Signal>>,
    token: Token,
    original: R::Part,
    /// The part with the parameters that are set.
    part: R::Part,
    inputs: [f64; INPUTS],
    start_values: [f64; STATES],
    time: f64,
    /// Places of the continuous states in the run's states, and their nominal values.
    places: Vec<usize>,
    nominals: Vec<f64>,
    initialised: bool,
    /// Whether parameters were set that the run does not know yet; before the start also inputs and start values.
    pending: bool,
    in_event: bool,
    run: Option<Box<R>>,
    shown: [f64; STATES],
}

impl<R: Run<INPUTS, STATES>, const INPUTS: usize, const STATES: usize>
    ExchangeComponent<R, INPUTS, STATES>
{
    /// The component that `part`, read from `model_toml`, is.
    ///
    /// # Errors
    /// A unit that is none, or a part that is for co-simulation only.
    pub(super) fn new(part: R::Part, model_toml: &str) -> Result<Self, ModelError> {
        if let Some(reason) = part.co_simulation_only() {
            return Err(ModelError(reason.to_owned()));
        }
        let (table, quantities) = part.rows().map_err(ModelError::from_display)?;
        let token = Token::new(&table, model_toml);
        let nominals = table.states().map(|state| state.nominal.unwrap_or(1.0));
        Ok(Self {
            nominals: nominals.collect(),
            table: Arc::new(table),
            quantities,
            token,
            original: part,
            part,
            inputs: [0.0; INPUTS],
            start_values: [0.0; STATES],
            time: part.identity().default_experiment.start_time,
            places: R::places(&part),
            initialised: false,
            pending: false,
            in_event: false,
            run: None,
            shown: [0.0; STATES],
        })
    }

    fn quantity(
        &self,
        value_reference: u32,
    ) -> Result<Quantity<<R::Part as Part>::Signal>, ModelError> {
        self.quantities
            .get(value_reference as usize)
            .copied()
            .ok_or_else(|| ModelError(format!("there is no value reference {value_reference}")))
    }

    /// The run with everything that was set.
    fn run(&mut self) -> Result<&mut R, ModelError> {
        let afresh = self.run.is_none() || (self.pending && !self.initialised);
        if afresh {
            let run = R::start(&self.part, self.time, self.start_values, self.inputs)?;
            self.run = Some(Box::new(run));
        } else if self.pending
            && let Some(run) = &mut self.run
            && *run.part() != self.part
        {
            run.set_part(&self.part)?;
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

impl<R: Run<INPUTS, STATES>, const INPUTS: usize, const STATES: usize> ModelExchange
    for ExchangeComponent<R, INPUTS, STATES>
{
    fn state_count(&self) -> usize {
        self.places.len()
    }

    fn indicator_count(&self) -> usize {
        self.table.event_indicators().count()
    }

    fn set_time(&mut self, time: f64) {
        self.time = time;
        if let Some(run) = &mut self.run {
            run.set_time(time);
        }
    }

    fn set_states(&mut self, states: &[f64]) {
        if let Some(run) = &mut self.run {
            let present = run.states_mut();
            for (place, value) in self.places.iter().zip(states) {
                present[*place] = *value;
            }
        }
    }

    fn states(&mut self) -> Result<&[f64], ModelError> {
        let state = *self.run()?.states();
        for (shown, place) in self.shown.iter_mut().zip(&self.places) {
            *shown = state[*place];
        }
        Ok(&self.shown[..self.places.len()])
    }

    fn nominals(&self) -> &[f64] {
        &self.nominals
    }

    fn derivatives(&mut self) -> Result<&[f64], ModelError> {
        let rates = self.run()?.rates();
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

impl<R: Run<INPUTS, STATES>, const INPUTS: usize, const STATES: usize> CoSimulationModel
    for ExchangeComponent<R, INPUTS, STATES>
{
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
            Quantity::Parameter(position) => parameter::value_at(&self.part.sections(), position)
                .ok_or_else(|| self.not(value_reference, "a parameter")),
            Quantity::Signal(signal) => match R::Part::start_place(signal) {
                Some(place) if !self.initialised => Ok(self.start_values[place]),
                _ => {
                    let value = self.run()?.real(signal);
                    value.ok_or_else(|| self.not(value_reference, "a real"))
                }
            },
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
                self.part
                    .set_parameter_at(position, value)
                    .map_err(ModelError::from_display)?;
                self.pending = true;
            }
            Quantity::Signal(signal) => match R::Part::start_place(signal) {
                Some(place) if !self.initialised => {
                    self.start_values[place] = value;
                    self.pending = true;
                }
                Some(place) => self.run()?.states_mut()[place] = value,
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
        let mut seeds = Seeds {
            time: 0.0,
            state: [0.0; STATES],
            inputs: [0.0; INPUTS],
            parameters: Vec::new(),
        };
        for (known, seed) in direction {
            match self.quantity(*known)? {
                Quantity::Time => seeds.time += seed,
                Quantity::Input(place) => seeds.inputs[place] += seed,
                Quantity::Parameter(position) => seeds.parameters.push((position, *seed)),
                Quantity::Signal(signal) => match R::Part::start_place(signal) {
                    Some(place) => seeds.state[place] += seed,
                    None => return Err(self.not(*known, "time, a state, an input or a parameter")),
                },
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
            run.drain_notices(tell);
        }
    }

    fn save(&self, state: &mut StateWriter) {
        state.real(self.time);
        for flag in [self.initialised, self.pending, self.in_event] {
            state.flag(flag);
        }
        let numbers = self.start_values.iter().chain(&self.inputs);
        numbers.for_each(|value| state.real(*value));
        write_parameters(&self.part, state);
        state.flag(self.run.is_some());
        if let Some(run) = &self.run {
            run.save(state);
        }
    }

    fn restore(&mut self, state: &mut StateReader<'_>) -> Result<(), StateError> {
        let time = state.real()?;
        let [initialised, pending, in_event] = [state.flag()?, state.flag()?, state.flag()?];
        let (mut start_values, mut inputs) = ([0.0; STATES], [0.0; INPUTS]);
        for value in start_values.iter_mut().chain(&mut inputs) {
            *value = state.real()?;
        }
        let part = read_parameters(&self.original, state)?;
        let run = if state.flag()? {
            Some(Box::new(R::restore(&self.original, state)?))
        } else {
            None
        };
        (self.time, self.part, self.inputs) = (time, part, inputs);
        (self.start_values, self.run) = (start_values, run);
        (self.initialised, self.pending, self.in_event) = (initialised, pending, in_event);
        Ok(())
    }

    fn reset(&mut self) {
        self.part = self.original;
        (self.inputs, self.start_values) = ([0.0; INPUTS], [0.0; STATES]);
        self.time = self.identity().default_experiment.start_time;
        (self.initialised, self.pending, self.in_event) = (false, false, false);
        self.run = None;
    }

    fn exchange(&mut self) -> Option<&mut dyn ModelExchange> {
        Some(self)
    }
}
