//! Which call is legal in which state: the tables of the standards, written down from the standards and
//! not from the library.
//!
//! FMI 2.0.5, section 4.2.4 (table of allowed function calls); FMI 3.0.2, sections 2.3 and 4.2.
//! One reading is deliberate: FMI 2 importers that skip `fmi2SetupExperiment` get the default start time.

use clap::ValueEnum;
use stickslip::ffi::Status;

/// Either version of the standard.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Version {
    /// FMI 2.0.5.
    #[value(name = "2")]
    Two,
    /// FMI 3.0.2.
    #[value(name = "3")]
    Three,
}

impl Version {
    /// The one that it is not.
    #[must_use]
    pub fn other(self) -> Self {
        match self {
            Self::Two => Self::Three,
            Self::Three => Self::Two,
        }
    }
}

/// States of an instance; a step is never in progress when another call arrives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// After instantiation or reset.
    Instantiated,
    /// FMI 3: configuration mode.
    Configuration,
    /// Initialization mode.
    Initialization,
    /// FMI 2: step complete. FMI 3: step mode.
    Step,
    /// FMI 3: event mode.
    Event,
    /// After `Terminate`; in FMI 3 also after an error.
    Terminated,
    /// FMI 2: after an error.
    Error,
}

/// Functions, or families of functions that share a row of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Function {
    /// `fmi2SetupExperiment`.
    SetUp,
    /// `EnterInitializationMode`.
    EnterInitialization,
    /// `ExitInitializationMode`.
    ExitInitialization,
    /// `fmi3EnterConfigurationMode`.
    EnterConfiguration,
    /// `fmi3ExitConfigurationMode`.
    ExitConfiguration,
    /// `fmi3EnterEventMode`.
    EnterEvent,
    /// `fmi3EvaluateDiscreteStates` and `fmi3UpdateDiscreteStates`.
    UpdateStates,
    /// `fmi3EnterStepMode`.
    EnterStep,
    /// `Terminate`.
    Terminate,
    /// `Reset`, `SetDebugLogging` and everything about saved states.
    Always,
    /// Getters.
    Get,
    /// Setters.
    Set,
    /// `fmi2SetRealInputDerivatives`.
    InputDerivatives,
    /// `GetRealOutputDerivatives`, `fmi3GetOutputDerivatives`.
    OutputDerivatives,
    /// `GetDirectionalDerivative`.
    Directional,
    /// `DoStep`.
    Step,
    /// `fmi2CancelStep`.
    Cancel,
    /// `fmi2Get…Status`.
    GetStatus,
}

/// Whether the standard allows `function` in `state`.
#[must_use]
pub fn is_legal(version: Version, function: Function, state: State) -> bool {
    use Function as F;
    use State as S;
    let states: &[State] = match (version, function) {
        (_, F::Always) => return true,
        (Version::Two, F::SetUp) | (_, F::EnterInitialization) => &[S::Instantiated],
        (_, F::ExitInitialization) => &[S::Initialization],
        (_, F::Step) => &[S::Step],
        (Version::Two, F::Terminate) => &[S::Step],
        (Version::Two, F::Get | F::Directional) => {
            &[S::Initialization, S::Step, S::Terminated, S::Error]
        }
        (Version::Two, F::Set | F::InputDerivatives) => {
            &[S::Instantiated, S::Initialization, S::Step]
        }
        (Version::Two, F::OutputDerivatives | F::GetStatus) => &[S::Step, S::Terminated, S::Error],
        (Version::Three, F::EnterConfiguration) => &[S::Instantiated],
        (Version::Three, F::ExitConfiguration) => &[S::Configuration],
        (Version::Three, F::EnterEvent) => &[S::Step],
        (Version::Three, F::UpdateStates | F::EnterStep) => &[S::Event],
        (Version::Three, F::Terminate) => &[S::Step, S::Event],
        (Version::Three, F::Get) => &[
            S::Instantiated,
            S::Initialization,
            S::Step,
            S::Event,
            S::Terminated,
        ],
        (Version::Three, F::Set) => &[
            S::Instantiated,
            S::Configuration,
            S::Initialization,
            S::Step,
            S::Event,
        ],
        (Version::Three, F::OutputDerivatives) => &[S::Step, S::Terminated],
        (Version::Three, F::Directional) => &[S::Initialization, S::Step, S::Event, S::Terminated],
        // Not of this version, or legal only while a step is in progress.
        _ => &[],
    };
    states.contains(&state)
}

/// Where a call that returned `status` leaves an instance that was, or would be, in `state`.
#[must_use]
pub fn state_after(version: Version, state: State, status: Status) -> State {
    match (status, version) {
        (Status::Error, Version::Two) => State::Error,
        (Status::Error, Version::Three) => State::Terminated,
        _ => state,
    }
}
