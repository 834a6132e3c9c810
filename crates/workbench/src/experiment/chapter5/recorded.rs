//! A record of the virtual rig with the friction torque that inverse dynamics recovers from it.

use crate::experiment::ExperimentError;
use crate::experiment::virtual_rig::{
    Operation, Run, SAMPLE_STEP, encoder, reduced_rig, relative_force, virtual_rig,
};
use crate::identify::inverse_dynamics::{RecoveredFriction, recover_friction};

/// Samples on either side over which the encoders' angles are smoothed.
pub const HALF_WIDTH: usize = 6;

/// A record and what was recovered from it.
pub struct RecordedFriction {
    /// The run itself.
    pub run: Run,
    /// What inverse dynamics makes of its encoders.
    pub friction: RecoveredFriction,
    /// N2 over time [N].
    pub normal_force: Vec<f64>,
}

impl RecordedFriction {
    /// Leaves out as many samples at both ends, where the smoothing has neighbours on one side only.
    fn trim(&mut self, samples: usize) {
        let (run, friction) = (&mut self.run, &mut self.friction);
        for series in [
            &mut run.time,
            &mut run.theta,
            &mut run.omega,
            &mut run.acceleration,
            &mut run.theta3,
            &mut run.omega3,
            &mut run.current,
            &mut run.theta1,
            &mut run.omega1,
            &mut run.friction,
            &mut friction.velocity,
            &mut friction.acceleration,
            &mut friction.torque,
            &mut self.normal_force,
        ] {
            series.truncate(series.len().saturating_sub(samples));
            series.drain(..samples.min(series.len()));
        }
    }
}

/// The record at an operating point [rpm, N].
pub fn recorded_friction(
    speed_rpm: f64,
    normal_force: f64,
) -> Result<RecordedFriction, ExperimentError> {
    let rig = virtual_rig()?;
    let run = Run::of(&rig, &Operation::steady(speed_rpm, normal_force))?;
    let friction = recover_friction(
        &reduced_rig()?,
        &encoder(&run.theta),
        &encoder(&run.theta3),
        SAMPLE_STEP,
        HALF_WIDTH,
    )
    .ok_or_else(|| ExperimentError::Nothing("the record is too short to smooth".to_owned()))?;
    let force = run
        .theta
        .iter()
        .map(|theta| normal_force * relative_force(&rig, *theta))
        .collect();
    let mut record = RecordedFriction {
        run,
        friction,
        normal_force: force,
    };
    record.trim(HALF_WIDTH);
    Ok(record)
}
