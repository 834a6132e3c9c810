//! Watches a run as it goes by, on the polynomials of its segments.

use std::collections::VecDeque;

use stickslip::integrator::HybridSystem;
use stickslip::integrator::Simulation;
use stickslip::plant::{Contact, Rig, index};
use stickslip::series::{evaluate, evaluate_derivative};

use super::point::Point;
use crate::analysis::motion::{Evidence, thirds};

/// Parts into which a segment is cut to look for extrema and crossings. A segment of high order is far shorter than the
/// period of what it describes.
const PARTS: usize = 4;
/// Share of the range by which a velocity must have been below the middle before crossing it counts.
const HYSTERESIS: f64 = 0.1;
/// Change of a velocity over a part, relative to one more than its size, below which its slope is rounding.
const FLAT: f64 = 1e-11;
/// Range of a velocity [rad/s] below which it has no cycle.
const SMALLEST_RANGE: f64 = 1e-6;

/// What was seen so far of disc D2.
#[derive(Debug, Clone)]
pub struct Watch {
    early_start: f64,
    late_start: f64,
    end: f64,
    evidence: Evidence,
    /// Time stuck in the late part so far [s].
    resting: f64,
    /// Whether the velocity has been low enough for the next crossing to count.
    armed: bool,
    /// Whether the velocity rose when it last changed.
    rising: Option<bool>,
    crossings: u64,
    /// Time of the first and last crossing with the time stuck until then [s].
    first: (f64, f64),
    last: (f64, f64),
    most_extrema: usize,
    extrema: VecDeque<f64>,
}

/// Where a piece of a run lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Part {
    Early,
    Late,
}

impl Watch {
    /// For a run from 0 to `end` [s], of whose local extrema the last `most_extrema` are to be kept.
    #[must_use]
    pub fn new(end: f64, most_extrema: usize) -> Self {
        let (early_start, late_start) = thirds(0.0, end);
        Self {
            early_start,
            late_start,
            end,
            evidence: Evidence::default(),
            resting: 0.0,
            armed: false,
            rising: None,
            crossings: 0,
            first: (0.0, 0.0),
            last: (0.0, 0.0),
            most_extrema,
            extrema: VecDeque::new(),
        }
    }

    /// Looks at the run's present segment, whose polynomials have the given order.
    pub fn see(&mut self, run: &Simulation<f64, Rig<f64>>, order: usize) {
        let (start, end) = (run.segment_start(), run.segment_end());
        if end <= start {
            return;
        }
        let velocity = &run.system().states(run.jet())[index::OMEGA][..=order];
        let stuck = run.mode().contact(Contact::Disc).is_stuck();
        self.evidence.has_moved |= !stuck;
        let windows = [
            (Part::Early, self.early_start, self.late_start),
            (Part::Late, self.late_start, self.end),
        ];
        for (part, from, to) in windows {
            let (from, to) = (from.max(start), to.min(end));
            if from < to {
                if stuck {
                    self.see_rest(part, from, to);
                } else {
                    self.see_sliding(part, velocity, start, from, to);
                }
            }
        }
    }

    fn see_rest(&mut self, part: Part, from: f64, to: f64) {
        match part {
            Part::Early => self.evidence.early.see(0.0),
            Part::Late => {
                self.evidence.late.see(0.0);
                self.resting += to - from;
                self.armed |= 0.0 < self.low();
            }
        }
    }

    fn see_sliding(&mut self, part: Part, velocity: &[f64], start: f64, from: f64, to: f64) {
        let value = |time: f64| evaluate(velocity, time - start);
        let slope = |time: f64| evaluate_derivative(velocity, time - start);
        let (middle, low) = (self.middle(), self.low());
        let mut before = (from, value(from), slope(from));
        self.see_value(part, before.1);
        for step in 0..=PARTS {
            let time = from + (to - from) * step as f64 / PARTS as f64;
            let after = (time, value(time), slope(time));
            let flat = FLAT * (1.0 + after.1.abs()) * PARTS as f64 / (to - from);
            if after.2.abs() > flat {
                let rises = after.2 > 0.0;
                if self.rising == Some(!rises) {
                    // Segments may end at an extremum, where the slope is rounding or jumps.
                    let within = step > 0 && before.2.abs() > flat && (before.2 > 0.0) != rises;
                    let extremum = if within {
                        value(root(slope, before.0, after.0))
                    } else {
                        before.1
                    };
                    self.see_extremum(part, extremum);
                }
                self.rising = Some(rises);
            }
            self.see_value(part, after.1);
            if part == Part::Late {
                self.armed |= before.1 < low;
                if self.armed && before.1 < middle && after.1 >= middle {
                    self.cross(root(|time| value(time) - middle, before.0, after.0));
                }
            }
            before = after;
        }
    }

    fn see_extremum(&mut self, part: Part, value: f64) {
        self.see_value(part, value);
        if part == Part::Late {
            self.keep_extremum(value);
        }
    }

    fn see_value(&mut self, part: Part, value: f64) {
        match part {
            Part::Early => self.evidence.early.see(value),
            Part::Late => self.evidence.late.see(value),
        }
    }

    fn keep_extremum(&mut self, value: f64) {
        if self.extrema.len() == self.most_extrema {
            self.extrema.pop_front();
        }
        if self.most_extrema > 0 {
            self.extrema.push_back(value);
        }
    }

    fn cross(&mut self, time: f64) {
        self.armed = false;
        self.crossings += 1;
        self.last = (time, self.resting);
        if self.crossings == 1 {
            self.first = self.last;
        }
    }

    /// Middle of the velocities of the early part.
    fn middle(&self) -> f64 {
        0.5 * (self.evidence.early.minimum + self.evidence.early.maximum)
    }

    /// Velocity below which a crossing of the middle is prepared.
    fn low(&self) -> f64 {
        self.middle() - 2.0 * HYSTERESIS * self.evidence.early.half()
    }

    /// What the run came to, after `switches` mode changes.
    #[must_use]
    pub fn point(mut self, switches: u64) -> Point {
        let cycles = self.crossings.saturating_sub(1) as f64;
        let time = self.last.0 - self.first.0;
        let cyclic = self.crossings >= 3 && self.evidence.late.half() > 0.5 * SMALLEST_RANGE;
        self.evidence.stick_fraction = if cyclic && self.resting > 0.0 {
            (self.last.1 - self.first.1) / time
        } else {
            self.resting / (self.end - self.late_start)
        };
        if self.resting >= (self.end - self.late_start) * (1.0 - 1e-12) {
            self.evidence.stick_fraction = 1.0;
        }
        Point {
            motion: Some(self.evidence.judge()),
            minimum: self.evidence.late.minimum,
            maximum: self.evidence.late.maximum,
            frequency: if cyclic { cycles / time } else { f64::NAN },
            stick_fraction: self.evidence.stick_fraction,
            switches,
            extrema: self.extrema.into(),
        }
    }
}

/// Zero of a continuous function that changes its sign between `low` and `high`, by false position with the Illinois rule.
fn root(function: impl Fn(f64) -> f64, low: f64, high: f64) -> f64 {
    let (mut a, mut b) = ((low, function(low)), (high, function(high)));
    for _ in 0..12 {
        if a.1 == b.1 {
            break;
        }
        let middle = (a.0 * b.1 - b.0 * a.1) / (b.1 - a.1);
        let value = function(middle);
        if (value > 0.0) == (b.1 > 0.0) {
            a.1 *= 0.5;
        } else {
            a = b;
        }
        b = (middle, value);
        if value == 0.0 || (a.0 - b.0).abs() < 1e-12 {
            break;
        }
    }
    b.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_are_found() {
        assert!((root(|x| x * x - 2.0, 0.0, 2.0) - 2.0_f64.sqrt()).abs() < 1e-10);
        assert!((root(|x| (x - 0.3).powi(3), 0.0, 1.0) - 0.3).abs() < 2e-2);
    }
}
