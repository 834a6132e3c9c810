//! Frequency and damping from a free decay by logarithmic decrement (Eqs 4-8 to 4-11).

use std::f64::consts::{PI, TAU};

use super::line::{Estimate, straight};

/// What a free decay says.
#[derive(Debug, Clone, PartialEq)]
pub struct Decay {
    /// Damped angular frequency ω_d [rad/s].
    pub damped_frequency: Estimate,
    /// Logarithmic decrement υ of a full period.
    pub decrement: Estimate,
    /// Damping ratio ξ.
    pub damping_ratio: f64,
    /// Undamped angular frequency ω_n [rad/s].
    pub natural_frequency: f64,
    /// Times [s] and values of the extremes that were used.
    pub extremes: Vec<(f64, f64)>,
}

impl Decay {
    /// Damping coefficient d = 2 ξ J ω_n [N m s/rad] of a body of the given inertia [kg m²].
    #[must_use]
    pub fn damping(&self, inertia: f64) -> f64 {
        2.0 * self.damping_ratio * inertia * self.natural_frequency
    }

    /// Stiffness J ω_n² [N m/rad] on which a body of the given inertia [kg m²] swings.
    #[must_use]
    pub fn stiffness(&self, inertia: f64) -> f64 {
        inertia * self.natural_frequency * self.natural_frequency
    }
}

/// Damping ratio of a logarithmic decrement (Eq. 4-9).
#[must_use]
pub fn damping_ratio(decrement: f64) -> f64 {
    decrement / decrement.hypot(TAU)
}

/// Evaluates a decay sampled at `time` [s]; swings smaller than `smallest` (in the series' unit) are left out, since the
/// sensor's resolution dominates them. `None` with fewer than four swings.
///
/// An extreme is the vertex of the parabola through the samples about it; the half differences of neighbouring extremes
/// carry the decrement, so that the position of rest need not be known.
#[must_use]
pub fn evaluate(time: &[f64], displacement: &[f64], smallest: f64) -> Option<Decay> {
    let extremes = extremes(time, displacement, smallest)?;
    if extremes.len() < 5 {
        return None;
    }
    let numbers: Vec<f64> = (0..extremes.len()).map(|index| index as f64).collect();
    let times: Vec<f64> = extremes.iter().map(|extreme| extreme.0).collect();
    let (_, half_period) = straight(&numbers, &times)?;
    let swings: Vec<f64> = extremes
        .windows(2)
        .map(|pair| (0.5 * (pair[0].1 - pair[1].1)).abs().ln())
        .collect();
    let (_, fall) = straight(&numbers[..swings.len()], &swings)?;
    let decrement = Estimate {
        value: -2.0 * fall.value,
        error: 2.0 * fall.error,
    };
    let damped = PI / half_period.value;
    let ratio = damping_ratio(decrement.value);
    Some(Decay {
        damped_frequency: Estimate {
            value: damped,
            error: damped * half_period.error / half_period.value,
        },
        decrement,
        damping_ratio: ratio,
        natural_frequency: damped / (1.0 - ratio * ratio).sqrt(),
        extremes,
    })
}

/// The extremes between crossings of the middle, refined.
fn extremes(time: &[f64], values: &[f64], smallest: f64) -> Option<Vec<(f64, f64)>> {
    if time.len() != values.len() || time.len() < 8 {
        return None;
    }
    // The mean over the last quarter is the best guess of the position of rest before the period is known.
    let tail = &values[values.len() * 3 / 4..];
    let rest = tail.iter().sum::<f64>() / tail.len() as f64;
    let mut raw: Vec<usize> = Vec::new();
    for (index, value) in values.iter().enumerate() {
        let away = value - rest;
        if away.abs() < smallest {
            continue;
        }
        match raw.last_mut() {
            Some(last) if (values[*last] - rest) * away > 0.0 => {
                if away.abs() > (values[*last] - rest).abs() {
                    *last = index;
                }
            }
            _ => raw.push(index),
        }
    }
    if raw.len() < 3 {
        return None;
    }
    let half_period = (raw[raw.len() - 1] - raw[0]) / (raw.len() - 1);
    let reach = (half_period / 5).max(2);
    // The first one may be cut off by the start of the record.
    let refined = raw
        .iter()
        .skip(1)
        .filter(|&&index| index >= reach && index + reach < values.len())
        .filter_map(|&index| {
            let window = index - reach..=index + reach;
            vertex(&time[window.clone()], &values[window], time[index])
        })
        .collect();
    Some(refined)
}

/// Vertex of the parabola of least squares.
fn vertex(time: &[f64], values: &[f64], centre: f64) -> Option<(f64, f64)> {
    let shifted: Vec<f64> = time.iter().map(|t| t - centre).collect();
    let [c0, c1, c2] = super::local_polynomial::quadratic(&shifted, values)?;
    let at = -c1 / (2.0 * c2);
    let bound = shifted.last()?.abs();
    (at.abs() <= bound).then_some((centre + at, c0 + 0.5 * c1 * at))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quantised_decay_gives_its_damping_back() {
        let (natural, ratio, resolution): (f64, f64, f64) = (4.808, 0.0157, TAU / 1000.0);
        let damped = natural * (1.0 - ratio * ratio).sqrt();
        let time: Vec<f64> = (0..4000).map(|index| f64::from(index) * 0.01).collect();
        let values: Vec<f64> = time
            .iter()
            .map(|t| {
                let clean = 0.05 + 1.2 * (-ratio * natural * t).exp() * (damped * t).cos();
                (clean / resolution).floor() * resolution
            })
            .collect();
        let decay = evaluate(&time, &values, 0.1).unwrap();
        assert!(
            (decay.damping_ratio / ratio - 1.0).abs() < 0.01,
            "{decay:?}"
        );
        assert!(
            (decay.natural_frequency / natural - 1.0).abs() < 1e-3,
            "{decay:?}"
        );
        assert!((decay.decrement.value - 0.0987).abs() < 1e-3);
    }

    #[test]
    fn a_line_is_no_decay() {
        let time: Vec<f64> = (0..100).map(f64::from).collect();
        assert_eq!(evaluate(&time, &vec![1.0; 100], 0.01), None);
    }
}
