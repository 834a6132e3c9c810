//! The house is as ARCHITECTURE.md draws it: what a module of the library uses stands left of it there.

#![allow(clippy::unwrap_used, reason = "tests")]

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

type Directions = BTreeMap<String, BTreeSet<String>>;

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// What each module may use, straight or through others, by the lines with arrows below "Modules of the library".
fn drawn() -> Directions {
    let page = fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap();
    let (_, section) = page.split_once("## Modules of the library").unwrap();
    let (section, _) = section.split_once("\n## ").unwrap();
    let mut all = Directions::new();
    for line in section.lines().filter(|line| line.contains(" ← ")) {
        let places: Vec<Vec<&str>> = line
            .trim()
            .split(" ← ")
            .map(|place| place.split(", ").collect())
            .collect();
        for pair in places.windows(2) {
            for user in &pair[1] {
                let used = pair[0].iter().map(|used| (*used).to_owned());
                all.entry((*user).to_owned()).or_default().extend(used);
            }
            for used in &pair[0] {
                all.entry((*used).to_owned()).or_default();
            }
        }
    }
    // Through others, until nothing is added.
    loop {
        let before = all.clone();
        for uses in all.values_mut() {
            let further: Vec<String> = uses.iter().flat_map(|used| before[used].clone()).collect();
            uses.extend(further);
        }
        if all == before {
            return all;
        }
    }
}

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() && path.file_name().unwrap() != "tests" {
            sources(&path, found);
        } else if path.extension().is_some_and(|end| end == "rs") {
            found.push(path);
        }
    }
}

/// The modules that a file's code names, comments and its tests left aside.
fn named(text: &str) -> BTreeSet<String> {
    let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap();
    let code: String = code
        .lines()
        .filter(|line| !line.trim_start().starts_with("//"))
        .collect();
    assert!(
        !code.contains("crate::{"),
        "name each module in a `use` of its own"
    );
    let word = |text: &str| -> String {
        let letters = text.chars();
        letters
            .take_while(|c| c.is_alphanumeric() || *c == '_')
            .collect()
    };
    code.split("crate::").skip(1).map(word).collect()
}

#[test]
fn modules_use_what_stands_left_of_them() {
    let drawn = drawn();
    for (module, uses) in &drawn {
        assert!(!uses.contains(module), "a circle through {module}");
    }
    let mut modules = BTreeSet::new();
    for entry in fs::read_dir(root().join("src")).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            modules.insert(path.file_name().unwrap().to_string_lossy().into_owned());
        }
    }
    assert_eq!(modules, drawn.keys().cloned().collect(), "drawn are others");
    for module in &modules {
        let mut files = Vec::new();
        sources(&root().join("src").join(module), &mut files);
        assert!(!files.is_empty());
        for file in files {
            for used in named(&fs::read_to_string(&file).unwrap()) {
                let may = &used == module || drawn[module].contains(&used);
                assert!(
                    may || !modules.contains(&used),
                    "{}: uses {used}",
                    file.display()
                );
            }
        }
    }
}
