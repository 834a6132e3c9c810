//! Derivatives of inputs and outputs as an importer sets and reads them.

use super::{Fmi2, Fmi3, Instance};
use stickslip::ffi::{Status, fmi2, fmi3};

impl Instance<'_> {
    /// Derivative of `unknown` in the direction of the knowns, weighed by their seeds; or the status with which it
    /// was refused.
    pub fn try_directional(
        &self,
        unknown: &str,
        knowns: &[&str],
        seed: &[f64],
    ) -> Result<f64, Status> {
        let unknown = self.reference(unknown);
        let knowns: Vec<u32> = knowns.iter().map(|name| self.reference(name)).collect();
        let mut sensitivity = f64::NAN;
        let (c, count) = (self.handle, knowns.len());
        let (knowns, seed) = (knowns.as_ptr(), seed.as_ptr());
        // SAFETY: one unknown, as many knowns as seeds.
        let status = unsafe {
            match self.version {
                Fmi2 => fmi2::fmi2GetDirectionalDerivative(
                    c,
                    &unknown,
                    1,
                    knowns,
                    count,
                    seed,
                    &mut sensitivity,
                ),
                Fmi3 => fmi3::fmi3GetDirectionalDerivative(
                    c,
                    &unknown,
                    1,
                    knowns,
                    count,
                    seed,
                    count,
                    &mut sensitivity,
                    1,
                ),
            }
        };
        if status == Status::Ok {
            Ok(sensitivity)
        } else {
            Err(status)
        }
    }

    /// Derivative of `unknown` with respect to `known`.
    #[track_caller]
    pub fn derivative(&self, unknown: &str, known: &str) -> f64 {
        self.try_directional(unknown, &[known], &[1.0]).unwrap()
    }

    /// Time derivative of a variable, or the status with which it was refused.
    pub fn try_output_derivative(&self, name: &str, order: i32) -> Result<f64, Status> {
        let (reference, mut value) = (self.reference(name), f64::NAN);
        // SAFETY: one variable, one order, one value.
        let status = unsafe {
            match self.version {
                Fmi2 => fmi2::fmi2GetRealOutputDerivatives(
                    self.handle,
                    &reference,
                    1,
                    &order,
                    &mut value,
                ),
                Fmi3 => fmi3::fmi3GetOutputDerivatives(
                    self.handle,
                    &reference,
                    1,
                    &order,
                    &mut value,
                    1,
                ),
            }
        };
        if status == Status::Ok {
            Ok(value)
        } else {
            Err(status)
        }
    }

    /// Time derivative of an output.
    #[track_caller]
    pub fn output_derivative(&self, name: &str, order: i32) -> f64 {
        self.try_output_derivative(name, order).unwrap()
    }

    /// Sets the time derivative of an input; FMI 2 only.
    pub fn set_input_derivative(&self, name: &str, order: i32, value: f64) -> Status {
        let reference = self.reference(name);
        // SAFETY: one variable, one order, one value.
        unsafe { fmi2::fmi2SetRealInputDerivatives(self.handle, &reference, 1, &order, &value) }
    }
}
