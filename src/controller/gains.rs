//! What every control law comes down to.

use crate::series::Scalar;

/// Number of inputs that a controller may have.
pub const INPUTS: usize = 3;

/// Places of the inputs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Input {
    /// Wanted speed of the gearbox output [rad/s].
    SpeedReference = 0,
    /// Measured speed of the gearbox output [rad/s].
    Speed = 1,
    /// Measured armature current [A].
    Current = 2,
}

/// A law as numbers: with the inputs w, the voltage without its limits is
/// u = d·w + c y + v, where v' = k·w is the integral and T y' = f·w − y the filtered torque.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gains<S> {
    /// d, in V per unit of the input.
    pub direct: [S; INPUTS],
    /// k, in V/s per unit of the input.
    pub integral: [S; INPUTS],
    /// f, in N m per unit of the input; zero in a law without filter.
    pub filtered: [S; INPUTS],
    /// c [V/(N m)]; zero in a law without filter.
    pub through_filter: S,
    /// T [s]; `None` in a law without filter.
    pub filter_time: Option<S>,
    /// Lowest and highest voltage [V].
    pub limits: [S; 2],
}

impl<S: Scalar> Gains<S> {
    /// Voltage [V] without its limits for these inputs, integral [V] and filtered torque [N m].
    pub fn unlimited(&self, inputs: [S; INPUTS], integral: S, filtered_torque: S) -> S {
        let mut sum = integral + self.through_filter * filtered_torque;
        for (gain, input) in self.direct.into_iter().zip(inputs) {
            sum += gain * input;
        }
        sum
    }
}
