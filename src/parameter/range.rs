//! Where a parameter may lie, as code asks for it and as files write it.

use super::number;
use std::fmt;
use toml::Value;

/// What a parameter's value may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Range {
    /// Above zero.
    Positive,
    /// Zero or above.
    NonNegative,
    /// Any finite number.
    Finite,
    /// Between two bounds, both allowed.
    Between(f64, f64),
}

impl Range {
    /// Whether `value` is finite and allowed.
    pub fn contains(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Self::Positive => value > 0.0,
                Self::NonNegative => value >= 0.0,
                Self::Finite => true,
                Self::Between(low, high) => low <= value && value <= high,
            }
    }

    /// Smallest value that may be declared as a minimum; `None` without a lower bound.
    pub fn minimum(self) -> Option<f64> {
        match self {
            Self::Positive | Self::NonNegative => Some(0.0),
            Self::Finite => None,
            Self::Between(low, _) => Some(low),
        }
    }

    /// Largest allowed value; `None` without an upper bound.
    pub fn maximum(self) -> Option<f64> {
        match self {
            Self::Between(_, high) => Some(high),
            _ => None,
        }
    }
}

impl Range {
    /// What a file may write for a range.
    pub const WRITTEN: &str = "\"any\", \"positive\", \"non-negative\" or [lowest, highest]";

    /// The range that a file writes so; `None` where it is none of [`Self::WRITTEN`].
    pub fn read(value: &Value) -> Option<Self> {
        match value {
            Value::String(word) => match word.as_str() {
                "any" => Some(Self::Finite),
                "positive" => Some(Self::Positive),
                "non-negative" => Some(Self::NonNegative),
                _ => None,
            },
            Value::Array(list) => {
                let [low, high] = list.as_slice() else {
                    return None;
                };
                let (low, high) = (number(low)?, number(high)?);
                let is_sound = low.is_finite() && high.is_finite() && low < high;
                is_sound.then_some(Self::Between(low, high))
            }
            _ => None,
        }
    }

    /// The range as a file writes it.
    pub fn written(self) -> String {
        match self {
            Self::Positive => "\"positive\"".to_owned(),
            Self::NonNegative => "\"non-negative\"".to_owned(),
            Self::Finite => "\"any\"".to_owned(),
            Self::Between(low, high) => format!("[{low:?}, {high:?}]"),
        }
    }
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Positive => write!(f, "a finite number above 0"),
            Self::NonNegative => write!(f, "a finite number not below 0"),
            Self::Finite => write!(f, "a finite number"),
            Self::Between(low, high) => write!(f, "a number from {low} to {high}"),
        }
    }
}
