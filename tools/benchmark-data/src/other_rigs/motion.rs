//! Whether records stick and slip: what a trial run is looked at for.

use crate::excitation::Run;
use crate::other_rigs::case::DrawnCase;
use crate::other_rigs::contact::loop_margin;
use crate::simulator::Sample;

/// Smallest margin of the algebraic loop over the region visited [-].
const SMALLEST_MARGIN: f64 = 0.3;
/// Speed over the top speed below which the disc sticks, and above which it slides [-].
const SPEEDS: (f64, f64) = (0.004, 0.02);
/// Natural periods of sliding without a stop that count as sliding only [-].
const SLIDING_PERIODS: f64 = 1.5;
/// Natural periods at rest that count as sticking [-].
const STICKING_PERIODS: f64 = 0.03;

/// What the disc did.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Motion {
    /// Phases of sticking after the first motion.
    pub phases: usize,
    /// Share of the braked time in which the disc sticks [-].
    pub sticking: f64,
    /// Longest stretch of sliding under load in natural periods [-].
    pub sliding: f64,
    /// Smallest margin of the algebraic loop [-].
    pub margin: f64,
    /// Whether the disc ever moved.
    pub moved: bool,
    /// Whether the pin pressed at all.
    pub braked: bool,
}

/// Judgement of a trial.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Seen {
    /// It sticks at some points and slides at others.
    Good(Motion),
    /// The loads are too small.
    NeverSticks,
    /// The loads are too large.
    NeverSlides,
    /// The friction law sees an acceleration that has several solutions.
    LoopManyValued,
}

impl DrawnCase {
    /// What the disc did in one run.
    pub fn look(&self, samples: &[Sample], run: &Run) -> Motion {
        let interval = self.layout.interval;
        let (rest, moving) = (SPEEDS.0 * self.rig.top_speed, SPEEDS.1 * self.rig.top_speed);
        let needed = (STICKING_PERIODS * self.rig.period / interval)
            .ceil()
            .max(2.0) as usize;
        let per_load = self.truth.parameters.contact_radius;
        let mut motion = Motion {
            margin: f64::INFINITY,
            ..Motion::default()
        };
        let (mut resting, mut sliding, mut stuck, mut pressed) =
            (0_usize, 0_usize, 0_usize, 0_usize);
        for (sample, &load) in samples.iter().zip(&run.excitation.normal_force) {
            let speed = sample.state.disc_speed;
            if load > 0.0 {
                pressed += 1;
                if speed.abs() > moving {
                    let margin = loop_margin(
                        &self.truth.law,
                        load * per_load,
                        self.truth.parameters.disc_inertia,
                        speed,
                        sample.acceleration,
                    );
                    motion.margin = motion.margin.min(margin);
                }
            }
            if speed.abs() < rest && load > 0.0 {
                resting += 1;
                stuck += 1;
                if resting == needed && motion.moved {
                    motion.phases += 1;
                }
            } else {
                resting = 0;
            }
            if speed.abs() > moving {
                motion.moved = true;
                sliding = if load > 0.0 { sliding + 1 } else { 0 };
            } else {
                sliding = 0;
            }
            let periods = sliding as f64 * interval / self.rig.period;
            motion.sliding = motion.sliding.max(periods);
        }
        motion.braked = pressed > 0;
        motion.sticking = stuck as f64 / pressed.max(1) as f64;
        motion
    }

    /// Whether what was seen in the runs to learn from makes a case.
    pub fn judge(&self, motions: &[Motion]) -> Seen {
        let braked: Vec<&Motion> = motions.iter().filter(|motion| motion.braked).collect();
        let count = braked.len().max(1) as f64;
        let all = Motion {
            phases: braked.iter().map(|motion| motion.phases).sum(),
            sticking: braked.iter().map(|motion| motion.sticking).sum::<f64>() / count,
            sliding: braked
                .iter()
                .map(|motion| motion.sliding)
                .fold(0.0, f64::max),
            margin: braked
                .iter()
                .map(|motion| motion.margin)
                .fold(f64::INFINITY, f64::min),
            moved: braked.iter().all(|motion| motion.moved),
            braked: true,
        };
        // Without stiction the disc sticks where the drive stops, or starts.
        let has_stiction = self.truth.law.breakaway() > 1.05 * self.laws.levels.sliding;
        let needed = if has_stiction { 2 } else { 0 };
        if all.margin < SMALLEST_MARGIN {
            Seen::LoopManyValued
        } else if !all.moved || all.sliding < SLIDING_PERIODS {
            Seen::NeverSlides
        } else if all.phases < needed {
            Seen::NeverSticks
        } else {
            Seen::Good(all)
        }
    }
}
