//! The next segment of a run: its series, how far they hold, and the switch that ends it.

use super::piece::End;
use super::step_size::from_last_terms;
use super::{Fold, HybridSystem, IntegrationError, Simulation};
use crate::series::{Scalar, evaluate, evaluate_derivative, first_loss_of_sign, lower_bound};

/// Relative size below which a leading coefficient of the guard that was just crossed is rounding.
const ROUNDING: f64 = 1e-11;
/// The same for a negative coefficient: what a switch leaves behind is a small difference of large
/// terms, such as the torque of a shaft whose two angles have grown for minutes. Taken at its word it
/// would undo the switch, and the next rounding would do it again.
const NEGATIVE_ROUNDING: f64 = 1e-8;

/// Depth, in tolerances, to which a guard has to dip below zero to have been crossed and not just
/// touched: whether such a switch happens is beyond the accuracy of the run.
const GRAZING: f64 = 10.0;

/// Share of the tolerance for segments without fast transients: they are as long as it allows, where
/// the others are kept short, and so more accurate, by the fast modes.
pub(crate) const SETTLED_SHARE: f64 = 0.01;

impl<S: Scalar, P: HybridSystem<S>> Simulation<S, P> {
    /// Computes the segment that starts at `start` and finds its end.
    pub(super) fn expand(&mut self) -> Result<(), IntegrationError> {
        let order = self.options.order;
        let settled = !self.departing
            && self.system.expand_without_transients(
                &self.mode,
                self.start,
                &self.state,
                &self.inputs,
                order,
                self.options.tolerance,
                &mut self.jet,
            );
        if !settled {
            self.system.expand(
                &self.mode,
                self.start,
                &self.state,
                &self.inputs,
                order,
                &mut self.jet,
            );
        }
        self.statistics.segments += 1;
        let mut step = self.step_length(if settled { SETTLED_SHARE } else { 1.0 });
        if step.is_nan() {
            return Err(self.overflow());
        }
        let held = self.system.reach(&self.jet);
        // At a fold the derivatives are found without their series, but only from series that have the fast modes.
        let asked = if settled { step.min(held) } else { step };
        let fold = match self.system.fold(&self.mode, &self.jet, asked) {
            Fold::At(instant) => {
                step = instant.value();
                Some(instant)
            }
            Fold::Beyond(short) => {
                step = short.min(held);
                None
            }
        };
        let reach = step;
        let mut lost = None;
        for (position, guard) in self.system.guards(&self.jet).iter().enumerate() {
            if lower_bound(&guard.series[..=order], step) > 0.0 && !self.departing {
                continue;
            }
            let series = &guard.series[..=order];
            // Bounds that are not finite would exclude nothing, and the search would never end.
            if !evaluate(&guard.series.map(f64::abs)[..=order], reach).is_finite() {
                return Err(self.overflow());
            }
            // Of guards that are lost together the first counts: the next segment looks at the others.
            if let Some(tau) = loss(series, reach, step, self.departing)
                && (tau < step || lost.is_none())
            {
                step = tau;
                lost = Some(position);
            }
        }
        let mut fold = fold.filter(|_| lost.is_none());
        if lost.is_some() && step > held {
            // A switch before a fold needs the derivatives between the segment's start and the fold.
            (step, lost, fold) = (held, None, None);
        }
        let floor = 4.0 * f64::EPSILON * self.start.value().abs().max(1e-3);
        if step < floor && lost.is_none() && fold.is_none() {
            return Err(IntegrationError::StepTooSmall {
                time: self.start.value(),
                step,
                mode: self.system.describe(&self.mode),
            });
        }
        (self.length, self.end) = match fold {
            Some(instant) => (instant, End::Fold),
            None => (S::constant(step), End::Step),
        };
        if let Some(position) = lost {
            let guard = &self.system.guards(&self.jet)[position];
            let kind = guard.kind;
            self.end = End::Switch(kind);
            let series = &guard.series[..=order];
            if step == 0.0 && series[0] < -NEGATIVE_ROUNDING * size(series, reach) {
                // It was lost before the segment began, by new inputs or the switch before: at that instant.
                return Ok(());
            }
            let slope = evaluate_derivative(series, step);
            let start = series[0].abs().max(1e-3);
            let bend = second_derivative(series, step).max(0.0);
            // It dips below zero by slope²/(2 bend) before it rises again.
            let depth = GRAZING * self.options.tolerance * (1.0 + series[0].abs());
            if slope * slope > 2.0 * bend * depth && slope.abs() > 1e-9 * start {
                self.move_switch(kind, step, slope);
            } else if !(self.departing && step == 0.0) {
                // Right behind a switch a guard may leave zero without slope: its instant is that switch's.
                self.statistics.grazing += 1;
            }
        }
        Ok(())
    }

    /// Lets the instant of the switch at local time `tau` depend on whatever its guard, which falls with
    /// `slope`, depends on.
    fn move_switch(&mut self, guard: P::GuardKind, tau: f64, slope: f64) {
        let state = self.state_after(S::constant(tau));
        let Some(spare) = &mut self.spare else {
            return;
        };
        let value = self.system.guard_at(
            &self.mode,
            guard,
            &self.jet,
            tau,
            self.start + tau,
            &state,
            &self.inputs,
            spare,
        );
        self.length = S::constant(tau) - (value - value.value()) * (1.0 / slope);
    }

    /// Coefficients overflow where a time constant is extremely short or an input absurdly large.
    #[cold]
    fn overflow(&self) -> IntegrationError {
        let (time, mode) = (self.start.value(), self.system.describe(&self.mode));
        if self.state.as_ref().iter().all(|x| x.value().is_finite()) {
            IntegrationError::StepTooSmall {
                time,
                step: 0.0,
                mode,
            }
        } else {
            IntegrationError::NotFinite { time, mode }
        }
    }

    fn step_length(&self, share: f64) -> f64 {
        let order = self.options.order;
        let (mut last, mut before) = (0.0_f64, 0.0_f64);
        for (index, series) in self.system.states(&self.jet).iter().enumerate() {
            let size = if self.system.is_coordinate(index) {
                1.0
            } else {
                1.0 + series[0].value().abs()
            };
            last = larger(last, series[order].value().abs() / size);
            before = larger(before, series[order - 1].value().abs() / size);
        }
        if last.is_nan() || before.is_nan() {
            return f64::NAN;
        }
        let tolerance = share * self.options.tolerance;
        from_last_terms(last / tolerance, before / tolerance, order).min(self.options.longest_step)
    }
}

/// Second derivative of the polynomial with these coefficients at `tau`.
fn second_derivative(coefficients: &[f64], tau: f64) -> f64 {
    let mut sum = 0.0;
    for (k, c) in coefficients.iter().enumerate().skip(2).rev() {
        sum = sum * tau + c * (k * (k - 1)) as f64;
    }
    sum
}

/// The larger of two numbers; not a number if either is not.
#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() {
        f64::NAN
    } else {
        a.max(b)
    }
}

/// Σ |c| `reach`^k: what a guard is large or small against.
fn size(series: &[f64], reach: f64) -> f64 {
    let mut size = 0.0;
    let mut power = 1.0;
    for c in series {
        size += c.abs() * power;
        power *= reach;
    }
    size
}

/// Local time within `width` at which a guard is lost. Right behind a switch (`departing`) a guard may
/// start at zero: leading coefficients that are only rounding over the length `reach`, on which the
/// series is good, are divided out. A guard that is lost by more than that is lost at once.
fn loss(series: &[f64], reach: f64, width: f64, departing: bool) -> Option<f64> {
    let mut series = series;
    if departing || series[0] == 0.0 {
        let size = size(series, reach);
        let mut power = 1.0;
        let is_rounding = |c: f64, power: f64| {
            let limit = if c < 0.0 && departing {
                NEGATIVE_ROUNDING
            } else {
                ROUNDING
            };
            c.abs() * power <= limit * size
        };
        while series.len() > 1 && is_rounding(series[0], power) {
            series = &series[1..];
            power *= reach;
        }
        if series.len() == 1 && series[0] == 0.0 {
            return None;
        }
    }
    first_loss_of_sign(series, width)
}
