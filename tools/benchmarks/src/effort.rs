//! How long a benchmark may take.

use anyhow::Result;
use cpu_time::ProcessTime;

/// The fastest of so many runs: its processor time [s] and what it returned.
///
/// # Errors
/// When a run fails.
pub fn fastest<T>(repetitions: u32, run: impl Fn() -> Result<T>) -> Result<(f64, T)> {
    let timed = || {
        let clock = ProcessTime::now();
        run().map(|end| (clock.elapsed().as_secs_f64(), end))
    };
    let mut best = timed()?;
    for _ in 1..repetitions {
        let again = timed()?;
        if again.0 < best.0 {
            best = again;
        }
    }
    Ok(best)
}

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
