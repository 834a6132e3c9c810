//! Derivatives of a rig's signals: with respect to time, inputs and parameters.

use super::course::{Run, series};
use super::input_signals::InputSignals;
use super::variables::{Channel, Signal};
use crate::cosim::ModelError;
use crate::cosim::part::Known;
use crate::integrator::HybridSystem;
use crate::plant::{Indicators, MOST_INDICATORS, RigInputs, RigJet};
use crate::series::{Dual, Scalar};

/// Partial derivative of `unknown` with respect to `known` at `time` [s], state and mode held: the
/// equations are expanded once over dual numbers. `None` for an unknown that is neither a state nor
/// a torque.
pub(super) fn partial_derivative(
    run: &Run,
    time: f64,
    unknown: Signal,
    known: Known,
) -> Result<Option<f64>, ModelError> {
    let mut rig = run.system().to_scalar::<Dual<1>>();
    let mut inputs = dual_inputs(&InputSignals::of(run.inputs()).rig_inputs(time));
    match known {
        Known::Input(place) => {
            let value = match place {
                _ if place == Channel::Voltage as usize => &mut inputs.voltage[0],
                _ if place == Channel::NormalForce as usize => &mut inputs.normal_force[0],
                _ => &mut inputs.normal_force_1[0],
            };
            *value = Dual::variable(value.value, 0);
        }
        Known::Parameter(position) => {
            let value = rig.parameter_at(position).map_or(0.0, Scalar::value);
            rig.set_parameter_at(position, Dual::variable(value, 0))
                .map_err(ModelError::from_display)?;
        }
    }
    let mode = run
        .system()
        .carry(run.mode(), run.jet(), time - run.segment_start());
    let state = run.state_at(time).map(Dual::constant);
    let mut jet = RigJet::new(&rig);
    rig.expand_motion(&mode, Dual::constant(time), &state, &inputs, 1, &mut jet);
    let coefficient = match unknown {
        Signal::Rate(place) => jet.rates().get(place).copied(),
        _ => series(&rig, &jet, unknown).and_then(|series| series.first().copied()),
    };
    Ok(coefficient.map(|coefficient| coefficient.derivative[0]))
}

/// The event indicator at this place, at `time` \[s\].
pub(super) fn indicator(run: &Run, time: f64, place: usize) -> Option<f64> {
    let rig = run.system();
    let mode = rig.carry(run.mode(), run.jet(), time - run.segment_start());
    let inputs = InputSignals::of(run.inputs()).rig_inputs(time);
    let mut jet = RigJet::new(rig);
    rig.evaluate(&mode, time, &run.state_at(time), &inputs, &mut jet);
    let indicators = Indicators::new(rig);
    let mut values = [0.0; MOST_INDICATORS];
    let values = values.get_mut(..indicators.count())?;
    indicators.evaluate(rig, &mode, &inputs, &jet, values);
    values.get(place).copied()
}

fn dual_inputs(inputs: &RigInputs<f64>) -> RigInputs<Dual<1>> {
    RigInputs {
        time: inputs.time,
        voltage: inputs.voltage.map(Dual::constant),
        normal_force: inputs.normal_force.map(Dual::constant),
        normal_force_1: inputs.normal_force_1.map(Dual::constant),
        ..RigInputs::held(Dual::ZERO, Dual::ZERO, Dual::ZERO)
    }
}
