//! Where stick-slip begins or ends along a control parameter, as a bifurcation diagram shows it.

use serde::{Deserialize, Serialize};
use stickslip::plant::Rig;

use super::cycle::{Cycle, Operating};

/// Runs along the control parameter.
const STEPS: usize = 8;
/// Halvings of the step in which the change lies.
const HALVINGS: usize = 4;
/// Misfit [bars] of a transition that is not there at all.
const ABSENT: f64 = 6.0;

/// The control parameter along which is looked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Control {
    /// ω_ref [rpm].
    SpeedRpm,
    /// N2 [N].
    NormalForce,
}

/// The side of the transition on which the disc sticks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// It sticks at smaller values.
    Below,
    /// It sticks at larger values.
    Above,
}

/// A statement about where stick-slip begins or ends.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Transition {
    /// The control parameter that is varied.
    pub over: Control,
    /// Its range; outside nothing is stated.
    pub range: [f64; 2],
    /// The other control parameter, held.
    pub held: f64,
    /// Where the disc sticks.
    pub sticks: Side,
    /// Between which values the change must lie.
    pub between: [f64; 2],
    /// On which side of the change the range of the velocity must grow with the control parameter, if that is known.
    pub grows: Option<Side>,
    /// Where the statement comes from.
    pub source: Option<String>,
}

/// What is seen of a transition.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Seen {
    /// Value at which the disc begins or ceases to stick; `None` where it does not, or does so more than once.
    pub at: Option<f64>,
    /// Runs that stick where they should not or the reverse, given the best single change; runs that stop count too.
    pub out_of_place: usize,
    /// Whether the range of the velocity grows on the side that is asked for; true where none is.
    pub grows: bool,
}

impl Transition {
    /// What makes no sense about the statement, if anything.
    ///
    /// # Errors
    /// A message that says what would be right.
    pub fn check(&self) -> Result<(), &'static str> {
        let [low, high] = self.range;
        let [least, most] = self.between;
        let finite = [low, high, least, most, self.held]
            .iter()
            .all(|value| value.is_finite());
        if !finite || low < 0.0 || self.held < 0.0 || low >= high {
            return Err(
                "range must be two finite values, the first at least 0 and below the second; held at least 0",
            );
        }
        if least >= most || least < low || most > high {
            return Err("between must be two values within range, the first below the second");
        }
        Ok(())
    }

    /// In words.
    #[must_use]
    pub fn label(&self) -> String {
        match self.over {
            Control::SpeedRpm => format!("transition over speed_rpm at {} N", self.held),
            Control::NormalForce => format!("transition over normal_force at {} rpm", self.held),
        }
    }

    fn operating(&self, value: f64) -> Operating {
        match self.over {
            Control::SpeedRpm => Operating::reduced(value, self.held),
            Control::NormalForce => Operating::reduced(self.held, value),
        }
    }

    /// Looks along the control parameter of `rig`.
    #[must_use]
    pub fn seen(&self, rig: &Rig<f64>) -> Seen {
        let [low, high] = self.range;
        let step = (high - low) / (STEPS - 1) as f64;
        let values: Vec<f64> = (0..STEPS).map(|k| low + k as f64 * step).collect();
        let cycles: Vec<Option<Cycle>> = values
            .iter()
            .map(|value| Cycle::of(rig, &self.operating(*value)).ok())
            .collect();
        // A disc that stands still throughout, as at no speed, is on neither side.
        let sticks: Vec<Option<bool>> = cycles
            .iter()
            .map(|cycle| {
                cycle
                    .filter(|cycle| cycle.stick_fraction < 1.0)
                    .map(|cycle| cycle.sticks_and_slips())
            })
            .collect();
        let failed = cycles.iter().filter(|cycle| cycle.is_none()).count();
        let (change, wrong) = best_change(&sticks, self.sticks);
        let at = (wrong == 0 && (1..STEPS).contains(&change)).then(|| {
            let (mut left, mut right) = (values[change - 1], values[change]);
            for _ in 0..HALVINGS {
                let middle = 0.5 * (left + right);
                let sticks_here = Cycle::of(rig, &self.operating(middle))
                    .is_ok_and(|cycle| cycle.sticks_and_slips());
                if sticks_here == (self.sticks == Side::Below) {
                    left = middle;
                } else {
                    right = middle;
                }
            }
            0.5 * (left + right)
        });
        let grows = self.grows.is_none_or(|side| {
            let part = match side {
                Side::Below => &cycles[..change],
                Side::Above => &cycles[change..],
            };
            let ranges: Vec<f64> = part
                .iter()
                .flatten()
                .map(|cycle| cycle.maximum - cycle.minimum)
                .collect();
            ranges.windows(2).all(|pair| pair[1] >= pair[0])
        });
        Seen {
            at,
            out_of_place: wrong + failed,
            grows,
        }
    }

    /// Distance of what is seen from the statement in bars, 0 if it holds.
    #[must_use]
    pub fn misfit(&self, seen: &Seen) -> f64 {
        let growth = if seen.grows { 0.0 } else { 0.5 };
        let place = match seen.at {
            Some(at) => {
                let [least, most] = self.between;
                let outside = (least - at).max(at - most).max(0.0);
                if outside == 0.0 {
                    0.0
                } else {
                    1.5 + 3.0 * outside / (self.range[1] - self.range[0])
                }
            }
            None => ABSENT * (1 + seen.out_of_place) as f64 / (STEPS + 1) as f64 + 1.0,
        };
        if place + growth == 0.0 {
            0.0
        } else {
            1.0 + place + growth
        }
    }
}

/// The number of runs before the change that leaves the fewest on the wrong side, and how many those are.
fn best_change(sticks: &[Option<bool>], side: Side) -> (usize, usize) {
    (0..=sticks.len())
        .map(|change| {
            let wrong = sticks
                .iter()
                .enumerate()
                .filter(|(k, sticks)| {
                    let expected = (*k < change) == (side == Side::Below);
                    sticks.is_some_and(|sticks| sticks != expected)
                })
                .count();
            (change, wrong)
        })
        .min_by_key(|(_, wrong)| *wrong)
        .unwrap_or((0, 0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_best_change_and_what_stands_against_it() {
        let seen = |text: &str| -> Vec<Option<bool>> {
            text.chars()
                .map(|c| match c {
                    's' => Some(true),
                    '-' => Some(false),
                    _ => None,
                })
                .collect()
        };
        assert_eq!(best_change(&seen("sss--"), Side::Below), (3, 0));
        assert_eq!(best_change(&seen("--sss"), Side::Above), (2, 0));
        assert_eq!(best_change(&seen("s-s--"), Side::Below).1, 1);
        assert_eq!(best_change(&seen("?ss--"), Side::Below), (3, 0));
        assert_eq!(best_change(&seen("-----"), Side::Below), (0, 0));
    }
}
