//! Drive and contact: the force that was measured against the force that the model needs for the measured motion.

use super::filter::LowPass;
use super::model::{AT_ONCE, Model};
use super::motion::{Measurement, Motion, Scales};
use super::problem::Problem;
use super::term::Sample;
use stickslip::body::{Dimension, Kind};

/// Order of the low-pass that both forces go through.
const ORDER: usize = 8;
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
    /// The FMU's parameters as the analyst believes them.
    nominal: Vec<f64>,
    /// Residual that weighs as much as one standard deviation of such a parameter.
    known: f64,
    /// What a residual at each port of an FMU counts; 1 where none is given.
    weights: Vec<f64>,
}

#[derive(Debug, Clone)]
struct Prepared {
    motion: Motion,
    filter: Option<LowPass>,
    stride: usize,
    edge: usize,
    /// Which of the thinned moments say something.
    kept: Vec<usize>,
    /// Measured force, filtered and thinned.
    measured: Vec<f64>,
    /// Every moment as it was read: what most models are asked about.
    read: Vec<Sample>,
    /// By how much an FMU's missing force falls as each uncertain parameter grows, filtered and thinned.
    slopes: Vec<Vec<f64>>,
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
                let filter = motion
                    .cut_off
                    .or(measurement.compare_low_pass)
                    .map(|cut_off| LowPass::new(cut_off, ORDER, motion.interval));
                let mut prepared = Prepared {
                    motion: motion.clone(),
                    filter,
                    stride,
                    edge: (measurement.edge / motion.interval).round() as usize,
                    kept: Vec::new(),
                    measured: Vec::new(),
                    read: Vec::new(),
                    slopes: Vec::new(),
                };
                prepared.kept = prepared.moving();
                prepared.read = (0..motion.len())
                    .map(|at| prepared.sample(at, 0.0))
                    .collect();
                prepared.measured = prepared.thinned(&motion.force);
                let slopes = motion.pursuit.iter().flat_map(|own| &own.slopes);
                prepared.slopes = slopes.map(|series| prepared.thinned(series)).collect();
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
        let folds = if prepared.iter().all(|p| p.motion.port == 0) {
            (0..total).map(|at| at * count / total.max(1)).collect()
        } else {
            folds_by_time(&prepared, &pieces, count)
        };
        Self {
            folds,
            records: prepared,
            piece,
            nominal: Vec::new(),
            known: 0.0,
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
                .filter(|own| own.motion.port == port)
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
                let pieces = own.measured.len().div_ceil(self.piece);
                vec![own.motion.port == port; pieces]
            })
            .collect()
    }

    fn weight(&self, record: &Prepared) -> f64 {
        self.weights.get(record.motion.port).copied().unwrap_or(1.0)
    }

    /// The same where the base's numbers are known from `model`, to the deviations that its parameters state; `known` is the residual
    /// that weighs as much as one deviation.
    #[must_use]
    pub fn knowing(mut self, model: &Model, known: f64) -> Self {
        let base = model.terms().first();
        self.nominal = base.map_or(Vec::new(), |term| term.values.clone());
        self.known = known;
        self
    }

    /// Every compared moment under a model, in time.
    #[must_use]
    pub fn compared(&self, model: &Model) -> Vec<Compared> {
        let mut all = Vec::new();
        for record in &self.records {
            let forces = record.model_force(model);
            let lightness = record.lightness(model) * self.weight(record);
            for (at, (measured, force)) in record.measured.iter().zip(forces).enumerate() {
                all.push(Compared {
                    sample: record.sample(record.edge + record.kept[at] * record.stride, 0.0),
                    measured: lightness * measured,
                    model: lightness * force,
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
    /// A series after the low-pass, at the moments that are compared.
    fn thinned(&self, series: &[f64]) -> Vec<f64> {
        let known;
        let mut series = series;
        if self.motion.tells.contains(&false) {
            // The filter would spread what friction takes at rest, which nobody knows, over the moments beside.
            let pairs = series.iter().zip(&self.motion.tells);
            known = pairs
                .map(|(value, tells)| if *tells { *value } else { 0.0 })
                .collect::<Vec<f64>>();
            series = &known;
        }
        let filtered = self.filter.as_ref().map(|filter| filter.apply(series));
        let series = filtered.as_deref().unwrap_or(series);
        let at = |kept: &usize| series[self.edge + kept * self.stride];
        self.kept.iter().map(at).collect()
    }

    /// The moments to compare: not at the edges, every so many samples, and where the force that an FMU lacks is known.
    fn moving(&self) -> Vec<usize> {
        let count = self.motion.len().saturating_sub(2 * self.edge);
        let tells = |kept: &usize| self.motion.tells[self.edge + kept * self.stride];
        (0..count.div_ceil(self.stride)).filter(tells).collect()
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
            if part == 0.0 {
                return series[low];
            }
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
            voltage: motion.voltage[at],
            connected: motion.connected[at],
            driving: motion.driving[at],
            port: motion.port,
            ..self.of_pursuit(at)
        }
    }

    /// What a moment has of an FMU's.
    fn of_pursuit(&self, at: usize) -> Sample {
        let mut sample = Sample::default();
        let Some(pursuit) = &self.motion.pursuit else {
            return sample;
        };
        let all = pursuit.slopes.iter().zip(&pursuit.at);
        let places = sample.slopes.iter_mut().zip(&mut sample.drifts);
        for ((slope, drift), (series, value)) in places.zip(all) {
            *slope = series[at];
            *drift = series[at] * value;
        }
        for (offset, series) in sample.offsets.iter_mut().zip(&pursuit.offsets) {
            *offset = series[at];
        }
        sample.nominal = pursuit.nominal[at];
        sample
    }

    /// The port's inertia of the FMU over that of a model. Noise is that of the motion, which the inertia makes a
    /// force: without it the lightest plant would be the best, since it leaves no force at all.
    fn lightness(&self, model: &Model) -> f64 {
        let (Some(pursuit), Some(base)) = (&self.motion.pursuit, model.terms().first()) else {
            return 1.0;
        };
        let moved = base
            .values
            .iter()
            .zip(&pursuit.at)
            .zip(&pursuit.inertia_slopes);
        let more: f64 = moved.map(|((value, at), slope)| (value - at) * slope).sum();
        let accelerated = Sample {
            acceleration: 1.0,
            port: self.motion.port,
            ..Sample::default()
        };
        let still = Sample {
            port: self.motion.port,
            ..Sample::default()
        };
        let added = model.force(&accelerated) - model.force(&still);
        let inertia = pursuit.inertia + more + added;
        if inertia > 0.0 {
            pursuit.inertia / inertia
        } else {
            f64::NAN
        }
    }

    fn model_force(&self, model: &Model) -> Vec<f64> {
        let inertia = if model.kind.runs_alone() { 1.0 } else { 0.0 };
        // What is read now was there `delay` ago: the motion that goes with this force is read later.
        let port = self.motion.port;
        let later: Vec<f64> = match &self.motion.pursuit {
            Some(pursuit) => {
                let delays = pursuit.at_delays.iter().enumerate();
                delays
                    .map(|(at, found_at)| model.delay(at) - found_at)
                    .collect()
            }
            None => vec![model.delay(port)],
        };
        let shift = later
            .get(port)
            .map_or(0.0, |own| own / self.motion.interval);
        let delayed = |at: usize| -> f64 {
            let Some(pursuit) = &self.motion.pursuit else {
                return 0.0;
            };
            let all = later.iter().zip(&pursuit.delayed);
            all.map(|(delay, series)| delay * series[at]).sum()
        };
        let encoder = model.eccentricity();
        let is_elsewhere = shift != 0.0 || encoder.is_some();
        let mut moved = Vec::with_capacity(AT_ONCE);
        let mut force = Vec::with_capacity(self.read.len());
        for (block, read) in self.read.chunks(AT_ONCE).enumerate() {
            let first = block * AT_ONCE;
            let mut samples = read;
            if is_elsewhere {
                moved.clear();
                moved.extend(read.iter().enumerate().map(|(at, sample)| {
                    let shifted = match shift {
                        0.0 => *sample,
                        _ => self.sample(first + at, shift),
                    };
                    match &encoder {
                        Some(encoder) => encoder.motion(&shifted),
                        None => shifted,
                    }
                }));
                samples = &moved;
            }
            model.add_forces(samples, &mut force);
            for (at, (force, sample)) in force[first..].iter_mut().zip(samples).enumerate() {
                *force = *force + inertia * sample.acceleration + delayed(first + at);
            }
        }
        self.thinned(&force)
    }
}

/// Folds of pieces that were measured at the same time at several ports: left out together.
fn folds_by_time(prepared: &[Prepared], pieces: &[usize], count: usize) -> Vec<usize> {
    let ports = prepared.iter().map(|own| own.motion.port + 1).max();
    let seconds = || prepared.iter().map(|own| own.motion.seconds());
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
        if Some(own.motion.port + 1) == ports {
            begin += seconds;
        }
    }
    folds
}

impl Problem for Balance {
    fn residuals(&self, model: &Model) -> Vec<Vec<f64>> {
        let mut pieces = Vec::with_capacity(self.folds.len());
        for record in &self.records {
            let forces = record.model_force(model);
            let lightness = record.lightness(model) * self.weight(record);
            for (measured, forces) in record
                .measured
                .chunks(self.piece)
                .zip(forces.chunks(self.piece))
            {
                let residual = |(y, f): (&f64, &f64)| (y - f) * lightness;
                pieces.push(measured.iter().zip(forces).map(residual).collect());
            }
        }
        pieces
    }

    fn slopes(
        &self,
        model: &Model,
        residuals: &[Vec<f64>],
        (term, number): (usize, usize),
    ) -> Option<Vec<Vec<f64>>> {
        // An FMU's parameters: how the force that it lacks changes with them is in the pursuits.
        if model.kind != Kind::Fmu || term != 0 {
            return None;
        }
        let mut residuals = residuals.iter();
        let mut all = Vec::with_capacity(residuals.len());
        for record in &self.records {
            let pursuit = record.motion.pursuit.as_ref()?;
            let slopes = record.slopes.get(number)?;
            let lightness = record.lightness(model);
            let heavier = pursuit.inertia_slopes.get(number)? * lightness / pursuit.inertia;
            let weight = lightness * self.weight(record);
            for slopes in slopes.chunks(self.piece) {
                let pairs = slopes.iter().zip(residuals.next()?);
                all.push(
                    pairs
                        .map(|(slope, residual)| -slope * weight - residual * heavier)
                        .collect(),
                );
            }
        }
        // The prior's errors come last, one for each parameter that was known before.
        let parameters = model.terms().first()?.entry.parameters.iter();
        let known = parameters.zip(&self.nominal).enumerate();
        let errors = known.filter_map(|(at, (parameter, _))| match parameter.dimension {
            Dimension::Own { size, .. } if at == number => Some(self.known / size),
            Dimension::Own { .. } => Some(0.0),
            _ => None,
        });
        all.push(errors.collect());
        Some(all)
    }

    fn prior(&self, model: &Model) -> Vec<f64> {
        let base = model.terms().first();
        let numbers = base.map(|term| term.entry.parameters.iter().zip(&term.values));
        numbers
            .into_iter()
            .flatten()
            .zip(&self.nominal)
            .filter_map(|((parameter, value), nominal)| match parameter.dimension {
                Dimension::Own { size, .. } => Some(self.known * (value - nominal) / size),
                _ => None,
            })
            .collect()
    }

    fn folds(&self) -> &[usize] {
        &self.folds
    }
}
