//! The dissertation's measures of agreement between a model and a record (its Section 4.5 and Table 4.7).

/// Root mean square of the difference, in the series' unit. NaN for series that are empty or of unequal length.
#[must_use]
pub fn root_mean_square_error(model: &[f64], measured: &[f64]) -> f64 {
    if model.len() != measured.len() {
        return f64::NAN;
    }
    let sum: f64 = model
        .iter()
        .zip(measured)
        .map(|(left, right)| (left - right).powi(2))
        .sum();
    (sum / model.len() as f64).sqrt()
}

/// Pearson's correlation, −1 … 1: 1 is a perfect match of shape, 0 none. NaN where a series does not vary or the lengths
/// differ.
#[must_use]
pub fn pearson_correlation(model: &[f64], measured: &[f64]) -> f64 {
    if model.len() != measured.len() {
        return f64::NAN;
    }
    let (mean_model, mean_measured) = (mean(model), mean(measured));
    let covariance: f64 = model
        .iter()
        .zip(measured)
        .map(|(left, right)| (left - mean_model) * (right - mean_measured))
        .sum();
    covariance / (deviation_sum(model, mean_model) * deviation_sum(measured, mean_measured)).sqrt()
}

/// Amplitude pulse level, 0 … 1: 0 where both series pulse equally strongly about their means, 1 where only one does.
///
/// The dissertation prints the measure's values and both ends of its scale but no formula, and takes it from a reference
/// that it does not quote. What is computed here has those ends and, like the name, concerns the amplitude of the pulsation
/// alone and not its phase: |s_model − s_measured|/(s_model + s_measured), with s the standard deviation over time. It is
/// inferred from Table 4.7 itself: the printed root mean square error and correlation fix s_measured, and of the formulas
/// tried this one then comes nearest to the printed levels (experiment `table-4.7`). NaN for series that are empty.
#[must_use]
pub fn amplitude_pulse_level(model: &[f64], measured: &[f64]) -> f64 {
    level_of_deviations(standard_deviation(model), standard_deviation(measured))
}

/// [`amplitude_pulse_level`] of two standard deviations; two that are zero match (0).
#[must_use]
pub fn level_of_deviations(model: f64, measured: f64) -> f64 {
    if model + measured == 0.0 {
        0.0
    } else {
        (model - measured).abs() / (model + measured)
    }
}

/// Standard deviation over the samples (divided by their number), in the series' unit.
#[must_use]
pub fn standard_deviation(series: &[f64]) -> f64 {
    (deviation_sum(series, mean(series)) / series.len() as f64).sqrt()
}

fn mean(series: &[f64]) -> f64 {
    series.iter().sum::<f64>() / series.len() as f64
}

fn deviation_sum(series: &[f64], mean: f64) -> f64 {
    series.iter().map(|value| (value - mean).powi(2)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ends_of_the_scales() {
        let wave: Vec<f64> = (0..1000)
            .map(|index| (index as f64 * 0.0628318530718).sin())
            .collect();
        let still = vec![0.0; 1000];
        let opposite: Vec<f64> = wave.iter().map(|value| -value).collect();
        assert_eq!(root_mean_square_error(&wave, &wave), 0.0);
        assert!((pearson_correlation(&wave, &wave) - 1.0).abs() < 1e-12);
        assert_eq!(amplitude_pulse_level(&wave, &wave), 0.0);
        assert_eq!(amplitude_pulse_level(&wave, &still), 1.0);
        assert_eq!(amplitude_pulse_level(&still, &still), 0.0);
        assert!((pearson_correlation(&wave, &opposite) + 1.0).abs() < 1e-12);
        assert!((root_mean_square_error(&wave, &opposite) - 2.0_f64.sqrt()).abs() < 1e-3);
        assert!(amplitude_pulse_level(&wave, &opposite) < 1e-12);
    }

    #[test]
    fn a_scaled_and_shifted_series() {
        let measured = [0.0, 1.0, 0.0, -1.0, 0.0, 1.0, 0.0, -1.0];
        let model: Vec<f64> = measured.iter().map(|value| 3.0 + 0.75 * value).collect();
        assert!((amplitude_pulse_level(&model, &measured) - 1.0 / 7.0).abs() < 1e-12);
        assert!((pearson_correlation(&model, &measured) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn unequal_lengths_have_no_measure() {
        assert!(root_mean_square_error(&[1.0], &[]).is_nan());
        assert!(pearson_correlation(&[1.0, 2.0], &[1.0]).is_nan());
        assert!(root_mean_square_error(&[], &[]).is_nan());
    }
}
