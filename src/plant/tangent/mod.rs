//! Derivatives of a segment: the variational equations along a motion that is computed without them.
//!
//! The series of the motion itself come from the same recurrences as in a plain run, to the last bit.
//! A derivative y of the state obeys equations that are linear in y,
//!
//! J dy_ω/dt = −(torques of shafts by y) − ∂T/∂ω y_ω − ∂T/∂a dy_ω/dt − ∂T/∂θ y_θ + r,
//!
//! where r collects what a parameter does while the state is held ([`parameter_forcing`]) and the slopes of the
//! friction torque T are series known once for all derivatives ([`pin`]). So each derivative costs one
//! product of series for each slope, where dual numbers carry every product of the motion twice.
//!
//! What a guard depends on is asked for at switches only (`guard_at` of [`Rig`](super::Rig)).

mod full_series;
mod motion;
mod parameter_forcing;
mod pin;
mod slow_series;

pub(super) use motion::Tangent;
pub(super) use slow_series::SlowTangent;
