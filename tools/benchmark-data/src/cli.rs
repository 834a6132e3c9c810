//! The command line.

use anyhow::{Context, bail, ensure};
use benchmark_data::axis::AXES;
use benchmark_data::axis_fmu;
use benchmark_data::balance::JOINTS;
use benchmark_data::case_files::{Case, make_cases};
use benchmark_data::excitation::Brake;
use benchmark_data::other_rigs::case::{OtherCase, RigChoice};
use benchmark_data::other_rigs::plan::{OtherWish, Sort};
use benchmark_data::plan::{FULL_SIZE, Group, Measured, PlannedCase, SMALL_SIZE, Suite, Wish};
use benchmark_data::practice::{read_answers, read_record, replay, true_rig};
use benchmark_data::recipe::Kind;
use benchmark_data::records::Sensors;
use clap::{Parser, Subcommand, ValueEnum as _};
use indicatif::{ProgressBar, ProgressStyle};
use std::path::{Path, PathBuf};

/// Samples over which `verify` takes its differences (10 s).
const VERIFIED_STRETCH: usize = 1000;

#[derive(Parser)]
#[command(version, about)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Make cases with a hidden effect and their sealed ANSWERS.json.
    Make(MakeArguments),
    /// Replay practice cases with their true parameters and print how far the records are away.
    Verify {
        /// Directory of cases with an ANSWERS.json.
        #[arg(long)]
        practice: PathBuf,
        /// Only these cases.
        #[arg(long)]
        case: Vec<String>,
    },
}

#[derive(clap::Args)]
struct MakeArguments {
    /// New directory for the cases.
    #[arg(long)]
    out: PathBuf,
    /// A whole suite with its own seeds.
    #[arg(long, value_enum, conflicts_with = "seed")]
    suite: Option<Suite>,
    /// Only these groups of the suite (repeatable).
    #[arg(long, requires = "suite", value_enum)]
    group: Vec<Group>,
    /// First seed, one per case (not 10000 to 29999).
    #[arg(long, required_unless_present = "suite")]
    seed: Option<u64>,
    /// Number of cases; with a suite, per group.
    #[arg(long, required_unless_present = "suite")]
    cases: Option<usize>,
    /// Size over practice size: full (0.6 to 1.4), small (0.05 to 0.2) or a number.
    #[arg(long, default_value = "full", value_parser = parse_size)]
    size: (f64, f64),
    /// Contacts that follow another law do so in part, as far as --size says, instead of wholly.
    #[arg(long, conflicts_with = "suite")]
    share_laws: bool,
    /// Random friction of 4 %, nominal parameters 2 % off.
    #[arg(long)]
    rough: bool,
    /// Two effects per case.
    #[arg(long, conflicts_with_all = ["suite", "outside", "clean"])]
    pairs: bool,
    /// Three effects per case.
    #[arg(long, conflicts_with_all = ["suite", "outside", "clean", "pairs"])]
    triples: bool,
    /// A rig of its own for every case, with loads, instruments and sizes that fit it.
    #[arg(long, conflicts_with = "suite")]
    other_rigs: bool,
    /// The same with two discs, effects on either.
    #[arg(long, conflicts_with_all = ["suite", "outside", "own_sizes"])]
    full_rig: bool,
    /// The dissertation's rig with contacts, loads and sizes drawn as for other rigs.
    #[arg(long, conflicts_with_all = ["suite", "other_rigs"])]
    own_sizes: bool,
    /// Joints whose torque is measured beside the one that a model predicts.
    #[arg(long, conflicts_with_all = ["suite", "other_rigs", "full_rig", "own_sizes", "pairs", "triples", "outside", "clean", "rough", "size",
        "share_laws", "load_reference", "sensors", "instruments_unknown", "noise"])]
    balance: bool,
    /// Axes of which an FMU is the model, with that FMU beside the cases; rustc compiles it.
    #[arg(long, conflicts_with_all = ["balance", "suite", "other_rigs", "full_rig", "own_sizes", "pairs", "triples", "outside", "clean",
        "rough", "size", "share_laws", "load_reference", "sensors", "instruments_unknown", "noise"])]
    fmu: bool,
    /// Normal force in N at which a load exponent changes nothing, or `middle` for the middle load
    /// of the case.
    #[arg(long, default_value = "50", value_parser = parse_load_reference)]
    load_reference: LoadReference,
    /// What is measured; `no-disc` has the gearbox output's angle and the current, `current` all and
    /// the current.
    #[arg(long, value_enum, default_value = "all")]
    sensors: Sensors,
    /// No sensors.toml; instruments 0.2 to 5 times as noisy, encoders that round or not.
    #[arg(long)]
    instruments_unknown: bool,
    /// Effects in no catalogue.
    #[arg(long, conflicts_with_all = ["suite", "clean"])]
    outside: bool,
    /// Nothing hidden.
    #[arg(long, conflicts_with = "suite")]
    clean: bool,
    /// Only this kind (as in ANSWERS.json).
    #[arg(long, conflicts_with = "suite")]
    kind: Option<String>,
    /// Factor on the noise of the instruments.
    #[arg(long, default_value_t = 1.0, conflicts_with = "suite")]
    noise: f64,
    /// Worker threads.
    #[arg(long, default_value_t = 2)]
    threads: usize,
}

impl MakeArguments {
    /// First seed and number of cases on demand.
    fn seed_and_cases(&self) -> anyhow::Result<(u64, usize)> {
        match (self.seed, self.cases) {
            (Some(seed), Some(cases)) => Ok((seed, cases)),
            _ => bail!("--seed or --cases is missing"),
        }
    }

    fn measured(&self) -> Measured {
        Measured {
            sensors: self.sensors,
            unknown: self.instruments_unknown,
        }
    }
}

/// `None`: the middle load of the case.
#[derive(Clone, Copy)]
struct LoadReference(Option<f64>);

/// Runs the command; `false` when a check said no.
pub fn run() -> anyhow::Result<bool> {
    match Arguments::parse().command {
        Command::Make(arguments) => make(&arguments).map(|()| true),
        Command::Verify { practice, case } => verify(&practice, &case),
    }
}

fn make(arguments: &MakeArguments) -> anyhow::Result<()> {
    if arguments.balance || arguments.fmu {
        let (seed, cases) = arguments.seed_and_cases()?;
        let set = if arguments.fmu { &AXES } else { &JOINTS };
        let plan = set.plan(seed, cases, arguments.kind.as_deref())?;
        make_all(arguments, &plan)?;
        if arguments.fmu {
            axis_fmu::write(&arguments.out)?;
        }
        Ok(())
    } else if arguments.other_rigs || arguments.full_rig || arguments.own_sizes {
        make_all(arguments, &plan_other_rigs(arguments)?)
    } else {
        ensure!(
            !arguments.triples,
            "--triples needs --other-rigs, --full-rig or --own-sizes"
        );
        make_all(arguments, &plan(arguments)?)
    }
}

fn make_all<C: Case>(arguments: &MakeArguments, cases: &[C]) -> anyhow::Result<()> {
    let style = ProgressStyle::with_template("{bar:40} {pos}/{len} cases, {eta} left")
        .context("progress bar")?;
    let bar = ProgressBar::new(cases.len() as u64).with_style(style);
    make_cases(&arguments.out, cases, arguments.threads, &|| bar.inc(1))?;
    bar.finish_and_clear();
    println!("{} cases in {}", cases.len(), arguments.out.display());
    Ok(())
}

fn plan_other_rigs(arguments: &MakeArguments) -> anyhow::Result<Vec<OtherCase>> {
    let sort = if arguments.pairs {
        Sort::Pair
    } else if arguments.triples {
        Sort::Triple
    } else if arguments.outside {
        Sort::Outside
    } else if arguments.clean {
        Sort::Clean
    } else {
        Sort::Single
    };
    let (seed, cases) = arguments.seed_and_cases()?;
    let wish = OtherWish {
        seed,
        cases,
        sort,
        kind: arguments.kind.clone(),
        common: OtherCase {
            rig: if arguments.full_rig {
                RigChoice::Full
            } else if arguments.own_sizes {
                RigChoice::Dissertation
            } else {
                RigChoice::Drawn
            },
            size: match arguments.size {
                FULL_SIZE => (1.0, 1.0),
                size => size,
            },
            share_laws: arguments.share_laws,
            rough: arguments.rough,
            noise: arguments.noise,
            measured: arguments.measured(),
            load_reference: arguments.load_reference.0,
            ..OtherCase::default()
        },
    };
    Ok(wish.plan()?)
}

fn plan(arguments: &MakeArguments) -> anyhow::Result<Vec<PlannedCase>> {
    let measured = arguments.measured();
    if let Some(suite) = arguments.suite {
        let groups = match arguments.group.as_slice() {
            [] => Group::value_variants(),
            chosen => chosen,
        };
        let mut cases = suite.plan(groups, arguments.cases);
        for case in &mut cases {
            case.measured = measured;
        }
        return Ok(cases);
    }
    let (seed, cases) = arguments.seed_and_cases()?;
    let mut kinds = match (arguments.pairs, arguments.outside, arguments.clean) {
        (true, _, _) => Kind::pairs(),
        (_, true, _) => Kind::outsiders(false),
        (_, _, true) => vec![Kind::clean(Brake::On), Kind::clean(Brake::Off)],
        _ => Kind::singles(),
    };
    if let Some(name) = &arguments.kind {
        if !(arguments.pairs || arguments.outside || arguments.clean) {
            // What goes round by itself is of the practice records; laws in part are what --share-laws makes of those.
            let further = Kind::further().into_iter();
            kinds.extend(further.filter(|kind| !kind.replaces_law()));
        }
        kinds.retain(|kind| *name == kind.name);
    }
    kinds.retain(|kind| !arguments.rough || kind.brake == Brake::On);
    ensure!(
        !kinds.is_empty(),
        "no kind fits; names are those of `kind` in ANSWERS.json, and rough cases need the brake"
    );
    let wish = Wish {
        seed,
        cases,
        kinds,
        scale: arguments.size,
        share_laws: arguments.share_laws,
        rough: arguments.rough,
        noise: arguments.noise,
        measured,
    };
    Ok(wish.plan()?)
}

fn verify(practice: &Path, chosen: &[String]) -> anyhow::Result<bool> {
    println!(
        "root mean square differences over each 10 s: disc [rad, rad/s], gearbox [rad, rad/s]"
    );
    let mut finite = true;
    for (name, answer) in read_answers(practice)? {
        // Random friction cannot be replayed.
        if answer.rough > 0.0 || !(chosen.is_empty() || chosen.contains(&name)) {
            continue;
        }
        let rig = true_rig(&answer)?;
        for file in ["run-0.csv", "run-a.csv", "run-b.csv", "held-out.csv"] {
            let path = practice.join(&name).join(file);
            if !path.exists() {
                continue;
            }
            print!("{name} {file}:");
            let differences = replay(&rig, &read_record(&path)?, VERIFIED_STRETCH)?;
            for d in &differences[..differences.len() - 1] {
                finite &= d.disc_angle.is_finite();
                print!(
                    " [{:.4} {:.3} {:.5} {:.4}]",
                    d.disc_angle, d.disc_speed, d.gearbox_angle, d.gearbox_speed
                );
            }
            println!();
        }
    }
    Ok(finite)
}

fn parse_size(text: &str) -> Result<(f64, f64), String> {
    match text {
        "full" => Ok(FULL_SIZE),
        "small" => Ok(SMALL_SIZE),
        number => number
            .parse()
            .map(|size: f64| (size, size))
            .map_err(|_| "expected full, small or a number".to_owned()),
    }
}

fn parse_load_reference(text: &str) -> Result<LoadReference, String> {
    match (text, text.parse::<f64>()) {
        ("middle", _) => Ok(LoadReference(None)),
        (_, Ok(newton)) if newton > 0.0 && newton.is_finite() => Ok(LoadReference(Some(newton))),
        _ => Err("expected `middle` or a force above 0 N".to_owned()),
    }
}
