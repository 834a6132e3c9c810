//! Stiffness from a static test (Eq. 4-7): known torques, measured twists.

use super::line::{Estimate, straight, through_origin};

/// What a static test says about a stiffness [N m/rad].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StaticStiffness {
    /// Mean of torque over twist, the dissertation's estimate, with its standard error.
    pub mean_ratio: Estimate,
    /// Standard deviation of the ratios (n − 1).
    pub deviation: f64,
    /// Slope of the line through the origin.
    pub proportional: Estimate,
    /// Slope of the line that need not pass through the origin: free of an offset of the twist.
    pub affine: Estimate,
    /// Torque at which that line has no twist [N m].
    pub offset: Estimate,
}

/// Relative spread below which twists count as one and the same.
const SAME: f64 = 1e-9;

/// Evaluates a static test; `None` with fewer than three points, unequal lengths, a twist of zero or one twist throughout.
#[must_use]
pub fn evaluate(torque: &[f64], twist: &[f64]) -> Option<StaticStiffness> {
    let first = *twist.first()?;
    let differ = |other: &f64| (other - first).abs() > SAME * first.abs();
    if twist.contains(&0.0) || !twist.iter().any(differ) {
        return None;
    }
    let (offset, affine) = straight(twist, torque)?;
    let proportional = through_origin(twist, torque)?;
    let ratios: Vec<f64> = torque.iter().zip(twist).map(|(t, d)| t / d).collect();
    let count = ratios.len() as f64;
    let mean = ratios.iter().sum::<f64>() / count;
    let square: f64 = ratios.iter().map(|ratio| (ratio - mean).powi(2)).sum();
    let deviation = (square / (count - 1.0)).sqrt();
    Some(StaticStiffness {
        mean_ratio: Estimate {
            value: mean,
            error: deviation / count.sqrt(),
        },
        deviation,
        proportional,
        affine,
        offset,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statistics_of_table_4_3() {
        let torque = [0.0398, 0.0795, 0.1589, 0.3679, 0.3980, 0.4474, 0.5360];
        let twist = [0.1257, 0.2262, 0.4178, 1.0681, 1.1750, 1.2378, 1.5582];
        let test = evaluate(&torque, &twist).unwrap();
        assert!((test.mean_ratio.value - 0.3482).abs() < 2e-4, "{test:?}");
        assert!((test.deviation - 0.0197).abs() < 2e-4, "{test:?}");
        assert_eq!(evaluate(&torque, &[0.0; 7]), None);
        assert_eq!(evaluate(&torque, &[0.1; 7]), None);
    }
}
