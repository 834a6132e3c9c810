//! What the XML says of the rigs besides their variables.

use crate::cosim::{DefaultExperiment, Identity};
use crate::integrator::Options;
use crate::plant::RigKind;

/// One minute, in steps that show the stick-slip cycle, at the integrator's own tolerance.
const EXPERIMENT: DefaultExperiment = DefaultExperiment {
    start_time: 0.0,
    stop_time: 60.0,
    tolerance: Options::DEFAULT_TOLERANCE,
    step_size: 0.01,
};

static REDUCED: Identity = Identity {
    model_identifier: "ReducedRig",
    description: "DC motor, gearbox, flexible shaft and disc D2 under dry friction: stick-slip of a torsional rig",
    default_experiment: EXPERIMENT,
};

static FULL: Identity = Identity {
    model_identifier: "FullRig",
    description: "DC motor, gearbox, two flexible shafts and discs D2 and D1 under dry friction: stick-slip of a torsional rig",
    default_experiment: EXPERIMENT,
};

/// The constants of a kind of rig.
pub(super) fn identity(kind: RigKind) -> &'static Identity {
    match kind {
        RigKind::Reduced => &REDUCED,
        RigKind::Full => &FULL,
    }
}
