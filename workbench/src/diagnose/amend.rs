//! The amended model: the analyst's model with what was found, and its FMUs.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use build_fmu::build::{BuildError, Source};
use build_fmu::library::Library;
use build_fmu::platform::FmiVersion;
use stickslip::parameter::ParameterError;
use stickslip::plant::{ModelFile, ModelFileError, Provenance, Rig};
use thiserror::Error;

use super::case::Case;
use super::catalogue::{Entry, entry};
use super::finding::{Finding, FoundEffect, ParameterValue};
use super::hypothesis::{Estimate, Hypothesis};
use crate::files::atomic::{self, WriteError};

/// Name of the amended model in the output directory.
pub const FILE: &str = "model.amended.toml";
/// Names of its FMUs there.
pub const FMU_FILES: [&str; 2] = ["ReducedRig.fmi2.fmu", "ReducedRig.fmi3.fmu"];

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

/// The effects with their numbers as a finding tells them.
///
/// Numbers of an effect that are held, not fitted, are given without an interval.
#[must_use]
pub fn found_effects(
    rig: &Rig<f64>,
    effects: &[(String, f64)],
    estimates: &[Estimate],
) -> Vec<FoundEffect> {
    effects
        .iter()
        .map(|(name, probability)| {
            let symbols = entry(name).map_or(&[][..], |entry| entry.symbols);
            let law = entry(name).is_some_and(Entry::is_law);
            let mut parameters = BTreeMap::new();
            for parameter in rig.parameters() {
                let own_section = parameter.name.split('.').next() == Some(name);
                let estimate = estimates
                    .iter()
                    .find(|e| e.name == parameter.name && !e.is_nominal);
                let in_law = law && parameter.name.starts_with("contact.") && estimate.is_some();
                if !(own_section || in_law) {
                    continue;
                }
                let Some(value) = rig.parameter(&parameter.name) else {
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
                        interval95: estimate.map(interval95),
                        unit: parameter.info.unit.to_owned(),
                        model_parameter: parameter.name.clone(),
                    },
                );
            }
            FoundEffect {
                name: name.clone(),
                probability: *probability,
                parameters,
            }
        })
        .collect()
}

/// Refitted nominal parameters as a finding tells them.
#[must_use]
pub fn refitted(rig: &Rig<f64>, estimates: &[Estimate]) -> BTreeMap<String, ParameterValue> {
    let parameters = rig.parameters();
    estimates
        .iter()
        .filter(|estimate| estimate.is_nominal)
        .map(|estimate| {
            let unit = parameters
                .iter()
                .find(|p| p.name == estimate.name)
                .map(|p| p.info.unit.to_owned());
            let value = ParameterValue {
                value: estimate.value,
                interval95: Some(interval95(estimate)),
                unit: unit.unwrap_or_default(),
                model_parameter: estimate.name.clone(),
            };
            (estimate.name.clone(), value)
        })
        .collect()
}

fn interval95(estimate: &Estimate) -> [f64; 2] {
    let reach = TO_95_PERCENT * estimate.deviation;
    [estimate.value - reach, estimate.value + reach]
}

/// The amended model that a finding describes.
///
/// # Errors
/// [`AmendError`] where the finding does not fit the case's model or the catalogue.
pub fn amended_model(case: &Case, finding: &Finding) -> Result<ModelFile, AmendError> {
    let mut hypothesis = Hypothesis::base(&case.model);
    for effect in &finding.effects {
        let entry =
            entry(&effect.name).ok_or_else(|| AmendError::UnknownEffect(effect.name.clone()))?;
        hypothesis = entry
            .starts(&hypothesis, false)
            .into_iter()
            .next()
            .ok_or_else(|| AmendError::NotApplicable {
                effect: effect.name.clone(),
                reason: NOT_APPLICABLE,
            })?;
    }
    let mut rig = hypothesis.rig;
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
    let mut files: Vec<&str> = case.runs.iter().map(|run| file_name(&run.name)).collect();
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
    let what = if names.is_empty() {
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
    for version in FmiVersion::ALL {
        written.push(
            source
                .build(std::slice::from_ref(library), version, directory)?
                .path,
        );
    }
    Ok(written)
}
