//! Knots of a free function over the coordinate's range in the records, and how smooth and large it is a priori.

use super::family::Family;
use super::table::TableEffect;
use crate::gram::{Gram, Place};
use crate::problem::Problem;
use crate::structure::augment;
use nalgebra::{Cholesky, DMatrix};
use std::f64::consts::TAU;

/// Knots of a function.
pub(super) const KNOTS: usize = 24;
/// Part of a function's variance that is independent from knot to knot, so that matrices stay positive.
const JITTER: f64 = 1e-6;
/// Range of a coordinate, as a share of it, below which it does not vary.
const ROUNDING: f64 = 1e-6;

/// A family on a problem's records, in the plant's units.
pub(super) struct Basis<'a> {
    pub problem: &'a Problem,
    pub family: Family,
    knots: Vec<f64>,
    ratio: f64,
}

impl<'a> Basis<'a> {
    /// `None` where the coordinate does not vary.
    pub(super) fn new(
        problem: &'a Problem,
        family: Family,
        grams: &[Option<Gram>],
    ) -> Option<Self> {
        let ratio = problem.rig.gearbox.ratio;
        let knots = if family.is_periodic() {
            (0..KNOTS).map(|k| k as f64 * TAU / KNOTS as f64).collect()
        } else {
            let seen = grams
                .iter()
                .flatten()
                .flat_map(|gram| &gram.places)
                .filter(|place| family.torques(place, ratio, 0.0) != (0.0, 0.0))
                .map(|place| family.coordinate(place, ratio));
            let (low, high) = seen.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
                (low.min(x), high.max(x))
            });
            let varies = high - low > ROUNDING * high.abs().max(low.abs());
            if !varies {
                return None;
            }
            let step = (high - low) / (KNOTS - 1) as f64;
            (0..KNOTS).map(|k| low + step * k as f64).collect()
        };
        Some(Self {
            problem,
            family,
            knots,
            ratio,
        })
    }

    fn step(&self) -> f64 {
        self.knots[1] - self.knots[0]
    }

    /// The knot below a coordinate, the next one, and the share of the way to that.
    fn between(&self, x: f64) -> (usize, usize, f64) {
        let at = (x - self.knots[0]) / self.step();
        if self.family.is_periodic() {
            let below = at.floor();
            let k = (below as usize) % KNOTS;
            return (k, (k + 1) % KNOTS, at - below);
        }
        let at = at.clamp(0.0, (KNOTS - 1) as f64);
        let k = (at.floor() as usize).min(KNOTS - 2);
        (k, k + 1, at - k as f64)
    }

    /// Gram matrices with the values at the knots as further free numbers, where they are `values`.
    pub(super) fn augmented(&self, grams: &[Option<Gram>], values: &[f64]) -> Vec<Option<Gram>> {
        let functions = |place: &Place| {
            let (below, above, share) = self.between(self.family.coordinate(place, self.ratio));
            let present = (1.0 - share) * values[below] + share * values[above];
            let (disc, motor) = self.family.torques(place, self.ratio, present);
            let mut hats = vec![(0.0, 0.0); KNOTS];
            hats[below] = ((1.0 - share) * disc, (1.0 - share) * motor);
            hats[above] = (share * disc, share * motor);
            hats
        };
        let with = |gram: &Gram| augment(gram, functions);
        grams.iter().map(|gram| gram.as_ref().map(with)).collect()
    }

    /// Square root of the covariance of the values at the knots.
    pub(super) fn root(&self, reach: f64, size: f64) -> Option<DMatrix<f64>> {
        let range = if self.family.is_periodic() {
            TAU
        } else {
            self.knots[KNOTS - 1] - self.knots[0]
        };
        let size = size * self.family.size(&self.problem.long.scales, self.ratio);
        let covariance = DMatrix::from_fn(KNOTS, KNOTS, |i, j| {
            let between = self.knots[i] - self.knots[j];
            let distance = if self.family.is_periodic() {
                2.0 * (0.5 * between).sin()
            } else {
                between
            };
            let near = (-0.5 * (distance / (reach * range)).powi(2)).exp();
            size * size * (near + if i == j { JITTER } else { 0.0 })
        });
        Cholesky::new(covariance).map(|cholesky| cholesky.l())
    }

    /// Name of the effect: one that the model does not have yet, which may itself have been amended.
    fn name(&self) -> String {
        let plain = self.family.name();
        let is_free = |name: &String| {
            let mut known = self.problem.rig.equations.known();
            known.all(|effect| effect.definition.name() != name)
        };
        std::iter::once(plain.clone())
            .chain((2..).map(|number| format!("{plain}_{number}")))
            .find(is_free)
            .unwrap_or(plain)
    }

    /// The effect with these values at the knots.
    pub(super) fn table(&self, values: &[f64]) -> TableEffect {
        let ([x, y], units) = self.family.units(&self.problem.units);
        let scaled = |numbers: &[f64], unit: f64| numbers.iter().map(|v| v * unit).collect();
        TableEffect {
            name: self.name(),
            port: self.family.port,
            equation: self.family.equation(),
            units: units.map(str::to_owned),
            period: self.family.is_periodic().then_some(TAU),
            knots: scaled(&self.knots, x),
            values: scaled(values, y),
        }
    }
}
