//! Shares with Wilson's interval.

/// Standard deviations of a 95 % interval.
const Z: f64 = 1.959_963_985;

/// A number of successes out of a number of cases.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Share {
    /// Successes.
    pub successes: usize,
    /// Cases.
    pub cases: usize,
}

impl Share {
    /// Counts how often `test` holds.
    pub fn of<T>(cases: impl Iterator<Item = T>, test: impl Fn(&T) -> bool) -> Self {
        let mut share = Self {
            successes: 0,
            cases: 0,
        };
        for case in cases {
            share.cases += 1;
            share.successes += usize::from(test(&case));
        }
        share
    }

    /// The share, 0 … 1; NaN without cases.
    #[must_use]
    pub fn value(self) -> f64 {
        self.successes as f64 / self.cases as f64
    }

    /// Wilson's interval that covers the true share with 95 % probability (Wilson, J. Am. Stat. Assoc. 22, 1927).
    #[must_use]
    pub fn interval95(self) -> [f64; 2] {
        let n = self.cases as f64;
        let p = self.value();
        let middle = p + Z * Z / (2.0 * n);
        let reach = Z * (p * (1.0 - p) / n + Z * Z / (4.0 * n * n)).sqrt();
        let scale = 1.0 + Z * Z / n;
        [
            ((middle - reach) / scale).max(0.0),
            ((middle + reach) / scale).min(1.0),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_of_known_counts() {
        // Oracle: statsmodels.stats.proportion.proportion_confint(count, nobs, method="wilson").
        for (successes, cases, low, high) in [
            (8, 10, 0.490_162, 0.943_318),
            (0, 20, 0.0, 0.161_125),
            (150, 150, 0.975_030, 1.0),
        ] {
            let [l, h] = Share { successes, cases }.interval95();
            assert!((l - low).abs() < 1e-4 && (h - high).abs() < 1e-4, "{l} {h}");
        }
    }
}
