//! Derivatives of everything that a rig computes at an instant, in one direction at a time: the same equations over dual
//! numbers.

use super::super::variables::{CHANNELS, Channel, Signal};
use super::run::friction_of;
use crate::cosim::ModelError;
use crate::cosim::exchange_component::Seeds;
use crate::plant::{
    Indicators, MOST_INDICATORS, Rig, RigInputs, RigJet, RigMode, RigState, STATES,
};
use crate::series::{Dual, Scalar};

type Number = Dual<1>;

/// A rig over dual numbers, with its workspace.
pub(super) struct Sensitivities {
    rig: Rig<Number>,
    jet: RigJet<Number>,
}

impl Sensitivities {
    /// Those of `rig` in directions whose parameters are those of `seeds`.
    ///
    /// # Errors
    /// A parameter that is out of range.
    pub(super) fn new(rig: &Rig<f64>, seeds: &Seeds<CHANNELS, STATES>) -> Result<Self, ModelError> {
        let mut dual = rig.to_scalar::<Number>();
        for (position, seed) in &seeds.parameters {
            let value = rig.parameter_at(*position).unwrap_or(0.0);
            dual.set_parameter_at(*position, number(value, *seed))
                .map_err(ModelError::from_display)?;
        }
        Ok(Self {
            jet: RigJet::new(&dual),
            rig: dual,
        })
    }

    /// Derivatives of the `unknowns` along `seeds`.
    #[allow(clippy::too_many_arguments)]
    pub(super) fn along(
        &mut self,
        mode: &RigMode,
        time: f64,
        state: &RigState<f64>,
        inputs: &RigInputs<f64>,
        indicators: &Indicators,
        unknowns: &[Signal],
        seeds: &Seeds<CHANNELS, STATES>,
    ) -> Vec<f64> {
        let mut moving = [Number::constant(0.0); STATES];
        for (place, component) in moving.iter_mut().enumerate() {
            *component = number(state[place], seeds.state[place]);
        }
        let input = |value: f64, channel: Channel| number(value, seeds.inputs[channel as usize]);
        let inputs = RigInputs {
            time: inputs.time,
            ..RigInputs::held(
                input(inputs.voltage[0], Channel::Voltage),
                input(inputs.normal_force[0], Channel::NormalForce),
                input(inputs.normal_force_1[0], Channel::NormalForce1),
            )
        };
        let (rig, jet) = (&self.rig, &mut self.jet);
        rig.evaluate(mode, number(time, seeds.time), &moving, &inputs, jet);
        let rates = jet.rates();
        let mut watched = [Number::constant(1.0); MOST_INDICATORS];
        if unknowns
            .iter()
            .any(|signal| matches!(signal, Signal::Indicator(_)))
        {
            let watched = &mut watched[..indicators.count()];
            indicators.evaluate(rig, mode, &inputs, jet, watched);
        }
        let of = |signal: &Signal| {
            let value = match *signal {
                Signal::State(place) => moving.get(place).copied(),
                Signal::Rate(place) => rates.get(place).copied(),
                Signal::Friction(friction) => friction_of(jet, friction),
                Signal::Indicator(place) => watched.get(place).copied(),
                Signal::Stuck(_) | Signal::CouplingFree => None,
            };
            value.map_or(0.0, |value| value.derivative[0])
        };
        unknowns.iter().map(of).collect()
    }
}

fn number(value: f64, derivative: f64) -> Number {
    Number {
        value,
        derivative: [derivative],
    }
}
