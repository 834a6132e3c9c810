//! What the model file states of its numbers, against the records.

use crate::records::{DRIVE, drive};
use crate::{Place, names};

#[test]
fn stated_numbers_count_until_the_records_contradict_them() {
    let stated = |value: f64, share: f64| {
        let line = format!(
            "inertia = {{ value = {value}, unit = \"kg\", relative_uncertainty = {share} }}"
        );
        let model = DRIVE.replace(r#"inertia = { value = 9.0, unit = "kg" }"#, &line);
        let place = Place::new(&model, &drive(5.0, 1), &drive(5.0, 2));
        let (found, text) = place.diagnosed(0);
        assert_eq!(names(&found), ["coulomb_friction"], "{text}");
        let inertia = found.finding.parameters["drive.inertia"].clone();
        let [low, high] = inertia.interval95.unwrap();
        (
            inertia.value,
            high - low,
            text.contains("contradicts the records"),
        )
    };
    let (value, width, is_doubted) = stated(10.0, 5e-5);
    assert!((value - 10.0).abs() < 2e-3 && !is_doubted, "{value}");
    let (_, vague, is_doubted) = stated(9.0, 0.2);
    assert!(width < 0.2 * vague && !is_doubted, "{width} {vague}");
    let (value, width, is_doubted) = stated(9.0, 0.01);
    assert!((value - 10.0).abs() < 2.0 * vague && is_doubted, "{value}");
    assert!(width > 0.5 * vague, "{width} {vague}");
}
