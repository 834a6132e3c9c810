//! Low-pass without delay: Butterworth's, run forward and backward.

use std::f64::consts::PI;

/// A Butterworth low-pass of even order as sections of second order.
#[derive(Debug, Clone)]
pub struct LowPass {
    sections: Vec<[f64; 5]>,
    /// Samples by which a series is continued on both sides, so that the filter has settled where the series begins.
    run_in: usize,
}

impl LowPass {
    /// Cut-off frequency [Hz], even order, sampling interval [s]; the cut-off must be below half the sampling rate.
    #[must_use]
    pub fn new(cut_off: f64, order: usize, interval: f64) -> Self {
        let angle = 2.0 * PI * cut_off * interval;
        let (sine, cosine) = angle.sin_cos();
        let sections = (0..order / 2)
            .map(|k| {
                // Poles evenly over the circle: quality 1/(2 cos) of each pair's angle.
                let damping = (PI * (2 * k + 1) as f64 / (2 * order) as f64).cos() * sine;
                let scale = 1.0 / (1.0 + damping);
                let low = 0.5 * (1.0 - cosine) * scale;
                [
                    low,
                    2.0 * low,
                    low,
                    -2.0 * cosine * scale,
                    (1.0 - damping) * scale,
                ]
            })
            .collect();
        Self {
            sections,
            run_in: (order as f64 / (cut_off * interval)).ceil() as usize,
        }
    }

    /// The series without what is faster than the cut-off, nothing delayed.
    #[must_use]
    pub fn apply(&self, series: &[f64]) -> Vec<f64> {
        let count = series.len();
        if count < 2 {
            return series.to_vec();
        }
        let run_in = self.run_in.min(count - 1);
        let (first, last) = (series[0], series[count - 1]);
        // Point reflection at both ends keeps value and slope.
        let mut work: Vec<f64> = (1..=run_in)
            .rev()
            .map(|j| 2.0 * first - series[j])
            .collect();
        work.extend_from_slice(series);
        work.extend((1..=run_in).map(|j| 2.0 * last - series[count - 1 - j]));
        self.forward(&mut work);
        work.reverse();
        self.forward(&mut work);
        work.reverse();
        work[run_in..run_in + count].to_vec()
    }

    fn forward(&self, series: &mut [f64]) {
        let begin = series.first().copied().unwrap_or(0.0);
        let mut states = vec![[0.0; 2]; self.sections.len()];
        // All sections at each value: their recursions run beside each other in the processor.
        for value in series.iter_mut() {
            let mut x = *value - begin;
            for ([b0, b1, b2, a1, a2], [z1, z2]) in self.sections.iter().zip(&mut states) {
                let y = b0 * x + *z1;
                *z1 = b1 * x - a1 * y + *z2;
                *z2 = b2 * x - a2 * y;
                x = y;
            }
            *value = x + begin;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slow_sines_pass_undelayed_and_the_cut_off_halves_the_power_twice() {
        let filter = LowPass::new(20.0, 4, 1e-3);
        let sine = |hertz: f64| -> Vec<f64> {
            (0..4000)
                .map(|j| 0.3 + (2.0 * PI * hertz * j as f64 * 1e-3).sin())
                .collect()
        };
        let slow = sine(2.0);
        for (x, y) in slow.iter().zip(filter.apply(&slow)) {
            assert!((x - y).abs() < 1e-3, "{x} {y}");
        }
        let edge: Vec<f64> = sine(20.0);
        let passed = filter.apply(&edge);
        for (x, y) in edge.iter().zip(&passed).skip(1000).take(2000) {
            assert!((0.3 + 0.5 * (x - 0.3) - y).abs() < 1e-6, "{x} {y}");
        }
    }
}
