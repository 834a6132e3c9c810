//! A prescribed quantity: a constant plus one harmonic.

/// mean + amplitude cos(rate τ + phase).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drive {
    /// Constant part.
    pub mean: f64,
    /// Amplitude of the harmonic.
    pub amplitude: f64,
    /// Angular frequency of the harmonic.
    pub rate: f64,
    /// Phase of the harmonic [rad].
    pub phase: f64,
}

impl Drive {
    /// A constant.
    #[must_use]
    pub fn constant(mean: f64) -> Self {
        Self {
            mean,
            amplitude: 0.0,
            rate: 0.0,
            phase: 0.0,
        }
    }

    /// mean + amplitude cos(rate τ), as in Eq. 3-8.
    #[must_use]
    pub fn cosine(mean: f64, amplitude: f64, rate: f64) -> Self {
        Self {
            mean,
            amplitude,
            rate,
            phase: 0.0,
        }
    }

    /// mean + amplitude sin(rate τ), as in Eq. 3-10.
    #[must_use]
    pub fn sine(mean: f64, amplitude: f64, rate: f64) -> Self {
        Self {
            mean,
            amplitude,
            rate,
            phase: -std::f64::consts::FRAC_PI_2,
        }
    }

    /// Taylor coefficient `order` about `time`.
    #[must_use]
    pub fn coefficient(&self, order: usize, time: f64) -> f64 {
        // The k-th derivative of a cosine is rate^k cos(… + k π/2).
        let angle = self.rate * time + self.phase;
        let wave = match order % 4 {
            0 => angle.cos(),
            1 => -angle.sin(),
            2 => -angle.cos(),
            _ => angle.sin(),
        };
        let factor: f64 = (1..=order).map(|k| self.rate / k as f64).product();
        let constant = if order == 0 { self.mean } else { 0.0 };
        constant + self.amplitude * wave * factor
    }
}
