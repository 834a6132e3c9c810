//! The instruments of the rig: encoders that round down, noisy tachometers and load cell.

use crate::answers::named;
use crate::effects::Effects;
use crate::excitation::{Excitation, SAMPLE_INTERVAL};
use crate::random::Stream;
use crate::simulator::Sample;
use core::f64::consts::TAU;
use std::collections::BTreeMap;
use std::fmt::Write;

/// Angle of one step of the disc encoder [rad].
pub const DISC_ENCODER_STEP: f64 = TAU / 1000.0;
/// Angle of one step of the motor encoder, seen at the gearbox output [rad].
pub const MOTOR_ENCODER_STEP: f64 = TAU / 8000.0;

/// Instruments of any rig.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Instruments {
    /// Step of the disc encoder [rad]; both discs of the full rig have the same instruments.
    pub disc_encoder_step: f64,
    /// Step of the motor encoder, seen at the gearbox output [rad].
    pub gear_encoder_step: f64,
    /// Noise of the disc tachometer (one standard deviation, like all that follow) [rad/s].
    pub disc_speed: f64,
    /// Noise of the tachometer seen at the gearbox output [rad/s].
    pub gearbox_speed: f64,
    /// Noise of the load cell [N].
    pub normal_force: f64,
    /// Noise of the current's reading [A].
    pub current: f64,
    /// Whether encoders round down to whole steps; if not, they have noise of a step over √12.
    pub quantised: bool,
}

impl Instruments {
    /// The dissertation's rig, whose current runs to about 2 A; how well that is read is drawn.
    pub fn dissertation(stream: &mut Stream) -> Self {
        Self {
            disc_encoder_step: DISC_ENCODER_STEP,
            gear_encoder_step: MOTOR_ENCODER_STEP,
            disc_speed: 0.05,
            gearbox_speed: 0.05 / 8.0,
            normal_force: 0.2,
            current: 2.0 * stream.log_uniform(0.002, 0.02),
            quantised: true,
        }
    }

    /// Instruments nobody knows, drawn: 0.2 to 5 times as noisy, encoders too where they do not round.
    pub fn unknown_to_all(self, stream: &mut Stream) -> Self {
        let factor = stream.log_uniform(0.2, 5.0);
        let quantised = stream.chance(0.5);
        let angle_factor = if quantised { 1.0 } else { factor };
        Self {
            disc_encoder_step: self.disc_encoder_step * angle_factor,
            gear_encoder_step: self.gear_encoder_step * angle_factor,
            quantised,
            ..self.noisier(factor)
        }
    }

    /// As the answers state them; `encoders_round` is 1 or 0.
    pub fn answers(&self) -> BTreeMap<String, f64> {
        named([
            ("disc_encoder_step", self.disc_encoder_step),
            ("gear_encoder_step", self.gear_encoder_step),
            ("disc_velocity_noise", self.disc_speed),
            ("gear_velocity_noise", self.gearbox_speed),
            ("load_cell_noise", self.normal_force),
            ("current_noise", self.current),
            ("encoders_round", f64::from(u8::from(self.quantised))),
        ])
    }

    /// The same with `factor` times the noise.
    pub fn noisier(self, factor: f64) -> Self {
        Self {
            disc_speed: self.disc_speed * factor,
            gearbox_speed: self.gearbox_speed * factor,
            normal_force: self.normal_force * factor,
            current: self.current * factor,
            ..self
        }
    }

    /// What the load cell shows of `force` [N]; without the pin (zero force) it is switched off and reads zero.
    pub(crate) fn force(&self, force: f64, bias: f64, stream: &mut Stream) -> f64 {
        let noise = self.normal_force * stream.normal();
        if force == 0.0 {
            0.0
        } else {
            force + bias + noise
        }
    }

    /// What an encoder of this step shows of `angle` [rad].
    pub(crate) fn angle(&self, angle: f64, step: f64, stream: &mut Stream) -> f64 {
        // An angle that is not quantised is noisy as much as a quantised one errs.
        let noise = step / libm::sqrt(12.0) * stream.normal();
        if self.quantised {
            encoder(angle, step)
        } else {
            angle + noise
        }
    }

    /// The text of `sensors.toml`; `with_current`: whether the current is read.
    pub fn toml(&self, with_current: bool) -> String {
        let mut text = String::new();
        if !self.quantised {
            text.push_str(
                "# The encoders do not round; their noise is the step over the root of 12.\n",
            );
        }
        // Writing into a String cannot fail.
        let _ = write!(
            text,
            "disc_encoder_step = {:?}    # rad\ngear_encoder_step = {:?}    # rad at the gearbox output\n\
             disc_velocity_noise = {:?}    # rad/s, one standard deviation\n\
             gear_velocity_noise = {:?}    # rad/s\nload_cell_noise = {:?}    # N\n",
            self.disc_encoder_step,
            self.gear_encoder_step,
            self.disc_speed,
            self.gearbox_speed,
            self.normal_force,
        );
        if with_current {
            let _ = writeln!(text, "current_noise = {:?}    # A", self.current);
        }
        text
    }
}

/// Rounds `angle` down to a whole encoder step, both [rad].
pub fn encoder(angle: f64, step: f64) -> f64 {
    (angle / step).floor() * step
}

/// The text of a record of the dissertation's rig, its noise drawn row by row.
pub fn record_csv(
    excitation: &Excitation,
    samples: &[Sample],
    hidden: &Effects,
    tools: &Instruments,
    stream: &mut Stream,
) -> String {
    let mut text = String::with_capacity(64 * samples.len());
    text.push_str("time,u,N2,theta,theta_dot,theta3,theta3_dot\n");
    for (index, sample) in samples.iter().enumerate() {
        let reading = tools.force(excitation.normal_force[index], hidden.cell_bias, stream);
        let disc_speed =
            hidden.tacho_gain * sample.seen_disc_speed + tools.disc_speed * stream.normal();
        let gearbox_speed = sample.state.gearbox_speed + tools.gearbox_speed * stream.normal();
        let disc_angle = hidden.encoder_angle(sample.seen_disc_angle);
        // Writing into a String cannot fail.
        let _ = writeln!(
            text,
            "{:.2},{:.5},{:.3},{:.6},{:.4},{:.6},{:.5}",
            index as f64 * SAMPLE_INTERVAL,
            excitation.voltage[index],
            reading,
            encoder(disc_angle, DISC_ENCODER_STEP) + 0.0,
            disc_speed,
            encoder(sample.state.gearbox_angle, MOTOR_ENCODER_STEP) + 0.0,
            gearbox_speed,
        );
    }
    text
}
