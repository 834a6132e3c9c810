//! The control laws and their parameters.

use super::gains::{Gains, INPUTS, Input};
use crate::parameter::{self, Parameter, ParameterError, Range, Section, section};
use crate::plant::Gearbox;
use crate::series::Scalar;

section! {
    /// A PI controller of speed.
    pub struct SpeedGains {
        /// Proportional gain on the error of the controlled speed
        kappa_p: "V.s/rad", Range::NonNegative;
        /// Integral gain on the error of the controlled speed
        kappa_i: "V/rad", Range::NonNegative;
    }
}

section! {
    /// How soft the drive is to the shaft.
    pub struct SoftTorqueGains {
        /// Torsional impedance that the gearbox output shows the shaft; sqrt(J k) of disc and shaft takes up its waves
        impedance: "N.m.s/rad", Range::Positive;
        /// Time constant of the filter on the motor's torque
        filter_time: "s", Range::Positive;
        /// Rate at which the mean speed returns to its reference
        integral_rate: "1/s", Range::NonNegative;
    }
}

section! {
    /// What a controller has to know of the motor, quantities on the motor's own shaft.
    pub struct MotorConstants {
        /// Armature resistance
        resistance: "Ohm", Range::Positive;
        /// Torque constant
        torque_constant: "N.m/A", Range::Positive;
        /// Back-EMF constant
        back_emf_constant: "V.s/rad", Range::Positive;
    }
}

section! {
    /// What the supply can give.
    pub struct VoltageLimits {
        /// Lowest voltage
        minimum: "V", Range::Finite;
        /// Highest voltage
        maximum: "V", Range::Finite;
    }
}

/// u = κp e + κi ∫e dt within the voltage limits; e = ω_ref − ω3, or η times that if the motor's
/// own speed is controlled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedController<S> {
    /// Gains.
    pub gains: SpeedGains<S>,
    /// The gearbox, if the gains act on the motor's speed; `None`: on the gearbox output's.
    pub gearbox: Option<Gearbox<S>>,
    /// Limits of the voltage.
    pub voltage: VoltageLimits<S>,
}

/// Soft torque by impedance matching: the speed reference yields to the measured torque.
///
/// u = K_E η (ω_ref − y/Z_c) + v with y the filtered motor torque η K_T i and
/// v' = K_E η a (ω_ref − ω3). Quasi-statically the motor alone is the impedance
/// D = η² K_T K_E/R; with 1/Z_c = 1/Z − 1/D both together are Z.
///
/// Sources: torque feedback to the speed reference, G. W. Halsey, Å. Kyllingstad, A. Kylling, SPE 18049
/// (1988); active damping, J. D. Jansen, L. van den Steen, J. Sound Vib. 179 (1995) 647; an integral
/// that takes out the drive's inertia at the stick-slip frequency, Å. Kyllingstad, P. J. Nessjøen,
/// SPE/IADC 119660 (2009).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SoftTorque<S> {
    /// Gains.
    pub gains: SoftTorqueGains<S>,
    /// The gearbox.
    pub gearbox: Gearbox<S>,
    /// The motor.
    pub motor: MotorConstants<S>,
    /// Limits of the voltage.
    pub voltage: VoltageLimits<S>,
}

/// A controller with all its numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ControlLaw<S> {
    /// PI on a speed.
    Speed(SpeedController<S>),
    /// Soft torque.
    SoftTorque(SoftTorque<S>),
}

/// Name of the section with the gains of [`SpeedController`].
pub(super) const SPEED_CONTROLLER: &str = "speed_controller";
/// Name of the section with the gains of [`SoftTorque`].
pub(super) const SOFT_TORQUE: &str = "soft_torque";

impl<S: Scalar> ControlLaw<S> {
    /// All sections with their names, in the fixed order of the parameter list.
    pub fn sections(&self) -> Vec<(&'static str, &dyn Section<S>)> {
        match self {
            Self::Speed(law) => {
                let mut sections: Vec<(&'static str, &dyn Section<S>)> =
                    vec![(SPEED_CONTROLLER, &law.gains)];
                sections.extend(law.gearbox.as_ref().map(|g| ("gearbox", g as _)));
                sections.push(("voltage", &law.voltage));
                sections
            }
            Self::SoftTorque(law) => vec![
                (SOFT_TORQUE, &law.gains),
                ("gearbox", &law.gearbox),
                ("motor", &law.motor),
                ("voltage", &law.voltage),
            ],
        }
    }

    fn sections_mut(&mut self) -> Vec<(&'static str, &mut dyn Section<S>)> {
        match self {
            Self::Speed(law) => {
                let mut sections: Vec<(&'static str, &mut dyn Section<S>)> =
                    vec![(SPEED_CONTROLLER, &mut law.gains)];
                sections.extend(law.gearbox.as_mut().map(|g| ("gearbox", g as _)));
                sections.push(("voltage", &mut law.voltage));
                sections
            }
            Self::SoftTorque(law) => vec![
                (SOFT_TORQUE, &mut law.gains),
                ("gearbox", &mut law.gearbox),
                ("motor", &mut law.motor),
                ("voltage", &mut law.voltage),
            ],
        }
    }

    /// All parameters in a fixed order.
    pub fn parameters(&self) -> Vec<Parameter> {
        parameter::parameters(&self.sections())
    }

    /// Value of the parameter at this position of [`Self::parameters`].
    pub fn parameter_at(&self, position: usize) -> Option<S> {
        parameter::value_at(&self.sections(), position)
    }

    /// Replaces a parameter by position after checking its range.
    ///
    /// # Errors
    /// No such parameter, or a value out of its range.
    pub fn set_parameter_at(&mut self, position: usize, value: S) -> Result<(), ParameterError> {
        parameter::set_at(self.sections_mut(), position, value)
    }

    /// Checks every range and every relation between parameters.
    ///
    /// # Errors
    /// The first that is violated.
    pub fn check(&self) -> Result<(), ParameterError> {
        parameter::check(&self.sections())?;
        let limits = match self {
            Self::Speed(law) => &law.voltage,
            Self::SoftTorque(law) => &law.voltage,
        };
        let (minimum, maximum) = (limits.minimum.value(), limits.maximum.value());
        if minimum >= maximum {
            return Err(ParameterError::Inconsistent {
                section: "voltage".into(),
                message: format!("minimum = {minimum} V must be below maximum = {maximum} V"),
            });
        }
        if let Self::SoftTorque(law) = self {
            let (impedance, motor) = (law.gains.impedance.value(), law.motor_impedance().value());
            if impedance >= motor {
                return Err(ParameterError::Inconsistent {
                    section: SOFT_TORQUE.into(),
                    message: format!(
                        "impedance = {impedance} N.m.s/rad must be below that of the motor at constant voltage, \
                         ratio² torque_constant back_emf_constant/resistance = {motor} N.m.s/rad: a \
                         controller can only make the drive softer"
                    ),
                });
            }
        }
        Ok(())
    }

    /// The law as numbers.
    pub fn gains(&self) -> Gains<S> {
        match self {
            Self::Speed(law) => law.gains(),
            Self::SoftTorque(law) => law.gains(),
        }
    }

    /// Whether the law needs this input.
    pub fn has(&self, input: Input) -> bool {
        input != Input::Current || matches!(self, Self::SoftTorque(_))
    }

    /// The same law over another kind of number, without derivatives.
    pub fn to_scalar<T: Scalar>(&self) -> ControlLaw<T> {
        match self {
            Self::Speed(law) => ControlLaw::Speed(SpeedController {
                gains: law.gains.to_scalar(),
                gearbox: law.gearbox.map(|gearbox| gearbox.to_scalar()),
                voltage: law.voltage.to_scalar(),
            }),
            Self::SoftTorque(law) => ControlLaw::SoftTorque(SoftTorque {
                gains: law.gains.to_scalar(),
                gearbox: law.gearbox.to_scalar(),
                motor: law.motor.to_scalar(),
                voltage: law.voltage.to_scalar(),
            }),
        }
    }
}

impl<S: Scalar> SpeedController<S> {
    fn gains(&self) -> Gains<S> {
        let factor = self
            .gearbox
            .map_or(S::constant(1.0), |gearbox| gearbox.ratio);
        let on_error = |gain: S| [gain, -gain, S::ZERO];
        Gains {
            direct: on_error(self.gains.kappa_p * factor),
            integral: on_error(self.gains.kappa_i * factor),
            filtered: [S::ZERO; INPUTS],
            through_filter: S::ZERO,
            filter_time: None,
            limits: [self.voltage.minimum, self.voltage.maximum],
        }
    }
}

impl<S: Scalar> SoftTorque<S> {
    /// Impedance [N m s/rad] of the motor at constant voltage, on the shaft side: η² K_T K_E/R.
    pub fn motor_impedance(&self) -> S {
        let ratio = self.gearbox.ratio;
        let motor = &self.motor;
        ratio * ratio * motor.torque_constant * motor.back_emf_constant / motor.resistance
    }

    fn gains(&self) -> Gains<S> {
        let ratio = self.gearbox.ratio;
        let back_emf = self.motor.back_emf_constant * ratio;
        let one = S::constant(1.0);
        let admittance = one / self.gains.impedance - one / self.motor_impedance();
        let integral = back_emf * self.gains.integral_rate;
        Gains {
            direct: [back_emf, S::ZERO, S::ZERO],
            integral: [integral, -integral, S::ZERO],
            filtered: [S::ZERO, S::ZERO, ratio * self.motor.torque_constant],
            through_filter: -(back_emf * admittance),
            filter_time: Some(self.gains.filter_time),
            limits: [self.voltage.minimum, self.voltage.maximum],
        }
    }
}
