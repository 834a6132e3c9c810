//! Reads a small plant's model file: what the library reads, and beside it columns, measurement and what an FMU's has.

use std::collections::BTreeMap;
use std::path::PathBuf;

use serde::Deserialize;
use stickslip::body::{Dimension, FileError, Kind, OWN_EFFECTS, Parameter, Plant, Reader};
use stickslip::parameter::{Provenance, Range};

use super::columns::Columns;
use super::fmu::places::effects;
use super::fmu::ports::{Input, Port, Ports};
use super::model_file::{SmallModel, SmallModelError, dotted, has_load};
use inference::body::base::{PARAMETERS, base, of_fmu};
use inference::body::catalogue::{CATALOGUE, entry};
use inference::body::effect_file;
use inference::body::model::Model;
use inference::body::motion::Measurement;
use inference::body::term::{Entry, MOST_OFFSETS, MOST_PARAMETERS};

/// Parameters of an FMU that may change with time.
#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct Drifts {
    parameters: Vec<String>,
}

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
    let ports = match kind {
        Kind::Fmu => Some(ports(reader, fmu)?),
        _ => None,
    };
    let Described {
        model,
        of_ports,
        origins,
    } = described(reader, has_load(&columns, ports.as_ref()), ports.as_ref())?;
    Ok(SmallModel {
        model,
        columns,
        measurement,
        ports,
        of_ports,
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
    let described = described(reader, has_load, None)?;
    Ok((described.model, described.origins))
}

/// What a model file says of base and effects.
struct Described {
    model: Model,
    /// Effects that an FMU can have at its ports.
    of_ports: Vec<&'static Entry>,
    origins: BTreeMap<String, Provenance>,
}

/// Base and effects of the plant that a file describes; `ports` are an FMU's.
fn described(
    reader: &Reader<'_>,
    has_load: bool,
    ports: Option<&Ports>,
) -> Result<Described, FileError> {
    let Plant { kind, path, .. } = reader.plant()?;
    let own_base = base(kind).map_or(PARAMETERS, |entry| entry.name);
    let mut known = vec!["plant", "columns", "measurement", OWN_EFFECTS, own_base];
    if kind == Kind::Fmu {
        known.extend(["port", "inputs", "start", "drifts"]);
    }
    let (base, of_ports) = match base(kind) {
        Some(base) => (base, Vec::new()),
        None => {
            let parameters = parameters(reader)?;
            let of_ports = match ports {
                Some(ports) => {
                    check_drifts(reader, &ports.drifts, &parameters)?;
                    effects(ports, &parameters)
                }
                None => Vec::new(),
            };
            (of_fmu(parameters), of_ports)
        }
    };
    let fitting = CATALOGUE
        .iter()
        .chain(of_ports.iter().copied())
        .filter(|entry| entry.fits(kind, path, has_load));
    let possible: Vec<&str> = fitting.map(|entry| entry.name).collect();
    reader.check_sections(kind, &known, &possible)?;
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
        let mut own = of_ports.iter().copied();
        if let Some(effect) = own.find(|own| own.name == name).or_else(|| entry(name)) {
            model = model.with(effect, values(effect, numbers(effect)?));
        }
    }
    for described in reader.own_effects()? {
        let effect = effect_file::effect(&described, reader.file, kind, path)?;
        let entry = effect_file::of_user(effect, kind, path);
        let is_known = CATALOGUE.iter().any(|own| own.name == entry.name);
        reader.check_name(entry.name, is_known || model.has(entry.name))?;
        if !entry.fits(kind, path, has_load) {
            let section = format!("effect {}", entry.name);
            let expected = "without load, since the model names none";
            let found = format!("{:?}", effect.equation);
            Err(reader.wrong(&section, "equation", &found, expected))?;
        }
        let numbers = described.numbers(effect, reader.file, kind, path)?;
        let values = values(&entry, numbers);
        // An entry lives as long as the program, as those of the catalogue do.
        model = model.with(Box::leak(Box::new(entry)), values);
    }
    Ok(Described {
        model,
        of_ports,
        origins,
    })
}

/// What an FMU's file has beside the other kinds'.
fn ports(reader: &Reader<'_>, fmu: Option<PathBuf>) -> Result<Ports, FileError> {
    let expected = "input, the FMU's input at which a force acts, and position, velocity or both, its outputs there";
    let several = reader.table.get("port").is_some_and(|own| own.is_array());
    let all: Vec<Port> = if several {
        reader.section("port", expected)?
    } else {
        vec![reader.section("port", expected)?]
    };
    check_ports(reader, &all)?;
    let inputs: BTreeMap<String, Input> = reader.optional(
        "inputs",
        "lines such as u = { column = \"voltage\", unit = \"V\", between = \"linear\" }",
    )?;
    let offsets = inputs.values().filter(|input| input.may_be_offset).count();
    if offsets > MOST_OFFSETS {
        let expected = format!("{MOST_OFFSETS} or fewer inputs with may_be_offset = true");
        return Err(reader.wrong("inputs", "may_be_offset", &offsets.to_string(), &expected));
    }
    Ok(Ports {
        fmu,
        ports: all,
        drifts: reader
            .optional::<Drifts>(
                "drifts",
                "parameters, names of uncertain parameters that may change with time",
            )?
            .parameters,
        inputs,
        start: reader.optional("start", "lines such as phi_start = \"position\"")?,
    })
}

/// Refuses drifts of parameters that are not uncertain.
fn check_drifts(
    reader: &Reader<'_>,
    drifts: &[String],
    parameters: &[Parameter],
) -> Result<(), FileError> {
    let is_known = |name: &&String| parameters.iter().any(|own| own.key == **name);
    match drifts.iter().find(|name| !is_known(name)) {
        Some(name) => {
            let known: Vec<&str> = parameters.iter().map(|own| own.key).collect();
            let expected = format!("names out of [parameters]: {}", known.join(", "));
            Err(reader.wrong("drifts", "parameters", &format!("{name:?}"), &expected))
        }
        None => Ok(()),
    }
}

/// Refuses several ports that cannot be told apart, or whose motion no column gives.
fn check_ports(reader: &Reader<'_>, all: &[Port]) -> Result<(), FileError> {
    let wrong = |key: &str, found: &str, expected: &str| reader.wrong("port", key, found, expected);
    if all.is_empty() {
        return Err(wrong("number", "0", "1 or more"));
    }
    let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '_';
    for (at, port) in all.iter().enumerate() {
        let name = port.name.as_deref().unwrap_or_default();
        let is_named = !name.is_empty() && name.chars().all(is_plain);
        if all.len() > 1 && !is_named {
            let expected = "a name of letters, digits and underscores for each of several ports";
            return Err(wrong("name", &format!("{name:?}"), expected));
        }
        if all[..at].iter().any(|other| other.name == port.name) {
            return Err(wrong(
                "name",
                &format!("{name:?}"),
                "a name that no other port has",
            ));
        }
        if let Some(cut_off) = port.compare_low_pass
            && !(cut_off.is_finite() && cut_off > 0.0)
        {
            let expected = "a number above 0 [Hz]";
            return Err(wrong("compare_low_pass", &cut_off.to_string(), expected));
        }
        if let Some(often) = port
            .repeats
            .iter()
            .find(|own| !(own.is_finite() && **own > 0.0))
        {
            return Err(wrong("repeats", &often.to_string(), "numbers above 0"));
        }
        let has_columns = port.measured_position.is_some() || port.measured_velocity.is_some();
        if at == 0 && has_columns {
            let expected = "left out: [columns] has those of the first port";
            return Err(wrong(
                "measured_position, measured_velocity",
                name,
                expected,
            ));
        }
        if at > 0 && !has_columns {
            let expected = "a column for one of them at every port but the first, such as { column = \"angle\", unit = \"rad\" }";
            return Err(wrong(
                "measured_position, measured_velocity",
                name,
                expected,
            ));
        }
    }
    Ok(())
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
