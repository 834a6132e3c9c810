//! Where a model leaves structure: a free function of each coordinate and of each two of them, judged on what it was not fitted to.

use std::f64::consts::TAU;

use super::balance::{Balance, Compared, MOST_FOLDS};
use super::evidence::{Errors, Gain};
use super::known::misfit;
use super::model::Model;
use super::motion::Scales;
use super::problem::Problem;
use stickslip::body::Path;

/// Values of the free function over a coordinate, at quantiles.
const BINS: usize = 16;
/// The same over each of two coordinates: as many values in all as over a turn.
const BINS_OF_TWO: usize = 8;
/// The same over the angle within a turn, where teeth, poles and rollers repeat many times.
const BINS_OF_A_TURN: usize = 64;

/// A coordinate over which residuals can be structured.
pub struct Coordinate {
    /// Its name.
    pub name: &'static str,
    /// Its label on an axis, without unit.
    pub label: &'static str,
    /// Its value at a moment.
    pub of: fn(&Compared, &Scales) -> f64,
    /// Values of the free function over it.
    bins: usize,
}

impl Coordinate {
    /// Whether a motion along such a path has it.
    #[must_use]
    pub fn is_along(&self, path: Path) -> bool {
        self.bins == BINS || path == Path::Turn
    }
}

/// The coordinates that are looked at.
pub const COORDINATES: &[Coordinate] = &[
    Coordinate {
        name: "velocity",
        label: "velocity",
        of: |c, _| c.sample.velocity,
        bins: BINS,
    },
    Coordinate {
        name: "acceleration",
        label: "acceleration",
        of: |c, _| c.sample.acceleration,
        bins: BINS,
    },
    Coordinate {
        name: "phase_angle",
        label: "angle of the plane of velocity and acceleration",
        of: phase_angle,
        bins: BINS,
    },
    Coordinate {
        name: "position",
        label: "position",
        of: |c, _| c.sample.position,
        bins: BINS,
    },
    Coordinate {
        name: "position_by_direction",
        label: "position times direction of motion",
        of: |c, _| c.sample.position * c.sample.direction,
        bins: BINS,
    },
    Coordinate {
        name: "angle_within_a_turn",
        label: "angle within a turn",
        of: |c, _| c.sample.position.rem_euclid(TAU),
        bins: BINS_OF_A_TURN,
    },
    Coordinate {
        name: "time",
        label: "time",
        of: |c, _| c.sample.time,
        bins: BINS,
    },
    Coordinate {
        name: "time_by_direction",
        label: "time times direction of motion",
        of: |c, _| c.sample.time * c.sample.direction,
        bins: BINS,
    },
    Coordinate {
        name: "load",
        label: "load",
        of: |c, _| c.sample.load,
        bins: BINS,
    },
    Coordinate {
        name: "load_by_direction",
        label: "load times direction of motion",
        of: |c, _| c.sample.load * c.sample.direction,
        bins: BINS,
    },
    Coordinate {
        name: "driving_input",
        label: "driving force or input",
        of: |c, _| c.sample.driving,
        bins: BINS,
    },
    Coordinate {
        name: "predicted_force",
        label: "predicted force",
        of: |c, _| c.sample.predicted,
        bins: BINS,
    },
    Coordinate {
        name: "predicted_force_by_direction",
        label: "predicted force times direction of motion",
        of: |c, _| c.sample.predicted * c.sample.direction,
        bins: BINS,
    },
];

/// Coordinates that stand in pairs, where two explain surely more than either alone; the others are made of these. Acceleration does not:
/// its noise is most of that of the force, and beside another coordinate it would be seen.
const PAIRED: &[&str] = &[
    "velocity",
    "position",
    "time",
    "load",
    "driving_input",
    "predicted_force",
];

/// Angle of the plane of velocity and acceleration, each over its usual size; zero where the speed is highest.
fn phase_angle(compared: &Compared, scales: &Scales) -> f64 {
    let direction = compared.sample.direction;
    stickslip::friction::acceleration_angle(
        direction * compared.sample.velocity,
        direction * compared.sample.acceleration,
        scales.speed,
        scales.acceleration,
    )
}

/// Structure that is left, with the share of the residuals' square that it explains.
#[derive(Debug, Clone)]
pub struct Left {
    /// The coordinate, or two of them with "and" between.
    pub coordinate: String,
    /// Whether it is two: position and velocity together are the plant's state, of which a free function can say all.
    pub is_of_two: bool,
    /// What a free function of it gains.
    pub gain: Gain,
    /// Share of the residuals' square, on what the function was not fitted to.
    pub share: f64,
    /// Which of an FMU's ports it is at.
    pub port: usize,
    /// Errors beside the function, on what it was not fitted to.
    pub errors: Errors,
}

/// Structure of what a model leaves over every coordinate, at each of an FMU's ports for itself where it has several, strongest first.
#[must_use]
pub fn structures(balance: &Balance, model: &Model, scales: &Scales, ports: usize) -> Vec<Left> {
    if ports < 2 {
        return at_one(balance, model, scales);
    }
    let mut all = Vec::new();
    for port in 0..ports {
        let there = at_one(&balance.at_port(port), model, scales);
        all.extend(there.into_iter().map(|left| Left { port, ..left }));
    }
    all.sort_by(|a, b| b.gain.value.total_cmp(&a.gain.value));
    all
}

fn at_one(balance: &Balance, model: &Model, scales: &Scales) -> Vec<Left> {
    let compared = balance.compared(model);
    let residuals = balance.residuals(model);
    let lengths = balance.piece_lengths();
    let fold_of: Vec<(usize, usize)> = lengths
        .iter()
        .enumerate()
        // Pieces that follow each other are in different folds: a function of time is not learned from other times.
        .flat_map(|(piece, &length)| vec![(piece, piece % MOST_FOLDS); length])
        .collect();
    let known = misfit(balance.known(), model);
    let before = Errors::of(&residuals, known);
    let total: f64 = before.pieces.iter().sum();
    let left = |coordinate: String, is_of_two: bool, bins: &[usize]| {
        let errors = Errors::of(&left_out(&compared, bins, &fold_of, &lengths), known);
        Left {
            coordinate,
            is_of_two,
            gain: errors.gain_over(&before),
            share: 1.0 - errors.pieces.iter().sum::<f64>() / total,
            port: 0,
            errors,
        }
    };
    let known_here = COORDINATES.iter().filter(|own| own.is_along(model.path));
    let over: Vec<(&Coordinate, Vec<f64>, Left)> = known_here
        .filter_map(|own| {
            let values: Vec<f64> = compared.iter().map(|c| (own.of)(c, scales)).collect();
            let found = left(own.name.to_owned(), false, &bins(&values, own.bins)?);
            Some((own, values, found))
        })
        .collect();
    let mut all: Vec<Left> = over.iter().map(|(.., found)| found.clone()).collect();
    for (at, (first, of_first, alone)) in over.iter().enumerate() {
        for (second, of_second, also_alone) in &over[at + 1..] {
            if PAIRED.contains(&first.name) && PAIRED.contains(&second.name) {
                let name = format!("{} and {}", first.name, second.name);
                let found = left(name, true, &bins_of_two(of_first, of_second));
                let more = |than: &Left| found.errors.gain_over(&than.errors).is_sure();
                if more(alone) && more(also_alone) {
                    all.push(found);
                }
            }
        }
    }
    all.sort_by(|a, b| b.gain.value.total_cmp(&a.gain.value));
    all
}

/// Bin of each value, bins between quantiles; none where the coordinate does not change.
fn bins(values: &[f64], count: usize) -> Option<Vec<usize>> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    if sorted.first() == sorted.last() {
        return None;
    }
    let limits: Vec<f64> = (1..count)
        .map(|j| sorted[j * sorted.len() / count])
        .collect();
    Some(
        values
            .iter()
            .map(|value| limits.partition_point(|limit| limit <= value))
            .collect(),
    )
}

/// Bin of each pair of values: bins between quantiles of the first, and in each of them between quantiles of the second.
fn bins_of_two(first: &[f64], second: &[f64]) -> Vec<usize> {
    let one = |values: &[f64]| bins(values, BINS_OF_TWO).unwrap_or_else(|| vec![0; values.len()]);
    let mut all = one(first);
    for outer in 0..BINS_OF_TWO {
        let (places, values): (Vec<usize>, Vec<f64>) = all
            .iter()
            .zip(second)
            .enumerate()
            .filter(|(_, (bin, _))| **bin == outer)
            .map(|(at, (_, value))| (at, *value))
            .unzip();
        for (place, inner) in places.into_iter().zip(one(&values)) {
            all[place] = outer + BINS_OF_TWO * inner;
        }
    }
    all
}

/// Residuals piece by piece after subtracting the means of the bins over the other folds.
fn left_out(
    compared: &[Compared],
    bins: &[usize],
    fold_of: &[(usize, usize)],
    lengths: &[usize],
) -> Vec<Vec<f64>> {
    let folds = fold_of.iter().map(|(_, fold)| fold + 1).max().unwrap_or(0);
    let count = bins.iter().max().map_or(0, |last| last + 1);
    let mut sums = vec![vec![(0.0, 0_usize); count]; folds];
    for ((moment, &bin), &(_, fold)) in compared.iter().zip(bins).zip(fold_of) {
        sums[fold][bin].0 += moment.measured - moment.model;
        sums[fold][bin].1 += 1;
    }
    let mean = |without: usize, bin: usize| {
        let (mut sum, mut count) = (0.0, 0);
        for (fold, bins) in sums.iter().enumerate() {
            if fold != without {
                sum += bins[bin].0;
                count += bins[bin].1;
            }
        }
        if count == 0 { 0.0 } else { sum / count as f64 }
    };
    let means: Vec<Vec<f64>> = (0..folds)
        .map(|fold| (0..count).map(|bin| mean(fold, bin)).collect())
        .collect();
    let mut residuals: Vec<Vec<f64>> = lengths.iter().map(|own| Vec::with_capacity(*own)).collect();
    for ((moment, &bin), &(piece, fold)) in compared.iter().zip(bins).zip(fold_of) {
        residuals[piece].push(moment.measured - moment.model - means[fold][bin]);
    }
    residuals
}
