//! Files under adverse conditions: killed writers, full disks, odd names, links.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail")]

use std::fs::{self, Permissions};
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use stress_tests::component::REDUCED_RIG;
use stress_tests::kills::kills;
use stress_tests::library;
use stress_tests::program::{Files, command, files, find};

fn source_tree() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
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
    let paths = [("model", model), ("out", out)];
    let mut command = command("build-fmu {model} --out {out}", &paths).unwrap();
    command.output().unwrap()
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

const AT: &str = "--speed-rpm 55 --normal-force 50";

/// Lines of commands that write.
const WRITERS: [&str; 9] = [
    "build-fmu {model} --out {out}",
    "build-fmu ssp {model} {controller} --out {out}",
    "stickslip build {model} --out {out}",
    "stickslip simulate {model} {at} --duration 2 --out {out}",
    "stickslip map --speed-rpm 20:60:6 --normal-force 0:70:6 --out {out} {model}",
    "stickslip closed-loop {model} --controller {controller} {at} --duration 2 --out {out}",
    "stickslip cross-check {model} {at} --duration 2 --out {out}",
    "stickslip experiment run fig-3.5 --document {out}/reproduction.md --out {out}",
    "stickslip locate {case} --out {out}",
];

/// Runs a writer into `out`, with no file larger than so many KiB if there is a limit.
fn run_writer(writer: &str, model: &Path, out: &Path, limit: Option<u32>) -> Output {
    let controller = source_tree().join("modelDescription/soft-torque.toml");
    let case = source_tree().join("crates/workbench/tests/data/unbalance");
    let paths = [
        ("model", model),
        ("controller", &controller),
        ("case", &case),
        ("out", out),
    ];
    let writer = command(&writer.replace("{at}", AT), &paths).unwrap();
    // The limit of a file's size acts as a disk that is full from there on; the signal is ignored so that the program is
    // told and not killed.
    let limit = limit.map_or(String::new(), |limit| format!("ulimit -f {limit}; "));
    let mut bash = Command::new("bash");
    bash.args(["-c", &format!("trap '' XFSZ; {limit}exec \"$@\""), "bash"])
        .arg(writer.get_program())
        .args(writer.get_args());
    bash.output().unwrap()
}

/// Every file below a folder, hidden ones too.
fn contents(folder: &Path) -> Files {
    files(folder, true).unwrap()
}

#[test]
fn a_full_disk_leaves_the_old_files_and_no_rest() {
    let place = tempfile::tempdir().unwrap();
    let model = model(place.path());
    for (number, writer) in WRITERS.into_iter().enumerate() {
        let out = place.path().join(number.to_string());
        let whole = run_writer(writer, &model, &out, None);
        assert!(
            matches!(whole.status.code(), Some(0 | 1)),
            "{writer}: {}",
            said(&whole)
        );
        let before = contents(&out);
        assert!(!before.is_empty(), "{writer} writes nothing");
        let output = run_writer(writer, &model, &out, Some(1));
        assert_eq!(output.status.code(), Some(2), "{writer}: {}", said(&output));
        assert!(said(&output).contains("too large"), "{}", said(&output));
        let mut after = contents(&out);
        // A journal of what was finished is kept, so that the next run goes on from there.
        after.retain(|path, _| path.extension().is_none_or(|end| end != "journal"));
        assert!(after == before, "{writer}: {:?}", after.keys());
    }
}

/// Copies of the programs where every user may run them, and a command that runs one as a user who may not write
/// everywhere: root may, so that another one is taken for it.
fn as_a_user(place: &Path, program: &str) -> Command {
    let open = Permissions::from_mode(0o755);
    fs::set_permissions(place, open.clone()).unwrap();
    let bin = place.join("bin");
    fs::create_dir_all(&bin).unwrap();
    let library = library::beside_program().unwrap();
    for file in [
        find("stickslip").unwrap(),
        find("build-fmu").unwrap(),
        library,
    ] {
        let copy = bin.join(file.file_name().unwrap());
        fs::copy(&file, &copy).unwrap();
        fs::set_permissions(copy, open.clone()).unwrap();
    }
    let user = Command::new("id").arg("-u").output().unwrap().stdout;
    if user.starts_with(b"0\n") {
        let mut command = Command::new("setpriv");
        command
            .args(["--reuid=65534", "--regid=65534", "--clear-groups"])
            .arg(bin.join(program));
        return command;
    }
    Command::new(bin.join(program))
}

#[test]
fn folders_that_may_only_be_read_are_named_and_stay_as_they_are() {
    let place = tempfile::tempdir().unwrap();
    let model = model(place.path());
    let out = place.path().join("out");
    assert!(build(&model, &out).status.success());
    fs::set_permissions(&out, Permissions::from_mode(0o555)).unwrap();
    let before = contents(&out);
    let at = ["--speed-rpm", "55", "--normal-force", "50"];
    let spans = ["--speed-rpm", "20:60:2", "--normal-force", "0:70:2"];
    for (program, arguments) in [
        ("build-fmu", &[][..]),
        ("stickslip", &[&["simulate"], &at[..]].concat()),
        ("stickslip", &[&["map"], &spans[..]].concat()),
    ] {
        for out in [out.clone(), out.join("below")] {
            let mut command = as_a_user(place.path(), program);
            command.args(arguments).arg(&model).arg("--out").arg(&out);
            let output = command.output().unwrap();
            let text = said(&output);
            assert_eq!(
                output.status.code(),
                Some(2),
                "{program} {arguments:?}: {text}"
            );
            let reason = text.contains(out.to_str().unwrap()) && text.contains("denied");
            assert!(reason, "{program} {arguments:?}: {text}");
        }
    }
    assert!(contents(&out) == before);
    fs::set_permissions(&out, Permissions::from_mode(0o755)).unwrap();
}

#[test]
fn targets_that_exist_are_replaced_if_they_are_files_and_left_alone_if_not() {
    let place = tempfile::tempdir().unwrap();
    let model = model(place.path());
    let plain = place.path().join("plain");
    assert!(build(&model, &plain).status.success());
    let name = "ReducedRig.fmi2.fmu";
    let expected = fs::read(plain.join(name)).unwrap();

    let out = place.path().join("out");
    fs::create_dir(&out).unwrap();
    fs::write(out.join(name), "an older file").unwrap();
    fs::set_permissions(out.join(name), Permissions::from_mode(0o444)).unwrap();
    assert!(build(&model, &out).status.success());
    assert_eq!(fs::read(out.join(name)).unwrap(), expected);

    // A link gives way to the file; what it leads to is not written to.
    let elsewhere = place.path().join("elsewhere");
    fs::write(&elsewhere, "kept").unwrap();
    fs::remove_file(out.join(name)).unwrap();
    symlink(&elsewhere, out.join(name)).unwrap();
    assert!(build(&model, &out).status.success());
    assert_eq!(fs::read(out.join(name)).unwrap(), expected);
    assert_eq!(fs::read_to_string(&elsewhere).unwrap(), "kept");

    fs::remove_file(out.join(name)).unwrap();
    fs::create_dir(out.join(name)).unwrap();
    fs::write(out.join(name).join("within"), "kept").unwrap();
    let output = build(&model, &out);
    assert_eq!(output.status.code(), Some(2), "{}", said(&output));
    assert!(said(&output).contains(name), "{}", said(&output));
    assert_eq!(fs::read(out.join(name).join("within")).unwrap(), b"kept");
    assert!(names(&out).iter().all(|name| !name.starts_with('.')));
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

/// Nested folders whose path has so many characters.
fn folders(length: usize) -> PathBuf {
    let (whole, rest) = (length / 200, length % 200);
    let names = std::iter::repeat_n("x".repeat(199), whole);
    // The last one takes what is left, and the stroke that no folder follows.
    let mut path: PathBuf = names.collect();
    if rest > 0 {
        path.push("x".repeat(rest));
    } else {
        path.as_mut_os_string().push("x");
    }
    path
}

#[test]
fn odd_names_work_like_any_other() {
    let place = tempfile::tempdir().unwrap();
    let plain = place.path().join("plain");
    assert!(build(&model(place.path()), &plain).status.success());
    let expected = fs::read(plain.join("ReducedRig.fmi2.fmu")).unwrap();
    // The system's own limit is 4,096.
    let mut longest = 0;
    let around = place.path().join("out/ReducedRig.fmi2.fmu");
    let long = folders(4000 - around.as_os_str().len() - 1);
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
        longest = longest.max(fmu.as_os_str().len());
        assert_eq!(fs::read(&fmu).unwrap(), expected, "{}", folder.display());
        let run = folder.join("run");
        let line = format!("stickslip simulate {{fmu}} {AT} --duration 1 --out {{out}}");
        let mut simulate = command(&line, &[("fmu", &fmu), ("out", &run)]).unwrap();
        let output = simulate.output().unwrap();
        assert!(
            output.status.success(),
            "{}: {}",
            folder.display(),
            said(&output)
        );
        assert!(run.join("result.csv").is_file());
    }
    assert_eq!(longest, 4000);
    let too_long = place.path().join("x".repeat(4000));
    let output = build(&place.path().join("model.toml"), &too_long);
    assert_eq!(output.status.code(), Some(2));
    assert!(said(&output).contains("too long"), "{}", said(&output));
}
