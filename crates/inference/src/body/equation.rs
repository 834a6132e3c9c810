//! Coordinates of equations at moments of a record.

use operations::Operation;
use stickslip::body::coordinate::{
    ACCELERATION, COUNT, DIRECTION, FRICTION, LOAD, MOTOR, POSITION, PREDICTED, TIME, VELOCITY,
};

use super::term::Sample;

/// Moments of one port with the coordinates that equations look at, in the order of their places.
#[derive(Debug)]
pub struct Moments<'a, const N: usize> {
    /// The moments.
    pub samples: &'a [Sample; N],
    /// Each coordinate at all of them.
    pub coordinates: [[f64; N]; COUNT],
}

impl<'a, const N: usize> Moments<'a, N> {
    /// Moments without friction.
    #[must_use]
    pub fn new(samples: &'a [Sample; N]) -> Self {
        let mut coordinates = [[0.0; N]; COUNT];
        for (lane, sample) in samples.iter().enumerate() {
            for (place, value) in [
                (POSITION, sample.position),
                (VELOCITY, sample.velocity),
                (ACCELERATION, sample.acceleration),
                (DIRECTION, sample.direction),
                (TIME, sample.time),
                (LOAD, sample.load),
                (PREDICTED, sample.predicted),
                (MOTOR, sample.motor),
            ] {
                coordinates[place][lane] = value;
            }
        }
        Self {
            samples,
            coordinates,
        }
    }

    /// Friction at each moment, which some effects multiply; zero until it is set.
    #[must_use]
    pub fn friction(&self) -> &[f64; N] {
        &self.coordinates[FRICTION]
    }

    /// Sets the friction at each moment.
    pub fn set_friction(&mut self, friction: [f64; N]) {
        self.coordinates[FRICTION] = friction;
    }
}

/// Whether an equation depends on the coordinate at this place.
#[must_use]
pub fn uses(operations: &[Operation], place: usize) -> bool {
    operations.contains(&Operation::Coordinate(place))
}
