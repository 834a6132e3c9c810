//! The page's text.

use std::fmt::Write as _;

use super::{Report, figures};
use crate::diagnose::catalogue::{Entry, entry};
use crate::diagnose::console::{answer, number, percent, readable};
use crate::diagnose::finding::{Finding, Measures, ParameterValue, VerdictName};
use crate::diagnose::show::LEAST_FLUCTUATION;
use crate::plot::Figure;

const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("zoom.js");

pub fn page(report: &Report<'_>) -> String {
    let finding = report.finding;
    let mut body = String::new();
    for section in [
        head(report),
        disagreement(report),
        ranking(finding),
        before_and_after(report),
        parameters(report),
        floor(finding),
        confusions(finding),
        usage(),
        notes(finding),
    ] {
        body.push_str(&section);
    }
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n\
         <title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n{body}\
         <script>\n//<![CDATA[\n{SCRIPT}//]]>\n</script>\n</body>\n</html>\n",
        title = escape(&format!("{}: {}", report.case.name, headline(finding))),
    )
}

/// The answer in half a sentence.
fn headline(finding: &Finding) -> String {
    let names: Vec<String> = finding
        .effects
        .iter()
        .map(|effect| readable(&effect.name))
        .collect();
    match finding.verdict {
        VerdictName::NothingMissing => "nothing is missing".to_owned(),
        VerdictName::Parameters => "other parameters, no missing effect".to_owned(),
        VerdictName::Named => format!("missing: {}", names.join(" and ")),
        VerdictName::Ambiguous => {
            let names: Vec<String> = finding
                .alternatives
                .iter()
                .map(|name| readable(name))
                .collect();
            format!("missing: {}", names.join(" or "))
        }
        VerdictName::NotInCatalogue => {
            "something is missing that the catalogue does not have".to_owned()
        }
    }
}

fn head(report: &Report<'_>) -> String {
    let finding = report.finding;
    let state = if finding.is_settled() {
        "closed"
    } else {
        "open"
    };
    let mut text = format!(
        "<p class=\"case\">Diagnosis of {}</p>\n<h1>{}</h1>\n<div class=\"answer {state}\">\n",
        escape(&report.case.name),
        escape(&capital(&headline(finding)))
    );
    for line in answer(finding) {
        let _ = writeln!(text, "<p>{}</p>", escape(&line));
    }
    text.push_str("</div>\n<div class=\"tiles\">\n");
    let mut tile = |value: String, what: &str| {
        let _ = writeln!(
            text,
            "<div class=\"tile\"><b>{}</b><span>{}</span></div>",
            escape(&value),
            escape(what)
        );
    };
    if let Some(gap) = &finding.gap {
        let errors = gap.through_fmu.fmi3;
        tile(
            number(errors.before),
            "window error before, in sensor deviations",
        );
        tile(number(errors.after), "after, through the amended FMU");
        tile(number(errors.noise_floor), "what noise alone gives");
        tile(
            errors.closed.map_or("no gap".to_owned(), percent),
            "of the gap closed",
        );
    }
    text.push_str("</div>\n");
    text
}

fn disagreement(report: &Report<'_>) -> String {
    let mut text = String::from("<h2>Where model and records disagree</h2>\n");
    let significant: Vec<_> = report
        .finding
        .structure
        .iter()
        .filter(|place| place.significant)
        .collect();
    if significant.is_empty() {
        text.push_str("<p>No coordinate shows structure beyond what chance gives.</p>\n");
    } else {
        text.push_str(
            "<p>A free residual torque over one coordinate after the other, judged on windows it was not fitted to; \
             strongest first.</p>\n<table><tr><th>coordinate</th><th>equation</th><th class=\"n\">gain</th>\
             <th class=\"n\">95 % interval</th></tr>\n",
        );
        for place in significant {
            let _ = writeln!(
                text,
                "<tr><td>{}</td><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{} … {}</td></tr>",
                escape(&readable(&place.coordinate)),
                escape(&place.equation),
                number(place.gain),
                number(place.interval95[0]),
                number(place.interval95[1])
            );
        }
        text.push_str("</table>\n");
    }
    text.push_str(&figure(
        &figures::residuals(report.residuals_before, report.residuals_after),
        "The torque that would have to be added for the model to follow the records it learned from, in pieces of 0.05 s \
         while the disc slides. Dots: single pieces before. Lines: means of bins before and after.",
    ));
    text
}

fn ranking(finding: &Finding) -> String {
    if finding.ranking.is_empty() {
        return String::new();
    }
    format!(
        "<h2>The candidates</h2>\n{}",
        figure(
            &figures::ranking(finding),
            "Each effect fitted on top of the model together with its nominal parameters, and judged on windows it was not \
             fitted to. A gain near zero says that chance does as well. Bars show the first round, before any effect was kept.",
        )
    )
}

fn before_and_after(report: &Report<'_>) -> String {
    let mut text = String::from("<h2>Before and after on the held-out record</h2>\n");
    if let Some(gap) = &report.finding.gap {
        let (native, fmu, free) = (gap.held_out, gap.through_fmu, gap.free_run);
        let _ = write!(
            text,
            "<table><tr><th>restarted windows</th><th class=\"n\">before</th><th class=\"n\">after</th>\
             <th class=\"n\">noise floor</th><th class=\"n\">closed</th></tr>\n\
             <tr><td>native</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td></tr>\n\
             <tr><td>FMU, FMI 3.0</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td></tr>\n\
             <tr><td>FMU, FMI 2.0</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\"></td><td class=\"n\"></td></tr></table>\n",
            number(native.before),
            number(native.after),
            number(native.noise_floor),
            native.closed.map_or("no gap".to_owned(), percent),
            number(fmu.fmi3.before),
            number(fmu.fmi3.after),
            number(fmu.fmi3.noise_floor),
            fmu.fmi3.closed.map_or("no gap".to_owned(), percent),
            number(fmu.fmi2_before),
            number(fmu.fmi2_after),
        );
        let _ = write!(
            text,
            "<table><tr><th>free run, velocity of the disc</th><th class=\"n\">RMSE [rad/s]</th>\
             <th class=\"n\">RMSE/ω_ref</th><th class=\"n\">PC</th><th class=\"n\">APL</th></tr>\n{}{}{}</table>\n\
             <p class=\"hint\">ω_ref = {} rad/s, the mean speed of the gearbox output. A limit cycle that is a little out of \
             phase has a large free-run error however right the model is: the windows are what judges.</p>\n",
            measures("before", &free.before),
            measures("after", &free.after),
            measures("after, through the FMU", &free.after_through_fmu),
            number(free.reference_speed)
        );
    }
    text.push_str(&figure(
        &figures::time_series(report.comparison),
        "Velocity of the disc: each window restarted from its own start, and one run from the record's start.",
    ));
    text.push_str(&figure(
        &figures::portraits(report.comparison),
        "Phase portrait, and the models' friction torque over velocity and over the phase-plane angle α.",
    ));
    text.push_str(&figure(
        &figures::spectra(report.comparison),
        "Spectra of the disc's velocity, free run.",
    ));
    text
}

fn measures(label: &str, measures: &Measures) -> String {
    let cell = |value: Option<f64>| value.map_or("–".to_owned(), number);
    format!(
        "<tr><td>{label}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td></tr>\n",
        cell(measures.rmse),
        cell(measures.nrmse),
        cell(measures.pc),
        cell(measures.apl)
    )
}

fn parameters(report: &Report<'_>) -> String {
    let finding = report.finding;
    let mut text = String::from(
        "<h2>Parameters</h2>\n<table><tr><th>parameter</th><th class=\"n\">before</th><th class=\"n\">after</th>\
         <th class=\"n\">95 % interval</th><th>unit</th></tr>\n",
    );
    let effects = finding
        .effects
        .iter()
        .flat_map(|effect| effect.parameters.values());
    for value in effects.chain(finding.parameters.values()) {
        let before = report.case.model.rig.parameter(&value.model_parameter);
        text.push_str(&parameter_row(value, before));
    }
    text.push_str("</table>\n");
    text
}

fn parameter_row(value: &ParameterValue, before: Option<f64>) -> String {
    let interval = value.interval95.map_or("held".to_owned(), |[low, high]| {
        format!("{} … {}", number(low), number(high))
    });
    format!(
        "<tr><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{interval}</td><td>{}</td></tr>\n",
        escape(&value.model_parameter),
        before.map_or("–".to_owned(), number),
        number(value.value),
        escape(&value.unit)
    )
}

fn floor(finding: &Finding) -> String {
    let friction = if finding.friction_fluctuation >= LEAST_FLUCTUATION {
        format!(
            "The friction of these records fluctuates at random by {}; the floor contains it.",
            percent(finding.friction_fluctuation)
        )
    } else {
        "These records show no random friction to speak of.".to_owned()
    };
    format!(
        "<h2>The noise floor</h2>\n<p>The window error is the root mean square of model minus reading, in units of the \
         sensors' standard deviations (a rounded encoder step counts as step/√12). Each window starts from the state from \
         which the model fits its readings best. The floor is what the right model would show: sensor noise less what the \
         starts absorb. {friction} The share closed is (before² − after²)/(before² − floor²).</p>\n"
    )
}

fn confusions(finding: &Finding) -> String {
    let mut text = String::new();
    let names = finding.effects.iter().map(|effect| effect.name.as_str());
    let mut seen: Vec<&'static Entry> = Vec::new();
    for name in names.chain(finding.alternatives.iter().map(String::as_str)) {
        if let Some(entry) = entry(name)
            && !seen.iter().any(|known| known.name == entry.name)
        {
            seen.push(entry);
        }
    }
    if !seen.is_empty() {
        text.push_str("<h2>What it could be confused with</h2>\n<ul>\n");
        for entry in seen {
            let rivals: Vec<String> = entry.confusable.iter().map(|name| readable(name)).collect();
            let rivals = if rivals.is_empty() {
                "nothing in the catalogue".to_owned()
            } else {
                rivals.join(", ")
            };
            let _ = writeln!(
                text,
                "<li><b>{}</b> ({}): {}. Looks most like: {}.</li>",
                escape(&readable(entry.name)),
                escape(entry.description),
                escape(entry.signature),
                escape(&rivals)
            );
        }
        text.push_str("</ul>\n");
    }
    if let Some(experiment) = &finding.experiment {
        let _ = writeln!(
            text,
            "<p><b>Experiment proposed:</b> {} The inputs are in <code>{}</code>; it decides with a probability of {}.</p>",
            escape(&experiment.description),
            escape(&experiment.file),
            percent(experiment.expected_power)
        );
    }
    text
}

fn usage() -> String {
    "<h2>How to use the amended FMU</h2>\n\
     <p><code>ReducedRig.fmi2.fmu</code> and <code>ReducedRig.fmi3.fmu</code> beside this page are co-simulation FMUs of \
     <code>model.amended.toml</code>. Inputs are <code>u</code> [V] and <code>N2</code> [N]; all parameters of the model \
     file can be set. Any record with these columns drives them:</p>\n\
     <pre>stickslip simulate ReducedRig.fmi3.fmu --input held-out.csv --out result\n\n\
     # or in Python\nimport fmpy\nresult = fmpy.simulate_fmu('ReducedRig.fmi3.fmu', stop_time=20, output_interval=0.01,\n    \
     start_values={'u': 3.0, 'N2': 40.0})</pre>\n"
        .to_owned()
}

fn notes(finding: &Finding) -> String {
    let mut text = String::new();
    if !finding.notes.is_empty() {
        text.push_str("<h2>About the records</h2>\n<ul>\n");
        for note in &finding.notes {
            let _ = writeln!(text, "<li>{}</li>", escape(note));
        }
        text.push_str("</ul>\n");
    }
    let _ = writeln!(
        text,
        "<p class=\"hint\">Found in {} s. Pictures zoom with a double click (Shift for back) or Ctrl and the wheel, move \
         when dragged, and go back with Escape.</p>",
        number(finding.seconds)
    );
    text
}

fn figure(figure: &Figure, caption: &str) -> String {
    // Inside HTML the namespace is known; naming it would look like a reference to elsewhere.
    let svg = figure
        .to_svg()
        .replacen(" xmlns=\"http://www.w3.org/2000/svg\"", "", 1);
    format!(
        "<figure>\n{svg}<figcaption>{}</figcaption>\n</figure>\n",
        escape(caption)
    )
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_uppercase().chain(letters).collect()
    })
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}
