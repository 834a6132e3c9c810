//! The maker of hidden effects and the workflow that must find them never import each other.

#![allow(clippy::unwrap_used, reason = "tests")]

use std::fs;
use std::path::{Path, PathBuf};

fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn manifest(directory: &Path) -> toml::Table {
    let path = directory.join("Cargo.toml");
    fs::read_to_string(&path).unwrap().parse().unwrap()
}

/// Keys of every dependency table of a manifest, with the package a key is renamed from.
fn dependencies(manifest: &toml::Table) -> Vec<String> {
    let targets = manifest
        .get("target")
        .and_then(toml::Value::as_table)
        .into_iter()
        .flat_map(|targets| targets.values().filter_map(toml::Value::as_table));
    std::iter::once(manifest)
        .chain(targets)
        .flat_map(|table| {
            ["dependencies", "dev-dependencies", "build-dependencies"]
                .into_iter()
                .filter_map(|kind| table.get(kind)?.as_table())
        })
        .flat_map(|table| table.iter())
        .flat_map(|(key, value)| {
            let package = value.get("package").and_then(toml::Value::as_str);
            [Some(key.clone()), package.map(str::to_owned)]
        })
        .flatten()
        .collect()
}

fn members() -> Vec<(String, toml::Table)> {
    let root = manifest(&workspace());
    let mut manifests = vec![root.clone()];
    let members = root["workspace"]["members"].as_array().unwrap();
    for member in members {
        manifests.push(manifest(&workspace().join(member.as_str().unwrap())));
    }
    manifests
        .into_iter()
        .filter_map(|m| Some((m.get("package")?["name"].as_str()?.to_owned(), m)))
        .collect()
}

#[test]
fn the_maker_depends_on_no_crate_of_the_workspace_and_none_on_it() {
    let members = members();
    assert!(members.iter().any(|(name, _)| name == "benchmark-data"));
    assert!(members.iter().any(|(name, _)| name == "stickslip"));
    for (name, manifest) in &members {
        for dependency in dependencies(manifest) {
            if name == "benchmark-data" {
                assert!(
                    members.iter().all(|(member, _)| *member != dependency),
                    "benchmark-data must not depend on {dependency}"
                );
            } else {
                assert_ne!(dependency, "benchmark-data", "in {name}");
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
