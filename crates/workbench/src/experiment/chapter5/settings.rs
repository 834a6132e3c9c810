//! The virtual rigs laid open: what was set, by whom, and how far the facts to which they are calibrated are met.

use stickslip::plant::ModelFile;

use crate::calibrate::cycle::Cycle;
use crate::calibrate::target::{Goal, Point, Target};
use crate::experiment::virtual_rig::{
    VIRTUAL_FACTS, VIRTUAL_FULL_FACTS, VIRTUAL_FULL_RIG, VIRTUAL_RIG,
};
use crate::experiment::{ExperimentError, Findings, Row, Table, Verdict, short};
use crate::plot::{Axis, Chart, Figure, Marker, Style};

/// Settings and facts of the reduced virtual rig.
pub fn settings() -> Result<Findings, ExperimentError> {
    lay_open(
        "sec-5.1-virtual-rig",
        ("experiment-rig.toml", VIRTUAL_RIG),
        ("experiment.toml", VIRTUAL_FACTS),
    )
}

/// Settings and facts of the full virtual rig.
pub fn full_settings() -> Result<Findings, ExperimentError> {
    lay_open(
        "sec-5.3-virtual-rig",
        ("experiment-full-rig.toml", VIRTUAL_FULL_RIG),
        ("experiment-full.toml", VIRTUAL_FULL_FACTS),
    )
}

fn lay_open(
    name: &str,
    (model_file, model_text): (&str, &str),
    (target_file, target_text): (&str, &str),
) -> Result<Findings, ExperimentError> {
    let model = ModelFile::parse(model_text, model_file)?;
    let target = Target::parse(target_text, target_file, &model.rig)
        .map_err(|error| ExperimentError::Nothing(error.to_string()))?;
    let mut findings = Findings::default();
    for parameter in model.rig.parameters() {
        let origin = model.provenance.get(&parameter.name);
        let sought = target
            .parameter
            .iter()
            .any(|one| one.name == parameter.name);
        if !sought && model.rig.effect_infos(parameter.section).is_none() {
            continue;
        }
        let value = model.rig.parameter(&parameter.name).unwrap_or(f64::NAN);
        let source = origin.and_then(|origin| origin.source.clone());
        findings.rows.push(
            Row::added(
                &format!("{} [{}]", parameter.name, parameter.info.unit),
                format!("{value}"),
            )
            .remark(source.unwrap_or_default()),
        );
    }
    let mut misfits = Vec::new();
    let mut cycles = Vec::new();
    for point in &target.point {
        let cycle = Cycle::of(&model.rig, &point.operating())?;
        fact_rows(&mut findings, &mut misfits, point, &cycle);
        cycles.push(cycle);
    }
    if let Some(row) = findings.rows.first_mut() {
        row.remark = format!(
            "{}. Model file `crates/workbench/targets/{model_file}`, facts `crates/workbench/targets/{target_file}`: what is set here is set for all virtual experiments of the rig, and nothing else is",
            row.remark
        );
    }
    let numbers: Vec<f64> = (1..=misfits.len()).map(|number| number as f64).collect();
    findings.picture(
        name,
        "Facts met by the virtual rig",
        Figure::new("Distance of the virtual rig from the facts, in the order of the rows").panel(
            300.0,
            Chart::new(
                Axis::new("fact [1]").range(0.5, misfits.len() as f64 + 0.5),
                Axis::new("distance over bar [1]"),
            )
            .points(
                "virtual rig",
                &numbers,
                &misfits,
                Marker::Dot,
                Style::model(),
            )
            .horizontal("bar", 1.0, Style::reference())
            .horizontal("", -1.0, Style::reference()),
        ),
    );
    findings.tables.push(table(&target, &cycles));
    Ok(findings)
}

/// One row for each fact of a point; `misfits` gets its distance in bars.
fn fact_rows(findings: &mut Findings, misfits: &mut Vec<f64>, point: &Point, cycle: &Cycle) {
    let label = point.label();
    let source = point.source.clone().unwrap_or_default();
    let mut number = |name: &str, goal: Option<Goal>, ours: Option<f64>| {
        if let Some(goal) = goal {
            let ours = ours.unwrap_or(f64::NAN);
            misfits.push((ours / goal.value - 1.0) / goal.bar);
            let row = Row::number(&format!("{label}: {name}"), goal.value, ours, goal.bar);
            let verdict = calibrated(row.verdict.clone());
            findings
                .rows
                .push(row.verdict(verdict).remark(source.clone()));
        }
    };
    number("frequency [Hz]", point.frequency_hz, cycle.frequency);
    number(
        "half amplitude [rad/s]",
        point.half_amplitude,
        Some(cycle.half_amplitude()),
    );
    number(
        "lowest velocity [rad/s]",
        point.minimum_velocity,
        Some(cycle.minimum),
    );
    number(
        "highest velocity [rad/s]",
        point.maximum_velocity,
        Some(cycle.maximum),
    );
    if let Some(sticking) = point.sticking {
        let words = |sticks: bool| if sticks { "sticks" } else { "does not stick" };
        let holds = cycle.sticks_and_slips() == sticking;
        misfits.push(if holds { 0.0 } else { 2.0 });
        findings.rows.push(
            Row::statement(
                &format!("{label}: sticking"),
                words(sticking),
                format!(
                    "{}, {} … {} rad/s",
                    words(cycle.sticks_and_slips()),
                    short(cycle.minimum),
                    short(cycle.maximum)
                ),
                calibrated(Verdict::holds(holds, "")),
            )
            .remark(source),
        );
    }
}

/// A fact that was sought is met, not predicted.
fn calibrated(verdict: Verdict) -> Verdict {
    match verdict {
        Verdict::Reproduced => {
            Verdict::ReproducedWith("the virtual rig, which is calibrated to it".to_owned())
        }
        _ => Verdict::Open("the virtual rig is calibrated to it and does not meet it".to_owned()),
    }
}

fn table(target: &Target, cycles: &[Cycle]) -> Table {
    let points = |read: fn(&Point) -> f64| target.point.iter().map(read).collect::<Vec<_>>();
    let motions = |read: fn(&Cycle) -> f64| cycles.iter().map(read).collect::<Vec<_>>();
    Table::new(
        "facts",
        vec![
            ("speed [rpm]", points(|point| point.speed_rpm)),
            ("N2 [N]", points(|point| point.normal_force)),
            ("N1 [N]", points(|point| point.normal_force_1)),
            (
                "published frequency [Hz]",
                points(|point| point.frequency_hz.map_or(f64::NAN, |goal| goal.value)),
            ),
            (
                "frequency [Hz]",
                motions(|cycle| cycle.frequency.unwrap_or(f64::NAN)),
            ),
            ("lowest velocity [rad/s]", motions(|cycle| cycle.minimum)),
            ("highest velocity [rad/s]", motions(|cycle| cycle.maximum)),
            ("stick fraction", motions(|cycle| cycle.stick_fraction)),
            ("loop margin", motions(|cycle| cycle.loop_margin)),
        ],
    )
}
