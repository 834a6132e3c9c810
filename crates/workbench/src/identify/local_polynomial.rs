//! Smoothing and differentiating by local parabolas or cubics of least squares (Savitzky and Golay 1964).

/// Coefficients c0 + c1 x + c2 x² of least squares; `None` where the points do not determine them.
#[must_use]
pub fn quadratic(x: &[f64], y: &[f64]) -> Option<[f64; 3]> {
    let solution = fit(x, y, 3)?;
    Some([solution[0], solution[1], solution[2]])
}

/// A series with its first two derivatives.
#[derive(Debug, Clone, PartialEq)]
pub struct Smoothed {
    /// The series.
    pub value: Vec<f64>,
    /// First derivative by time.
    pub first: Vec<f64>,
    /// Second derivative by time.
    pub second: Vec<f64>,
}

/// Fits a cubic to the samples within `half_width` samples of each sample of an evenly sampled series; towards the ends the
/// window is cut. `None` where the series is shorter than the window or `half_width` is below 2.
#[must_use]
pub fn smooth(series: &[f64], step: f64, half_width: usize) -> Option<Smoothed> {
    let count = series.len();
    if half_width < 2 || count < 2 * half_width + 1 || step.is_nan() || step <= 0.0 {
        return None;
    }
    let mut smoothed = Smoothed {
        value: Vec::with_capacity(count),
        first: Vec::with_capacity(count),
        second: Vec::with_capacity(count),
    };
    let inside = weights(half_width, half_width)?;
    for index in 0..count {
        let from = index.saturating_sub(half_width);
        let to = (index + half_width).min(count - 1);
        let whole = index - from == half_width && to - index == half_width;
        let coefficients = if whole {
            inside.clone()
        } else {
            weights(index - from, to - index)?
        };
        let apply = |order: usize| -> f64 {
            series[from..=to]
                .iter()
                .zip(&coefficients[order])
                .map(|(value, weight)| value * weight)
                .sum()
        };
        smoothed.value.push(apply(0));
        smoothed.first.push(apply(1) / step);
        smoothed.second.push(2.0 * apply(2) / (step * step));
    }
    Some(smoothed)
}

/// Weights that give the cubic's coefficients of orders 0 to 2 at the sample with `left` and `right` neighbours.
fn weights(left: usize, right: usize) -> Option<[Vec<f64>; 3]> {
    let x: Vec<f64> = (0..=left + right)
        .map(|index| index as f64 - left as f64)
        .collect();
    let mut rows = [Vec::new(), Vec::new(), Vec::new()];
    for chosen in 0..x.len() {
        let unit: Vec<f64> = (0..x.len())
            .map(|index| f64::from(u8::from(index == chosen)))
            .collect();
        let solution = fit(&x, &unit, 4)?;
        for (row, value) in rows.iter_mut().zip(&solution) {
            row.push(*value);
        }
    }
    Some(rows)
}

/// Polynomial of least squares with `terms` coefficients, by the normal equations of scaled abscissae.
fn fit(x: &[f64], y: &[f64], terms: usize) -> Option<Vec<f64>> {
    if x.len() < terms || x.len() != y.len() {
        return None;
    }
    let scale = x.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    if scale.is_nan() || scale <= 0.0 {
        return None;
    }
    let mut matrix = vec![vec![0.0; terms + 1]; terms];
    for (x, y) in x.iter().zip(y) {
        let powers: Vec<f64> = (0..terms).map(|k| (x / scale).powi(k as i32)).collect();
        for row in 0..terms {
            for column in 0..terms {
                matrix[row][column] += powers[row] * powers[column];
            }
            matrix[row][terms] += powers[row] * y;
        }
    }
    let mut solution = solve(matrix)?;
    for (k, value) in solution.iter_mut().enumerate() {
        *value /= scale.powi(k as i32);
    }
    Some(solution)
}

/// Solves a linear system given with its right-hand side as last column, by elimination with pivots.
#[must_use]
pub fn solve(mut matrix: Vec<Vec<f64>>) -> Option<Vec<f64>> {
    let size = matrix.len();
    for column in 0..size {
        let pivot = (column..size).max_by(|a, b| {
            matrix[*a][column]
                .abs()
                .total_cmp(&matrix[*b][column].abs())
        })?;
        matrix.swap(column, pivot);
        let lead = matrix[column][column];
        if lead.is_nan() || lead.abs() < 1e-300 {
            return None;
        }
        let (upper, lower) = matrix.split_at_mut(column + 1);
        for row in lower {
            let factor = row[column] / lead;
            for (entry, above) in row.iter_mut().zip(&upper[column]).skip(column) {
                *entry -= factor * above;
            }
        }
    }
    let mut solution = vec![0.0; size];
    for row in (0..size).rev() {
        let known: f64 = (row + 1..size).map(|k| matrix[row][k] * solution[k]).sum();
        solution[row] = (matrix[row][size] - known) / matrix[row][row];
    }
    Some(solution)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cubic_and_its_derivatives_come_back_exactly() {
        let step = 0.01;
        let function = |t: f64| 1.0 - 2.0 * t + 3.0 * t * t - 4.0 * t.powi(3);
        let series: Vec<f64> = (0..50)
            .map(|index| function(f64::from(index) * step))
            .collect();
        let smoothed = smooth(&series, step, 5).unwrap();
        for index in [0, 3, 25, 49] {
            let t = index as f64 * step;
            assert!((smoothed.value[index] - function(t)).abs() < 1e-10);
            assert!((smoothed.first[index] - (-2.0 + 6.0 * t - 12.0 * t * t)).abs() < 1e-7);
            assert!((smoothed.second[index] - (6.0 - 24.0 * t)).abs() < 1e-4);
        }
        assert_eq!(smooth(&series, step, 40), None);
    }

    #[test]
    fn a_linear_system_is_solved() {
        let solution = solve(vec![vec![0.0, 2.0, 4.0], vec![3.0, 1.0, 5.0]]).unwrap();
        assert!((solution[0] - 1.0).abs() < 1e-15 && (solution[1] - 2.0).abs() < 1e-15);
    }
}
