//! FMUs made to do harm, given to every command that opens one: refused with a reason, in no time and little memory.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail")]

mod costly;
mod fmu;

use std::fmt::Write as _;
use std::fs;
use std::io::Write as _;
use std::path::Path;

use fmu::{BINARY, Fmu, deflated, described, description, refused};
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
    let whole = described(folder, "cut", &sound);
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
    let mut entities = String::from("<?xml version=\"1.0\"?><!DOCTYPE a [<!ENTITY l0 \"lol\">");
    for level in 1..12 {
        let inner = format!("&l{};", level - 1).repeat(10);
        write!(entities, "<!ENTITY l{level} \"{inner}\">").unwrap();
    }
    let entities = format!("{entities}]>{}", description("&l11;", ""));
    let outside = format!(
        "<?xml version=\"1.0\"?><!DOCTYPE a [<!ENTITY x SYSTEM \"file:///etc/passwd\">]>{}",
        description("&x;", "")
    );
    let variable = |n: usize| format!("<Float64 name=\"v{n}\" valueReference=\"{}\"/>", n + 3);
    let variables: String = (0..1_000_000).map(variable).collect();
    let deep = format!("{}{}", "<a>".repeat(400_000), "</a>".repeat(400_000));
    let attributes: String = (0..200_000).map(|n| format!(" a{n}=\"\"")).collect();
    let wide = format!("<Float64 name=\"w\" valueReference=\"9\"{attributes}/>");
    let unsound = &["not sound XML"][..];
    for (name, text, reasons) in [
        ("entities", entities, unsound),
        ("outside", outside, unsound),
        ("variables", description("{0}", &variables), &["more than"]),
        (
            "deep",
            description("{0}", &deep),
            &["not sound XML", "deep"],
        ),
        ("wide", description("{0}", &wide), &["attributes"]),
        (
            "small",
            description("{0}", &"<a/>".repeat(2_000_000)),
            unsound,
        ),
    ] {
        refused(&described(place.path(), name, &text), true, reasons);
    }
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
    let half = &library[..library.len() / 2];
    // The same file for another processor: the ELF header's machine is AArch64 instead of x86-64.
    let mut foreign = library.clone();
    foreign[18..20].copy_from_slice(&183_u16.to_le_bytes());
    let other_token = "{00000000-0000-0000-0000-000000000000}";
    let elsewhere = "binaries/aarch64-darwin/ReducedRig.dylib";
    let no_library = "not a shared library";
    for (fmu, reasons) in [
        (fmu("token", other_token, BINARY, &library), &["token"][..]),
        (fmu("text", token, BINARY, b"not a binary"), &[no_library]),
        (fmu("half", token, BINARY, half), &["cut off", no_library]),
        (
            fmu("foreign", token, BINARY, &foreign),
            &["for the processor"],
        ),
        (
            fmu("elsewhere", token, elsewhere, &library),
            &["there is none for"],
        ),
    ] {
        refused(&fmu, false, reasons);
    }
}
