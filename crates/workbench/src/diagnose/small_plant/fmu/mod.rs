//! Anybody's FMU as a plant: the force that it lacks at one of its inputs to move as was measured.
//!
//! [`pursuit`] runs the FMU after a record: a controller at the port pushes it along the measured motion, so that friction sticks and
//! slips in the FMU when it does in the record, and no state has to be known or set. The controller's force is the missing one;
//! [`missing`] makes it a balance of forces, which the same search explains as any other. Each run is a process of its own
//! ([`worker`]): an FMU that crashes or hangs takes nothing down. [`wrapper`] makes the FMU with the effects inside.

pub mod missing;
pub mod places;
pub mod plant;
pub mod ports;
#[cfg(test)]
mod ports_tests;
pub mod pursuit;
#[cfg(test)]
mod pursuit_tests;
pub mod swing;
pub mod template;
pub mod worker;
mod wrapped_place;
pub mod wrapper;
mod wrapper_description;
