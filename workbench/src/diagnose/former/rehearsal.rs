//! What the right model itself leaves where friction fluctuates under a law with branches.
//!
//! Friction that fluctuates changes the acceleration and with it the branch that such a law is on, so that what is left over
//! a window has structure over speed, acceleration and α although nothing is missing. How much of it is found by running the
//! fitted model through the same inputs, with friction that fluctuates as found and sensors as noisy, and looking at these
//! records as at the measured ones.

use std::sync::Arc;

use stickslip::integrator::{IntegrationError, Options, Simulation};
use stickslip::plant::{Rig, RigInputs, RigState, index};

use super::data::Data;
use super::fit::{Fit, fit};
use super::marginal::Disturbance;
use super::run::{CHANNELS, Run};
use super::structure::{Coordinate, Structure, structures};
use inference::random::Random;

/// Most rehearsals; what the strongest of them leaves is what chance may leave.
const REHEARSALS: u64 = 4;
/// Steps in which the fitted model settles on the records of a rehearsal.
const STEPS: usize = 4;

/// What is left of the records of a rehearsal.
#[derive(Debug)]
pub struct Rehearsal {
    /// Structure, strongest first.
    pub structures: Vec<Structure>,
    /// Sum of squares per residual without the few worst windows.
    pub typical_misfit: f64,
}

impl Rehearsal {
    /// Gain in ln likelihood of a residual torque over this coordinate; 0 where there is none.
    #[must_use]
    pub fn gain_over(&self, coordinate: Coordinate) -> f64 {
        self.structures
            .iter()
            .filter(|left| left.coordinate == coordinate)
            .map(|left| left.gain)
            .fold(0.0, f64::max)
    }
}

/// Rehearsals of `fitted` on the inputs of `data`, one after the other; fewer where the model cannot run through them.
pub fn rehearse<'a>(data: &'a Data, fitted: &'a Fit) -> impl Iterator<Item = Rehearsal> + 'a {
    (1..=REHEARSALS).filter_map(|seed| rehearsal(data, fitted, seed))
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
        // Under every law friction is in proportion to the normal force, but for a load exponent, which changes little here.
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

#[cfg(test)]
mod tests {
    use super::*;

    use std::path::Path;

    use stickslip::plant::ModelFile;

    use crate::diagnose::former::hypothesis::Hypothesis;
    use crate::diagnose::former::robust::Robust;
    use crate::diagnose::former::window::{Begin, Cut};
    use crate::diagnose::sensors::Sensors;

    /// A rig that turns from rest under constant inputs, with friction that fluctuates by this share.
    fn turning(relative: f64) -> (Data, Fit) {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/unbalance/model.toml");
        let text = std::fs::read_to_string(path).unwrap();
        let model = ModelFile::parse(&text, "believed").unwrap();
        let samples = 1200;
        let run = Run {
            name: "turning".to_owned(),
            time: (0..samples).map(|j| 0.01 * f64::from(j)).collect(),
            voltage: vec![model.rig.voltage_for_speed(12.0); 1200],
            normal_force: vec![20.0; 1200],
            readings: std::array::from_fn(|_| vec![0.0; 1200]),
        };
        let cut = Cut::of(&model.rig, Begin::Clear);
        let data = Data::new(Arc::new(vec![run]), cut, {
            let none = inference::record::Instruments::default();
            let [a, b, c, d, ..] = Sensors::dissertation().completed(&none).deviations();
            [a, b, c, d]
        });
        let hypothesis = Hypothesis::base(&model);
        let mut fitted = fit(&data, hypothesis, data.anchors(), 0, Robust::JUDGING);
        fitted.disturbance = Disturbance {
            relative,
            ..Disturbance::NONE
        };
        (data, fitted)
    }

    #[test]
    fn a_rehearsal_leaves_the_sensors_noise_alone() {
        for relative in [0.0, 0.04] {
            let (data, fitted) = turning(relative);
            let left = rehearsal(&data, &fitted, 1).unwrap();
            let misfit = left.typical_misfit;
            assert!(misfit > 0.8 && misfit < 1.1, "{relative}: {misfit}");
            assert!(left.gain_over(Coordinate::Time) < 10.0);
        }
    }

    #[test]
    fn friction_fluctuates_as_found() {
        let courses = [0.0, 0.04].map(|relative| {
            let (data, fitted) = turning(relative);
            let rig = fitted.hypothesis.rig_at().unwrap();
            let (run, start) = (&data.runs[0], &fitted.starts[0]);
            let mut random = Random::new(7);
            played(&data, run, &rig, start, &fitted.disturbance, &mut random).unwrap()
        });
        let [calm, rough] = &courses;
        let scatter = |run: &Run| {
            let speeds = &run.readings[1][600..];
            let mean = speeds.iter().sum::<f64>() / speeds.len() as f64;
            speeds.iter().map(|w| (w - mean).powi(2)).sum::<f64>() / speeds.len() as f64
        };
        assert!(
            scatter(rough) > 1.2 * scatter(calm),
            "{} {}",
            scatter(rough),
            scatter(calm)
        );
    }
}
