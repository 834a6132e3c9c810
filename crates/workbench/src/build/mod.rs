//! `stickslip build`: packs a model into FMUs.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::bail;

use build_fmu::build::Source;
use build_fmu::library;
use build_fmu::platform::{FmiVersion, Platform};
use clap::{Args, ValueEnum};

use crate::diagnose::small_plant::fmu::wrapper;
use crate::diagnose::small_plant::model_file::SmallModel;
use crate::outcome::Outcome;
use stickslip::body::{Kind, Reader};

/// Packs a model.toml and the prebuilt library into FMUs, or an FMU and the effects of its ports file into one.
#[derive(Debug, Args)]
pub struct BuildArguments {
    /// Model or ports file (.toml).
    pub model: PathBuf,
    /// Directory for the FMUs.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Version of the standard; both if not given.
    #[arg(long, value_enum, value_name = "VERSION")]
    pub fmi: Option<Version>,
    /// Pack the library for this platform (`linux64`, `win64`, `aarch64-linux`, …) from `platforms/` beside this
    /// program; may be repeated. Without it all that are there, and around another tool's FMU that of this machine.
    #[arg(long = "platform", value_name = "PLATFORM")]
    pub platforms: Vec<Platform>,
    /// A library to pack, for the platform that its header names; may be repeated. Without it those beside this program.
    #[arg(long = "library", value_name = "FILE")]
    pub libraries: Vec<PathBuf>,
}

/// Version of the FMI standard.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Version {
    /// FMI 2.0.
    #[value(name = "2")]
    Two,
    /// FMI 3.0.
    #[value(name = "3")]
    Three,
}

/// Runs the subcommand.
///
/// # Errors
/// Whatever is wrong with the model or the library.
pub fn command(arguments: &BuildArguments) -> anyhow::Result<Outcome> {
    if let Some(text) = ports(&arguments.model) {
        return around(arguments, &text);
    }
    let source = Source::read(&arguments.model)?;
    let libraries = library::select(&arguments.platforms, &arguments.libraries)?;
    let versions = match arguments.fmi {
        Some(Version::Two) => vec![FmiVersion::Fmi2],
        Some(Version::Three) => vec![FmiVersion::Fmi3],
        None => FmiVersion::ALL.to_vec(),
    };
    for version in versions {
        let built = source.build(&libraries, version, &arguments.out)?;
        println!("{built}");
        if let Some(reason) = built.without_reference {
            println!("  without reference results: {reason}");
        }
    }
    Ok(Outcome::Done)
}

/// The text of a ports file.
fn ports(file: &Path) -> Option<String> {
    let text = fs::read_to_string(file).ok()?;
    let plant = Reader::new(&text, "").ok()?.plant().ok()?;
    (plant.kind == Kind::Fmu).then_some(text)
}

/// Packs an FMU with the effects that its ports file has.
fn around(arguments: &BuildArguments, text: &str) -> anyhow::Result<Outcome> {
    let file = arguments.model.display().to_string();
    let model = SmallModel::parse(text, &file)?;
    if arguments.fmi.is_some() {
        bail!("{file}: an FMU with effects has the version of the one inside; leave --fmi out");
    }
    let libraries = library::select_wrappers(&arguments.platforms, &arguments.libraries)?;
    let directory = arguments.model.parent().unwrap_or(Path::new(""));
    let built = wrapper::build(&model, &file, directory, libraries, &arguments.out)?;
    println!(
        "{} ({} KiB)",
        built.path.display(),
        built.size.div_ceil(1024)
    );
    for name in built.left_out {
        eprintln!("note: {name} is an effect of the readings; the FMU does not have it");
    }
    Ok(Outcome::Done)
}
