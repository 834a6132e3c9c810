//! `build-fmu check` finds each of these planted defects, and nothing in what `build-fmu` makes.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use build_fmu::lint::{self, Loading, OpenError, Package, Rule};
use build_fmu::platform::FmiVersion;

use crate::component::build;
use crate::exchange_mutations::{EXCHANGE_FMI2, EXCHANGE_FMI3};
use crate::reference_mutations::REFERENCES;
use crate::spoiled::Defect::{self, Bytes, Files as Change, Replace};
use crate::spoiled::{DESCRIPTION, Files, LIBRARY, add, pack, patch, rename_symbol, spoil, unpack};

const BOTH: &[(&str, Rule, Defect)] = &[
    (
        "backslash",
        Rule::EntryName,
        Change(|files, _| add(files, "extra\\a.txt")),
    ),
    (
        "way out",
        Rule::EntryName,
        Change(|files, _| add(files, "../a.txt")),
    ),
    (
        "absolute path",
        Rule::EntryName,
        Change(|files, _| add(files, "/a.txt")),
    ),
    (
        "case twin",
        Rule::DuplicateEntry,
        Change(|files, _| add(files, "MODELDESCRIPTION.XML")),
    ),
    (
        "newer zip",
        Rule::ZipVersion,
        Bytes(|bytes| patch(bytes, 6, 45)),
    ),
    (
        "encrypted",
        Rule::Encrypted,
        Bytes(|bytes| patch(bytes, 8, 1)),
    ),
    (
        "odd compression",
        Rule::Compression,
        Bytes(|bytes| patch(bytes, 10, 12)),
    ),
    (
        "damaged",
        Rule::Damaged,
        Bytes(|bytes| patch(bytes, 16, 0x1234)),
    ),
    (
        "link",
        Rule::NotAFile,
        Bytes(|bytes| patch(bytes, 40, 0o120_777)),
    ),
    (
        "no description",
        Rule::Description,
        Change(|files, _| drop(files.remove(DESCRIPTION))),
    ),
    (
        "one folder down",
        Rule::Description,
        Change(|files, _| {
            let text = files.remove(DESCRIPTION).unwrap();
            files.insert(format!("ReducedRig/{DESCRIPTION}"), text);
        }),
    ),
    (
        "entities",
        Rule::Description,
        Replace(
            "<fmiModelDescription",
            "<!DOCTYPE a [<!ENTITY b \"c\">]><fmiModelDescription",
        ),
    ),
    (
        "cut off",
        Rule::Description,
        Replace("</fmiModelDescription>", ""),
    ),
    (
        "two of a name",
        Rule::DuplicateVariable,
        Replace("name=\"theta_dot\"", "name=\"theta\""),
    ),
    (
        "continuous parameter",
        Rule::Role,
        Replace("variability=\"tunable\"", "variability=\"continuous\""),
    ),
    (
        "input without start",
        Rule::Role,
        Replace(" start=\"0\"", ""),
    ),
    (
        "start below min",
        Rule::Limits,
        Replace("start=\"0.33\"", "start=\"-0.33\""),
    ),
    (
        "start is no number",
        Rule::Limits,
        Replace("start=\"0.33\"", "start=\"0,33\""),
    ),
    (
        "min above max",
        Rule::Limits,
        Replace("start=\"0.33\"", "max=\"-1\" start=\"0.33\""),
    ),
    (
        "unit twice",
        Rule::Unit,
        Replace("<Unit name=\"V\">", "<Unit name=\"N\">"),
    ),
    (
        "unit undefined",
        Rule::Unit,
        Replace("<Unit name=\"V\">", "<Unit name=\"Volt\">"),
    ),
    (
        "display unit undefined",
        Rule::Unit,
        Replace("<DisplayUnit name=\"rpm\"", "<DisplayUnit name=\"1/min\""),
    ),
    (
        "type undefined",
        Rule::Type,
        Replace("declaredType=\"Voltage\"", "declaredType=\"Tension\""),
    ),
    (
        "date is none",
        Rule::Date,
        Replace(
            "generationTool=",
            "generationDateAndTime=\"31.01.2026\" generationTool=",
        ),
    ),
    (
        "date to come",
        Rule::Date,
        Replace(
            "generationTool=",
            "generationDateAndTime=\"2999-01-31T00:00:00Z\" generationTool=",
        ),
    ),
    (
        "ends before its start",
        Rule::Experiment,
        Replace("stopTime=\"60\"", "stopTime=\"-60\""),
    ),
    (
        "step of zero",
        Rule::Experiment,
        Replace("stepSize=\"0.01\"", "stepSize=\"0\""),
    ),
    (
        "no library",
        Rule::Binary,
        Change(|files, library| drop(files.remove(library))),
    ),
    (
        "unknown platform",
        Rule::Binary,
        Change(|files, library| {
            let content = files.remove(library).unwrap();
            files.insert("binaries/amiga/ReducedRig.so".to_owned(), content);
        }),
    ),
    (
        "other name",
        Rule::BinaryName,
        Change(|files, library| {
            let content = files.remove(library).unwrap();
            files.insert(library.replace("ReducedRig", "libstickslip"), content);
        }),
    ),
    (
        "other identifier",
        Rule::BinaryName,
        Replace(
            "modelIdentifier=\"ReducedRig\"",
            "modelIdentifier=\"OtherRig\"",
        ),
    ),
    (
        "text as a library",
        Rule::BinaryPlatform,
        Change(|files, library| {
            files.insert(library.to_owned(), b"no library".to_vec());
        }),
    ),
    (
        "changed resource",
        Rule::Instantiation,
        Change(|files, _| {
            files
                .get_mut("resources/model.toml")
                .unwrap()
                .extend(b"\n# changed\n");
        }),
    ),
    (
        "no resource",
        Rule::Instantiation,
        Change(|files, _| drop(files.remove("resources/model.toml"))),
    ),
];

const FMI2: &[(&str, Rule, Defect)] = &[
    (
        "older standard",
        Rule::FmiVersion,
        Replace("fmiVersion=\"2.0\"", "fmiVersion=\"1.0\""),
    ),
    (
        "empty token",
        Rule::Missing,
        Replace("guid=\"{", "guid=\"\" copyright=\"{"),
    ),
    (
        "other token",
        Rule::Instantiation,
        Replace("guid=\"{", "guid=\"{0"),
    ),
    (
        "output not listed",
        Rule::Structure,
        Replace("<Unknown index=\"4\"", "<Unknown index=\"5\""),
    ),
    (
        "dependency on nothing",
        Rule::Structure,
        Replace("dependencies=\"3 4", "dependencies=\"300 4"),
    ),
    (
        "no source file",
        Rule::ListedFile,
        Replace(
            "providesDirectionalDerivative=\"true\"/>",
            "providesDirectionalDerivative=\"true\"><SourceFiles><File name=\"all.c\"/></SourceFiles></ModelExchange>",
        ),
    ),
    (
        "wrong machine",
        Rule::BinaryPlatform,
        Change(|files, library| {
            let content = files[library].clone();
            files.insert("binaries/win64/ReducedRig.dll".to_owned(), content);
        }),
    ),
    (
        "missing function",
        Rule::Symbols,
        Change(|files, library| {
            rename_symbol(
                files.get_mut(library).unwrap(),
                b"\0fmi2CancelStep\0",
                b"\0fmi2CancelStop\0",
            );
        }),
    ),
];

const FMI3: &[(&str, Rule, Defect)] = &[
    (
        "shared reference",
        Rule::DuplicateVariable,
        Replace("valueReference=\"4\"", "valueReference=\"3\""),
    ),
    (
        "empty token",
        Rule::Missing,
        Replace(
            "instantiationToken=\"{",
            "instantiationToken=\"\" copyright=\"{",
        ),
    ),
    (
        "other token",
        Rule::Instantiation,
        Replace("instantiationToken=\"{", "instantiationToken=\"{0"),
    ),
    (
        "output not listed",
        Rule::Structure,
        Replace(
            "<Output valueReference=\"3\"",
            "<Output valueReference=\"4\"",
        ),
    ),
    (
        "no icon",
        Rule::ListedFile,
        Change(|files, _| drop(files.remove("terminalsAndIcons/icon.png"))),
    ),
    (
        "terminal of nothing",
        Rule::ListedFile,
        Change(|files, _| {
            let file = files
                .get_mut("terminalsAndIcons/terminalsAndIcons.xml")
                .unwrap();
            let text = String::from_utf8(file.clone()).unwrap();
            *file = text.replace("\"T_f\"", "\"T_g\"").into_bytes();
        }),
    ),
    (
        "missing source",
        Rule::ListedFile,
        Change(|files, _| {
            let text = "<fmiBuildDescription fmiVersion=\"3.0\"><BuildConfiguration modelIdentifier=\"ReducedRig\">\
            <SourceFileSet><SourceFile name=\"all.c\"/></SourceFileSet></BuildConfiguration></fmiBuildDescription>";
            files.insert("sources/buildDescription.xml".to_owned(), text.into());
        }),
    ),
    (
        "missing function",
        Rule::Symbols,
        Change(|files, library| {
            rename_symbol(
                files.get_mut(library).unwrap(),
                b"\0fmi3SetClock\0",
                b"\0fmi3SetClick\0",
            );
        }),
    ),
];

fn every_defect_is_found(version: FmiVersion, own: &[(&str, Rule, Defect)]) {
    let folder = tempfile::tempdir().unwrap();
    let path = build("reduced-rig.toml", version, folder.path());
    assert_eq!(
        lint::check(&Package::open(&path).unwrap(), Loading::Load),
        []
    );
    let good = unpack(&path);
    let spoiled = folder.path().join("Spoiled.fmu");
    fs::write(&spoiled, pack(&good, 1)).unwrap();
    assert_eq!(
        lint::check(&Package::open(&spoiled).unwrap(), Loading::Load),
        []
    );
    let library = LIBRARY[usize::from(version == FmiVersion::Fmi3)];
    let exchange = match version {
        FmiVersion::Fmi2 => EXCHANGE_FMI2,
        FmiVersion::Fmi3 => EXCHANGE_FMI3,
    };
    for (name, rule, defect) in BOTH.iter().chain(own).chain(exchange).chain(REFERENCES) {
        fs::write(&spoiled, spoil(&good, defect, library)).unwrap();
        let findings = lint::check(&Package::open(&spoiled).unwrap(), Loading::Load);
        assert!(
            findings.iter().any(|finding| finding.rule == *rule),
            "{version}, {name}: {rule:?} expected, found {findings:?}"
        );
    }
}

#[test]
fn every_defect_of_an_fmi2_fmu_is_found() {
    every_defect_is_found(FmiVersion::Fmi2, FMI2);
}

#[test]
fn every_defect_of_an_fmi3_fmu_is_found() {
    every_defect_is_found(FmiVersion::Fmi3, FMI3);
}

/// The table of docs/check.md.
fn table() -> String {
    let mut rows: BTreeMap<(&str, &str), [bool; 2]> = BTreeMap::new();
    for (defects, versions) in [
        (BOTH, [true, true]),
        (REFERENCES, [true, true]),
        (FMI2, [true, false]),
        (FMI3, [false, true]),
        (EXCHANGE_FMI2, [true, false]),
        (EXCHANGE_FMI3, [false, true]),
    ] {
        for (name, rule, _) in defects {
            let row = rows.entry((rule.name(), name)).or_default();
            row[0] |= versions[0];
            row[1] |= versions[1];
        }
    }
    let mut table = String::from("| planted defect | rule | FMI 2 | FMI 3 |\n|---|---|---|---|\n");
    for ((rule, name), versions) in rows {
        let [two, three] = versions.map(|planted| if planted { "found" } else { "" });
        table.push_str(&format!("| {name} | `{rule}` | {two} | {three} |\n"));
    }
    table
}

#[test]
fn the_documented_table_is_that_of_these_defects() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/check.md");
    let page = fs::read_to_string(path).unwrap();
    let table = table();
    assert!(page.contains(&table), "docs/check.md should have\n{table}");
}

#[test]
fn an_archive_that_explodes_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("Bomb.fmu");
    let files = Files::from([("resources/zeros".to_owned(), vec![0; 64 << 20])]);
    fs::write(&path, pack(&files, 9)).unwrap();
    let error = Package::open(&path).unwrap_err();
    assert!(matches!(error, OpenError::Bomb { .. }), "{error}");
    assert!(error.to_string().contains("resources/zeros"), "{error}");
}

#[test]
fn a_file_that_is_no_archive_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("Notes.fmu");
    fs::write(&path, "notes").unwrap();
    let error = Package::open(&path).unwrap_err();
    assert!(
        error.to_string().contains("Notes.fmu is not a zip archive"),
        "{error}"
    );
}
