//! `documentation/index.html` of an FMU: equations, signs, variables, parameters with their sources. One
//! file without scripts or links to elsewhere.

mod body;
mod controller;
pub mod equations;
mod mathml;

use std::fmt::Write;

use stickslip::cosim::{Causality, Variable};

use crate::model_description::Facts;
use crate::reference::write::PAGE;
use equations::{Equations, MISPRINTS};
use mathml::{equation, escape};

const STYLE: &str = "body{font:16px/1.5 system-ui,sans-serif;max-width:62rem;margin:2rem auto;padding:0 1rem;color:#1c2733}\
h1,h2,h3{line-height:1.2}table{border-collapse:collapse;width:100%;font-size:.9rem;margin:1rem 0}\
th,td{border-bottom:1px solid #cdd5dd;padding:.3rem .5rem;text-align:left;vertical-align:top}\
th{background:#eef2f6}td.n{text-align:right;font-variant-numeric:tabular-nums}\
code{background:#eef2f6;padding:0 .2rem}math{margin:.4rem 0}small{color:#5b6875}\
@media(prefers-color-scheme:dark){body{background:#151b22;color:#dbe3ea}th,code{background:#232d38}th,td{border-color:#3a4652}}";

/// The page for a model: `facts` as in the XML, `model_toml` the resource with sources and status of its values, `references`
/// the files of the reference run by their names.
pub fn page(
    facts: &Facts<'_>,
    model_toml: &toml::Table,
    references: &[(String, String)],
) -> String {
    let name = facts.identity.model_identifier;
    let (signs, equations, usage, is_rig) = match controller::equations(model_toml) {
        Some(law) => {
            let law = format!("<h2>Equations</h2>\n{}", group(&law));
            (controller::signs(), law, controller::usage(facts), false)
        }
        None if model_toml.contains_key("plant") => {
            let equations = body::equations(model_toml);
            (body::signs(), equations, body::usage(facts), false)
        }
        None => (
            signs(),
            model_equations(facts, model_toml),
            usage(facts),
            true,
        ),
    };
    let mut sections = vec![
        introduction(facts),
        signs,
        equations,
        variables(facts),
        parameters(facts, model_toml),
    ];
    sections.extend(is_rig.then(misprints));
    sections.push(usage);
    if references.iter().any(|(name, _)| name == PAGE) {
        sections.push(reference_run());
    }
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>{name}</title>\n\
         <style>{STYLE}</style>\n</head>\n<body>\n<h1>{name}</h1>\n{}\n</body>\n</html>\n",
        sections.join("\n")
    )
}

fn introduction(facts: &Facts<'_>) -> String {
    format!(
        "<p>{}</p>\n<p><small>Made by stickslip build-fmu {}. Token {}. The model is the file \
         <code>resources/model.toml</code>; its numbers are FMI parameters.</small></p>",
        escape(facts.identity.description),
        env!("CARGO_PKG_VERSION"),
        escape(facts.token)
    )
}

fn reference_run() -> String {
    format!(
        "<h2>Checking an import</h2>\n<p>The FMU holds a run with its inputs and results: \
         <a href=\"{}\">{PAGE}</a>.</p>",
        PAGE.trim_start_matches("documentation/")
    )
}

fn signs() -> String {
    "<h2>Signs and units</h2>\n<p>Positive torques turn the disc forward. <code>T_f</code> is positive when it \
     opposes a positive slip velocity; it acts on the disc as −<code>T_f</code>. All quantities are in SI units and \
     on the shaft side of the gearbox unless their name says motor. A contact is in one of three modes: stuck, \
     slipping forward, slipping backward; breakaway, sticking and reversal are located as events. In stick, \
     <code>T_f</code> is the reaction that holds the disc.</p>"
        .to_owned()
}

fn group(group: &Equations) -> String {
    let lines: String = group.equations.iter().map(|line| equation(line)).collect();
    format!(
        "<h3>{}</h3>\n{lines}\n<p><small>Source: {}</small></p>\n",
        group.title, group.source
    )
}

fn model_equations(facts: &Facts<'_>, model: &toml::Table) -> String {
    let full = facts.table.find("theta1").is_some();
    let mut html = String::from("<h2>Equations</h2>\n");
    html.push_str(&group(&equations::rig(full)));
    let mut laws: Vec<&str> = ["contact", "contact1"]
        .iter()
        .filter_map(|section| model.get(*section)?.get("law")?.as_str())
        .collect();
    laws.dedup();
    for law in laws.into_iter().filter_map(equations::law) {
        html.push_str(&group(&law));
    }
    for effect in model
        .keys()
        .filter_map(|section| equations::effect(section))
    {
        html.push_str(&group(&effect));
    }
    html.push_str(&written_effects(model));
    html
}

/// The effects that the model file describes by equations.
fn written_effects(model: &toml::Table) -> String {
    let written = model.get("effect").and_then(toml::Value::as_array);
    written.into_iter().flatten().map(written_effect).collect()
}

/// An effect that the model file describes by an equation, in the words of its author.
fn written_effect(effect: &toml::Value) -> String {
    let words = |key: &str| {
        let text = effect.get(key).and_then(toml::Value::as_str);
        text.unwrap_or_default()
    };
    let source = match words("source") {
        "" => "the model file",
        source => source,
    };
    let [title, name, port, equation] = ["title", "name", "port", "equation"].map(words);
    effect_by_equation([title, name, port, equation, source])
}

/// An effect's title, name, port, equation and source.
fn effect_by_equation(words: [&str; 5]) -> String {
    let [title, name, port, equation, source] = words.map(escape);
    format!(
        "<h3>{title} (<code>{name}</code>)</h3>\n<p><code>{port} = {equation}</code></p>\n\
         <p><small>Source: {source}</small></p>\n"
    )
}

fn row(cells: &[(&str, &str)]) -> String {
    let cells: String = cells
        .iter()
        .map(|(class, text)| {
            if class.is_empty() {
                format!("<td>{}</td>", escape(text))
            } else {
                format!("<td class=\"{class}\">{}</td>", escape(text))
            }
        })
        .collect();
    format!("<tr>{cells}</tr>\n")
}

fn table(headings: &[&str], rows: &str) -> String {
    let head: String = headings.iter().fold(String::new(), |mut head, text| {
        let _ = write!(head, "<th>{text}</th>");
        head
    });
    format!("<table>\n<tr>{head}</tr>\n{rows}</table>\n")
}

fn start(variable: &Variable) -> String {
    variable
        .start
        .map(|value| value.to_string())
        .unwrap_or_default()
}

fn variables(facts: &Facts<'_>) -> String {
    let rows: String = facts
        .table
        .variables()
        .iter()
        .filter(|variable| variable.causality != Causality::Parameter)
        .map(|variable| {
            row(&[
                ("", &variable.name),
                ("", variable.causality.xml()),
                ("", variable.unit.as_deref().unwrap_or("Boolean")),
                ("n", &start(variable)),
                ("", &variable.description),
            ])
        })
        .collect();
    format!(
        "<h2>Inputs, outputs and locals</h2>\n{}",
        table(&["Name", "Causality", "Unit", "Start", "Meaning"], &rows)
    )
}

fn parameters(facts: &Facts<'_>, model: &toml::Table) -> String {
    let rows: String = facts
        .table
        .variables()
        .iter()
        .filter(|variable| variable.causality == Causality::Parameter)
        .map(|variable| {
            let (status, source) = provenance(model, &variable.name);
            row(&[
                ("", &variable.name),
                ("n", &start(variable)),
                ("", variable.unit.as_deref().unwrap_or_default()),
                ("", variable.variability.xml()),
                ("", &range(variable)),
                ("", &variable.description),
                ("", &status),
                ("", &source),
            ])
        })
        .collect();
    let headings = [
        "Name",
        "Value",
        "Unit",
        "Variability",
        "Allowed",
        "Meaning",
        "Status",
        "Source",
    ];
    format!("<h2>Parameters</h2>\n{}", table(&headings, &rows))
}

/// The allowed values in few signs; the unit has a column of its own.
fn range(variable: &Variable) -> String {
    let above = if variable.above_minimum { ">" } else { "≥" };
    match (variable.minimum, variable.maximum) {
        (None, None) => "any".to_owned(),
        (Some(low), None) => format!("{above} {low}"),
        (None, Some(high)) => format!("≤ {high}"),
        (Some(low), Some(high)) => format!("{above} {low}, ≤ {high}"),
    }
}

/// Status and source that `model.toml` gives for the dotted name `section.key`; empty where it gives none.
fn provenance(model: &toml::Table, name: &str) -> (String, String) {
    let entry = name
        .split_once('.')
        .and_then(|(section, key)| model.get(section)?.get(key));
    let text = |key| {
        entry
            .and_then(|value| value.get(key))
            .and_then(toml::Value::as_str)
            .unwrap_or_default()
            .to_owned()
    };
    (text("status"), text("source"))
}

fn misprints() -> String {
    let rows: String = MISPRINTS
        .iter()
        .map(|(place, printed, holds)| row(&[("", place), ("", printed), ("", holds)]))
        .collect();
    format!(
        "<h2>Misprints of the source put right</h2>\n{}",
        table(&["Where", "What it says", "What holds"], &rows)
    )
}

fn usage(facts: &Facts<'_>) -> String {
    let experiment = facts.identity.default_experiment;
    format!(
        "<h2>Use</h2>\n<ul>\n<li>Default experiment: {} s to {} s, communication step {} s.</li>\n\
         <li>While the inputs hold, the solution does not depend on the communication step: the integrator has its own \
         steps and events. Inputs are held between communication points, or follow their derivatives where given (FMI 2).</li>\n\
         <li>The state can be saved, restored and serialised; several instances may live in one process.</li>\n\
         <li>FMI 3: with early return allowed, a step ends at a stick-slip switch and event mode may be used.</li>\n</ul>\n\
         <h2>Source</h2>\n<p>The dissertation: I. Pires Macedo Oliveira dos Santos, <i>Torsional Friction-Induced Vibrations \
         in Slender Rotating Structures</i>, PUC-Rio, 2019; chapters 2 (friction laws), 4 (rig and parameters), 6 \
         (friction as a function of the acceleration).</p>",
        experiment.start_time, experiment.stop_time, experiment.step_size
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_effect_of_the_model_file_is_shown_as_its_author_wrote_it() {
        let effect: toml::Table = "name = \"pull\"\ntitle = \"A <b>cable</b>\"\nport = \"disc.torque\"\nequation = \"-a*max(angle, 0)\"\n"
            .parse()
            .unwrap();
        let html = written_effect(&toml::Value::Table(effect));
        assert!(html.contains("A &lt;b&gt;cable"), "{html}");
        assert!(
            html.contains("<code>disc.torque = -a*max(angle, 0)</code>"),
            "{html}"
        );
        assert!(html.contains("Source: the model file"), "{html}");
    }
}
