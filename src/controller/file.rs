//! A controller's `model.toml`.

use super::law::{
    ControlLaw, MotorConstants, SOFT_TORQUE, SPEED_CONTROLLER, SoftTorque, SoftTorqueGains,
    SpeedController, SpeedGains, VoltageLimits,
};
use crate::parameter::{ModelFileError, SectionReader};
use crate::plant::Gearbox;
use toml::Value;

/// Key that says which speed the gains of a [`SpeedController`] act on.
const SPEED: &str = "speed";
const SPEEDS: [&str; 2] = ["gearbox_output", "motor"];

/// Whether the text of a model file describes a controller.
pub fn is_controller(text: &str) -> bool {
    let sections = text.parse::<toml::Table>();
    sections.is_ok_and(|t| t.contains_key(SPEED_CONTROLLER) || t.contains_key(SOFT_TORQUE))
}

impl ControlLaw<f64> {
    /// The controller of a model file's text; `file` names it in messages.
    ///
    /// # Errors
    /// What is wrong, with file, section and key.
    pub fn from_toml(text: &str, file: &str) -> Result<Self, ModelFileError> {
        let mut reader = SectionReader::new(text, file)?;
        let law = if reader.table.contains_key(SOFT_TORQUE) {
            Self::SoftTorque(reader.soft_torque()?)
        } else {
            Self::Speed(reader.speed_controller()?)
        };
        law.check().map_err(|source| ModelFileError::Parameter {
            file: file.to_owned(),
            source,
        })?;
        Ok(law)
    }
}

impl SectionReader<'_> {
    fn speed_controller(&mut self) -> Result<SpeedController<f64>, ModelFileError> {
        let gains = self.values(SPEED_CONTROLLER, SpeedGains::<f64>::INFOS, &[SPEED])?;
        let gains = SpeedGains::from_values(gains)?;
        let on_motor = self.controlled_speed()? == "motor";
        // The ratio has no meaning where the motor's speed is not controlled: refused then.
        let mut known = vec![SPEED_CONTROLLER, "voltage"];
        known.extend(on_motor.then_some("gearbox"));
        self.check_sections(&known)?;
        let gearbox = if on_motor {
            Some(self.gearbox()?)
        } else {
            None
        };
        Ok(SpeedController {
            gains,
            gearbox,
            voltage: self.voltage()?,
        })
    }

    fn soft_torque(&mut self) -> Result<SoftTorque<f64>, ModelFileError> {
        self.check_sections(&[SOFT_TORQUE, "gearbox", "motor", "voltage"])?;
        let gains = self.values(SOFT_TORQUE, SoftTorqueGains::<f64>::INFOS, &[])?;
        let motor = self.values("motor", MotorConstants::<f64>::INFOS, &[])?;
        Ok(SoftTorque {
            gains: SoftTorqueGains::from_values(gains)?,
            gearbox: self.gearbox()?,
            motor: MotorConstants::from_values(motor)?,
            voltage: self.voltage()?,
        })
    }

    fn gearbox(&mut self) -> Result<Gearbox<f64>, ModelFileError> {
        Gearbox::from_values(self.values("gearbox", Gearbox::<f64>::INFOS, &[])?)
    }

    fn voltage(&mut self) -> Result<VoltageLimits<f64>, ModelFileError> {
        VoltageLimits::from_values(self.values("voltage", VoltageLimits::<f64>::INFOS, &[])?)
    }

    fn controlled_speed(&self) -> Result<String, ModelFileError> {
        let expected = format!("one of {}", SPEEDS.join(", "));
        let value = self
            .table
            .get(SPEED_CONTROLLER)
            .and_then(|section| section.get(SPEED));
        match value {
            Some(Value::String(name)) if SPEEDS.contains(&name.as_str()) => Ok(name.clone()),
            Some(other) => Err(self.wrong_type(SPEED_CONTROLLER, SPEED, other, &expected)),
            None => Err(ModelFileError::MissingKey {
                file: self.file.to_owned(),
                section: SPEED_CONTROLLER.into(),
                key: SPEED.into(),
                description: "the speed that the gains act on".into(),
                unit: expected,
            }),
        }
    }
}
