//! How long a benchmark may take.

/// `--quick` or thorough.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// Whole decades of tolerance, few repetitions.
    Quick,
    /// Half decades, more repetitions.
    Thorough,
}

impl Effort {
    /// Repetitions of each timed run, of which the best counts.
    #[must_use]
    pub fn repetitions(self) -> u32 {
        match self {
            Self::Quick => 3,
            Self::Thorough => 7,
        }
    }

    /// Tolerances from `loosest` to `tightest`, both included.
    #[must_use]
    pub fn tolerances(self, loosest: f64, tightest: f64) -> Vec<f64> {
        let ratio: f64 = match self {
            Self::Quick => 0.1,
            Self::Thorough => 0.1_f64.sqrt(),
        };
        let mut list = Vec::new();
        let mut tolerance = loosest;
        while tolerance > tightest * 1.001 {
            list.push(tolerance);
            tolerance *= ratio;
        }
        list.push(tightest);
        list
    }
}
