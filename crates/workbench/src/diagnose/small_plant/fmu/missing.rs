//! The force that an FMU lacks on each record, and how it changes with what is uncertain.

use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;
use thiserror::Error;

use super::plant::{Plant, PlantError};
use super::pursuit::{Pursuit, substeps};
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
}

/// Part of its root mean square by which a column is made larger to see what that does.
const OFFSET: f64 = 0.01;

impl Chased {
    /// The shortest step in which the FMU runs after a record [s].
    #[must_use]
    pub fn step(&self) -> f64 {
        let own = self.plant.places.iter().filter_map(|place| place.cut_off);
        let fastest = own.fold(self.cut_off, f64::max);
        let steps = self.records.iter();
        steps
            .map(|own| substeps(own.motions[0].interval, fastest).1)
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
                match variations[at % count] {
                    Variation::None => {}
                    Variation::Parameter(own) => values[own] += deviations[own],
                    Variation::Read(place, samples) => {
                        delays[place] += samples * record.motions[place].interval;
                    }
                    Variation::Offset(input) => offset = Some((input, record.offset(input))),
                }
                let pursuit = self.pursuit(record, &values, &delays, offset);
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
                let known = (parameters, delays);
                let motion = moved(record, place, found, &variations, known, &deviations);
                all.push(self.checked(motion)?);
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
    ) -> Result<Vec<Pursuit>, WorkerError> {
        let pursued = self
            .plant
            .pursued(record, parameters, delays, offset, self.cut_off);
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

    /// Refuses a record in which the plant hardly moves; finds where it does.
    fn checked(&self, mut motion: Motion) -> Result<Motion, MissingError> {
        let own = self.plant.places.get(motion.port);
        let cut_off = own.and_then(|place| place.cut_off).unwrap_or(self.cut_off);
        motion.cut_off = Some(cut_off);
        motion.leave_rests_out(self.standstill, cut_off);
        if motion.hardly_moves() {
            return Err(MissingError::Rests {
                seconds: motion.seconds_that_tell(),
                record: motion.name,
            });
        }
        Ok(motion)
    }
}

impl Recorded {
    /// By how much the column of an input is made larger to see what that does.
    fn offset(&self, input: usize) -> f64 {
        let size = root_mean_square(&self.driven[input]);
        OFFSET * if size > 0.0 { size } else { 1.0 }
    }
}

/// The motion at a port that a record's pursuits found.
fn moved(
    record: &Recorded,
    place: usize,
    found: &[Vec<Pursuit>],
    variations: &[Variation],
    (parameters, delays): (&[f64], &[f64]),
    deviations: &[f64],
) -> Motion {
    let mut motion = record.motions[place].clone();
    motion.port = place;
    let at = |run: usize| &found[run][place];
    let own = at(0);
    let slope = |from: &Pursuit, to: &Pursuit, size: f64| -> Vec<f64> {
        let pairs = from.force.iter().zip(&to.force);
        pairs.map(|(from, to)| (from - to) / size).collect()
    };
    let (mut slopes, mut inertia_slopes) = (Vec::new(), Vec::new());
    let (mut later, mut delayed, mut offsets) = (None, Vec::new(), Vec::new());
    for (run, variation) in variations.iter().enumerate() {
        match *variation {
            Variation::None => {}
            Variation::Parameter(which) => {
                let size = deviations[which];
                slopes.push(slope(own, at(run), size));
                inertia_slopes.push((at(run).inertia.abs() - own.inertia.abs()) / size);
            }
            // To both sides: noise of a difference to one side goes against that of the force, and a little of it would pass for a delay.
            Variation::Read(_, samples) if samples > 0.0 => later = Some(run),
            Variation::Read(of, _) => {
                if let Some(later) = later {
                    let interval = record.motions[of].interval;
                    delayed.push(slope(at(run), at(later), 2.0 * interval));
                }
            }
            Variation::Offset(input) => {
                offsets.push(slope(own, at(run), record.offset(input)));
            }
        }
    }
    let here = |at: usize| -> f64 {
        let pairs = parameters.iter().zip(&slopes);
        pairs.map(|(value, slope)| value * slope[at]).sum()
    };
    motion.pursuit = Some(Known {
        at: parameters.to_vec(),
        at_delays: delays.to_vec(),
        nominal: (0..motion.len()).map(here).collect(),
        inertia: own.inertia.abs(),
        sense: own.inertia.signum(),
        inertia_slopes,
        delayed,
        slopes,
        offsets,
    });
    // What the force was found for: another estimate of the motion has other noise, and a mixture of both has less than either.
    motion.force.clone_from(&own.force);
    motion.position.clone_from(&own.position);
    motion.velocity.clone_from(&own.velocity);
    motion.acceleration.clone_from(&own.acceleration);
    motion.load.clone_from(&own.load);
    motion
}
