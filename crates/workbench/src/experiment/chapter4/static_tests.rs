//! Section 4.4: moments of inertia and static stiffnesses.

use crate::experiment::{ExperimentError, Findings, Row, Table, Verdict, short};
use crate::identify::static_test::{self, StaticStiffness};
use crate::plot::{Axis, Chart, Figure, Marker, Style};

/// J1 and J2 of Table 4.1 [kg m²].
pub const INERTIAS: [f64; 2] = [288e-4, 149e-4];
/// ω_n of Table 4.4 [rad/s].
pub const NATURAL_FREQUENCIES: [f64; 2] = [10.044, 4.8080];

/// A static test as printed.
struct Printed {
    table: &'static str,
    shaft: usize,
    torque: [f64; 7],
    twist: [f64; 7],
    mean: f64,
    deviation: f64,
}

const SHAFT1: Printed = Printed {
    table: "Table 4.2",
    shaft: 1,
    torque: [0.0795, 0.2478, 0.3679, 0.4474, 0.5268, 0.7667, 1.1713],
    twist: [0.0283, 0.1257, 0.1759, 0.2042, 0.2356, 0.3142, 0.4492],
    mean: 2.3358,
    deviation: 0.2988,
};

const SHAFT2: Printed = Printed {
    table: "Table 4.3",
    shaft: 2,
    torque: [0.0398, 0.0795, 0.1589, 0.3679, 0.3980, 0.4474, 0.5360],
    twist: [0.1257, 0.2262, 0.4178, 1.0681, 1.1750, 1.2378, 1.5582],
    mean: 0.3482,
    deviation: 0.0197,
};

/// Table 4.1.
pub fn inertias() -> Result<Findings, ExperimentError> {
    let mut findings = Findings::default();
    let mut ours = Vec::new();
    for (disc, mass, radius, printed) in [
        (1, 6.40_f64, 0.095_f64, INERTIAS[0]),
        (2, 4.56, 0.081, INERTIAS[1]),
    ] {
        let inertia = 0.5 * mass * radius * radius;
        findings.rows.push(
            Row::number(&format!("J{disc} [kg m²]"), printed, inertia, 0.006).remark(format!(
                "m r²/2 (Eq. 4-6) = {:.2}e-4; the last printed digit is cut off, not rounded",
                1e4 * inertia
            )),
        );
        ours.push(inertia);
    }
    let discs = [1.0, 2.0];
    findings.picture(
        "table-4.1",
        "Moments of inertia",
        Figure::new("Moments of inertia (Table 4.1)").panel(
            260.0,
            Chart::new(
                Axis::new("disc [1]").range(0.5, 2.5),
                Axis::new("J [kg m²]").range(0.0, 0.032),
            )
            .published("published", &discs, &INERTIAS)
            .points("m r²/2", &discs, &ours, Marker::Dot, Style::model()),
        ),
    );
    findings.tables.push(Table::new(
        "inertias",
        vec![
            ("disc", discs.to_vec()),
            ("published J [kg m2]", INERTIAS.to_vec()),
            ("m r^2/2 [kg m2]", ours),
        ],
    ));
    Ok(findings)
}

/// Table 4.2.
pub fn shaft1() -> Result<Findings, ExperimentError> {
    evaluate(&SHAFT1)
}

/// Table 4.3.
pub fn shaft2() -> Result<Findings, ExperimentError> {
    evaluate(&SHAFT2)
}

fn evaluate(printed: &Printed) -> Result<Findings, ExperimentError> {
    let test = static_test::evaluate(&printed.torque, &printed.twist)
        .ok_or_else(|| ExperimentError::Nothing("the static test is degenerate".to_owned()))?;
    let (inertia, frequency) = (
        INERTIAS[printed.shaft - 1],
        NATURAL_FREQUENCIES[printed.shaft - 1],
    );
    let dynamic = inertia * frequency * frequency;
    let name = format!("k{}", printed.shaft);
    let mut findings = Findings::default();
    findings.rows.push(
        Row::number(
            &format!("{name}, mean of T/δ [N m/rad]"),
            printed.mean,
            test.mean_ratio.value,
            0.001,
        )
        .remark(format!("standard error {:.4}", test.mean_ratio.error)),
    );
    findings.rows.push(
        Row::number(
            &format!("{name}, standard deviation [N m/rad]"),
            printed.deviation,
            test.deviation,
            0.01,
        )
        .remark("with n − 1"),
    );
    let sigmas = (dynamic - test.mean_ratio.value) / test.mean_ratio.error;
    findings.rows.push(Row {
        quantity: format!("{name} from the measured ω_n = {frequency} rad/s [N m/rad]"),
        published: short(printed.mean),
        ours: short(dynamic),
        deviation: format!("{:+.1} %", 100.0 * (dynamic / printed.mean - 1.0)),
        verdict: if sigmas.abs() < 2.0 {
            Verdict::Reproduced
        } else {
            Verdict::NotReproducible(
                "the mean ratio is not the stiffness on which the disc swings".to_owned(),
            )
        },
        remark: format!("J ω_n²; {sigmas:+.1} standard errors from the static mean"),
    });
    findings.rows.push(
        Row::added(
            &format!("{name}, line with an offset [N m/rad]"),
            format!("{:.4} ± {:.4}", test.affine.value, test.affine.error),
        )
        .remark(format!(
            "free of a constant offset of the twist, {:+.1} of its standard errors from the dynamic value; torque at no twist {:+.4} ± {:.4} N m; through the origin {:.4} ± {:.4}",
            (test.affine.value - dynamic) / test.affine.error,
            test.offset.value, test.offset.error, test.proportional.value, test.proportional.error
        )),
    );
    findings.tables.push(Table::new(
        "static-test",
        vec![
            ("torque [N m]", printed.torque.to_vec()),
            ("twist [rad]", printed.twist.to_vec()),
        ],
    ));
    let stem = if printed.shaft == 1 {
        "fig-4.7"
    } else {
        "fig-4.8"
    };
    findings.picture(stem, printed.table, picture(printed, &test, dynamic));
    Ok(findings)
}

fn picture(printed: &Printed, test: &StaticStiffness, dynamic: f64) -> Figure {
    let largest = printed.twist[6] * 1.05;
    let twist = [0.0, largest];
    let line = |offset: f64, slope: f64| twist.map(|twist| offset + slope * twist);
    let chart = Chart::new(Axis::new("twist δ [rad]"), Axis::new("torque [N m]"))
        .points(
            "measured",
            &printed.twist,
            &printed.torque,
            Marker::Dot,
            Style::model(),
        )
        .line(
            "published mean of T/δ",
            &twist,
            &line(0.0, printed.mean),
            Style::reference(),
        )
        .line(
            "line with an offset",
            &twist,
            &line(test.offset.value, test.affine.value),
            Style::series(1),
        )
        .line(
            "dynamic J ω_n²",
            &twist,
            &line(0.0, dynamic),
            Style::series(2),
        );
    Figure::new(format!(
        "Static test of shaft {} ({})",
        printed.shaft, printed.table
    ))
    .panel(380.0, chart)
}
