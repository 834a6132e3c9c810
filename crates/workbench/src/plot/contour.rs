//! The boundary of a region on a grid.

/// A straight piece of a curve: its two ends.
pub type Piece = [(f64, f64); 2];

/// Pieces of the curve on which a grid's values cross `level`, by linear interpolation along the grid's edges (marching
/// squares).
///
/// `value(column, row)` is the value at (`x[column]`, `y[row]`); cells with a corner that is not finite are left out.
#[must_use]
pub fn boundary(
    x: &[f64],
    y: &[f64],
    level: f64,
    value: impl Fn(usize, usize) -> f64,
) -> Vec<Piece> {
    let mut pieces = Vec::new();
    for row in 1..y.len() {
        for column in 1..x.len() {
            let corners = [
                (column - 1, row - 1),
                (column, row - 1),
                (column, row),
                (column - 1, row),
            ];
            let heights = corners.map(|(column, row)| value(column, row) - level);
            if heights.iter().any(|height| !height.is_finite()) {
                continue;
            }
            let mut crossings = Vec::with_capacity(4);
            for (from, to) in [(0, 1), (1, 2), (2, 3), (3, 0)] {
                if (heights[from] < 0.0) != (heights[to] < 0.0) {
                    let share = heights[from] / (heights[from] - heights[to]);
                    let (start, end) = (corners[from], corners[to]);
                    crossings.push((
                        x[start.0] + share * (x[end.0] - x[start.0]),
                        y[start.1] + share * (y[end.1] - y[start.1]),
                    ));
                }
            }
            // Two crossings are one piece; four are two pieces that cut off opposite corners.
            pieces.extend(crossings.chunks_exact(2).map(|pair| [pair[0], pair[1]]));
        }
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_circle_is_followed() {
        let axis: Vec<f64> = (0..=40)
            .map(|index| -2.0 + 0.1 * f64::from(index))
            .collect();
        let pieces = boundary(&axis, &axis, 1.0, |column, row| {
            axis[column].hypot(axis[row])
        });
        let length: f64 = pieces
            .iter()
            .map(|[from, to]| (to.0 - from.0).hypot(to.1 - from.1))
            .sum();
        assert!((length - std::f64::consts::TAU).abs() < 0.02, "{length}");
        assert!(
            pieces
                .iter()
                .flatten()
                .all(|point| (point.0.hypot(point.1) - 1.0).abs() < 2e-3)
        );
    }

    #[test]
    fn missing_corners_and_flat_grids_have_no_boundary() {
        let axis = [0.0, 1.0];
        assert!(boundary(&axis, &axis, 0.5, |_, _| 0.0).is_empty());
        assert!(
            boundary(&axis, &axis, 0.5, |column, _| if column == 0 {
                f64::NAN
            } else {
                1.0
            })
            .is_empty()
        );
    }
}
