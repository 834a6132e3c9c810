//! What a command came to.

/// What a command came to; the process' exit code.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// The work is done: 0.
    Done,
    /// The work is done and what it was to check does not hold: 1.
    CheckFailed,
    /// The user interrupted the work, of which what is finished is kept: 130, as shells say it.
    Interrupted,
}

impl Outcome {
    /// That of a check that holds or does not.
    #[must_use]
    pub fn of(holds: bool) -> Self {
        if holds { Self::Done } else { Self::CheckFailed }
    }

    /// The process' exit code.
    #[must_use]
    pub fn code(self) -> u8 {
        match self {
            Self::Done => 0,
            Self::CheckFailed => 1,
            Self::Interrupted => 130,
        }
    }
}
