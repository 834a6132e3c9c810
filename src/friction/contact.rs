//! The modes of a contact.

/// Sense of sliding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// Positive slip velocity.
    Forward,
    /// Negative slip velocity.
    Backward,
}

impl Direction {
    /// +1 or −1.
    #[inline(always)]
    pub fn sign(self) -> f64 {
        match self {
            Self::Forward => 1.0,
            Self::Backward => -1.0,
        }
    }

    /// The other sense.
    pub fn opposite(self) -> Self {
        match self {
            Self::Forward => Self::Backward,
            Self::Backward => Self::Forward,
        }
    }

    /// The sense of a number that is not zero.
    pub fn of(value: f64) -> Self {
        if value < 0.0 {
            Self::Backward
        } else {
            Self::Forward
        }
    }
}

/// How a sliding contact's velocity changes: only laws that look at the acceleration's sign care.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Regime {
    /// The law is smooth in the acceleration here, or does not depend on it.
    Free,
    /// Upper branch of a hysteretic law: the slip speed grows.
    SpeedingUp,
    /// Lower branch of a hysteretic law: the slip speed falls.
    SlowingDown,
    /// The slip speed is constant because the torque lies between the two branches.
    Holding,
}

/// Mode of a contact: the discrete part of its state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContactMode {
    /// The surfaces stick; friction is a reaction.
    Stuck,
    /// Within the band that Karnopp's law and the switch model take for zero velocity, but pushed
    /// in this direction by more than the breakaway torque. Of a contact with bristles: they carry the
    /// breakaway torque in this direction and give way, while the disc is at rest or springs back.
    Breaking(Direction),
    /// The surfaces slide.
    Slipping(Direction, Regime),
}

impl ContactMode {
    /// Whether the contact sticks.
    pub fn is_stuck(self) -> bool {
        self == Self::Stuck
    }
}
