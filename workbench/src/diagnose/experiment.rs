//! An experiment that would tell effects apart which the records cannot.
//!
//! Among a few inputs that the rig can be given, the one is proposed on which the amended model and its nearest rival, each
//! refitted to what the other predicts, stay furthest apart.

use stickslip::plant::Rig;

use super::data::{Data, grams, reduced};
use super::fit::Fit;
use super::hypothesis::Hypothesis;
use super::losses::normal_equations;
use super::marginal::Disturbance;
use super::restart::{best_starts, course};
use super::robust::Robust;
use super::run::Run;
use super::sensors::Sensors;
use super::window::{Begin, Cut};
use crate::component::{ComponentError, Native};
use crate::files::record::{Record, RecordError};

/// Length of the experiments [s] and the step of their inputs [s].
const LENGTH: f64 = 40.0;
const STEP: f64 = 0.01;
/// Advantage in ln likelihood from which on one of two names counts as the right one.
const DECISIVE: f64 = 4.0;

/// Inputs that can be proposed.
pub struct Inputs {
    /// What is done, in words.
    pub description: &'static str,
    /// Speed that the voltage is chosen for [rad/s] and normal force [N] at a time [s].
    shape: fn(f64) -> (f64, f64),
}

/// Values held one after the other for equal times.
fn stairs(values: &[f64], time: f64) -> f64 {
    let step = (time / LENGTH * values.len() as f64) as usize;
    values[step.min(values.len() - 1)]
}

const CANDIDATES: [Inputs; 6] = [
    Inputs {
        description: "Without brake, at speeds from 1 to 9 rad/s forward and backward.",
        shape: |t| {
            (
                stairs(&[1.0, 3.0, 6.0, 9.0, -9.0, -6.0, -3.0, -1.0], t),
                0.0,
            )
        },
    },
    Inputs {
        description: "At 3 rad/s, with normal forces from 0 to 70 N.",
        shape: |t| {
            (
                3.0,
                stairs(&[0.0, 5.0, 10.0, 20.0, 35.0, 50.0, 60.0, 70.0], t),
            )
        },
    },
    Inputs {
        description: "At 9 rad/s, with normal forces from 0 to 70 N.",
        shape: |t| {
            (
                9.0,
                stairs(&[0.0, 5.0, 10.0, 20.0, 35.0, 50.0, 60.0, 70.0], t),
            )
        },
    },
    Inputs {
        description: "Under 30 N, reversing every 4 s between 6 rad/s forward and backward.",
        shape: |t| (if (t / 4.0) as i64 % 2 == 0 { 6.0 } else { -6.0 }, 30.0),
    },
    Inputs {
        description: "Under 20 N, while the speed rises evenly from 0.5 to 12 rad/s.",
        shape: |t| (0.5 + 11.5 * t / LENGTH, 20.0),
    },
    Inputs {
        description: "Speed and normal force both in steps: 2 and 8 rad/s under 10, 30 and 60 N.",
        shape: |t| {
            (
                stairs(&[2.0, 8.0, 2.0, 8.0, 2.0, 8.0], t),
                stairs(&[10.0, 10.0, 30.0, 30.0, 60.0, 60.0], t),
            )
        },
    },
];

/// The best of the candidates.
pub struct Proposal {
    /// Its inputs `u` and `N2` over time.
    pub inputs: Record,
    /// What is done, in words.
    pub description: &'static str,
    /// Probability that it decides, 0 … 1.
    pub power: f64,
}

/// Proposes the experiment that separates `amended` best from its `rivals`; `None` where no rival could be fitted.
///
/// Either of two names may be the right one, so each candidate is judged by what it decides when the amended model is
/// right and when the nearest rival is.
///
/// # Errors
/// The inputs of the best candidate are no record.
pub fn propose(
    amended: &Fit,
    rivals: &[Fit],
    sensors: &Sensors,
) -> Result<Option<Proposal>, ProposalError> {
    let Ok(rig) = amended.hypothesis.rig_at() else {
        return Ok(None);
    };
    let best = CANDIDATES
        .iter()
        .filter_map(|candidate| {
            let distances = rivals
                .iter()
                .map(|rival| both_ways(amended, rival, candidate, sensors))
                .min_by(|a, b| least(a).total_cmp(&least(b)))?;
            least(&distances)
                .is_finite()
                .then_some((distances, candidate))
        })
        .max_by(|(a, _), (b, _)| least(a).total_cmp(&least(b)));
    let Some(([if_amended, if_rival], candidate)) = best else {
        return Ok(None);
    };
    Ok(Some(Proposal {
        inputs: record(&rig, candidate)?,
        description: candidate.description,
        power: 0.5 * (power(if_amended) + power(if_rival)),
    }))
}

fn least(distances: &[f64; 2]) -> f64 {
    distances[0].min(distances[1])
}

/// How far the second of two models, refitted, stays from what the first predicts, and the other way round.
fn both_ways(first: &Fit, second: &Fit, candidate: &Inputs, sensors: &Sensors) -> [f64; 2] {
    [(first, second), (second, first)].map(|(right, wrong)| {
        distance(right, wrong, candidate, sensors).unwrap_or(f64::NEG_INFINITY)
    })
}

/// Squared distance [squared standard deviations of the sensors] that `wrong`, refitted, keeps from the prediction of
/// `right`; `None` where a model cannot run.
fn distance(right: &Fit, wrong: &Fit, candidate: &Inputs, sensors: &Sensors) -> Option<f64> {
    let rig = right.hypothesis.rig_at().ok()?;
    let run = predicted(&rig, candidate).ok()?;
    let data = Data::new(
        std::sync::Arc::new(vec![run]),
        Cut::of(&rig, Begin::Clear),
        sensors.deviations(),
    );
    let left = |fit: &Fit| remaining(&data, &fit.hypothesis, &fit.disturbance);
    let found = left(wrong) - left(right);
    found.is_finite().then_some(found)
}

/// Why no experiment can be proposed.
#[derive(Debug, thiserror::Error)]
pub enum ProposalError {
    /// The model cannot be run.
    #[error(transparent)]
    Component(#[from] ComponentError),
    /// The inputs are no record.
    #[error(transparent)]
    Record(#[from] RecordError),
}

fn record(rig: &Rig<f64>, candidate: &Inputs) -> Result<Record, RecordError> {
    let time: Vec<f64> = (0..=(LENGTH / STEP) as usize)
        .map(|row| row as f64 * STEP)
        .collect();
    let (voltage, force) = time
        .iter()
        .map(|&t| {
            let (speed, force) = (candidate.shape)(t);
            (rig.voltage_for_speed(speed), force)
        })
        .unzip();
    let mut record = Record::new("experiment.csv", time)?;
    record.add_column("u", voltage)?;
    record.add_column("N2", force)?;
    Ok(record)
}

/// What the model predicts under the inputs, without noise.
fn predicted(rig: &Rig<f64>, candidate: &Inputs) -> Result<Run, ProposalError> {
    let inputs = record(rig, candidate)?;
    let column = |name: &str| inputs.require(name).map(<[f64]>::to_vec);
    let mut run = Run {
        name: "prediction".to_owned(),
        time: inputs.time().to_vec(),
        voltage: column("u")?,
        normal_force: column("N2")?,
        readings: Default::default(),
    };
    let mut native = Native::from_text(&rig.to_toml(), "the amended model")?;
    let rest = [0.0; stickslip::plant::STATES];
    run.readings = course(&mut native, &run, 0, run.len() - 1, &rest)?.0;
    Ok(run)
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
    let (curvature, gradient) = normal_equations(
        forms.iter().flatten(),
        &precisions,
        &hypothesis.x,
        Robust::JUDGING,
    );
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
mod tests {
    use super::*;

    use std::path::Path;
    use std::sync::Arc;

    use stickslip::plant::ModelFile;

    use crate::diagnose::decide::fit_base;
    use crate::diagnose::law_fits::refit_with;
    use crate::diagnose::run::CHANNELS;

    fn data(run: Run, rig: &Rig<f64>, sensors: &Sensors) -> Data {
        let cut = Cut::of(rig, Begin::Clear);
        Data::new(Arc::new(vec![run]), cut, sensors.deviations())
    }

    /// Irregular numbers of mean 0 and deviation 1: sums of twelve uniform ones.
    fn noise(state: &mut u64) -> f64 {
        let mut uniform = || {
            *state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (*state >> 11) as f64 / (1_u64 << 53) as f64
        };
        (0..12).map(|_| uniform()).sum::<f64>() - 6.0
    }

    fn noisy(run: &Run, sensors: &Sensors, seed: u64) -> Run {
        let mut run = run.clone();
        let mut state = seed;
        for channel in 0..CHANNELS {
            let deviation = sensors.deviations()[channel];
            for reading in &mut run.readings[channel] {
                *reading += deviation * noise(&mut state);
            }
        }
        run
    }

    /// Sensors so bad that the experiment does not decide with certainty.
    fn bad_sensors() -> Sensors {
        let good = Sensors::default();
        let factor = 40.0;
        Sensors {
            disc_encoder_step: factor * good.disc_encoder_step,
            gear_encoder_step: factor * good.gear_encoder_step,
            disc_velocity_noise: factor * good.disc_velocity_noise,
            gear_velocity_noise: factor * good.gear_velocity_noise,
            load_cell_noise: good.load_cell_noise,
        }
    }

    #[test]
    fn the_proposed_experiment_decides_as_often_as_it_says() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/unbalance/model.toml");
        let believed = std::fs::read_to_string(path).unwrap();
        let truth = format!("{believed}\n[viscous_drag]\ncoefficient = 0.001\n");
        let model = ModelFile::parse(&believed, "believed").unwrap();
        let truth = ModelFile::parse(&truth, "truth").unwrap().rig;
        let sensors = bad_sensors();
        // Learned from one speed without brake: drag and dry friction of the bearings are the same there.
        let steady = Inputs {
            description: "one speed",
            shape: |_| (4.0, 0.0),
        };
        let learned = noisy(&predicted(&truth, &steady).unwrap(), &sensors, 5);
        let learned = data(learned, &model.rig, &sensors);
        let base = fit_base(&learned, Hypothesis::base(&model));
        let [drag, bearing] = ["viscous_drag", "bearing_friction"]
            .map(|name| refit_with(&learned, &base, name).unwrap());
        let apart = (drag.loss - bearing.loss).abs();
        assert!(apart < DECISIVE, "told apart already: {apart}");

        let (first, second) = (
            drag.hypothesis.rig_at().unwrap(),
            bearing.hypothesis.rig_at().unwrap(),
        );
        let proposal = propose(&drag, std::slice::from_ref(&bearing), &sensors)
            .unwrap()
            .unwrap();
        assert!(
            (0.5..0.98).contains(&proposal.power),
            "a power of {} would test nothing",
            proposal.power
        );
        let candidate = CANDIDATES
            .iter()
            .find(|candidate| candidate.description == proposal.description)
            .unwrap();
        let advantage = |run: Run| {
            let data = data(run, &model.rig, &sensors);
            let left = |fit: &Fit| remaining(&data, &fit.hypothesis, &Disturbance::NONE);
            0.5 * (left(&bearing) - left(&drag))
        };
        let repeats = 12;
        let mut decided = 0;
        for (rig, sign) in [(&first, 1.0), (&second, -1.0)] {
            let clean = predicted(rig, candidate).unwrap();
            decided += (0..repeats)
                .filter(|seed| sign * advantage(noisy(&clean, &sensors, 100 + seed)) > DECISIVE)
                .count();
        }
        let share = decided as f64 / (2 * repeats) as f64;
        // Three standard deviations of a share of so few.
        let scatter = (proposal.power * (1.0 - proposal.power) / (2 * repeats) as f64).sqrt();
        assert!(
            (share - proposal.power).abs() < 3.0 * scatter,
            "decided {share}, said {}",
            proposal.power
        );
    }

    #[test]
    fn power_grows_from_nothing_to_certainty() {
        assert_eq!(power(0.0), 0.0);
        assert!((power(8.0) - 0.5).abs() < 1e-6);
        assert!(power(100.0) > 0.9999);
        assert!(power(2.0) < 0.05);
    }

    #[test]
    fn error_function_at_known_points() {
        for (x, value) in [
            (0.0, 1.0),
            (1.0, 0.157_299_207),
            (-1.0, 1.842_700_793),
            (2.0, 0.004_677_735),
        ] {
            assert!((complementary_error(x) - value).abs() < 2e-7, "{x}");
        }
    }

    #[test]
    fn stairs_end_on_the_last_step() {
        assert_eq!(stairs(&[1.0, 2.0], 0.0), 1.0);
        assert_eq!(stairs(&[1.0, 2.0], 20.0), 2.0);
        assert_eq!(stairs(&[1.0, 2.0], 40.0), 2.0);
    }
}
