//! The page's text.

use std::fmt::Write as _;

use super::candidates::candidates;
use super::figures::Scaling;
use super::markup::{capital, escape, figure, table};
use super::residuals::{decisive, others, residuals};
use super::{Report, figures};
use crate::diagnose::amend::fmu_files;
use crate::diagnose::catalogue::{Entry, entry};
use crate::diagnose::console::{answer, number, percent, readable, shown_unit};
use crate::diagnose::finding::{Disagreement, Finding, ParameterValue, VerdictName};
use crate::diagnose::gap::Measures;
use crate::diagnose::sensors::in_words;
use crate::diagnose::show::LEAST_FLUCTUATION;
use crate::plot::Figure;
use stickslip::plant::{Rig, RigKind};

const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("zoom.js");

pub fn page(report: &Report<'_>) -> String {
    let finding = report.finding;
    let scaling = &Scaling::of(report.comparison, report.case.model.rig.gearbox.ratio);
    let mut all = residuals(report.residuals_before, report.residuals_after, scaling);
    let (first, caption) = decisive(finding, &mut all, report.comparison, scaling);
    let mut body = String::new();
    for section in [
        head(report),
        figure(&first, &caption),
        disagreement(finding, &others(all)),
        candidates(finding),
        learned(finding),
        before_and_after(report, scaling),
        parameters(report),
        floor(finding),
        confusions(finding),
        usage(&report.case.model.rig),
        notes(finding),
        report
            .made
            .section(Some(&in_words(&report.case.instruments))),
    ] {
        body.push_str(&section);
    }
    let title = format!("{}: {}", report.case.name, headline(finding));
    document(&title, &body)
}

/// A self-contained page from its title, as plain text, and its body, as HTML.
pub fn document(title: &str, body: &str) -> String {
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n\
         <title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n{body}\
         <script>\n//<![CDATA[\n{SCRIPT}//]]>\n</script>\n</body>\n</html>\n",
        title = escape(title),
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
            match names.len() {
                1 => format!("probably missing: {}", names[0]),
                _ => format!("missing: {}", names.join(" or ")),
            }
        }
        VerdictName::Located => "where model and records disagree".to_owned(),
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
    text.push_str(&added(finding));
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

/// The numbers of the effects that were added.
fn added(finding: &Finding) -> String {
    let rows: Vec<Vec<String>> = finding
        .effects
        .iter()
        .flat_map(|effect| effect.parameters.values())
        .map(|value| {
            vec![
                value.model_parameter.clone(),
                number(value.value),
                interval(value),
                shown_unit(&value.unit),
            ]
        })
        .collect();
    if rows.is_empty() {
        return String::new();
    }
    table(
        &[
            ("added", false),
            ("value", true),
            ("95 % interval", true),
            ("unit", false),
        ],
        &rows,
    )
}

fn interval(value: &ParameterValue) -> String {
    value.interval95.map_or("held".to_owned(), |[low, high]| {
        format!("{} … {}", number(low), number(high))
    })
}

fn disagreement(finding: &Finding, others: &Figure) -> String {
    let mut text = String::from("<h2>Where model and records disagree</h2>\n");
    text.push_str(&places(
        &finding.structure,
        "No coordinate shows structure beyond what chance gives.",
        "A free residual torque over one coordinate after the other, entered as one more hypothesis; strongest first.",
    ));
    if !finding.structure_left.is_empty() {
        text.push_str(&places(
            &finding.structure_left,
            "With the amended model no coordinate shows more structure than a right model leaves.",
            "With the amended model there is still structure:",
        ));
    }
    let _ = writeln!(
        text,
        "<details>\n<summary>The residual torque over all other coordinates</summary>\n{}</details>",
        figure(
            others,
            "Dots: single pieces before. Lines: means of bins before and after. Those on the disc are while it slides."
        )
    );
    text.push_str(
        "<p class=\"hint\">Plots zoom into a rectangle drawn with the mouse, or about the pointer with Ctrl and the wheel; \
         Shift and dragging moves them, a double click shows one whole again, Escape all.</p>\n",
    );
    text
}

/// The places with significant structure as a table, under `some`; or `none`.
fn places(all: &[Disagreement], none: &str, some: &str) -> String {
    let rows: Vec<Vec<String>> = all
        .iter()
        .filter(|place| place.significant)
        .map(|place| {
            let band = place.band.map_or(String::new(), |[low, high]| {
                format!(", {low:.2} … {high:.2} Hz")
            });
            vec![
                readable(&place.coordinate) + &band,
                place.equation.clone(),
                number(place.gain),
            ]
        })
        .collect();
    if rows.is_empty() {
        return format!("<p>{}</p>\n", escape(none));
    }
    let columns = [
        ("coordinate", false),
        ("torque on", false),
        ("gain in log evidence", true),
    ];
    format!("<p>{}</p>\n{}", escape(some), table(&columns, &rows))
}

fn before_and_after(report: &Report<'_>, scaling: &Scaling) -> String {
    let mut text = String::from("<h2>Before and after on the held-out record</h2>\n");
    if let Some(gap) = &report.finding.gap {
        let (native, fmu, free) = (gap.held_out, gap.through_fmu, gap.free_run);
        let closed = |closed: Option<f64>| closed.map_or("no gap".to_owned(), percent);
        let row = |label: &str, cells: [String; 4]| {
            let mut row = vec![label.to_owned()];
            row.extend(cells);
            row
        };
        text.push_str(&table(
            &[
                ("restarted windows", false),
                ("before", true),
                ("after", true),
                ("noise floor", true),
                ("closed", true),
            ],
            &[
                row(
                    "native",
                    [
                        number(native.before),
                        number(native.after),
                        number(native.noise_floor),
                        closed(native.closed),
                    ],
                ),
                row(
                    "through the FMUs, FMI 3.0",
                    [
                        number(fmu.fmi3.before),
                        number(fmu.fmi3.after),
                        number(fmu.fmi3.noise_floor),
                        closed(fmu.fmi3.closed),
                    ],
                ),
                row(
                    "through the FMUs, FMI 2.0",
                    [
                        number(fmu.fmi2_before),
                        number(fmu.fmi2_after),
                        String::new(),
                        String::new(),
                    ],
                ),
            ],
        ));
        text.push_str(&table(
            &[
                ("free run, velocity of the disc", false),
                ("RMSE [rad/s]", true),
                ("RMSE/ω_ref", true),
                ("PC", true),
                ("APL", true),
            ],
            &[
                row("before", measures(&free.before)),
                row("after", measures(&free.after)),
                row("after, through the FMU", measures(&free.after_through_fmu)),
            ],
        ));
        let aside = if gap.windows_left_aside > 0 {
            format!(
                " {} of {} windows are left aside: one of the models cannot run through them.",
                gap.windows_left_aside, gap.windows
            )
        } else {
            String::new()
        };
        let _ = writeln!(
            text,
            "<p class=\"hint\">ω_ref = {} rad/s, the mean speed of the gearbox output. A limit cycle that is a little out of \
             phase has a large free-run error however right the model is: the windows are what judges.{aside}</p>",
            number(free.reference_speed)
        );
    }
    text.push_str(&figure(
        &figures::free_run(report.comparison),
        "Velocity of the disc in one run from the record's start.",
    ));
    text.push_str(&figure(
        &figures::portraits(report.comparison, report.residuals_held_out, scaling),
        &format!(
            "Phase portrait, and the friction torque over velocity and over the phase-plane angle α (with {} rad/s and {} rad/s² \
             as its scales): of both models in the restarted windows, and as measured, in pieces of {} s. Torques beside the \
             contact's, such as an unbalance, are not in it.",
            number(scaling.angle.0),
            number(scaling.angle.1),
            number(scaling.piece())
        ),
    ));
    text.push_str(&figure(
        &figures::spectra(report.comparison, scaling),
        "Spectra of the disc's velocity, free run.",
    ));
    text
}

fn measures(measures: &Measures) -> [String; 4] {
    [measures.rmse, measures.nrmse, measures.pc, measures.apl]
        .map(|value| value.map_or("–".to_owned(), number))
}

fn parameters(report: &Report<'_>) -> String {
    let finding = report.finding;
    let effects = finding
        .effects
        .iter()
        .flat_map(|effect| effect.parameters.values());
    let rows: Vec<Vec<String>> = effects
        .chain(finding.parameters.values())
        .map(|value| {
            let before = report.case.model.rig.parameter(&value.model_parameter);
            let change = before
                .filter(|before| *before != 0.0)
                .map_or("–".to_owned(), |before| {
                    format!("{:+.1} %", 100.0 * (value.value / before - 1.0))
                });
            vec![
                value.model_parameter.clone(),
                before.map_or("–".to_owned(), number),
                number(value.value),
                change,
                interval(value),
                shown_unit(&value.unit),
            ]
        })
        .collect();
    if rows.is_empty() {
        return "<h2>Parameters</h2>\n<p>All as they were.</p>\n".to_owned();
    }
    let columns = [
        ("parameter", false),
        ("before", true),
        ("after", true),
        ("change", true),
        ("95 % interval", true),
        ("unit", false),
    ];
    format!("<h2>Parameters</h2>\n{}", table(&columns, &rows))
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

/// The function that was learned.
fn learned(finding: &Finding) -> String {
    let Some(term) = &finding.learned else {
        return String::new();
    };
    let end = if term.period.is_some() {
        String::new()
    } else {
        " Beyond the knots it keeps its last value.".to_owned()
    };
    format!(
        "<h2>What was learned instead of a cause</h2>\n<p>No effect of the catalogue explains what is left. A free function of \
         {} at {} gains {} in log evidence. The amended model and its FMUs have it as a table under the name <b>{}</b>, \
         with the equation <code>{}</code>.{end}</p>\n{}",
        escape(&readable(&term.coordinate)),
        escape(&term.port),
        number(term.gain),
        escape(&term.name),
        escape(&term.equation),
        figure(
            &figures::learned(term),
            "The function with the 95 % intervals of its values at the knots.",
        )
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

fn usage(rig: &Rig<f64>) -> String {
    let [fmi2, fmi3] = fmu_files(rig);
    let (inputs, columns) = match rig.kind() {
        RigKind::Reduced => (
            "<code>u</code> [V] and <code>N2</code> [N]",
            "'time', 'u', 'N2'",
        ),
        RigKind::Full => (
            "<code>u</code> [V], <code>N2</code> and <code>N1</code> [N]",
            "'time', 'u', 'N2', 'N1'",
        ),
    };
    format!(
        "<h2>How to use the amended FMU</h2>\n\
     <p><code>{fmi2}</code> and <code>{fmi3}</code> beside this page are co-simulation FMUs of \
     <code>model.amended.toml</code>. Inputs are {inputs}; all parameters of the model \
     file can be set. Any record with these columns drives them:</p>\n\
     <pre>stickslip simulate {fmi3} --inputs held-out.csv --out result\n\n\
     # or in Python\nimport fmpy\nrecord = fmpy.read_csv('held-out.csv')\n\
     result = fmpy.simulate_fmu('{fmi3}', input=record[[{columns}]],\n    \
     stop_time=record['time'][-1], output_interval=0.01)</pre>\n"
    )
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
        "<p class=\"hint\">Found in {} s.</p>",
        number(finding.seconds)
    );
    text
}
