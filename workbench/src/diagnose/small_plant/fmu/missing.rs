//! The force that an FMU lacks on each record, and how it changes with what is uncertain.

use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;
use thiserror::Error;

use super::plant::{Plant, PlantError};
use super::pursuit::{Pursuit, substeps};
use super::worker::{self, WorkerError};
use crate::diagnose::small_plant::motion::{Motion, Pursuit as Known};

/// A record with the columns that drive the FMU.
#[derive(Debug, Clone)]
pub struct Recorded {
    /// The measured motion.
    pub motion: Motion,
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

impl Chased {
    /// The shortest step in which the FMU runs after a record [s].
    #[must_use]
    pub fn step(&self) -> f64 {
        let steps = self.records.iter();
        steps
            .map(|own| substeps(own.motion.interval, self.cut_off).1)
            .fold(f64::INFINITY, f64::min)
    }
}

impl Chased {
    /// The motion of every record with the force that the FMU lacks, at these values of its uncertain parameters and of the delay
    /// with which the motion is read [s].
    ///
    /// # Errors
    /// [`MissingError`], naming the FMU, the record and the time.
    pub fn missing(
        &self,
        parameters: &[f64],
        delay: f64,
        progress: &mut dyn FnMut(&str),
    ) -> Result<Vec<Motion>, MissingError> {
        let deviations: Vec<f64> = self.plant.deviations().collect();
        // As it is, with each parameter one deviation larger, and with the motion read a sample later and a sample earlier.
        let count = deviations.len() + 3;
        progress(&format!(
            "{} runs of {} after the records",
            count * self.records.len(),
            self.plant.file.display()
        ));
        let has_failed = AtomicBool::new(false);
        let found: Vec<Result<Option<Pursuit>, WorkerError>> = (0..count * self.records.len())
            .into_par_iter()
            .map(|at| {
                // One failure is enough to say so.
                if has_failed.load(Ordering::Relaxed) {
                    return Ok(None);
                }
                let (record, variation) = (&self.records[at / count], at % count);
                let mut values = parameters.to_vec();
                let mut delay = delay;
                if variation == deviations.len() + 1 {
                    delay += record.motion.interval;
                } else if variation > deviations.len() {
                    delay -= record.motion.interval;
                } else if variation > 0 {
                    values[variation - 1] += deviations[variation - 1];
                }
                let pursuit = self.pursuit(record, &values, delay);
                if pursuit.is_err() {
                    has_failed.store(true, Ordering::Relaxed);
                }
                pursuit.map(Some)
            })
            .collect();
        let found: Result<Vec<Option<Pursuit>>, WorkerError> = found.into_iter().collect();
        let found: Vec<Pursuit> = found?.into_iter().flatten().collect();
        let own = self.records.iter().zip(found.chunks(count));
        own.map(|(record, found)| {
            let motion = moved(&record.motion, found, (parameters, delay), &deviations);
            self.checked(motion)
        })
        .collect()
    }

    /// The FMU's pursuit of a record, with the force against the motion that it lacks.
    fn pursuit(
        &self,
        record: &Recorded,
        parameters: &[f64],
        delay: f64,
    ) -> Result<Pursuit, WorkerError> {
        let pursued = self.plant.pursued(record, parameters, delay, self.cut_off);
        let pursuit = worker::run(&self.plant.file, pursued, &record.motion.name)?;
        let against = -pursuit.inertia.signum();
        Ok(Pursuit {
            force: pursuit.force.iter().map(|force| against * force).collect(),
            ..pursuit
        })
    }

    /// Refuses a record in which the plant hardly moves; finds where it does.
    fn checked(&self, mut motion: Motion) -> Result<Motion, MissingError> {
        // Through a standstill friction goes from one side to the other.
        let turning = |v: &f64| (v / self.standstill).clamp(-1.0, 1.0);
        if self.standstill > 0.0 {
            motion.direction = motion.velocity.iter().map(turning).collect();
        }
        let moves = moves(&motion, self.standstill, self.cut_off);
        let moving = moves.iter().filter(|own| **own).count();
        if moving < moves.len() / 10 {
            return Err(MissingError::Rests {
                record: motion.name,
                seconds: moving as f64 * motion.interval,
            });
        }
        if let Some(known) = &mut motion.pursuit {
            known.moves = moves;
        }
        Ok(motion)
    }
}

/// The motion that a record's pursuits found: as it is, with each parameter larger, with the motion read later and earlier.
fn moved(
    measured: &Motion,
    found: &[Pursuit],
    (parameters, delay): (&[f64], f64),
    deviations: &[f64],
) -> Motion {
    let mut motion = measured.clone();
    let [own, varied @ .., later, earlier] = found else {
        return motion;
    };
    let slope = |from: &Pursuit, to: &Pursuit, size: f64| -> Vec<f64> {
        let pairs = from.force.iter().zip(&to.force);
        pairs.map(|(from, to)| (from - to) / size).collect()
    };
    let sized = || varied.iter().zip(deviations);
    let slopes: Vec<Vec<f64>> = sized()
        .map(|(moved, size)| slope(own, moved, *size))
        .collect();
    let grown = |(moved, size): (&Pursuit, &f64)| (moved.inertia.abs() - own.inertia.abs()) / size;
    let here = |at: usize| -> f64 {
        let pairs = parameters.iter().zip(&slopes);
        pairs.map(|(value, slope)| value * slope[at]).sum()
    };
    motion.pursuit = Some(Known {
        at: parameters.to_vec(),
        at_delay: delay,
        nominal: (0..motion.len()).map(here).collect(),
        inertia: own.inertia.abs(),
        sense: own.inertia.signum(),
        inertia_slopes: sized().map(grown).collect(),
        // To both sides: noise of a difference to one side goes against that of the force, and a little of it would pass for a delay.
        delayed: slope(earlier, later, 2.0 * motion.interval),
        slopes,
        moves: Vec::new(),
    });
    // What the force was found for: another estimate of the motion has other noise, and a mixture of both has less than either.
    motion.force.clone_from(&own.force);
    motion.position.clone_from(&own.position);
    motion.velocity.clone_from(&own.velocity);
    motion.acceleration.clone_from(&own.acceleration);
    motion
}

/// Where the plant moves, and has moved for as long as what is looked at takes.
fn moves(motion: &Motion, standstill: f64, cut_off: f64) -> Vec<bool> {
    let reach = (0.5 / (cut_off * motion.interval)).ceil() as usize;
    let mut moves = vec![true; motion.len()];
    for (at, velocity) in motion.velocity.iter().enumerate() {
        if velocity.abs() <= standstill {
            let (from, to) = (at.saturating_sub(reach), (at + reach + 1).min(moves.len()));
            moves[from..to].fill(false);
        }
    }
    moves
}
