//! The amended model: the analyst's model with what was found, and its FMUs.

use std::collections::BTreeMap;
use std::convert::Infallible;
use std::path::{Path, PathBuf};

use build_fmu::build::{BuildError, Source};
use build_fmu::library::Library;
use build_fmu::platform::FmiVersion;
use inference::hypothesis::Estimate;
use inference::units::PlantUnits;
use stickslip::friction::Law;
use stickslip::parameter::{ParameterError, ParameterInfo};
use stickslip::plant::{ModelFile, ModelFileError, Provenance, Rig, RigKind};
use thiserror::Error;

use super::case::Case;
use super::catalogue::{Entry, entry};
use super::finding::{Finding, FoundEffect, ParameterValue};
use crate::files::atomic::{self, WriteError};

/// Name of the amended model in the output directory.
pub const FILE: &str = "model.amended.toml";

/// Names of its FMUs there.
#[must_use]
pub fn fmu_files(rig: &Rig<f64>) -> [&'static str; 2] {
    match rig.kind() {
        RigKind::Reduced => ["ReducedRig.fmi2.fmu", "ReducedRig.fmi3.fmu"],
        RigKind::Full => ["FullRig.fmi2.fmu", "FullRig.fmi3.fmu"],
    }
}

/// Standard deviations from the middle to the end of a 95 % interval.
const TO_95_PERCENT: f64 = 1.96;

/// Why a model cannot be amended.
#[derive(Debug, Error)]
pub enum AmendError {
    /// The catalogue has no such effect.
    #[error("the finding names `{0}`, which the catalogue does not have")]
    UnknownEffect(String),
    /// The effect makes no sense on top of the model.
    #[error("`{effect}` cannot be added to this model: {reason}")]
    NotApplicable {
        /// The effect.
        effect: String,
        /// Why.
        reason: &'static str,
    },
    /// A fitted model's number leaves its range in SI units.
    #[error(transparent)]
    Range(#[from] ParameterError),
    /// A number of the finding is not one of the amended model.
    #[error("the finding's number for `{name}`: {source}")]
    Parameter {
        /// Dotted name.
        name: String,
        /// What is wrong.
        source: ParameterError,
    },
    /// The amended model is none.
    #[error(transparent)]
    Model(#[from] ModelFileError),
    /// An FMU could not be built.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// A file could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

/// Why an effect has no starts on a model.
pub const NOT_APPLICABLE: &str =
    "it is there already, or the friction law is one that it cannot extend";

/// A fitted model in SI units.
#[derive(Debug, Clone)]
pub struct FittedRig {
    /// The rig.
    pub rig: Rig<f64>,
    /// Values and deviations of what was fitted.
    pub estimates: Vec<Estimate>,
}

impl FittedRig {
    /// `plant`, with these estimates, out of the plant's units.
    ///
    /// # Errors
    /// A number leaves its range.
    pub fn of(
        plant: &Rig<f64>,
        estimates: &[Estimate],
        units: &PlantUnits,
    ) -> Result<Self, ParameterError> {
        let rig = units.to_si(plant)?;
        let mut in_si = Vec::new();
        for parameter in plant.parameters() {
            let name = &parameter.name;
            let estimate = estimates.iter().find(|estimate| estimate.name == *name);
            let (Some(value), Some(own)) = (rig.parameter(name), plant.parameter(name)) else {
                continue;
            };
            // A load exponent is fitted with the level of the law, which is no parameter: the law's numbers move along.
            let is_moved =
                estimate.is_none() && is_level(name) && rig.effects.load_exponent.is_some();
            let Some(estimate) = estimate else {
                if is_moved {
                    in_si.push(Estimate {
                        name: name.clone(),
                        value,
                        deviation: f64::NAN,
                        is_nominal: true,
                    });
                }
                continue;
            };
            let unit = units.of_parameter_in(plant, &parameter);
            in_si.push(Estimate {
                name: name.clone(),
                // A phase is told between 0 and 2π.
                value: if is_level(name) {
                    value
                } else {
                    unit * estimate.value
                },
                deviation: if is_level(name) && estimate.value != 0.0 {
                    (own / estimate.value * unit * estimate.deviation).abs()
                } else {
                    unit * estimate.deviation
                },
                is_nominal: estimate.is_nominal,
            });
        }
        Ok(Self {
            rig,
            estimates: in_si,
        })
    }
}

/// Whether this is a level of a friction law, which a load exponent refers to its own force.
fn is_level(name: &str) -> bool {
    matches!(
        name,
        "contact.mu_c" | "contact.mu_s" | "contact.a1" | "contact.a2"
    )
}

/// The effects with their numbers as a finding tells them.
///
/// Numbers of an effect that are held, not fitted, are given without an interval.
#[must_use]
pub fn found_effects(fitted: &FittedRig, effects: &[(String, f64)]) -> Vec<FoundEffect> {
    effects
        .iter()
        .map(|(name, probability)| {
            let symbols = entry(name).map_or(&[][..], |entry| entry.symbols);
            let law = entry(name).is_some_and(Entry::is_law);
            let mut parameters = BTreeMap::new();
            for parameter in fitted.rig.parameters() {
                let own_section = parameter.name.split('.').next() == Some(name);
                let estimate = fitted
                    .estimates
                    .iter()
                    .find(|e| e.name == parameter.name && !e.is_nominal);
                let in_law = law && parameter.name.starts_with("contact.") && estimate.is_some();
                if !(own_section || in_law) {
                    continue;
                }
                let Some(value) = fitted.rig.parameter(&parameter.name) else {
                    continue;
                };
                let symbol = symbols
                    .iter()
                    .find(|(dotted, _)| *dotted == parameter.name)
                    .map_or_else(
                        || parameter.name.rsplit('.').next().unwrap_or_default(),
                        |(_, symbol)| symbol,
                    );
                parameters.insert(
                    symbol.to_owned(),
                    ParameterValue {
                        value: estimate.map_or(value, |e| e.value),
                        interval95: estimate.and_then(interval95),
                        unit: parameter.info.unit.to_owned(),
                        model_parameter: parameter.name.clone(),
                    },
                );
            }
            FoundEffect {
                name: name.clone(),
                description: description(&fitted.rig, name).to_owned(),
                probability: *probability,
                parameters,
            }
        })
        .collect()
}

/// What an effect of the catalogue or of the rig is.
fn description<'a>(rig: &'a Rig<f64>, name: &str) -> &'a str {
    let equation = || {
        let mut known = rig.equations.known();
        known.find(|effect| effect.definition.name() == name)
    };
    entry(name)
        .map(|entry| entry.description)
        .or_else(|| equation().map(|effect| effect.definition.title()))
        .unwrap_or_default()
}

/// Refitted nominal parameters as a finding tells them.
#[must_use]
pub fn refitted(fitted: &FittedRig) -> BTreeMap<String, ParameterValue> {
    let parameters = fitted.rig.parameters();
    fitted
        .estimates
        .iter()
        .filter(|estimate| estimate.is_nominal)
        .map(|estimate| {
            let unit = parameters
                .iter()
                .find(|p| p.name == estimate.name)
                .map(|p| p.info.unit.to_owned());
            let value = ParameterValue {
                value: estimate.value,
                interval95: interval95(estimate),
                unit: unit.unwrap_or_default(),
                model_parameter: estimate.name.clone(),
            };
            (estimate.name.clone(), value)
        })
        .collect()
}

fn interval95(estimate: &Estimate) -> Option<[f64; 2]> {
    let reach = TO_95_PERCENT * estimate.deviation;
    reach
        .is_finite()
        .then_some([estimate.value - reach, estimate.value + reach])
}

/// `rig` with an effect switched on, whose numbers `value` gives by dotted name; `None` where that makes no sense.
fn with_effect(
    rig: &Rig<f64>,
    name: &str,
    value: impl Fn(&str) -> Option<f64>,
) -> Option<Rig<f64>> {
    let mut amended = *rig;
    let is_law = entry(name).is_some_and(Entry::is_law);
    let section = if is_law { "contact" } else { name };
    let number = |info: &'static ParameterInfo| {
        let name = format!("{section}.{}", info.key);
        Ok::<f64, Infallible>(
            value(&name)
                .or_else(|| rig.parameter(&name))
                .unwrap_or_default(),
        )
    };
    if is_law {
        let Ok(law) = Law::from_values(law_of(name), number)?;
        amended.law = law;
    } else {
        if rig
            .parameters()
            .iter()
            .any(|p| p.name.split('.').next() == Some(section))
        {
            return None;
        }
        let Ok(()) = amended.insert_effect(section, number)?;
    }
    Some(amended)
}

/// The friction law that an effect on the contact leads to.
#[must_use]
pub fn law_of(effect: &str) -> &'static str {
    match effect {
        "stiction" => "coulomb_stiction",
        "stribeck" => "stribeck",
        _ => "two_gaussian_mu",
    }
}

/// The amended model that a finding describes.
///
/// # Errors
/// [`AmendError`] where the finding does not fit the case's model or the catalogue.
pub fn amended_model(case: &Case, finding: &Finding) -> Result<ModelFile, AmendError> {
    let mut rig = case.model.rig;
    for effect in &finding.effects {
        let mut supposed = case.catalogue.supposed.iter();
        match supposed.find(|own| own.definition.name() == effect.name) {
            Some(own) => rig.equations.add(own.definition)?,
            None if entry(&effect.name).is_some() => {}
            None => return Err(AmendError::UnknownEffect(effect.name.clone())),
        }
        let value = |name: &str| {
            finding
                .parameters
                .values()
                .chain(effect.parameters.values())
                .find(|number| number.model_parameter == name)
                .map(|number| number.value)
        };
        rig = with_effect(&rig, &effect.name, value).ok_or_else(|| AmendError::NotApplicable {
            effect: effect.name.clone(),
            reason: NOT_APPLICABLE,
        })?;
    }
    if let Some(learned) = &finding.learned {
        let added = learned.table().and_then(|table| table.added_to(&rig));
        rig = added.ok_or_else(|| AmendError::NotApplicable {
            effect: learned.name.clone(),
            reason: "port, equation or points are none that the rig can have",
        })?;
    }
    let source = provenance_source(case);
    let mut provenance = case.model.provenance.clone();
    let numbers = finding
        .parameters
        .values()
        .chain(finding.effects.iter().flat_map(|e| e.parameters.values()));
    for number in numbers {
        let name = &number.model_parameter;
        rig.set_parameter(name, number.value)
            .map_err(|source| AmendError::Parameter {
                name: name.clone(),
                source,
            })?;
        if let Some(interval95) = number.interval95 {
            provenance.insert(
                name.clone(),
                Provenance {
                    source: Some(source.clone()),
                    status: Some("fitted".to_owned()),
                    relative_uncertainty: None,
                    interval95: Some(interval95),
                },
            );
        }
    }
    // A law that was replaced takes the provenance of its numbers along.
    provenance.retain(|name, _| rig.parameter(name).is_some());
    Ok(ModelFile { rig, provenance })
}

fn provenance_source(case: &Case) -> String {
    let mut files: Vec<&str> = case
        .records
        .iter()
        .map(|record| file_name(&record.name))
        .collect();
    files.dedup();
    format!("fitted to {} by stickslip diagnose", files.join(", "))
}

fn file_name(path: &str) -> &str {
    path.rsplit(['/', '\\']).next().unwrap_or(path)
}

/// Text of the amended model file, checked by reading it back.
///
/// # Errors
/// [`AmendError::Model`] where a number is out of its range.
pub fn text(case: &Case, finding: &Finding, model: &ModelFile) -> Result<String, AmendError> {
    let names: Vec<&str> = finding
        .effects
        .iter()
        .map(|effect| effect.name.as_str())
        .collect();
    let what = if let Some(learned) = &finding.learned {
        format!("a learned function of {}", learned.coordinate)
    } else if names.is_empty() {
        "refitted parameters".to_owned()
    } else {
        names.join(" and ")
    };
    let text = format!(
        "# {} with {what}, as stickslip diagnose found it.\n{}",
        case.name,
        model.to_toml()
    );
    ModelFile::parse(&text, FILE)?;
    Ok(text)
}

/// Writes the amended model and its FMUs for both versions of the standard into `directory`, replacing earlier ones.
///
/// # Errors
/// [`AmendError`] where the FMUs cannot be built or a file cannot be written.
pub fn write(directory: &Path, text: &str, library: &Library) -> Result<Vec<PathBuf>, AmendError> {
    let path = directory.join(FILE);
    atomic::write_file(&path, text.as_bytes())?;
    let source = Source::from_text(text.to_owned(), FILE)?;
    let mut written = vec![path];
    written.extend(build(&source, directory, library)?);
    Ok(written)
}

/// Builds a model's FMUs for both versions of the standard into `directory`, replacing earlier ones.
///
/// # Errors
/// An FMU cannot be built or written.
pub fn build(
    source: &Source,
    directory: &Path,
    library: &Library,
) -> Result<Vec<PathBuf>, BuildError> {
    let libraries = std::slice::from_ref(library);
    let built = FmiVersion::ALL.map(|version| source.build(libraries, version, directory));
    built.into_iter().map(|built| Ok(built?.path)).collect()
}
