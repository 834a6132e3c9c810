//! What the XML says of a component besides its variables.

/// Constants of a component that go into its XML and that its behaviour must keep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Identity {
    /// `modelIdentifier`: name of the binary and prefix of the files that hold the component.
    pub model_identifier: &'static str,
    /// One line for people.
    pub description: &'static str,
    /// What an importer simulates if nobody says otherwise.
    pub default_experiment: DefaultExperiment,
}

/// What an importer simulates if nobody says otherwise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DefaultExperiment {
    /// Start time [s].
    pub start_time: f64,
    /// Stop time [s].
    pub stop_time: f64,
    /// Relative tolerance of the integrator.
    pub tolerance: f64,
    /// Communication step [s].
    pub step_size: f64,
}

/// Highest order of the input derivatives that `fmi2SetRealInputDerivatives` takes.
pub const MAX_INPUT_DERIVATIVE_ORDER: u32 = 3;

/// Highest order of the output derivatives that can be read (`maxOutputDerivativeOrder`).
pub const MAX_OUTPUT_DERIVATIVE_ORDER: u32 = 2;

/// A log category with its description, as both standards' XML lists it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LogCategory {
    /// Name, from the standard list of FMI 2.
    pub name: &'static str,
    /// One line for people.
    pub description: &'static str,
}

/// Every log category of the component; the log uses no other.
pub const LOG_CATEGORIES: [LogCategory; 5] = [
    LogCategory {
        name: "logEvents",
        description: "Switches between sticking and slipping, jumps of the friction torque, voltage limits reached and left",
    },
    LogCategory {
        name: "logStatusWarning",
        description: "Calls that were carried out with a reservation",
    },
    LogCategory {
        name: "logStatusDiscard",
        description: "Calls that were refused and left the instance as it was",
    },
    LogCategory {
        name: "logStatusError",
        description: "Calls that failed; the instance needs a reset or a saved state",
    },
    LogCategory {
        name: "logAll",
        description: "All messages",
    },
];
