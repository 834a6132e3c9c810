//! What the XML says of bodies besides their variables.

use crate::body::Kind;
use crate::cosim::{DefaultExperiment, Identity};
use crate::integrator::Options;

const EXPERIMENT: DefaultExperiment = DefaultExperiment {
    start_time: 0.0,
    stop_time: 10.0,
    tolerance: Options::DEFAULT_TOLERANCE,
    step_size: 0.01,
};

static DRIVE: Identity = Identity {
    model_identifier: "Drive",
    description: "Mass or inertia under a force, with friction that can hold it",
    default_experiment: EXPERIMENT,
};

static PENDULUM: Identity = Identity {
    model_identifier: "Pendulum",
    description: "Body that swings about a fixed axis, with friction that can hold it",
    default_experiment: EXPERIMENT,
};

static JOINT: Identity = Identity {
    model_identifier: "Joint",
    description: "Arm with gravity that a motor turns, with friction that can hold it",
    default_experiment: EXPERIMENT,
};

/// The constants of a kind of body.
pub(super) fn identity(kind: Kind) -> &'static Identity {
    match kind {
        Kind::Pendulum => &PENDULUM,
        Kind::Joint => &JOINT,
        // The others do not move by themselves: no body is one of them.
        Kind::Drive | Kind::Contact | Kind::Balance | Kind::Fmu => &DRIVE,
    }
}
