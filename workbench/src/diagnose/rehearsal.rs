//! What the right model itself leaves where friction fluctuates under a law with branches.
//!
//! Friction that fluctuates changes the acceleration and with it the branch that such a law is on, so that what is left over
//! a window has structure over speed, acceleration and α although nothing is missing. How much of it is found by running the
//! fitted model through the same inputs, with friction that fluctuates as found and sensors as noisy, and looking at these
//! records as at the measured ones.

use std::sync::Arc;

use rayon::prelude::*;
use stickslip::integrator::{IntegrationError, Options, Simulation};
use stickslip::plant::{Rig, RigInputs, RigState, index};

use super::data::Data;
use super::fit::{Fit, fit};
use super::marginal::Disturbance;
use super::run::{CHANNELS, Run};
use super::structure::{Structure, structures};
use crate::random::Random;

/// Rehearsals; what the strongest of them leaves is what chance may leave.
const REHEARSALS: u64 = 2;
/// Steps in which the fitted model settles on the records of a rehearsal.
const STEPS: usize = 6;

/// What is left of the records of a rehearsal.
#[derive(Debug)]
pub struct Rehearsal {
    /// Structure, strongest first.
    pub structures: Vec<Structure>,
    /// Sum of squares per residual without the few worst windows.
    pub typical_misfit: f64,
}

/// Rehearsals of `fitted` on the inputs of `data`; fewer where the model cannot run through them.
#[must_use]
pub fn rehearse(data: &Data, fitted: &Fit) -> Vec<Rehearsal> {
    (1..=REHEARSALS)
        .into_par_iter()
        .filter_map(|seed| rehearsal(data, fitted, seed))
        .collect()
}

fn rehearsal(data: &Data, fitted: &Fit, seed: u64) -> Option<Rehearsal> {
    let rig = fitted.hypothesis.rig_at().ok()?;
    let mut random = Random::new(seed);
    let mut runs = Vec::with_capacity(data.runs.len());
    for (at, run) in data.runs.iter().enumerate() {
        let first = data.windows.iter().position(|window| window.run == at);
        let start = first.map(|first| &fitted.starts[first])?;
        runs.push(played(data, run, &rig, start, &fitted.disturbance, &mut random).ok()?);
    }
    let records = Data::new(Arc::new(runs), data.cut, data.deviations);
    let hypothesis = fitted.hypothesis.clone();
    let refitted = fit(
        &records,
        hypothesis,
        records.anchors(),
        STEPS,
        fitted.judging,
    );
    Some(Rehearsal {
        structures: structures(&records, &refitted),
        typical_misfit: refitted.typical_misfit(&records),
    })
}

/// A run of the model through a record's inputs, read by sensors as noisy as the record's.
fn played(
    data: &Data,
    run: &Run,
    rig: &Rig<f64>,
    start: &RigState<f64>,
    disturbance: &Disturbance,
    random: &mut Random,
) -> Result<Run, IntegrationError> {
    let mut played = run.clone();
    let remembered = (-run.interval() / disturbance.correlation_time).exp();
    let mut fluctuation = disturbance.relative * random.normal();
    let inputs = |sample: usize, fluctuation: f64| {
        // Friction is in proportion to the normal force.
        let pressed = run.normal_force[sample] * (1.0 + fluctuation);
        RigInputs::held(run.voltage[sample], pressed, 0.0)
    };
    let mut simulation = Simulation::new(
        *rig,
        Options::default(),
        run.time[0],
        *start,
        inputs(0, fluctuation),
    )?;
    let mut motion: Vec<[f64; CHANNELS]> = Vec::with_capacity(run.len());
    for sample in 0..run.len() {
        let time = run.time[sample];
        simulation.advance_to(time)?;
        let at = |component: usize| simulation.component_at(component, time);
        motion.push([
            at(index::THETA),
            at(index::OMEGA),
            at(index::THETA3),
            at(index::OMEGA3),
        ]);
        fluctuation = remembered * fluctuation
            + (1.0 - remembered * remembered).sqrt() * disturbance.relative * random.normal();
        simulation.set_inputs(time, inputs(sample, fluctuation))?;
    }
    let delay = rig.effects.sensor_delay.map_or(0.0, |delay| delay.delay);
    for channel in 0..CHANNELS {
        let lag = if channel < 2 { delay } else { 0.0 };
        let samples_back = lag / run.interval();
        for (sample, reading) in played.readings[channel].iter_mut().enumerate() {
            let place = (sample as f64 - samples_back).max(0.0);
            let (before, share) = (place as usize, place.fract());
            let after = (before + 1).min(motion.len() - 1);
            let value = motion[before][channel] * (1.0 - share) + motion[after][channel] * share;
            *reading = value + data.deviations[channel] * random.normal();
        }
    }
    Ok(played)
}
