//! `stickslip cross-check`: FMUs with the files by which importers of the FMI Cross-Check compare theirs, in its folders:
//! `2.0/cs/linux64/stickslip/0.1.0/ReducedRig/ReducedRig.fmu`, `_in.csv`, `_ref.csv`, `_ref.opt`.
//!
//! The reference is the native model's, so that it does not come from what is to be checked.

use std::fs;
use std::path::PathBuf;

use anyhow::{Context, ensure};
use build_fmu::build::Source;
use build_fmu::library;
use build_fmu::platform::FmiVersion;
use clap::Args;

use crate::cli::Outcome;
use crate::component::{self, Role};
use crate::files::atomic::write_file;
use crate::files::record::Record;
use crate::simulate::{Drive, Schedule, simulate};

/// Time between the rows of the reference, and the communication step of its options [s].
const STEP: f64 = 0.01;

/// FMUs of a rig with constant inputs, reference results and options of the FMI Cross-Check.
#[derive(Debug, Args)]
pub struct CrossCheckArguments {
    /// The rig (.toml).
    model: PathBuf,
    /// Speed at the gearbox output [rpm] that the voltage would give the undisturbed rig.
    #[arg(long, allow_negative_numbers = true)]
    speed_rpm: f64,
    /// Normal force N2 on disc D2 [N].
    #[arg(long, allow_negative_numbers = true)]
    normal_force: f64,
    /// Normal force N1 on disc D1 [N], for the full rig.
    #[arg(long, allow_negative_numbers = true)]
    normal_force_1: Option<f64>,
    /// Length of the run [s].
    #[arg(long, default_value_t = 60.0, allow_negative_numbers = true)]
    duration: f64,
    /// The library to pack; without it the one beside this program.
    #[arg(long, value_name = "FILE")]
    library: Option<PathBuf>,
    /// Directory for the folders of the cross-check.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

/// Runs the subcommand.
///
/// # Errors
/// Whatever is wrong with the model, the inputs or the library.
pub fn command(arguments: &CrossCheckArguments) -> anyhow::Result<Outcome> {
    for (name, force) in [
        ("--normal-force", Some(arguments.normal_force)),
        ("--normal-force-1", arguments.normal_force_1),
    ] {
        if let Some(force) = force {
            ensure!(
                force.is_finite() && force >= 0.0,
                "{name} {force}: a force of 0 N or more is needed"
            );
        }
    }
    ensure!(
        arguments.duration.is_finite() && arguments.duration >= STEP,
        "--duration {}: {STEP} s or more is needed, the time between the rows of the reference",
        arguments.duration
    );
    ensure!(
        arguments.speed_rpm.is_finite(),
        "--speed-rpm {}: a finite number is needed",
        arguments.speed_rpm
    );
    let source = Source::read(&arguments.model)?;
    let mut native = component::open(&arguments.model)?;
    let drive = Drive::from_speed(
        native.as_ref(),
        |_| None,
        arguments.speed_rpm,
        arguments.normal_force,
        arguments.normal_force_1,
    )?;
    let library = library::find(arguments.library.as_deref())?;
    let schedule = Schedule::new(drive.start(), arguments.duration, STEP)?;
    let record = simulate(native.as_mut(), &drive, &schedule)?;
    let named = |role: Role| -> Vec<String> {
        let variables = native.variables().iter();
        variables
            .filter(|variable| variable.role == role)
            .map(|variable| variable.name.clone())
            .collect()
    };
    let every_row: Vec<usize> = (0..record.len()).collect();
    let ends = [0, record.len() - 1];
    let reference = part(&record, &every_row, &named(Role::Output))?;
    let inputs = part(&record, &ends, &named(Role::Input))?;
    let facts = source.facts();
    let options = format!(
        "StartTime, {}\nStopTime, {}\nStepSize, {STEP}\nRelTol, {:e}\n",
        drive.start(),
        drive.start() + arguments.duration,
        facts.identity.default_experiment.tolerance
    );
    let name = facts.identity.model_identifier;
    let libraries = [library];
    for version in FmiVersion::ALL {
        let folder: PathBuf = [
            version.number(),
            "cs",
            libraries[0].platform.folder(version),
            "stickslip",
            env!("CARGO_PKG_VERSION"),
            name,
        ]
        .iter()
        .collect();
        let folder = arguments.out.join(folder);
        fs::create_dir_all(&folder).with_context(|| format!("{}", folder.display()))?;
        let fmu = source.to_bytes(&libraries, version)?;
        write_file(&folder.join(format!("{name}.fmu")), &fmu)?;
        inputs.write(&folder.join(format!("{name}_in.csv")))?;
        reference.write(&folder.join(format!("{name}_ref.csv")))?;
        write_file(&folder.join(format!("{name}_ref.opt")), options.as_bytes())?;
        println!("{}", folder.display());
    }
    Ok(Outcome::Done)
}

/// The named columns of some rows.
fn part(record: &Record, rows: &[usize], names: &[String]) -> anyhow::Result<Record> {
    let chosen = |column: &[f64]| rows.iter().map(|&row| column[row]).collect();
    let mut part = Record::new(record.source(), chosen(record.time()))?;
    for name in names {
        part.add_column(name.clone(), chosen(record.require(name)?))?;
    }
    Ok(part)
}
