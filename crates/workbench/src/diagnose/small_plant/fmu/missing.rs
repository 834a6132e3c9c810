//! The force that an FMU lacks on each record, and how it changes with what is uncertain.

use std::f64::consts::TAU;
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;
use thiserror::Error;

use super::plant::{Plant, PlantError};
use super::pursuit::{Pursuit, substeps};
use super::swing;
use super::worker::{self, WorkerError};
use inference::body::motion::{Motion, Pursuit as Known, root_mean_square};

/// A record with the columns that drive the FMU.
#[derive(Debug, Clone)]
pub struct Recorded {
    /// The measured motion at each port.
    pub motions: Vec<Motion>,
    /// Columns in the order of [`Plant::columns`].
    pub driven: Vec<Vec<f64>>,
}

/// Why the force that an FMU lacks is not known.
#[derive(Debug, Error)]
pub enum MissingError {
    /// The ports are wrong.
    #[error(transparent)]
    Plant(#[from] PlantError),
    /// A run failed.
    #[error(transparent)]
    Worker(#[from] WorkerError),
    /// The plant hardly moves.
    #[error(
        "{record}: stands still but for {seconds:.3} s; where the plant rests, the force that is missing is not known"
    )]
    Rests {
        /// The record.
        record: String,
        /// How long it moves [s].
        seconds: f64,
    },
}

/// An FMU with the records that it is to explain.
#[derive(Debug, Clone)]
pub struct Chased {
    /// The FMU.
    pub plant: Plant,
    /// The records as they were measured.
    pub records: Vec<Recorded>,
    /// Frequency below which forces are compared [Hz].
    pub cut_off: f64,
    /// Speed below which the plant counts as standing [m/s or rad/s].
    pub standstill: f64,
}

/// A run beside the one with everything as it is.
#[derive(Debug, Clone, Copy)]
enum Variation {
    /// Everything as it is.
    None,
    /// A parameter is one deviation larger.
    Parameter(usize),
    /// The motion at a port is read a sample later (1) or earlier (−1).
    Read(usize, f64),
    /// The column of an input is larger by a part of its usual size.
    Offset(usize),
    /// The motion swings a little more, everything as it is or with one parameter a deviation larger.
    Swung(Option<usize>),
}

/// Part of its root mean square by which a column is made larger to see what that does.
const OFFSET: f64 = 0.01;
/// Periods for which the motion swings more while the plant moves. A numerical tolerance: the swing fades in and out, so that half count.
const SWINGS: f64 = 50.0;

impl Chased {
    /// The shortest step in which the FMU runs after a record [s].
    #[must_use]
    pub fn step(&self) -> f64 {
        let own = self.plant.places.iter().filter_map(|place| place.cut_off);
        let fastest = own.fold(self.cut_off, f64::max);
        let steps = self.records.iter();
        steps
            .map(|own| substeps(own.motions[0].interval, fastest, self.plant.own_step).1)
            .fold(f64::INFINITY, f64::min)
    }

    /// The motion of every record at every port with the force that the FMU lacks, at these values of its uncertain parameters and of
    /// the delays with which the motion is read at the ports [s]: record by record, in each port by port.
    ///
    /// # Errors
    /// [`MissingError`], naming the FMU, the record and the time.
    pub fn missing(
        &self,
        parameters: &[f64],
        delays: &[f64],
        progress: &mut dyn FnMut(&str),
    ) -> Result<Vec<Motion>, MissingError> {
        let deviations: Vec<f64> = self.plant.deviations().collect();
        let places = 0..self.plant.places.len();
        let variations: Vec<Variation> = std::iter::once(Variation::None)
            .chain((0..deviations.len()).map(Variation::Parameter))
            .chain(places.flat_map(|at| [Variation::Read(at, 1.0), Variation::Read(at, -1.0)]))
            .chain(self.plant.offsets().map(Variation::Offset))
            .chain([Variation::Swung(None)])
            .chain((0..deviations.len()).map(|own| Variation::Swung(Some(own))))
            .collect();
        let count = variations.len();
        progress(&format!(
            "{} runs of {} after the records",
            count * self.records.len(),
            self.plant.file.display()
        ));
        let has_failed = AtomicBool::new(false);
        let found: Vec<Result<Option<Vec<Pursuit>>, WorkerError>> = (0..count * self.records.len())
            .into_par_iter()
            .map(|at| {
                // One failure is enough to say so.
                if has_failed.load(Ordering::Relaxed) {
                    return Ok(None);
                }
                let record = &self.records[at / count];
                let mut values = parameters.to_vec();
                let mut delays = delays.to_vec();
                let mut offset = None;
                let is_swung = matches!(variations[at % count], Variation::Swung(_));
                match variations[at % count] {
                    Variation::None | Variation::Swung(None) => {}
                    Variation::Parameter(own) | Variation::Swung(Some(own)) => {
                        values[own] += deviations[own];
                    }
                    Variation::Read(place, samples) => {
                        delays[place] += samples * record.motions[place].interval;
                    }
                    Variation::Offset(input) => offset = Some((input, record.offset(input))),
                }
                let pursuit = self.pursuit(record, &values, &delays, offset, is_swung);
                if pursuit.is_err() {
                    has_failed.store(true, Ordering::Relaxed);
                }
                pursuit.map(Some)
            })
            .collect();
        let found: Result<Vec<Option<Vec<Pursuit>>>, WorkerError> = found.into_iter().collect();
        let found: Vec<Vec<Pursuit>> = found?.into_iter().flatten().collect();
        let mut all = Vec::new();
        for (record, found) in self.records.iter().zip(found.chunks(count)) {
            for place in 0..record.motions.len() {
                let found: Vec<&Pursuit> = found.iter().map(|ports| &ports[place]).collect();
                let mut motion = self.moved(record, place, found[0])?;
                motion.pursuit =
                    Some(self.known(record, &motion, (parameters, delays), &variations, &found));
                all.push(motion);
            }
        }
        Ok(all)
    }

    /// The FMU's pursuit of a record, with the force against the motion that it lacks at each port.
    fn pursuit(
        &self,
        record: &Recorded,
        parameters: &[f64],
        delays: &[f64],
        offset: Option<(usize, f64)>,
        is_swung: bool,
    ) -> Result<Vec<Pursuit>, WorkerError> {
        let mut pursued = self
            .plant
            .pursued(record, parameters, delays, offset, self.cut_off);
        if is_swung {
            let enough = self.enough(record);
            for (place, port) in pursued.ports.iter_mut().enumerate() {
                port.measured_position.truncate(enough);
                port.measured_velocity.truncate(enough);
                swing::add(port, self.swing(place), pursued.interval);
            }
        }
        let found = worker::run(&self.plant.file, pursued, &record.motions[0].name)?;
        let against = |pursuit: Pursuit| {
            let against = -pursuit.inertia.signum();
            Pursuit {
                force: pursuit.force.iter().map(|force| against * force).collect(),
                ..pursuit
            }
        };
        Ok(found.into_iter().map(against).collect())
    }

    /// Frequency up to which the force at a port is compared [Hz].
    fn cut_off(&self, place: usize) -> f64 {
        self.plant.places[place].cut_off.unwrap_or(self.cut_off)
    }

    /// Angular frequency at which the motion at a port swings more [rad/s]: at its cut-off, or below it for further ports, so that a
    /// force tells which of them it answers.
    fn swing(&self, place: usize) -> f64 {
        let part = place as f64 / self.plant.places.len() as f64;
        TAU * self.cut_off(place) * (1.0 - 0.5 * part)
    }

    /// Samples after which the motion at each port has swung often enough while it says something of the forces.
    fn enough(&self, record: &Recorded) -> usize {
        let of_places = record.motions.iter().enumerate().map(|(place, motion)| {
            let mut motion = motion.clone();
            motion.leave_rests_out(self.standstill, self.cut_off(place));
            let wanted = SWINGS * TAU / (self.swing(place) * motion.interval);
            let telling = (0..motion.len()).filter(|at| motion.tells[*at]);
            telling.take(wanted as usize).last().unwrap_or(0) + 2
        });
        of_places.max().unwrap_or(0)
    }

    /// The motion at a port with the force that the FMU lacks there. Refuses a record in which the plant hardly moves.
    fn moved(
        &self,
        record: &Recorded,
        place: usize,
        own: &Pursuit,
    ) -> Result<Motion, MissingError> {
        let mut motion = record.motions[place].clone();
        let cut_off = self.cut_off(place);
        motion.port = place;
        motion.cut_off = Some(cut_off);
        // What the force was found for: another estimate of the motion has other noise, and a mixture of both has less than either.
        motion.force.clone_from(&own.force);
        motion.position.clone_from(&own.position);
        motion.velocity.clone_from(&own.velocity);
        motion.acceleration.clone_from(&own.acceleration);
        motion.load.clone_from(&own.load);
        motion.leave_rests_out(self.standstill, cut_off);
        if motion.hardly_moves() {
            return Err(MissingError::Rests {
                seconds: motion.seconds_that_tell(),
                record: motion.name,
            });
        }
        Ok(motion)
    }

    /// How the force that the FMU lacks at a port changes with what is uncertain.
    fn known(
        &self,
        record: &Recorded,
        motion: &Motion,
        (parameters, delays): (&[f64], &[f64]),
        variations: &[Variation],
        found: &[&Pursuit],
    ) -> Known {
        let own = found[0];
        let deviations: Vec<f64> = self.plant.deviations().collect();
        let frequency = self.swing(motion.port);
        let slope = |from: &Pursuit, to: &Pursuit, size: f64| -> Vec<f64> {
            let pairs = from.force.iter().zip(&to.force);
            pairs.map(|(from, to)| (from - to) / size).collect()
        };
        let (mut slopes, mut inertias) = (Vec::new(), Vec::new());
        let (mut later, mut delayed, mut offsets) = (own, Vec::new(), Vec::new());
        for (run, variation) in found.iter().zip(variations) {
            match *variation {
                Variation::None => {}
                Variation::Parameter(which) => slopes.push(slope(own, run, deviations[which])),
                // To both sides: noise of a difference to one side goes against that of the force, and a little of it would pass for a delay.
                Variation::Read(_, samples) if samples > 0.0 => later = run,
                Variation::Read(of, _) => {
                    delayed.push(slope(run, later, 2.0 * record.motions[of].interval));
                }
                Variation::Offset(input) => offsets.push(slope(own, run, record.offset(input))),
                Variation::Swung(None) => {
                    inertias.push(swing::inertia(motion, own, run, frequency))
                }
                Variation::Swung(Some(which)) => {
                    inertias.push(swing::inertia(motion, found[1 + which], run, frequency));
                }
            }
        }
        let here = |at: usize| -> f64 {
            let pairs = parameters.iter().zip(&slopes);
            pairs.map(|(value, slope)| value * slope[at]).sum()
        };
        let grown = inertias[1..].iter().zip(&deviations);
        Known {
            at: parameters.to_vec(),
            at_delays: delays.to_vec(),
            nominal: (0..motion.len()).map(here).collect(),
            inertia: inertias[0],
            inertia_at_once: own.inertia,
            inertia_slopes: grown
                .map(|(more, size)| (more - inertias[0]) / size)
                .collect(),
            delayed,
            slopes,
            offsets,
        }
    }
}

impl Recorded {
    /// By how much the column of an input is made larger to see what that does.
    fn offset(&self, input: usize) -> f64 {
        let size = root_mean_square(&self.driven[input]);
        OFFSET * if size > 0.0 { size } else { 1.0 }
    }
}
