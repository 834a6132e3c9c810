//! Forward sensitivities of a run with respect to parameters, through all its switches.

use super::{Rig, RigInputs, RigState};
use crate::integrator::{IntegrationError, Options, Simulation};
use crate::parameter::ParameterError;
use crate::series::Dual;
use thiserror::Error;

/// Parameters that one run differentiates by; more take further runs.
const BATCH: usize = 8;

/// Why no sensitivities could be had.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum SensitivityError {
    /// A parameter does not exist.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// The run failed.
    #[error(transparent)]
    Integration(#[from] IntegrationError),
}

/// A state and its derivatives with respect to parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensitivities {
    /// The state.
    pub state: RigState<f64>,
    /// dx/dp, one state for each parameter asked for.
    pub derivatives: Vec<RigState<f64>>,
    /// Whether the motion only grazed a switch: there the derivatives do not exist.
    pub interrupted: bool,
}

/// The state at each of `times` [s, rising] of a run from `state` at time 0, with its derivatives
/// with respect to the parameters called `names`.
///
/// The instants of the switches move with the parameters; the jumps that this makes in the
/// derivatives are part of the result.
pub fn sensitivities(
    rig: &Rig<f64>,
    names: &[&str],
    options: Options,
    state: &RigState<f64>,
    inputs: &RigInputs<f64>,
    times: &[f64],
) -> Result<Vec<Sensitivities>, SensitivityError> {
    let mut results: Vec<Sensitivities> = Vec::with_capacity(times.len());
    for (batch, names) in names.chunks(BATCH).enumerate() {
        let mut dual_rig = rig.to_scalar::<Dual<BATCH>>();
        for (slot, name) in names.iter().enumerate() {
            let value = rig.parameter(name).ok_or_else(|| ParameterError::Unknown {
                name: (*name).to_owned(),
            })?;
            dual_rig.set_parameter(name, Dual::variable(value, slot))?;
        }
        let start = state.map(|x| Dual {
            value: x,
            derivative: [0.0; BATCH],
        });
        let mut run = Simulation::new(dual_rig, options, 0.0, start, inputs.to_scalar())?;
        for (place, &time) in times.iter().enumerate() {
            run.advance_to(time)?;
            let now = run.state_at(time);
            let statistics = run.statistics();
            if batch == 0 {
                results.push(Sensitivities {
                    state: now.map(|x| x.value),
                    derivatives: Vec::new(),
                    interrupted: statistics.grazing > 0,
                });
            }
            let derivatives = (0..names.len()).map(|slot| now.map(|x| x.derivative[slot]));
            results[place].derivatives.extend(derivatives);
        }
    }
    Ok(results)
}
