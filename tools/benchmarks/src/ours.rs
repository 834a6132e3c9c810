//! Our own integrator on the same systems, through its Rust interface.

use std::hint::black_box;

use anyhow::Result;
use cpu_time::ProcessTime;
use stickslip::integrator::{Options, Simulation};
use stickslip::plant::{Rig, RigInputs, STATES, index};

use crate::effort::Effort;
use crate::measurement::{Apart, Run};
use crate::systems::{END_TIME, OUTPUT_STEP, System};

/// Name in tables.
pub const NAME: &str = "stickslip";

/// Orders of the Taylor polynomials that are tried.
const ORDERS: [usize; 4] = [8, 12, 16, 21];

/// The order that converges furthest: the default.
pub const MOST_PRECISE: &str = "order 21";

/// Sweeps tolerances at several orders.
///
/// # Errors
/// When the model is refused. A run that fails is reported and left out.
pub fn sweep(system: &System, effort: Effort) -> Result<Vec<Run>> {
    let rig = Rig::from_toml(&system.model_toml(), "the benchmark's model")?;
    let force_1 = system.first_disc.map_or(0.0, |disc| disc.normal_force);
    let inputs = RigInputs::held(system.voltage(), system.normal_force, force_1);
    let mut runs = Vec::new();
    for order in ORDERS {
        for tolerance in effort.tolerances(1e-3, 1e-14) {
            let options = Options {
                tolerance,
                order,
                ..Options::default()
            };
            match best_of(system, rig, inputs, options, 10 * effort.repetitions()) {
                Ok(best) => runs.extend(best),
                Err(error) => eprintln!(
                    "system {}: {NAME} order {order} at {tolerance:.0e}: {error:#}",
                    system.key
                ),
            }
        }
    }
    Ok(runs)
}

/// A run takes a millisecond: many repetitions cost nothing and outlast disturbances.
fn best_of(
    system: &System,
    rig: Rig<f64>,
    inputs: RigInputs<f64>,
    options: Options,
    repetitions: u32,
) -> Result<Option<Run>> {
    let mut best: Option<Run> = None;
    for _ in 0..repetitions {
        let again = simulate(system, rig, inputs, options)?;
        if best.as_ref().is_none_or(|b| again.seconds < b.seconds) {
            best = Some(again);
        }
    }
    Ok(best)
}

fn simulate(
    system: &System,
    rig: Rig<f64>,
    inputs: RigInputs<f64>,
    options: Options,
) -> Result<Run> {
    let start = ProcessTime::now();
    let mut simulation = Simulation::new(rig, options, 0.0, [0.0; STATES], inputs)?;
    let points = (END_TIME / OUTPUT_STEP).round() as u32;
    for point in 1..=points {
        let time = if point == points {
            END_TIME
        } else {
            f64::from(point) * OUTPUT_STEP
        };
        simulation.advance_to(time)?;
        black_box(simulation.state_at(time));
    }
    let theta = simulation.state_at(END_TIME)[index::THETA];
    let seconds = start.elapsed().as_secs_f64();
    let statistics = simulation.statistics();
    Ok(Run {
        system: system.key.into(),
        solver: NAME.into(),
        configuration: format!("order {}", options.order),
        tolerance: options.tolerance,
        seconds,
        theta,
        error: f64::NAN,
        switches: statistics.switches,
        steps: statistics.segments,
        apart: Apart::default(),
    })
}
