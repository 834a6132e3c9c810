//! An encoder whose disc is not centred on the axis: its readings lie off by a sine of one turn.

use super::term::Sample;

/// Position less reading: cosine·cos x + sine·sin x, x read [rad].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Eccentricity {
    /// Part that goes with the cosine of the reading [rad].
    pub cosine: f64,
    /// Part that goes with its sine [rad].
    pub sine: f64,
}

/// Corrections of a reading until it is exact: the error shrinks each time by the eccentricity.
const CORRECTIONS: usize = 5;

impl Eccentricity {
    /// The motion that was read as `read`.
    #[must_use]
    pub fn motion(&self, read: &Sample) -> Sample {
        let (sin, cos) = read.position.sin_cos();
        let off = self.cosine * cos + self.sine * sin;
        let rate = 1.0 + self.sine * cos - self.cosine * sin;
        Sample {
            position: read.position + off,
            velocity: read.velocity * rate,
            acceleration: read.acceleration * rate - off * read.velocity * read.velocity,
            ..*read
        }
    }

    /// What is read at a position [rad].
    #[must_use]
    pub fn reading(&self, position: f64) -> f64 {
        (0..CORRECTIONS).fold(position, |read, _| {
            position - self.cosine * read.cos() - self.sine * read.sin()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_read_is_where_it_was_read() {
        let encoder = Eccentricity {
            cosine: 0.003,
            sine: -0.002,
        };
        let read = |time: f64| Sample {
            time,
            position: encoder.reading(3.0 * (2.0 * time).sin()),
            velocity: 0.0,
            acceleration: 0.0,
            direction: 1.0,
            load: 1.0,
            ..Sample::default()
        };
        let (step, time) = (1e-4, 0.3);
        let [before, now, after] = [time - step, time, time + step].map(read);
        let read = Sample {
            velocity: (after.position - before.position) / (2.0 * step),
            acceleration: (after.position - 2.0 * now.position + before.position) / (step * step),
            ..now
        };
        let motion = encoder.motion(&read);
        let (sin, cos) = (2.0 * time).sin_cos();
        assert!((motion.position - 3.0 * sin).abs() < 1e-12, "{motion:?}");
        assert!((motion.velocity - 6.0 * cos).abs() < 1e-6, "{motion:?}");
        assert!(
            (motion.acceleration + 12.0 * sin).abs() < 1e-5,
            "{motion:?}"
        );
    }
}
