//! The motion in which a rig settles at an operating point.

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};
use stickslip::integrator::{IntegrationError, Options, Simulation};
use stickslip::plant::{Rig, RigInputs, STATES, index};

use crate::analysis::limit_cycle;

/// Time from rest after which the motion counts as settled [s].
const SETTLE: f64 = 25.0;
/// Time over which it is measured [s].
const MEASURE: f64 = 15.0;
/// Sampling step of the measurement [s]; crossings are interpolated.
const STEP: f64 = 0.01;
/// Segments that one run may take; a motion that needs more chatters between branches of its law.
const MOST_SEGMENTS: u64 = 8_000;
/// Velocities within which a motion counts as steady [rad/s].
const STEADY: f64 = 1e-3;

/// The disc that a statement is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Disc {
    /// The disc at the far end of the full rig.
    D1,
    /// The disc on the motor's shaft; the only one of the reduced rig.
    #[default]
    D2,
}

/// Where a rig is operated and which of its discs is looked at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Operating {
    /// ω_ref [rpm]; the voltage that turns the unloaded rig at this speed is held.
    pub speed_rpm: f64,
    /// N2 [N].
    pub normal_force: f64,
    /// N1 [N]; 0 for the reduced rig.
    pub normal_force_1: f64,
    /// The disc that is looked at.
    pub disc: Disc,
}

impl Operating {
    /// The reduced rig at `speed_rpm` under `normal_force` [N].
    #[must_use]
    pub fn reduced(speed_rpm: f64, normal_force: f64) -> Self {
        Self {
            speed_rpm,
            normal_force,
            normal_force_1: 0.0,
            disc: Disc::D2,
        }
    }
}

/// What is seen of a settled motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cycle {
    /// Frequency [Hz]; `None` where the motion is steady or has no period.
    pub frequency: Option<f64>,
    /// Lowest velocity of the disc [rad/s].
    pub minimum: f64,
    /// Highest velocity of the disc [rad/s].
    pub maximum: f64,
    /// Share of the time during which the disc sticks, 0 … 1.
    pub stick_fraction: f64,
    /// Smallest margin 1 + (∂T_f/∂a)/J2 of the algebraic loop; 1 for laws without one.
    pub loop_margin: f64,
    /// Jumps between branches of the loop.
    pub branch_jumps: u64,
}

impl Cycle {
    /// Half of the velocity's range [rad/s].
    #[must_use]
    pub fn half_amplitude(&self) -> f64 {
        0.5 * (self.maximum - self.minimum)
    }

    /// Whether the disc sticks and slips: one that never moves does neither.
    #[must_use]
    pub fn sticks_and_slips(&self) -> bool {
        self.stick_fraction > 0.0 && self.maximum - self.minimum > STEADY
    }

    /// The settled motion of `rig` from rest.
    ///
    /// # Errors
    /// [`IntegrationError`] where the run cannot go on, for example because a trial law makes it chatter.
    pub fn of(rig: &Rig<f64>, at: &Operating) -> Result<Self, IntegrationError> {
        let options = Options {
            tolerance: 1e-7,
            order: 14,
            budget: MOST_SEGMENTS,
            ..Options::default()
        };
        let voltage = rig.voltage_for_speed(at.speed_rpm * PI / 30.0);
        let inputs = RigInputs::held(voltage, at.normal_force, at.normal_force_1);
        let component = match at.disc {
            Disc::D1 => index::OMEGA1,
            Disc::D2 => index::OMEGA,
        };
        let mut run = Simulation::new(*rig, options, 0.0, [0.0; STATES], inputs)?;
        run.advance_to(SETTLE)?;
        let jumps_before = run.statistics().branch_jumps;
        let (mut time, mut velocity) = (Vec::new(), Vec::new());
        let (mut sticking, mut loop_margin) = (0.0, f64::INFINITY);
        let end = SETTLE + MEASURE;
        loop {
            let stuck = match at.disc {
                Disc::D1 => run.mode().disc1.is_stuck(),
                Disc::D2 => run.mode().disc.is_stuck(),
            };
            if stuck {
                sticking += run.segment_end().min(end) - run.segment_start().max(SETTLE);
            } else {
                loop_margin = f64::min(loop_margin, run.jet().loop_margin());
            }
            loop {
                let instant = SETTLE + time.len() as f64 * STEP;
                if instant > run.segment_end().min(end) {
                    break;
                }
                time.push(instant);
                velocity.push(run.component_at(component, instant));
            }
            if run.segment_end() >= end {
                break;
            }
            if run.statistics().segments > MOST_SEGMENTS {
                return Err(IntegrationError::BudgetExhausted {
                    segments: MOST_SEGMENTS,
                    target: end,
                    time: run.segment_end(),
                    mode: "too many segments".to_owned(),
                });
            }
            run.next_segment()?;
        }
        let (minimum, maximum) = velocity
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
                (low.min(*value), high.max(*value))
            });
        Ok(Self {
            frequency: limit_cycle::find(&time, &velocity, 0.0, STEADY)
                .map(|cycle| cycle.frequency()),
            minimum,
            maximum,
            stick_fraction: sticking / MEASURE,
            loop_margin: if loop_margin.is_finite() {
                loop_margin
            } else {
                1.0
            },
            branch_jumps: run.statistics().branch_jumps - jumps_before,
        })
    }
}
