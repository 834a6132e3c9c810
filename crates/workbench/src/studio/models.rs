//! The models of a studio: the one that is believed, and those that came of it.

use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use stickslip::plant::{ModelFile, RigKind};

use crate::diagnose::case::CaseError;
use crate::diagnose::material::{CaseArguments, Material};
use crate::diagnose::rig_columns::RigColumns;
use crate::diagnose::uncertainty::uncertainties;
use stickslip::body::is_small_plant;

/// What is believed where no case is given.
const REDUCED_RIG: &str = include_str!("../../../../modelDescription/reduced-rig.toml");

/// The case's own files.
const MODEL: &str = "model.toml";
const SENSORS: &str = "sensors.toml";
const EFFECTS: &str = "effects";

/// Name of the model that is believed.
pub const BELIEVED: &str = "believed";
/// Name of the model that the diagnosis amended.
pub const AMENDED: &str = "amended";
/// Beginning of the name of a model whose effects were chosen by hand.
pub const HAND: &str = "hand:";

/// What the command line gives.
#[derive(Debug)]
pub struct Base {
    /// The case; its records may be missing.
    pub material: Material,
    /// Its directory.
    pub directory: Option<PathBuf>,
}

/// Reads what a case's directory has. Records may still be missing.
///
/// # Errors
/// The directory or its model cannot be read.
pub fn base(case: Option<&Path>) -> anyhow::Result<Base> {
    let Some(directory) = case else {
        return Ok(Base {
            material: Material {
                name: "studio".to_owned(),
                model_name: "reduced-rig.toml".to_owned(),
                model_text: REDUCED_RIG.to_owned(),
                ..Material::default()
            },
            directory: None,
        });
    };
    let given = CaseArguments {
        case: Some(directory.to_owned()),
        ..CaseArguments::default()
    };
    let material = match given.material() {
        Err(CaseError::NoRecords { .. }) => {
            let there = |name: &str| Some(directory.join(name)).filter(|path| path.exists());
            let without_records = CaseArguments {
                model: Some(directory.join(MODEL)),
                sensors: there(SENSORS),
                catalogue: there(EFFECTS),
                ..CaseArguments::default()
            };
            without_records.material()?
        }
        other => other?,
    };
    Ok(Base {
        material,
        directory: Some(directory.to_owned()),
    })
}

/// A model's parameters and what is known of them, for the page.
///
/// # Errors
/// The text is no model file.
pub fn described(text: &str, name: &str) -> anyhow::Result<Value> {
    let (_, text) = RigColumns::split(text);
    if is_small_plant(&text) {
        return Ok(json!({"kind": "small plant", "parameters": []}));
    }
    let model = ModelFile::parse(&text, name)?;
    let (known, _) = uncertainties(&model, name)?;
    let rig = &model.rig;
    let parameters: Vec<Value> = rig
        .parameters()
        .into_iter()
        .map(|parameter| {
            let value = rig.parameter(&parameter.name);
            let info = parameter.info;
            let deviation = known.iter().find(|(own, _)| *own == parameter.name);
            let origin = model.provenance.get(&parameter.name);
            json!({
                "name": parameter.name,
                "section": parameter.section,
                "value": value,
                "unit": info.unit,
                "description": info.description.trim(),
                "minimum": info.range.minimum(),
                "maximum": info.range.maximum(),
                "range": info.range.to_string(),
                "deviation": deviation.map(|(_, deviation)| deviation),
                "interval95": origin.and_then(|origin| origin.interval95),
            })
        })
        .collect();
    let sections = rig.sections();
    let effects: Vec<&str> = rig
        .effect_names()
        .filter(|name| sections.iter().any(|(section, _)| section == name))
        .collect();
    Ok(json!({
        "kind": match rig.kind() {
            RigKind::Reduced => "reduced",
            RigKind::Full => "full",
        },
        "law": rig.law.name(),
        "effects": effects,
        "parameters": parameters,
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_studio_begins_without_a_case() {
        let base = base(None).unwrap();
        let model = described(&base.material.model_text, "model").unwrap();
        assert_eq!(model["kind"], "reduced");
        let all = model["parameters"].as_array().unwrap();
        let inertia = all
            .iter()
            .find(|own| own["name"] == "disc.inertia")
            .unwrap();
        assert_eq!(
            (&inertia["unit"], &inertia["minimum"]),
            (&json!("kg.m2"), &json!(0.0))
        );
    }

    #[test]
    fn a_case_may_lack_its_records() {
        let place = tempfile::tempdir().unwrap();
        assert!(base(Some(place.path())).is_err());
        std::fs::write(place.path().join(MODEL), REDUCED_RIG).unwrap();
        let base = base(Some(place.path())).unwrap();
        assert!(base.material.records.is_empty());
    }
}
