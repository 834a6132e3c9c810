//! The rig's inputs as polynomials in time.

use crate::series::Scalar;

/// Number of coefficients of an input polynomial: value and three derivatives.
pub const INPUT_TERMS: usize = 4;

/// Inputs from `time` on: each is Σ c\[j\] (t − `time`)^j.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigInputs<S> {
    /// Time [s] at which the polynomials are centred.
    pub time: f64,
    /// Motor voltage u [V].
    pub voltage: [S; INPUT_TERMS],
    /// Normal force N2 on disc D2 as the load cell gives it [N]; a pin cannot pull, so that
    /// negative values act as zero.
    pub normal_force: [S; INPUT_TERMS],
    /// Normal force N1 on disc D1 [N]; only the full rig has it.
    pub normal_force_1: [S; INPUT_TERMS],
    /// Torque from outside on disc D2 [N m], held; zero unless a disturbance is being estimated.
    pub disc_torque: S,
    /// Torque from outside on the gearbox output [N m], held; zero unless a disturbance is being
    /// estimated.
    pub motor_torque: S,
}

impl<S: Scalar> RigInputs<S> {
    /// Inputs that are held: voltage [V], normal forces N2 and N1 [N].
    pub fn held(voltage: S, normal_force: S, normal_force_1: S) -> Self {
        let hold = |value| [value, S::ZERO, S::ZERO, S::ZERO];
        Self {
            time: 0.0,
            voltage: hold(voltage),
            normal_force: hold(normal_force),
            normal_force_1: hold(normal_force_1),
            disc_torque: S::ZERO,
            motor_torque: S::ZERO,
        }
    }

    /// The same inputs over another kind of number, without derivatives.
    pub fn to_scalar<T: Scalar>(&self) -> RigInputs<T> {
        let constants = |terms: [S; INPUT_TERMS]| terms.map(|c| T::constant(c.value()));
        RigInputs {
            time: self.time,
            voltage: constants(self.voltage),
            normal_force: constants(self.normal_force),
            normal_force_1: constants(self.normal_force_1),
            disc_torque: T::constant(self.disc_torque.value()),
            motor_torque: T::constant(self.motor_torque.value()),
        }
    }
}

/// Coefficients of an input about `offset` after its own centre, and whether it is constant.
///
/// `was_constant` tells that all but the first coefficient in `series` are zero already.
#[inline]
pub(super) fn recentre<S: Scalar>(
    input: &[S; INPUT_TERMS],
    offset: S,
    was_constant: bool,
    series: &mut [S],
) -> bool {
    let mut c = *input;
    let constant = c[1..].iter().all(|x| x.value() == 0.0);
    if constant && was_constant {
        series[0] = c[0];
        return true;
    }
    if !constant {
        for first in 0..INPUT_TERMS {
            for k in (first..INPUT_TERMS - 1).rev() {
                c[k] += offset * c[k + 1];
            }
        }
    }
    series[..INPUT_TERMS].copy_from_slice(&c);
    series[INPUT_TERMS..].fill(S::ZERO);
    constant
}
