//! `stickslip cross-check`: FMUs with the files by which importers of the FMI Cross-Check compare theirs, in its folders:
//! `2.0/cs/linux64/stickslip/0.1.0/ReducedRig/ReducedRig.fmu`, `_in.csv`, `_ref.csv`, `_ref.opt`.
//!
//! The reference is the native model's, so that it does not come from what is to be checked; of an FMU it is that inside
//! (FMI-LS-REF), and the FMU is run against it.

mod inside;

use std::fs;
use std::path::PathBuf;

use anyhow::{Context, bail, ensure};
use build_fmu::build::Source;
use build_fmu::library;
use build_fmu::platform::FmiVersion;
use clap::Args;

use crate::component::{self, Role};
use crate::files::atomic::write_file;
use crate::files::record::Record;
use crate::outcome::Outcome;
use crate::simulate::{Drive, Schedule, simulate};

/// Time between the rows of the reference, and the communication step of its options [s].
const STEP: f64 = 0.01;

/// FMUs of a rig with constant inputs, reference results and options of the FMI Cross-Check; of an FMU with reference results
/// inside, what it makes of them.
#[derive(Debug, Args)]
pub struct CrossCheckArguments {
    /// The rig (.toml), or an FMU (.fmu) that holds reference results (FMI-LS-REF): the experiments inside are repeated.
    model: PathBuf,
    /// Speed at the gearbox output [rpm] that the voltage would give the undisturbed rig.
    #[arg(long, allow_negative_numbers = true)]
    speed_rpm: Option<f64>,
    /// Normal force N2 on disc D2 [N].
    #[arg(long, allow_negative_numbers = true)]
    normal_force: Option<f64>,
    /// Normal force N1 on disc D1 [N], for the full rig.
    #[arg(long, allow_negative_numbers = true)]
    normal_force_1: Option<f64>,
    /// Length of the run [s]; 60 if not given.
    #[arg(long, allow_negative_numbers = true)]
    duration: Option<f64>,
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
    if arguments
        .model
        .extension()
        .is_some_and(|extension| extension == "fmu")
    {
        let given = [
            ("--speed-rpm", arguments.speed_rpm.is_some()),
            ("--normal-force", arguments.normal_force.is_some()),
            ("--normal-force-1", arguments.normal_force_1.is_some()),
            ("--duration", arguments.duration.is_some()),
            ("--library", arguments.library.is_some()),
        ];
        if let Some((option, _)) = given.iter().find(|(_, given)| *given) {
            bail!("{option}: the FMU brings its own experiment");
        }
        return inside::check(&arguments.model, &arguments.out);
    }
    let needed = "is needed for a rig";
    let speed_rpm = arguments
        .speed_rpm
        .context(format!("--speed-rpm RPM {needed}"))?;
    let normal_force = arguments
        .normal_force
        .context(format!("--normal-force N {needed}"))?;
    let duration = arguments.duration.unwrap_or(60.0);
    for (name, force) in [
        ("--normal-force", Some(normal_force)),
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
        duration.is_finite() && duration >= STEP,
        "--duration {}: {STEP} s or more is needed, the time between the rows of the reference",
        duration
    );
    ensure!(
        speed_rpm.is_finite(),
        "--speed-rpm {speed_rpm}: a finite number is needed"
    );
    let source = Source::read(&arguments.model)?;
    let mut native = component::open(&arguments.model)?;
    let drive = Drive::from_speed(
        native.as_ref(),
        |_| None,
        speed_rpm,
        normal_force,
        arguments.normal_force_1,
    )?;
    let library = library::find(arguments.library.as_deref())?;
    let schedule = Schedule::new(drive.start(), duration, STEP)?;
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
    let options = options(
        drive.start(),
        drive.start() + duration,
        STEP,
        facts.identity.default_experiment.tolerance,
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

/// The file of options: times [s] and relative tolerance.
fn options(start: f64, stop: f64, step: f64, tolerance: f64) -> String {
    format!("StartTime, {start}\nStopTime, {stop}\nStepSize, {step}\nRelTol, {tolerance:e}\n")
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
