//! Drive and contact: the force that was measured against the force that the model needs for the measured motion.

use super::known::Known;
use super::model::Model;
use super::motion::{Measurement, Motion, Scales};
use super::prepared::Prepared;
use super::problem::Problem;
use super::term::Sample;

/// Length of a piece in periods of the motion: from one reversal to the next, since friction's errors change sign with the direction.
const PIECE: f64 = 0.5;
/// Least length of what is left out together, in periods of the motion: long against slow changes of load and temperature.
const FOLD: f64 = 3.0;
/// Most parts that are left out in turn.
pub const MOST_FOLDS: usize = 8;

/// Records with measured force, prepared for comparison.
#[derive(Debug, Clone)]
pub struct Balance {
    records: Vec<Prepared>,
    piece: usize,
    folds: Vec<usize>,
    /// Numbers that were known before.
    known: Vec<Known>,
    /// What a residual at each port of an FMU counts; 1 where none is given.
    weights: Vec<f64>,
}

/// One compared moment: what was measured, what the model says, and when and where that was.
#[derive(Debug, Clone, Copy)]
pub struct Compared {
    /// The moment.
    pub sample: Sample,
    /// Measured force [N, N m].
    pub measured: f64,
    /// The model's force.
    pub model: f64,
}

impl Balance {
    /// Prepares records; a free swing is a balance without force.
    #[must_use]
    pub fn new(records: &[Motion], measurement: &Measurement, scales: &Scales) -> Self {
        let prepared: Vec<Prepared> = records
            .iter()
            .map(|motion| Prepared::new(motion, measurement))
            .collect();
        let interval = prepared.first().map_or(1.0, Prepared::interval);
        let piece = ((PIECE * scales.period / interval).round() as usize).max(4);
        let pieces: Vec<usize> = prepared.iter().map(|p| p.count().div_ceil(piece)).collect();
        let seconds: f64 = prepared.iter().map(|p| p.motion().seconds()).sum();
        let count = ((seconds / (FOLD * scales.period)).round() as usize).clamp(3, MOST_FOLDS);
        let total: usize = pieces.iter().sum();
        let folds = if prepared.iter().all(|p| p.motion().port == 0) {
            (0..total).map(|at| at * count / total.max(1)).collect()
        } else {
            folds_by_time(&prepared, &pieces, count)
        };
        Self {
            folds,
            records: prepared,
            piece,
            known: Vec::new(),
            weights: Vec::new(),
        }
    }

    /// The same where a residual at each port of an FMU counts so much.
    #[must_use]
    pub fn weighing(mut self, weights: &[f64]) -> Self {
        self.weights = weights.to_vec();
        self
    }

    /// What is at one port of an FMU.
    #[must_use]
    pub fn at_port(&self, port: usize) -> Self {
        let is_there = self.pieces_at(port);
        let folds = self.folds.iter().zip(is_there);
        Self {
            folds: folds
                .filter(|(_, own)| *own)
                .map(|(fold, _)| *fold)
                .collect(),
            records: self
                .records
                .iter()
                .filter(|own| own.motion().port == port)
                .cloned()
                .collect(),
            ..self.clone()
        }
    }

    /// Of each piece, whether it is at this port.
    #[must_use]
    pub fn pieces_at(&self, port: usize) -> Vec<bool> {
        self.records
            .iter()
            .flat_map(|own| {
                let pieces = own.count().div_ceil(self.piece);
                vec![own.motion().port == port; pieces]
            })
            .collect()
    }

    fn weight(&self, record: &Prepared) -> f64 {
        self.weights
            .get(record.motion().port)
            .copied()
            .unwrap_or(1.0)
    }

    /// The same where these numbers were known before.
    #[must_use]
    pub fn knowing(mut self, known: &[Known]) -> Self {
        self.known = known.to_vec();
        self
    }

    /// Every compared moment under a model, in time.
    #[must_use]
    pub fn compared(&self, model: &Model) -> Vec<Compared> {
        let mut all = Vec::new();
        for record in &self.records {
            let forces = record.force(model);
            let lightness = record.lightness(model) * self.weight(record);
            let measured = record.measured(model);
            for (at, (measured, force)) in measured.into_iter().zip(forces).enumerate() {
                all.push(Compared {
                    sample: record.moment(at),
                    measured: lightness * measured,
                    model: lightness * force,
                });
            }
        }
        all
    }

    /// Share of the square of what a model leaves that is no noise: that still goes on a period of the lowest cut-off later. Noise has
    /// turned its sign by then.
    #[must_use]
    pub fn lasting(&self, model: &Model) -> f64 {
        let mut sums: Vec<(f64, usize)> = Vec::new();
        for record in &self.records {
            let products = record.products(&self.left_of(record, model));
            for (later, (sum, count)) in products.into_iter().enumerate() {
                if sums.len() <= later {
                    sums.push((0.0, 0));
                }
                sums[later].0 += sum;
                sums[later].1 += count;
            }
        }
        let means = sums.iter().filter(|(_, count)| *count > 0);
        let means: Vec<f64> = means.map(|(sum, count)| sum / *count as f64).collect();
        let least = means.iter().copied().fold(f64::INFINITY, f64::min);
        means
            .first()
            .map_or(0.0, |square| (least / square).max(0.0))
    }

    /// What a model leaves of a record.
    fn left_of(&self, record: &Prepared, model: &Model) -> Vec<f64> {
        let lightness = record.lightness(model) * self.weight(record);
        let pairs = record.measured(model).into_iter().zip(record.force(model));
        pairs.map(|(y, f)| (y - f) * lightness).collect()
    }

    /// Number of compared moments of each piece.
    #[must_use]
    pub fn piece_lengths(&self) -> Vec<usize> {
        self.records
            .iter()
            .flat_map(|record| {
                let starts = (0..record.count()).step_by(self.piece);
                starts.map(|start| self.piece.min(record.count() - start))
            })
            .collect()
    }
}

/// Folds of pieces that were measured at the same time at several ports: left out together.
fn folds_by_time(prepared: &[Prepared], pieces: &[usize], count: usize) -> Vec<usize> {
    let ports = prepared.iter().map(|own| own.motion().port + 1).max();
    let seconds = || prepared.iter().map(|own| own.motion().seconds());
    // Each record stands there once for every port.
    let total = seconds().sum::<f64>() / ports.unwrap_or(1) as f64;
    let mut folds = Vec::new();
    let mut begin = 0.0;
    for ((own, &pieces), seconds) in prepared.iter().zip(pieces).zip(seconds()) {
        for piece in 0..pieces {
            let part = (piece as f64 + 0.5) / pieces as f64;
            let at = (begin + part * seconds) / total;
            folds.push(((at * count as f64) as usize).min(count - 1));
        }
        if Some(own.motion().port + 1) == ports {
            begin += seconds;
        }
    }
    folds
}

impl Problem for Balance {
    fn residuals(&self, model: &Model) -> Vec<Vec<f64>> {
        let mut pieces = Vec::with_capacity(self.folds.len());
        for record in &self.records {
            let left = self.left_of(record, model);
            pieces.extend(left.chunks(self.piece).map(<[f64]>::to_vec));
        }
        pieces
    }

    fn slopes(
        &self,
        model: &Model,
        residuals: &[Vec<f64>],
        (term, number): (usize, usize),
    ) -> Option<Vec<Vec<f64>>> {
        let linear = model.terms()[term].entry.linear();
        let place = linear.iter().position(|own| *own == number)?;
        if model.is_depended_on(term) {
            return None;
        }
        let mut residuals = residuals.iter();
        let mut all = Vec::with_capacity(self.folds.len());
        for record in &self.records {
            let weight = record.lightness(model) * self.weight(record);
            let lighter = record.lighter(model, (term, number));
            let acts = model.acting(record.motion().port).any(|at| at == term);
            let slopes = match acts {
                true => record.slope(model, term, place),
                false => vec![0.0; record.count()],
            };
            for slopes in slopes.chunks(self.piece) {
                let pairs = slopes.iter().zip(residuals.next()?);
                all.push(
                    pairs
                        .map(|(slope, residual)| residual * lighter - slope * weight)
                        .collect(),
                );
            }
        }
        Some(all)
    }

    fn known(&self) -> &[Known] {
        &self.known
    }

    fn folds(&self) -> &[usize] {
        &self.folds
    }
}
