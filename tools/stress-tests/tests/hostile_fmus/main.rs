//! FMUs made to do harm, given to every command that opens one: refused with a reason, in no time and little memory.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail")]

mod costly;
mod fmu;

use std::fmt::Write as _;
use std::fs;
use std::io::Write as _;
use std::path::Path;

use fmu::{BINARY, Fmu, deflated, description, refused};
use stress_tests::component::{Component, REDUCED_RIG};
use stress_tests::library;
use zip::write::SimpleFileOptions;

#[test]
fn archives_that_reach_outside_or_pretend() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path();
    let sound = description("{0}", "");
    for (name, entry) in [
        ("up", "../../escaped.txt"),
        ("deep", "resources/../../../escaped.txt"),
        ("absolute", "/tmp/escaped.txt"),
        ("drive", "C:\\escaped.txt"),
    ] {
        let fmu = Fmu::new(folder, name)
            .file("modelDescription.xml", &sound)
            .file(entry, "x")
            .finish();
        refused(&fmu, true, &["leads out", "absolute path", "backslash"]);
    }
    let mut link = Fmu::new(folder, "link").file("modelDescription.xml", &sound);
    link.writer
        .add_symlink(
            "resources/link",
            "/etc/passwd",
            SimpleFileOptions::default(),
        )
        .unwrap();
    refused(&link.finish(), true, &["link or a special file"]);
    fs::write(folder.join("empty.fmu"), "").unwrap();
    refused(&folder.join("empty.fmu"), true, &["not a sound zip"]);
    fs::write(folder.join("text.fmu"), "not an archive at all".repeat(100)).unwrap();
    refused(&folder.join("text.fmu"), true, &["not a sound zip"]);
    let whole = Fmu::new(folder, "cut")
        .file("modelDescription.xml", &sound)
        .finish();
    let bytes = fs::read(&whole).unwrap();
    fs::write(&whole, &bytes[..bytes.len() / 2]).unwrap();
    refused(&whole, true, &["not a sound zip"]);
    assert!(!folder.join("escaped.txt").exists() && !Path::new("/tmp/escaped.txt").exists());
}

#[test]
fn bombs() {
    let place = tempfile::tempdir().unwrap();
    let zeros = vec![0; 1 << 20];
    let mut bomb =
        Fmu::new(place.path(), "bomb").file("modelDescription.xml", description("{0}", ""));
    bomb.writer
        .start_file("resources/zeros", deflated())
        .unwrap();
    for _ in 0..1024 {
        bomb.writer.write_all(&zeros).unwrap();
    }
    refused(&bomb.finish(), true, &["unpacks to more than"]);
    let mut many =
        Fmu::new(place.path(), "many").file("modelDescription.xml", description("{0}", ""));
    for number in 0..30_000 {
        many.writer
            .start_file(format!("resources/{number}"), SimpleFileOptions::default())
            .unwrap();
    }
    refused(&many.finish(), true, &["more than 10000 entries"]);
    // A gibibyte that says it is a kibibyte.
    let bytes = fs::read(place.path().join("bomb.fmu")).unwrap();
    let announced = (1_u32 << 30).to_le_bytes();
    let mut lying = bytes.clone();
    for at in 0..lying.len() - 4 {
        if lying[at..at + 4] == announced {
            lying[at..at + 4].copy_from_slice(&1024_u32.to_le_bytes());
        }
    }
    assert_ne!(lying, bytes);
    let path = place.path().join("lying.fmu");
    fs::write(&path, lying).unwrap();
    refused(&path, true, &["than it says", "not a sound zip"]);
}

#[test]
fn descriptions_that_explode() {
    let place = tempfile::tempdir().unwrap();
    let fmu = |name: &str, text: String| {
        Fmu::new(place.path(), name)
            .file("modelDescription.xml", text)
            .finish()
    };
    let mut entities = String::from("<?xml version=\"1.0\"?><!DOCTYPE a [<!ENTITY l0 \"lol\">");
    for level in 1..12 {
        let inner = format!("&l{};", level - 1).repeat(10);
        write!(entities, "<!ENTITY l{level} \"{inner}\">").unwrap();
    }
    let lol = fmu(
        "entities",
        format!("{entities}]>{}", description("&l11;", "")),
    );
    refused(&lol, true, &["not sound XML"]);
    let outside = "<?xml version=\"1.0\"?><!DOCTYPE a [<!ENTITY x SYSTEM \"file:///etc/passwd\">]>";
    refused(
        &fmu("outside", format!("{outside}{}", description("&x;", ""))),
        true,
        &["not sound XML"],
    );
    let mut variables = String::new();
    for number in 0..1_000_000 {
        write!(
            variables,
            "<Float64 name=\"v{number}\" valueReference=\"{}\"/>",
            number + 3
        )
        .unwrap();
    }
    refused(
        &fmu("variables", description("{0}", &variables)),
        true,
        &["more than"],
    );
    let deep = format!("{}{}", "<a>".repeat(400_000), "</a>".repeat(400_000));
    refused(
        &fmu("deep", description("{0}", &deep)),
        true,
        &["not sound XML", "deep"],
    );
    let mut wide = String::from("<Float64 name=\"w\" valueReference=\"9\"");
    for number in 0..200_000 {
        write!(wide, " a{number}=\"\"").unwrap();
    }
    refused(
        &fmu("wide", description("{0}", &format!("{wide}/>"))),
        true,
        &["attributes"],
    );
    let mut small = String::new();
    (0..2_000_000).for_each(|_| small.push_str("<a/>"));
    refused(
        &fmu("small", description("{0}", &small)),
        true,
        &["not sound XML"],
    );
}

#[test]
fn binaries_that_are_not_ours() {
    let place = tempfile::tempdir().unwrap();
    let component = Component::new(REDUCED_RIG).unwrap();
    let token = component.token.to_str().unwrap();
    let library = fs::read(library::beside_program().unwrap()).unwrap();
    let fmu = |name: &str, token: &str, place_of_binary: &str, binary: &[u8]| {
        Fmu::new(place.path(), name)
            .file("modelDescription.xml", description(token, ""))
            .file("resources/model.toml", REDUCED_RIG)
            .file(place_of_binary, binary)
            .finish()
    };
    let wrong = fmu(
        "token",
        "{00000000-0000-0000-0000-000000000000}",
        BINARY,
        &library,
    );
    refused(&wrong, false, &["token"]);
    refused(
        &fmu("text", token, BINARY, b"not a binary"),
        false,
        &["not a shared library"],
    );
    let mut half = library.clone();
    half.truncate(library.len() / 2);
    refused(
        &fmu("half", token, BINARY, &half),
        false,
        &["cut off", "not a shared library"],
    );
    // The same file for another processor: the ELF header's machine is AArch64 instead of x86-64.
    let mut foreign = library.clone();
    foreign[18..20].copy_from_slice(&183_u16.to_le_bytes());
    refused(
        &fmu("foreign", token, BINARY, &foreign),
        false,
        &["for the processor"],
    );
    let elsewhere = "binaries/aarch64-darwin/ReducedRig.dylib";
    refused(
        &fmu("elsewhere", token, elsewhere, &library),
        false,
        &["there is none for"],
    );
}
