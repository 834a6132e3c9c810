//! Names, tokens and resources with which there is no instance.

use crate::importer::{Component, FULL_RIG, Fmi2, Fmi3, REDUCED_RIG, Request, Version};
use crate::{BOTH, CASE, goes_on, said};
use std::ffi::CString;
use std::fs;
use stickslip::ffi::Status::Error;
use stickslip::ffi::fmi2::fmi2FreeInstance;
use stickslip::ffi::fmi3::fmi3FreeInstance;

/// An instantiation that must fail, with one line that says all `parts`.
#[track_caller]
fn no_instance(version: Version, request: &Request, parts: &[&str]) {
    let (handle, log) = request.send(version);
    assert!(handle.is_null(), "{parts:?}");
    let function = match version {
        Fmi2 => "fmi2Instantiate",
        Fmi3 => "fmi3InstantiateCoSimulation",
    };
    said(&log, Error, &[&[function], parts].concat());
}

/// An instantiation that must do.
fn an_instance(version: Version, request: &Request) {
    let (handle, log) = request.send(version);
    assert!(!handle.is_null(), "{:?}", log.take());
    match version {
        Fmi2 => fmi2FreeInstance(handle),
        Fmi3 => fmi3FreeInstance(handle),
    }
}

#[test]
fn tokens_and_names_that_do_not_match_give_no_instance() {
    let component = Component::new(REDUCED_RIG);
    let own = component.token.to_str().unwrap().to_owned();
    let foreign = Component::new(FULL_RIG).token.to_str().unwrap().to_owned();
    for version in BOTH {
        let good = component.request(version);
        for token in [
            "",
            "{00000000-0000-0000-0000-000000000000}",
            foreign.as_str(),
            &own.to_uppercase(),
            &format!("{own} "),
        ] {
            let request = Request {
                token: Some(CString::new(token).unwrap()),
                ..good.clone()
            };
            let wrong = format!("the token {token} does not match {own}");
            no_instance(version, &request, &[&wrong, "one run of build-fmu"]);
        }
        let request = Request {
            token: None,
            ..good.clone()
        };
        no_instance(
            version,
            &request,
            &[
                "the instantiation token (GUID) is NULL",
                "modelDescription.xml",
            ],
        );
        let request = Request {
            name: None,
            ..good.clone()
        };
        no_instance(
            version,
            &request,
            &["'instanceName' is NULL", "at least one character"],
        );
        let request = Request {
            name: Some(c" ".to_owned()),
            ..good.clone()
        };
        no_instance(
            version,
            &request,
            &["'instanceName' is empty", "at least one character"],
        );
        an_instance(version, &good);
    }
}

#[test]
fn resource_locations_that_lead_nowhere_give_no_instance() {
    let component = Component::new(REDUCED_RIG);
    for version in BOTH {
        let good = component.request(version);
        for (location, parts) in [
            (None, &["the resource location is NULL", "model.toml"][..]),
            (
                Some("http://x/resources"),
                &["has the scheme http", "only file: URIs"],
            ),
            (
                Some("file://server/resources"),
                &["names another host", "expected file:///path"],
            ),
            (
                Some("resources"),
                &["\"resources\" is a relative path", "must be absolute"],
            ),
            (Some(""), &["\"\" is a relative path", "must be absolute"]),
            (
                Some("/nowhere"),
                &[
                    "cannot read /nowhere/model.toml",
                    "resources of the unpacked FMU",
                ],
            ),
        ] {
            let request = Request {
                resources: location.map(|text| CString::new(text).unwrap()),
                ..good.clone()
            };
            no_instance(version, &request, parts);
        }
        an_instance(version, &good);
    }
}

#[test]
fn a_missing_or_changed_resource_gives_no_instance_and_leaves_others_alone() {
    let component = Component::new(REDUCED_RIG);
    let file = component.folder.join("model.toml");
    let path = file.to_str().unwrap();
    let changes: [(&str, String, &[&str]); 8] = [
        (
            "a value",
            changed("0.0149", "0.0150"),
            &["the token", "does not match", path],
        ),
        (
            "a comment",
            format!("{REDUCED_RIG}\n# seen\n"),
            &["the token", "does not match", path],
        ),
        (
            "an unknown key",
            changed("[disc]\n", "[disc]\nmass = 4.5\n"),
            &[path, "[disc] has no key \"mass\"", "known are inertia"],
        ),
        (
            "an unknown section",
            format!("{REDUCED_RIG}\n[disk]\nx = 1\n"),
            &[path, "there is no section [disk]", "known are disc"],
        ),
        (
            "a missing key",
            changed("law = \"stribeck\"", ""),
            &[path, "[contact] lacks law", "one of coulomb"],
        ),
        (
            "out of range",
            changed("value = 0.0149", "value = -1.0"),
            &[path, "disc.inertia = -1", "above 0"],
        ),
        (
            "no TOML",
            "what is this".to_owned(),
            &[path, "not valid TOML"],
        ),
        (
            "too large",
            format!("{REDUCED_RIG}{}", "#".repeat(1 << 20)),
            &[path, "larger than 1048576 bytes"],
        ),
    ];
    for version in BOTH {
        let good = component.request(version);
        let mut living = component.start(version, &CASE);
        for (what, text, parts) in &changes {
            fs::write(&file, text).unwrap();
            println!("{what}");
            no_instance(version, &good, parts);
        }
        fs::write(&file, b"\xff\xfe").unwrap();
        no_instance(version, &good, &[path, "UTF-8"]);
        fs::remove_file(&file).unwrap();
        no_instance(version, &good, &["cannot read", path, "No such file"]);
        fs::create_dir(&file).unwrap();
        no_instance(version, &good, &["cannot read", path, "directory"]);
        fs::remove_dir(&file).unwrap();
        // What lives already does not need the file any more.
        living.run(0.01, 0.5);
        living.reset();
        fs::write(&file, REDUCED_RIG).unwrap();
        living.initialize(0.0, &CASE);
        goes_on(&component, &mut living, 0.5);
        an_instance(version, &good);
    }
}

/// The reduced rig's file with one text replaced; it must be there.
fn changed(old: &str, new: &str) -> String {
    assert!(REDUCED_RIG.contains(old), "{old}");
    REDUCED_RIG.replacen(old, new, 1)
}
