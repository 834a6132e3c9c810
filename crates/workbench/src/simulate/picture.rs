//! The picture of a run.

use crate::files::record::{Record, RecordError};
use crate::plot::{Axis, Chart, Figure, Marker, Style};

/// Velocities and friction torque over time, phase portrait and friction torque over velocity.
///
/// The phase portraits show the last third of the run alone, where the transient has passed.
///
/// # Errors
/// [`RecordError::MissingColumn`] where the result lacks one of the rig's outputs.
pub fn picture(record: &Record, title: &str) -> Result<Figure, RecordError> {
    let time = record.time();
    let range = |axis: Axis| axis.range(time[0], time[time.len() - 1]);
    let mut velocities = Chart::new(range(Axis::new("time [s]")), Axis::new("velocity [rad/s]"))
        .line(
            "θ̇₂ disc D2",
            time,
            record.require("theta_dot")?,
            Style::series(0),
        )
        .line(
            "θ̇₃ gearbox output",
            time,
            record.require("theta3_dot")?,
            Style::series(1),
        );
    let mut torque = Chart::new(
        range(Axis::new("time [s]")),
        Axis::new("friction torque [N m]"),
    )
    .line("T_f on D2", time, record.require("T_f")?, Style::series(0));
    if let (Some(velocity), Some(friction)) = (record.column("theta1_dot"), record.column("T_f1")) {
        velocities = velocities.line("θ̇₁ disc D1", time, velocity, Style::series(2));
        torque = torque.line("T_f1 on D1", time, friction, Style::series(2));
    }
    let settled = record.window(
        time[0] + 2.0 * (time[time.len() - 1] - time[0]) / 3.0,
        f64::INFINITY,
    );
    let twist: Vec<f64> = settled
        .require("theta3")?
        .iter()
        .zip(settled.require("theta")?)
        .map(|(output, disc)| output - disc)
        .collect();
    let velocity = settled.require("theta_dot")?;
    let portrait = Chart::new(Axis::new("θ₃ − θ₂ [rad]"), Axis::new("θ̇₂ [rad/s]"))
        .title("phase portrait, last third")
        .line("", &twist, velocity, Style::series(0));
    let friction = friction_over_velocity(&settled)?;
    Ok(Figure::new(title)
        .panel(270.0, velocities)
        .panel(230.0, torque)
        .row(340.0, vec![Box::new(portrait), Box::new(friction)]))
}

/// Sliding as a curve, sticking as points: between them the torque jumps, and a line there would show what is not.
fn friction_over_velocity(settled: &Record) -> Result<Chart, RecordError> {
    let (velocity, torque) = (settled.require("theta_dot")?, settled.require("T_f")?);
    let stuck = |row: usize| {
        settled
            .column("stuck")
            .map_or(velocity[row] == 0.0, |stuck| stuck[row] != 0.0)
    };
    let only = |kind: bool| -> Vec<f64> {
        (0..settled.len())
            .map(|row| {
                if stuck(row) == kind {
                    torque[row]
                } else {
                    f64::NAN
                }
            })
            .collect()
    };
    Ok(Chart::new(Axis::new("θ̇₂ [rad/s]"), Axis::new("T_f [N m]"))
        .title("friction over velocity, last third")
        .line("sliding", velocity, &only(false), Style::series(0))
        .points(
            "sticking",
            velocity,
            &only(true),
            Marker::Dot,
            Style::series(1).wide(0.0),
        ))
}
