//! `benchmarks derivatives`: what eight derivatives cost beside the run that they belong to, for every law on both
//! rigs and for every effect on the reduced one.

use std::fmt::Write;
use std::hint::black_box;
use std::path::PathBuf;

use anyhow::Result;
use clap::Args;
use cpu_time::ProcessTime;
use stickslip::integrator::{self, Simulation};
use stickslip::plant::{Rig, RigInputs, STATES, sensitivities};

use crate::effects::EFFECTS;
use crate::files::write_atomically;
use crate::laws::LAWS;
use crate::systems::{self, END_TIME};

/// Cost of eight derivatives asked for, in plain runs.
const BAR: f64 = 4.0;

/// Repetitions of each run, of which the fastest counts.
const REPETITIONS: u32 = 40;

/// Number of parameters differentiated by.
const COUNT: usize = 8;

/// Parameters of every rig; they fill up to [`COUNT`] behind those of the law or the effect.
const COMMON: [&str; 8] = [
    "disc.inertia",
    "shaft.stiffness",
    "shaft.damping",
    "motor.resistance",
    "motor.torque_constant",
    "contact.radius",
    "gearbox.ratio",
    "motor.inertia",
];
/// How many parameters of the law or the effect are asked for at most.
const OWN: usize = 3;

/// Law under which effects are timed.
const LAW_OF_EFFECTS: &str = "stribeck";

/// Options of `benchmarks derivatives`.
#[derive(Args, Debug)]
pub struct Options {
    /// Folder for derivatives.md.
    #[arg(long, default_value = "docs")]
    out: PathBuf,
    /// Only this law (or effect), without writing the page.
    #[arg(long)]
    law: Option<String>,
    /// End with exit code 1 when the bar is missed.
    #[arg(long)]
    check: bool,
}

/// Times all rigs, prints the table and writes it; `false` when the bar was to be checked and is missed.
///
/// # Errors
/// When a model is refused, a run fails or the page cannot be written.
pub fn run(options: &Options) -> Result<bool> {
    let wanted = |law: &str| options.law.as_ref().is_none_or(|only| only == law);
    let (costs, with_effects) = (costs(wanted)?, costs_with_effects(wanted)?);
    let page = page(&costs, &with_effects);
    print!("{page}");
    if options.law.is_none() {
        write_atomically(&options.out.join("derivatives.md"), &page)?;
    }
    Ok(!options.check || costs.iter().all(|cost| cost.ratio() <= BAR))
}

/// Processor times of one rig [s].
#[derive(Clone, Debug)]
struct Cost {
    /// Law and rig.
    name: String,
    /// A plain run.
    plain: f64,
    /// The state at the end with its derivatives by eight parameters.
    with_derivatives: f64,
}

impl Cost {
    /// Plain runs that the derivatives cost.
    fn ratio(&self) -> f64 {
        self.with_derivatives / self.plain
    }
}

/// Times every `wanted` law on both rigs at the default tolerance, plain and with derivatives in turn.
fn costs(wanted: impl Fn(&str) -> bool) -> Result<Vec<Cost>> {
    let [reduced, _, full] = systems::all();
    let mut costs = Vec::new();
    for (law, _) in LAWS.into_iter().filter(|(law, _)| wanted(law)) {
        for system in [reduced, full] {
            let rig = Rig::from_toml(&system.model_with_law(law), law)?;
            let force_1 = system.first_disc.map_or(0.0, |disc| disc.normal_force);
            let inputs = RigInputs::held(system.voltage(), system.normal_force, force_1);
            let which = if system.first_disc.is_some() {
                "full"
            } else {
                "reduced"
            };
            let own = rig.law.section().infos().iter().map(|info| info.key);
            let own = own.map(|key| format!("contact.{key}")).collect();
            costs.push(cost(format!("{law}, {which} rig"), rig, inputs, own)?);
        }
    }
    Ok(costs)
}

/// Times every `wanted` effect alone on the reduced rig.
fn costs_with_effects(wanted: impl Fn(&str) -> bool) -> Result<Vec<Cost>> {
    let [system, ..] = systems::all();
    let model = system.model_with_law(LAW_OF_EFFECTS);
    let inputs = RigInputs::held(system.voltage(), system.normal_force, 0.0);
    let mut costs = Vec::new();
    for (effect, numbers) in EFFECTS.into_iter().filter(|(effect, _)| wanted(effect)) {
        let rig = Rig::from_toml(&format!("{model}\n[{effect}]\n{numbers}\n"), effect)?;
        let own = rig.parameters().into_iter().map(|parameter| parameter.name);
        let own = own
            .filter(|name| name.starts_with(effect) && !name.ends_with("seed"))
            .collect();
        costs.push(cost(effect.to_owned(), rig, inputs, own)?);
    }
    Ok(costs)
}

/// Times one rig; of its `own` parameters the first are asked for.
fn cost(
    name: String,
    rig: Rig<f64>,
    inputs: RigInputs<f64>,
    mut names: Vec<String>,
) -> Result<Cost> {
    names.truncate(OWN);
    names.extend(COMMON.map(String::from));
    names.truncate(COUNT);
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let (options, start) = (integrator::Options::default(), [0.0; STATES]);
    let mut cost = Cost {
        name,
        plain: f64::INFINITY,
        with_derivatives: f64::INFINITY,
    };
    for _ in 0..REPETITIONS {
        let clock = ProcessTime::now();
        let mut run = Simulation::new(rig, options, 0.0, start, inputs)?;
        run.advance_to(END_TIME)?;
        black_box(run.state_at(END_TIME));
        cost.plain = cost.plain.min(clock.elapsed().as_secs_f64());
        let clock = ProcessTime::now();
        let times = [END_TIME];
        black_box(sensitivities(
            &rig, &names, options, &start, &inputs, &times,
        )?);
        cost.with_derivatives = cost.with_derivatives.min(clock.elapsed().as_secs_f64());
    }
    Ok(cost)
}

/// The page, as Markdown.
fn page(costs: &[Cost], with_effects: &[Cost]) -> String {
    let mut text = format!(
        "# Cost of derivatives\n\nMade by `cargo run --release -p benchmarks --no-default-features -- derivatives`. Each run: 60 s from \
         rest at a tolerance of {:e}, the smallest processor time of {REPETITIONS}, plain and with the derivatives of the \
         last state by eight parameters (up to three of the law, the others of the rig) in turn; one thread. Reduced rig: \
         5.76 rad/s, 50 N; full rig: 40 rpm, 30 N on D1, 20 N on D2, the law on both discs. Asked for: {BAR} plain runs.\n\n\
         | law, rig | plain run [ms] | with eight derivatives [ms] | plain runs |\n|---|---:|---:|---:|\n",
        integrator::Options::DEFAULT_TOLERANCE
    );
    rows(costs, &mut text);
    let _ = write!(
        text,
        "\n## With effects\n\nThe reduced rig under the law `{LAW_OF_EFFECTS}` with one effect; up to three of the eight parameters are the \
         effect's. Rigs with effects carry their derivatives as dual numbers.\n\n\
         | effect | plain run [ms] | with eight derivatives [ms] | plain runs |\n|---|---:|---:|---:|\n"
    );
    rows(with_effects, &mut text);
    text
}

fn rows(costs: &[Cost], text: &mut String) {
    for cost in costs {
        let _ = writeln!(
            text,
            "| {} | {:.3} | {:.3} | {:.1} |",
            cost.name,
            1e3 * cost.plain,
            1e3 * cost.with_derivatives,
            cost.ratio()
        );
    }
}
