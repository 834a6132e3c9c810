//! Straight lines through points, with the uncertainty of their coefficients.

/// A coefficient with its standard error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// Value.
    pub value: f64,
    /// Standard error.
    pub error: f64,
}

/// y = `offset` + `slope` x by least squares; `None` with fewer than three points or a single abscissa.
#[must_use]
pub fn straight(x: &[f64], y: &[f64]) -> Option<(Estimate, Estimate)> {
    let count = x.len();
    if count < 3 || y.len() != count {
        return None;
    }
    let n = count as f64;
    let (mean_x, mean_y) = (x.iter().sum::<f64>() / n, y.iter().sum::<f64>() / n);
    let spread: f64 = x.iter().map(|x| (x - mean_x).powi(2)).sum();
    if spread.is_nan() || spread <= 0.0 {
        return None;
    }
    let product: f64 = x
        .iter()
        .zip(y)
        .map(|(x, y)| (x - mean_x) * (y - mean_y))
        .sum();
    let slope = product / spread;
    let offset = mean_y - slope * mean_x;
    let residual: f64 = x
        .iter()
        .zip(y)
        .map(|(x, y)| (y - offset - slope * x).powi(2))
        .sum();
    let variance = residual / (n - 2.0);
    Some((
        Estimate {
            value: offset,
            error: (variance * (1.0 / n + mean_x * mean_x / spread)).sqrt(),
        },
        Estimate {
            value: slope,
            error: (variance / spread).sqrt(),
        },
    ))
}

/// y = `slope` x by least squares; `None` with fewer than two points or x all zero.
#[must_use]
pub fn through_origin(x: &[f64], y: &[f64]) -> Option<Estimate> {
    let square: f64 = x.iter().map(|x| x * x).sum();
    if x.len() < 2 || y.len() != x.len() || square.is_nan() || square <= 0.0 {
        return None;
    }
    let slope = x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>() / square;
    let residual: f64 = x.iter().zip(y).map(|(x, y)| (y - slope * x).powi(2)).sum();
    Some(Estimate {
        value: slope,
        error: (residual / (x.len() as f64 - 1.0) / square).sqrt(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_points_have_no_error() {
        let x = [0.0, 1.0, 2.0, 5.0];
        let y = x.map(|x| 3.0 - 0.5 * x);
        let (offset, slope) = straight(&x, &y).unwrap();
        assert!((offset.value - 3.0).abs() < 1e-12 && (slope.value + 0.5).abs() < 1e-12);
        assert!(slope.error < 1e-12);
        assert!(straight(&[1.0; 4], &y).is_none());
    }

    #[test]
    fn error_of_the_slope() {
        // Residuals ±1 about y = 2x at x = 1, 1, 2, 2: slope 2, s² = 4/3, Σx² = 10.
        let line = through_origin(&[1.0, 1.0, 2.0, 2.0], &[3.0, 1.0, 5.0, 3.0]).unwrap();
        assert!((line.value - 2.0).abs() < 1e-12);
        assert!((line.error - (4.0 / 3.0 / 10.0_f64).sqrt()).abs() < 1e-12);
    }
}
