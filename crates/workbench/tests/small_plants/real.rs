//! Measurements by others, where they are shared: what their models lack.

use std::path::{Path, PathBuf};

use workbench::diagnose::small_plant::finding::SmallFinding;

use crate::common::{library, stickslip};
use crate::names;

/// The shared measurements, where this tree has them beside it.
fn real() -> Option<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    [
        root.join("../../../shared/records/real"),
        root.join("../../../../shared/records/real"),
    ]
    .into_iter()
    .find(|directory| directory.is_dir())
}

/// Diagnoses a shared measurement with the project's model of it.
fn measured(model: &str, records: &str, held_out: &str) -> Option<(SmallFinding, String)> {
    let real = real()?;
    let out = tempfile::tempdir().unwrap();
    let model = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../docs/examples")
        .join(model);
    let (code, text) = stickslip(&[
        "diagnose",
        "--model",
        model.to_str().unwrap(),
        "--records",
        real.join(records).to_str().unwrap(),
        "--held-out",
        real.join(held_out).to_str().unwrap(),
        "--out",
        out.path().to_str().unwrap(),
        "--library",
        &library("stickslip"),
    ]);
    assert_eq!(code, 0, "{text}");
    Some((SmallFinding::read(out.path()).unwrap(), text))
}

#[test]
fn emps_lacks_dry_friction_and_then_its_asymmetry() {
    let Some((found, text)) = measured("emps.toml", "emps.csv", "emps_pulses.csv") else {
        return;
    };
    assert_eq!(
        names(&found)[..2],
        ["coulomb_friction", "friction_asymmetry"],
        "{text}"
    );
    let steps = &found.small_plant.steps;
    assert!(
        steps[1].learned.relative <= 0.041 && steps[1].held_out.relative <= 0.060,
        "{text}"
    );
    assert!(
        steps[2].learned.relative <= 0.0315 && steps[2].held_out.relative <= 0.054,
        "{text}"
    );
    // Published for the asymmetric model, on the records learned from.
    assert!(steps.last().unwrap().learned.relative < 0.03112, "{text}");
    assert!(
        steps.last().unwrap().held_out.relative < steps[2].held_out.relative,
        "{text}"
    );
}

#[test]
fn the_drill_string_lacks_acceleration_hysteresis() {
    let records = ["drillstring_ufrj.csv@31:40", "drillstring_ufrj.csv@40:47"];
    let Some((found, text)) = measured("drill-string.toml", records[0], records[1]) else {
        return;
    };
    assert_eq!(names(&found), ["acceleration_hysteresis"], "{text}");
    assert!(
        text.contains("acceleration hysteresis + load exponent would be likelier"),
        "{text}"
    );
    assert!(
        found.small_plant.steps.last().unwrap().held_out.rmse <= 0.228,
        "{text}"
    );
}

#[test]
fn the_pendulum_lacks_dry_friction_and_quadratic_drag() {
    let records = [
        "pendulum_freeswing.csv@0:36.665",
        "pendulum_freeswing.csv@36.665:55",
    ];
    let Some((found, text)) = measured("pendulum.toml", records[0], records[1]) else {
        return;
    };
    let mut named = names(&found);
    named.sort_unstable();
    let lacking = ["coulomb_friction", "encoder_eccentricity", "quadratic_drag"];
    assert_eq!(named, lacking, "{text}");
    assert!(
        found.small_plant.steps.last().unwrap().held_out.rmse <= 0.0052,
        "{text}"
    );
}
