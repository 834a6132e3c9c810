//! A controller at one instant, of which only the values of its inputs are known: for solvers that bring their own steps.
//!
//! The modes are those of [`Mode`]. While the integral rides on a limit it fills what the rest of the output leaves, and follows
//! that rest's rate. Of a filtered torque the rate is known, and riding is exact. Of inputs with a direct gain it is not: there the
//! integral runs and is held by turns, in a band about the limit.

use super::gains::{Gains, INPUTS};
use super::limited::Mode::{Holding, Riding, Unwinding, Within};
use super::limited::{Mode, Side, Signals};
use crate::series::Scalar;

/// Number of indicators that exist in memory.
pub const MOST_INDICATORS: usize = 4;

/// What each of them tells; the last is of laws with a filter.
const INDICATORS: [&str; MOST_INDICATORS] = [
    "the voltage reaches or leaves its lower limit",
    "the voltage reaches or leaves its upper limit",
    "the inputs drive the integral the other way",
    "the filtered torque turns while the integral rides on a limit",
];

/// A guard is lost this far beyond zero, in ranges of the voltage: right behind a switch it is zero.
const LOST: f64 = 1e-10;
/// How far the output without limits may be from the limit on which the integral rides, in ranges of the voltage.
const BAND: f64 = 1e-4;

/// All that a controller computes at an instant.
#[derive(Clone, Copy, Debug)]
pub struct Instant<S> {
    limits: [S; 2],
    has_filter: bool,
    /// The output without its limits [V].
    unlimited: S,
    integral: S,
    filtered_torque: S,
    /// Rate at which the inputs drive the integral [V/s].
    drive: S,
    filtered_rate: S,
    /// Rate of the output without its integral [V/s], as far as it is known.
    rest_rate: S,
}

impl<S: Scalar> Instant<S> {
    /// What the law of these `gains` computes from inputs, integral [V] and filtered torque [N m].
    pub fn new(gains: &Gains<S>, inputs: [S; INPUTS], integral: S, filtered_torque: S) -> Self {
        let weighted = |weights: [S; INPUTS]| {
            let terms = weights.into_iter().zip(inputs);
            terms.fold(S::ZERO, |sum, (weight, input)| sum + weight * input)
        };
        let filtered_rate = match gains.filter_time {
            Some(time) => (weighted(gains.filtered) - filtered_torque) / time,
            None => S::ZERO,
        };
        Self {
            limits: gains.limits,
            has_filter: gains.filter_time.is_some(),
            unlimited: gains.unlimited(inputs, integral, filtered_torque),
            integral,
            filtered_torque,
            drive: weighted(gains.integral),
            filtered_rate,
            rest_rate: gains.through_filter * filtered_rate,
        }
    }

    /// The integral [V] and the filtered torque [N m].
    pub fn states(&self) -> [S; 2] {
        [self.integral, self.filtered_torque]
    }

    /// Voltage [V] within its limits.
    pub fn voltage(&self, mode: Mode) -> S {
        mode.limit()
            .map_or(self.unlimited, |side| self.limits[side as usize])
    }

    /// Time derivatives of the integral [V/s] and of the filtered torque [N m/s].
    pub fn rates(&self, mode: Mode) -> [S; 2] {
        let integral = match mode {
            Holding(_) => S::ZERO,
            Riding(_) if self.has_filter => -self.rest_rate,
            Within | Riding(_) | Unwinding(_) => self.drive,
        };
        [integral, self.filtered_rate]
    }

    /// A difference of voltages, or a rate times 1 s, in ranges of the voltage.
    fn share(&self, voltage: S) -> S {
        voltage / (self.limits[1] - self.limits[0])
    }

    /// How far the output without limits is within `side`'s limit [V].
    fn room(&self, side: Side) -> S {
        (self.limits[side as usize] - self.unlimited) * side.sign()
    }

    /// How fast the inputs drive the integral out [V/s].
    fn push(&self, side: Side) -> S {
        self.drive * side.sign()
    }

    /// How fast the rest of the output retreats from the limit [V/s], as far as it is known.
    fn retreat(&self, side: Side) -> S {
        -(self.rest_rate * side.sign())
    }

    /// The event indicators, of which those with a [description](Gains::indicator_descriptions) count: positive as long as `mode` is the
    /// right one.
    pub fn indicators(&self, mode: Mode) -> [S; MOST_INDICATORS] {
        let mut values = [S::constant(1.0); MOST_INDICATORS];
        for side in [Side::Lower, Side::Upper] {
            let room = self.share(self.room(side));
            let distance = if room.value() < 0.0 { -room } else { room };
            values[side as usize] = match mode.limit() {
                Some(at) if at != side => continue,
                None => room + LOST,
                Some(_) if matches!(mode, Riding(_)) => -distance + BAND,
                Some(_) => -room + LOST,
            };
        }
        match mode {
            Holding(side) => values[2] = self.share(self.push(side)) + LOST,
            Unwinding(side) => values[2] = -self.share(self.push(side)) + LOST,
            Riding(side) if self.has_filter => {
                values[2] = self.share(self.push(side) - self.retreat(side)) + LOST;
                values[3] = self.share(self.retreat(side)) + LOST;
            }
            Within | Riding(_) => {}
        }
        values
    }
}

impl<S: Scalar> Gains<S> {
    /// What each event indicator tells.
    pub fn indicator_descriptions(&self) -> impl Iterator<Item = &'static str> {
        let count = MOST_INDICATORS - usize::from(self.filter_time.is_none());
        INDICATORS.into_iter().take(count)
    }
}

impl Instant<f64> {
    /// The mode that values and tendencies ask for where nothing is known of what was before, the inputs taken as held.
    pub fn wanted_mode(
        gains: &Gains<f64>,
        inputs: [f64; INPUTS],
        integral: f64,
        filtered_torque: f64,
    ) -> Mode {
        let held = inputs.map(|value| [value, 0.0, 0.0, 0.0]);
        Signals::new(gains, &held, integral, filtered_torque, None).mode
    }

    /// The mode that follows `mode`, itself if no indicator is lost, and the integral [V] in it.
    pub fn next(&self, mode: Mode) -> (Mode, f64) {
        let [lower, upper, push, retreat] = self.indicators(mode).map(|indicator| indicator <= 0.0);
        let reaches = |side| match side {
            Side::Lower => lower,
            Side::Upper => upper,
        };
        let next = match mode {
            Within if upper => self.beyond(Side::Upper),
            Within if lower => self.beyond(Side::Lower),
            Holding(side) if reaches(side) && self.retreat(side) > self.push(side) => Within,
            Holding(side) if reaches(side) => Riding(side),
            Riding(side) if reaches(side) && self.room(side) > 0.0 => Within,
            Riding(side) if reaches(side) || retreat => Holding(side),
            Unwinding(side) if reaches(side) => Within,
            Holding(side) if push => Unwinding(side),
            Unwinding(side) if push => Holding(side),
            Riding(_) if push => Within,
            same => same,
        };
        let integral = match (mode, next) {
            // What it is while it rides, exactly.
            (Riding(side), other) | (other, Riding(side))
                if other != Riding(side) && self.has_filter =>
            {
                self.integral + self.room(side) * side.sign()
            }
            _ => self.integral,
        };
        (next, integral)
    }

    /// The mode beyond a limit that the output has just passed while its integral ran.
    fn beyond(&self, side: Side) -> Mode {
        if self.push(side) <= 0.0 {
            Unwinding(side)
        } else if self.retreat(side) > 0.0 {
            Riding(side)
        } else {
            Holding(side)
        }
    }
}
