//! Sensors of the disc that lag: the motion of the recent past, from which they read.

use crate::cosim::{StateError, StateReader, StateWriter};
use crate::integrator::{HybridSystem, Simulation};
use crate::plant::{Rig, index};
use std::collections::VecDeque;

/// Angle and velocity of disc D2 over a stretch of time, as polynomials from its start on. It ends
/// where the next one starts.
#[derive(Clone, Debug, PartialEq)]
struct Stretch {
    start: f64,
    angle: Vec<f64>,
    velocity: Vec<f64>,
}

/// The recent past of disc D2. Before the run began, angle and velocity were what they began with: a diagnosis leaves such readings
/// out or takes the same.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct DelayLine {
    /// Lag of the sensors [s].
    delay: f64,
    stretches: VecDeque<Stretch>,
}

impl DelayLine {
    /// A line for sensors that lag by `delay` [s].
    pub(super) fn new(delay: f64) -> Self {
        Self {
            delay,
            stretches: VecDeque::new(),
        }
    }

    /// Keeps the present segment of a run, which is about to be left or cut.
    pub(super) fn keep(&mut self, run: &Simulation<f64, Rig<f64>>) {
        self.stretches.push_back(Stretch::of(run));
        let oldest = run.segment_start() - self.delay;
        while self
            .stretches
            .get(1)
            .is_some_and(|next| next.start <= oldest)
        {
            self.stretches.pop_front();
        }
    }

    /// What `use_it` makes of the polynomial that the sensors show at `time` [s], of the angle or the velocity by its `place` in
    /// the state, and of the local time at which to read it.
    pub(super) fn read<R>(
        &self,
        run: &Simulation<f64, Rig<f64>>,
        place: usize,
        time: f64,
        use_it: impl FnOnce(&[f64], f64) -> R,
    ) -> R {
        let time = time - self.delay;
        let present = present(run, place);
        if time >= run.segment_start() {
            return use_it(present, time - run.segment_start());
        }
        let past = self.stretches.iter().rev().find(|past| past.start <= time);
        match (past, self.stretches.front()) {
            (Some(past), _) => use_it(past.of_state(place), time - past.start),
            (None, Some(first)) => use_it(&first.of_state(place)[..1], 0.0),
            (None, None) => use_it(&present[..1], 0.0),
        }
    }

    /// Writes the line into a state.
    pub(super) fn save(&self, state: &mut StateWriter) {
        state.integer(self.stretches.len() as u64);
        for stretch in &self.stretches {
            state.real(stretch.start);
            state.integer(stretch.angle.len() as u64);
            for series in [&stretch.angle, &stretch.velocity] {
                series
                    .iter()
                    .for_each(|coefficient| state.real(*coefficient));
            }
        }
    }

    /// The opposite of [`save`](Self::save).
    pub(super) fn restore(delay: f64, state: &mut StateReader<'_>) -> Result<Self, StateError> {
        let mut line = Self::new(delay);
        for _ in 0..state.integer()? {
            let start = state.real()?;
            let terms = state.integer()?;
            let mut series = || {
                (0..terms)
                    .map(|_| state.real())
                    .collect::<Result<Vec<_>, _>>()
            };
            let (angle, velocity) = (series()?, series()?);
            if angle.is_empty() {
                return Err(StateError::Content("a stretch of the past is empty".into()));
            }
            line.stretches.push_back(Stretch {
                start,
                angle,
                velocity,
            });
        }
        Ok(line)
    }
}

impl Stretch {
    fn of(run: &Simulation<f64, Rig<f64>>) -> Self {
        Self {
            start: run.segment_start(),
            angle: present(run, index::THETA).to_vec(),
            velocity: present(run, index::OMEGA).to_vec(),
        }
    }

    /// The polynomial of a state.
    fn of_state(&self, place: usize) -> &[f64] {
        if place == index::OMEGA {
            &self.velocity
        } else {
            &self.angle
        }
    }
}

/// The present segment's polynomial of a state.
fn present(run: &Simulation<f64, Rig<f64>>, place: usize) -> &[f64] {
    let terms = run.jet().friction_torque().len();
    &run.system().states(run.jet())[place][..terms]
}
