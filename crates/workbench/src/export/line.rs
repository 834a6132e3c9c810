//! The line that comes closest to a law over a range of speeds.

use std::str::FromStr;

use thiserror::Error;

/// Evenly spaced speeds at which a law is read, and as many in even ratios.
const SPEEDS: usize = 2000;
/// Lowest of the speeds in even ratios, over the highest.
const LOWEST: f64 = 1e-9;
/// Steps of the search for the slope: each takes a third of the interval away.
const STEPS: usize = 200;
/// Digits of the numbers that are written.
const DIGITS: usize = 6;

/// A range of speeds [rad/s or m/s], the same in both directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Speeds {
    /// The lowest, 0 or more.
    pub low: f64,
    /// The highest, above the lowest.
    pub high: f64,
}

/// What is wrong with a range of speeds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum SpeedsError {
    /// Not two numbers with a colon between them.
    #[error("write LOW:HIGH in rad/s or m/s, such as 0.05:6")]
    Form,
    /// Numbers that are no range of speeds.
    #[error("the lowest speed must be 0 or more, and the highest a finite one above it")]
    Range,
}

impl FromStr for Speeds {
    type Err = SpeedsError;

    fn from_str(text: &str) -> Result<Self, SpeedsError> {
        let (low, high) = text.split_once(':').ok_or(SpeedsError::Form)?;
        let number = |text: &str| text.trim().parse::<f64>().map_err(|_| SpeedsError::Form);
        let (low, high) = (number(low)?, number(high)?);
        // What is not a number is in no order.
        if low >= 0.0 && high > low && high.is_finite() {
            Ok(Self { low, high })
        } else {
            Err(SpeedsError::Range)
        }
    }
}

impl Speeds {
    /// The speeds at which a law is read: where it is steep near zero, too.
    fn all(self) -> impl Iterator<Item = f64> {
        let Self { low, high } = self;
        let last = (SPEEDS - 1) as f64;
        let even = (0..SPEEDS).map(move |at| low + (high - low) * at as f64 / last);
        let first = low.max(LOWEST * high);
        let ratios = (0..SPEEDS).map(move |at| first * (high / first).powf(at as f64 / last));
        // A power may round to beyond the range.
        even.chain(ratios).map(move |speed| speed.clamp(low, high))
    }
}

/// damping·v + friction·sign v, and how far that is from the law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// Viscous friction, 0 or more.
    pub damping: f64,
    /// Dry friction, 0 or more.
    pub friction: f64,
    /// Largest distance from the law over the range, in both directions.
    pub error: f64,
    /// Where that is: a velocity.
    pub at: f64,
}

/// What resists at a speed, in the mean of both directions.
#[derive(Clone, Copy)]
struct Point {
    speed: f64,
    resistance: f64,
}

/// The line whose largest distance from the mean of both directions of `law` over the range is smallest, neither of its numbers below
/// 0, both rounded to six digits. Its error is that beside each direction. `law` gives the force against the motion at a velocity and a direction, 1 or −1.
///
/// # Errors
/// The first velocity at which the law is no finite number.
pub fn closest(speeds: Speeds, law: impl Fn(f64, f64) -> f64) -> Result<Line, f64> {
    let mut points = Vec::new();
    for speed in speeds.all() {
        let mut resistance = 0.0;
        for direction in [1.0, -1.0] {
            resistance += 0.5 * direction * law(direction * speed, direction);
            if !resistance.is_finite() {
                return Err(direction * speed);
            }
        }
        points.push(Point { speed, resistance });
    }
    // Over the slope, the largest distance is convex.
    let distance = |damping| best(&points, damping).1;
    let [lowest, highest] = ends(&points, 0.0);
    let reach = (2.0 * distance(0.0) + highest - lowest) / (speeds.high - speeds.low);
    let (mut from, mut to) = (0.0, reach);
    for _ in 0..STEPS {
        let (a, b) = (from + (to - from) / 3.0, to - (to - from) / 3.0);
        if distance(a) <= distance(b) {
            to = b;
        } else {
            from = a;
        }
    }
    let middle = 0.5 * (from + to);
    let damping = rounded(if distance(0.0) <= distance(middle) {
        0.0
    } else {
        middle
    });
    let friction = rounded(best(&points, damping).0);
    let mut line = Line {
        damping,
        friction,
        error: 0.0,
        at: speeds.high,
    };
    for Point { speed, .. } in points {
        for direction in [1.0, -1.0] {
            let resistance = direction * law(direction * speed, direction);
            let error = (resistance - damping * speed - friction).abs();
            if error > line.error {
                (line.error, line.at) = (error, direction * speed);
            }
        }
    }
    Ok(line)
}

/// Lowest and highest resistance that this damping leaves.
fn ends(points: &[Point], damping: f64) -> [f64; 2] {
    let mut ends = [f64::INFINITY, f64::NEG_INFINITY];
    for point in points {
        let left = point.resistance - damping * point.speed;
        ends = [ends[0].min(left), ends[1].max(left)];
    }
    ends
}

/// The best dry friction beside this damping, and the largest distance.
fn best(points: &[Point], damping: f64) -> (f64, f64) {
    let [lowest, highest] = ends(points, damping);
    let friction = (0.5 * (lowest + highest)).max(0.0);
    (friction, (highest - friction).max(friction - lowest))
}

/// A number to the digits that are written.
#[must_use]
pub fn rounded(value: f64) -> f64 {
    format!("{value:.*e}", DIGITS - 1).parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPEEDS: Speeds = Speeds {
        low: 0.1,
        high: 4.0,
    };

    #[test]
    fn a_line_is_found_again() {
        let line = closest(SPEEDS, |v, direction| 0.25 * v + 1.5 * direction).unwrap();
        assert_eq!((line.damping, line.friction), (0.25, 1.5));
        assert!(line.error < 1e-14, "{line:?}");
    }

    #[test]
    fn a_parabola_has_the_line_of_chebyshev() {
        // v² from a to b: slope a + b, and a distance of (b − a)²/8.
        let line = closest(SPEEDS, |v, _| v * v.abs() + 3.0 * v.signum()).unwrap();
        assert!((line.damping - 4.1).abs() < 1e-3, "{line:?}");
        assert!((line.friction - 0.69875).abs() < 1e-3, "{line:?}");
        assert!((line.error - 3.9 * 3.9 / 8.0).abs() < 1e-5, "{line:?}");
    }

    #[test]
    fn friction_that_falls_with_the_speed_gets_no_negative_damping() {
        let line = closest(SPEEDS, |v, direction| direction * (2.0 - 0.1 * v.abs())).unwrap();
        assert_eq!(line.damping, 0.0);
        assert!((line.friction - 1.795).abs() < 1e-5, "{line:?}");
        assert!((line.error - 0.195).abs() < 1e-5, "{line:?}");
    }

    #[test]
    fn directions_that_differ_get_their_middle() {
        let line = closest(SPEEDS, |v, direction| direction + 0.1 * v.abs()).unwrap();
        assert!((line.friction - 1.0).abs() < 1e-5, "{line:?}");
        assert!(line.damping < 1e-5, "{line:?}");
        assert!((line.error - 0.4).abs() < 1e-5, "{line:?}");
    }

    #[test]
    fn a_law_without_a_number_is_told() {
        let found = closest(SPEEDS, |v, _| if v < -3.0 { f64::NAN } else { v });
        assert!(found.is_err_and(|at| at < -3.0));
    }

    #[test]
    fn ranges_of_speeds_are_read_or_refused() {
        let read: Speeds = "0:2.5".parse().unwrap();
        assert_eq!((read.low, read.high), (0.0, 2.5));
        for wrong in [
            "", "2", "2:1", "1:1", "-1:2", "0:inf", "nan:2", "0:nan", "a:b",
        ] {
            assert!(wrong.parse::<Speeds>().is_err(), "{wrong}");
        }
    }
}
