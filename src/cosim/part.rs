//! What a [`Component`](super::component::Component) asks of the things that it can be: a rig, a controller, a body.

use super::identity::Identity;
use super::input_signals::InputSignals;
use super::model::{ModelError, Notice, StepEnd};
use super::state::{StateError, StateReader, StateWriter};
use super::variables::{TableError, VariableTable};
use crate::parameter::{ParameterError, Section};

/// What a row of the variable table stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Quantity<S> {
    /// Time.
    Time,
    /// Input at this place.
    Input(usize),
    /// What the course computes over time.
    Signal(S),
    /// Parameter at this position of the part's list.
    Parameter(usize),
}

/// What a signal is differentiated by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Known {
    /// The input at this place.
    Input(usize),
    /// The parameter at this position of the part's list.
    Parameter(usize),
}

/// The table of a part and what each of its rows stands for.
pub(super) type Rows<S> = (VariableTable, Vec<Quantity<S>>);

/// A model's structure with its numbers, as `model.toml` gives them.
pub(super) trait Part: Copy + PartialEq + Send {
    /// What its course computes: outputs and locals.
    type Signal: Copy + Send;

    /// What the XML says of it besides its variables.
    fn identity(&self) -> &'static Identity;

    /// Its variables.
    ///
    /// # Errors
    /// A parameter's unit cannot be expressed in SI base units.
    fn rows(&self) -> Result<Rows<Self::Signal>, TableError>;

    /// Place among the start values of a signal that is a state: it starts from a value that the importer may set, and
    /// no input moves it at once. `None` for other signals.
    fn start_place(signal: Self::Signal) -> Option<usize>;

    /// Why it cannot be handed to a solver from outside, where it cannot.
    fn co_simulation_only(&self) -> Option<&'static str> {
        None
    }

    /// Its sections, in the order of its list of parameters.
    fn sections(&self) -> Vec<(&'static str, &dyn Section<f64>)>;

    /// Replaces a parameter after checking its range.
    ///
    /// # Errors
    /// There is no such parameter, or the value is out of range.
    fn set_parameter_at(&mut self, position: usize, value: f64) -> Result<(), ParameterError>;

    /// Checks every range and every relation between parameters.
    ///
    /// # Errors
    /// Parameters that contradict each other.
    fn check(&self) -> Result<(), ParameterError>;
}

/// The motion of a part over time. It may go ahead of the communication points; the present is read from it.
pub(super) trait Course<const INPUTS: usize, const STARTS: usize>: Sized + Send {
    /// Whose course it is.
    type Part: Part;

    /// The course from `time` [s] on, at the relative `tolerance` or the default one.
    ///
    /// # Errors
    /// There is no such course.
    fn start(
        part: &Self::Part,
        tolerance: Option<f64>,
        time: f64,
        values: &[f64; STARTS],
        signals: &InputSignals<INPUTS>,
    ) -> Result<Self, ModelError>;

    /// Puts other parameters and inputs in force from `now` [s] on, where they are other ones; whether the mode changes
    /// at once because of them.
    ///
    /// # Errors
    /// Parameters that contradict each other, or a course that cannot go on.
    fn change(
        &mut self,
        part: &Self::Part,
        signals: &InputSignals<INPUTS>,
        now: f64,
    ) -> Result<bool, ModelError>;

    /// Whether it is known up to `until` [s] without an event on the way.
    fn covers(&mut self, until: f64) -> bool;

    /// Goes on from `begin` [s] until it covers `until`, or with `stop_at_switch` to the first switch after `begin`.
    ///
    /// # Errors
    /// It cannot go on; [`reached`](Self::reached) tells where it is.
    fn advance(
        &mut self,
        begin: f64,
        until: f64,
        stop_at_switch: bool,
    ) -> Result<StepEnd, ModelError>;

    /// Start [s] of the stretch that it is on.
    fn reached(&self) -> f64;

    /// A real signal, or its time derivative of the given order, at `time` [s]; `None` for a flag.
    fn signal(&self, signal: Signal<Self, INPUTS, STARTS>, order: u32, time: f64) -> Option<f64>;

    /// A Boolean signal; `None` for a real one.
    fn flag(&self, signal: Signal<Self, INPUTS, STARTS>) -> Option<bool>;

    /// Partial derivative of a real signal at `time` [s], states and mode held; `None` for a flag.
    ///
    /// # Errors
    /// It does not exist.
    fn partial(
        &self,
        unknown: Signal<Self, INPUTS, STARTS>,
        known: Known,
        time: f64,
    ) -> Result<Option<f64>, ModelError>;

    /// Hands on, and forgets, what happened.
    fn drain_notices(&mut self, tell: &mut dyn FnMut(&dyn Notice));

    /// Writes all that its future depends on.
    fn save(&self, state: &mut StateWriter);

    /// The opposite of [`save`](Self::save), for a part built like `original`.
    ///
    /// # Errors
    /// The state is not that of such a course.
    fn restore(
        original: &Self::Part,
        tolerance: Option<f64>,
        state: &mut StateReader<'_>,
    ) -> Result<Self, StateError>;
}

/// The signals of a course's part.
pub(super) type Signal<C, const INPUTS: usize, const STARTS: usize> =
    <<C as Course<INPUTS, STARTS>>::Part as Part>::Signal;

/// Writes the values of all parameters.
pub(super) fn write_parameters(part: &impl Part, state: &mut StateWriter) {
    for (_, section) in part.sections() {
        for place in 0..section.infos().len() {
            state.real(section.get(place));
        }
    }
}

/// The part built like `original` with the values that were written.
pub(super) fn read_parameters<P: Part>(
    original: &P,
    state: &mut StateReader<'_>,
) -> Result<P, StateError> {
    let mut part = *original;
    let count: usize = original
        .sections()
        .iter()
        .map(|(_, section)| section.infos().len())
        .sum();
    for position in 0..count {
        part.set_parameter_at(position, state.real()?)
            .map_err(|error| StateError::Content(error.to_string()))?;
    }
    Ok(part)
}
