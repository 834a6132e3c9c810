//! Table 4.6 and Eq. 4-4: the motor's constants held against each other, and numbers that are not given.

use stickslip::friction::Law;
use stickslip::plant::Rig;

use crate::calibrate::cycle::{Cycle, Operating};
use crate::experiment::virtual_rig::{
    Operation, Run, radians_per_second, reduced_rig, two_gaussian_rig,
};
use crate::experiment::{ExperimentError, Findings, Row, Table, Verdict, short};
use crate::plot::{Axis, Chart, Figure, Marker, Style};

/// Inertias of the motor tried [kg m²]; the built-in one is 5.18e-5.
const MOTOR_INERTIAS: [f64; 5] = [1e-5, 5.18e-5, 1e-4, 3e-4, 1e-3];
/// Radius of the pin tried instead of the built-in one [m].
const OTHER_RADIUS: f64 = 0.060;
/// Speed [rpm] and normal force [N] at which the numbers are held against each other.
const SPEED: f64 = 55.0;
const FORCE: f64 = 50.0;

fn mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = values.len() as f64;
    values.sum::<f64>() / count
}

fn frequency(rig: &Rig<f64>) -> Result<f64, ExperimentError> {
    Cycle::of(rig, &Operating::reduced(SPEED, FORCE))?
        .frequency
        .ok_or_else(|| ExperimentError::Nothing("no vibration".to_owned()))
}

/// Mechanical power of the motor for each watt that its back-EMF takes from the supply.
fn power_row(rig: &Rig<f64>) -> Result<Row, ExperimentError> {
    let run = Run::of(rig, &Operation::steady(SPEED, FORCE))?;
    let motor = &rig.motor;
    let taken =
        rig.voltage_for_speed(radians_per_second(SPEED)) * mean(run.current.iter().copied());
    let heat = motor.resistance * mean(run.current.iter().map(|current| current * current));
    let given = motor.torque_constant
        * rig.gearbox.ratio
        * mean(
            run.current
                .iter()
                .zip(&run.omega3)
                .map(|(current, omega)| current * omega),
        );
    let ratio = given / (taken - heat);
    Ok(Row::statement(
        "mechanical power of the motor over the power left after heating, 55 rpm, 50 N",
        "K_T = 0.126 N m/A, K_E = 0.0602 V s/rad",
        format!("{given:.2} W of {:.2} W: {ratio:.3}", taken - heat),
        if ratio > 1.01 {
            Verdict::NotReproducible("in SI both constants are one number; as printed the motor makes energy".to_owned())
        } else {
            Verdict::Reproduced
        },
    )
    .remark(format!(
        "supply {taken:.2} W, heat {heat:.2} W; K_T/K_E = {:.3}. Catalogue values that the text itself does not vouch for; used as printed",
        motor.torque_constant / motor.back_emf_constant
    )))
}

/// What a Coulomb torque without sign, as Eq. 4-4 prints it, does to a rig at rest without voltage.
fn sign_row(rig: &Rig<f64>) -> Result<Row, ExperimentError> {
    let still = Run::of(
        rig,
        &Operation {
            settle: 0.0,
            duration: 10.0,
            ..Operation::steady(0.0, 0.0)
        },
    )?;
    let (low, high) = still.range();
    let motor = &rig.motor;
    let (ratio, torque) = (rig.gearbox.ratio, motor.coulomb_torque);
    // Standing torque balance K_T i = C_m η ω3 + T_fm with R i = −K_E η ω3.
    let backward = torque
        / (ratio
            * (motor.torque_constant * motor.back_emf_constant / motor.resistance
                + motor.viscous_damping));
    Ok(Row::statement(
        "rig without voltage (Eq. 4-4 has T_fm without sign)",
        format!(
            "turns backward at {:.2} rpm",
            backward / radians_per_second(1.0)
        )
        .as_str(),
        format!("{low:.1} … {high:.1} rad/s"),
        Verdict::NotReproducible(
            "friction opposes motion: T_fm sign(ω₃), and it holds the motor while it can"
                .to_owned(),
        ),
    )
    .remark("the published column is what the printed equation gives"))
}

/// Table 4.6, Eq. 4-4, J_m and the radius of the pin.
pub fn constants() -> Result<Findings, ExperimentError> {
    let mut findings = Findings::default();
    let rig = two_gaussian_rig()?;
    findings.rows.push(power_row(&rig)?);
    findings.rows.push(sign_row(&reduced_rig()?)?);
    let mut frequencies = Vec::new();
    for inertia in MOTOR_INERTIAS {
        let mut other = rig;
        other.motor.inertia = inertia;
        frequencies.push(frequency(&other)?);
    }
    let reference = frequency(&rig)?;
    let farthest = frequencies
        .iter()
        .map(|frequency| (frequency / reference - 1.0).abs())
        .fold(0.0, f64::max);
    findings.rows.push(
        Row::added(
            "J_m (not given) from 1e-5 to 1e-3 kg m²: change of the frequency at 55 rpm, 50 N",
            format!("{:.2} %", 100.0 * farthest),
        )
        .remark(format!(
            "frequencies {} Hz",
            frequencies
                .iter()
                .map(|frequency| format!("{frequency:.4}"))
                .collect::<Vec<_>>()
                .join(", ")
        )),
    );
    let mut other = rig;
    let stretch = rig.contact.radius / OTHER_RADIUS;
    other.contact.radius = OTHER_RADIUS;
    if let Law::TwoGaussianMu(law) = &mut other.law {
        law.a1 *= stretch;
        law.a2 *= stretch;
    }
    findings.rows.push(
        Row::added(
            &format!("pin's radius (not given) {OTHER_RADIUS} instead of {} m, coefficients × {stretch}: change of the frequency", rig.contact.radius),
            format!("{:.1e}", (frequency(&other)? / reference - 1.0).abs()),
        )
        .remark("only the product of coefficient and radius can be found from motions"),
    );
    findings.rows.push(
        Row::number(
            "55 rpm [rad/s] (Section 6.3 has 5.75 beside 5.76)",
            5.76,
            radians_per_second(SPEED),
            0.001,
        )
        .remark(format!(
            "5.75 would be {} rpm",
            short(5.75 / radians_per_second(1.0))
        )),
    );
    findings.picture(
        "table-4.6",
        "Inertia of the motor",
        Figure::new("What the inertia of the motor, not given, does at 55 rpm, 50 N").panel(
            300.0,
            Chart::new(
                Axis::new("J_m [kg m²]").logarithmic(),
                Axis::new("frequency [Hz]").range(0.70, 0.80),
            )
            .points(
                "second law",
                &MOTOR_INERTIAS,
                &frequencies,
                Marker::Dot,
                Style::model(),
            )
            .horizontal(
                "published 0.81 Hz / 1.072",
                0.81 / 1.072,
                Style::reference(),
            ),
        ),
    );
    findings.tables.push(Table::new(
        "motor-inertia",
        vec![
            ("J_m [kg m2]", MOTOR_INERTIAS.to_vec()),
            ("frequency [Hz]", frequencies),
        ],
    ));
    Ok(findings)
}
