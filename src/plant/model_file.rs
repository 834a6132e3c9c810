//! `model.toml`: a rig with its numbers, where they come from, and its effects.

use super::equation::{read_effects, write_effect};
use super::{
    ContactRadius, DISC1_EFFECT_NAMES, Disc, Disc1, Disc1Effects, EFFECT_NAMES, Effects, Gearbox,
    Motor, Rig, Shaft, effect_infos,
};
use crate::friction::{LAW_NAMES, Law};
use crate::parameter::{ModelFileError, Provenance, SectionReader};
use std::collections::BTreeMap;
use std::fmt::Write;
use toml::Value;

/// A rig as read from a file, with the provenance of its numbers by dotted name.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelFile {
    /// The rig.
    pub rig: Rig<f64>,
    /// Provenance of those numbers that state any.
    pub provenance: BTreeMap<String, Provenance>,
}

const DISC1_PARTS: [&str; 3] = ["disc1", "shaft1", "contact1"];
/// Sections that are no effects.
pub(super) const SECTIONS: [&str; 9] = [
    "disc", "shaft", "gearbox", "motor", "contact", "disc1", "shaft1", "contact1", "effect",
];

impl ModelFile {
    /// Reads the text of a model file; `file` names it in messages.
    pub fn parse(text: &str, file: &str) -> Result<Self, ModelFileError> {
        let mut reader = SectionReader::new(text, file)?;
        let mut known = [&SECTIONS[..], EFFECT_NAMES].concat();
        // Effects on a disc that is not there are none.
        if reader.is_full() {
            known.extend(DISC1_EFFECT_NAMES);
        }
        reader.check_sections(&known)?;
        let rig = reader.rig()?;
        rig.check().map_err(|source| ModelFileError::Parameter {
            file: file.to_owned(),
            source,
        })?;
        Ok(Self {
            rig,
            provenance: reader.provenance,
        })
    }

    /// The file's text: every number with unit, description and provenance.
    pub fn to_toml(&self) -> String {
        let mut text = String::from(
            "# A stickslip model. SI units, shaft side of the gearbox unless named motor.\n",
        );
        let mut open = "";
        for (section, values) in self.rig.coded_sections() {
            if section != open {
                let _ = writeln!(text, "\n[{section}]");
                open = section;
            } else if section.starts_with("contact") {
                let law = if section == "contact" {
                    self.rig.law.name()
                } else {
                    self.rig.disc1.as_ref().map_or("", |disc1| disc1.law.name())
                };
                let _ = writeln!(text, "law = \"{law}\"");
            }
            for (j, info) in values.infos().iter().enumerate() {
                let name = format!("{section}.{}", info.key);
                let value = write_number(values.get(j));
                let _ = writeln!(
                    text,
                    "{} = {} # {}, {}",
                    info.key,
                    write_value(&value, self.provenance.get(&name)),
                    info.description.trim(),
                    info.unit
                );
            }
        }
        for effect in self.rig.equations.active() {
            write_effect(&mut text, effect, &self.provenance);
        }
        text
    }
}

impl Rig<f64> {
    /// The rig of a model file's text; `file` names it in messages.
    pub fn from_toml(text: &str, file: &str) -> Result<Self, ModelFileError> {
        ModelFile::parse(text, file).map(|model| model.rig)
    }

    /// The text of a model file with this rig.
    pub fn to_toml(&self) -> String {
        ModelFile {
            rig: *self,
            provenance: BTreeMap::new(),
        }
        .to_toml()
    }
}

/// A number as TOML: always with a point or an exponent, exact on reading back.
pub(super) fn write_number(value: f64) -> String {
    format!("{value:?}")
}

fn write_value(value: &str, provenance: Option<&Provenance>) -> String {
    let Some(provenance) = provenance else {
        return value.to_owned();
    };
    format!("{{ value = {value}{} }}", provenance_keys(provenance))
}

/// The keys that state a provenance, each after a comma.
pub(super) fn provenance_keys(provenance: &Provenance) -> String {
    let mut text = String::new();
    if let Some(source) = &provenance.source {
        let _ = write!(text, ", source = {}", Value::String(source.clone()));
    }
    if let Some(status) = &provenance.status {
        let _ = write!(text, ", status = {}", Value::String(status.clone()));
    }
    if let Some(relative) = provenance.relative_uncertainty {
        let _ = write!(text, ", relative_uncertainty = {}", write_number(relative));
    }
    if let Some([low, high]) = provenance.interval95 {
        let (low, high) = (write_number(low), write_number(high));
        let _ = write!(text, ", interval95 = [{low}, {high}]");
    }
    text
}

impl SectionReader<'_> {
    fn rig(&mut self) -> Result<Rig<f64>, ModelFileError> {
        let (contact, law) = self.contact("contact")?;
        let disc = Disc::from_values(self.values("disc", Disc::<f64>::INFOS, &[])?)?;
        let shaft = Shaft::from_values(self.values("shaft", Shaft::<f64>::INFOS, &[])?)?;
        let gearbox = Gearbox::from_values(self.values("gearbox", Gearbox::<f64>::INFOS, &[])?)?;
        let motor = Motor::from_values(self.values("motor", Motor::<f64>::INFOS, &[])?)?;
        let disc1 = if self.is_full() {
            let (contact, law) = self.contact("contact1")?;
            Some(Disc1 {
                disc: Disc::from_values(self.values("disc1", Disc::<f64>::INFOS, &[])?)?,
                shaft: Shaft::from_values(self.values("shaft1", Shaft::<f64>::INFOS, &[])?)?,
                contact,
                law,
                effects: Disc1Effects::default(),
            })
        } else {
            None
        };
        let mut rig = Rig {
            disc,
            shaft,
            gearbox,
            motor,
            contact,
            law,
            disc1,
            effects: Effects::default(),
            equations: read_effects(self)?,
        };
        let coded: Vec<&str> = rig.effect_names().collect();
        for name in coded {
            if !self.table.contains_key(name) {
                continue;
            }
            let infos = effect_infos(name).unwrap_or(&[]);
            let values = self.values(name, infos, &[])?;
            if let Some(result) = rig.insert_effect(name, values) {
                result?;
            }
        }
        Ok(rig)
    }

    /// Whether the file describes the full rig.
    fn is_full(&self) -> bool {
        DISC1_PARTS
            .iter()
            .any(|part| self.table.contains_key(*part))
    }

    fn contact(&mut self, section: &str) -> Result<(ContactRadius<f64>, Law<f64>), ModelFileError> {
        let missing = || ModelFileError::MissingSection {
            file: self.file.to_owned(),
            section: section.to_owned(),
            keys: "radius, law and the law's parameters".to_owned(),
        };
        let table = self
            .table
            .get(section)
            .and_then(Value::as_table)
            .ok_or_else(missing)?;
        let expected = format!("one of {}", LAW_NAMES.join(", "));
        let name = match table.get("law") {
            Some(Value::String(name)) => name.clone(),
            Some(other) => return Err(self.wrong_type(section, "law", other, &expected)),
            None => {
                return Err(ModelFileError::MissingKey {
                    file: self.file.to_owned(),
                    section: section.to_owned(),
                    key: "law".to_owned(),
                    description: "friction law".to_owned(),
                    unit: expected,
                });
            }
        };
        let mut infos = ContactRadius::<f64>::INFOS.to_vec();
        let mut count = 0;
        // A first pass with zeros only asks the law which parameters it has.
        let shape = Law::<f64>::from_values(&name, |_| Ok::<_, ModelFileError>(0.0));
        let Some(Ok(shape)) = shape else {
            let value = Value::String(name);
            return Err(self.wrong_type(section, "law", &value, &expected));
        };
        for info in shape.section().infos() {
            infos.push(*info);
            count += 1;
        }
        debug_assert_eq!(infos.len(), count + ContactRadius::<f64>::INFOS.len());
        let mut values = self.values(section, &infos, &["law"])?;
        let radius = ContactRadius::from_values(&mut values)?;
        match Law::from_values(&name, values) {
            Some(law) => Ok((radius, law?)),
            None => Err(self.wrong_type(section, "law", &Value::String(name), &expected)),
        }
    }
}
