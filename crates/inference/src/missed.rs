//! Windows that a model misses: they leave more than instruments can.
//!
//! A right model misses a few, where the start of a window about a breakaway was not found, or where friction that fluctuates throws the
//! motion to the other branch of a law. Replicas of the records tell how many.

use crate::data::Data;
use crate::fit::Fit;
use crate::marginal::Reduced;
use crate::policy::{MOST_MISFIT, MOST_TOLD};

/// Windows, and how many of them a model misses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Missed {
    /// All of them.
    pub windows: usize,
    /// Those that the model misses.
    pub missed: usize,
}

impl Missed {
    /// Windows that `fit` misses: by more than one window may tell, beyond what instruments explain that are known to a fifth.
    #[must_use]
    pub fn by(fit: &Fit, data: &Data) -> Self {
        let is_missed = |form: &Reduced| {
            let n = form.residuals.max(1) as f64;
            0.5 * n * (form.left / (MOST_MISFIT * n)).ln() > MOST_TOLD
        };
        let forms = fit.reduced(data);
        Self {
            windows: forms.len(),
            missed: forms
                .iter()
                .filter(|form| form.as_ref().is_none_or(is_missed))
                .count(),
        }
    }

    /// Probability that as many of these are missed as there are, if those of `replicas` are missed as easily: that of
    /// drawing so many from all that are missed (hypergeometric distribution).
    #[must_use]
    pub fn chance(self, replicas: Self) -> f64 {
        let all_windows = self.windows + replicas.windows;
        let all_missed = self.missed + replicas.missed;
        // The windows are drawn one after the other, and `by_missed[k]` is the probability that k of them are missed ones.
        let mut by_missed = vec![0.0; self.windows + 1];
        by_missed[0] = 1.0;
        for drawn in 0..self.windows {
            for missed in (0..=drawn.min(all_missed)).rev() {
                let share = (all_missed - missed) as f64 / (all_windows - drawn) as f64;
                let before = by_missed[missed];
                by_missed[missed + 1] += before * share;
                by_missed[missed] = before * (1.0 - share);
            }
        }
        by_missed[self.missed..].iter().sum()
    }
}

#[cfg(test)]
mod tests {
    use super::Missed;

    const fn of(windows: usize, missed: usize) -> Missed {
        Missed { windows, missed }
    }

    #[test]
    fn the_chance_is_that_of_drawing_so_many() {
        let none = of(45, 0);
        assert!((of(5, 0).chance(none) - 1.0).abs() < 1e-12);
        assert!((of(5, 1).chance(none) - 0.1).abs() < 1e-12);
        // C(5, 2) of C(50, 2) pairs.
        assert!((of(5, 2).chance(none) - 10.0 / 1225.0).abs() < 1e-12);
        // All five of the seven that are missed: C(7, 5) of C(50, 5).
        assert!((of(5, 5).chance(of(45, 2)) - 21.0 / 2_118_760.0).abs() < 1e-12);
    }
}
