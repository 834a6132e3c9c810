//! Where model and records disagree, in the terms of `finding.json`.

use super::finding::Located;
use super::left::STRUCTURE_GAIN;
use super::structure::{Coordinate, Structure};

/// Standard deviations between the ends of a 95 % interval.
const INTERVAL_WIDTH: f64 = 2.0 * 1.96;
/// Width of a band of frequencies [Hz]: eight of them, 0.05 Hz apart.
const BAND: f64 = 0.35;

/// The places in their order; of the bands of frequency only the strongest.
#[must_use]
pub fn located(structures: &[Structure]) -> Vec<Located> {
    let is_band = |structure: &&Structure| matches!(structure.coordinate, Coordinate::Frequency(_));
    let strongest_band = structures
        .iter()
        .filter(is_band)
        .max_by(|a, b| a.gain.total_cmp(&b.gain))
        .map(|structure| structure.coordinate);
    structures
        .iter()
        .filter(|structure| !is_band(structure) || Some(structure.coordinate) == strongest_band)
        .map(place)
        .collect()
}

fn place(structure: &Structure) -> Located {
    let [low, high] = structure.interval95;
    let deviation = (high - low) / INTERVAL_WIDTH;
    Located {
        coordinate: structure.coordinate.name().to_owned(),
        equation: structure.coordinate.equation().to_owned(),
        band: match structure.coordinate {
            Coordinate::Frequency(first) => Some([first, first + BAND]),
            _ => None,
        },
        gain: structure.gain,
        interval95: structure.interval95,
        significance: if deviation > 0.0 {
            structure.gain / deviation
        } else {
            0.0
        },
        significant: structure.gain > STRUCTURE_GAIN && low > 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn structure(coordinate: Coordinate, gain: f64) -> Structure {
        Structure {
            coordinate,
            gain,
            interval95: [gain - 19.6, gain + 19.6],
        }
    }

    #[test]
    fn one_band_of_frequencies_is_told_with_its_ends() {
        let found = located(&[
            structure(Coordinate::Frequency(0.6), 80.0),
            structure(Coordinate::DiscAngle, 60.0),
            structure(Coordinate::Frequency(0.2), 50.0),
        ]);
        let names: Vec<&str> = found
            .iter()
            .map(|place| place.coordinate.as_str())
            .collect();
        assert_eq!(names, ["frequency", "disc_angle"]);
        assert_eq!(found[0].band, Some([0.6, 0.6 + BAND]));
        assert_eq!(found[1].band, None);
        assert!((found[1].significance - 6.0).abs() < 1e-12);
        assert!(found[0].significant);
        assert!(!located(&[structure(Coordinate::Speed, 15.0)])[0].significant);
    }
}
