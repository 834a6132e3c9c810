//! Section 6.4: bifurcation diagrams of the second law, Figs 6.14 and 6.15.

use crate::experiment::virtual_rig::{Operation, Run, two_gaussian_rig};
use crate::experiment::{ExperimentError, Findings, Row, Table, Verdict};
use crate::plot::{Axis, Chart, Figure, Marker, Style};

/// One column of a diagram.
struct Column {
    parameter: f64,
    lowest: f64,
    highest: f64,
    sticks: bool,
}

/// Velocity range above which a motion counts as a vibration [rad/s].
const VIBRATES: f64 = 0.05;

fn column(parameter: f64, operation: &Operation) -> Result<Column, ExperimentError> {
    let run = Run::of(
        &two_gaussian_rig()?,
        &Operation {
            duration: 10.0,
            ..*operation
        },
    )?;
    let (lowest, highest) = run.range();
    Ok(Column {
        parameter,
        lowest,
        highest,
        sticks: run.stick_fraction() > 0.0 && highest > VIBRATES,
    })
}

fn diagram(title: &str, label: &str, columns: &[Column], facts: &[(f64, bool)]) -> Figure {
    let pick = |sticks: bool, high: bool| -> (Vec<f64>, Vec<f64>) {
        columns
            .iter()
            .filter(|column| column.sticks == sticks)
            .map(|column| {
                (
                    column.parameter,
                    if high { column.highest } else { column.lowest },
                )
            })
            .unzip()
    };
    let mut chart = Chart::new(Axis::new(label), Axis::new("extremes of θ̇₂ [rad/s]"));
    for (sticks, name, marker, style) in [
        (true, "stick-slip", Marker::Dot, Style::model()),
        (false, "no sticking", Marker::Ring, Style::series(1)),
    ] {
        for high in [true, false] {
            let (x, y) = pick(sticks, high);
            chart = chart.points(if high { name } else { "" }, &x, &y, marker, style);
        }
    }
    for (parameter, sticks) in facts {
        let word = if *sticks {
            "published: sticks"
        } else {
            "published: does not stick"
        };
        chart = chart.vertical(
            format!("{word} ({parameter})"),
            *parameter,
            Style::reference(),
        );
    }
    Figure::new(title).panel(420.0, chart)
}

fn table(name: &str, columns: &[Column]) -> Table {
    let series = |read: fn(&Column) -> f64| columns.iter().map(read).collect::<Vec<f64>>();
    Table::new(
        "bifurcation",
        vec![
            (name, series(|column| column.parameter)),
            ("lowest omega2 [rad/s]", series(|column| column.lowest)),
            ("highest omega2 [rad/s]", series(|column| column.highest)),
            (
                "sticks",
                series(|column| f64::from(u8::from(column.sticks))),
            ),
        ],
    )
}

/// Fig. 6.14.
pub fn over_speed() -> Result<Findings, ExperimentError> {
    let columns = (1..=60)
        .map(|rpm| column(f64::from(rpm), &Operation::steady(f64::from(rpm), 10.0)))
        .collect::<Result<Vec<_>, _>>()?;
    let sticking: Vec<&Column> = columns.iter().filter(|column| column.sticks).collect();
    let last = sticking.last().map_or(f64::NAN, |column| column.parameter);
    let grows = sticking
        .windows(2)
        .all(|pair| pair[1].highest > pair[0].highest);
    let beyond = columns.iter().filter(|column| column.parameter > last);
    let vibrates = beyond.clone().count() > 0
        && beyond
            .clone()
            .all(|column| column.highest - column.lowest > VIBRATES);
    let mut findings = Findings::default();
    findings.rows.push(Row::statement(
        "amplitude of the stick-slip",
        "increases with ω_ref",
        if grows {
            "increases throughout"
        } else {
            "does not increase throughout"
        },
        Verdict::holds(grows, "not monotonic"),
    ));
    findings.rows.push(
        Row::statement(
            "stick-slip vanishes above ω_ref",
            "below 55 rpm (Fig. 6.11 does not stick)",
            format!("{last} rpm"),
            Verdict::holds(last < 55.0 && vibrates, "it sticks at 55 rpm, or nothing vibrates beyond"),
        )
        .remark("the figure's axis values are not in the text; beyond, torsional vibration only, as printed"),
    );
    findings.shown_picture(
        "fig-6.14",
        "Bifurcation diagram over the reference speed",
        diagram(
            "Bifurcation diagram over ω_ref, N₂ = 10 N (Fig. 6.14)",
            "ω_ref [rpm]",
            &columns,
            &[(55.0, false)],
        ),
    );
    findings.tables.push(table("speed [rpm]", &columns));
    Ok(findings)
}

/// Fig. 6.15.
pub fn over_force() -> Result<Findings, ExperimentError> {
    let columns = (1..=50)
        .map(|force| column(f64::from(force), &Operation::steady(55.0, f64::from(force))))
        .collect::<Result<Vec<_>, _>>()?;
    let first = columns
        .iter()
        .find(|column| column.sticks)
        .map_or(f64::NAN, |column| column.parameter);
    let below: Vec<&Column> = columns
        .iter()
        .filter(|column| column.parameter < first)
        .collect();
    let range = |column: &&Column| column.highest - column.lowest;
    let vibrating: Vec<f64> = below
        .iter()
        .map(range)
        .filter(|range| *range > VIBRATES)
        .collect();
    let grows = vibrating.len() > 1 && vibrating.windows(2).all(|pair| pair[1] > pair[0]);
    let stays = columns
        .iter()
        .filter(|column| column.parameter >= first)
        .all(|column| column.sticks);
    let mut findings = Findings::default();
    findings.rows.push(Row::statement(
        "low N₂",
        "torsional oscillations, growing with N₂",
        format!(
            "{} forces below {first} N vibrate without sticking",
            vibrating.len()
        ),
        Verdict::holds(grows, "they do not grow throughout"),
    ));
    findings.rows.push(
        Row::statement(
            "stick-slip appears from N₂",
            "above 10 N, at 50 N present (Figs 6.4, 6.11)",
            format!("{first} N"),
            Verdict::holds(first > 10.0 && first <= 50.0 && stays, "outside"),
        )
        .remark("the figure's axis values are not in the text"),
    );
    findings.shown_picture(
        "fig-6.15",
        "Bifurcation diagram over the normal force",
        diagram(
            "Bifurcation diagram over N₂, 55 rpm (Fig. 6.15)",
            "N₂ [N]",
            &columns,
            &[(10.0, false), (50.0, true)],
        ),
    );
    findings.tables.push(table("normal force [N]", &columns));
    Ok(findings)
}
