//! What a rig tells the log.

use super::variables::Friction;
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

impl fmt::Display for Notice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "t = {} s: ", self.time)?;
        match self.what {
            What::Sticks(contact) => write!(f, "{} sticks", name(contact)),
            What::Slips(contact) => write!(f, "{} breaks away", name(contact)),
            What::BranchJump => write!(
                f,
                "the friction law is many-valued here; its branch ended and the acceleration jumped to \
                 the other stable branch"
            ),
        }
    }
}

fn name(contact: Friction) -> &'static str {
    match contact {
        Friction::Disc => "disc D2",
        Friction::Disc1 => "disc D1",
        Friction::Motor => "the motor",
    }
}
