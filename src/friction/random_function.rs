//! Smooth random functions that are the same in every run with the same seed.

use std::f64::consts::FRAC_PI_2;
use std::f64::consts::TAU;

/// Number of harmonics in a random function.
pub const HARMONICS: usize = 12;

/// A stationary random function ξ(x) = Σ a cos(κ x + φ) of zero mean and unit variance whose
/// correlation falls off over a given length, as a sum of harmonics with seeded phases.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RandomFunction {
    /// (wave number, phase) of each harmonic; all have amplitude √(2/`HARMONICS`).
    pub harmonics: [(f64, f64); HARMONICS],
}

impl RandomFunction {
    /// Common amplitude of the harmonics.
    pub fn amplitude() -> f64 {
        libm::sqrt(2.0 / HARMONICS as f64)
    }

    /// The function number `seed` with correlation close to exp(−|Δx|/`length`): wave numbers are
    /// quantiles of the Cauchy distribution that belongs to this correlation, jittered within their
    /// strata.
    pub fn new(seed: u64, length: f64) -> Self {
        let mut state = seed;
        let mut uniform = || {
            // SplitMix64 (Steele, Lea and Flood 2014).
            state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
            let mut z = state;
            z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
            ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
        };
        let mut harmonics = [(0.0, 0.0); HARMONICS];
        for (m, harmonic) in harmonics.iter_mut().enumerate() {
            let quantile = (m as f64 + uniform()) / HARMONICS as f64;
            // The tail of the Cauchy law is cut at its 97 % quantile to keep the function smooth.
            let wave_number = libm::tan(0.97 * FRAC_PI_2 * quantile) / length;
            *harmonic = (wave_number, TAU * uniform());
        }
        Self { harmonics }
    }

    /// Value at `x`.
    pub fn at(&self, x: f64) -> f64 {
        let sum: f64 = self
            .harmonics
            .iter()
            .map(|&(w, phase)| libm::cos(w * x + phase))
            .sum();
        Self::amplitude() * sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_variance_and_seed() {
        let function = RandomFunction::new(7, 0.1);
        let n = 200_000;
        let values: Vec<f64> = (0..n).map(|j| function.at(f64::from(j) * 0.05)).collect();
        let mean = values.iter().sum::<f64>() / f64::from(n);
        let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / f64::from(n);
        assert!(mean.abs() < 0.02, "{mean}");
        assert!((variance - 1.0).abs() < 0.05, "{variance}");
        assert_eq!(function, RandomFunction::new(7, 0.1));
        assert_ne!(function, RandomFunction::new(8, 0.1));
    }
}
