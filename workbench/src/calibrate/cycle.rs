//! The motion in which a rig settles at an operating point.

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

/// What is seen of a settled motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cycle {
    /// Frequency [Hz]; `None` where the motion is steady or has no period.
    pub frequency: Option<f64>,
    /// Lowest velocity of D2 [rad/s].
    pub minimum: f64,
    /// Highest velocity of D2 [rad/s].
    pub maximum: f64,
    /// Share of the time during which D2 sticks, 0 … 1.
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

    /// The settled motion of `rig` from rest at `speed` [rad/s] under `normal_force` [N].
    ///
    /// # Errors
    /// [`IntegrationError`] where the run cannot go on, for example because a trial law makes it chatter.
    pub fn of(rig: &Rig<f64>, speed: f64, normal_force: f64) -> Result<Self, IntegrationError> {
        let options = Options {
            tolerance: 1e-7,
            order: 14,
            budget: MOST_SEGMENTS,
            ..Options::default()
        };
        let inputs = RigInputs::held(rig.voltage_for_speed(speed), normal_force, 0.0);
        let mut run = Simulation::new(*rig, options, 0.0, [0.0; STATES], inputs)?;
        run.advance_to(SETTLE)?;
        let jumps_before = run.statistics().branch_jumps;
        let (mut time, mut velocity) = (Vec::new(), Vec::new());
        let (mut sticking, mut loop_margin) = (0.0, f64::INFINITY);
        let end = SETTLE + MEASURE;
        loop {
            if run.mode().disc.is_stuck() {
                sticking += run.segment_end().min(end) - run.segment_start().max(SETTLE);
            } else {
                loop_margin = f64::min(loop_margin, run.jet().loop_margin());
            }
            loop {
                let at = SETTLE + time.len() as f64 * STEP;
                if at > run.segment_end().min(end) {
                    break;
                }
                time.push(at);
                velocity.push(run.component_at(index::OMEGA, at));
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
