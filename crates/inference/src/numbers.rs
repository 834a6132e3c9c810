//! The numbers of an effect that an equation describes: which make it vanish, which turn it and which shape it, how large each
//! usually is, and from where fits start. All of it follows from the equation, the ranges and the size of the plant.

use stickslip::expression::Dimension;
use stickslip::parameter::Range;

/// Share of the size of what it acts on that an effect usually has: of the friction torque, of the twist, of the load, of one.
pub const USUAL: f64 = 0.3;
/// Multiple of the usual size that bounds a number.
pub(crate) const BOUND: f64 = 30.0;
/// Smallest share of the speed, of the period or of the stiffness that a number of a law or of a spring may have.
pub(crate) const NARROW: f64 = 1e-3;
/// Differences, as a share of what they are compared with, that are rounding.
const ROUNDING: f64 = 1e-9;
/// Share of itself by which a number moves to see what it does.
const MOVE: f64 = 1e-4;
/// Most starts of one effect.
const MOST_STARTS: usize = 24;
/// Phases from which fits start that do not begin with hardly any effect.
pub const PHASES: [f64; 4] = [0.0, 1.6, 3.1, 4.7];

/// Places at which an equation is looked at: enough for means of a few per cent.
const PLACES: usize = 97;

/// Places that fill a space of `N` coordinates evenly, each from 0 to 1: multiples of the powers of the root of x^(N+1) = x + 1
/// (M. Roberts, *The unreasonable effectiveness of quasirandom sequences*, 2018).
#[must_use]
pub fn places<const N: usize>() -> Vec<[f64; N]> {
    let power = N as i32 + 1;
    let newton =
        |x: f64| x - (x.powi(power) - x - 1.0) / (f64::from(power) * x.powi(power - 1) - 1.0);
    let root = (0..32).fold(1.5, |x, _| newton(x));
    let share = |place: usize, j: usize| (0.5 + place as f64 * root.powi(-(j as i32 + 1))).fract();
    (1..=PLACES)
        .map(|place| std::array::from_fn(|j| share(place, j)))
        .collect()
}

/// What is known of a number before any record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Known<'a> {
    /// Where it may lie.
    pub range: Range,
    /// Its unit.
    pub unit: &'a str,
    /// How large such numbers are on this plant.
    pub natural: f64,
    /// Where a fit may start, if its file says so.
    pub guess: Option<f64>,
}

impl Known<'_> {
    fn is_pure(&self) -> bool {
        Dimension::of_unit(self.unit) == Ok(Dimension::NONE)
    }
}

/// How large a number of this unit in an equation usually is: the records' `duration` for a moment of them, else what the plant's size
/// says.
#[must_use]
pub fn natural(unit: &str, uses_time: bool, duration: f64, by_size: f64) -> f64 {
    if unit == "s" && uses_time {
        duration
    } else {
        by_size
    }
}

/// One number of an effect.
#[derive(Clone, Debug, PartialEq)]
pub enum Number {
    /// It is `origin` where there is no effect.
    Amplitude {
        /// Its value without effect.
        origin: f64,
        /// Its distance from there where the effect has its usual size; infinite where nothing of it shows.
        scale: f64,
    },
    /// The angle at which the effect is largest.
    Phase,
    /// It says at which place or how wide the effect is.
    Shape {
        /// Where fits start.
        starts: Vec<f64>,
        /// Middle of what is known.
        origin: f64,
        /// Its standard deviation.
        scale: f64,
        /// Its range.
        bounds: (f64, f64),
    },
}

/// The numbers of an effect of the usual size `usual`; `values` gives the effect over many places, less that of no effect. `None`
/// where no value of its numbers makes it vanish, so that it cannot be compared with no effect.
#[must_use]
pub fn recognise(
    known: &[Known<'_>],
    usual: f64,
    values: &dyn Fn(&[f64]) -> Vec<f64>,
) -> Option<Vec<Number>> {
    let shapes: Vec<Number> = known.iter().map(shape).collect();
    let typical: Vec<f64> = shapes.iter().map(middle).collect();
    let looked = Looked {
        known,
        typical,
        values,
    };
    let origins = looked.amplitudes()?;
    let mut held = looked.typical.clone();
    for (place, origin) in origins.iter().enumerate() {
        if let Some(origin) = origin {
            held[place] = *origin;
        }
    }
    let mut numbers: Vec<Number> = shapes
        .into_iter()
        .enumerate()
        .map(|(place, shape)| {
            origins[place].map_or(shape, |origin| {
                let step = MOVE * known[place].natural;
                let mut moved = held.clone();
                moved[place] += step;
                let slope = size(&values(&moved)) / step;
                Number::Amplitude {
                    origin,
                    scale: usual / slope,
                }
            })
        })
        .collect();
    if origins.iter().flatten().count() == 1
        && let Some(place) = looked.phase(&origins)
    {
        numbers[place] = Number::Phase;
    }
    Some(numbers)
}

/// The values from which fits start, every number's with every other's: amplitudes at the share `near` of their usual size, phases at
/// `phases`. Empty where nothing of the effect shows.
#[must_use]
pub fn starts(numbers: &[Number], near: f64, phases: &[f64]) -> Vec<Vec<f64>> {
    let mut sets: Vec<Vec<f64>> = vec![Vec::new()];
    for number in numbers {
        let own = match number {
            Number::Amplitude { origin, scale } if scale.is_finite() => {
                vec![origin + near * scale]
            }
            Number::Amplitude { .. } => Vec::new(),
            Number::Phase => phases.to_vec(),
            Number::Shape { starts, .. } => starts.clone(),
        };
        sets = sets
            .iter()
            .flat_map(|set| own.iter().map(|value| [&set[..], &[*value]].concat()))
            .collect();
    }
    let every = sets.len().div_ceil(MOST_STARTS).max(1);
    sets.into_iter().step_by(every).collect()
}

/// A number as it is if it shapes the effect.
fn shape(known: &Known<'_>) -> Number {
    let natural = known.natural;
    let (starts, origin, scale, mut bounds) = match known.range {
        Range::Between(low, high) => {
            let width = high - low;
            let starts = [1.0, 3.0, 5.0].map(|sixth| low + width * sixth / 6.0);
            (
                starts.to_vec(),
                0.5 * (low + high),
                0.5 * width,
                (low, high),
            )
        }
        Range::Positive | Range::NonNegative => (
            [0.1, 0.3, 1.0].map(|share| share * natural).to_vec(),
            natural,
            3.0 * natural,
            (NARROW * natural, BOUND * natural),
        ),
        Range::Finite => (
            if known.unit == "rad" {
                PHASES.to_vec()
            } else {
                [0.2, 0.5, 0.8].map(|share| share * natural).to_vec()
            },
            0.0,
            natural,
            (-BOUND * natural, BOUND * natural),
        ),
    };
    let starts = match known.guess {
        Some(guess) => {
            bounds = (bounds.0.min(guess), bounds.1.max(guess));
            vec![guess]
        }
        None => starts,
    };
    Number::Shape {
        starts,
        origin,
        scale,
        bounds,
    }
}

fn middle(number: &Number) -> f64 {
    match number {
        Number::Shape { starts, .. } => starts[starts.len() / 2],
        Number::Amplitude { .. } | Number::Phase => 0.0,
    }
}

fn size(values: &[f64]) -> f64 {
    (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt()
}

fn difference(a: &[f64], b: &[f64]) -> f64 {
    let differences: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
    size(&differences)
}

/// An effect with typical numbers, to be looked at.
struct Looked<'a> {
    known: &'a [Known<'a>],
    typical: Vec<f64>,
    values: &'a dyn Fn(&[f64]) -> Vec<f64>,
}

impl Looked<'_> {
    /// Of every number the value at which the effect vanishes, where it is one that decides that: one number, if possible one to
    /// which the effect is proportional, else the fewest that must vanish together.
    fn amplitudes(&self) -> Option<Vec<Option<f64>>> {
        let count = self.typical.len();
        let only = |place: usize, origin: f64| {
            let mut origins = vec![None; count];
            origins[place] = Some(origin);
            origins
        };
        let single: Vec<Vec<Option<f64>>> = (0..count)
            .flat_map(|place| [0.0, 1.0].map(|origin| (place, origin)))
            .filter(|&(place, origin)| origin == 0.0 || self.known[place].is_pure())
            .map(|(place, origin)| only(place, origin))
            .filter(|origins| self.vanishes(origins))
            .collect();
        let proportional = single.iter().find(|origins| {
            let place = origins.iter().position(Option::is_some);
            place.is_some_and(|place| origins[place] == Some(0.0) && self.is_proportional(place))
        });
        if let Some(found) = proportional.or(single.first()) {
            return Some(found.clone());
        }
        let mut sets: Vec<usize> = (1..1usize << count).collect();
        sets.sort_by_key(|set| set.count_ones());
        sets.into_iter()
            .map(|set| {
                (0..count)
                    .map(|place| (set >> place & 1 == 1).then_some(0.0))
                    .collect::<Vec<_>>()
            })
            .find(|origins| self.vanishes(origins))
    }

    fn vanishes(&self, origins: &[Option<f64>]) -> bool {
        let at: Vec<f64> = self
            .typical
            .iter()
            .zip(origins)
            .map(|(typical, origin)| origin.unwrap_or(*typical))
            .collect();
        let may_be = |(known, origin): (&Known<'_>, &Option<f64>)| {
            origin.is_none_or(|origin| {
                known.range.minimum().is_none_or(|low| low <= origin)
                    && known.range.maximum().is_none_or(|high| origin <= high)
            })
        };
        if !self.known.iter().zip(origins).all(may_be) {
            return false;
        }
        let whole = size(&(self.values)(&self.typical));
        let left = size(&(self.values)(&at));
        left <= ROUNDING * whole.max(f64::MIN_POSITIVE) || (whole.is_nan() && left == 0.0)
    }

    fn is_proportional(&self, place: usize) -> bool {
        let at = |share: f64| {
            let mut at = self.typical.clone();
            at[place] = share * MOVE * self.known[place].natural;
            (self.values)(&at)
        };
        let (one, two) = (at(1.0), at(2.0));
        let doubled: Vec<f64> = one.iter().map(|v| 2.0 * v).collect();
        difference(&doubled, &two) <= 1e3 * ROUNDING * size(&two)
    }

    /// The number that turns the effect: its cosine times the effect at zero, and its sine times the effect a quarter of a turn on.
    fn phase(&self, origins: &[Option<f64>]) -> Option<usize> {
        let amplitude = origins.iter().position(Option::is_some)?;
        if origins[amplitude] != Some(0.0)
            || matches!(self.known[amplitude].range, Range::Between(low, _) if low > 0.0)
        {
            return None;
        }
        (0..self.typical.len()).find(|&place| {
            let turned = |phase: f64| {
                let mut at = self.typical.clone();
                at[amplitude] = MOVE * self.known[amplitude].natural;
                at[place] = phase;
                (self.values)(&at)
            };
            let (along, across) = (turned(0.0), turned(std::f64::consts::FRAC_PI_2));
            let is_turned = |phase: f64| {
                let (s, c) = phase.sin_cos();
                let sum: Vec<f64> = along
                    .iter()
                    .zip(&across)
                    .map(|(a, b)| c * a + s * b)
                    .collect();
                difference(&sum, &turned(phase)) <= 1e3 * ROUNDING * size(&sum)
            };
            place != amplitude
                && self.known[place].range == Range::Finite
                && self.known[place].is_pure()
                && [0.7, 2.1, 4.0].into_iter().all(is_turned)
        })
    }
}
