//! How far a parameter set is from a target.

use stickslip::plant::Rig;

use super::cycle::Cycle;
use super::target::{Goal, Point, Target};
use super::transition::Seen;

/// Misfit [bars] of a point whose run cannot go on.
const FAILED: f64 = 100.0;
/// Misfit [bars] of the transitions of a set that does not meet the points: more than the worst that is seen of one.
const UNTRIED: f64 = 8.0;

/// A parameter set judged by a target.
#[derive(Debug, Clone, PartialEq)]
pub struct Judgement {
    /// Distances from each fact in units of its bar (sticking: 0 or more than 1), with weights.
    pub misfits: Vec<(f64, f64)>,
    /// The motions at the target's points; `None` where a run cannot go on.
    pub cycles: Vec<Option<Cycle>>,
    /// What is seen of the target's transitions; empty where the points are not met.
    pub transitions: Vec<Seen>,
}

impl Judgement {
    /// Judges `rig`, with the sought parameters set to `values`.
    #[must_use]
    pub fn of(rig: &Rig<f64>, target: &Target, values: &[f64]) -> Self {
        let mut judgement = Self {
            misfits: Vec::new(),
            cycles: Vec::new(),
            transitions: Vec::new(),
        };
        let mut trial = *rig;
        for (sought, value) in target.parameter.iter().zip(values) {
            if trial.set_parameter(&sought.name, *value).is_err() {
                judgement.misfits.push((FAILED, 1.0));
                return judgement;
            }
        }
        if trial.check().is_err() {
            judgement.misfits.push((FAILED, 1.0));
            return judgement;
        }
        for point in &target.point {
            let cycle = Cycle::of(&trial, &point.operating()).ok();
            match &cycle {
                Some(cycle) => judgement.add(point, cycle, target.search.smallest_loop_margin),
                None => judgement.misfits.push((FAILED, 1.0)),
            }
            let failed = cycle.is_none();
            judgement.cycles.push(cycle);
            if failed {
                return judgement;
            }
        }
        // A transition takes a dozen runs: only sets that meet all points are worth them.
        if judgement.excess() == 0.0 {
            for transition in &target.transition {
                let seen = transition.seen(&trial);
                judgement.misfits.push((transition.misfit(&seen), 1.0));
                judgement.transitions.push(seen);
            }
        } else if !target.transition.is_empty() {
            judgement.misfits.push((UNTRIED, 1.0));
        }
        judgement
    }

    fn add(&mut self, point: &Point, cycle: &Cycle, smallest_margin: f64) {
        let mut goal = |goal: Option<Goal>, ours: Option<f64>| {
            if let Some(goal) = goal {
                let misfit = ours
                    .map(|ours| (ours / goal.value - 1.0) / goal.bar)
                    .filter(|misfit| misfit.is_finite())
                    .unwrap_or(FAILED);
                self.misfits.push((misfit, goal.weight));
            }
        };
        goal(point.frequency_hz, cycle.frequency);
        goal(point.half_amplitude, Some(cycle.half_amplitude()));
        goal(point.minimum_velocity, Some(cycle.minimum));
        goal(point.maximum_velocity, Some(cycle.maximum));
        if let Some(sticking) = point.sticking {
            // Continuous, so that the search is led: how far from standing still, how long it stands.
            let misfit = match (sticking, cycle.sticks_and_slips()) {
                (true, true) | (false, false) => 0.0,
                (true, false) => 1.5 + 5.0 * cycle.minimum.abs() / (1.0 + cycle.maximum.abs()),
                (false, true) => 1.5 + 10.0 * cycle.stick_fraction,
            };
            self.misfits.push((misfit, 1.0));
        }
        if cycle.loop_margin < smallest_margin {
            self.misfits
                .push((1.5 + 10.0 * (smallest_margin - cycle.loop_margin), 1.0));
        }
    }

    /// Sum of squares of what exceeds the bars: 0 if all facts are met.
    #[must_use]
    pub fn excess(&self) -> f64 {
        self.misfits
            .iter()
            .map(|(misfit, _)| (misfit.abs() - 1.0).max(0.0).powi(2))
            .sum()
    }

    /// Weighted sum of squares of all distances, with what exceeds the bars counted again a hundredfold.
    #[must_use]
    pub fn distance(&self) -> f64 {
        let squares: f64 = self
            .misfits
            .iter()
            .map(|(misfit, weight)| weight * misfit * misfit)
            .sum();
        squares + 100.0 * self.excess()
    }

    /// Smallest loop margin over the points.
    #[must_use]
    pub fn loop_margin(&self) -> f64 {
        self.cycles
            .iter()
            .flatten()
            .map(|cycle| cycle.loop_margin)
            .fold(f64::INFINITY, f64::min)
    }
}
