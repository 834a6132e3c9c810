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
        self.check_knowns(knowns)?;
        self.check_unknowns(unknowns)?;
        let direction: Vec<(u32, f64)> = knowns.iter().copied().zip(seed.iter().copied()).collect();
        let sums = self.model.directional_derivatives(unknowns, &direction);
        for (place, (sum, unknown)) in sums.map_err(discard)?.into_iter().zip(unknowns).enumerate()
        {
            let sum = self.finite(sum, "the directional derivative of ", *unknown)?;
            sensitivity.write(place, sum);
        }
        Ok(())
    }

    /// Adjoint derivative: transposed Jacobian of the unknowns with respect to the knowns, times `seed`.
    pub(super) fn adjoint_derivative(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        seed: &[f64],
        sensitivity: &mut Output<f64>,
    ) -> Outcome {
        self.check_knowns(knowns)?;
        self.check_unknowns(unknowns)?;
        for (place, known) in knowns.iter().enumerate() {
            let column = self
                .model
                .directional_derivatives(unknowns, &[(*known, 1.0)]);
            let terms = column.map_err(discard)?.into_iter().zip(seed);
            let sum = terms.map(|(derivative, seed)| derivative * seed).sum();
            let sum = self.finite(sum, "the adjoint derivative by ", *known)?;
            sensitivity.write(place, sum);
        }
        Ok(())
    }

    /// Refuses what cannot be a direction: what cannot change. Fixed parameters count until the run starts.
    fn check_knowns(&self, knowns: &[u32]) -> Outcome {
        for known in knowns {
            let variable = self.typed(*known, VariableType::Real)?;
            let allowed = match self.phase {
                Phase::Initialization => variable.settable_before_start(),
                _ => variable.settable_between_steps(),
            };
            let is_state = || {
                self.model
                    .table()
                    .states()
                    .any(|state| state.value_reference == *known)
            };
            let of_solver =
                || self.exchange && (variable.causality == Causality::Independent || is_state());
            if (!allowed || variable.causality == Causality::Output) && !of_solver() {
                return Err(Refusal::error(format_args!(
                    "\"{}\" cannot be a known of a derivative; inputs and tunable parameters can, and in model exchange \
                     time and continuous states",
                    variable.name
                )));
            }
        }
        Ok(())
    }

    fn check_unknowns(&self, unknowns: &[u32]) -> Outcome {
        for unknown in unknowns {
            let variable = self.typed(*unknown, VariableType::Real)?;
            if !matches!(variable.causality, Causality::Output | Causality::Local) {
                return Err(Refusal::error(format_args!(
                    "\"{}\" cannot be an unknown of a derivative; outputs and locals can",
                    variable.name
                )));
            }
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
