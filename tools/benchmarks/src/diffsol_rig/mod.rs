//! diffsol: the rigs under its BDF, ESDIRK and explicit Runge-Kutta methods.

mod equations;
mod loop_law;

use std::rc::Rc;

use anyhow::Result;
use diffsol::{
    NalgebraContext, NalgebraLU, NalgebraMat, NalgebraVec, OdeBuilder, OdeEquations,
    OdeSolverMethod, OdeSolverStopReason,
};

use crate::effort::{Effort, fastest};
use crate::measurement::{Apart, Run};
use crate::systems::{END_TIME, OUTPUT_STEP, System};
use equations::{Rig, THETA};

/// Name in tables.
pub const NAME: &str = "diffsol";

type Matrix = NalgebraMat<f64>;
type Solver = NalgebraLU<f64>;

/// Methods that are tried.
#[derive(Clone, Copy, Debug)]
enum Method {
    Bdf,
    TrBdf2,
    Esdirk34,
    Tsit45,
}

impl Method {
    const ALL: [Self; 4] = [Self::Bdf, Self::TrBdf2, Self::Esdirk34, Self::Tsit45];

    fn name(self) -> &'static str {
        match self {
            Self::Bdf => "BDF",
            Self::TrBdf2 => "TR-BDF2",
            Self::Esdirk34 => "ESDIRK34",
            Self::Tsit45 => "Tsit45",
        }
    }

    /// Below this tolerance a low-order method takes seconds for a run.
    fn tightest(self) -> f64 {
        match self {
            Self::Bdf | Self::Tsit45 => 1e-13,
            Self::TrBdf2 => 1e-8,
            Self::Esdirk34 => 1e-9,
        }
    }
}

/// Last θ2, mode changes and steps of a run.
struct End {
    theta: f64,
    switches: u64,
    steps: u64,
}

/// Drives a solver from event to event to the end, reading the state every output step.
fn march<'a, E, S>(mut solver: S, rig: &Rig) -> Result<End>
where
    E: OdeEquations<T = f64, V = NalgebraVec<f64>, C = NalgebraContext> + 'a,
    S: OdeSolverMethod<'a, E>,
{
    let (rtol, h0) = (solver.problem().rtol, solver.problem().h0);
    let order = solver.order();
    let mut output = solver.state().y.clone();
    let points = (END_TIME / OUTPUT_STEP).round() as u64;
    let mut next = 1;
    let mut switches = 0;
    solver.set_stop_time(END_TIME)?;
    loop {
        let reason = solver.step()?;
        let reached = match reason {
            OdeSolverStopReason::RootFound(time, _) => time,
            _ => solver.state().t,
        };
        while next <= points && next as f64 * OUTPUT_STEP <= reached {
            solver.interpolate_inplace(next as f64 * OUTPUT_STEP, &mut output)?;
            next += 1;
        }
        match reason {
            OdeSolverStopReason::InternalTimestep => {}
            OdeSolverStopReason::TstopReached => break,
            OdeSolverStopReason::RootFound(time, index) => {
                solver.state_mut_back(time)?;
                let problem = solver.problem();
                let mut state = solver.state_mut();
                let mut at = [0.0; equations::MOST_STATES];
                let (at, mut slope) = (&mut at[..rig.states()], [0.0; equations::MOST_STATES]);
                for (k, value) in at.iter_mut().enumerate() {
                    *value = state.y[k];
                }
                rig.switch(index, at);
                rig.derivative(at, &mut slope[..rig.states()]);
                for (k, value) in at.iter().enumerate() {
                    state.y[k] = *value;
                    state.dy[k] = slope[k];
                }
                state.set_step_size(h0, &problem.atol, rtol, &problem.eqn, order);
                // a mutated state alone leaves the Runge-Kutta methods with the old mode's Jacobian
                let state = solver.state_clone();
                solver.set_state(state);
                switches += 1;
            }
        }
    }
    Ok(End {
        theta: solver.state().y[THETA],
        switches,
        steps: solver.get_statistics().number_of_steps as u64,
    })
}

fn simulate(rig: &Rc<Rig>, method: Method, tolerance: f64) -> Result<End> {
    rig.start();
    let (for_rhs, for_jacobian, for_roots) = (rig.clone(), rig.clone(), rig.clone());
    let states = rig.states();
    let problem = OdeBuilder::<Matrix>::new()
        .rtol(tolerance)
        .atol(vec![tolerance; states])
        .rhs_implicit(
            move |y, _p, _t, d| for_rhs.derivative(y, d),
            move |y, _p, _t, v, d| for_jacobian.jacobian_product(y, v, d),
        )
        .init(|_p, _t, y| y.fill(0.0), states)
        .root(move |y, _p, _t, r| for_roots.roots(y, r), rig.roots_count())
        .build()?;
    match method {
        Method::Bdf => march(problem.bdf::<Solver>()?, rig),
        Method::TrBdf2 => march(problem.tr_bdf2::<Solver>()?, rig),
        Method::Esdirk34 => march(problem.esdirk34::<Solver>()?, rig),
        Method::Tsit45 => march(problem.tsit45()?, rig),
    }
}

/// Sweeps tolerances with every method.
///
/// # Errors
/// When a parameter of the system is missing.
pub fn sweep(system: &System, effort: Effort) -> Result<Vec<Run>> {
    let rig = Rc::new(Rig::new(system)?);
    let mut runs = Vec::new();
    for method in Method::ALL {
        for tolerance in effort.tolerances(1e-4, method.tightest()) {
            match fastest(effort.repetitions(), || simulate(&rig, method, tolerance)) {
                Ok((seconds, end)) => runs.push(Run {
                    system: system.key.into(),
                    solver: NAME.into(),
                    configuration: method.name().into(),
                    tolerance,
                    seconds,
                    theta: end.theta,
                    error: f64::NAN,
                    switches: end.switches,
                    steps: end.steps,
                    apart: Apart::default(),
                }),
                Err(error) => eprintln!(
                    "system {}: diffsol {} at {tolerance:.0e}: {error}",
                    system.key,
                    method.name()
                ),
            }
        }
    }
    Ok(runs)
}
