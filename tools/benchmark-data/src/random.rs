//! Pinned random streams: the same seed and purpose give the same numbers on every machine.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

/// What a stream is used for. Purposes never share numbers, so a longer run or another noise
/// level leaves the draws of the effect unchanged.
#[derive(Debug, Clone, Copy)]
pub enum Purpose {
    /// Effect, its size, the true parameters.
    Recipe,
    /// Input profiles.
    Excitation,
    /// Sensor noise of the run with this index.
    Sensors(u64),
    /// Random friction of the run with this index.
    Contact(u64),
    /// Numbers of a rig other than the dissertation's.
    Rig,
    /// Instruments.
    Instruments,
    /// Disc D1.
    Disc1,
    /// How far the analyst is off about disc D1.
    Disc1Ratios,
    /// Friction law of disc D1.
    Disc1Law,
    /// Friction law of the attempt with this index.
    Law(u64),
    /// Inputs of the attempt with this index.
    Inputs(u64),
}

/// One stream of random numbers.
#[derive(Debug, Clone)]
pub struct Stream {
    generator: ChaCha8Rng,
    spare_normal: Option<f64>,
}

impl Stream {
    /// The stream of `seed` for `purpose`.
    pub fn new(seed: u64, purpose: Purpose) -> Self {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        generator.set_stream(match purpose {
            Purpose::Recipe => 0,
            Purpose::Excitation => 1,
            Purpose::Sensors(run) => 100 + run,
            Purpose::Contact(run) => 200 + run,
            Purpose::Rig => 2,
            Purpose::Instruments => 3,
            Purpose::Disc1 => 4,
            Purpose::Disc1Ratios => 5,
            Purpose::Disc1Law => 6,
            Purpose::Law(attempt) => 1_000_000 + attempt,
            Purpose::Inputs(attempt) => 2_000_000 + attempt,
        });
        Self {
            generator,
            spare_normal: None,
        }
    }

    /// Uniform number in [low, high).
    pub fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Number in [low, high) whose logarithm is uniform (0 < `low`).
    pub fn log_uniform(&mut self, low: f64, high: f64) -> f64 {
        low * libm::pow(high / low, self.unit())
    }

    /// A sign, either with equal probability.
    pub fn sign(&mut self) -> f64 {
        if self.chance(0.5) { 1.0 } else { -1.0 }
    }

    /// Uniform index in 0..count (`count` ≥ 1).
    pub fn index(&mut self, count: usize) -> usize {
        ((self.unit() * count as f64) as usize).min(count.saturating_sub(1))
    }

    /// True with the given probability.
    pub fn chance(&mut self, probability: f64) -> bool {
        self.unit() < probability
    }

    /// Standard normal number (Box–Muller).
    pub fn normal(&mut self) -> f64 {
        if let Some(spare) = self.spare_normal.take() {
            return spare;
        }
        let radius = libm::sqrt(-2.0 * libm::log(1.0 - self.unit()));
        let angle = core::f64::consts::TAU * self.unit();
        self.spare_normal = Some(radius * libm::sin(angle));
        radius * libm::cos(angle)
    }

    /// Puts `items` in random order.
    pub fn shuffle<T>(&mut self, items: &mut [T]) {
        for last in (1..items.len()).rev() {
            let chosen = self.index(last + 1);
            items.swap(last, chosen);
        }
    }

    fn unit(&mut self) -> f64 {
        (self.generator.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn streams_repeat_and_differ_by_purpose() {
        let draw = |purpose| Stream::new(7, purpose).uniform(0.0, 1.0);
        assert_eq!(draw(Purpose::Recipe), draw(Purpose::Recipe));
        assert_ne!(draw(Purpose::Recipe), draw(Purpose::Excitation));
        assert_ne!(draw(Purpose::Sensors(0)), draw(Purpose::Contact(0)));
    }

    #[test]
    fn normal_numbers_have_unit_variance() {
        let mut stream = Stream::new(1, Purpose::Recipe);
        let draws: Vec<f64> = (0..40_000).map(|_| stream.normal()).collect();
        let mean = draws.iter().sum::<f64>() / draws.len() as f64;
        let variance = draws.iter().map(|x| x * x).sum::<f64>() / draws.len() as f64;
        assert!(mean.abs() < 0.02, "mean {mean}");
        assert!((variance - 1.0).abs() < 0.03, "variance {variance}");
    }
}
