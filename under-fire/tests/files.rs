//! Files under adverse conditions: killed writers, full disks, odd names, links.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail")]

use std::fs;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use under_fire::component::REDUCED_RIG;
use under_fire::kills::kills;
use under_fire::program::find;

fn source_tree() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

#[test]
fn twenty_kills_leave_whole_files() {
    println!("{}", kills(20, 7, &source_tree(), false).unwrap());
}

fn model(folder: &Path) -> PathBuf {
    let path = folder.join("model.toml");
    fs::write(&path, REDUCED_RIG).unwrap();
    path
}

fn build(model: &Path, out: &Path) -> Output {
    let mut command = Command::new(find("build-fmu").unwrap());
    command.arg(model).arg("--out").arg(out).output().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Names in a folder, hidden ones too.
fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = (fs::read_dir(folder).unwrap())
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

#[test]
fn a_full_disk_leaves_the_old_file_and_no_rest() {
    let place = tempfile::tempdir().unwrap();
    let (model, out) = (model(place.path()), place.path().join("out"));
    assert!(build(&model, &out).status.success());
    let before = fs::read(out.join("ReducedRig.fmi3.fmu")).unwrap();
    let programs = [
        format!(
            "{} {} --out {}",
            find("build-fmu").unwrap().display(),
            model.display(),
            out.display()
        ),
        format!(
            "{} simulate {} --speed-rpm 55 --normal-force 50 --out {}",
            find("stickslip").unwrap().display(),
            model.display(),
            out.join("run").display()
        ),
    ];
    for program in programs {
        // The limit of a file's size acts as a disk that is full after 100 KiB; the signal is ignored so that the
        // program is told and not killed.
        let script = format!("trap '' XFSZ; ulimit -f 100; exec {program}");
        let output = Command::new("bash").args(["-c", &script]).output().unwrap();
        assert_eq!(
            output.status.code(),
            Some(2),
            "{program}: {}",
            said(&output)
        );
        assert!(said(&output).contains("too large"), "{}", said(&output));
    }
    assert_eq!(fs::read(out.join("ReducedRig.fmi3.fmu")).unwrap(), before);
    for folder in [out.clone(), out.join("run")] {
        if folder.exists() {
            let rests: Vec<String> = names(&folder)
                .into_iter()
                .filter(|name| name.starts_with('.'))
                .collect();
            assert!(rests.is_empty(), "{}: {rests:?}", folder.display());
        }
    }
}

#[test]
fn places_that_cannot_be_written_are_named() {
    let place = tempfile::tempdir().unwrap();
    let model = model(place.path());
    let file = place.path().join("file");
    fs::write(&file, "kept").unwrap();
    // A file where a folder should be, and the pseudo file system that nobody can write to, root neither.
    for out in [
        file.clone(),
        file.join("below"),
        PathBuf::from("/proc/nowhere"),
    ] {
        let output = build(&model, &out);
        assert_eq!(output.status.code(), Some(2), "{}", said(&output));
        assert!(
            said(&output).contains(out.to_str().unwrap()),
            "{}",
            said(&output)
        );
    }
    assert_eq!(fs::read_to_string(&file).unwrap(), "kept");
}

#[test]
fn links_that_lead_in_circles_are_named() {
    let place = tempfile::tempdir().unwrap();
    let model = model(place.path());
    let (one, other) = (place.path().join("one"), place.path().join("other"));
    symlink(&one, &other).unwrap();
    symlink(&other, &one).unwrap();
    for output in [build(&one, &place.path().join("out")), build(&model, &one)] {
        assert_eq!(output.status.code(), Some(2), "{}", said(&output));
        assert!(
            said(&output).contains(one.to_str().unwrap()),
            "{}",
            said(&output)
        );
    }
}

#[test]
fn odd_names_work_like_any_other() {
    let place = tempfile::tempdir().unwrap();
    let plain = place.path().join("plain");
    assert!(build(&model(place.path()), &plain).status.success());
    let expected = fs::read(plain.join("ReducedRig.fmi2.fmu")).unwrap();
    // A path of 3,500 characters: 14 folders of 250; the system's own limit is 4,096.
    let long: PathBuf = std::iter::repeat_n("x".repeat(250), 14).collect();
    for name in [
        PathBuf::from("with  spaces"),
        PathBuf::from("ümläut-日本語-🎻"),
        PathBuf::from("a'b\"c$d%20e#f;g&h"),
        long,
    ] {
        let folder = place.path().join(name);
        fs::create_dir_all(&folder).unwrap();
        let output = build(&model(&folder), &folder.join("out"));
        assert!(
            output.status.success(),
            "{}: {}",
            folder.display(),
            said(&output)
        );
        let fmu = folder.join("out/ReducedRig.fmi2.fmu");
        assert_eq!(fs::read(&fmu).unwrap(), expected, "{}", folder.display());
        let mut simulate = Command::new(find("stickslip").unwrap());
        simulate.arg("simulate").arg(&fmu).args([
            "--speed-rpm",
            "55",
            "--normal-force",
            "50",
            "--duration",
            "1",
            "--out",
        ]);
        let output = simulate.arg(folder.join("run")).output().unwrap();
        assert!(
            output.status.success(),
            "{}: {}",
            folder.display(),
            said(&output)
        );
        assert!(folder.join("run/result.csv").is_file());
    }
    let too_long = place.path().join("x".repeat(4000));
    let output = build(&place.path().join("model.toml"), &too_long);
    assert_eq!(output.status.code(), Some(2));
    assert!(said(&output).contains("too long"), "{}", said(&output));
}
