//! Our own integrator on the same systems, through its Rust interface.

use std::hint::black_box;

use anyhow::Result;
use stickslip::integrator::{Options, Simulation, Statistics};
use stickslip::plant::{Rig, RigInputs, STATES, index};

use crate::effort::{Effort, fastest};
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
            // A run takes a millisecond: many repetitions cost nothing and outlast disturbances.
            let repetitions = 10 * effort.repetitions();
            match fastest(repetitions, || simulate(rig, inputs, options)) {
                Ok((seconds, (theta, statistics))) => runs.push(Run {
                    system: system.key.into(),
                    solver: NAME.into(),
                    configuration: format!("order {order}"),
                    tolerance,
                    seconds,
                    theta,
                    error: f64::NAN,
                    switches: statistics.switches,
                    steps: statistics.segments,
                    apart: Apart::default(),
                }),
                Err(error) => eprintln!(
                    "system {}: {NAME} order {order} at {tolerance:.0e}: {error:#}",
                    system.key
                ),
            }
        }
    }
    Ok(runs)
}

/// θ2 at the end of a run, and what it took.
fn simulate(rig: Rig<f64>, inputs: RigInputs<f64>, options: Options) -> Result<(f64, Statistics)> {
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
    Ok((theta, simulation.statistics()))
}
