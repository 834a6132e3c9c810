//! Log evidence window by window.

use crate::policy::MOST_TOLD;

/// What each window tells of a hypothesis, and what its free numbers cost.
#[derive(Clone, Debug, PartialEq)]
pub struct Told {
    /// Log likelihood of each window.
    pub windows: Vec<f64>,
    /// Log of prior density and volume of the free numbers.
    pub numbers: f64,
}

impl Told {
    /// Log evidence by Laplace's approximation.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.windows.iter().sum::<f64>() + self.numbers
    }

    /// Gain in log evidence over `other`, where no window tells more than [`MOST_TOLD`]: the start of a window may not have been
    /// found under one of the two.
    #[must_use]
    pub fn gain_over(&self, other: &Self) -> f64 {
        let windows: f64 = self
            .windows
            .iter()
            .zip(&other.windows)
            .map(|(own, other)| own - other)
            .filter(|gain| !gain.is_nan())
            .map(|gain| gain.clamp(-MOST_TOLD, MOST_TOLD))
            .sum();
        windows + self.numbers - other.numbers
    }
}
