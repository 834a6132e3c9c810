//! What parameters do to the accelerations while the motion is held.

use crate::plant::linear_parts::LinearParts;
use crate::series::{Scalar, Series};

/// Rows of the equations of motion: accelerations of D2, D1 and of the gearbox output, and di/dt.
pub(super) const ON_DISC: usize = 0;
pub(super) const ON_DISC_1: usize = 1;
pub(super) const ON_MOTOR: usize = 2;
pub(super) const ON_CIRCUIT: usize = 3;
pub(super) const ROWS: usize = 4;

/// What all parameters add to each row; derivatives only.
pub(super) type Forcing<S> = [Series<S>; ROWS];

/// Series of the motion with which parameters enter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Along {
    /// θ2 − θ3 and its rate.
    Twist,
    Rate,
    /// θ1 − θ2 and its rate.
    Twist1,
    Rate1,
    /// ω3 and i.
    MotorSpeed,
    Current,
    /// Accelerations of D2, D1 and of the gearbox output, and di/dt.
    Rates(usize),
    /// ±1 at order 0: the direction in which the motor turns.
    MotorDirection,
}

/// Number of series that [`Along`] tells apart.
pub(super) const KINDS: usize = 7 + ROWS;

impl Along {
    pub fn position(self) -> usize {
        match self {
            Self::Twist => 0,
            Self::Rate => 1,
            Self::Twist1 => 2,
            Self::Rate1 => 3,
            Self::MotorSpeed => 4,
            Self::Current => 5,
            Self::MotorDirection => 6,
            Self::Rates(row) => 7 + row,
        }
    }
}

/// One parameter's effect on one row: `factor` × a series of the motion, in one slot.
#[derive(Clone, Copy, Debug)]
struct ParameterForcing {
    along: Along,
    slot: usize,
    factor: f64,
}

/// What the numbers of the linear part add to each row; the same in all segments.
#[derive(Clone, Debug)]
pub(super) struct ParameterForcings {
    rows: [Vec<ParameterForcing>; ROWS],
}

impl ParameterForcings {
    pub fn new<S: Scalar>(parts: &LinearParts<S>) -> Self {
        let mut parameter_forcings = Self {
            rows: Default::default(),
        };
        let per = |inverse: S| inverse.value();
        let (disc, disc_1) = (per(parts.inverse_inertia), per(parts.inverse_inertia_1));
        let motor = per(parts.inverse_motor_inertia);
        let circuit = per(parts.inverse_inductance);
        parameter_forcings.add(ON_DISC, Along::Twist, &parts.stiffness, -disc);
        parameter_forcings.add(ON_DISC, Along::Rate, &parts.damping, -disc);
        parameter_forcings.add(ON_DISC, Along::Twist1, &parts.stiffness_1, disc);
        parameter_forcings.add(ON_DISC, Along::Rate1, &parts.damping_1, disc);
        parameter_forcings.add(ON_DISC_1, Along::Twist1, &parts.stiffness_1, -disc_1);
        parameter_forcings.add(ON_DISC_1, Along::Rate1, &parts.damping_1, -disc_1);
        parameter_forcings.add(ON_MOTOR, Along::Twist, &parts.stiffness, motor);
        parameter_forcings.add(ON_MOTOR, Along::Rate, &parts.damping, motor);
        parameter_forcings.add(ON_MOTOR, Along::Current, &parts.current_to_torque, motor);
        parameter_forcings.add(ON_MOTOR, Along::MotorSpeed, &parts.motor_damping, -motor);
        parameter_forcings.add(
            ON_MOTOR,
            Along::MotorDirection,
            &parts.motor_coulomb,
            -motor,
        );
        parameter_forcings.add(ON_CIRCUIT, Along::Current, &parts.resistance, -circuit);
        parameter_forcings.add(ON_CIRCUIT, Along::MotorSpeed, &parts.back_emf, -circuit);
        // All of an acceleration is inversely proportional to the inertia.
        for (row, inverse) in [
            (ON_DISC, &parts.inverse_inertia),
            (ON_DISC_1, &parts.inverse_inertia_1),
            (ON_MOTOR, &parts.inverse_motor_inertia),
            (ON_CIRCUIT, &parts.inverse_inductance),
        ] {
            if inverse.value() != 0.0 {
                parameter_forcings.add(row, Along::Rates(row), inverse, 1.0 / inverse.value());
            }
        }
        parameter_forcings
    }

    fn add<S: Scalar>(&mut self, row: usize, along: Along, number: &S, factor: f64) {
        for slot in 0..S::SLOTS {
            let derivative = number.slot(slot);
            if derivative != 0.0 {
                self.rows[row].push(ParameterForcing {
                    along,
                    slot,
                    factor: factor * derivative,
                });
            }
        }
    }

    /// Whether any series of this kind is wanted for `row`.
    pub fn uses(&self, along: Along) -> bool {
        self.rows
            .iter()
            .flatten()
            .any(|forcing| forcing.along == along)
    }

    /// Adds them to `row` up to order `top`.
    pub fn add_to<S: Scalar>(
        &self,
        row: usize,
        top: usize,
        motion: &[Series<f64>; KINDS],
        forcing: &mut Forcing<S>,
    ) {
        for own in &self.rows[row] {
            let series = &motion[own.along.position()];
            add_series(own.slot, own.factor, series, row, top, forcing);
        }
    }
}

/// Adds `factor` × `series` to one slot of `row`.
#[inline]
pub(super) fn add_series<S: Scalar>(
    slot: usize,
    factor: f64,
    series: &Series<f64>,
    row: usize,
    top: usize,
    forcing: &mut Forcing<S>,
) {
    for (term, c) in forcing[row][..=top].iter_mut().zip(series) {
        term.add_to_slot(slot, factor * c);
    }
}
