//! Kinds of small plants.

/// What a small plant is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A mass or an inertia under a known force.
    Drive,
    /// A body that swings freely about a fixed axis.
    Pendulum,
    /// A contact whose force or torque and motion are both measured.
    Contact,
    /// A force or torque that is measured beside the one that somebody's own model predicts.
    Balance,
    /// Anybody's FMU: the force that it lacks to move as was measured.
    Fmu,
    /// An arm with gravity that a motor turns, under a measured voltage.
    Joint,
}

/// Along what it moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Path {
    /// A line: metres and newtons.
    Line,
    /// A turn: radians and newton metres.
    Turn,
}

impl Kind {
    /// All kinds.
    pub const ALL: [Self; 6] = [
        Self::Drive,
        Self::Pendulum,
        Self::Contact,
        Self::Balance,
        Self::Fmu,
        Self::Joint,
    ];

    /// The kind as written in a model file.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Drive => "drive",
            Self::Pendulum => "pendulum",
            Self::Contact => "contact",
            Self::Balance => "balance",
            Self::Fmu => "fmu",
            Self::Joint => "joint",
        }
    }

    /// Why a plant of this kind does not move by itself, if it does not.
    #[must_use]
    pub fn stands_still(self) -> Option<&'static str> {
        match self {
            Self::Drive | Self::Pendulum | Self::Joint => None,
            Self::Contact => Some("a contact is a law without a body"),
            Self::Balance => {
                Some("a balance is the difference from your own model, which stays yours")
            }
            Self::Fmu => Some("the effects of an FMU go around it"),
        }
    }

    /// Whether all its forces are over its moment of inertia, and it is judged by runs of its own.
    #[must_use]
    pub fn runs_alone(self) -> bool {
        matches!(self, Self::Pendulum | Self::Joint)
    }
}

impl Path {
    /// The path as written in a model file.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Line => "line",
            Self::Turn => "turn",
        }
    }
}
