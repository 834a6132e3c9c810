//! The maker of hidden effects and the workflow that must find them never import each other.

#![allow(clippy::unwrap_used, reason = "tests")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

#[test]
fn the_maker_depends_on_no_crate_of_the_workspace_and_none_on_it() {
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--no-deps", "--offline", "--format-version=1"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .unwrap();
    let metadata: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let members = metadata["packages"].as_array().unwrap();
    let has = |name: &str| members.iter().any(|member| member["name"] == name);
    assert!(has("benchmark-data") && has("stickslip"));
    for member in members {
        // Of every kind and platform, by the name of the package whatever it is called here.
        for dependency in member["dependencies"].as_array().unwrap() {
            let dependency = dependency["name"].as_str().unwrap();
            if member["name"] == "benchmark-data" {
                assert!(
                    !has(dependency),
                    "benchmark-data must not depend on {dependency}"
                );
            } else {
                assert_ne!(dependency, "benchmark-data", "in {}", member["name"]);
            }
        }
    }
}

#[test]
fn no_source_of_the_maker_is_included_from_outside() {
    fn sources(directory: &Path, found: &mut Vec<PathBuf>) {
        for entry in fs::read_dir(directory).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                sources(&path, found);
            } else {
                found.push(path);
            }
        }
    }
    let mut found = Vec::new();
    sources(
        &Path::new(env!("CARGO_MANIFEST_DIR")).join("src"),
        &mut found,
    );
    assert!(!found.is_empty());
    for path in found {
        let text = fs::read_to_string(&path).unwrap();
        let reaches_out = text.contains("#[path") || text.contains("include!(");
        assert!(!reaches_out, "{} reaches out of the crate", path.display());
    }
}
