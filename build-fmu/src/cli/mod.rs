//! The command line of `build-fmu`: packs a `model.toml` and the prebuilt library into FMUs, and checks FMUs.

use std::ffi::OsString;
use std::io::Write;
use std::path::PathBuf;

use crate::archive::write_atomically;
use crate::build::{Reference, Source};
use crate::explain::explain;
use crate::library;
use crate::lint::{self, Loading, Package};
use crate::platform::{FmiVersion, Platform};
use crate::ssp::{self, SspVersion, System};
use anyhow::Context;
use clap::{Args, CommandFactory, Parser, Subcommand, ValueEnum};
use clap_complete::Shell;

/// Exit code for wrong usage or input; 1 is kept for checks that say no.
const INPUT_ERROR: u8 = 2;

/// Packs a model.toml and the prebuilt stickslip library into FMI 2.0 and FMI 3.0 FMUs.
#[derive(Debug, Parser)]
#[command(
    name = "build-fmu",
    version,
    args_conflicts_with_subcommands = true,
    subcommand_negates_reqs = true,
    after_help = "Example:\n  build-fmu modelDescription/reduced-rig.toml --out out\n\
                  writes out/ReducedRig.fmi2.fmu and out/ReducedRig.fmi3.fmu.\n\
                  build-fmu check out/ReducedRig.fmi2.fmu\n\
                  finds in any FMU what validators miss.\n\
                  build-fmu modelDescription/reduced-rig.toml --platform linux64 --platform win64 --out out\n\
                  packs a binary for each.\n\
                  Needs neither cargo nor a compiler: the library lies beside this program."
)]
struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
    /// The model: a rig with its parts, friction law and effects, or a controller, with their numbers.
    #[arg(required = true)]
    model: Option<PathBuf>,
    /// Folder for the FMUs; made if it is missing.
    #[arg(long, value_name = "DIR", required_unless_present_any = ["print_xml", "write_xml"])]
    out: Option<PathBuf>,
    /// Version of the standard; both if not given.
    #[arg(long, value_enum, value_name = "VERSION")]
    fmi: Option<Version>,
    #[command(flatten)]
    binaries: Binaries,
    /// Value that an input holds in the reference run inside the FMU; may be repeated [default: a share of its nominal].
    #[arg(long, value_name = "NAME=VALUE", value_parser = start_value, conflicts_with = "no_reference")]
    stimulus: Vec<(String, f64)>,
    /// Leave out the reference run, by which users of the FMU can check its import.
    #[arg(long)]
    no_reference: bool,
    /// Print modelDescription.xml instead of building an FMU; needs --fmi.
    #[arg(long, requires = "fmi", conflicts_with_all = ["out", "write_xml"])]
    print_xml: bool,
    /// Write MODEL.fmi2.xml and MODEL.fmi3.xml into a folder instead of building FMUs.
    #[arg(long, value_name = "DIR", conflicts_with = "out")]
    write_xml: Option<PathBuf>,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Find what validators miss in any FMU; exit code 1 if there is anything.
    #[command(after_help = "Example:\n  build-fmu check --no-load Foreign.fmu\n\
                            looks at the files without running the FMU's code.")]
    Check {
        /// The FMUs.
        #[arg(required = true)]
        fmus: Vec<PathBuf>,
        /// Do not load the library: loading runs the FMU's code.
        #[arg(long)]
        no_load: bool,
    },
    /// Pack models with their connections, or a single one, into a system structure archive (SSP).
    #[command(
        after_help = "Example:\n  build-fmu ssp modelDescription/reduced-rig.toml \
                            modelDescription/soft-torque.toml --start omega_ref=5.76 --start N2=50 --out out\n\
                            connects what is called the same: u, theta3_dot, i."
    )]
    Ssp(SystemArguments),
    /// Print the completions of these commands for a shell.
    #[command(
        after_help = "Example:\n  build-fmu completions bash > ~/.local/share/bash-completion/completions/build-fmu"
    )]
    Completions {
        /// The shell.
        shell: Shell,
    },
}

#[derive(Debug, Args)]
struct SystemArguments {
    /// The models; outputs are connected to inputs of the same name.
    #[arg(required = true)]
    models: Vec<PathBuf>,
    /// Start value of a free input or of a parameter; may be repeated.
    #[arg(long, value_name = "NAME=VALUE", value_parser = start_value)]
    start: Vec<(String, f64)>,
    /// Give the system itself connectors for its free inputs and all outputs. FMPy needs them; ecos and
    /// libcosim cannot read them.
    #[arg(long)]
    expose: bool,
    /// Version of the FMUs.
    #[arg(long, value_enum, value_name = "VERSION", default_value = "2")]
    fmi: Version,
    /// Version of the archive's own standard: 1 is read by more programs, 2 knows the types of FMI 3.
    #[arg(long, value_enum, value_name = "VERSION", default_value = "1")]
    ssp: ArchiveVersion,
    #[command(flatten)]
    binaries: Binaries,
    /// Folder for the archive; made if it is missing.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

/// What is packed for which platform.
#[derive(Debug, Args)]
struct Binaries {
    /// Pack the library for this platform; may be repeated [default: all that are there].
    #[arg(
        long = "platform",
        value_name = "PLATFORM",
        long_help = "Pack the library for this platform; may be repeated [default: this machine and all that are there].\n\
                       linux64, win64, aarch64-linux, darwin64, aarch64-darwin, or the names of FMI 3 \
                       (x86_64-windows). Looked for in platforms/PLATFORM/ beside this program, where \
                       `build-fmu/platforms/build PLATFORM` in the source tree puts it"
    )]
    platforms: Vec<Platform>,
    /// A library to pack, for the platform that its header names; may be repeated [default: those beside this program].
    #[arg(long = "library", value_name = "PATH")]
    libraries: Vec<PathBuf>,
}

fn start_value(text: &str) -> Result<(String, f64), String> {
    let needed = "NAME=VALUE is needed, such as N2=50";
    let (name, value) = text.split_once('=').ok_or(needed)?;
    let value = value.trim().parse().map_err(|_| needed)?;
    Ok((name.trim().to_owned(), value))
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Version {
    #[value(name = "2")]
    Two,
    #[value(name = "3")]
    Three,
}

impl From<Version> for FmiVersion {
    fn from(version: Version) -> Self {
        match version {
            Version::Two => FmiVersion::Fmi2,
            Version::Three => FmiVersion::Fmi3,
        }
    }
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum ArchiveVersion {
    #[value(name = "1")]
    One,
    #[value(name = "2")]
    Two,
}

impl From<ArchiveVersion> for SspVersion {
    fn from(version: ArchiveVersion) -> Self {
        match version {
            ArchiveVersion::One => SspVersion::One,
            ArchiveVersion::Two => SspVersion::Two,
        }
    }
}

/// The program: `arguments` are its name and those of the command line; returns the exit code. Usage that is wrong or asks for
/// help ends the process.
pub fn main(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    // A reader such as `head` that has seen enough is no error.
    sigpipe::reset();
    let arguments = Arguments::parse_from(arguments);
    let outcome = match &arguments.command {
        Some(Command::Check { fmus, no_load }) => check(fmus, *no_load),
        Some(Command::Ssp(arguments)) => pack_system(arguments).map(|()| true),
        Some(Command::Completions { shell }) => complete(*shell).map(|()| true),
        None => build(&arguments).map(|()| true),
    };
    match outcome {
        Ok(true) => 0,
        Ok(false) => 1,
        Err(error) => {
            eprintln!("build-fmu: {}", explain(error.as_ref()));
            INPUT_ERROR
        }
    }
}

fn complete(shell: Shell) -> anyhow::Result<()> {
    // Into memory first: what writes to a pipe that is closed would panic.
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Arguments::command(), "build-fmu", &mut script);
    Ok(std::io::stdout().write_all(&script)?)
}

/// Checks FMUs; whether nothing was found.
fn check(fmus: &[PathBuf], no_load: bool) -> anyhow::Result<bool> {
    let loading = if no_load {
        Loading::FilesOnly
    } else {
        Loading::Load
    };
    let mut clean = true;
    for path in fmus {
        let lint::Report { findings, notes } = lint::report(&Package::open(path)?, loading);
        clean &= findings.is_empty();
        match findings.len() {
            0 => println!("{}: nothing found", path.display()),
            count => println!("{}: {count} found", path.display()),
        }
        for finding in findings {
            println!("  {finding}");
        }
        for note in notes {
            println!("  {note}");
        }
    }
    Ok(clean)
}

fn pack_system(arguments: &SystemArguments) -> anyhow::Result<()> {
    let components = arguments
        .models
        .iter()
        .map(|model| Source::read(model))
        .collect::<Result<Vec<_>, _>>()?;
    let mut system = System::new(components)?;
    for (name, value) in &arguments.start {
        system.start(name, *value)?;
    }
    if arguments.expose {
        system.expose();
    }
    let libraries = library::select(&arguments.binaries.platforms, &arguments.binaries.libraries)?;
    let path = ssp::build(
        &system,
        &libraries,
        arguments.fmi.into(),
        arguments.ssp.into(),
        &arguments.out,
    )?;
    println!("{}", path.display());
    Ok(())
}

fn build(arguments: &Arguments) -> anyhow::Result<()> {
    let model = arguments.model.as_deref().context("name a model.toml")?;
    let mut source = Source::read(model)?;
    source.set_reference(if arguments.no_reference {
        Reference::LeftOut
    } else {
        Reference::Run(arguments.stimulus.clone())
    });
    let versions = match arguments.fmi {
        Some(version) => vec![FmiVersion::from(version)],
        None => FmiVersion::ALL.to_vec(),
    };
    if arguments.print_xml {
        for version in versions {
            print!("{}", source.model_description(version)?);
        }
        return Ok(());
    }
    if let Some(folder) = &arguments.write_xml {
        for version in versions {
            let path = folder.join(source.xml_file_name(version));
            write_atomically(&path, source.model_description(version)?.as_bytes())?;
            println!("{}", path.display());
        }
        return Ok(());
    }
    let folder = arguments
        .out
        .as_deref()
        .context("name a folder for the FMUs with --out DIR")?;
    let libraries = library::select(&arguments.binaries.platforms, &arguments.binaries.libraries)?;
    for version in versions {
        let built = source.build(&libraries, version, folder)?;
        println!("{built}");
        if let Some(reason) = built.without_reference {
            println!("  without reference results: {reason}");
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_example_of_the_help_can_be_typed() {
        let command = Arguments::command();
        let helps = std::iter::once(&command)
            .chain(command.get_subcommands())
            .map(|command| (command.get_name().to_owned(), command.get_after_help()));
        for (name, help) in helps {
            let help = help.map(ToString::to_string).unwrap_or_default();
            let examples: Vec<&str> = help
                .lines()
                .map(str::trim)
                .filter(|line| line.starts_with("build-fmu "))
                .collect();
            assert!(!examples.is_empty(), "{name} has no example");
            for example in examples {
                let words = example.split_whitespace().take_while(|word| *word != ">");
                if let Err(error) = Arguments::try_parse_from(words) {
                    panic!("{example}: {error}");
                }
            }
        }
    }
}
