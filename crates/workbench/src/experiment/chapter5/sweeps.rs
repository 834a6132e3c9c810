//! Section 5.2: sweeps of the reduced rig, Figs 5.1 to 5.4.

use crate::experiment::virtual_rig::{
    Operation, Run, SAMPLE_STEP, peak_frequency, two_gaussian_rig, virtual_rig,
};
use crate::experiment::{ExperimentError, Findings, Row, Table, Verdict};
use crate::plot::{Axis, Chart, Figure, Panel, Space, Style};

/// Speeds [rpm] of Fig. 5.1 and whether the disc sticks there.
pub const SPEEDS: [(f64, bool); 4] = [(25.0, true), (35.0, false), (45.0, true), (55.0, false)];
/// Normal force of Fig. 5.1 [N].
pub const SPEED_SWEEP_FORCE: f64 = 10.0;
/// Normal forces [N] of Fig. 5.3 and whether the disc sticks there.
pub const FORCES: [(f64, bool); 4] = [(10.0, false), (30.0, true), (50.0, true), (70.0, true)];
/// Speed of Fig. 5.3 [rpm].
pub const FORCE_SWEEP_SPEED: f64 = 55.0;
/// Length of the time histories in the pictures [s].
const SHOWN: f64 = 15.0;

/// Whether a run counts as stick-slip.
pub fn sticks(run: &Run) -> bool {
    run.stick_fraction() > 0.0
}

/// A run in words.
pub fn describe(run: &Run) -> String {
    let (low, high) = run.range();
    format!(
        "{}, {:.3} Hz, {low:.2} … {high:.2} rad/s",
        if sticks(run) {
            "sticks"
        } else {
            "does not stick"
        },
        peak_frequency(&run.omega, SAMPLE_STEP)
    )
}

fn pattern_rows(
    findings: &mut Findings,
    cases: &[(String, bool, Operation)],
) -> Result<Vec<Run>, ExperimentError> {
    let (plain, virtual_rig) = (two_gaussian_rig()?, virtual_rig()?);
    let mut runs = Vec::new();
    for (name, published, operation) in cases {
        let without = Run::of(&plain, operation)?;
        let with = Run::of(&virtual_rig, operation)?;
        let verdict = match (sticks(&without) == *published, sticks(&with) == *published) {
            (true, true) => Verdict::Reproduced,
            (false, true) => {
                Verdict::ReproducedWith("the virtual rig, which is calibrated to it".to_owned())
            }
            (true, false) => {
                Verdict::ReproducedWith("the second law alone; not on the virtual rig".to_owned())
            }
            (false, false) => {
                Verdict::Open("neither on the virtual rig nor with the second law alone".to_owned())
            }
        };
        findings.rows.push(
            Row::statement(
                name,
                if *published {
                    "sticks"
                } else {
                    "does not stick"
                },
                describe(&with),
                verdict,
            )
            .remark(format!("second law alone: {}", describe(&without))),
        );
        runs.push(with);
    }
    Ok(runs)
}

fn speed_cases() -> Vec<(String, bool, Operation)> {
    SPEEDS
        .iter()
        .map(|(speed, sticks)| {
            (
                format!("{speed} rpm"),
                *sticks,
                Operation::steady(*speed, SPEED_SWEEP_FORCE),
            )
        })
        .collect()
}

fn force_cases() -> Vec<(String, bool, Operation)> {
    FORCES
        .iter()
        .map(|(force, sticks)| {
            (
                format!("{force} N"),
                *sticks,
                Operation::steady(FORCE_SWEEP_SPEED, *force),
            )
        })
        .collect()
}

fn histories(title: &str, cases: &[(String, bool, Operation)], runs: &[Run]) -> Figure {
    let mut figure = Figure::new(title);
    for pair in [[0, 1], [2, 3]] {
        let panels = pair.map(|index| {
            let shown = (SHOWN / SAMPLE_STEP) as usize;
            let run = &runs[index];
            let word = if cases[index].1 {
                "published: sticks"
            } else {
                "published: does not stick"
            };
            let chart = Chart::new(Axis::new("time [s]"), Axis::new("velocity [rad/s]"))
                .title(format!("{}, {word}", cases[index].0))
                .line(
                    "θ̇₂",
                    &run.time[..shown],
                    &run.omega[..shown],
                    Style::model(),
                )
                .line(
                    "θ̇₃",
                    &run.time[..shown],
                    &run.omega3[..shown],
                    Style::series(1),
                );
            Box::new(chart) as Box<dyn Panel>
        });
        figure = figure.row(270.0, Vec::from(panels));
    }
    figure
}

fn table(cases: &[(String, bool, Operation)], runs: &[Run]) -> Table {
    let mut columns = vec![("time [s]".to_owned(), runs[0].time.clone())];
    for ((name, ..), run) in cases.iter().zip(runs) {
        columns.push((format!("{name}: omega2 [rad/s]"), run.omega.clone()));
        columns.push((format!("{name}: omega3 [rad/s]"), run.omega3.clone()));
        columns.push((format!("{name}: theta3 - theta2 [rad]"), twist(run)));
    }
    Table {
        name: "sweep".to_owned(),
        columns,
    }
}

fn twist(run: &Run) -> Vec<f64> {
    run.theta3
        .iter()
        .zip(&run.theta)
        .map(|(output, disc)| output - disc)
        .collect()
}

/// Fig. 5.1.
pub fn speeds() -> Result<Findings, ExperimentError> {
    let mut findings = Findings::default();
    let cases = speed_cases();
    let runs = pattern_rows(&mut findings, &cases)?;
    findings.picture(
        "fig-5.1",
        "Speed sweep",
        histories(
            "Speed sweep at N₂ = 10 N, virtual rig (Fig. 5.1)",
            &cases,
            &runs,
        ),
    );
    findings.tables.push(table(&cases, &runs));
    Ok(findings)
}

/// Fig. 5.3.
pub fn forces() -> Result<Findings, ExperimentError> {
    let mut findings = Findings::default();
    let cases = force_cases();
    let runs = pattern_rows(&mut findings, &cases)?;
    if let Some(row) = findings.rows.first_mut() {
        row.remark.push_str(". The text names Figs 5.9(a), (c), (d) as the cases that stick; Fig. 5.3(b), (c), (d) must be meant");
    }
    findings.picture(
        "fig-5.3",
        "Normal-force sweep",
        histories(
            "Normal-force sweep at 55 rpm, virtual rig (Fig. 5.3)",
            &cases,
            &runs,
        ),
    );
    findings.tables.push(table(&cases, &runs));
    Ok(findings)
}

/// Phase portraits stacked along a control parameter; each entry is its value and a run.
pub fn stack(title: &str, axis: &str, portraits: &[(f64, bool, Run)]) -> Figure {
    let mut space = Space::new(
        Axis::new(axis),
        Axis::new("θ₃ − θ₂ [rad]"),
        Axis::new("θ̇₂ [rad/s]"),
    );
    let mut named = Vec::new();
    for (value, published, run) in portraits {
        let points = twist(run)
            .iter()
            .zip(&run.omega)
            .take((SHOWN / SAMPLE_STEP) as usize)
            .map(|(twist, omega)| [*value, *twist, *omega])
            .collect();
        let (words, style) = if *published {
            ("published: sticks", Style::model())
        } else {
            ("published: does not stick", Style::series(1).solid())
        };
        // One entry of the legend for each kind.
        let first = !named.contains(&words);
        named.push(words);
        space = space.curve(if first { words } else { "" }, points, style.wide(1.0));
    }
    Figure::new(title).panel(560.0, space)
}

fn portraits(
    cases: Vec<(String, bool, Operation)>,
    value: fn(&Operation) -> f64,
) -> Result<Vec<(f64, bool, Run)>, ExperimentError> {
    let rig = virtual_rig()?;
    cases
        .into_iter()
        .map(|(_, published, operation)| {
            Ok((value(&operation), published, Run::of(&rig, &operation)?))
        })
        .collect()
}

/// The portraits as columns.
fn portrait_table(unit: &str, portraits: &[(f64, bool, Run)]) -> Table {
    let mut columns = Vec::new();
    for (value, _, run) in portraits {
        columns.push((format!("{value} {unit}: theta3 - theta2 [rad]"), twist(run)));
        columns.push((format!("{value} {unit}: omega2 [rad/s]"), run.omega.clone()));
    }
    Table {
        name: "portraits".to_owned(),
        columns,
    }
}

/// Largest velocities of those portraits that stick, in order.
fn sticking_peaks(portraits: &[(f64, bool, Run)]) -> Vec<f64> {
    portraits
        .iter()
        .filter(|(_, _, run)| sticks(run))
        .map(|(_, _, run)| run.range().1)
        .collect()
}

/// Fig. 5.2.
pub fn portraits_over_speed() -> Result<Findings, ExperimentError> {
    let portraits = portraits(speed_cases(), |operation| operation.speed_rpm)?;
    let peaks = sticking_peaks(&portraits);
    let mut findings = Findings::default();
    findings.rows.push(Row::statement(
        "amplitude of the stick-slip over ω_ref",
        "increases until stick-slip vanishes",
        format!("highest velocities where it sticks: {}", list(&peaks)),
        Verdict::holds(
            peaks.len() > 1 && peaks.windows(2).all(|pair| pair[1] > pair[0]),
            "it does not increase throughout",
        ),
    ));
    findings.shown_picture(
        "fig-5.2",
        "Phase portraits over the reference speed, virtual rig",
        stack(
            "Phase portraits at N₂ = 10 N, virtual rig (Fig. 5.2)",
            "ω_ref [rpm]",
            &portraits,
        ),
    );
    findings.tables.push(portrait_table("rpm", &portraits));
    Ok(findings)
}

/// Fig. 5.4.
pub fn portraits_over_force() -> Result<Findings, ExperimentError> {
    let portraits = portraits(force_cases(), |operation| operation.normal_force)?;
    let amplitudes: Vec<f64> = portraits
        .iter()
        .map(|(_, _, run)| run.half_amplitude())
        .collect();
    let mut findings = Findings::default();
    findings.rows.push(Row::statement(
        "lowest normal force",
        "torsional vibration of small amplitude only",
        format!("half amplitudes {} rad/s", list(&amplitudes)),
        Verdict::holds(
            amplitudes[1..].iter().all(|other| *other > amplitudes[0]),
            "not the smallest",
        ),
    ));
    findings.picture(
        "fig-5.4",
        "Phase portraits over the normal force",
        stack(
            "Phase portraits at 55 rpm, virtual rig (Fig. 5.4)",
            "N₂ [N]",
            &portraits,
        ),
    );
    findings.tables.push(portrait_table("N", &portraits));
    Ok(findings)
}

fn list(values: &[f64]) -> String {
    values
        .iter()
        .map(|value| format!("{value:.2}"))
        .collect::<Vec<_>>()
        .join(", ")
}
