//! Before and after: each model on the way, on the records learned from and on the held-out one.
//!
//! Drive and contact: measured force less the model's. Pendulum: one free run, never corrected, from the start of the
//! records learned from; where the held-out record goes on there, the run goes on through it, so that every error of phase
//! and decay adds up.

use super::case::SmallCase;
use super::finding::{ErrorSize, Step};
use inference::body::balance::Balance;
use inference::body::least_squares::{AT_REST, Fit, Interval, Linearised, fit, intervals};
use inference::body::model::Model;
use inference::body::motion::Motion;
use inference::body::naming::{fit_base, fit_with};
use inference::body::problem::Problem;
use inference::body::swing::Swing;
use inference::body::term::Entry;
use stickslip::body::Kind;

/// Periods of the shortest stretches that a pendulum's free run is fitted to.
const SHORT: f64 = 8.0;
/// Steps of a fit to longer stretches.
const POLISH: usize = 12;
/// Periods at the start of a held-out record from which a pendulum's start is taken, where it is another swing.
const START: f64 = 2.0;

/// What was measured and what a model says, over time.
#[derive(Debug, Clone, Default)]
pub struct Course {
    /// Time [s].
    pub time: Vec<f64>,
    /// Measured force or angle.
    pub measured: Vec<f64>,
    /// The model's.
    pub model: Vec<f64>,
}

/// What effects are compared on: the balance of forces on the records learned from; a pendulum's is that of a free swing.
#[must_use]
pub fn balance(case: &SmallCase) -> Balance {
    Balance::new(&case.records, &case.model.measurement, &case.scales)
        .knowing(&case.known)
        .weighing(&case.weights)
}

/// Free runs through all that was learned from.
fn whole(case: &SmallCase) -> Swing {
    Swing::whole(&case.records, &case.model.measurement, &case.scales).knowing(&case.known)
}

/// A model's numbers brought to their best on all that was learned from: a pendulum's on ever longer stretches up to one
/// free run.
#[must_use]
pub fn polished(case: &SmallCase, fitted: &Fit) -> Fit {
    if !case.kind().runs_alone() {
        let model = &fitted.model;
        return fit(&balance(case), model, &case.scales, (POLISH, AT_REST));
    }
    let mut best = fitted.clone();
    let longest = case.records.iter().map(Motion::seconds).fold(0.0, f64::max);
    let mut length = SHORT * case.scales.period;
    loop {
        let swing = if length < longest {
            Swing::cut(&case.records, &case.model.measurement, &case.scales, length)
                .knowing(&case.known)
        } else {
            whole(case)
        };
        best = fit(&swing, &best.model, &case.scales, (POLISH, AT_REST));
        if length >= longest {
            return best;
        }
        length *= 2.0;
    }
}

/// Intervals of all numbers of the final model.
#[must_use]
pub fn final_intervals(case: &SmallCase, fitted: &Fit) -> Vec<Interval> {
    let problem: Box<dyn Problem> = match case.kind() {
        Kind::Pendulum | Kind::Joint => Box::new(whole(case)),
        Kind::Drive | Kind::Contact | Kind::Balance | Kind::Fmu => Box::new(balance(case)),
    };
    let end = Linearised::new(problem.as_ref(), &fitted.model, &case.scales);
    intervals(problem.as_ref(), &end)
}

/// The models on the way: the analyst's with its numbers refitted, then with one effect more each.
#[must_use]
pub fn models_on_the_way(
    case: &SmallCase,
    effects: &[&'static Entry],
    progress: &mut dyn FnMut(&str),
) -> Vec<Model> {
    let problem = balance(case);
    progress("nominal parameters");
    let mut current = fit_base(&problem, &case.model.model, &case.scales);
    let mut models = vec![polished(case, &current).model];
    for &effect in effects {
        progress(effect.name);
        current = fit_with(&problem, &current.model, effect, &case.scales);
        models.push(polished(case, &current).model);
    }
    models
}

/// Errors of a model on the way.
#[must_use]
pub fn step(case: &SmallCase, effect: Option<&str>, model: &Model) -> Step {
    Step {
        effect: effect.map(str::to_owned),
        learned: error(&learned_course(case, model)),
        held_out: error(&held_out_course(case, model)),
    }
}

fn learned_course(case: &SmallCase, model: &Model) -> Course {
    match case.kind() {
        Kind::Pendulum | Kind::Joint => {
            let swing = Swing::whole(&case.records, &case.model.measurement, &case.scales);
            let residuals: Vec<f64> = swing.residuals(model).concat();
            let measured = swing.readings();
            Course {
                time: (0..residuals.len()).map(|at| at as f64).collect(),
                model: measured
                    .iter()
                    .zip(&residuals)
                    .map(|(y, r)| y - r)
                    .collect(),
                measured,
            }
        }
        Kind::Drive | Kind::Contact | Kind::Balance | Kind::Fmu => {
            balance_course(&balance(case), model)
        }
    }
}

/// The held-out record and the model's course through it.
#[must_use]
pub fn held_out_course(case: &SmallCase, model: &Model) -> Course {
    let held_out = std::slice::from_ref(&case.held_out);
    let measurement = &case.model.measurement;
    if !case.kind().runs_alone() {
        let all = [held_out, &case.held_out_further].concat();
        let balance = Balance::new(&all, measurement, &case.scales).weighing(&case.weights);
        return balance_course(&balance, model);
    }
    let (swing, begin, skipped, known) = match case.records.last() {
        Some(last) if case.goes_on => {
            let known =
                Swing::whole(std::slice::from_ref(last), measurement, &case.scales).first_length();
            // Thinned out together, so that every reading has its time in the run.
            let joined = Swing::whole(
                &[last.followed_by(&case.held_out)],
                measurement,
                &case.scales,
            );
            (joined, last.begin, known, known)
        }
        _ => {
            let alone = Swing::whole(held_out, measurement, &case.scales);
            // A joint's friction forgets the start, which is the measured one.
            let known = match case.kind() {
                Kind::Joint => 0,
                _ => (START * case.scales.period / alone.time_step()) as usize,
            };
            (alone, case.held_out.begin, 0, known)
        }
    };
    let readings = swing.readings();
    let run = swing.run(model, known, readings.len());
    Course {
        time: (skipped..readings.len())
            .map(|at| begin + at as f64 * swing.time_step())
            .collect(),
        measured: readings[skipped..].to_vec(),
        model: run[skipped..].to_vec(),
    }
}

fn balance_course(balance: &Balance, model: &Model) -> Course {
    let compared = balance.compared(model);
    Course {
        time: compared.iter().map(|c| c.sample.time).collect(),
        measured: compared.iter().map(|c| c.measured).collect(),
        model: compared.iter().map(|c| c.model).collect(),
    }
}

fn error(course: &Course) -> ErrorSize {
    let count = course.measured.len().max(1) as f64;
    let square: f64 = course
        .measured
        .iter()
        .zip(&course.model)
        .map(|(y, m)| (y - m).powi(2))
        .sum();
    let pairs = course.measured.iter().zip(&course.model);
    let magnitude: f64 = pairs.map(|(y, m)| (y - m).abs()).sum();
    let size: f64 = course.measured.iter().map(|y| y * y).sum();
    ErrorSize {
        rmse: (square / count).sqrt(),
        relative: (square / size).sqrt(),
        mean: magnitude / count,
    }
}
