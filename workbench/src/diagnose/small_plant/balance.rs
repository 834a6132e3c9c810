//! Drive and contact: the force that was measured against the force that the model needs for the measured motion.

use super::filter::LowPass;
use super::model::Model;
use super::model_file::Measurement;
use super::motion::{Motion, Scales};
use super::problem::Problem;
use super::term::Sample;
use super::unit::Kind;

/// Order of the low-pass that both forces go through.
const ORDER: usize = 8;
/// Length of a piece in periods of the motion: several correlation times of what a model leaves.
const PIECE: f64 = 0.5;
/// Least length of what is left out together, in periods of the motion: long against slow changes of load and temperature.
const FOLD: f64 = 3.0;
/// Most parts that are left out in turn.
const MOST_FOLDS: usize = 8;

/// Records with measured force, prepared for comparison.
#[derive(Debug, Clone)]
pub struct Balance {
    records: Vec<Prepared>,
    piece: usize,
    folds: Vec<usize>,
}

#[derive(Debug, Clone)]
struct Prepared {
    motion: Motion,
    filter: Option<LowPass>,
    stride: usize,
    edge: usize,
    /// Measured force, filtered and thinned.
    measured: Vec<f64>,
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
            .map(|motion| {
                let stride = (1.0 / (measurement.compare_rate * motion.interval))
                    .round()
                    .max(1.0) as usize;
                let filter = measurement
                    .compare_low_pass
                    .map(|cut_off| LowPass::new(cut_off, ORDER, motion.interval));
                let mut prepared = Prepared {
                    motion: motion.clone(),
                    filter,
                    stride,
                    edge: (measurement.edge / motion.interval).round() as usize,
                    measured: Vec::new(),
                };
                prepared.measured = prepared.thinned(&motion.force);
                prepared
            })
            .collect();
        let interval = prepared
            .first()
            .map_or(1.0, |p| p.motion.interval * p.stride as f64);
        let piece = ((PIECE * scales.period / interval).round() as usize).max(4);
        let pieces: Vec<usize> = prepared
            .iter()
            .map(|p| p.measured.len().div_ceil(piece))
            .collect();
        let seconds: f64 = prepared.iter().map(|p| p.motion.seconds()).sum();
        let count = ((seconds / (FOLD * scales.period)).round() as usize).clamp(3, MOST_FOLDS);
        let total: usize = pieces.iter().sum();
        Self {
            folds: (0..total).map(|at| at * count / total.max(1)).collect(),
            records: prepared,
            piece,
        }
    }

    /// Every compared moment under a model, in time.
    #[must_use]
    pub fn compared(&self, model: &Model) -> Vec<Compared> {
        let mut all = Vec::new();
        for record in &self.records {
            let forces = record.model_force(model);
            for (at, (measured, force)) in record.measured.iter().zip(forces).enumerate() {
                all.push(Compared {
                    sample: record.sample(record.edge + at * record.stride, 0.0),
                    measured: *measured,
                    model: force,
                });
            }
        }
        all
    }

    /// Number of compared moments of each piece.
    #[must_use]
    pub fn piece_lengths(&self) -> Vec<usize> {
        self.records
            .iter()
            .flat_map(|record| record.measured.chunks(self.piece).map(<[f64]>::len))
            .collect()
    }
}

impl Prepared {
    /// A series after the low-pass, without edges, every so many samples.
    fn thinned(&self, series: &[f64]) -> Vec<f64> {
        let filtered = self.filter.as_ref().map(|filter| filter.apply(series));
        let series = filtered.as_deref().unwrap_or(series);
        let end = series.len().saturating_sub(self.edge);
        series
            .get(self.edge..end)
            .unwrap_or(&[])
            .iter()
            .step_by(self.stride)
            .copied()
            .collect()
    }

    /// The moment at sample `at` plus `shift` samples, between samples on the cubic through four of them.
    fn sample(&self, at: usize, shift: f64) -> Sample {
        let motion = &self.motion;
        let last = motion.len() - 1;
        let place = (at as f64 + shift).clamp(0.0, last as f64);
        let low = (place as usize).min(last - 1);
        let part = place - low as f64;
        let [before, high, after] = [low.saturating_sub(1), low + 1, (low + 2).min(last)];
        // Lagrange's weights at −1, 0, 1, 2.
        let weights = [
            -part * (part - 1.0) * (part - 2.0) / 6.0,
            (part + 1.0) * (part - 1.0) * (part - 2.0) / 2.0,
            -(part + 1.0) * part * (part - 2.0) / 2.0,
            (part + 1.0) * part * (part - 1.0) / 6.0,
        ];
        let between = |series: &[f64]| {
            let nodes = [series[before], series[low], series[high], series[after]];
            weights.iter().zip(nodes).map(|(w, y)| w * y).sum::<f64>()
        };
        Sample {
            time: motion.begin + at as f64 * motion.interval,
            position: between(&motion.position),
            velocity: between(&motion.velocity),
            acceleration: between(&motion.acceleration),
            direction: motion.direction[low],
            load: motion.load[at],
            predicted: between(&motion.predicted),
        }
    }

    fn model_force(&self, model: &Model) -> Vec<f64> {
        let inertia = if model.kind == Kind::Pendulum {
            1.0
        } else {
            0.0
        };
        // What is read now was there `delay` ago: the motion that goes with this force is read later.
        let shift = model.delay() / self.motion.interval;
        let encoder = model.eccentricity();
        let force: Vec<f64> = (0..self.motion.len())
            .map(|at| {
                let read = self.sample(at, shift);
                let sample = encoder.map_or(read, |encoder| encoder.motion(&read));
                model.force(&sample) + inertia * sample.acceleration
            })
            .collect();
        self.thinned(&force)
    }
}

impl Problem for Balance {
    fn residuals(&self, model: &Model) -> Vec<Vec<f64>> {
        let mut pieces = Vec::with_capacity(self.folds.len());
        for record in &self.records {
            let forces = record.model_force(model);
            for (measured, forces) in record
                .measured
                .chunks(self.piece)
                .zip(forces.chunks(self.piece))
            {
                pieces.push(measured.iter().zip(forces).map(|(y, f)| y - f).collect());
            }
        }
        pieces
    }

    fn folds(&self) -> &[usize] {
        &self.folds
    }
}
