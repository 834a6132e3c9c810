//! The model descriptions kept in `modelDescription/` are what the generator writes today.

use crate::component::shipped_model;
use build_fmu::build::Source;
use build_fmu::platform::FmiVersion;

#[test]
fn kept_model_descriptions_are_up_to_date() {
    for model in [
        "reduced-rig.toml",
        "full-rig.toml",
        "speed-controller.toml",
        "soft-torque.toml",
    ] {
        let source = Source::read(&shipped_model(model)).unwrap();
        for version in FmiVersion::ALL {
            let kept = shipped_model(&source.xml_file_name(version));
            let written = source.model_description(version).unwrap();
            let found = std::fs::read_to_string(&kept).unwrap_or_default();
            assert!(
                found == written,
                "{} differs; regenerate with: build-fmu modelDescription/{model} --write-xml modelDescription",
                kept.display()
            );
        }
    }
}
