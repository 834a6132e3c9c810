//! What Table 4.7 says about the length of its records and about the formula of its amplitude pulse level.
//!
//! The records are lost, but their model is not. With s_m the standard deviation of the model's start-up over the length of
//! the record, and equal means, RMSE² = s_m² + s_e² − 2 PC s_m s_e fixes the record's standard deviation s_e, and is
//! solvable only if RMSE ≥ s_m √(1 − PC²). Since s_m falls with the length of the record, that is a shortest length; and any
//! formula of the amplitude pulse level over s_m and s_e can be held against the printed levels.

use super::start_up::{TABLE_4_7, start};
use crate::analysis::measures::{level_of_deviations, standard_deviation};
use crate::experiment::virtual_rig::{SAMPLE_STEP, reduced_rig};
use crate::experiment::{ExperimentError, Findings, Row, Table, Verdict};
use crate::plot::{Axis, Chart, Figure, Style};

/// Longest record considered [s].
const LONGEST: usize = 120;
/// Shortest record considered [s]; the start-up lasts that long.
const SHORTEST: usize = 5;

/// A formula over the standard deviations of model and record.
type Formula = fn(f64, f64) -> f64;

/// Formulas tried; all are 0 for equal deviations and 1 where only the record pulses.
const FORMULAS: [(&str, Formula); 4] = [
    ("|s_m − s_e|/(s_m + s_e)", level_of_deviations),
    ("|s_m − s_e|/max(s_m, s_e)", |model, record| {
        (model - record).abs() / model.max(record)
    }),
    ("|s_m − s_e|/s_e", |model, record| {
        (model - record).abs() / record
    }),
    ("|s_m² − s_e²|/(s_m² + s_e²)", |model, record| {
        (model * model - record * record).abs() / (model * model + record * record)
    }),
];

/// The record's standard deviation from the model's, the error and the correlation: the larger root, a vibration that
/// lasts, as the text describes it. `None` where no record is compatible.
fn record_deviation(model: f64, error: f64, correlation: f64) -> Option<f64> {
    let square = error * error - model * model * (1.0 - correlation * correlation);
    (square >= 0.0).then(|| correlation * model + square.sqrt())
}

/// Levels of the four starts for records of a common length, if the printed errors and correlations allow it.
fn levels(deviations: &[Vec<f64>], at: usize, formula: Formula) -> Option<Vec<f64>> {
    TABLE_4_7
        .iter()
        .zip(deviations)
        .map(|((_, error, correlation, _), model)| {
            let record = record_deviation(model[at], *error, *correlation)?;
            Some(formula(model[at], record))
        })
        .collect()
}

fn distance(levels: &[f64]) -> f64 {
    let squares: f64 = levels
        .iter()
        .zip(&TABLE_4_7)
        .map(|(ours, printed)| (ours - printed.3).powi(2))
        .sum();
    (squares / levels.len() as f64).sqrt()
}

/// The common length [s] at which a formula comes nearest to the printed levels, with its levels and their distance.
fn nearest(deviations: &[Vec<f64>], formula: Formula) -> Option<(usize, Vec<f64>, f64)> {
    (0..=LONGEST - SHORTEST)
        .filter_map(|at| {
            let levels = levels(deviations, at, formula)?;
            let distance = distance(&levels);
            Some((at + SHORTEST, levels, distance))
        })
        .min_by(|a, b| a.2.total_cmp(&b.2))
}

fn words(levels: &[f64]) -> String {
    let words: Vec<String> = levels.iter().map(|level| format!("{level:.3}")).collect();
    words.join(", ")
}

/// Table 4.7 held against itself.
pub fn consistency() -> Result<Findings, ExperimentError> {
    let rig = reduced_rig()?;
    let mut findings = Findings::default();
    let lengths: Vec<f64> = (SHORTEST..=LONGEST).map(|length| length as f64).collect();
    let mut deviations = Vec::new();
    let mut chart = Chart::new(
        Axis::new("length of the record [s]"),
        Axis::new("least RMSE at the printed PC, over the printed RMSE [1]").range(0.0, 3.0),
    );
    for (index, (speed, error, correlation, _)) in TABLE_4_7.iter().enumerate() {
        let run = start(&rig, *speed, LONGEST as f64)?;
        let model: Vec<f64> = lengths
            .iter()
            .map(|length| {
                standard_deviation(&run.omega[..=(length / SAMPLE_STEP).round() as usize])
            })
            .collect();
        let least: Vec<f64> = model
            .iter()
            .map(|model| model * (1.0 - correlation * correlation).sqrt() / error)
            .collect();
        let shortest = lengths
            .iter()
            .zip(&least)
            .find(|(_, least)| **least <= 1.0)
            .map_or(f64::NAN, |(length, _)| *length);
        findings.rows.push(Row::added(
            &format!(
                "{speed} rpm: shortest record with both RMSE {error} rad/s and PC {correlation}"
            ),
            format!("{shortest} s"),
        ));
        chart = chart.line(
            format!("{speed} rpm"),
            &lengths,
            &least,
            Style::series(index),
        );
        deviations.push(model);
    }
    if let Some(row) = findings.rows.first_mut() {
        row.remark = "RMSE ≥ s_m √(1 − PC²) whatever the record, with s_m the standard deviation of the model's start-up, which falls with the length. Taken for records that begin with the start, as Fig. 4.11 shows them.".to_owned();
    }
    let printed: Vec<f64> = TABLE_4_7.iter().map(|row| row.3).collect();
    let mut found = Vec::new();
    for (name, formula) in FORMULAS {
        let (length, levels, distance) = nearest(&deviations, formula).ok_or_else(|| {
            ExperimentError::Nothing("no common length allows the printed measures".to_owned())
        })?;
        found.push((name, length, levels, distance));
    }
    let others: Vec<String> = found[1..]
        .iter()
        .map(|(name, length, levels, distance)| {
            format!(
                "{name}: {} at {length} s, off by {distance:.3}",
                words(levels)
            )
        })
        .collect();
    let (name, length, levels, distance) = &found[0];
    let nearest = found[1..].iter().all(|other| *distance < 0.5 * other.3);
    findings.rows.push(
        Row::statement(
            "APL at 20, 30, 40, 50 rpm",
            &words(&printed),
            format!("{} at {length} s", words(levels)),
            Verdict::Open(if nearest {
                format!("the nearest of four formulas is {name}, which this project uses")
            } else {
                "no formula tried stands out".to_owned()
            }),
        )
        .remark(format!(
            "From the printed RMSE and PC and the model alone, over the one common length of record that suits each formula best; off by {distance:.3} (root mean square). Other formulas: {}. The printed reference for the formula is not part of the text at hand.",
            others.join("; ")
        )),
    );
    findings.picture(
        "table-4.7",
        "Length of the records",
        Figure::new("Below 1 the printed RMSE and PC are compatible (Table 4.7)").panel(
            340.0,
            chart.horizontal("compatible below", 1.0, Style::reference()),
        ),
    );
    let mut columns = vec![("length [s]".to_owned(), lengths)];
    for ((speed, ..), model) in TABLE_4_7.iter().zip(deviations) {
        columns.push((format!("s_m {speed} rpm [rad/s]"), model));
    }
    findings.tables.push(Table {
        name: "deviations".to_owned(),
        columns,
    });
    Ok(findings)
}
