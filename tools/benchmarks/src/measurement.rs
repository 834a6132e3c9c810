//! Work and precision: runs, their errors, and the time a solver needs for a given error.

use serde::Serialize;

/// One timed run over the whole time span.
#[derive(Clone, Debug, Serialize)]
pub struct Run {
    /// Key of the system.
    pub system: String,
    /// Who ran it: `CVODE`, `LSODA`, …
    pub solver: String,
    /// Method and set-up within the solver; a sweep over tolerances shares one.
    pub configuration: String,
    /// Relative (and absolute) tolerance asked for.
    pub tolerance: f64,
    /// Smallest processor time of the repetitions [s].
    pub seconds: f64,
    /// θ2 at the end [rad].
    pub theta: f64,
    /// |θ2 − reference| at the end [rad]; set once the reference is known.
    pub error: f64,
    /// Mode changes seen.
    pub switches: u64,
    /// Steps taken (0: the solver does not tell).
    pub steps: u64,
    /// Processor times that are not in `seconds`.
    #[serde(flatten)]
    pub apart: Apart,
}

/// Processor times of a run that are stated but not counted [s].
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Apart {
    /// The loop around the integration, in a slower language than the solver's.
    pub driver: f64,
    /// Compiling the equations, once before all repetitions.
    pub compiling: f64,
}

/// Smallest error a double can show in an angle of some 300 rad.
const SMALLEST_ERROR: f64 = 1e-13;

/// Work against precision of one configuration, without lucky hits: each error is raised to the
/// largest that a tighter tolerance of the same sweep still made. Sorted by error, smallest first.
fn honest_curve(runs: &[&Run]) -> Vec<(f64, f64)> {
    let mut sorted = runs.to_vec();
    sorted.sort_by(|a, b| a.tolerance.total_cmp(&b.tolerance));
    let mut worst = SMALLEST_ERROR;
    let mut curve: Vec<(f64, f64)> = Vec::with_capacity(sorted.len());
    for run in sorted {
        worst = worst.max(run.error);
        match curve.last_mut() {
            Some(last) if last.0 >= worst => last.1 = last.1.min(run.seconds),
            _ => curve.push((worst, run.seconds)),
        }
    }
    curve
}

/// Time [s] on a curve at the error `target`, interpolated in both logarithms; `None` where the curve
/// does not reach that precision. Beyond its loosest point the loosest time stands.
fn time_on_curve(curve: &[(f64, f64)], target: f64) -> Option<f64> {
    let first_above = curve.partition_point(|point| point.0 <= target);
    let below = curve.get(first_above.checked_sub(1)?)?;
    let Some(above) = curve.get(first_above) else {
        return Some(below.1);
    };
    let share = (target / below.0).ln() / (above.0 / below.0).ln();
    Some((below.1.ln() + share * (above.1 / below.1).ln()).exp())
}

/// The names, each once, in order of appearance.
pub fn distinct<'a>(all: impl Iterator<Item = &'a String>) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for name in all {
        if !names.contains(name) {
            names.push(name.clone());
        }
    }
    names
}

/// Time [s] that the fastest configuration among `runs` needs for an error of `target`, and its name.
#[must_use]
pub fn time_at_error(runs: &[&Run], target: f64) -> Option<(f64, String)> {
    distinct(runs.iter().map(|run| &run.configuration))
        .into_iter()
        .filter_map(|name| {
            let sweep: Vec<&Run> = runs
                .iter()
                .copied()
                .filter(|r| r.configuration == name)
                .collect();
            time_on_curve(&honest_curve(&sweep), target).map(|time| (time, name))
        })
        .min_by(|a, b| a.0.total_cmp(&b.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(tolerance: f64, error: f64, seconds: f64) -> Run {
        Run {
            system: "a".into(),
            solver: "s".into(),
            configuration: "x".into(),
            tolerance,
            seconds,
            theta: 0.0,
            error,
            switches: 0,
            steps: 0,
            apart: Apart::default(),
        }
    }

    #[test]
    fn time_is_interpolated_between_decades() {
        let runs = [run(1e-4, 1e-2, 1.0), run(1e-8, 1e-6, 100.0)];
        let list: Vec<&Run> = runs.iter().collect();
        let (time, _) = time_at_error(&list, 1e-4).expect("within the curve");
        assert!((time - 10.0).abs() < 1e-9, "{time}");
        assert!(time_at_error(&list, 1e-7).is_none());
    }

    #[test]
    fn a_lucky_hit_at_a_loose_tolerance_does_not_count() {
        let runs = [
            run(1e-4, 1e-9, 1.0),
            run(1e-6, 1e-4, 5.0),
            run(1e-8, 1e-6, 100.0),
        ];
        let list: Vec<&Run> = runs.iter().collect();
        let (time, _) = time_at_error(&list, 1e-6).expect("reached by the tightest run");
        assert!((time - 100.0).abs() < 1e-9, "{time}");
    }
}
