//! How well the analyst's model is known: what the model file states, and what is assumed where it states nothing.

use stickslip::plant::ModelFile;
use thiserror::Error;

/// Relative standard deviations [1] of nominal parameters where the model file states none: as well as such numbers are
/// usually identified.
const ASSUMED: [(&str, f64); 18] = [
    ("disc.inertia", 0.006),
    ("shaft.stiffness", 0.02),
    ("shaft.damping", 0.06),
    ("motor.resistance", 0.02),
    ("motor.torque_constant", 0.02),
    ("motor.back_emf_constant", 0.01),
    ("motor.coulomb_torque", 0.04),
    ("contact.mu_c", 0.02),
    ("contact.mu_s", 0.02),
    ("contact.a1", 0.02),
    ("contact.a2", 0.02),
    ("disc1.inertia", 0.006),
    ("shaft1.stiffness", 0.02),
    ("shaft1.damping", 0.06),
    ("contact1.mu_c", 0.02),
    ("contact1.mu_s", 0.02),
    ("contact1.a1", 0.02),
    ("contact1.a2", 0.02),
];

/// A relative uncertainty that cannot be one.
#[derive(Debug, Error)]
#[error(
    "{file}: relative_uncertainty = {value} of {name} must be above 0 and below 1: the standard deviation of what is known of the number, over the number"
)]
pub struct UncertaintyError {
    /// The model file.
    pub file: String,
    /// Dotted name of the parameter.
    pub name: String,
    /// What it states.
    pub value: f64,
}

/// Relative standard deviations [1] by dotted name of a parameter.
pub type Uncertainties = Vec<(String, f64)>;

/// Relative standard deviations that the model file states, in the order of the model's parameters.
///
/// # Errors
/// [`UncertaintyError`] where one is not between 0 and 1.
pub fn stated(model: &ModelFile, file: &str) -> Result<Uncertainties, UncertaintyError> {
    let mut all = Vec::new();
    for parameter in model.rig.parameters() {
        let name = parameter.name;
        let stated = model
            .provenance
            .get(&name)
            .and_then(|origin| origin.relative_uncertainty);
        let Some(value) = stated else {
            continue;
        };
        if !(value > 0.0 && value < 1.0) {
            return Err(UncertaintyError {
                file: file.to_owned(),
                name,
                value,
            });
        }
        all.push((name, value));
    }
    Ok(all)
}

/// Relative standard deviations of the model's parameters, and a note on those that were assumed.
///
/// # Errors
/// [`UncertaintyError`] where a stated one is not between 0 and 1.
pub fn uncertainties(
    model: &ModelFile,
    file: &str,
) -> Result<(Uncertainties, Option<String>), UncertaintyError> {
    let stated = stated(model, file)?;
    let (mut all, mut assumed) = (Vec::new(), Vec::new());
    for parameter in model.rig.parameters() {
        let name = parameter.name;
        if let Some(known) = stated.iter().find(|(known, _)| *known == name) {
            all.push(known.clone());
        } else if let Some((_, usual)) = ASSUMED.iter().find(|(known, _)| *known == name)
            && model.rig.parameter(&name).is_some_and(|value| value != 0.0)
        {
            assumed.push(format!("{name} {} %", 100.0 * usual));
            all.push((name, *usual));
        }
    }
    let note = (!assumed.is_empty()).then(|| {
        format!(
            "{file} states no relative_uncertainty for some parameters; assumed are {}",
            assumed.join(", ")
        )
    });
    Ok((all, note))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn model(more: &str) -> ModelFile {
        let text = include_str!("../../../../modelDescription/reduced-rig.toml");
        ModelFile::parse(&format!("{text}\n{more}"), "model.toml").unwrap()
    }

    #[test]
    fn what_is_assumed_is_said() {
        let (all, note) = uncertainties(&model(""), "model.toml").unwrap();
        let note = note.unwrap_or_default();
        for (name, _) in &all {
            let stated = model("")
                .provenance
                .get(name)
                .and_then(|p| p.relative_uncertainty);
            assert_eq!(
                stated.is_none(),
                note.contains(name.as_str()),
                "{name}: {note}"
            );
        }
    }
}
