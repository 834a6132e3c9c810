//! What a rig tells the log.

use super::rig_variables::Friction;
use std::fmt;

/// A contact that began to stick or to slip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Notice {
    /// When [s].
    pub(super) time: f64,
    /// Which contact.
    pub(super) contact: Friction,
    /// Whether it sticks from then on.
    pub(super) sticks: bool,
}

impl fmt::Display for Notice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let contact = match self.contact {
            Friction::Disc => "disc D2",
            Friction::Disc1 => "disc D1",
            Friction::Motor => "the motor",
        };
        let verb = if self.sticks { "sticks" } else { "breaks away" };
        write!(f, "t = {} s: {contact} {verb}", self.time)
    }
}
