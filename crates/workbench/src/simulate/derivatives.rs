//! Derivatives of a run's states with respect to parameters, the inputs held as they are.

use stickslip::integrator::{IntegrationError, Options, Simulation};
use stickslip::parameter::ParameterError;
use stickslip::plant::{Rig, RigKind, RigState, index};
use stickslip::series::Dual;
use thiserror::Error;

use super::drive::Drive;
use super::run::{SAME_TIME, Schedule};
use crate::component::{Component, closest};

/// Parameters that one run differentiates by; more take further runs.
const BATCH: usize = 8;

/// Names of the states as variables of the FMUs, with their positions; the first five are those of every rig.
const STATES: [(&str, usize); 7] = [
    ("theta", index::THETA),
    ("theta_dot", index::OMEGA),
    ("theta3", index::THETA3),
    ("theta3_dot", index::OMEGA3),
    ("i", index::CURRENT),
    ("theta1", index::THETA1),
    ("theta1_dot", index::OMEGA1),
];
const OF_REDUCED_RIG: usize = 5;

/// Why there are no derivatives.
#[derive(Debug, Error)]
pub enum DerivativeError {
    /// No parameter has this name.
    #[error("the model has no parameter `{name}`{hint}")]
    UnknownParameter {
        /// The name.
        name: String,
        /// The nearest name, as half a sentence; may be empty.
        hint: String,
    },
    /// The parameter cannot be differentiated by at its value.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// The run failed.
    #[error(transparent)]
    Integration(#[from] IntegrationError),
}

/// Derivatives of the states over time.
#[derive(Debug, Clone, PartialEq)]
pub struct Derivatives {
    /// State and parameter, in the order of `columns`.
    pub names: Vec<(&'static str, String)>,
    /// Derivatives over time, a column for each pair; in the state's unit over the parameter's.
    pub columns: Vec<Vec<f64>>,
    /// Row from which on they do not exist: the motion grazed a switch there.
    pub interrupted: Option<usize>,
}

/// Names of the states of a rig of this kind, as variables of its FMUs.
pub fn state_names(kind: RigKind) -> impl Iterator<Item = (&'static str, usize)> {
    let count = match kind {
        RigKind::Reduced => OF_REDUCED_RIG,
        RigKind::Full => STATES.len(),
    };
    STATES.into_iter().take(count)
}

/// Derivatives of the states with respect to the parameters called `names`, over a run from `start` under the inputs of
/// `drive`; the instants of the switches move with the parameters. `go_on` is asked after each row of each run; where it says
/// no there is no result.
///
/// # Errors
/// [`DerivativeError`], naming the parameter or where the integrator gave up.
pub fn derivatives(
    rig: &Rig<f64>,
    component: &dyn Component,
    names: &[String],
    start: &RigState<f64>,
    (drive, schedule): (&Drive, &Schedule),
    go_on: &mut dyn FnMut() -> bool,
) -> Result<Option<Derivatives>, DerivativeError> {
    let states: Vec<_> = state_names(rig.kind()).collect();
    let mut found = Derivatives {
        names: Vec::new(),
        columns: Vec::new(),
        interrupted: None,
    };
    for batch in names.chunks(BATCH) {
        let mut run = Run::begin(rig, component, batch, start, (drive, schedule))?;
        let first = found.columns.len();
        for name in batch {
            for (state, _) in &states {
                found.names.push((*state, name.clone()));
                found.columns.push(Vec::with_capacity(schedule.rows()));
            }
        }
        for row in 0..schedule.rows() {
            let now = run.advance(component, row)?;
            let derivatives = (0..batch.len())
                .flat_map(|slot| states.iter().map(move |(_, at)| now[*at].derivative[slot]));
            for (column, value) in found.columns[first..].iter_mut().zip(derivatives) {
                column.push(value);
            }
            if run.is_interrupted() {
                let earliest = found.interrupted.map_or(row, |before| before.min(row));
                found.interrupted = Some(earliest);
            }
            if !go_on() {
                return Ok(None);
            }
        }
    }
    Ok(Some(found))
}

/// One run with derivatives by a batch of parameters.
struct Run<'a> {
    simulation: Simulation<Dual<BATCH>, Rig<Dual<BATCH>>>,
    drive: &'a Drive,
    schedule: &'a Schedule,
    sample: usize,
}

impl<'a> Run<'a> {
    fn begin(
        rig: &Rig<f64>,
        component: &dyn Component,
        names: &[String],
        start: &RigState<f64>,
        (drive, schedule): (&'a Drive, &'a Schedule),
    ) -> Result<Self, DerivativeError> {
        let mut dual_rig = rig.to_scalar::<Dual<BATCH>>();
        for (slot, name) in names.iter().enumerate() {
            let value = rig.parameter(name).ok_or_else(|| unknown(rig, name))?;
            dual_rig.set_parameter(name, Dual::variable(value, slot))?;
        }
        let state = start.map(|value| Dual {
            value,
            derivative: [0.0; BATCH],
        });
        let inputs = drive.rig_inputs(component, 0).to_scalar();
        Ok(Self {
            simulation: Simulation::new(
                dual_rig,
                Options::default(),
                schedule.time(0),
                state,
                inputs,
            )?,
            drive,
            schedule,
            sample: 0,
        })
    }

    /// The state at a row, after the changes of the inputs up to it.
    fn advance(
        &mut self,
        component: &dyn Component,
        row: usize,
    ) -> Result<RigState<Dual<BATCH>>, IntegrationError> {
        let target = self.schedule.time(row);
        while self.sample + 1 < self.drive.len()
            && self.drive.time(self.sample + 1) <= target + SAME_TIME
        {
            self.sample += 1;
            let change = self.drive.time(self.sample).min(target);
            let inputs = self.drive.rig_inputs(component, self.sample).to_scalar();
            if *self.simulation.inputs() != inputs {
                self.simulation.set_inputs(change, inputs)?;
            }
        }
        self.simulation.advance_to(target)?;
        Ok(self.simulation.state_at(target))
    }

    fn is_interrupted(&self) -> bool {
        let statistics = self.simulation.statistics();
        statistics.grazing > 0
    }
}

fn unknown(rig: &Rig<f64>, name: &str) -> DerivativeError {
    let parameters = rig.parameters();
    let near = closest(
        name,
        parameters.iter().map(|parameter| parameter.name.as_str()),
    );
    DerivativeError::UnknownParameter {
        name: name.to_owned(),
        hint: near
            .map(|near| format!("; did you mean `{near}`?"))
            .unwrap_or_default(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::Native;
    use crate::files::record::Record;
    use crate::simulate::{simulate_variables, usual_variables};

    const MODEL: &str = include_str!("../../../../modelDescription/reduced-rig.toml");
    const BY: [&str; 2] = ["contact.mu_s", "disc.inertia"];

    /// Inputs that change between and at the rows.
    fn inputs() -> Record {
        let mut record = Record::new("inputs", vec![0.0, 1.0, 1.305]).unwrap();
        record.add_column("u", vec![3.0, 2.0, 3.5]).unwrap();
        record.add_column("N2", vec![50.0, 40.0, 60.0]).unwrap();
        record
    }

    /// Angle and velocity of the disc with one parameter off by a relative amount.
    fn run(name: &str, off: f64) -> Record {
        let mut rig = Rig::from_toml(MODEL, "model").unwrap();
        let value = rig.parameter(name).unwrap();
        rig.set_parameter(name, value * (1.0 + off)).unwrap();
        let mut component = Native::from_text(&rig.to_toml(), "model").unwrap();
        let drive = Drive::from_record(&component, &inputs()).unwrap();
        let schedule = Schedule::new(0.0, 4.0, 0.1).unwrap();
        let shown = usual_variables(&component);
        simulate_variables(&mut component, &drive, &schedule, &shown, &mut |_| true).unwrap()
    }

    #[test]
    fn derivatives_are_those_of_neighbouring_runs() {
        let rig = Rig::from_toml(MODEL, "model").unwrap();
        let component = Native::from_text(MODEL, "model").unwrap();
        let drive = Drive::from_record(&component, &inputs()).unwrap();
        let schedule = Schedule::new(0.0, 4.0, 0.1).unwrap();
        let names = BY.map(str::to_owned);
        let start = [0.0; stickslip::plant::STATES];
        let work = (&drive, &schedule);
        let found = derivatives(&rig, &component, &names, &start, work, &mut || true)
            .unwrap()
            .unwrap();
        assert_eq!((found.names.len(), found.interrupted), (10, None));
        let off = 1e-6;
        for name in BY {
            let (above, below) = (run(name, off), run(name, -off));
            let width = 2.0 * off * rig.parameter(name).unwrap();
            for state in ["theta", "theta3_dot"] {
                let at = found
                    .names
                    .iter()
                    .position(|(own, by)| *own == state && by == name)
                    .unwrap();
                let pairs = above
                    .column(state)
                    .unwrap()
                    .iter()
                    .zip(below.column(state).unwrap());
                let scale = found.columns[at]
                    .iter()
                    .fold(0.0, |most: f64, x| most.max(x.abs()));
                assert!(scale > 0.1, "{state} by {name}");
                for ((above, below), derivative) in pairs.zip(&found.columns[at]) {
                    let difference = (above - below) / width;
                    assert!(
                        (difference - derivative).abs() < 1e-3 * scale,
                        "{state} by {name}: {derivative}, by differences {difference}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_parameter_that_is_none_is_named_with_the_nearest() {
        let rig = Rig::from_toml(MODEL, "model").unwrap();
        let error = unknown(&rig, "contact.mu_z").to_string();
        assert!(error.contains("did you mean `contact.mu_"), "{error}");
    }
}
