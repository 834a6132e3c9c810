//! FMUs to be refused, and a look at how they are.

use std::fs::File;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use stress_tests::program;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

/// Processor time that a refusal may take [s].
pub const SECONDS: f64 = 2.0;
/// Memory that a refusal may take [MiB].
pub const MEBIBYTES: f64 = 200.0;

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

/// Gives the FMU to every command that opens one, and looks at what they say and take; to `info`, which runs nothing in it,
/// only where that is to refuse it too.
pub fn refused(fmu: &Path, by_info: bool, reasons: &[&str]) {
    let out = fmu.with_extension("out");
    let stickslip = program::find("stickslip").unwrap();
    let mut simulate = Command::new(&stickslip);
    simulate
        .arg("simulate")
        .arg(fmu)
        .args(["--speed-rpm", "55", "--normal-force", "50", "--out"])
        .arg(&out);
    let mut closed_loop = Command::new(&stickslip);
    closed_loop
        .arg("closed-loop")
        .arg(fmu)
        .arg("--controller")
        .arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../modelDescription/soft-torque.toml"))
        .args(["--speed-rpm", "55", "--normal-force", "50", "--out"])
        .arg(&out);
    let mut check = Command::new(program::find("build-fmu").unwrap());
    check.arg("check").arg(fmu);
    let mut info = Command::new(&stickslip);
    info.arg("info").arg(fmu);
    let mut commands = vec![("simulate", simulate, 2), ("closed-loop", closed_loop, 2)];
    if by_info {
        commands.push(("info", info, 2));
    }
    commands.push(("check", check, 1));
    for (name, mut command, code) in commands {
        let ended = program::run(&mut command).unwrap();
        let found = ended.status.code();
        assert!(
            found == Some(code) || name == "check" && found == Some(2),
            "{name} {}: {:?}\n{}",
            fmu.display(),
            ended.status,
            ended.said
        );
        let reason = name == "check" || reasons.iter().any(|reason| ended.said.contains(reason));
        assert!(reason, "{name} {}: {}", fmu.display(), ended.said);
        assert!(
            ended.seconds < SECONDS && ended.mebibytes < MEBIBYTES,
            "{name} {}: {} s, {} MiB",
            fmu.display(),
            ended.seconds,
            ended.mebibytes
        );
    }
    assert!(!out.exists(), "something was written for {}", fmu.display());
}
