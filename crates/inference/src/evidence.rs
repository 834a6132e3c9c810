//! Log evidence window by window.

use crate::loss;
use crate::marginal::Reduced;
use crate::policy::MOST_TOLD;
use crate::window::Window;
use nalgebra::Cholesky;

/// What each window tells of a hypothesis, and what its free numbers cost.
#[derive(Clone, Debug, PartialEq)]
pub struct Told {
    /// Log likelihood of each window.
    pub windows: Vec<f64>,
    /// Whether the start of each window is known, so that none had to be found.
    pub is_start_known: Vec<bool>,
    /// Log of prior density and volume of the free numbers.
    pub numbers: f64,
}

impl Told {
    /// Laplace's approximation at numbers that are `x` and have these precisions a priori; −∞ where the curvature is not
    /// positive.
    #[must_use]
    pub fn at(
        windows: &[Window],
        forms: &[Option<Reduced>],
        precisions: &[f64],
        x: &[f64],
    ) -> Self {
        let (curvature, _) = loss::normal_equations(forms.iter().flatten(), precisions, x);
        let volume = Cholesky::new(curvature).map_or(f64::INFINITY, |cholesky| {
            2.0 * cholesky
                .l_dirty()
                .diagonal()
                .iter()
                .map(|d| d.ln())
                .sum::<f64>()
        });
        let prior: f64 = precisions
            .iter()
            .zip(x)
            .map(|(p, x)| p.ln() - p * x * x)
            .sum();
        Self {
            windows: forms
                .iter()
                .map(|form| -0.5 * loss::of_window(form))
                .collect(),
            is_start_known: windows.iter().map(Window::is_start_known).collect(),
            numbers: 0.5 * (prior - volume),
        }
    }

    /// Log evidence by Laplace's approximation.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.windows.iter().sum::<f64>() + self.numbers
    }

    /// Gain in log evidence over `other`, where no window tells more than [`MOST_TOLD`] whose start may not have been found under one
    /// of the two.
    #[must_use]
    pub fn gain_over(&self, other: &Self) -> f64 {
        let windows: f64 = self
            .windows
            .iter()
            .zip(&other.windows)
            .zip(&self.is_start_known)
            .map(|((own, other), is_known)| (own - other, is_known))
            .filter(|(gain, _)| !gain.is_nan())
            .map(|(gain, is_known)| match is_known {
                true => gain,
                false => gain.clamp(-MOST_TOLD, MOST_TOLD),
            })
            .sum();
        windows + self.numbers - other.numbers
    }
}
