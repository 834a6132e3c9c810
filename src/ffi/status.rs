//! Statuses and phases, shared by both standards, and refusals.

use std::fmt;

/// What both standards return from a call; the numbers agree.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// Done.
    Ok = 0,
    /// Done, with a reservation that is in the log.
    Warning = 1,
    /// Not done; the instance is as it was before the call.
    Discard = 2,
    /// Not done; the instance needs a reset or a saved state.
    Error = 3,
}

/// Which of the two C interfaces an instance was made through.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Interface {
    Fmi2,
    Fmi3,
}

/// Where in its life an instance is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u16)]
pub(super) enum Phase {
    Instantiated = 1 << 0,
    Configuration = 1 << 1,
    Initialization = 1 << 2,
    /// FMI 2: step complete. FMI 3: step mode.
    Step = 1 << 3,
    Event = 1 << 4,
    Terminated = 1 << 5,
    /// FMI 2 only: a call returned an error. FMI 3 calls this terminated.
    Failed = 1 << 6,
    /// Model exchange only.
    ContinuousTime = 1 << 7,
    /// FMI 3 only: the importer's callback is looking at an instant inside a step.
    IntermediateUpdate = 1 << 8,
}

const ALL_PHASES: [Phase; 9] = [
    Phase::Instantiated,
    Phase::Configuration,
    Phase::Initialization,
    Phase::Step,
    Phase::Event,
    Phase::ContinuousTime,
    Phase::Terminated,
    Phase::Failed,
    Phase::IntermediateUpdate,
];

impl Phase {
    /// The standard's name of the phase.
    pub(super) fn name(self, interface: Interface) -> &'static str {
        match (self, interface) {
            (Self::Instantiated, Interface::Fmi2) => "instantiated",
            (Self::Instantiated, Interface::Fmi3) => "Instantiated",
            (Self::Configuration, _) => "Configuration Mode",
            (Self::Initialization, _) => "Initialization Mode",
            (Self::Step, Interface::Fmi2) => "stepComplete",
            (Self::Step, Interface::Fmi3) => "Step Mode",
            (Self::Event, _) => "Event Mode",
            (Self::ContinuousTime, _) => "Continuous-Time Mode",
            (Self::Terminated, Interface::Fmi2) => "terminated",
            (Self::Terminated, Interface::Fmi3) => "Terminated",
            (Self::Failed, _) => "error",
            (Self::IntermediateUpdate, _) => "Intermediate Update Mode",
        }
    }

    /// Whether instances of this kind, for model `exchange` or for co-simulation, can be in the phase.
    fn exists(self, interface: Interface, exchange: bool) -> bool {
        match self {
            Self::Step => !exchange,
            Self::IntermediateUpdate => !exchange && interface == Interface::Fmi3,
            Self::ContinuousTime => exchange,
            Self::Event => exchange || interface == Interface::Fmi3,
            Self::Configuration => interface == Interface::Fmi3,
            Self::Failed => interface == Interface::Fmi2,
            Self::Instantiated | Self::Initialization | Self::Terminated => true,
        }
    }

    /// The phase that a saved state calls by this number.
    pub(super) fn from_number(number: u64) -> Option<Self> {
        ALL_PHASES.into_iter().find(|phase| *phase as u64 == number)
    }
}

/// A set of phases: those in which a function may be called.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Phases(u16);

impl Phases {
    /// The set of these phases.
    pub(super) const fn of(phases: &[Phase]) -> Self {
        let mut set = 0;
        let mut place = 0;
        while place < phases.len() {
            set |= phases[place] as u16;
            place += 1;
        }
        Self(set)
    }

    /// Whether the phase belongs to the set.
    #[inline]
    pub(super) fn contains(self, phase: Phase) -> bool {
        self.0 & phase as u16 != 0
    }

    /// The standard's names of those phases that an instance of this kind can be in, for a message.
    pub(super) fn names(self, interface: Interface, exchange: bool) -> String {
        let names: Vec<_> = ALL_PHASES
            .into_iter()
            .filter(|phase| self.contains(*phase) && phase.exists(interface, exchange))
            .map(|phase| phase.name(interface))
            .collect();
        names.join(", ")
    }
}

/// A call that is not carried out as asked: the status that it returns and the line that it logs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Refusal {
    pub(super) status: Status,
    pub(super) message: String,
}

impl Refusal {
    pub(super) fn warning(message: impl fmt::Display) -> Self {
        Self {
            status: Status::Warning,
            message: message.to_string(),
        }
    }

    pub(super) fn discard(message: impl fmt::Display) -> Self {
        Self {
            status: Status::Discard,
            message: message.to_string(),
        }
    }

    pub(super) fn error(message: impl fmt::Display) -> Self {
        Self {
            status: Status::Error,
            message: message.to_string(),
        }
    }
}

/// Outcome of the body of an exported function.
pub(super) type Outcome = Result<(), Refusal>;

/// Every phase, but not the middle of a step.
pub(super) const ANY: Phases =
    Phases(Phases::of(&ALL_PHASES).0 & !(Phase::IntermediateUpdate as u16));
