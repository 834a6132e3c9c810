//! What a rig tells the log.

use super::variables::Friction;
use crate::cosim;
use std::fmt;

/// Something that happened at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Notice {
    /// When [s].
    pub(super) time: f64,
    /// What.
    pub(super) what: What,
}

/// What happened.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum What {
    /// A contact began to stick.
    Sticks(Friction),
    /// A contact broke away.
    Slips(Friction),
    /// A branch of the law's algebraic loop ended, and the motion jumped to the other one.
    BranchJump,
}

impl cosim::Notice for Notice {
    fn time(&self) -> f64 {
        self.time
    }

    fn what(&self) -> String {
        match self.what {
            What::Sticks(contact) => format!("{} sticks", name(contact)),
            What::Slips(contact) => format!("{} breaks away", name(contact)),
            What::BranchJump => "the friction law is many-valued here; its branch ended and the \
                                 acceleration jumped to the other stable branch"
                .to_owned(),
        }
    }
}

impl fmt::Display for Notice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "t = {} s: {}", self.time, cosim::Notice::what(self))
    }
}

fn name(contact: Friction) -> &'static str {
    match contact {
        Friction::Disc => "disc D2",
        Friction::Disc1 => "disc D1",
        Friction::Motor => "the motor",
    }
}
