//! Repeats an experiment and compares what comes out with what should.

use std::collections::BTreeMap;

use thiserror::Error;

use super::table::{Column, Table};
use crate::component::{Component, ComponentError, Kind, Role, Variable};

/// Most communication steps of an experiment.
const MOST_STEPS: f64 = 1e6;
/// Relative tolerance where nobody states one: that which tools take if they are not told another.
const USUAL_TOLERANCE: f64 = 1e-4;
/// How often the tolerance of the solver results may differ: errors of steps add up.
const ALLOWANCE: f64 = 100.0;
/// Share of the step within which two instants are one: importers add up their time.
const SAME: f64 = 1e-6;

/// What to run.
#[derive(Debug, Clone, PartialEq)]
pub struct Experiment {
    /// Its name.
    pub name: String,
    /// Start [s].
    pub start: f64,
    /// End [s].
    pub stop: f64,
    /// Communication step [s].
    pub step: f64,
    /// Relative tolerance for the solver, where it is stated.
    pub tolerance: Option<f64>,
    /// Values of parameters.
    pub parameters: Vec<(String, f64)>,
    /// The inputs.
    pub stimuli: Table,
}

impl Experiment {
    /// The tolerance that is stated, or the usual one.
    #[must_use]
    pub fn tolerance(&self) -> f64 {
        self.tolerance.unwrap_or(USUAL_TOLERANCE)
    }
}

/// Why an experiment could not be repeated.
#[derive(Debug, Error)]
pub enum RepeatError {
    /// The times make no run.
    #[error(
        "from {start} s to {stop} s in steps of {step} s is no run of at most {MOST_STEPS:e} steps"
    )]
    Times {
        /// Start [s].
        start: f64,
        /// End [s].
        stop: f64,
        /// Communication step [s].
        step: f64,
    },
    /// A name is that of no variable that can take the part.
    #[error("{name} is no {part}")]
    Name {
        /// The name.
        name: String,
        /// `real input`, `real parameter`, `variable that can be read`.
        part: &'static str,
    },
    /// The component refused something.
    #[error(transparent)]
    Component(#[from] ComponentError),
}

/// The furthest that a variable came from its reference, in shares of what is allowed.
#[derive(Debug, Clone, PartialEq)]
pub struct Deviation {
    /// The variable.
    pub name: String,
    /// When [s].
    pub time: f64,
    /// Its value in the repeated run.
    pub found: f64,
    /// Its value in the reference.
    pub expected: f64,
    /// The difference that is allowed.
    pub allowed: f64,
}

impl Deviation {
    /// Whether it is more than is allowed; a value that is no number is.
    #[must_use]
    pub fn is_excess(&self) -> bool {
        self.size().total_cmp(&self.allowed).is_gt()
    }

    /// Difference between the two values.
    #[must_use]
    pub fn size(&self) -> f64 {
        (self.found - self.expected).abs()
    }
}

/// Runs the experiment: the `shown` variables at the times `rows` [s] that lie within it. Where the component takes one
/// length of step only, `fixed_step`, rows between the steps are left out.
///
/// Values are read before the inputs of the same instant are set, as importers do that write such results.
///
/// # Errors
/// [`RepeatError`].
pub fn run(
    component: &mut dyn Component,
    experiment: &Experiment,
    shown: &[&str],
    rows: &[f64],
    fixed_step: bool,
) -> Result<Table, RepeatError> {
    let Experiment {
        start, stop, step, ..
    } = *experiment;
    let steps = (stop - start) / step;
    // Negated, since a comparison with NaN is false.
    if !(steps > 0.0 && steps <= MOST_STEPS && step > 0.0 && start.is_finite()) {
        return Err(RepeatError::Times { start, stop, step });
    }
    let names = Names::of(component.variables());
    let outputs = shown
        .iter()
        .map(|name| {
            names.find(name, "variable that can be read", |variable| {
                variable.kind != Kind::Other
            })
        })
        .collect::<Result<Vec<_>, _>>()?;
    let mut inputs = Vec::new();
    for column in &experiment.stimuli.columns {
        let at = names.find(&column.name, "real input", |variable| {
            variable.role == Role::Input && variable.kind == Kind::Real
        })?;
        inputs.push((at, column, names.variables[at].held));
    }
    let mut values = Vec::new();
    for (name, value) in &experiment.parameters {
        let at = names.find(name, "real parameter", |variable| {
            variable.role == Role::Parameter && variable.kind == Kind::Real
        })?;
        values.push((at, *value));
    }
    let driven = |time: f64| {
        let drive = |(at, column, held): &(usize, &Column, bool)| {
            (*at, experiment.stimuli.at(column, time, *held))
        };
        inputs.iter().map(drive).collect::<Vec<_>>()
    };
    values.extend(driven(start));
    component.set(&values)?;
    component.initialise(start, stop)?;
    let mut table = Table {
        time: Vec::new(),
        columns: shown
            .iter()
            .map(|name| Column {
                name: (*name).to_owned(),
                values: Vec::new(),
            })
            .collect(),
    };
    let wanted = rows.iter().copied();
    let within = start - SAME * step..=stop + SAME * step;
    let wanted: Vec<f64> = wanted.filter(|row| within.contains(row)).collect();
    let mut row = vec![0.0; outputs.len()];
    let mut now = start;
    let mut next = 0;
    for target in instants(experiment, (!fixed_step).then_some(&wanted)) {
        if target > now {
            component.set(&driven(now))?;
            component.step(now, target)?;
            now = target;
        }
        while next < wanted.len() && wanted[next] <= now + SAME * step {
            if wanted[next] >= now - SAME * step {
                component.get(&outputs, &mut row)?;
                table.time.push(wanted[next]);
                for (column, value) in table.columns.iter_mut().zip(&row) {
                    column.values.push(*value);
                }
            }
            next += 1;
        }
    }
    Ok(table)
}

/// A component's variables by their names.
struct Names<'a> {
    variables: &'a [Variable],
    places: BTreeMap<&'a str, usize>,
}

impl<'a> Names<'a> {
    fn of(variables: &'a [Variable]) -> Self {
        let named = variables.iter().enumerate();
        let places = named.map(|(at, variable)| (variable.name.as_str(), at));
        Self {
            variables,
            places: places.collect(),
        }
    }

    /// The place of the variable of this name, if it can take the part.
    fn find(
        &self,
        name: &str,
        part: &'static str,
        fits: impl Fn(&Variable) -> bool,
    ) -> Result<usize, RepeatError> {
        let at = self.places.get(name).copied();
        at.filter(|at| fits(&self.variables[*at]))
            .ok_or_else(|| RepeatError::Name {
                name: name.to_owned(),
                part,
            })
    }
}

/// Communication points: the start and every step; with rows, these and the end too.
fn instants(experiment: &Experiment, rows: Option<&Vec<f64>>) -> Vec<f64> {
    let Experiment {
        start, stop, step, ..
    } = *experiment;
    let count = ((stop - start) / step + SAME).floor() as usize;
    let mut instants: Vec<f64> = (0..=count).map(|at| start + at as f64 * step).collect();
    if let Some(rows) = rows {
        instants.extend(rows);
        instants.push(stop);
    }
    instants.sort_by(f64::total_cmp);
    instants.dedup_by(|later, earlier| *later - *earlier <= SAME * step);
    instants
}

/// Where each variable of the reference was furthest from it. The allowance is that of the stated tolerance, relative to the
/// variable's largest value.
#[must_use]
pub fn compare(found: &Table, expected: &Table, tolerance: Option<f64>) -> Vec<Deviation> {
    let share = ALLOWANCE * tolerance.unwrap_or(USUAL_TOLERANCE);
    let mut deviations = Vec::new();
    let named = found.columns.iter();
    let named: BTreeMap<&str, &Column> =
        named.map(|column| (column.name.as_str(), column)).collect();
    for reference in &expected.columns {
        let Some(column) = named.get(reference.name.as_str()) else {
            continue;
        };
        let largest = reference
            .values
            .iter()
            .fold(0.0_f64, |largest, value| largest.max(value.abs()));
        let allowed = share * if largest > 0.0 { largest } else { 1.0 };
        // Two rows of one time are a jump, at which either value will do.
        let mut at = 0;
        let mut furthest: Option<Deviation> = None;
        for (time, value) in found.time.iter().zip(&column.values) {
            while expected.time[at] < *time {
                at += 1;
            }
            let rows = (at..expected.time.len()).take_while(|row| expected.time[*row] == *time);
            let nearest = rows
                .map(|row| reference.values[row])
                .min_by(|one, other| (one - value).abs().total_cmp(&(other - value).abs()));
            let deviation = Deviation {
                name: reference.name.clone(),
                time: *time,
                found: *value,
                expected: nearest.unwrap_or(f64::NAN),
                allowed,
            };
            if furthest
                .as_ref()
                .is_none_or(|known| deviation.size().total_cmp(&known.size()).is_gt())
            {
                furthest = Some(deviation);
            }
        }
        deviations.extend(furthest);
    }
    deviations
}

/// The times of a table, each once.
#[must_use]
pub fn times(table: &Table) -> Vec<f64> {
    let mut times = table.time.clone();
    times.dedup();
    times
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Adds up its input over its steps; `held` says of the input that it changes at events only.
    struct Sum {
        variables: Vec<Variable>,
        values: [f64; 2],
        steps: Vec<f64>,
    }

    impl Sum {
        fn new(held: bool) -> Self {
            let variable = |name: &str, role| Variable {
                name: name.to_owned(),
                reference: 0,
                role,
                kind: Kind::Real,
                held,
                is_tunable: false,
                unit: String::new(),
                start: None,
                minimum: None,
                maximum: None,
                description: String::new(),
            };
            Self {
                variables: vec![variable("u", Role::Input), variable("x", Role::Output)],
                values: [0.0; 2],
                steps: Vec::new(),
            }
        }
    }

    impl Component for Sum {
        fn title(&self) -> String {
            "sum".to_owned()
        }
        fn variables(&self) -> &[Variable] {
            &self.variables
        }
        fn set(&mut self, values: &[(usize, f64)]) -> Result<(), ComponentError> {
            values
                .iter()
                .for_each(|(at, value)| self.values[*at] = *value);
            Ok(())
        }
        fn initialise(&mut self, _start: f64, _stop: f64) -> Result<(), ComponentError> {
            Ok(())
        }
        fn reset(&mut self) -> Result<(), ComponentError> {
            Ok(())
        }
        fn get(&mut self, positions: &[usize], values: &mut [f64]) -> Result<(), ComponentError> {
            for (at, value) in positions.iter().zip(values) {
                *value = self.values[*at];
            }
            Ok(())
        }
        fn step(&mut self, from: f64, to: f64) -> Result<(), ComponentError> {
            self.values[1] += self.values[0] * (to - from);
            self.steps.push(to - from);
            Ok(())
        }
        fn switches(&self) -> Option<u64> {
            None
        }
    }

    fn experiment(stimuli: &str) -> Experiment {
        Experiment {
            name: "test".to_owned(),
            start: 0.0,
            stop: 2.0,
            step: 0.5,
            tolerance: None,
            parameters: Vec::new(),
            stimuli: Table::parse(stimuli).unwrap(),
        }
    }

    #[test]
    fn inputs_are_on_the_line_between_rows_or_held() {
        for (held, expected) in [(false, 0.5 * (0.0 + 1.0 + 2.0 + 3.0)), (true, 0.0)] {
            let mut sum = Sum::new(held);
            let experiment = experiment("time,u\n0,0\n2,4\n");
            let table = run(&mut sum, &experiment, &["x"], &[2.0], false).unwrap();
            assert_eq!(table.columns[0].values, [expected]);
        }
    }

    #[test]
    fn a_component_of_one_step_length_is_given_no_other() {
        let rows = [0.0, 0.5, 0.7, 2.0];
        let experiment = experiment("time,u\n0,1\n");
        let mut sum = Sum::new(false);
        let table = run(&mut sum, &experiment, &["x"], &rows, true).unwrap();
        assert_eq!((table.time, sum.steps), (vec![0.0, 0.5, 2.0], vec![0.5; 4]));
        let mut sum = Sum::new(false);
        let table = run(&mut sum, &experiment, &["x"], &rows, false).unwrap();
        assert_eq!((table.time.len(), sum.steps.len()), (4, 5));
    }

    #[test]
    fn what_is_no_run_or_no_variable_is_refused() {
        let mut sum = Sum::new(false);
        let mut said = |experiment: &Experiment, shown: &str| {
            run(&mut sum, experiment, &[shown], &[0.0], false)
                .unwrap_err()
                .to_string()
        };
        let good = experiment("time,u\n0,1\n");
        assert!(said(&good, "y").contains("y is no variable"));
        assert!(said(&experiment("time,x\n0,1\n"), "x").contains("x is no real input"));
        for (stop, step) in [(0.0, 0.5), (2.0, 1e-9), (f64::NAN, 0.5), (2.0, -0.5)] {
            let odd = Experiment {
                stop,
                step,
                ..good.clone()
            };
            assert!(said(&odd, "x").contains("no run"), "{stop} {step}");
        }
    }

    #[test]
    fn only_what_is_beyond_the_tolerance_is_an_excess() {
        let expected = Table::parse("time,x\n0,0\n1,10\n1,20\n2,20\n").unwrap();
        let worst = |values: &str, tolerance| {
            let found = Table::parse(values).unwrap();
            compare(&found, &expected, tolerance)[0].clone()
        };
        // Either side of the jump will do; a hundred tolerances of 20 are allowed.
        for side in ["10", "20"] {
            let text = format!("time,x\n0,0\n1,{side}\n2,20.0009\n");
            let deviation = worst(&text, Some(1e-6));
            assert!(
                !deviation.is_excess() && deviation.time == 2.0,
                "{deviation:?}"
            );
            assert!(worst(&text, Some(1e-8)).is_excess());
        }
        assert!(worst("time,x\n0,0\n1,15\n2,20\n", None).is_excess());
        let mut broken = Table::parse("time,x\n0,0\n2,20\n").unwrap();
        broken.columns[0].values[0] = f64::NAN;
        let deviation = compare(&broken, &expected, None)[0].clone();
        assert!(
            deviation.is_excess() && deviation.time == 0.0,
            "{deviation:?}"
        );
    }
}
