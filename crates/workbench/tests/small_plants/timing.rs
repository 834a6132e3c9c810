//! When force and motion were read, against each other and between samples.

use crate::records::{DRIVE, held, read_late};
use crate::{Place, names};

#[test]
fn a_force_that_is_held_between_samples_is_no_delay() {
    let place = Place::new(DRIVE, &held(5.0, 1), &held(5.0, 2));
    let (found, text) = place.diagnosed(0);
    assert_eq!(names(&found), ["coulomb_friction"], "{text}");
    assert!(
        text.contains("takes effect 0.50 of a sampling interval"),
        "{text}"
    );
    assert!(text.contains("Drive.fmi3.fmu"), "{text}");
}

#[test]
fn how_samples_lie_about_a_jump_is_no_effect_beside_a_delay() {
    let model = DRIVE
        .replace("compare_low_pass = 10.0\n", "")
        .replace("compare_rate = 40.0", "compare_rate = 250.0");
    let place = Place::new(&model, &read_late(0.01, 1), &read_late(0.01, 2));
    let (found, text) = place.diagnosed(0);
    let mut named = names(&found);
    named.sort_unstable();
    assert_eq!(named, ["coulomb_friction", "sensor_delay"], "{text}");
}
