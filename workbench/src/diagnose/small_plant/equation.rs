//! Coordinates of equations at a moment of a record.

use operations::Operation;
use stickslip::body::coordinate::COUNT;

use super::term::Sample;

/// The coordinates at a moment, in the order of their places.
#[must_use]
pub fn coordinates(sample: &Sample, friction: f64) -> [f64; COUNT] {
    [
        sample.position,
        sample.velocity,
        sample.acceleration,
        sample.direction,
        sample.time,
        friction,
        sample.load,
        sample.predicted,
        sample.motor,
        sample.weight,
    ]
}

/// Whether an equation depends on the coordinate at this place.
#[must_use]
pub fn uses(operations: &[Operation], place: usize) -> bool {
    operations.contains(&Operation::Coordinate(place))
}
