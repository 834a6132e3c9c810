//! The axis as an FMU: compiled with rustc, packed with its description.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::Write as _;
use std::path::Path;
use std::process::Command;

use zip::ZipWriter;
use zip::write::SimpleFileOptions;

use crate::error::MakerError;

/// Name of its file beside the cases.
pub const FILE: &str = "axis.fmu";
const SOURCE: &str = include_str!("../fmu/axis.rs");
/// Name, causality, unit and start value of the variables, in the order of their references.
const VARIABLES: [(&str, &str, &str, f64); 10] = [
    ("voltage", "input", "V", 0.0),
    ("torque", "input", "N.m", 0.0),
    ("phi", "output", "rad", 0.0),
    ("w", "output", "rad/s", 0.0),
    ("J", "parameter", "kg.m2", 0.02),
    ("R", "parameter", "Ohm", 2.0),
    ("k", "parameter", "N.m/A", 0.5),
    ("d", "parameter", "N.m.s/rad", 0.01),
    ("m", "parameter", "N.m", 0.6),
    ("friction", "parameter", "N.m", 0.0),
];

/// Compiles and packs the FMU into `directory`.
///
/// # Errors
/// There is no rustc, or a file cannot be written.
pub fn write(directory: &Path) -> Result<(), MakerError> {
    let wrong = |what: String| MakerError::Fmu(what);
    let at =
        |path: &Path, error: &dyn std::fmt::Display| wrong(format!("{}: {error}", path.display()));
    fs::create_dir_all(directory).map_err(|error| at(directory, &error))?;
    let source = directory.join("axis.rs");
    let binary = directory.join("axis.binary");
    fs::write(&source, SOURCE).map_err(|error| at(&source, &error))?;
    let compiler = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let compiled = Command::new(&compiler)
        .args(["--edition", "2024", "--crate-type", "cdylib", "-O", "-o"])
        .args([&binary, &source])
        .status();
    let _ = fs::remove_file(&source);
    if !compiled
        .as_ref()
        .is_ok_and(std::process::ExitStatus::success)
    {
        return Err(wrong(format!(
            "{}: {compiled:?}; rustc compiles the FMU: put it into the PATH, or name it in RUSTC",
            compiler.display()
        )));
    }
    let library = fs::read(&binary).map_err(|error| at(&binary, &error))?;
    let _ = fs::remove_file(&binary);
    let path = directory.join(FILE);
    let packed = || -> Result<(), Box<dyn std::error::Error>> {
        let mut archive = ZipWriter::new(File::create(&path)?);
        archive.start_file("modelDescription.xml", SimpleFileOptions::default())?;
        archive.write_all(description().as_bytes())?;
        archive.start_file(binary_name(), SimpleFileOptions::default())?;
        archive.write_all(&library)?;
        archive.finish()?;
        Ok(())
    };
    packed().map_err(|error| at(&path, &error))
}

fn binary_name() -> String {
    let system = match std::env::consts::OS {
        "macos" => "darwin",
        "windows" => "win",
        other => other,
    };
    let end = std::env::consts::DLL_EXTENSION;
    format!("binaries/{system}{}/Axis.{end}", usize::BITS)
}

fn description() -> String {
    let units: BTreeSet<&str> = VARIABLES.iter().map(|(_, _, unit, _)| *unit).collect();
    let units: String = units
        .iter()
        .map(|unit| format!("<Unit name=\"{unit}\"/>"))
        .collect();
    let mut text = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiModelDescription fmiVersion=\"2.0\" modelName=\"Axis\" guid=\"{{axis}}\">\n\
         <CoSimulation modelIdentifier=\"Axis\" canHandleVariableCommunicationStepSize=\"true\"/>\n\
         <UnitDefinitions>{units}</UnitDefinitions>\n<ModelVariables>\n"
    );
    for (reference, (name, causality, unit, start)) in VARIABLES.iter().enumerate() {
        let further = match *causality {
            "output" => " initial=\"exact\"",
            "parameter" => " variability=\"fixed\"",
            _ => "",
        };
        let _ = writeln!(
            text,
            "<ScalarVariable name=\"{name}\" valueReference=\"{reference}\" causality=\"{causality}\"{further}>\
             <Real unit=\"{unit}\" start=\"{start}\"/></ScalarVariable>"
        );
    }
    let outputs = (1..).zip(&VARIABLES);
    let outputs: String = outputs
        .filter(|(_, (_, causality, ..))| *causality == "output")
        .map(|(index, _)| format!("<Unknown index=\"{index}\"/>"))
        .collect();
    text + &format!(
        "</ModelVariables>\n<ModelStructure><Outputs>{outputs}</Outputs></ModelStructure>\n</fmiModelDescription>\n"
    )
}
