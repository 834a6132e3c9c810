//! An experiment that would tell effects apart which the records cannot.
//!
//! Among a few inputs that the rig can be given, the one is proposed on which the amended model and its nearest rival, each
//! refitted to what the other predicts, stay furthest apart. Voltages and loads are those of the records: what the bench has
//! done it can do again.

use std::sync::Arc;

use inference::data::{Data, grams, reduced};
use inference::fit::Fit;
use inference::hypothesis::Hypothesis;
use inference::loss::normal_equations;
use inference::marginal::Disturbance;
use inference::problem::Problem;
use inference::record::{Instruments, RawRecord, Run};
use inference::window::{Begin, LENGTH as WINDOW};
use stickslip::parameter::ParameterError;
use stickslip::plant::Rig;

use super::console::number;
use super::restart::{best_starts, course};
use crate::component::{ComponentError, Native};
use crate::files::record::{Record, RecordError};

/// Length of the experiments and step of their inputs, in radians of the shaft's natural oscillation: 30 periods, of 130
/// samples each.
const LENGTH: f64 = 190.0;
const STEP: f64 = 0.048;
/// Advantage in ln likelihood from which on one of two names counts as the right one.
const DECISIVE: f64 = 4.0;

/// Inputs that can be proposed.
struct Inputs {
    /// Shares of the largest voltage and of the largest normal force of the records, at a share of the experiment's time.
    shape: fn(f64) -> (f64, f64),
    /// What is done, in words, with these largest inputs [V], [N].
    description: fn(f64, f64) -> String,
}

/// Values held one after the other for equal times.
fn stairs(values: &[f64], share: f64) -> f64 {
    let step = (share * values.len() as f64) as usize;
    values[step.min(values.len() - 1)]
}

/// Loads of an experiment over loads, in shares of the records' largest.
const LOADS: [f64; 8] = [0.0, 0.1, 0.2, 0.3, 0.5, 0.7, 0.85, 1.0];
/// Reversals of an experiment that reverses.
const REVERSALS: f64 = 10.0;

const CANDIDATES: [Inputs; 6] = [
    Inputs {
        shape: |t| {
            (
                stairs(&[0.15, 0.4, 0.7, 1.0, -1.0, -0.7, -0.4, -0.15], t),
                0.0,
            )
        },
        description: |u, _| {
            format!(
                "Without brake, at voltages from {} to {} V forward and backward.",
                number(0.15 * u),
                number(u)
            )
        },
    },
    Inputs {
        shape: |t| (0.4, stairs(&LOADS, t)),
        description: |u, n| {
            format!(
                "At {} V, with normal forces from 0 to {} N.",
                number(0.4 * u),
                number(n)
            )
        },
    },
    Inputs {
        shape: |t| (1.0, stairs(&LOADS, t)),
        description: |u, n| {
            format!(
                "At {} V, with normal forces from 0 to {} N.",
                number(u),
                number(n)
            )
        },
    },
    Inputs {
        shape: |t| {
            let forward = (t * REVERSALS) as i64 % 2 == 0;
            (if forward { 0.7 } else { -0.7 }, 0.5)
        },
        description: |u, n| {
            format!(
                "Under {} N, reversing ten times between {} V forward and backward.",
                number(0.5 * n),
                number(0.7 * u)
            )
        },
    },
    Inputs {
        shape: |t| (0.05 + 0.95 * t, 0.3),
        description: |u, n| {
            format!(
                "Under {} N, while the voltage rises evenly from {} to {} V.",
                number(0.3 * n),
                number(0.05 * u),
                number(u)
            )
        },
    },
    Inputs {
        shape: |t| {
            (
                stairs(&[0.3, 0.9, 0.3, 0.9, 0.3, 0.9], t),
                stairs(&[0.15, 0.15, 0.5, 0.5, 1.0, 1.0], t),
            )
        },
        description: |u, n| {
            format!(
                "Voltage and normal force both in steps: {} and {} V under {}, {} and {} N.",
                number(0.3 * u),
                number(0.9 * u),
                number(0.15 * n),
                number(0.5 * n),
                number(n)
            )
        },
    },
];

/// The best of the candidates.
pub struct Proposal {
    /// Its inputs `u`, `N2` and, of the full rig, `N1` over time.
    pub inputs: Record,
    /// What is done, in words.
    pub description: String,
    /// Probability that it decides, 0 … 1.
    pub power: f64,
}

/// What a rig can be given: the largest inputs of the records in the plant's units.
#[derive(Clone, Copy)]
struct Reach {
    voltage: f64,
    force: f64,
    force_1: f64,
}

impl Reach {
    fn of(problem: &Problem) -> Self {
        let largest = |of: fn(&Run) -> &[f64]| {
            problem
                .long
                .runs
                .iter()
                .flat_map(of)
                .fold(0.0_f64, |a, b| a.max(b.abs()))
        };
        Self {
            voltage: largest(|run| &run.voltage),
            force: largest(|run| &run.normal_force),
            force_1: largest(|run| &run.normal_force_1),
        }
    }
}

/// Proposes the experiment that separates `amended` best from its `rivals`; `None` where no rival could be fitted.
///
/// Either of two names may be the right one, so each candidate is judged by what it decides when the amended model is
/// right and when the nearest rival is.
///
/// # Errors
/// The inputs of the best candidate are no record.
pub fn propose(
    problem: &Problem,
    amended: &Fit,
    rivals: &[Fit],
) -> Result<Option<Proposal>, ProposalError> {
    let reach = Reach::of(problem);
    let best = CANDIDATES
        .iter()
        .filter_map(|candidate| {
            let distances = rivals
                .iter()
                .map(|rival| both_ways(problem, amended, rival, candidate))
                .min_by(|a, b| least(a).total_cmp(&least(b)))?;
            least(&distances)
                .is_finite()
                .then_some((distances, candidate))
        })
        .max_by(|(a, _), (b, _)| least(a).total_cmp(&least(b)));
    let Some(([if_amended, if_rival], candidate)) = best else {
        return Ok(None);
    };
    let units = &problem.units;
    let raw = inputs(problem, candidate);
    let mut record = Record::new("experiment.csv", raw.time)?;
    record.add_column("u", raw.voltage)?;
    record.add_column("N2", raw.normal_force)?;
    if !raw.normal_force_1.is_empty() {
        record.add_column("N1", raw.normal_force_1)?;
    }
    let mut description =
        (candidate.description)(reach.voltage * units.voltage(), reach.force * units.force);
    if reach.force_1 > 0.0 {
        let largest = number(reach.force_1 * units.force);
        description +=
            &format!(" The normal force on disc D1 takes the same course, up to {largest} N.");
    }
    Ok(Some(Proposal {
        inputs: record,
        description,
        power: 0.5 * (power(if_amended) + power(if_rival)),
    }))
}

fn least(distances: &[f64; 2]) -> f64 {
    distances[0].min(distances[1])
}

/// How far the second of two models, refitted, stays from what the first predicts, and the other way round.
fn both_ways(problem: &Problem, first: &Fit, second: &Fit, candidate: &Inputs) -> [f64; 2] {
    [(first, second), (second, first)].map(|(right, wrong)| {
        distance(problem, right, wrong, candidate).unwrap_or(f64::NEG_INFINITY)
    })
}

/// Squared distance [squared standard deviations of the sensors] that `wrong`, refitted, keeps from the prediction of
/// `right`; `None` where a model cannot run.
fn distance(problem: &Problem, right: &Fit, wrong: &Fit, candidate: &Inputs) -> Option<f64> {
    let rig = right.hypothesis.rig_at().ok()?;
    let predicted = predicted(problem, &rig, candidate).ok()?;
    let data = cut(problem, &predicted);
    let left = |fit: &Fit| remaining(&data, &fit.hypothesis, &fit.disturbance);
    let found = left(wrong) - left(right);
    found.is_finite().then_some(found)
}

/// A prediction, or readings without steps, cut into windows.
fn cut(problem: &Problem, record: &RawRecord) -> Data {
    let deviations = problem.instruments.deviations();
    // No reading was rounded down: what an encoder hides counts as noise.
    let smooth = Instruments {
        step: [0.0; inference::record::CHANNELS],
        noise: deviations,
    };
    let run = Run::new(record, &problem.units, &problem.rig, &smooth);
    Data::new(
        Arc::new(vec![run]),
        &problem.rig,
        problem.long.scales,
        deviations,
        WINDOW,
        Begin::Clear,
    )
}

/// Why no experiment can be proposed.
#[derive(Debug, thiserror::Error)]
pub enum ProposalError {
    /// The model cannot be run.
    #[error(transparent)]
    Component(#[from] ComponentError),
    /// A number of the model leaves its range in SI units.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// The inputs are no record.
    #[error(transparent)]
    Record(#[from] RecordError),
}

/// The inputs of a candidate, SI units.
fn inputs(problem: &Problem, candidate: &Inputs) -> RawRecord {
    let (reach, units) = (Reach::of(problem), &problem.units);
    let count = (LENGTH / STEP) as usize;
    let (mut voltage, mut normal_force, mut normal_force_1) = (Vec::new(), Vec::new(), Vec::new());
    for row in 0..=count {
        let (u, n) = (candidate.shape)(row as f64 / count as f64);
        voltage.push(u * reach.voltage * units.voltage());
        normal_force.push(n * reach.force * units.force);
        if problem.rig.disc1.is_some() {
            normal_force_1.push(n * reach.force_1 * units.force);
        }
    }
    RawRecord {
        name: "prediction".to_owned(),
        time: (0..=count)
            .map(|row| row as f64 * STEP * units.time)
            .collect(),
        voltage,
        normal_force,
        normal_force_1,
        ..RawRecord::default()
    }
}

/// What a model in the plant's units predicts under the inputs, without noise, for the channels that are measured.
fn predicted(
    problem: &Problem,
    rig: &Rig<f64>,
    candidate: &Inputs,
) -> Result<RawRecord, ProposalError> {
    let mut record = inputs(problem, candidate);
    let rig = problem.units.to_si(rig)?;
    let mut native = Native::from_text(&rig.to_toml(), "the amended model")?;
    let rest = [0.0; stickslip::plant::STATES];
    let last = record.time.len() - 1;
    let (readings, _) = course(&mut native, &record, 0, last, &rest)?;
    for (c, (own, predicted)) in record.readings.iter_mut().zip(readings).enumerate() {
        if problem.long.runs.iter().all(|run| run.has(c)) {
            *own = predicted;
        }
    }
    Ok(record)
}

/// Sum of squares that a hypothesis leaves after its free numbers and the windows' starts are refitted to first order.
fn remaining(data: &Data, hypothesis: &Hypothesis, disturbance: &Disturbance) -> f64 {
    let Ok(rig) = hypothesis.rig_at() else {
        return f64::INFINITY;
    };
    let starts = best_starts(data, &rig).states;
    let forms = reduced(
        data,
        &starts,
        &grams(data, hypothesis, &starts),
        disturbance,
    );
    let precisions = hypothesis.prior_precisions();
    let (curvature, gradient) =
        normal_equations(forms.iter().flatten(), &precisions, &hypothesis.x);
    let Some(step) = curvature.clone().cholesky().map(|c| c.solve(&gradient)) else {
        return f64::INFINITY;
    };
    let square: f64 = forms.iter().flatten().map(|form| form.square).sum();
    square - gradient.dot(&step)
}

/// Probability that an advantage with the expectation `distance`/2 and the variance `distance` is decisive.
fn power(distance: f64) -> f64 {
    if distance <= 0.0 {
        return 0.0;
    }
    let z = (0.5 * distance - DECISIVE) / distance.sqrt();
    0.5 * complementary_error(-z / std::f64::consts::SQRT_2)
}

/// Complementary error function to 1.2e-7 (Numerical Recipes, Chebyshev fit in Section 6.2).
fn complementary_error(x: f64) -> f64 {
    const COEFFICIENTS: [f64; 10] = [
        -1.265_512_23,
        1.000_023_68,
        0.374_091_96,
        0.096_784_18,
        -0.186_288_06,
        0.278_868_07,
        -1.135_203_98,
        1.488_515_87,
        -0.822_152_23,
        0.170_872_77,
    ];
    let t = 1.0 / (1.0 + 0.5 * x.abs());
    let polynomial = COEFFICIENTS.iter().rev().fold(0.0, |sum, c| sum * t + c);
    let value = t * (-x * x + polynomial).exp();
    if x >= 0.0 { value } else { 2.0 - value }
}

#[cfg(test)]
mod tests;
