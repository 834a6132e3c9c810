//! Derivatives of an instance's variables: with respect to time, inputs and parameters.

use super::instance::Instance;
use super::pointers::Output;
use super::status::{Outcome, Phase, Refusal};
use super::values::discard;
use crate::cosim::{
    Causality, MAX_INPUT_DERIVATIVE_ORDER, MAX_OUTPUT_DERIVATIVE_ORDER, VariableType,
};

impl Instance {
    /// Sets time derivatives of inputs at the present communication point.
    pub(super) fn set_input_derivatives(
        &mut self,
        references: &[u32],
        orders: &[i32],
        values: &[f64],
    ) -> Outcome {
        let checked = |(reference, order): (&u32, &i32)| {
            let variable = self.typed(*reference, VariableType::Real)?;
            if variable.causality != Causality::Input {
                return Err(Refusal::error(format_args!(
                    "\"{}\" is not an input; only inputs have derivatives to be set",
                    variable.name
                )));
            }
            order_within(*order, MAX_INPUT_DERIVATIVE_ORDER, &variable.name)
        };
        let orders = references
            .iter()
            .zip(orders)
            .map(checked)
            .collect::<Result<Vec<_>, Refusal>>()?;
        for (reference, value) in references.iter().zip(values) {
            if !value.is_finite() {
                return Err(Refusal::discard(format_args!(
                    "the derivative of \"{}\" cannot be {value}: it must be a finite number",
                    self.variable(*reference)?.name
                )));
            }
        }
        for ((reference, order), value) in references.iter().zip(orders).zip(values) {
            self.model
                .set_input_derivative(*reference, order, *value)
                .map_err(discard)?;
        }
        Ok(())
    }

    /// Reads time derivatives of outputs at the present communication point.
    pub(super) fn output_derivatives(
        &mut self,
        references: &[u32],
        orders: &[i32],
        values: &mut Output<f64>,
    ) -> Outcome {
        for (place, (reference, order)) in references.iter().zip(orders).enumerate() {
            let variable = self.typed(*reference, VariableType::Real)?;
            if variable.causality != Causality::Output {
                return Err(Refusal::error(format_args!(
                    "\"{}\" is not an output",
                    variable.name
                )));
            }
            let order = order_within(*order, MAX_OUTPUT_DERIVATIVE_ORDER, &variable.name)?;
            let value = self
                .model
                .output_derivative(*reference, order)
                .map_err(discard)?;
            values.write(place, self.finite(value, "the derivative of ", *reference)?);
        }
        Ok(())
    }

    /// Directional derivative: Jacobian of the unknowns with respect to the knowns, times `seed`.
    pub(super) fn directional_derivative(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        seed: &[f64],
        sensitivity: &mut Output<f64>,
    ) -> Outcome {
        for known in knowns {
            let variable = self.typed(*known, VariableType::Real)?;
            // What cannot change cannot be a direction: fixed parameters count until the run starts.
            let known = match self.phase {
                Phase::Initialization => variable.settable_before_start(),
                _ => variable.settable_between_steps(),
            };
            if !known || variable.causality == Causality::Output {
                return Err(Refusal::error(format_args!(
                    "\"{}\" cannot be a known of a directional derivative; inputs and tunable parameters can",
                    variable.name
                )));
            }
        }
        for (place, unknown) in unknowns.iter().enumerate() {
            let variable = self.typed(*unknown, VariableType::Real)?;
            if !matches!(variable.causality, Causality::Output | Causality::Local) {
                return Err(Refusal::error(format_args!(
                    "\"{}\" cannot be an unknown of a directional derivative; outputs and locals can",
                    variable.name
                )));
            }
            let mut sum = 0.0;
            for (known, seed) in knowns.iter().zip(seed) {
                sum += seed
                    * self
                        .model
                        .partial_derivative(*unknown, *known)
                        .map_err(discard)?;
            }
            let sum = self.finite(sum, "the directional derivative of ", *unknown)?;
            sensitivity.write(place, sum);
        }
        Ok(())
    }
}

fn order_within(order: i32, maximum: u32, name: &str) -> Result<u32, Refusal> {
    u32::try_from(order)
        .ok()
        .filter(|order| (1..=maximum).contains(order))
        .ok_or_else(|| {
            Refusal::error(format_args!(
                "order {order} of the derivative of \"{name}\" must be from 1 to {maximum}"
            ))
        })
}
