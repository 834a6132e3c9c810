//! The rig as data: parts, friction law, effects, and its flat list of parameters.

use super::{
    ContactRadius, DISC1_EFFECT_NAMES, Disc, Disc1Effects, EFFECT_NAMES, Effects, EquationEffects,
    Gearbox, Motor, Shaft, effect_infos,
};
use crate::friction::Law;
use crate::parameter::{self, Parameter, ParameterError, ParameterInfo, Section};
use crate::series::Scalar;

/// Number of state variables of the largest rig.
pub const STATES: usize = 10;

/// Position of each state variable.
pub mod index {
    /// θ2, disc D2 [rad].
    pub const THETA: usize = 0;
    /// ω2 [rad/s].
    pub const OMEGA: usize = 1;
    /// θ3, gearbox output [rad].
    pub const THETA3: usize = 2;
    /// ω3 [rad/s].
    pub const OMEGA3: usize = 3;
    /// Armature current [A].
    pub const CURRENT: usize = 4;
    /// θ1, disc D1 [rad]; zero in the reduced rig.
    pub const THETA1: usize = 5;
    /// ω1 [rad/s]; zero in the reduced rig.
    pub const OMEGA1: usize = 6;
    /// Torque of the shaft's relaxing part [N m]; zero without shaft hysteresis.
    pub const RELAXING_TORQUE: usize = 7;
    /// Deflection of the bristles between D2 and its pin [rad]; zero while the disc slides and without
    /// presliding.
    pub const BRISTLE: usize = 8;
    /// The same on D1.
    pub const BRISTLE1: usize = 9;
}

/// Continuous state of a rig, at the positions of [`index`].
pub type RigState<S> = [S; STATES];

/// Which rig.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RigKind {
    /// Motor, gearbox, shaft and disc D2.
    Reduced,
    /// The same with disc D1 on a second shaft beyond D2.
    Full,
}

/// What the full rig has beyond the reduced one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc1<S> {
    /// Disc D1.
    pub disc: Disc<S>,
    /// Shaft between D2 and D1.
    pub shaft: Shaft<S>,
    /// Pin on D1.
    pub contact: ContactRadius<S>,
    /// Friction law of the pin on D1.
    pub law: Law<S>,
    /// Effects on D1 beyond the nominal rig.
    pub effects: Disc1Effects<S>,
}

/// A rig with all its numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rig<S> {
    /// Disc D2.
    pub disc: Disc<S>,
    /// Shaft between gearbox and D2.
    pub shaft: Shaft<S>,
    /// Gearbox.
    pub gearbox: Gearbox<S>,
    /// Motor.
    pub motor: Motor<S>,
    /// Pin on D2.
    pub contact: ContactRadius<S>,
    /// Friction law of the pin on D2.
    pub law: Law<S>,
    /// Disc D1 and its shaft and pin, if this is the full rig.
    pub disc1: Option<Disc1<S>>,
    /// Effects beyond the nominal rig.
    pub effects: Effects<S>,
    /// Effects that files describe by equations.
    pub equations: EquationEffects<S>,
}

impl<S: Scalar> Rig<S> {
    /// Reduced or full.
    pub fn kind(&self) -> RigKind {
        if self.disc1.is_some() {
            RigKind::Full
        } else {
            RigKind::Reduced
        }
    }

    /// All sections with their names, in the fixed order of the parameter list.
    pub fn sections(&self) -> Vec<(&'static str, &dyn Section<S>)> {
        let mut sections = self.coded_sections();
        for effect in self.equations.active() {
            sections.push((effect.definition.name(), effect));
        }
        sections
    }

    /// All sections but those of effects by equation.
    pub(super) fn coded_sections(&self) -> Vec<(&'static str, &dyn Section<S>)> {
        let mut sections: Vec<(&'static str, &dyn Section<S>)> = vec![
            ("disc", &self.disc),
            ("shaft", &self.shaft),
            ("gearbox", &self.gearbox),
            ("motor", &self.motor),
            ("contact", &self.contact),
            ("contact", self.law.section()),
        ];
        if let Some(disc1) = &self.disc1 {
            sections.push(("disc1", &disc1.disc));
            sections.push(("shaft1", &disc1.shaft));
            sections.push(("contact1", &disc1.contact));
            sections.push(("contact1", disc1.law.section()));
            sections.extend(disc1.effects.active());
        }
        sections.extend(self.effects.active());
        sections
    }

    fn sections_mut(&mut self) -> Vec<(&'static str, &mut dyn Section<S>)> {
        let mut sections: Vec<(&'static str, &mut dyn Section<S>)> = vec![
            ("disc", &mut self.disc),
            ("shaft", &mut self.shaft),
            ("gearbox", &mut self.gearbox),
            ("motor", &mut self.motor),
            ("contact", &mut self.contact),
            ("contact", self.law.section_mut()),
        ];
        if let Some(disc1) = &mut self.disc1 {
            sections.push(("disc1", &mut disc1.disc));
            sections.push(("shaft1", &mut disc1.shaft));
            sections.push(("contact1", &mut disc1.contact));
            sections.push(("contact1", disc1.law.section_mut()));
            sections.extend(disc1.effects.active_mut());
        }
        sections.extend(self.effects.active_mut());
        for effect in self.equations.active_mut() {
            sections.push((effect.definition.name(), effect));
        }
        sections
    }

    /// Whether any effect that is on needs series of its own beside the rig's.
    pub(super) fn needs_effect_series(&self) -> bool {
        let on_disc1 = self.disc1.as_ref();
        self.effects.need_series()
            || on_disc1.is_some_and(|disc1| disc1.effects.need_series())
            || self.equations.active().next().is_some()
    }

    /// Names of all effects that this rig can have, as `model.toml` spells their sections.
    pub fn effect_names(&self) -> impl Iterator<Item = &'static str> + use<S> {
        let disc1 = self.disc1.as_ref().map_or(&[][..], |_| DISC1_EFFECT_NAMES);
        let known = self.equations.known();
        let by_equation: Vec<&str> = known.map(|effect| effect.definition.name()).collect();
        EFFECT_NAMES.iter().chain(disc1).copied().chain(by_equation)
    }

    /// Switches the effect `name` on with the values that `value` gives; `None` if this rig can have no such effect.
    pub fn insert_effect<E>(
        &mut self,
        name: &str,
        mut value: impl FnMut(&'static ParameterInfo) -> Result<S, E>,
    ) -> Option<Result<(), E>> {
        if let Some(inserted) = self.effects.insert(name, &mut value) {
            return Some(inserted);
        }
        let disc1 = self.disc1.as_mut();
        let inserted = disc1.and_then(|disc1| disc1.effects.insert(name, &mut value));
        inserted.or_else(|| self.equations.insert(name, value))
    }

    /// Switches the effect `name` off; whether it was on.
    pub fn remove_effect(&mut self, name: &str) -> bool {
        let disc1 = self.disc1.as_mut();
        self.effects.remove(name)
            || disc1.is_some_and(|disc1| disc1.effects.remove(name))
            || self.equations.remove(name)
    }

    /// Parameters of the effect `name`, on or off; `None` if this rig can have no such effect.
    pub fn effect_infos(&self, name: &str) -> Option<&'static [ParameterInfo]> {
        let by_equation = || {
            let mut known = self.equations.known();
            known.find(|effect| effect.definition.name() == name)
        };
        effect_infos(name).or_else(|| by_equation().map(|effect| effect.definition.infos()))
    }

    /// Dry friction torque of the bearings of D2.
    pub(super) fn bearing_torque(&self) -> S {
        let bearing = self.effects.bearing_friction.as_ref();
        bearing.map_or(S::ZERO, |bearing| bearing.torque)
    }

    /// Viscous damping of the motor, on its own side.
    pub(super) fn motor_viscous_damping(&self) -> S {
        let mut damping = self.motor.viscous_damping;
        if let Some(extra) = &self.effects.motor_viscous {
            damping += extra.coefficient;
        }
        damping
    }

    /// All parameters in a fixed order.
    pub fn parameters(&self) -> Vec<Parameter> {
        parameter::parameters(&self.sections())
    }

    /// Value of the parameter at this position of [`Self::parameters`].
    pub fn parameter_at(&self, position: usize) -> Option<S> {
        parameter::value_at(&self.sections(), position)
    }

    /// Value of the parameter with this dotted name.
    pub fn parameter(&self, name: &str) -> Option<S> {
        self.parameter_at(self.position(name)?)
    }

    /// Position of the parameter with this dotted name in [`Self::parameters`].
    pub fn position(&self, name: &str) -> Option<usize> {
        parameter::position(&self.sections(), name)
    }

    /// Replaces a parameter by position after checking its range.
    pub fn set_parameter_at(&mut self, position: usize, value: S) -> Result<(), ParameterError> {
        parameter::set_at(self.sections_mut(), position, value)
    }

    /// Replaces a parameter by dotted name after checking its range.
    pub fn set_parameter(&mut self, name: &str, value: S) -> Result<(), ParameterError> {
        let position = self.position(name).ok_or_else(|| ParameterError::Unknown {
            name: name.to_owned(),
        })?;
        self.set_parameter_at(position, value)
    }

    /// Checks every range and every relation between parameters.
    pub fn check(&self) -> Result<(), ParameterError> {
        parameter::check(&self.sections())?;
        self.law.check("contact")?;
        if let Some(disc1) = &self.disc1 {
            disc1.law.check("contact1")?;
        }
        self.check_bristles()?;
        self.check_equations()
    }

    /// Checks that effects by equation act on parts that there are.
    fn check_equations(&self) -> Result<(), ParameterError> {
        self.equations.check()?;
        let stray = self
            .equations
            .known()
            .find(|effect| effect.definition.port().is_on_disc1() && self.disc1.is_none());
        let Some(effect) = stray else {
            return Ok(());
        };
        Err(ParameterError::Inconsistent {
            section: format!("effect {}", effect.definition.name()),
            message: format!(
                "port = \"{}\" is a place of the full rig; this one has no disc D1",
                effect.definition.port().name()
            ),
        })
    }

    /// The same rig over another kind of number, without derivatives.
    pub fn to_scalar<T: Scalar>(&self) -> Rig<T> {
        Rig {
            disc: self.disc.to_scalar(),
            shaft: self.shaft.to_scalar(),
            gearbox: self.gearbox.to_scalar(),
            motor: self.motor.to_scalar(),
            contact: self.contact.to_scalar(),
            law: self.law.to_scalar(),
            disc1: self.disc1.map(|disc1| Disc1 {
                disc: disc1.disc.to_scalar(),
                shaft: disc1.shaft.to_scalar(),
                contact: disc1.contact.to_scalar(),
                law: disc1.law.to_scalar(),
                effects: disc1.effects.to_scalar(),
            }),
            effects: self.effects.to_scalar(),
            equations: self.equations.to_scalar(),
        }
    }
}

impl Rig<f64> {
    /// Motor voltage [V] that turns the undisturbed rig at `speed` [rad/s] at the gearbox output:
    /// u = R (C_m η ω + T_fm sign ω)/K_T + K_E η ω.
    pub fn voltage_for_speed(&self, speed: f64) -> f64 {
        let motor = &self.motor;
        let motor_speed = self.gearbox.ratio * speed;
        let direction = if speed == 0.0 { 0.0 } else { speed.signum() };
        motor.resistance * (motor.viscous_damping * motor_speed + motor.coulomb_torque * direction)
            / motor.torque_constant
            + motor.back_emf_constant * motor_speed
    }
}
