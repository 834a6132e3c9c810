//! An integral that stops while the limited output would not follow it (anti-windup), as modes.
//!
//! u is the output without limits, b a limit, and "push" the rate at which the inputs drive the integral
//! v against that limit. Within the limits v' = k·w. Beyond a limit the output is the limit, and v
//! - is *held* while it is pushed further out,
//! - *rides* where it would be pushed out but the rest of u retreats: v fills the difference, u = b,
//! - *unwinds*, v' = k·w, while it is driven back.

use super::gains::{Gains, INPUTS};
use super::signal::Signal;
use Mode::{Holding, Riding, Unwinding, Within};

/// Which limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The lowest voltage.
    Lower,
    /// The highest voltage.
    Upper,
}

impl Side {
    /// +1 at the upper limit, −1 at the lower.
    pub(super) fn sign(self) -> f64 {
        match self {
            Self::Lower => -1.0,
            Self::Upper => 1.0,
        }
    }
}

/// What output and integral do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// The output is between its limits.
    Within,
    /// The output is at a limit; the integral is held.
    Holding(Side),
    /// The output is at a limit; the integral follows so that it just reaches it.
    Riding(Side),
    /// The output is at a limit; the integral runs back.
    Unwinding(Side),
}

impl Mode {
    /// The limit at which the output is.
    pub fn limit(self) -> Option<Side> {
        match self {
            Within => None,
            Holding(side) | Riding(side) | Unwinding(side) => Some(side),
        }
    }
}

/// A share of the terms of a sum below which the sum is rounding.
const ROUNDING: f64 = 1e-13;

/// Inputs from an instant on, as polynomials.
pub(super) type Inputs = [[f64; 4]; INPUTS];

/// All signals of a controller from an instant on, as long as its mode lasts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Signals {
    pub(super) mode: Mode,
    limits: [f64; 2],
    /// Voltage [V] and rate [V/s] below which differences of them are rounding.
    floors: [f64; 2],
    /// The output without limits and without the integral.
    rest: Signal,
    /// k·w.
    drive: Signal,
    /// v if it runs.
    running: Signal,
    /// v at the start.
    initial: f64,
    /// y.
    pub(super) filtered: Signal,
}

impl Signals {
    /// The signals from an instant at which the integral is `integral` [V] and the filtered torque
    /// `filtered_torque` [N m]; the mode is the one that these want, or `mode` where an event has
    /// already decided it.
    pub(super) fn new(
        gains: &Gains<f64>,
        inputs: &Inputs,
        integral: f64,
        filtered_torque: f64,
        mode: Option<Mode>,
    ) -> Self {
        let rate = gains.filter_time.map_or(0.0, |time| 1.0 / time);
        let weighted = |weights: &[f64; INPUTS]| {
            let mut sum = Signal::polynomial(&[], rate);
            for (weight, input) in weights.iter().zip(inputs) {
                sum = sum.plus(&Signal::polynomial(input, rate).times(*weight));
            }
            sum
        };
        let filtered = follow(
            &weighted(&gains.filtered),
            filtered_torque,
            gains.filter_time,
        );
        let drive = weighted(&gains.integral);
        let rest = weighted(&gains.direct).plus(&filtered.times(gains.through_filter));
        let mut signals = Self {
            mode: Within,
            limits: gains.limits,
            floors: floors(gains, inputs, &rest, integral),
            rest,
            drive,
            running: drive.integral_of_polynomial().plus_constant(integral),
            initial: integral,
            filtered,
        };
        signals.mode = mode.unwrap_or_else(|| signals.wanted_mode());
        signals
    }

    fn bound(&self, side: Side) -> f64 {
        match side {
            Side::Lower => self.limits[0],
            Side::Upper => self.limits[1],
        }
    }

    /// v as long as the mode lasts.
    pub(super) fn integral(&self) -> Signal {
        match self.mode {
            Within | Unwinding(_) => self.running,
            Holding(_) => Signal::polynomial(&[self.initial], self.rest.rate),
            Riding(side) => self.rest.times(-1.0).plus_constant(self.bound(side)),
        }
    }

    /// u within its limits, as long as the mode lasts.
    pub(super) fn output(&self) -> Signal {
        match self.mode.limit() {
            None => self.rest.plus(&self.running),
            Some(side) => Signal::polynomial(&[self.bound(side)], self.rest.rate),
        }
    }

    /// How far u is within `side`'s limit if the integral is `integral`; negative beyond it.
    fn room(&self, side: Side, integral: &Signal) -> Signal {
        self.rest
            .plus(integral)
            .plus_constant(-self.bound(side))
            .times(-side.sign())
    }

    /// How fast the inputs drive the integral out.
    fn push(&self, side: Side) -> Signal {
        self.drive.times(side.sign())
    }

    /// How fast the rest of u retreats from the limit.
    fn retreat(&self, side: Side) -> Signal {
        self.rest.derivative().times(-side.sign())
    }

    /// How fast u would leave the limit inward if the integral ran.
    fn relief(&self, side: Side) -> Signal {
        self.retreat(side).plus(&self.push(side).times(-1.0))
    }

    /// The mode that values and tendencies at the start ask for.
    fn wanted_mode(&self) -> Mode {
        for side in [Side::Upper, Side::Lower] {
            if self.room(side, &self.running).starting_sign(self.floors[0]) < 0.0 {
                return self.beyond(side);
            }
        }
        Within
    }

    /// The mode at or beyond a limit that the output would pass if the integral ran.
    fn beyond(&self, side: Side) -> Mode {
        if self.push(side).starting_sign(self.floors[1]) <= 0.0 {
            return Unwinding(side);
        }
        let held = Signal::polynomial(&[self.initial], self.rest.rate);
        let at_the_limit = self.room(side, &held).value(0.0) >= -10.0 * self.floors[0];
        if at_the_limit && self.retreat(side).starting_sign(self.floors[1]) > 0.0 {
            Riding(side)
        } else {
            Holding(side)
        }
    }

    /// What ends the mode: signals that stay at or above zero while it lasts, the size below which each is
    /// rounding, and what follows.
    fn guards(&self) -> [(Signal, f64, Next); 2] {
        let [voltage, rate] = self.floors;
        let beyond = |side| self.room(side, &self.integral()).times(-1.0);
        match self.mode {
            Within => [Side::Upper, Side::Lower]
                .map(|side| (self.room(side, &self.running), voltage, Next::Beyond(side))),
            Holding(side) => [
                (beyond(side), voltage, Next::Return(side)),
                (self.push(side), rate, Next::Mode(Unwinding(side))),
            ],
            Riding(side) => [
                (self.retreat(side), rate, Next::Mode(Holding(side))),
                (self.relief(side).times(-1.0), rate, Next::Mode(Within)),
            ],
            Unwinding(side) => [
                (beyond(side), voltage, Next::Mode(Within)),
                (self.push(side).times(-1.0), rate, Next::Mode(Holding(side))),
            ],
        }
    }

    /// The first event in search window number `number`: local time [s] and what follows.
    pub(super) fn event_in_window(&self, number: u32) -> Option<(f64, Next)> {
        let mut first: Option<(f64, Next)> = None;
        for (guard, floor, next) in self.guards() {
            if let Some(tau) = guard.loss_in_window(number, floor)
                && first.is_none_or(|(earlier, _)| tau < earlier)
            {
                first = Some((tau, next));
            }
        }
        first
    }

    /// The mode after an event, of signals that start at it.
    pub(super) fn after(&self, next: Next) -> Mode {
        match next {
            Next::Mode(mode) => mode,
            Next::Beyond(side) => self.beyond(side),
            // At the limit with the integral held: it runs again if u would then retreat too.
            Next::Return(side) if self.relief(side).starting_sign(self.floors[1]) > 0.0 => Within,
            Next::Return(side) => Riding(side),
        }
    }
}

/// Sizes below which a voltage [V] and a rate [V/s] are rounding: a share of the terms that they are sums of.
fn floors(gains: &Gains<f64>, inputs: &Inputs, rest: &Signal, integral: f64) -> [f64; 2] {
    let (mut voltage, mut rate) = (integral.abs() + rest.amplitude.abs(), 0.0);
    voltage += gains.limits[0].abs().max(gains.limits[1].abs());
    for (place, input) in inputs.iter().enumerate() {
        voltage += (gains.direct[place] * input[0]).abs();
        rate += (gains.integral[place] * input[0]).abs() + (gains.direct[place] * input[1]).abs();
    }
    voltage += rest.polynomial[0].abs();
    rate += rest.polynomial[1].abs() + (rest.rate * rest.amplitude).abs();
    [ROUNDING * voltage, ROUNDING * rate]
}

/// What follows an event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Next {
    /// This mode.
    Mode(Mode),
    /// The output reaches a limit.
    Beyond(Side),
    /// The output comes back to a limit while its integral is held.
    Return(Side),
}

/// Solution of T y' = f − y from `start` on; `f` itself without a filter.
fn follow(f: &Signal, start: f64, filter_time: Option<f64>) -> Signal {
    let Some(time) = filter_time else {
        return Signal::polynomial(&[start], 0.0);
    };
    // f − T f' + T² f'' − T³ f''', exact for a cubic.
    let mut particular = *f;
    let mut derivative = *f;
    for _ in 0..3 {
        derivative = derivative.derivative().times(-time);
        particular = particular.plus(&derivative);
    }
    let amplitude = start - particular.polynomial[0];
    Signal {
        amplitude,
        ..particular
    }
}

/// The instant's inputs.
pub(super) fn at_start(inputs: &Inputs) -> [f64; INPUTS] {
    inputs.map(|polynomial| polynomial[0])
}
