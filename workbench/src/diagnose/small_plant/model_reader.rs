//! Reads a small plant's model file: what the library reads, and beside it columns, measurement and what an FMU's has.

use std::collections::BTreeMap;
use std::path::PathBuf;

use serde::Deserialize;
use stickslip::body::{Dimension, FileError, Kind, OWN_EFFECTS, Parameter, Plant, Reader};
use stickslip::parameter::{Provenance, Range};

use super::base::{PARAMETERS, base, of_fmu};
use super::catalogue::{CATALOGUE, entry};
use super::columns::Columns;
use super::effect_file;
use super::fmu::ports::Ports;
use super::model::Model;
use super::model_file::{Measurement, SmallModel, SmallModelError, dotted};
use super::term::{Entry, MOST_PARAMETERS};

/// An uncertain parameter of an FMU.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Uncertain {
    value: f64,
    unit: Option<String>,
    #[serde(rename = "source")]
    _source: Option<String>,
    #[serde(rename = "status")]
    _status: Option<String>,
    relative_uncertainty: Option<f64>,
    interval95: Option<[f64; 2]>,
}

/// The small plant that a file describes.
///
/// # Errors
/// [`SmallModelError`], naming section and key and what would be right.
pub(super) fn read(reader: &Reader<'_>) -> Result<SmallModel, SmallModelError> {
    let Plant { kind, path, fmu } = reader.plant()?;
    let columns: Columns = reader.section(
        "columns",
        "lines such as time = { column = \"t\", unit = \"s\" }, for time, position, velocity, force, load, predicted, voltage, duty, supply, connected",
    )?;
    columns
        .check(kind, path)
        .map_err(|source| SmallModelError::Column {
            file: reader.file.to_owned(),
            source,
        })?;
    let measurement: Measurement = reader.section(
        "measurement",
        "motion_low_pass [Hz], compare_rate [Hz] and, if need be, compare_low_pass [Hz], edge [s] and standstill_speed",
    )?;
    check_measurement(reader, &measurement)?;
    let (model, origins) = model(reader, columns.load.is_some())?;
    let ports = match kind {
        Kind::Fmu => Some(ports(reader, fmu)?),
        _ => None,
    };
    Ok(SmallModel {
        model,
        columns,
        measurement,
        ports,
        origins,
    })
}

/// Base and effects of the plant that a file describes, with the origins of their numbers; `has_load` where a column has its load.
///
/// # Errors
/// [`FileError`], naming section and key and what would be right.
pub fn model(
    reader: &Reader<'_>,
    has_load: bool,
) -> Result<(Model, BTreeMap<String, Provenance>), FileError> {
    let Plant { kind, path, .. } = reader.plant()?;
    let own_base = base(kind).map_or(PARAMETERS, |entry| entry.name);
    let mut known = vec!["plant", "columns", "measurement", OWN_EFFECTS, own_base];
    if kind == Kind::Fmu {
        known.extend(["port", "inputs", "start"]);
    }
    let fitting = CATALOGUE
        .iter()
        .filter(|entry| entry.fits(kind, path, has_load));
    let possible: Vec<&str> = fitting.map(|entry| entry.name).collect();
    reader.check_sections(kind, &known, &possible)?;
    let base = match base(kind) {
        Some(base) => base,
        None => of_fmu(parameters(reader)?),
    };
    let mut origins = BTreeMap::new();
    let mut values = |entry: &Entry, numbers: Vec<(f64, Provenance)>| -> Vec<f64> {
        let numbers = entry.parameters.iter().zip(numbers);
        let values = numbers.map(|(parameter, (value, origin))| {
            origins.insert(dotted(entry, parameter.key), origin);
            value
        });
        values.collect()
    };
    let numbers = |entry: &Entry| reader.numbers(entry.name, entry.parameters, kind, path);
    let mut model = Model::new(kind, path, base, values(base, numbers(base)?));
    for name in reader.table.keys() {
        if let Some(effect) = entry(name) {
            model = model.with(effect, values(effect, numbers(effect)?));
        }
    }
    for described in reader.own_effects()? {
        let effect = effect_file::effect(&described, reader.file, kind, path)?;
        let entry = effect_file::of_user(effect, kind, path);
        let is_known = CATALOGUE.iter().any(|own| own.name == entry.name);
        reader.check_name(entry.name, is_known || model.has(entry.name))?;
        if entry.needs_load && !has_load {
            let section = format!("effect {}", entry.name);
            let expected = "without load, since [columns] has none";
            let found = format!("{:?}", effect.equation);
            Err(reader.wrong(&section, "equation", &found, expected))?;
        }
        let numbers = described.numbers(effect, reader.file, kind, path)?;
        let values = values(&entry, numbers);
        // An entry lives as long as the program, as those of the catalogue do.
        model = model.with(Box::leak(Box::new(entry)), values);
    }
    Ok((model, origins))
}

/// What an FMU's file has beside the other kinds'.
fn ports(reader: &Reader<'_>, fmu: Option<PathBuf>) -> Result<Ports, FileError> {
    Ok(Ports {
        fmu,
        port: reader.section(
            "port",
            "input, the FMU's input at which a force acts, and position, velocity or both, its outputs there",
        )?,
        inputs: reader.optional(
            "inputs",
            "lines such as u = { column = \"voltage\", unit = \"V\", between = \"linear\" }",
        )?,
        start: reader.optional("start", "lines such as phi_start = \"position\"")?,
    })
}

/// An FMU's uncertain parameters.
fn parameters(reader: &Reader<'_>) -> Result<Vec<Parameter>, FileError> {
    let table: BTreeMap<String, Uncertain> = reader.optional(
        PARAMETERS,
        "lines such as inertia = { value = 0.1, unit = \"kg.m2\", relative_uncertainty = 0.05 }",
    )?;
    if table.len() > MOST_PARAMETERS {
        return Err(reader.wrong(
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
                return Err(reader.wrong(
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

fn check_measurement(reader: &Reader<'_>, measurement: &Measurement) -> Result<(), FileError> {
    let numbers = [
        ("motion_low_pass", Some(measurement.motion_low_pass)),
        ("compare_low_pass", measurement.compare_low_pass),
        ("compare_rate", Some(measurement.compare_rate)),
    ];
    for (key, number) in numbers {
        if let Some(number) = number
            && !(number.is_finite() && number > 0.0)
        {
            return Err(reader.wrong(
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
            return Err(reader.wrong(
                "measurement",
                key,
                &number.to_string(),
                "a number of 0 or more",
            ));
        }
    }
    Ok(())
}
