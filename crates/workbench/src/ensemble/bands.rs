//! What the runs at one place came to: how often each kind of motion, and bands of the measures.

use crate::analysis::motion::Motion;
use crate::analysis::quantile::of_sorted;
use crate::diagnose::score::wilson::Share;
use crate::map::Point;

/// Shares at which a band is given.
pub const LEVELS: [f64; 3] = [0.05, 0.5, 0.95];

/// A number of a run.
type Measure = fn(&Point) -> f64;

/// Name and value of each measure.
pub const MEASURES: [(&str, Measure); 5] = [
    ("velocity_minimum", |point| point.minimum),
    ("velocity_maximum", |point| point.maximum),
    ("half_amplitude", Point::half_amplitude),
    ("frequency", |point| point.frequency),
    ("stick_fraction", |point| point.stick_fraction),
];

/// The runs at one place.
#[derive(Debug, Clone, PartialEq)]
pub struct Bands {
    /// Number of runs of each kind, in the order of [`Motion::ALL`].
    pub counts: [usize; Motion::ALL.len()],
    /// Number of runs that failed.
    pub failed: usize,
    /// For each of [`MEASURES`] its quantiles at [`LEVELS`] over the runs that have it; NaN where none has.
    pub quantiles: [[f64; LEVELS.len()]; MEASURES.len()],
}

impl Bands {
    /// Of the runs at one place.
    #[must_use]
    pub fn of<'a>(points: impl Iterator<Item = &'a Point> + Clone) -> Self {
        let mut counts = [0; Motion::ALL.len()];
        let mut failed = 0;
        for point in points.clone() {
            match point.motion {
                Some(motion) => counts[motion.index()] += 1,
                None => failed += 1,
            }
        }
        let quantiles = MEASURES.map(|(_, measure)| {
            let mut values: Vec<f64> = points
                .clone()
                .map(measure)
                .filter(|value| value.is_finite())
                .collect();
            values.sort_by(f64::total_cmp);
            LEVELS.map(|level| of_sorted(&values, level).unwrap_or(f64::NAN))
        });
        Self {
            counts,
            failed,
            quantiles,
        }
    }

    /// Number of runs.
    #[must_use]
    pub fn runs(&self) -> usize {
        self.counts.iter().sum::<usize>() + self.failed
    }

    /// How many of the runs that did not fail are of this kind.
    #[must_use]
    pub fn share(&self, motion: Motion) -> Share {
        Share {
            successes: self.counts[motion.index()],
            cases: self.counts.iter().sum(),
        }
    }

    /// The quantiles of the measure with this place in [`MEASURES`].
    #[must_use]
    pub fn band(&self, measure: usize) -> [f64; LEVELS.len()] {
        self.quantiles[measure]
    }
}

/// The bands at every place of the runs in `rows`, a row for each rig.
#[must_use]
pub fn at_places(rows: &[Vec<Point>], places: usize) -> Vec<Bands> {
    (0..places)
        .map(|place| Bands::of(rows.iter().map(move |points| &points[place])))
        .collect()
}
