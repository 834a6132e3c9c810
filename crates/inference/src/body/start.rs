//! From where the fit of an effect that an equation describes starts: as on the rigs, from what its numbers do.

use crate::numbers::{self, Known, Number, PHASES, USUAL, places, recognise};

use super::motion::Scales;
use super::term::{Entry, Sample};
use super::unit::Usual as _;
use stickslip::body::coordinate::TIME;
use stickslip::body::{Kind, Path};

/// Share of its usual size at which a fit starts: small enough to leave the model near the analyst's, large enough that the numbers that
/// shape the effect have derivatives.
const NEAR: f64 = 0.1;
/// By how much beyond its root mean square a coordinate is looked at: the amplitude of a sine.
const REACH: f64 = std::f64::consts::SQRT_2;

/// Sets of values for all numbers of an effect on such a plant; `None` where no value of them makes it vanish.
#[must_use]
pub fn values(entry: &Entry, kind: Kind, path: Path, scales: &Scales) -> Option<Vec<Vec<f64>>> {
    let numbers = recognised(entry, kind, path, scales)?;
    Some(numbers::starts(&numbers, NEAR, &PHASES))
}

/// What each number of an effect does; `None` where no value of them makes it vanish.
#[must_use]
pub fn recognised(entry: &Entry, kind: Kind, path: Path, scales: &Scales) -> Option<Vec<Number>> {
    let known: Vec<Known<'_>> = entry
        .parameters
        .iter()
        .map(|own| {
            let unit = own.dimension.unit(kind, path);
            let by_size = own.dimension.scale(scales);
            Known {
                range: own.range,
                unit,
                natural: numbers::natural(unit, entry.uses(TIME), scales.duration, by_size),
                guess: own.guess,
            }
        })
        .collect();
    let moments: Vec<Sample> = places()
        .iter()
        .map(|shares| moment(shares, kind, scales))
        .collect();
    let values = |parameters: &[f64]| -> Vec<f64> {
        let force =
            |sample: &Sample| entry.force(parameters, sample, scales.force * sample.direction);
        moments.iter().map(force).collect()
    };
    recognise(&known, USUAL * scales.force, &values)
}

/// A moment of the records, from shares of 0 to 1.
fn moment(shares: &[f64; 7], kind: Kind, scales: &Scales) -> Sample {
    let signed = |place: usize, size: f64| REACH * (2.0 * shares[place] - 1.0) * size;
    let velocity = signed(1, scales.speed);
    Sample {
        time: shares[0] * scales.duration,
        velocity,
        position: signed(2, scales.position),
        acceleration: signed(3, scales.acceleration),
        direction: velocity.signum(),
        load: match kind {
            Kind::Contact => 0.5 + shares[4],
            _ => signed(6, scales.force),
        },
        predicted: signed(5, scales.force),
        motor: signed(5, scales.force),
        ..Sample::default()
    }
}
