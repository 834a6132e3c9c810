//! Kinds of motion of a disc, and how they are told apart.

use serde::{Deserialize, Serialize};

/// What a disc does once the transient has passed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Motion {
    /// It has never moved.
    NoMotion,
    /// It has moved, and sticks for good.
    Sticking,
    /// It sticks and slips in turn.
    StickSlip,
    /// It turns without sticking and its velocity oscillates.
    Oscillation,
    /// It turns at a constant velocity, or its oscillation dies away.
    Steady,
}

impl Motion {
    /// All kinds, in the order of the classes of a map.
    pub const ALL: [Self; 5] = [
        Self::NoMotion,
        Self::Sticking,
        Self::StickSlip,
        Self::Oscillation,
        Self::Steady,
    ];

    /// The word for it in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::NoMotion => "no_motion",
            Self::Sticking => "sticking",
            Self::StickSlip => "stick_slip",
            Self::Oscillation => "oscillation",
            Self::Steady => "steady",
        }
    }

    /// Place in [`Motion::ALL`].
    #[must_use]
    pub fn index(self) -> usize {
        self as usize
    }
}

/// Lowest and highest value seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// Lowest value; +∞ before anything was seen.
    pub minimum: f64,
    /// Highest value; −∞ before anything was seen.
    pub maximum: f64,
}

impl Default for Range {
    fn default() -> Self {
        Self {
            minimum: f64::INFINITY,
            maximum: f64::NEG_INFINITY,
        }
    }
}

impl Range {
    /// Takes a value into account.
    pub fn see(&mut self, value: f64) {
        self.minimum = self.minimum.min(value);
        self.maximum = self.maximum.max(value);
    }

    /// Half of the distance between lowest and highest; 0 before anything was seen.
    #[must_use]
    pub fn half(&self) -> f64 {
        (0.5 * (self.maximum - self.minimum)).max(0.0)
    }

    /// The range of both.
    #[must_use]
    pub fn with(self, other: Self) -> Self {
        Self {
            minimum: self.minimum.min(other.minimum),
            maximum: self.maximum.max(other.maximum),
        }
    }
}

/// What was seen of a disc's velocity in a run whose early part is there to be compared with its late part.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Evidence {
    /// Whether the disc has moved at all since the start of the run.
    pub has_moved: bool,
    /// Share of the late part in which it stuck, 0 … 1.
    pub stick_fraction: f64,
    /// Velocities in the early part [rad/s].
    pub early: Range,
    /// Velocities in the late part [rad/s].
    pub late: Range,
}

/// Half range of a velocity, relative to its middle, below which it counts as constant.
const CONSTANT: f64 = 0.01;
/// Ratio of the half ranges late and early below which an oscillation counts as dying away.
const DYING: f64 = 0.8;

impl Evidence {
    /// The kind of motion.
    ///
    /// It is that of the late part. A velocity that varies by less than one hundredth of its middle is constant. An
    /// oscillation that loses a fifth of its size from the early to the late part is a transient that outlives the run, as
    /// lightly damped shafts have, and counts as steady.
    #[must_use]
    pub fn judge(&self) -> Motion {
        if !self.has_moved {
            Motion::NoMotion
        } else if self.stick_fraction >= 1.0 {
            Motion::Sticking
        } else if self.stick_fraction > 0.0 {
            Motion::StickSlip
        } else if self.late.half()
            <= CONSTANT * (0.5 * (self.late.minimum + self.late.maximum)).abs()
            || self.late.half() <= DYING * self.early.half()
        {
            Motion::Steady
        } else {
            Motion::Oscillation
        }
    }
}

/// What is seen in a sampled run: `velocity` [rad/s] over `time` [s] and whether the disc sticks at a sample. The late part
/// is the last third of the run, the early part the third before it.
#[must_use]
pub fn evidence(time: &[f64], velocity: &[f64], stuck: impl Fn(usize) -> bool) -> Evidence {
    let mut evidence = Evidence {
        has_moved: velocity.iter().any(|value| *value != 0.0),
        ..Evidence::default()
    };
    let (Some(&start), Some(&end)) = (time.first(), time.last()) else {
        return evidence;
    };
    let (early, late) = thirds(start, end);
    let (mut resting, mut judged) = (0_usize, 0_usize);
    for index in 0..time.len().min(velocity.len()) {
        if time[index] >= late {
            judged += 1;
            resting += usize::from(stuck(index));
            evidence.late.see(velocity[index]);
        } else if time[index] >= early {
            evidence.early.see(velocity[index]);
        }
    }
    evidence.stick_fraction = resting as f64 / judged.max(1) as f64;
    evidence
}

/// Where the early and the late part of a run from `start` to `end` [s] begin.
#[must_use]
pub fn thirds(start: f64, end: f64) -> (f64, f64) {
    (
        start + (end - start) / 3.0,
        start + 2.0 * (end - start) / 3.0,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judge(velocity: impl Fn(f64) -> f64) -> Motion {
        let time: Vec<f64> = (0..=6000).map(|index| f64::from(index) * 0.01).collect();
        let series: Vec<f64> = time.iter().map(|t| velocity(*t)).collect();
        evidence(&time, &series, |index| series[index] == 0.0).judge()
    }

    #[test]
    fn the_kinds_are_told_apart() {
        assert_eq!(judge(|_| 0.0), Motion::NoMotion);
        assert_eq!(judge(|t| if t < 5.0 { 1.0 } else { 0.0 }), Motion::Sticking);
        assert_eq!(
            judge(|t| (5.0 + 8.0 * (4.8 * t).sin()).max(0.0)),
            Motion::StickSlip
        );
        assert_eq!(judge(|t| 5.0 + 4.0 * (4.8 * t).sin()), Motion::Oscillation);
        assert_eq!(
            judge(|t| 5.0 + 4.0 * (-0.075 * t).exp() * (4.8 * t).sin()),
            Motion::Steady
        );
        assert_eq!(judge(|t| 5.0 + 0.01 * (4.8 * t).sin()), Motion::Steady);
    }

    #[test]
    fn the_order_of_the_classes_is_that_of_their_indices() {
        for (index, motion) in Motion::ALL.into_iter().enumerate() {
            assert_eq!(motion.index(), index);
        }
    }
}
