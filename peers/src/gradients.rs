//! What eight derivatives cost beside the run that they belong to.

use std::hint::black_box;

use anyhow::Result;
use cpu_time::ProcessTime;
use stickslip::integrator::{Options, Simulation};
use stickslip::plant::{Rig, RigInputs, STATES, sensitivities};

use crate::effort::Effort;
use crate::systems::{END_TIME, Law, System};

/// Cost of eight derivatives asked for, in plain runs.
pub const BAR: f64 = 4.0;

/// Parameters of every system.
const COMMON: [&str; 5] = [
    "disc.inertia",
    "shaft.stiffness",
    "shaft.damping",
    "motor.resistance",
    "motor.torque_constant",
];
/// Those of its friction law.
const STRIBECK: [&str; 3] = ["contact.mu_c", "contact.mu_s", "contact.omega_s"];
const TWO_GAUSSIAN: [&str; 3] = ["contact.a1", "contact.b1", "contact.c1"];

/// Processor times of one system [s].
#[derive(Clone, Copy, Debug)]
pub struct Cost {
    /// Short name of the system.
    pub system: &'static str,
    /// A plain run.
    pub plain: f64,
    /// The state at the end with its derivatives by eight parameters.
    pub with_derivatives: f64,
}

impl Cost {
    /// Plain runs that the derivatives cost.
    #[must_use]
    pub fn ratio(&self) -> f64 {
        self.with_derivatives / self.plain
    }
}

/// Times `system` at the default tolerance, the two in turn.
///
/// # Errors
/// When the model is refused or a run fails.
pub fn cost(system: &System, effort: Effort) -> Result<Cost> {
    let rig = Rig::from_toml(&system.model_toml(), "the benchmark's model")?;
    let force_1 = system.first_disc.map_or(0.0, |disc| disc.normal_force);
    let inputs = RigInputs::held(system.voltage(), system.normal_force, force_1);
    let law = match system.law {
        Law::Stribeck { .. } => STRIBECK,
        Law::TwoGaussian { .. } => TWO_GAUSSIAN,
    };
    let names: Vec<&str> = COMMON.into_iter().chain(law).collect();
    let (options, start) = (Options::default(), [0.0; STATES]);
    let mut cost = Cost {
        system: system.key,
        plain: f64::INFINITY,
        with_derivatives: f64::INFINITY,
    };
    for _ in 0..20 * effort.repetitions() {
        let clock = ProcessTime::now();
        let mut run = Simulation::new(rig, options, 0.0, start, inputs)?;
        run.advance_to(END_TIME)?;
        black_box(run.state_at(END_TIME));
        cost.plain = cost.plain.min(clock.elapsed().as_secs_f64());
        let clock = ProcessTime::now();
        black_box(sensitivities(
            &rig,
            &names,
            options,
            &start,
            &inputs,
            &[END_TIME],
        )?);
        cost.with_derivatives = cost.with_derivatives.min(clock.elapsed().as_secs_f64());
    }
    Ok(cost)
}

/// The table, as Markdown.
#[must_use]
pub fn table(costs: &[Cost]) -> String {
    let mut text = format!(
        "### Derivatives\n\nState at 60 s with its derivatives by eight parameters, at the default tolerance, \
         against the plain run in turn with it; bar {BAR} plain runs.\n\n\
         | system | plain run [ms] | with eight derivatives [ms] | plain runs |\n|---|---:|---:|---:|\n"
    );
    for cost in costs {
        text.push_str(&format!(
            "| ({}) | {:.3} | {:.3} | {:.1} |\n",
            cost.system,
            1e3 * cost.plain,
            1e3 * cost.with_derivatives,
            cost.ratio()
        ));
    }
    text
}
