//! Where model and records disagree, in the terms of `finding.json`.

use std::f64::consts::TAU;

use inference::structure::{Coordinate, Structure};
use inference::units::PlantUnits;

use super::finding::Disagreement;

/// Gain in log evidence from which on structure over one coordinate is significant: odds of 100 : 1.
const SIGNIFICANT: f64 = 4.6;

/// The places in their order; of the bands of frequency only the strongest, in Hz.
#[must_use]
pub fn disagreements(structures: &[Structure], units: &PlantUnits) -> Vec<Disagreement> {
    let is_band = |structure: &&Structure| matches!(structure.coordinate, Coordinate::Frequency(_));
    let strongest_band = structures
        .iter()
        .filter(is_band)
        .max_by(|a, b| a.gain.total_cmp(&b.gain))
        .map(|structure| structure.coordinate);
    structures
        .iter()
        .filter(|structure| structure.gain.is_finite())
        .filter(|structure| !is_band(structure) || Some(structure.coordinate) == strongest_band)
        .map(|structure| Disagreement {
            coordinate: structure.coordinate.name().to_owned(),
            equation: structure.coordinate.equation().to_owned(),
            band: structure
                .coordinate
                .band()
                .map(|band| band.map(|rate| rate / (TAU * units.time))),
            gain: structure.gain,
            interval95: None,
            significance: None,
            significant: structure.gain > SIGNIFICANT,
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_band_of_frequencies_is_told_with_its_ends_in_hertz() {
        let units = PlantUnits {
            time: 0.5,
            torque: 1.0,
            force: 1.0,
            current: 1.0,
        };
        let structure = |coordinate, gain| Structure { coordinate, gain };
        let found = disagreements(
            &[
                structure(Coordinate::Frequency(0.6), 80.0),
                structure(Coordinate::DiscAngle, 60.0),
                structure(Coordinate::Frequency(0.2), 50.0),
                structure(Coordinate::Speed, 2.0),
            ],
            &units,
        );
        let names: Vec<&str> = found
            .iter()
            .map(|place| place.coordinate.as_str())
            .collect();
        assert_eq!(names, ["frequency", "disc_angle", "speed"]);
        let [low, high] = found[0].band.unwrap();
        assert!((low - 0.6 / (TAU * 0.5)).abs() < 1e-12 && high > low);
        assert_eq!(found[1].band, None);
        assert!(found[0].significant && !found[2].significant);
    }
}
