//! A small plant's model file as text.

use std::fmt::Write as _;

use super::fmu::ports::key;
use super::model_file::{SmallModel, dotted};
use inference::body::effect_file::section;
use inference::body::model::Term;
use inference::body::motion::Measurement;
use inference::body::term::Entry;

impl SmallModel {
    /// The file's text, every number with unit, origin and interval; `origins` replaces or adds to what is known.
    #[must_use]
    pub fn to_toml(&self, head: &str) -> String {
        let (kind, path) = (self.model.kind, self.model.path);
        let mut text: String = head.lines().map(|line| format!("# {line}\n")).collect();
        let _ = writeln!(
            text,
            "\n[plant]\nkind = \"{}\"\npath = \"{}\"",
            kind.word(),
            path.word()
        );
        if let Some(ports) = &self.ports {
            text.push_str(&ports.to_toml());
        }
        text.push_str("\n[columns]\n");
        for (quantity, column) in self.columns.given(kind) {
            let _ = writeln!(text, "{} = {}", quantity.word(), column.to_toml());
        }
        let Measurement {
            motion_low_pass,
            compare_low_pass,
            compare_rate,
            edge,
            standstill_speed,
        } = &self.measurement;
        let _ = writeln!(
            text,
            "\n[measurement]\nmotion_low_pass = {motion_low_pass:?}"
        );
        if let Some(cut_off) = compare_low_pass {
            let _ = writeln!(text, "compare_low_pass = {cut_off:?}");
        }
        let _ = writeln!(
            text,
            "compare_rate = {compare_rate:?}\nedge = {edge:?}\nstandstill_speed = {standstill_speed:?}"
        );
        let more = |entry: &Entry, key: &str| {
            let mut text = String::new();
            if let Some(origin) = self.origins.get(&dotted(entry, key)) {
                if let Some(source) = &origin.source {
                    let _ = write!(text, ", source = {source:?}");
                }
                if let Some(status) = &origin.status {
                    let _ = write!(text, ", status = {status:?}");
                }
                if let Some([low, high]) = origin.interval95 {
                    let _ = write!(text, ", interval95 = [{low:?}, {high:?}]");
                }
                if let Some(uncertainty) = origin.relative_uncertainty {
                    let _ = write!(text, ", relative_uncertainty = {uncertainty:?}");
                }
            }
            text
        };
        let (own, known): (Vec<&Term>, Vec<&Term>) =
            self.model.terms().iter().partition(|term| term.entry.own);
        for term in known {
            let _ = writeln!(
                text,
                "\n[{}]  # {}",
                term.entry.name, term.entry.description
            );
            for (parameter, value) in term.entry.parameters.iter().zip(&term.values) {
                let _ = writeln!(
                    text,
                    "{} = {{ value = {value:?}, unit = {:?}{} }}  # {}",
                    key(parameter.key),
                    parameter.dimension.unit(kind, path),
                    more(term.entry, parameter.key),
                    parameter.description
                );
            }
        }
        for term in own {
            let more = |key: &str| more(term.entry, key);
            text.push_str(&section(term, kind, path, &more));
        }
        text
    }
}
