//! Units of the plant itself, in which every comparison of the engine is made.
//!
//! The disc has inertia 1 and its shaft stiffness 1, so that the shaft's natural frequency is 1 rad per unit of time; the
//! armature's resistance is 1, and the normal force is 50 where the records load the pin as they do on average. Two cases that
//! differ by the size of their masses, torques, forces, voltages and times alone are the same case here.

use stickslip::friction::Law;
use stickslip::parameter::units::Unit;
use stickslip::parameter::{Parameter, ParameterError};
use stickslip::plant::{Rig, RigState, STATES, SiUnits, index};

/// The normal force to which the library's load exponent refers, in its own equation [N].
const REFERENCE_FORCE: f64 = 50.0;

/// SI values of the plant's own units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlantUnits {
    /// Unit of time [s]: one radian of the shaft's natural oscillation.
    pub time: f64,
    /// Unit of torque [N m]: that of the shaft at a twist of one radian.
    pub torque: f64,
    /// Unit of force [N].
    pub force: f64,
    /// Unit of current [A].
    pub current: f64,
}

impl PlantUnits {
    /// Units of `rig`, whose pin the records load with `load` [N] on average; `None` where they never do.
    #[must_use]
    pub fn of(rig: &Rig<f64>, load: Option<f64>) -> Self {
        let torque = rig.shaft.stiffness;
        let time = (rig.disc.inertia / torque).sqrt();
        let force = load.map_or(torque / rig.contact.radius, |load| load / REFERENCE_FORCE);
        Self {
            time,
            torque,
            force,
            current: (torque / (time * rig.motor.resistance)).sqrt(),
        }
    }

    /// Unit of voltage [V].
    #[must_use]
    pub fn voltage(&self) -> f64 {
        self.torque / (self.time * self.current)
    }

    /// SI value of one unit of this parameter.
    #[must_use]
    pub fn of_parameter(&self, name: &str, unit: &str) -> f64 {
        if name.ends_with("rate_per_minute") {
            return 1.0 / self.time;
        }
        let Ok(unit) = Unit::parse(unit) else {
            return 1.0;
        };
        let length = self.torque / self.force;
        let mass = self.torque * (self.time / length).powi(2);
        mass.powi(unit.base.kg)
            * length.powi(unit.base.m)
            * self.time.powi(unit.base.s)
            * self.current.powi(unit.base.a)
    }

    /// SI values of the units of the state's components.
    #[must_use]
    pub fn of_state(&self) -> [f64; STATES] {
        let mut units = [1.0; STATES];
        for velocity in [index::OMEGA, index::OMEGA3, index::OMEGA1] {
            units[velocity] = 1.0 / self.time;
        }
        units[index::CURRENT] = self.current;
        units[index::RELAXING_TORQUE] = self.torque;
        units
    }

    /// A state in SI units.
    #[must_use]
    pub fn state_to_si(&self, state: &RigState<f64>) -> RigState<f64> {
        let units = self.of_state();
        std::array::from_fn(|j| state[j] * units[j])
    }

    /// A rig in these units.
    ///
    /// # Errors
    /// A number leaves the range that its unit gives it.
    pub fn to_plant(&self, rig: &Rig<f64>) -> Result<Rig<f64>, ParameterError> {
        let equations = SiUnits {
            time: self.time,
            torque: self.torque,
            force: self.force,
            current: self.current,
            voltage: self.voltage(),
        };
        self.converted(rig, |value, unit| value / unit, self.level(rig), equations)
    }

    /// A rig in SI units.
    ///
    /// # Errors
    /// A number leaves the range that its unit gives it.
    pub fn to_si(&self, rig: &Rig<f64>) -> Result<Rig<f64>, ParameterError> {
        let level = 1.0 / self.level(rig);
        self.converted(rig, |value, unit| value * unit, level, SiUnits::SI)
    }

    /// SI value of one unit of a parameter of `rig`: of its friction law's levels too, which a load exponent refers to 50 N.
    #[must_use]
    pub fn of_parameter_in(&self, rig: &Rig<f64>, parameter: &Parameter) -> f64 {
        let unit = self.si_value(rig, parameter);
        if is_level(&parameter.name) {
            unit / self.level(rig)
        } else {
            unit
        }
    }

    /// The same without the level of friction. Equations of a model file stay in SI units, whatever those of their rig are.
    fn si_value(&self, rig: &Rig<f64>, parameter: &Parameter) -> f64 {
        let mut equations = rig.equations.known();
        if equations.any(|effect| effect.definition.name() == parameter.section) {
            1.0
        } else {
            self.of_parameter(&parameter.name, parameter.info.unit)
        }
    }

    /// Factor on the levels of the friction law, which a load exponent refers to 50 units of force.
    fn level(&self, rig: &Rig<f64>) -> f64 {
        match (&rig.effects.load_exponent, &rig.law) {
            (None, _) | (_, Law::TwoGaussianTorque(_)) => 1.0,
            (Some(effect), _) => self.force.powf(effect.exponent - 1.0),
        }
    }

    fn converted(
        &self,
        rig: &Rig<f64>,
        convert: impl Fn(f64, f64) -> f64,
        level: f64,
        equations: SiUnits,
    ) -> Result<Rig<f64>, ParameterError> {
        let mut converted = *rig;
        converted.equations.units = equations;
        for (position, parameter) in rig.parameters().iter().enumerate() {
            let Some(value) = rig.parameter_at(position) else {
                continue;
            };
            let mut value = convert(value, self.si_value(rig, parameter));
            if is_level(&parameter.name) {
                value *= level;
            }
            converted.set_parameter_at(position, value)?;
        }
        Ok(converted)
    }
}

/// Whether this is a level of a friction law.
pub(crate) fn is_level(name: &str) -> bool {
    matches!(
        name,
        "contact.mu_c" | "contact.mu_s" | "contact.a1" | "contact.a2"
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use stickslip::integrator::{Options, Simulation};
    use stickslip::plant::RigInputs;

    #[test]
    fn a_run_in_plant_units_is_the_run_in_si_units() {
        let text = include_str!("../../../modelDescription/reduced-rig.toml");
        let text = format!(
            "{text}\n[load_exponent]\nexponent = 0.8\n[friction_wear]\nrate_per_minute = 0.7\n[unbalance]\ntorque = 0.05\nphase = 0.4\n\
             [[effect]]\nname = \"pull\"\ntitle = \"pull\"\nport = \"motor.voltage\"\nequation = \"-drop*current*time/(1 + abs(time)/span) - lag*velocity\"\n\
             parameters.drop = {{ value = 0.03, unit = \"Ohm/s\", description = \"drop\" }}\n\
             parameters.span = {{ value = 3, unit = \"s\", range = \"positive\", description = \"span\" }}\n\
             parameters.lag = {{ value = 0.001, unit = \"V.s/rad\", description = \"lag\" }}\n\
             [[effect]]\nname = \"rub\"\ntitle = \"rub\"\nport = \"disc.torque\"\nequation = \"-rub*load*velocity*abs(velocity)\"\n\
             parameters.rub = {{ value = 1e-5, unit = \"m.s2/rad2\", description = \"rub\" }}\n"
        );
        let rig = Rig::from_toml(&text, "rig").unwrap();
        let units = PlantUnits::of(&rig, Some(37.0));
        let plant = units.to_plant(&rig).unwrap();
        assert!((plant.disc.inertia - 1.0).abs() < 1e-12);
        assert!((plant.motor.resistance - 1.0).abs() < 1e-12);
        let back = units.to_si(&plant).unwrap();
        for parameter in rig.parameters() {
            let (a, b) = (
                rig.parameter(&parameter.name),
                back.parameter(&parameter.name),
            );
            let (a, b) = (a.unwrap(), b.unwrap());
            assert!(
                (a - b).abs() <= 1e-12 * a.abs(),
                "{}: {a} {b}",
                parameter.name
            );
        }
        let end = 8.0;
        let run = |rig, voltage, force, end| {
            let inputs = RigInputs::held(voltage, force, 0.0);
            let mut run =
                Simulation::new(rig, Options::default(), 0.0, [0.0; STATES], inputs).unwrap();
            run.advance_to(end).unwrap();
            run.state_at(end)
        };
        let si = run(rig, 3.2, 42.0, end);
        let own = units.state_to_si(&run(
            plant,
            3.2 / units.voltage(),
            42.0 / units.force,
            end / units.time,
        ));
        for (a, b) in si.iter().zip(own) {
            assert!((a - b).abs() < 1e-7, "{a} {b}");
        }
    }
}
