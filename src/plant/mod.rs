//! The rigs: a DC motor, a gearbox, flexible shafts and one or two discs under dry friction.
//!
//! Signs: positive torques turn the discs forward; a friction torque is positive when it opposes a
//! positive slip velocity and acts on its disc as −T. All quantities are on the shaft side of the
//! gearbox unless their name says motor.

mod bodies;
mod bristle;
mod effect_series;
mod effects;
mod equation;
mod equation_series;
mod expansion;
mod fading;
mod folds;
mod guards;
mod indicators;
mod inputs;
mod instant;
mod jet;
mod linear_parts;
mod load;
mod mode;
mod model_file;
mod plain_motion;
mod rig;
mod sections;
mod sensitivity;
mod slow_manifold;
mod slow_motion;
mod switching;
mod tangent;

pub use crate::parameter::{ModelFileError, Parameter, Provenance};
pub use effects::*;
pub use equation::{Definition, EquationEffect, EquationEffects, Port, SiUnits, Supposition};
pub use indicators::{Indicators, MOST_INDICATORS};
pub use inputs::{INPUT_TERMS, RigInputs};
pub use instant::{Changes, Chattering};
pub use jet::RigJet;
pub use mode::{Contact, Coupling, RigGuard, RigMode};
pub use model_file::ModelFile;
pub use rig::{Disc1, Rig, RigKind, RigState, STATES, index};
pub use sections::{ContactRadius, Disc, Gearbox, Motor, Shaft};
pub use sensitivity::{Sensitivities, SensitivityError, sensitivities};
