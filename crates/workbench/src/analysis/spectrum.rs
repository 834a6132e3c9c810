//! Amplitude spectra of evenly sampled series.

use rustfft::FftPlanner;
use rustfft::num_complex::Complex;

/// The amplitude spectrum of a series, its mean removed.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrum {
    /// Frequencies [Hz], evenly spaced from 0 to half the sampling rate.
    pub frequency: Vec<f64>,
    /// Amplitudes in the series' unit: a sine of amplitude 1 midway through the band shows a peak of 1.
    pub amplitude: Vec<f64>,
}

/// A peak of a spectrum, located between the samples of the frequency axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Peak {
    /// Frequency [Hz].
    pub frequency: f64,
    /// Amplitude in the series' unit.
    pub amplitude: f64,
}

impl Spectrum {
    /// The spectrum of `series`, sampled every `step` seconds, seen through a Hann window.
    ///
    /// The window keeps the strong fundamental of a limit cycle from leaking over its weak neighbours; it widens each peak
    /// to four bins. `None` where there are fewer than eight samples or `step` is not positive: no peak could be told.
    #[must_use]
    pub fn new(series: &[f64], step: f64) -> Option<Self> {
        let count = series.len();
        if count < 8 || !step.is_finite() || step <= 0.0 {
            return None;
        }
        let mean = series.iter().sum::<f64>() / count as f64;
        let mut buffer: Vec<Complex<f64>> = series
            .iter()
            .enumerate()
            .map(|(index, value)| Complex::new((value - mean) * hann(index, count), 0.0))
            .collect();
        FftPlanner::new()
            .plan_fft_forward(count)
            .process(&mut buffer);
        // Half the amplitude sits at the negative frequency, and the window's mean is one half.
        let scale = 4.0 / count as f64;
        let half = count / 2 + 1;
        Some(Self {
            frequency: (0..half)
                .map(|bin| bin as f64 / (count as f64 * step))
                .collect(),
            amplitude: buffer[..half]
                .iter()
                .map(|value| value.norm() * scale)
                .collect(),
        })
    }

    /// The strongest `count` peaks above `lowest` [Hz], strongest first.
    ///
    /// A peak is interpolated by the Hann window's own shape from the larger of its neighbours, which is exact for a
    /// single sine.
    #[must_use]
    pub fn peaks(&self, count: usize, lowest: f64) -> Vec<Peak> {
        let mut peaks: Vec<Peak> = (1..self.amplitude.len().saturating_sub(1))
            .filter(|&bin| self.frequency[bin] >= lowest)
            .filter(|&bin| {
                self.amplitude[bin] > self.amplitude[bin - 1]
                    && self.amplitude[bin] >= self.amplitude[bin + 1]
            })
            .map(|bin| self.interpolate(bin))
            .collect();
        peaks.sort_by(|left, right| right.amplitude.total_cmp(&left.amplitude));
        peaks.truncate(count);
        peaks
    }

    /// The strongest peak above `lowest` [Hz].
    #[must_use]
    pub fn peak(&self, lowest: f64) -> Option<Peak> {
        self.peaks(1, lowest).first().copied()
    }

    fn interpolate(&self, bin: usize) -> Peak {
        let (before, at, after) = (
            self.amplitude[bin - 1],
            self.amplitude[bin],
            self.amplitude[bin + 1],
        );
        let (neighbour, side) = if after > before {
            (after, 1.0)
        } else {
            (before, -1.0)
        };
        // Hann main lobe: W(d) = sinc(d)/(1 - d²) in bins, so neighbour/at = (1 + d)/(2 - d).
        let ratio = neighbour / at;
        let offset = ((2.0 * ratio - 1.0) / (1.0 + ratio)).max(0.0);
        let lobe = if offset < 1e-9 {
            1.0
        } else {
            (std::f64::consts::PI * offset).sin()
                / (std::f64::consts::PI * offset)
                / (1.0 - offset * offset)
        };
        let spacing = self.frequency[1];
        Peak {
            frequency: self.frequency[bin] + side * offset * spacing,
            amplitude: at / lobe,
        }
    }
}

fn hann(index: usize, count: usize) -> f64 {
    0.5 - 0.5 * (std::f64::consts::TAU * index as f64 / count as f64).cos()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sine(frequency: f64, amplitude: f64, count: usize, step: f64) -> Vec<f64> {
        (0..count)
            .map(|index| {
                5.0 + amplitude
                    * (std::f64::consts::TAU * frequency * index as f64 * step + 0.3).sin()
            })
            .collect()
    }

    #[test]
    fn a_sine_between_the_bins_is_found() {
        let series = sine(0.7533, 6.1, 4001, 0.01);
        let peak = Spectrum::new(&series, 0.01).unwrap().peak(0.1).unwrap();
        assert!((peak.frequency - 0.7533).abs() < 2e-4, "{peak:?}");
        assert!((peak.amplitude - 6.1).abs() < 1e-2, "{peak:?}");
    }

    #[test]
    fn a_weak_neighbour_of_a_strong_peak_is_second() {
        let series: Vec<f64> = sine(0.75, 6.0, 6000, 0.01)
            .iter()
            .zip(sine(0.9167, 0.4, 6000, 0.01))
            .map(|(strong, weak)| strong + weak)
            .collect();
        let peaks = Spectrum::new(&series, 0.01).unwrap().peaks(2, 0.1);
        assert!((peaks[1].frequency - 0.9167).abs() < 5e-3, "{peaks:?}");
        assert!((peaks[1].amplitude - 0.4).abs() < 0.02, "{peaks:?}");
    }

    #[test]
    fn too_little_data_has_no_spectrum() {
        assert_eq!(Spectrum::new(&[1.0; 7], 0.01), None);
        assert_eq!(Spectrum::new(&[1.0; 70], 0.0), None);
        assert_eq!(Spectrum::new(&[1.0; 70], 0.01).unwrap().peak(0.1), None);
    }
}
