//! A function that a file gives by points: piecewise polynomials between knots.

use super::Dimension;
use thiserror::Error;

/// Most points of a table: more tell of a record, not of a function.
const MOST_POINTS: usize = 400;

/// What lies between the points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interpolation {
    /// Straight lines.
    Linear,
    /// Cubic polynomials that meet with equal slope and curvature; natural ends without a period.
    Spline,
}

/// Points, and what they make.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Name by which an equation calls it.
    pub name: String,
    /// Dimension of its argument.
    pub argument: Dimension,
    /// Dimension of its value.
    pub value: Dimension,
    /// Where pieces meet, rising; the last one of a periodic table is the first one a period on.
    pub knots: Vec<f64>,
    /// Coefficients of each piece about its lower knot.
    pub pieces: Vec<[f64; 4]>,
    /// Period of a function that repeats. Without one, the function keeps its first and last value beyond its knots.
    pub period: Option<f64>,
}

/// Why points make no function.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum TableError {
    /// Numbers of points differ, are too few or too many.
    #[error(
        "table {name} has {x} x and {y} y; it needs as many of one as of the other, from 2 to {MOST_POINTS}"
    )]
    Points {
        /// The table.
        name: String,
        /// How many x.
        x: usize,
        /// How many y.
        y: usize,
    },
    /// An x that is no number.
    #[error("table {name}: x[{place}] = {value:?} must be a finite number")]
    Knot {
        /// The table.
        name: String,
        /// Which x.
        place: usize,
        /// Its value.
        value: f64,
    },
    /// An x that does not lie above the one before it.
    #[error("table {name}: x[{place}] = {value:?} must lie above x[{}] = {before:?}", place.saturating_sub(1))]
    Unsorted {
        /// The table.
        name: String,
        /// Which x.
        place: usize,
        /// Its value.
        value: f64,
        /// The one before.
        before: f64,
    },
    /// Points so near or so far apart that what lies between them is no number.
    #[error(
        "table {name}: between x[{place}] = {from:?} and the next point at {to:?} the slope is too large for a number; \
         put the points further apart or the values nearer to each other"
    )]
    Steep {
        /// The table.
        name: String,
        /// The x at which the piece begins.
        place: usize,
        /// Its value.
        from: f64,
        /// Where the piece ends.
        to: f64,
    },
    /// A value that is no number.
    #[error("table {name}: y[{place}] = {value:?} must be a finite number")]
    Value {
        /// The table.
        name: String,
        /// Which y.
        place: usize,
        /// Its value.
        value: f64,
    },
    /// A period that does not hold all points.
    #[error(
        "table {name}: period = {period:?} must be above x[last] − x[0] = {span:?}; the first point returns by itself"
    )]
    Period {
        /// The table.
        name: String,
        /// Its period.
        period: f64,
        /// What the points span.
        span: f64,
    },
}

impl Table {
    /// The function through the points (`x`, `y`).
    ///
    /// # Errors
    /// Points that make none.
    pub fn new(
        name: &str,
        (argument, value): (Dimension, Dimension),
        x: &[f64],
        y: &[f64],
        interpolation: Interpolation,
        period: Option<f64>,
    ) -> Result<Self, TableError> {
        let owned = || name.to_owned();
        if x.len() != y.len() || x.len() < 2 || x.len() > MOST_POINTS {
            return Err(TableError::Points {
                name: owned(),
                x: x.len(),
                y: y.len(),
            });
        }
        for place in 0..x.len() {
            if !x[place].is_finite() {
                return Err(TableError::Knot {
                    name: owned(),
                    place,
                    value: x[place],
                });
            }
            if place > 0 && x[place] <= x[place - 1] {
                return Err(TableError::Unsorted {
                    name: owned(),
                    place,
                    value: x[place],
                    before: x[place - 1],
                });
            }
            if !y[place].is_finite() {
                return Err(TableError::Value {
                    name: owned(),
                    place,
                    value: y[place],
                });
            }
        }
        let (mut knots, mut values) = (x.to_vec(), y.to_vec());
        if let Some(period) = period {
            let span = x[x.len() - 1] - x[0];
            if !(period.is_finite() && period > span) {
                return Err(TableError::Period {
                    name: owned(),
                    period,
                    span,
                });
            }
            knots.push(x[0] + period);
            values.push(y[0]);
        }
        let curvatures = match interpolation {
            Interpolation::Linear => vec![0.0; knots.len()],
            Interpolation::Spline => curvatures(&knots, &values, period.is_some()),
        };
        let pieces: Vec<[f64; 4]> = (0..knots.len() - 1)
            .map(|j| {
                let width = knots[j + 1] - knots[j];
                let (here, next) = (curvatures[j], curvatures[j + 1]);
                [
                    values[j],
                    (values[j + 1] - values[j]) / width - width * (2.0 * here + next) / 6.0,
                    here / 2.0,
                    (next - here) / (6.0 * width),
                ]
            })
            .collect();
        let is_steep = |piece: &[f64; 4]| piece.iter().any(|coefficient| !coefficient.is_finite());
        if let Some(place) = pieces.iter().position(is_steep) {
            return Err(TableError::Steep {
                name: owned(),
                place,
                from: knots[place],
                to: knots[place + 1],
            });
        }
        Ok(Self {
            name: owned(),
            argument,
            value,
            knots,
            pieces,
            period,
        })
    }

    /// The piece that `x` lies on: turns × pieces + piece with a period; without one, −1 below the knots and the number of pieces
    /// above.
    pub(super) fn branch(&self, x: f64) -> i32 {
        let count = self.pieces.len() as i32;
        let turn = self
            .period
            .map_or(0.0, |period| ((x - self.knots[0]) / period).floor());
        let local = x - turn * self.period.unwrap_or(0.0);
        let piece = self.knots.partition_point(|knot| *knot <= local) as i32 - 1;
        if self.period.is_some() {
            (turn as i32)
                .saturating_mul(count)
                .saturating_add(piece.clamp(0, count - 1))
        } else {
            piece
        }
    }

    /// Coefficients on this branch and the knots between which it lies.
    pub(super) fn piece(&self, branch: i32) -> ([f64; 4], [f64; 2]) {
        let count = self.pieces.len() as i32;
        match self.period {
            Some(period) => {
                let place = branch.rem_euclid(count) as usize;
                let shift = f64::from(branch.div_euclid(count)) * period;
                let ends = [self.knots[place] + shift, self.knots[place + 1] + shift];
                (self.pieces[place], ends)
            }
            None if branch < 0 => {
                let first = self.knots[0];
                let value = self.pieces[0][0];
                ([value, 0.0, 0.0, 0.0], [f64::NEG_INFINITY, first])
            }
            None if branch >= count => {
                let last = self.pieces.len() - 1;
                let width = self.knots[last + 1] - self.knots[last];
                let [a, b, c, d] = self.pieces[last];
                let value = a + width * (b + width * (c + width * d));
                (
                    [value, 0.0, 0.0, 0.0],
                    [self.knots[last + 1], f64::INFINITY],
                )
            }
            None => {
                let place = branch as usize;
                (
                    self.pieces[place],
                    [self.knots[place], self.knots[place + 1]],
                )
            }
        }
    }
}

/// Second derivatives of the cubic spline through the points, natural or periodic.
fn curvatures(x: &[f64], y: &[f64], periodic: bool) -> Vec<f64> {
    let last = x.len() - 1;
    let width = |j: usize| x[j + 1] - x[j];
    let slope = |j: usize| (y[j + 1] - y[j]) / width(j);
    let (first, count) = if periodic { (0, last) } else { (1, last - 1) };
    if count == 0 {
        return vec![0.0; x.len()];
    }
    let mut matrix = vec![vec![0.0; count]; count];
    let mut right = vec![0.0; count];
    for row in 0..count {
        let j = first + row;
        let before = if j == 0 { last - 1 } else { j - 1 };
        let weights = [
            (before, width(before)),
            (j, 2.0 * (width(before) + width(j))),
            (j + 1, width(j)),
        ];
        for (place, weight) in weights {
            let place = if periodic { place % last } else { place };
            if let Some(column) = place.checked_sub(first).filter(|column| *column < count) {
                matrix[row][column] += weight;
            }
        }
        right[row] = 6.0 * (slope(j) - slope(before));
    }
    eliminate(&mut matrix, &mut right);
    let mut all = vec![0.0; x.len()];
    all[first..first + count].copy_from_slice(&right);
    if periodic {
        all[last] = all[0];
    }
    all
}

/// Solves linear equations whose diagonal dominates, in place of their right-hand side.
fn eliminate(matrix: &mut [Vec<f64>], right: &mut [f64]) {
    let count = right.len();
    for pivot in 0..count {
        let (above, below) = matrix.split_at_mut(pivot + 1);
        let own = &above[pivot];
        for (offset, row) in below
            .iter_mut()
            .enumerate()
            .filter(|(_, row)| row[pivot] != 0.0)
        {
            let factor = row[pivot] / own[pivot];
            for (value, of) in row[pivot..].iter_mut().zip(&own[pivot..]) {
                *value -= factor * of;
            }
            right[pivot + 1 + offset] -= factor * right[pivot];
        }
    }
    for pivot in (0..count).rev() {
        let known: f64 = (pivot + 1..count)
            .map(|j| matrix[pivot][j] * right[j])
            .sum();
        right[pivot] = (right[pivot] - known) / matrix[pivot][pivot];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(table: &Table, x: f64) -> f64 {
        let ([a, b, c, d], [low, _]) = table.piece(table.branch(x));
        let tau = if low.is_finite() { x - low } else { 0.0 };
        a + tau * (b + tau * (c + tau * d))
    }

    fn made(x: &[f64], y: &[f64], interpolation: Interpolation, period: Option<f64>) -> Table {
        let none = (Dimension::NONE, Dimension::NONE);
        Table::new("f", none, x, y, interpolation, period).unwrap()
    }

    #[test]
    fn a_periodic_spline_through_a_sine_is_nearly_that_sine_for_many_turns() {
        let turn = 2.0 * std::f64::consts::PI;
        let x: Vec<f64> = (0..24).map(|j| f64::from(j) * turn / 24.0).collect();
        let y: Vec<f64> = x.iter().map(|x| x.sin()).collect();
        let table = made(&x, &y, Interpolation::Spline, Some(turn));
        for j in -300..300 {
            let x = 0.137 * f64::from(j);
            assert!((value(&table, x) - x.sin()).abs() < 5e-5, "{x}");
        }
    }

    #[test]
    fn lines_pass_through_their_points_and_stay_level_beyond() {
        let table = made(
            &[0.0, 1.0, 3.0],
            &[2.0, 4.0, 0.0],
            Interpolation::Linear,
            None,
        );
        for (x, y) in [(-5.0, 2.0), (0.5, 3.0), (2.0, 2.0), (9.0, 0.0)] {
            assert_eq!(value(&table, x), y);
        }
    }

    #[test]
    fn a_natural_spline_of_a_line_is_that_line() {
        let table = made(
            &[0.0, 1.0, 4.0, 5.0],
            &[1.0, 3.0, 9.0, 11.0],
            Interpolation::Spline,
            None,
        );
        assert!((value(&table, 2.7) - 6.4).abs() < 1e-14);
    }

    #[test]
    fn points_that_make_no_function_are_refused() {
        let new = |x: &[f64], y: &[f64], period| {
            let none = (Dimension::NONE, Dimension::NONE);
            Table::new("f", none, x, y, Interpolation::Linear, period).unwrap_err()
        };
        assert!(matches!(
            new(&[1.0], &[1.0], None),
            TableError::Points { .. }
        ));
        assert!(matches!(
            new(&[0.0; 500], &[0.0; 500], None),
            TableError::Points { .. }
        ));
        assert!(matches!(
            new(&[1.0, 0.5], &[1.0; 2], None),
            TableError::Unsorted { place: 1, .. }
        ));
        for x in [f64::NAN, f64::INFINITY] {
            for (place, points) in [(0, [x, 1.0]), (1, [0.0, x])] {
                let error = new(&points, &[1.0; 2], None);
                let words = format!("table f: x[{place}] = {x} must be a finite number");
                assert_eq!(error.to_string(), words);
            }
        }
        for x in [[0.0, 1e-320], [-1e308, 1e308]] {
            assert!(matches!(
                new(&x, &[-1e308, 1e308], None),
                TableError::Steep { place: 0, .. }
            ));
        }
        assert!(matches!(
            new(&[0.0, 1.0], &[1.0, f64::NAN], None),
            TableError::Value { .. }
        ));
        assert!(matches!(
            new(&[0.0, 1.0], &[1.0; 2], Some(0.5)),
            TableError::Period { .. }
        ));
    }
}
