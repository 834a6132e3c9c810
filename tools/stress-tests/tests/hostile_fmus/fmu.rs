//! FMUs to be refused, and a look at how they are.

use std::fs::File;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use stress_tests::program::{self, Ended};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

/// Processor time that a refusal may take [s].
const SECONDS: f64 = 2.0;
/// Memory that a refusal may take [MiB].
const MEBIBYTES: f64 = 200.0;

pub const BINARY: &str = "binaries/x86_64-linux/ReducedRig.so";

/// An FMI 3.0 description with further variables.
pub fn description(token: &str, variables: &str) -> String {
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiModelDescription fmiVersion=\"3.0\" modelName=\"Rig\" \
         instantiationToken=\"{token}\"><CoSimulation modelIdentifier=\"ReducedRig\"/><ModelVariables>\
         <Float64 name=\"time\" valueReference=\"0\" causality=\"independent\" variability=\"continuous\"/>\
         <Float64 name=\"u\" valueReference=\"1\" causality=\"input\" start=\"0\"/>\
         <Float64 name=\"N2\" valueReference=\"2\" causality=\"input\" start=\"0\"/>{variables}</ModelVariables>\
         <ModelStructure/></fmiModelDescription>"
    )
}

pub fn deflated() -> SimpleFileOptions {
    SimpleFileOptions::default().compression_method(CompressionMethod::Deflated)
}

/// An FMU that is being written.
pub struct Fmu {
    path: PathBuf,
    pub writer: ZipWriter<File>,
}

impl Fmu {
    pub fn new(folder: &Path, name: &str) -> Self {
        let path = folder.join(format!("{name}.fmu"));
        let writer = ZipWriter::new(File::create(&path).unwrap());
        Self { path, writer }
    }

    pub fn file(mut self, name: &str, content: impl AsRef<[u8]>) -> Self {
        self.writer.start_file(name, deflated()).unwrap();
        self.writer.write_all(content.as_ref()).unwrap();
        self
    }

    pub fn finish(self) -> PathBuf {
        self.writer.finish().unwrap();
        self.path
    }
}

/// An FMU of nothing but a description.
pub fn described(folder: &Path, name: &str, description: &str) -> PathBuf {
    Fmu::new(folder, name)
        .file("modelDescription.xml", description)
        .finish()
}

/// Gives the FMU to every command that opens one, and looks at what they say and take; to `info`, which runs nothing in it,
/// only where that is to refuse it too.
pub fn refused(fmu: &Path, by_info: bool, reasons: &[&str]) {
    let out = fmu.with_extension("out");
    let controller =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../modelDescription/soft-torque.toml");
    let at = "--speed-rpm 55 --normal-force 50 --out {out}";
    let paths = [
        ("fmu", fmu),
        ("out", out.as_path()),
        ("controller", controller.as_path()),
    ];
    let mut lines = vec![
        format!("stickslip simulate {{fmu}} {at}"),
        format!("stickslip closed-loop {{fmu}} --controller {{controller}} {at}"),
    ];
    if by_info {
        lines.push("stickslip info {fmu}".to_owned());
    }
    for line in lines {
        let ended = cheap(&line, &paths);
        assert_eq!(ended.status.code(), Some(2), "{line}\n{}", ended.said);
        let reason = reasons.iter().any(|reason| ended.said.contains(reason));
        assert!(reason, "{line} {}: {}", fmu.display(), ended.said);
    }
    let ended = cheap(CHECK, &paths);
    assert!(
        matches!(ended.status.code(), Some(1 | 2)),
        "check {}: {:?}\n{}",
        fmu.display(),
        ended.status,
        ended.said
    );
    assert!(!out.exists(), "something was written for {}", fmu.display());
}

pub const CHECK: &str = "build-fmu check {fmu}";

/// Runs a command that must end in no time and with little memory.
pub fn cheap(line: &str, paths: &[(&str, &Path)]) -> Ended {
    let ended = program::run(&mut program::command(line, paths).unwrap()).unwrap();
    assert!(
        ended.seconds < SECONDS && ended.mebibytes < MEBIBYTES,
        "{line} {paths:?}: {} s, {} MiB",
        ended.seconds,
        ended.mebibytes
    );
    ended
}
