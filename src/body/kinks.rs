//! Kinks of a body's equations: when they are passed, and how far a series tells that.

use super::Body;
use super::coordinate::TIME;
use super::motion::{BodyJet, Branches, GuardKind, effects, side};
use crate::friction::Direction;
use crate::integrator::{Guard, Options};
use crate::series::{Series, TERMS};

/// Halvings after which a series counts as one that overflows.
const HALVINGS: u32 = 200;

/// Length [s] on which the last terms of a series are small beside the others.
pub(super) fn trusted(series: &Series<f64>) -> f64 {
    let mut length = Options::default().longest_step;
    for _ in 0..HALVINGS {
        let (mut power, mut size, mut last) = (1.0, 0.0, [0.0; 2]);
        for c in &series[..=Options::default().order] {
            size += c.abs() * power;
            last = [last[1], c.abs() * power];
            power *= length;
        }
        if last[0] + last[1] <= Options::DEFAULT_TOLERANCE * size {
            return length;
        }
        length *= 0.5;
    }
    0.0
}

impl Body<f64> {
    /// Appends the guards of all kinks of one direction's equations.
    pub(super) fn watch(
        &self,
        direction: Direction,
        branches: &Branches,
        order: usize,
        jet: &mut BodyJet<f64>,
    ) {
        let BodyJet {
            sides,
            guards,
            reach,
            ..
        } = jet;
        let mut first = 0;
        for ((_, effect), work) in effects(self).zip(&sides[side(direction)]) {
            let program = &effect.program;
            for site in 0..program.sites().len() {
                let branch = branches[first + site];
                for upwards in [false, true] {
                    if program.has_end(site, upwards, branch) {
                        let mut series = [0.0; TERMS];
                        for (k, c) in series[..=order].iter_mut().enumerate() {
                            *c = program.watched(site, upwards, branch, work, k);
                        }
                        // What depends on the state alone is as accurate as that.
                        if program.uses(TIME) {
                            *reach = reach.min(trusted(&series));
                        }
                        let kind = GuardKind::Kink(direction, first + site, upwards);
                        guards.push(Guard { kind, series });
                    }
                }
            }
            first += program.sites().len();
        }
    }

    /// The branch beyond the end of that of the kink at `place`.
    pub(super) fn next_branch(&self, place: usize, upwards: bool, branch: i32) -> i32 {
        let mut first = 0;
        for (_, effect) in effects(self) {
            let count = effect.program.sites().len();
            if place < first + count {
                let site = place - first;
                return effect.program.next_branch(site, upwards, branch, branch);
            }
            first += count;
        }
        branch
    }
}
