//! `benchmarks dostep`: what a communication step costs through the C ABI, and that its size does not
//! change the result.

use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
use std::fmt::Write as _;
use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Context, Result};
use clap::Args;
use stress_tests::component::Component;
use stress_tests::library::Library;
use stress_tests::rig::Rig;
use stress_tests::standard::Version;

use crate::files::write_atomically;
use crate::systems::{self, END_TIME, System};

/// Largest difference of θ2 between communication steps [rad].
const IDENTITY: f64 = 1e-9;
/// Communication steps whose results are compared, in units of the shortest, 0.1 ms.
const MULTIPLES: [u32; 4] = [10, 73, 100, 1000];
const SHORTEST_STEP: f64 = 1e-4;

const VERSIONS: [(Version, &str); 2] = [(Version::Two, "FMI 2"), (Version::Three, "FMI 3")];
const OUTPUTS: [&str; 6] = ["theta", "theta_dot", "T_f", "theta3", "theta3_dot", "i"];

/// Options of `benchmarks dostep`.
#[derive(Args, Debug)]
pub struct Options {
    /// The built library (default: beside this program).
    #[arg(long)]
    library: Option<PathBuf>,
    /// Folder for do-step.md.
    #[arg(long, default_value = "docs")]
    out: PathBuf,
    /// End with exit code 1 when a speed bar is missed.
    #[arg(long)]
    check: bool,
}

/// One row of the table.
#[derive(Clone, Copy)]
struct Case {
    name: &'static str,
    step: f64,
    input_changes: bool,
    /// Median asked for, without outputs [ns].
    bar: f64,
}

const CASES: [Case; 3] = [
    Case {
        name: "1 ms, inputs held",
        step: 1e-3,
        input_changes: false,
        bar: 100.0,
    },
    Case {
        name: "10 ms, inputs held",
        step: 1e-2,
        input_changes: false,
        bar: 250.0,
    },
    Case {
        name: "1 ms, voltage set before every step",
        step: 1e-3,
        input_changes: true,
        bar: 1500.0,
    },
];

/// Times the steps and compares the results; `false` when a bar was to be checked and is missed, or
/// when the result depends on the communication step.
///
/// # Errors
/// When the library is missing or refuses a call.
pub fn run(options: &Options) -> Result<bool> {
    let path = options.library.clone().map_or_else(beside_program, Ok)?;
    let library = Library::load(&path)?;
    let [system, ..] = systems::all();
    let component = Component::new(&system.model_toml())?;
    let mut text = String::from(
        "# Cost of a communication step\n\nMade by `cargo run --release -p benchmarks -- dostep`: the built library through its C ABI, the reduced rig with the\n\
         Stribeck law at 5.76 rad/s and 50 N, 60 s per run. Median over all calls of the median-of-three runs, the clock's own\n\
         time subtracted; the mean is the whole run over its number of steps.\n\n\
         | interface | communication step | median [ns] | with six outputs read [ns] | mean [ns] | bar [ns] |\n|---|---|---:|---:|---:|---:|\n",
    );
    let mut met = true;
    let grounds = VERSIONS.map(|(version, name)| {
        let ground = Ground {
            library: &library,
            component: &component,
            version,
            system,
        };
        (ground, name)
    });
    for (ground, version_name) in &grounds {
        for case in CASES {
            let median = median_of_three(|| ground.timed_calls(case, false))?;
            let with_outputs = median_of_three(|| ground.timed_calls(case, true))?;
            let mean = median_of_three(|| ground.mean_of_run(case))?;
            met &= median <= case.bar;
            let _ = writeln!(
                text,
                "| {version_name} | {} | {median:.0} | {with_outputs:.0} | {mean:.0} | {:.0} |",
                case.name, case.bar
            );
        }
    }
    text.push_str("\n| interface | communication step [ms] | largest difference of θ2 from that with 0.1 ms [rad] |\n|---|---:|---:|\n");
    let mut identical = true;
    for (ground, version_name) in &grounds {
        let reference = ground.angles(1)?;
        for multiple in MULTIPLES {
            let difference = ground
                .angles(multiple)?
                .iter()
                .zip(
                    reference
                        .iter()
                        .skip(multiple as usize - 1)
                        .step_by(multiple as usize),
                )
                .fold(0.0_f64, |worst, (a, b)| worst.max((a - b).abs()));
            identical &= difference <= IDENTITY;
            let _ = writeln!(
                text,
                "| {version_name} | {} | {difference:.1e} |",
                f64::from(multiple) * SHORTEST_STEP * 1e3
            );
        }
    }
    println!("{text}");
    write_atomically(&options.out.join("do-step.md"), &text)?;
    if !identical {
        eprintln!(
            "benchmarks: the result depends on the communication step by more than {IDENTITY:e} rad"
        );
    }
    Ok(identical && (met || !options.check))
}

/// Cargo leaves the library of a dependency among the program's `deps`, and that of the workspace's
/// own build beside the program; the newer one counts.
fn beside_program() -> Result<PathBuf> {
    let program = std::env::current_exe()?;
    let folder = program.parent().context("this program lies in no folder")?;
    let name = format!("{DLL_PREFIX}stickslip{DLL_SUFFIX}");
    let changed = |path: &Path| path.metadata().and_then(|m| m.modified()).ok();
    [folder.join("deps").join(&name), folder.join(&name)]
        .into_iter()
        .filter_map(|path| changed(&path).map(|time| (time, path)))
        .max()
        .map(|(_, path)| path)
        .with_context(|| {
            format!(
                "no {name} in {}: run `cargo build --release`",
                folder.display()
            )
        })
}

fn median(values: &mut [f64]) -> f64 {
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

fn median_of_three(mut measure: impl FnMut() -> Result<f64>) -> Result<f64> {
    let mut values = [measure()?, measure()?, measure()?];
    Ok(median(&mut values))
}

/// Median time [ns] between two readings of the clock with nothing between.
fn clock_overhead() -> f64 {
    let mut pauses: Vec<f64> = (0..10_000)
        .map(|_| Instant::now().elapsed().as_nanos() as f64)
        .collect();
    median(&mut pauses)
}

fn steps_of(case: Case) -> u32 {
    (END_TIME / case.step).round() as u32
}

/// What is timed, through which version.
struct Ground<'a> {
    library: &'a Library,
    component: &'a Component,
    version: Version,
    system: System,
}

impl<'a> Ground<'a> {
    fn start(&self) -> Result<Rig<'a>> {
        let [u, n2] = self.component.references(["u", "N2"])?;
        let inputs = [(u, self.system.voltage()), (n2, self.system.normal_force)];
        Rig::start(self.library, self.component, self.version, &inputs)
    }

    /// The voltage of step `k`: never twice the same in a row.
    fn changing_voltage(&self, k: u32) -> f64 {
        self.system.voltage() * (1.0 + 0.01 * (f64::from(k) * 0.01).sin())
    }

    fn timed_calls(&self, case: Case, outputs: bool) -> Result<f64> {
        let rig = self.start()?;
        let [voltage] = self.component.references(["u"])?;
        let read = self.component.references(OUTPUTS)?;
        let mut times = Vec::with_capacity(steps_of(case) as usize);
        for k in 0..steps_of(case) {
            let point = f64::from(k) * case.step;
            let input = self.changing_voltage(k);
            let before = Instant::now();
            if case.input_changes {
                rig.set(voltage, input)?;
            }
            rig.step(point, case.step)?;
            if outputs {
                black_box(rig.get(&read)?);
            }
            times.push(before.elapsed().as_nanos() as f64);
        }
        Ok(median(&mut times) - clock_overhead())
    }

    fn mean_of_run(&self, case: Case) -> Result<f64> {
        let rig = self.start()?;
        let [voltage] = self.component.references(["u"])?;
        let before = Instant::now();
        for k in 0..steps_of(case) {
            if case.input_changes {
                rig.set(voltage, self.changing_voltage(k))?;
            }
            rig.step(f64::from(k) * case.step, case.step)?;
        }
        Ok(before.elapsed().as_nanos() as f64 / f64::from(steps_of(case)))
    }

    /// θ2 at every communication point of a run with a step of `multiple` times the shortest.
    fn angles(&self, multiple: u32) -> Result<Vec<f64>> {
        let rig = self.start()?;
        let theta = self.component.references(["theta"])?;
        let step = f64::from(multiple) * SHORTEST_STEP;
        let count = (END_TIME / step + 1e-6).floor() as u32;
        let angle = |k: u32| {
            rig.step(f64::from(k) * step, step)?;
            Ok(rig.get(&theta)?[0])
        };
        (0..count).map(angle).collect()
    }
}
