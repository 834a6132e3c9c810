//! Reads a small plant's model file: sections, numbers, effects, and what is wrong with them.

use std::collections::BTreeMap;
use std::path::PathBuf;

use serde::Deserialize;
use stickslip::parameter::Range;
use toml::Value;

use super::base::{PARAMETERS, base, of_fmu};
use super::catalogue::{CATALOGUE, entry};
use super::columns::Columns;
use super::effect_file::Described;
use super::fmu::ports::Ports;
use super::model::Model;
use super::model_file::{Measurement, Origin, SmallModel, SmallModelError, dotted};
use super::term::{Entry, MOST_PARAMETERS, Parameter};
use super::unit::{Dimension, Kind, Path, plain};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PlantSection {
    kind: String,
    path: String,
    fmu: Option<PathBuf>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct NumberTable {
    value: f64,
    unit: Option<String>,
    source: Option<String>,
    #[serde(rename = "status")]
    _status: Option<String>,
    relative_uncertainty: Option<f64>,
    interval95: Option<[f64; 2]>,
}

/// Sections of effects that the file itself describes.
const OWN_EFFECTS: &str = "effect";

/// A model file's table, and its name in messages.
pub(super) struct Reader<'a> {
    pub table: toml::Table,
    pub file: &'a str,
}

impl Reader<'_> {
    pub fn read(&self) -> Result<SmallModel, SmallModelError> {
        let plant: PlantSection = self.section(
            "plant",
            "kind = \"drive\", \"pendulum\", \"contact\", \"balance\", \"joint\" or \"fmu\" and path = \"line\" or \"turn\"",
        )?;
        let kind = self.word("kind", &plant.kind, &Kind::ALL, Kind::word)?;
        let path = self.word("path", &plant.path, &[Path::Line, Path::Turn], Path::word)?;
        if kind.runs_alone() && path == Path::Line {
            let right = format!("\"turn\": a {} turns", kind.word());
            return Err(self.wrong("plant", "path", "\"line\"", &right));
        }
        let columns: Columns = self.section(
            "columns",
            "lines such as time = { column = \"t\", unit = \"s\" }, for time, position, velocity, force, load, predicted, voltage, duty, supply, connected",
        )?;
        columns
            .check(kind, path)
            .map_err(|source| SmallModelError::Column {
                file: self.file.to_owned(),
                source,
            })?;
        let measurement: Measurement = self.section(
            "measurement",
            "motion_low_pass [Hz], compare_rate [Hz] and, if need be, compare_low_pass [Hz], edge [s] and standstill_speed",
        )?;
        self.check_measurement(&measurement)?;
        self.check_sections(kind, path, columns.load.is_some())?;
        let mut origins = BTreeMap::new();
        let ports = match kind {
            Kind::Fmu => Some(self.ports(plant.fmu)?),
            _ if plant.fmu.is_some() => {
                return Err(SmallModelError::Unknown {
                    file: self.file.to_owned(),
                    what: format!("key fmu in the model of a {}", kind.word()),
                    known: "kind and path".to_owned(),
                });
            }
            _ => None,
        };
        let base = match base(kind) {
            Some(base) => base,
            None => of_fmu(self.parameters()?),
        };
        let mut model = Model::new(
            kind,
            path,
            base,
            self.values(base, kind, path, &mut origins)?,
        );
        for name in self.table.keys() {
            if let Some(effect) = entry(name) {
                model = model.with(effect, self.values(effect, kind, path, &mut origins)?);
            }
        }
        for described in self.own_effects()? {
            let (entry, values) =
                self.own_effect(&described, &model, columns.load.is_some(), &mut origins)?;
            model = model.with(entry, values);
        }
        Ok(SmallModel {
            model,
            columns,
            measurement,
            ports,
            origins,
        })
    }

    /// The sections `[[effect]]`.
    fn own_effects(&self) -> Result<Vec<Described>, SmallModelError> {
        let Some(list) = self.table.get(OWN_EFFECTS) else {
            return Ok(Vec::new());
        };
        list.clone()
            .try_into()
            .map_err(|error: toml::de::Error| SmallModelError::Syntax {
                file: self.file.to_owned(),
                message: format!(
                    "[[effect]]: {}; it needs name, title, port, equation and parameters",
                    error.message()
                ),
            })
    }

    /// An effect that a section `[[effect]]` describes, with its numbers.
    fn own_effect(
        &self,
        described: &Described,
        model: &Model,
        has_load: bool,
        origins: &mut BTreeMap<String, Origin>,
    ) -> Result<(&'static Entry, Vec<f64>), SmallModelError> {
        let entry = described.entry(self.file, model.kind, model.path)?;
        let section = format!("effect {}", entry.name);
        if model.has(entry.name) || CATALOGUE.iter().any(|own| own.name == entry.name) {
            let found = format!("{:?}", entry.name);
            return Err(self.wrong(&section, "name", &found, "a name that no effect has yet"));
        }
        if entry.needs_load && !has_load {
            let expected = "without load, since [columns] has none";
            let found = entry.equation().unwrap_or_default();
            return Err(self.wrong(&section, "equation", &format!("{found:?}"), expected));
        }
        let mut values = Vec::new();
        for parameter in entry.parameters {
            let number = &described.parameters[parameter.key];
            let value = number.value.ok_or_else(|| SmallModelError::Missing {
                file: self.file.to_owned(),
                section: section.clone(),
                key: format!("parameters.{}.value", parameter.key),
                expected: format!(
                    "{} [{}]",
                    parameter.description,
                    parameter.dimension.unit(model.kind, model.path)
                ),
            })?;
            values.push(value);
            let origin = Origin {
                relative_uncertainty: number.relative_uncertainty,
                source: number.source.clone(),
                interval95: number.interval95,
            };
            origins.insert(dotted(&entry, parameter.key), origin);
        }
        // An entry lives as long as the program, as those of the catalogue do.
        Ok((Box::leak(Box::new(entry)), values))
    }

    /// What an FMU's file has beside the other kinds'.
    fn ports(&self, fmu: Option<PathBuf>) -> Result<Ports, SmallModelError> {
        Ok(Ports {
            fmu,
            port: self.section(
                "port",
                "input, the FMU's input at which a force acts, and position, velocity or both, its outputs there",
            )?,
            inputs: self.optional(
                "inputs",
                "lines such as u = { column = \"voltage\", unit = \"V\", between = \"linear\" }",
            )?,
            start: self.optional("start", "lines such as phi_start = \"position\"")?,
        })
    }

    /// An FMU's uncertain parameters.
    fn parameters(&self) -> Result<Vec<Parameter>, SmallModelError> {
        let table: BTreeMap<String, NumberTable> = self.optional(
            PARAMETERS,
            "lines such as inertia = { value = 0.1, unit = \"kg.m2\", relative_uncertainty = 0.05 }",
        )?;
        if table.len() > MOST_PARAMETERS {
            return Err(self.wrong(
                PARAMETERS,
                "number of lines",
                &table.len().to_string(),
                &format!("{MOST_PARAMETERS} or fewer: give those that are least certain"),
            ));
        }
        let leaked = |text: String| -> &'static str { text.leak() };
        table
            .into_iter()
            .map(|(key, number)| {
                let size = match (number.relative_uncertainty, number.interval95) {
                    (Some(share), _) => number.value * share,
                    (None, Some([low, high])) => 0.5 * (high - low) / 1.96,
                    (None, None) => 0.0,
                };
                if !(size.abs() > 0.0 && size.is_finite()) {
                    return Err(self.wrong(
                        PARAMETERS,
                        &key,
                        &number.value.to_string(),
                        "a number with relative_uncertainty above 0, or an interval95",
                    ));
                }
                Ok(Parameter {
                    key: leaked(key),
                    dimension: Dimension::Own {
                        unit: leaked(number.unit.unwrap_or_default()),
                        size: size.abs(),
                    },
                    range: Range::Finite,
                    description: "uncertain parameter of the FMU",
                    guess: None,
                })
            })
            .collect()
    }

    fn optional<T: serde::de::DeserializeOwned + Default>(
        &self,
        name: &str,
        expected: &str,
    ) -> Result<T, SmallModelError> {
        if self.table.contains_key(name) {
            self.section(name, expected)
        } else {
            Ok(T::default())
        }
    }

    fn section<T: serde::de::DeserializeOwned>(
        &self,
        name: &str,
        expected: &str,
    ) -> Result<T, SmallModelError> {
        let value = self
            .table
            .get(name)
            .ok_or_else(|| SmallModelError::Missing {
                file: self.file.to_owned(),
                section: name.to_owned(),
                key: "everything".to_owned(),
                expected: expected.to_owned(),
            })?;
        value
            .clone()
            .try_into()
            .map_err(|error: toml::de::Error| SmallModelError::Syntax {
                file: self.file.to_owned(),
                message: format!("[{name}]: {}; it needs {expected}", error.message()),
            })
    }

    fn word<T: Copy>(
        &self,
        key: &str,
        found: &str,
        all: &[T],
        of: fn(T) -> &'static str,
    ) -> Result<T, SmallModelError> {
        all.iter()
            .copied()
            .find(|choice| of(*choice) == found)
            .ok_or_else(|| {
                let words: Vec<&str> = all.iter().map(|choice| of(*choice)).collect();
                self.wrong(
                    "plant",
                    key,
                    &format!("{found:?}"),
                    &format!("one of {}", words.join(", ")),
                )
            })
    }

    fn check_measurement(&self, measurement: &Measurement) -> Result<(), SmallModelError> {
        let numbers = [
            ("motion_low_pass", Some(measurement.motion_low_pass)),
            ("compare_low_pass", measurement.compare_low_pass),
            ("compare_rate", Some(measurement.compare_rate)),
        ];
        for (key, number) in numbers {
            if let Some(number) = number
                && !(number.is_finite() && number > 0.0)
            {
                return Err(self.wrong(
                    "measurement",
                    key,
                    &number.to_string(),
                    "a number above 0 [Hz]",
                ));
            }
        }
        for (key, number) in [
            ("edge", measurement.edge),
            ("standstill_speed", measurement.standstill_speed),
        ] {
            if !(number.is_finite() && number >= 0.0) {
                return Err(self.wrong(
                    "measurement",
                    key,
                    &number.to_string(),
                    "a number of 0 or more",
                ));
            }
        }
        Ok(())
    }

    fn check_sections(
        &self,
        kind: Kind,
        path: Path,
        has_load: bool,
    ) -> Result<(), SmallModelError> {
        let base = base(kind).map_or(PARAMETERS, |entry| entry.name);
        let own: &[&str] = if kind == Kind::Fmu {
            &["port", "inputs", "start"]
        } else {
            &[]
        };
        let possible = || {
            CATALOGUE
                .iter()
                .filter(|entry| entry.fits(kind, path, has_load))
                .map(|entry| entry.name)
        };
        for section in self.table.keys() {
            let known = [&["plant", "columns", "measurement", OWN_EFFECTS, base], own].concat();
            if !known.contains(&section.as_str()) && !possible().any(|name| name == section) {
                return Err(SmallModelError::Unknown {
                    file: self.file.to_owned(),
                    what: format!("section [{section}] in the model of a {}", kind.word()),
                    known: known
                        .into_iter()
                        .chain(possible())
                        .collect::<Vec<_>>()
                        .join(", "),
                });
            }
        }
        Ok(())
    }

    fn values(
        &self,
        entry: &Entry,
        kind: Kind,
        path: Path,
        origins: &mut BTreeMap<String, Origin>,
    ) -> Result<Vec<f64>, SmallModelError> {
        let expected = || {
            let parameters = entry.parameters.iter();
            parameters
                .map(|p| {
                    format!(
                        "{} [{}], {}",
                        p.key,
                        p.dimension.unit(kind, path),
                        p.description
                    )
                })
                .collect::<Vec<_>>()
                .join("; ")
        };
        let missing = |key: &str| SmallModelError::Missing {
            file: self.file.to_owned(),
            section: entry.name.to_owned(),
            key: key.to_owned(),
            expected: expected(),
        };
        let nothing = toml::Table::new();
        let table = match self.table.get(entry.name).and_then(Value::as_table) {
            Some(table) => table,
            None if entry.parameters.is_empty() => &nothing,
            None => return Err(missing("everything")),
        };
        if let Some(key) = table
            .keys()
            .find(|key| !entry.parameters.iter().any(|p| p.key == **key))
        {
            return Err(SmallModelError::Unknown {
                file: self.file.to_owned(),
                what: format!("key {key} in [{}]", entry.name),
                known: expected(),
            });
        }
        let mut values = Vec::new();
        for parameter in entry.parameters {
            let value = table
                .get(parameter.key)
                .ok_or_else(|| missing(parameter.key))?;
            let (number, origin) = match value {
                Value::Float(number) => (*number, Origin::default()),
                Value::Integer(number) => (*number as f64, Origin::default()),
                other => self.number(
                    entry.name,
                    parameter.key,
                    other,
                    parameter.dimension.unit(kind, path),
                )?,
            };
            if !parameter.range.contains(number) {
                let expected = parameter.range.to_string();
                return Err(self.wrong(entry.name, parameter.key, &number.to_string(), &expected));
            }
            values.push(number);
            origins.insert(dotted(entry, parameter.key), origin);
        }
        Ok(values)
    }

    fn number(
        &self,
        section: &str,
        key: &str,
        value: &Value,
        unit: &str,
    ) -> Result<(f64, Origin), SmallModelError> {
        let expected = format!("a number or {{ value = …, unit = \"{unit}\", source = … }}");
        let table: NumberTable = value
            .clone()
            .try_into()
            .map_err(|_| self.wrong(section, key, &value.to_string(), &expected))?;
        if let Some(found) = &table.unit
            && plain(found) != plain(unit)
        {
            return Err(self.wrong(
                section,
                &format!("{key}.unit"),
                &format!("{found:?}"),
                &format!("\"{unit}\""),
            ));
        }
        let origin = Origin {
            relative_uncertainty: table.relative_uncertainty,
            source: table.source,
            interval95: table.interval95,
        };
        Ok((table.value, origin))
    }

    fn wrong(&self, section: &str, key: &str, found: &str, expected: &str) -> SmallModelError {
        SmallModelError::Value {
            file: self.file.to_owned(),
            section: section.to_owned(),
            key: key.to_owned(),
            found: found.to_owned(),
            expected: expected.to_owned(),
        }
    }
}
