//! FMUs that follow the rules of zip and XML and yet would cost minutes or gigabytes: each is quadratic in something.

use std::fmt::Write as _;
use std::fs;
use std::io::Write as _;
use std::os::unix::fs::symlink;
use std::process::Command;

use stress_tests::component::{Component, REDUCED_RIG};
use stress_tests::library;
use zip::CompressionMethod;
use zip::write::SimpleFileOptions;

use crate::fmu::{BINARY, CHECK, Fmu, cheap, described, description, refused};

/// A text repeated with its number until it has so many bytes.
fn repeated(bytes: usize, piece: impl Fn(usize) -> String) -> String {
    let mut text = String::new();
    let mut number = 0;
    while text.len() < bytes {
        text += &piece(number);
        number += 1;
    }
    text
}

#[test]
fn archives_of_many_or_large_files() {
    let place = tempfile::tempdir().unwrap();
    let sound = description("{0}", "");
    let stored = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);

    // Every file is read: none may cost as much as the whole archive.
    let mut many = Fmu::new(place.path(), "many").file("modelDescription.xml", &sound);
    let padding = vec![7; 1000];
    for number in 0..9_000 {
        let name = format!("resources/{number}");
        many.writer.start_file(name, stored).unwrap();
        many.writer.write_all(&padding).unwrap();
    }
    refused(&many.finish(), false, &["there is none for"]);

    // No library, but as large as one.
    let mut large = Fmu::new(place.path(), "large").file("modelDescription.xml", &sound);
    large.writer.start_file(BINARY, stored).unwrap();
    let block = vec![1; 1 << 20];
    (0..120).for_each(|_| large.writer.write_all(&block).unwrap());
    refused(
        &large.finish(),
        false,
        &["not a shared library", "are not read"],
    );

    // Just below every limit, and 180 times as large on the disk as in the archive.
    let mut dense = Fmu::new(place.path(), "dense").file("modelDescription.xml", &sound);
    let zeros = vec![0; (16 << 20) - 1];
    for number in 0..15 {
        let name = format!("resources/{number}");
        dense
            .writer
            .start_file(name, crate::fmu::deflated())
            .unwrap();
        dense.writer.write_all(&zeros).unwrap();
    }
    refused(&dense.finish(), false, &["there is none for"]);

    // Names of a thousand folders each.
    let mut deep = Fmu::new(place.path(), "deep").file("modelDescription.xml", &sound);
    for number in 0..900 {
        let name = format!("{number}/{}", "a/".repeat(1000));
        deep.writer.add_directory(name, stored).unwrap();
    }
    refused(&deep.finish(), true, &["folders"]);

    let mut long = Fmu::new(place.path(), "long").file("modelDescription.xml", &sound);
    for number in 0..1000 {
        let name = format!("{number}{}", "a".repeat(60_000));
        long.writer.start_file(name, stored).unwrap();
    }
    refused(&long.finish(), true, &["directory has"]);
}

#[test]
fn reference_results_at_the_limits() {
    const FOLDER: &str = "extra/org.fmi-standard.fmi-ls-ref";
    let place = tempfile::tempdir().unwrap();
    let sound = description("{0}", "");
    let manifest = |related: &str| {
        format!(
            "<fmiReferences xmlns:l=\"http://fmi-standard.org/fmi-ls-manifest\" l:fmi-ls-name=\"org.fmi-standard.fmi-ls-ref\" \
             l:fmi-ls-version=\"1.0.0\" l:fmi-ls-description=\"related files\">{related}</fmiReferences>"
        )
    };
    let one = "<Related source=\"a.exp\" role=\"experiment\"/>";
    let experiment =
        |n: usize| format!("<Experiment name=\"{n}\"><References source=\"r.csv\"/></Experiment>");
    let fmu = |name: &str, related: &str, experiments: &str, table: &str| {
        Fmu::new(place.path(), name)
            .file("modelDescription.xml", &sound)
            .file(&format!("{FOLDER}/fmi-ls-manifest.xml"), manifest(related))
            .file(
                &format!("{FOLDER}/a.exp"),
                format!("<Experiments name=\"a\">{experiments}</Experiments>"),
            )
            .file(&format!("{FOLDER}/r.csv"), table)
            .finish()
    };
    let below = (15 << 20) - 2000;
    let columns = repeated(below, |n| format!(",v{n}"));
    let rows = format!("time,u\n{}", repeated(below, |n| format!("{n},1\n")));
    let many = repeated((1 << 20) - 2000, experiment);
    for path in [
        fmu("columns", one, &experiment(0), &format!("time{columns}\n")),
        fmu("rows", one, &experiment(0), &rows),
        fmu("experiments", one, &many, "time,u\n0,0\n"),
        fmu("related", &one.repeat(999), &many, &rows),
        fmu("manifest", &repeated(below, |_| one.to_owned()), "", ""),
    ] {
        refused(&path, false, &["there is none for"]);
    }
    let mut folders = Fmu::new(place.path(), "folders").file("modelDescription.xml", &sound);
    for number in 0..2_000 {
        let name = format!("extra/{number}/fmi-ls-manifest.xml");
        folders = folders.file(&name, manifest(one));
    }
    refused(&folders.finish(), false, &["there is none for"]);
}

#[test]
fn files_that_are_none() {
    let place = tempfile::tempdir().unwrap();
    let pipe = place.path().join("pipe.fmu");
    assert!(
        Command::new("mkfifo")
            .arg(&pipe)
            .status()
            .unwrap()
            .success()
    );
    let device = place.path().join("device.fmu");
    symlink("/dev/zero", &device).unwrap();
    let folder = place.path().join("folder.fmu");
    fs::create_dir(&folder).unwrap();
    for path in [pipe, device, folder] {
        refused(&path, true, &["it is no file"]);
    }
    let circle = place.path().join("circle.fmu");
    symlink(&circle, &circle).unwrap();
    refused(&circle, true, &["symbolic links"]);
}

#[test]
fn descriptions_at_the_limits() {
    let place = tempfile::tempdir().unwrap();
    let below = (16 << 20) - 2000;
    let variables = |piece: fn(usize) -> String| description("{0}", &repeated(below, piece));

    let plain = variables(|n| {
        format!(
            "<Float64 name=\"v{n}\" valueReference=\"{}\" causality=\"output\"/>\n",
            n + 3
        )
    });
    let attributes = variables(|n| {
        let mut text = format!("<Float64 name=\"v{n}\" valueReference=\"{}\"", n + 3);
        (0..250).for_each(|k| write!(text, " a{k}=\"\"").unwrap());
        text + "/>"
    });
    let elements = variables(|_| "<a/>".repeat(100));
    // Each element inside would get a list of all namespaces around it.
    let mut names = String::from("<a");
    (0..250).for_each(|n| write!(names, " xmlns:n{n}=\"u{n}\"").unwrap());
    let inside = repeated(below - names.len(), |n| {
        format!("<b xmlns:m=\"w{}\"/>", n % 1000)
    });
    let namespaces = description("{0}", &format!("{names}>{inside}</a>"));
    for (name, text, by_info, reasons) in [
        ("plain", plain, false, &["more", "there is none for"][..]),
        ("attributes", attributes, true, &["attributes"]),
        ("elements", elements, true, &["not sound XML", "name"]),
        ("namespaces", namespaces, true, &["namespaces"]),
    ] {
        refused(&described(place.path(), name, &text), by_info, reasons);
    }
}

/// A description with further elements beside its variables.
fn with_sections(before: &str, variables: &str, structure: &str) -> String {
    description("{0}", variables)
        .replace("<ModelVariables>", &format!("{before}<ModelVariables>"))
        .replace(
            "<ModelStructure/>",
            &format!("<ModelStructure>{structure}</ModelStructure>"),
        )
}

#[test]
fn descriptions_whose_parts_name_each_other() {
    let place = tempfile::tempdir().unwrap();
    let third = 5 << 20;
    let plain = repeated(third, |n| {
        format!("<Float64 name=\"v{n}\" valueReference=\"{}\"/>", n + 3)
    });
    let unknowns = repeated(third, |n| {
        format!("<InitialUnknown valueReference=\"{}\"/>", n + 3)
    });

    let list = "3 ".repeat(third);
    let dependent = format!("<Output valueReference=\"3\" dependencies=\"{list}\"/>");

    // As many as the limit on attributes allows.
    let fewer = 3 << 20;
    let units = repeated(fewer, |n| format!("<Unit name=\"u{n}\"/>"));
    let types = repeated(fewer, |n| {
        format!("<Float64Type name=\"t{n}\" unit=\"u{n}\"/>")
    });
    let typed = repeated(fewer, |n| {
        format!(
            "<Float64 name=\"v{n}\" valueReference=\"{}\" declaredType=\"t{n}\"/>",
            n + 3
        )
    });
    let before = format!(
        "<UnitDefinitions>{units}</UnitDefinitions><TypeDefinitions>{types}</TypeDefinitions>"
    );

    let displayed = repeated(third, |n| format!("<DisplayUnit name=\"d{n}\"/>"));
    let using = repeated(third, |n| {
        format!(
            "<Float64 name=\"v{n}\" valueReference=\"{}\" unit=\"u\" displayUnit=\"none\"/>",
            n + 3
        )
    });
    let unit = format!("<UnitDefinitions><Unit name=\"u\">{displayed}</Unit></UnitDefinitions>");

    for (name, text) in [
        ("unknowns", with_sections("", &plain, &unknowns)),
        ("dependent", with_sections("", &plain, &dependent)),
        ("types", with_sections(&before, &typed, "")),
        ("displayed", with_sections(&unit, &using, "")),
    ] {
        let path = described(place.path(), name, &text);
        refused(&path, false, &["there is none for"]);
    }

    // Every interface names a binary that would be loaded.
    let component = Component::new(REDUCED_RIG).unwrap();
    let library = fs::read(library::beside_program().unwrap()).unwrap();
    let interfaces = "<CoSimulation modelIdentifier=\"ReducedRig\"/>".repeat(100_000);
    let text = description(component.token.to_str().unwrap(), "")
        .replace("<ModelVariables>", &format!("{interfaces}<ModelVariables>"));
    let path = Fmu::new(place.path(), "interfaces")
        .file("modelDescription.xml", text)
        .file("binaries/x86_64-linux/Other.so", library)
        .finish();
    refused(&path, false, &["there is none for"]);
}

#[test]
fn other_xml_of_an_fmu() {
    let place = tempfile::tempdir().unwrap();
    let sound = description("{0}", "");
    let large = repeated(20 << 20, |n| format!("<SourceFile name=\"{n}.c\"/>"));
    let listed = repeated(15 << 20, |n| format!("<SourceFile name=\"{n}.c\"/>"));
    let wide = format!("<Icon {}/>", repeated(8 << 20, |n| format!("a{n}=\"\" ")));
    for (name, file, text) in [
        ("large", "sources/buildDescription.xml", &large),
        ("listed", "sources/buildDescription.xml", &listed),
        ("wide", "terminalsAndIcons/terminalsAndIcons.xml", &wide),
    ] {
        let path = Fmu::new(place.path(), name)
            .file("modelDescription.xml", &sound)
            .file(file, text)
            .finish();
        let ended = cheap(CHECK, &[("fmu", &path)]);
        assert_eq!(ended.status.code(), Some(1), "{name}: {}", ended.said);
    }
}
