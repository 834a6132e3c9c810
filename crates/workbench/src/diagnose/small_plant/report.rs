//! A small plant's `report.html`: the rig's page with the pictures that such a plant has.

use std::fmt::Write as _;

use super::case::SmallCase;
use super::console::{answer, size};
use super::finding::SmallFinding;
use super::showing::{Course, balance, held_out_course};
use crate::diagnose::console::{number, readable};
use crate::diagnose::made::Made;
use crate::diagnose::report::figures::ranking;
use crate::diagnose::report::markup::{escape, figure};
use crate::diagnose::report::page::document;
use crate::plot::{Axis, Chart, Figure, Marker, Panel, Style};
use inference::body::balance::Compared;
use inference::body::model::Model;
use inference::body::structure::COORDINATES;
use stickslip::body::{Dimension, Path};

/// Bins of a residual over a coordinate.
const BINS: usize = 32;
/// Single values shown in a picture.
const SHOWN: usize = 3000;
/// Length of the detail of the held-out record [s].
const DETAIL: f64 = 4.0;

/// The page as HTML that is well-formed XML too.
#[must_use]
pub fn page(
    case: &SmallCase,
    made: &Made,
    found: &SmallFinding,
    [before, after]: [&Model; 2],
) -> String {
    let names: Vec<String> = found
        .finding
        .effects
        .iter()
        .map(|effect| readable(&effect.name))
        .collect();
    let headline = if names.is_empty() {
        readable(found.finding.verdict.word())
    } else {
        format!(
            "{}: {}",
            readable(found.finding.verdict.word()),
            names.join(", ")
        )
    };
    let body: String = [
        head(case, found, &headline),
        steps(found),
        disagreement(case, found, before, after),
        candidates(found),
        held_out(case, before, after),
        numbers(case, found),
        confusions(case, found),
        notes(found),
        made.section(None),
    ]
    .concat();
    document(&format!("{}: {headline}", case.name), &body)
}

fn head(case: &SmallCase, found: &SmallFinding, headline: &str) -> String {
    let state = if found.is_settled() { "closed" } else { "open" };
    let mut text = format!(
        "<p class=\"case\">Diagnosis of {} ({})</p>\n<h1>{}</h1>\n<div class=\"answer {state}\">\n",
        escape(&case.name),
        found.small_plant.kind,
        escape(headline)
    );
    for line in answer(found) {
        let _ = writeln!(text, "<p>{}</p>", escape(&line));
    }
    text.push_str("</div>\n");
    text
}

fn steps(found: &SmallFinding) -> String {
    let mut text = format!(
        "<h2>Error of the {}</h2>\n<table><tr><th>model</th><th class=\"n\">learned from</th><th class=\"n\">held out</th></tr>\n",
        escape(&found.small_plant.quantity)
    );
    for step in &found.small_plant.steps {
        let name = step
            .effect
            .as_ref()
            .map_or("the analyst's, refitted".to_owned(), |effect| {
                format!("+ {}", readable(effect))
            });
        let _ = writeln!(
            text,
            "<tr><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td></tr>",
            escape(&name),
            size(&step.learned, &found.small_plant.unit),
            size(&step.held_out, &found.small_plant.unit)
        );
    }
    text.push_str(
        "</table>\n<p class=\"hint\">Root mean square and, in brackets, ‖y − ŷ‖/‖y‖. Every model was fitted to the records learned from alone.</p>\n",
    );
    text
}

fn disagreement(case: &SmallCase, found: &SmallFinding, before: &Model, after: &Model) -> String {
    let mut text = String::from("<h2>Where model and records disagree</h2>\n");
    let significant: Vec<_> = found
        .finding
        .structure
        .iter()
        .filter(|place| place.significant)
        .collect();
    if significant.is_empty() {
        text.push_str("<p>No coordinate shows structure beyond what chance gives.</p>\n");
    } else {
        text.push_str("<table><tr><th>coordinate</th><th class=\"n\">gain</th><th class=\"n\">95 % interval</th></tr>\n");
        for place in significant {
            let _ = writeln!(
                text,
                "<tr><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td></tr>",
                escape(&readable(&place.coordinate)),
                number(place.gain),
                place.interval95.map_or(String::new(), |[low, high]| {
                    format!("{} … {}", number(low), number(high))
                })
            );
        }
        text.push_str("</table>\n");
    }
    let balance = balance(case);
    let (old, new) = (balance.compared(before), balance.compared(after));
    let mut picture = Figure::new("");
    let has_load = case.model.has_load();
    let shown: Vec<_> = COORDINATES
        .iter()
        .filter(|c| (has_load || !c.name.starts_with("load")) && c.is_along(case.model.model.path))
        .collect();
    for pair in shown.chunks(2) {
        let panels = pair
            .iter()
            .map(|coordinate| {
                let x = |all: &[Compared]| -> Vec<f64> {
                    all.iter()
                        .map(|c| (coordinate.of)(c, &case.scales))
                        .collect()
                };
                let axis = Axis::new(format!(
                    "{} {}",
                    coordinate.label,
                    unit(coordinate.name, case)
                ));
                let panel: Box<dyn Panel> =
                    Box::new(over(case, axis, (&x(&old), &old), (&x(&new), &new)));
                panel
            })
            .collect();
        picture = picture.row(250.0, panels);
    }
    text.push_str(&figure(
        &picture,
        "What was measured less what the model needs, on the records learned from. Dots: single values before. Lines: means of bins before and after.",
    ));
    text
}

fn unit(coordinate: &str, case: &SmallCase) -> &'static str {
    let turn = case.model.model.path == Path::Turn;
    match coordinate {
        "velocity" if turn => "[rad/s]",
        "velocity" => "[m/s]",
        "acceleration" if turn => "[rad/s²]",
        "acceleration" => "[m/s²]",
        "phase_angle" => "[rad]",
        "position" | "position_by_direction" | "angle_within_a_turn" if turn => "[rad]",
        "position" | "position_by_direction" => "[m]",
        "time" => "[s]",
        _ => "[1]",
    }
}

fn force_axis(case: &SmallCase, what: &str) -> Axis {
    let unit = Dimension::Force.unit(case.kind(), case.model.model.path);
    Axis::new(format!("{what} [{}]", unit.replace('.', " ")))
}

fn over(
    case: &SmallCase,
    axis: Axis,
    (old_x, old): (&[f64], &[Compared]),
    (new_x, new): (&[f64], &[Compared]),
) -> Chart {
    let residual =
        |all: &[Compared]| -> Vec<f64> { all.iter().map(|c| c.measured - c.model).collect() };
    let (old_y, new_y) = (residual(old), residual(new));
    let stride = old_x.len().div_ceil(SHOWN).max(1);
    let thin = |series: &[f64]| -> Vec<f64> { series.iter().step_by(stride).copied().collect() };
    let dots = Style {
        colour: "#e8b9a2",
        ..Style::series(1)
    };
    let (middle, mean) = binned(old_x, &old_y);
    let (new_middle, new_mean) = binned(new_x, &new_y);
    Chart::new(axis, force_axis(case, "residual"))
        .points("", &thin(old_x), &thin(&old_y), Marker::Dot, dots.wide(0.0))
        .horizontal("", 0.0, Style::reference())
        .line("before", &middle, &mean, Style::series(1).wide(2.0))
        .line("after", &new_middle, &new_mean, Style::series(0).wide(2.0))
}

/// Means of bins that hold equally many values.
fn binned(x: &[f64], y: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let mut order: Vec<usize> = (0..x.len()).collect();
    order.sort_by(|a, b| x[*a].total_cmp(&x[*b]));
    order
        .chunks(x.len().div_ceil(BINS).max(1))
        .map(|bin| {
            let mean = |of: &[f64]| bin.iter().map(|at| of[*at]).sum::<f64>() / bin.len() as f64;
            (mean(x), mean(y))
        })
        .unzip()
}

fn candidates(found: &SmallFinding) -> String {
    if found.finding.ranking.is_empty() {
        return String::new();
    }
    format!(
        "<h2>The candidates</h2>\n{}",
        figure(
            &ranking(&found.finding),
            "Each effect fitted on top of the model together with its numbers, and judged on parts of the records that were left out of the fit. \
             Bars show the first round, before any effect was kept.",
        )
    )
}

fn held_out(case: &SmallCase, before: &Model, after: &Model) -> String {
    let (old, new) = (held_out_course(case, before), held_out_course(case, after));
    let value = || match case.kind() {
        kind if kind.runs_alone() => Axis::new("angle [rad]"),
        _ => force_axis(case, "force"),
    };
    let end = old.time.last().copied().unwrap_or(0.0);
    let begin = old.time.first().copied().unwrap_or(0.0);
    let chart = |title: &str, from: f64, to: f64| {
        Chart::new(Axis::new("time [s]").range(from, to), value())
            .title(title)
            .line("measured", &old.time, &old.measured, Style::measured())
            .line("before", &old.time, &old.model, Style::series(1))
            .line("after", &new.time, &new.model, Style::series(0))
    };
    let error = |course: &Course| -> Vec<f64> {
        course
            .measured
            .iter()
            .zip(&course.model)
            .map(|(y, m)| y - m)
            .collect()
    };
    let errors = Chart::new(Axis::new("time [s]"), value())
        .title("measured less model")
        .line("before", &old.time, &error(&old), Style::series(1))
        .line("after", &new.time, &error(&new), Style::series(0));
    let picture = Figure::new("")
        .panel(260.0, chart("held-out record", begin, end))
        .panel(
            260.0,
            chart(
                "its last seconds",
                (end - DETAIL * case.scales.period).max(begin),
                end,
            ),
        )
        .panel(220.0, errors);
    format!(
        "<h2>Before and after on the held-out record</h2>\n{}",
        figure(
            &picture,
            "The analyst's model with its numbers refitted, and the amended model."
        )
    )
}

fn numbers(case: &SmallCase, found: &SmallFinding) -> String {
    let mut text = String::from(
        "<h2>Parameters</h2>\n<table><tr><th>parameter</th><th class=\"n\">before</th><th class=\"n\">after</th>\
         <th class=\"n\">95 % interval</th><th>unit</th></tr>\n",
    );
    let before = |name: &str| {
        case.model.model.terms().iter().find_map(|term| {
            let at = term.entry.parameters.iter().position(|parameter| {
                super::model_file::dotted(term.entry, parameter.key) == name
            })?;
            Some(term.values[at])
        })
    };
    let effects = found
        .finding
        .effects
        .iter()
        .flat_map(|effect| effect.parameters.values());
    for value in effects.chain(found.finding.parameters.values()) {
        let interval = value.interval95.map_or("–".to_owned(), |[low, high]| {
            format!("{} … {}", number(low), number(high))
        });
        let _ = writeln!(
            text,
            "<tr><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{interval}</td><td>{}</td></tr>",
            escape(&value.model_parameter),
            before(&value.model_parameter).map_or("–".to_owned(), number),
            number(value.value),
            escape(&value.unit)
        );
    }
    text.push_str("</table>\n");
    text
}

fn confusions(case: &SmallCase, found: &SmallFinding) -> String {
    let mut text = String::from("<h2>What it could be confused with</h2>\n<ul>\n");
    for effect in &found.finding.effects {
        if let Ok(entry) = case.effect(&effect.name) {
            let rivals: Vec<String> = entry.confusable.iter().map(|name| readable(name)).collect();
            let _ = writeln!(
                text,
                "<li><b>{}</b> ({}): {}. Looks most like: {}.</li>",
                escape(&readable(entry.name)),
                escape(entry.description),
                escape(entry.signature),
                escape(&rivals.join(", "))
            );
        }
    }
    if found.finding.effects.is_empty() {
        return String::new();
    }
    text.push_str("</ul>\n");
    text
}

fn notes(found: &SmallFinding) -> String {
    let mut text = String::from("<h2>Notes</h2>\n<ul>\n");
    for note in &found.finding.notes {
        let _ = writeln!(text, "<li>{}</li>", escape(note));
    }
    text.push_str("</ul>\n");
    text
}
