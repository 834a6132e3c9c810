//! What the XML says of the controllers besides their variables.

use crate::controller::ControlLaw;
use crate::cosim::{DefaultExperiment, Identity};
use crate::integrator::Options;

const fn experiment(step_size: f64) -> DefaultExperiment {
    DefaultExperiment {
        start_time: 0.0,
        stop_time: 60.0,
        tolerance: Options::DEFAULT_TOLERANCE,
        step_size,
    }
}

/// Its gains are high: the loop with the rig is stable up to a step of a few tenths of a millisecond.
static SPEED: Identity = Identity {
    model_identifier: "SpeedController",
    description: "PI control of the motor's or the gearbox output's speed by the motor's voltage, with limits and anti-windup",
    default_experiment: experiment(0.0001),
};

static SOFT_TORQUE: Identity = Identity {
    model_identifier: "SoftTorque",
    description: "Drive control by the motor's voltage with the impedance of the shaft: takes up torsional waves and prevents stick-slip",
    default_experiment: experiment(0.001),
};

/// The constants of a kind of controller.
pub(super) fn identity(law: &ControlLaw<f64>) -> &'static Identity {
    match law {
        ControlLaw::Speed(_) => &SPEED,
        ControlLaw::SoftTorque(_) => &SOFT_TORQUE,
    }
}
