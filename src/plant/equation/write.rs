//! An effect as a section `[[effect]]` of a model file.

use super::EquationEffect;
use crate::expression::Interpolation;
use crate::parameter::{Provenance, Section};
use crate::plant::model_file::{provenance_keys, write_number};
use std::collections::BTreeMap;
use std::fmt::Write;
use toml::Value;

/// Appends the section of an effect to the text of a model file.
pub(in crate::plant) fn write_effect(
    text: &mut String,
    effect: &EquationEffect<f64>,
    provenance: &BTreeMap<String, Provenance>,
) {
    let draft = effect.definition.draft();
    let quoted = |words: &str| Value::String(words.to_owned());
    let _ = writeln!(text, "\n[[effect]]");
    let words = [
        ("name", Some(draft.name.as_str())),
        ("title", Some(&draft.title)),
        ("port", Some(draft.port.name())),
        ("equation", Some(&draft.equation)),
        ("source", draft.source.as_deref()),
    ];
    for (key, words) in words {
        if let Some(words) = words {
            let _ = writeln!(text, "{key} = {}", quoted(words));
        }
    }
    for (place, (key, unit, range, description)) in draft.parameters.iter().enumerate() {
        let known = provenance.get(&format!("{}.{key}", draft.name));
        let _ = writeln!(
            text,
            "parameters.{key} = {{ value = {}, unit = {}, range = {}, description = {}{} }}",
            write_number(effect.get(place)),
            quoted(unit),
            range.written(),
            quoted(description),
            known.map(provenance_keys).unwrap_or_default()
        );
    }
    for points in &draft.tables {
        let list = |numbers: &[f64]| {
            let texts: Vec<String> = numbers.iter().map(|x| write_number(*x)).collect();
            texts.join(", ")
        };
        let word = match points.interpolation {
            Interpolation::Linear => "linear",
            Interpolation::Spline => "spline",
        };
        let _ = writeln!(text, "[effect.tables.{}]", points.name);
        let _ = writeln!(text, "x = [{}]", list(&points.x));
        let _ = writeln!(text, "y = [{}]", list(&points.y));
        let _ = writeln!(text, "x_unit = {}", quoted(&points.units[0]));
        let _ = writeln!(text, "y_unit = {}", quoted(&points.units[1]));
        let _ = writeln!(text, "interpolation = {}", quoted(word));
        if let Some(period) = points.period {
            let _ = writeln!(text, "period = {}", write_number(period));
        }
    }
}
