//! Controllers that drive the motor's voltage: linear laws with an integral and voltage limits.
//!
//! A controller sees the gearbox output's speed ω3 and, for soft torque, the armature current, and sets
//! the voltage u. Between two changes of its inputs its course is known in closed form: polynomials in
//! time and one decaying exponential. Reaching or leaving a voltage limit is an exact event.

mod course;
mod file;
mod gains;
mod instant;
mod law;
mod limited;
mod signal;

pub use course::{Course, CourseError, Known, Start};
pub use file::is_controller;
pub use gains::{Gains, INPUTS, Input};
pub use instant::{Instant, MOST_INDICATORS};
pub use law::{
    ControlLaw, MotorConstants, SoftTorque, SoftTorqueGains, SpeedController, SpeedGains,
    VoltageLimits,
};
pub use limited::{Mode, Side};
