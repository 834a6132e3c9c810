//! diffsol: the reduced rig with the Stribeck law under its BDF, ESDIRK and explicit Runge-Kutta methods.

use std::cell::Cell;
use std::rc::Rc;

use anyhow::{Context, Result, anyhow, bail};
use cpu_time::ProcessTime;
use diffsol::{
    NalgebraContext, NalgebraLU, NalgebraMat, NalgebraVec, OdeBuilder, OdeEquations,
    OdeSolverMethod, OdeSolverStopReason,
};

use crate::effort::Effort;
use crate::measurement::Run;
use crate::systems::{END_TIME, Law, OUTPUT_STEP, System};

/// Name in tables.
pub const NAME: &str = "diffsol";

const STATES: usize = 5;
const ROOTS: usize = 4;
const THETA: usize = 0;
const OMEGA: usize = 1;
const THETA3: usize = 2;
const OMEGA3: usize = 3;
const CURRENT: usize = 4;

type Matrix = NalgebraMat<f64>;
type Solver = NalgebraLU<f64>;

/// State of one contact.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Contact {
    Backward,
    Stuck,
    Forward,
}

impl Contact {
    fn sign(self) -> f64 {
        match self {
            Self::Backward => -1.0,
            Self::Stuck => 0.0,
            Self::Forward => 1.0,
        }
    }

    fn slips_along(torque: f64) -> Self {
        if torque > 0.0 {
            Self::Forward
        } else {
            Self::Backward
        }
    }
}

/// Contacts of disc and motor.
#[derive(Clone, Copy, Debug)]
struct Mode {
    disc: Contact,
    motor: Contact,
}

/// The rig's numbers.
#[derive(Clone, Copy, Debug)]
struct Rig {
    inertia: f64,
    stiffness: f64,
    damping: f64,
    load_radius: f64,
    mu_c: f64,
    mu_s: f64,
    omega_s: f64,
    ratio: f64,
    motor_inertia: f64,
    resistance: f64,
    inductance: f64,
    torque_constant: f64,
    back_emf: f64,
    coulomb: f64,
    viscous: f64,
    voltage: f64,
}

impl Rig {
    fn new(system: &System) -> Result<Self> {
        let Law::Stribeck {
            mu_c,
            mu_s,
            omega_s,
        } = system.law
        else {
            bail!(
                "system {}: the diffsol peer has the Stribeck law only",
                system.key
            );
        };
        let number = |name| {
            system
                .parameters()
                .iter()
                .find(|(key, _)| *key == name)
                .map(|(_, value)| *value)
                .with_context(|| format!("system {} has no parameter `{name}`", system.key))
        };
        let ratio = number("eta")?;
        Ok(Self {
            inertia: number("J2")?,
            stiffness: number("k2")?,
            damping: number("c2")?,
            load_radius: number("radius")? * number("N2")?,
            mu_c,
            mu_s,
            omega_s,
            ratio,
            motor_inertia: ratio * ratio * number("Jm")?,
            resistance: number("R")?,
            inductance: number("L")?,
            torque_constant: number("KT")?,
            back_emf: number("KE")?,
            coulomb: number("Tfm")?,
            viscous: number("Cm")?,
            voltage: number("u")?,
        })
    }

    fn shaft_torque(&self, y: &[f64]) -> f64 {
        self.damping * (y[OMEGA3] - y[OMEGA]) + self.stiffness * (y[THETA3] - y[THETA])
    }

    fn motor_torque(&self, y: &[f64]) -> f64 {
        self.ratio * (self.torque_constant * y[CURRENT] - self.viscous * self.ratio * y[OMEGA3])
            - self.shaft_torque(y)
    }

    fn breakaway(&self) -> f64 {
        self.load_radius * self.mu_s
    }

    fn fading(&self, speed: f64) -> f64 {
        (self.mu_s - self.mu_c) * (-speed / self.omega_s).exp()
    }

    fn derivative(&self, mode: Mode, y: &[f64], d: &mut [f64]) {
        d[THETA] = 0.0;
        d[OMEGA] = 0.0;
        d[THETA3] = 0.0;
        d[OMEGA3] = 0.0;
        if mode.disc != Contact::Stuck {
            let s = mode.disc.sign();
            let friction = s * self.load_radius * (self.mu_c + self.fading(s * y[OMEGA]));
            d[THETA] = y[OMEGA];
            d[OMEGA] = (self.shaft_torque(y) - friction) / self.inertia;
        }
        if mode.motor != Contact::Stuck {
            d[THETA3] = y[OMEGA3];
            d[OMEGA3] = (self.motor_torque(y) - self.ratio * self.coulomb * mode.motor.sign())
                / self.motor_inertia;
        }
        d[CURRENT] =
            (self.voltage - self.resistance * y[CURRENT] - self.back_emf * self.ratio * y[OMEGA3])
                / self.inductance;
    }

    /// Jacobian of the derivative times `v`.
    fn jacobian_product(&self, mode: Mode, y: &[f64], v: &[f64], d: &mut [f64]) {
        d[THETA] = 0.0;
        d[OMEGA] = 0.0;
        d[THETA3] = 0.0;
        d[OMEGA3] = 0.0;
        if mode.disc != Contact::Stuck {
            let slope = -self.load_radius * self.fading(mode.disc.sign() * y[OMEGA]) / self.omega_s;
            d[THETA] = v[OMEGA];
            d[OMEGA] = (self.shaft_torque(v) - slope * v[OMEGA]) / self.inertia;
        }
        if mode.motor != Contact::Stuck {
            d[THETA3] = v[OMEGA3];
            d[OMEGA3] = self.motor_torque(v) / self.motor_inertia;
        }
        d[CURRENT] = (-self.resistance * v[CURRENT] - self.back_emf * self.ratio * v[OMEGA3])
            / self.inductance;
    }

    /// Root functions, positive while the mode lasts: two for the disc, two for the motor.
    fn roots(&self, mode: Mode, y: &[f64], r: &mut [f64]) {
        let contact = |contact: Contact, speed: f64, torque: f64, breakaway: f64| match contact {
            Contact::Stuck => (breakaway - torque, breakaway + torque),
            slipping => (slipping.sign() * speed, 1.0),
        };
        (r[0], r[1]) = contact(mode.disc, y[OMEGA], self.shaft_torque(y), self.breakaway());
        (r[2], r[3]) = contact(
            mode.motor,
            y[OMEGA3],
            self.motor_torque(y),
            self.ratio * self.coulomb,
        );
    }

    /// The mode after root `index`; an arrested velocity becomes zero.
    fn switch(&self, mode: Mode, index: usize, y: &mut NalgebraVec<f64>) -> Mode {
        let state: [f64; STATES] = std::array::from_fn(|k| y[k]);
        let next = |contact: Contact, torque: f64, breakaway: f64| {
            if contact != Contact::Stuck && torque.abs() <= breakaway {
                Contact::Stuck
            } else {
                Contact::slips_along(torque)
            }
        };
        if index < 2 {
            if mode.disc != Contact::Stuck {
                y[OMEGA] = 0.0;
            }
            let at_rest = [
                state[THETA],
                y[OMEGA],
                state[THETA3],
                state[OMEGA3],
                state[CURRENT],
            ];
            Mode {
                disc: next(mode.disc, self.shaft_torque(&at_rest), self.breakaway()),
                ..mode
            }
        } else {
            if mode.motor != Contact::Stuck {
                y[OMEGA3] = 0.0;
            }
            let at_rest = [
                state[THETA],
                state[OMEGA],
                state[THETA3],
                y[OMEGA3],
                state[CURRENT],
            ];
            Mode {
                motor: next(
                    mode.motor,
                    self.motor_torque(&at_rest),
                    self.ratio * self.coulomb,
                ),
                ..mode
            }
        }
    }
}

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
            Self::Bdf | Self::Tsit45 => 1e-12,
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
fn march<'a, E, S>(mut solver: S, rig: &Rig, mode: &Cell<Mode>) -> Result<End>
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
                mode.set(rig.switch(mode.get(), index, state.y));
                let at: [f64; STATES] = std::array::from_fn(|k| state.y[k]);
                let mut slope = [0.0; STATES];
                rig.derivative(mode.get(), &at, &mut slope);
                for (k, value) in slope.into_iter().enumerate() {
                    state.dy[k] = value;
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

fn simulate(rig: &Rig, method: Method, tolerance: f64) -> Result<End> {
    let rig = *rig;
    let mode = Rc::new(Cell::new(Mode {
        disc: Contact::Stuck,
        motor: Contact::Stuck,
    }));
    let (for_rhs, for_jacobian, for_roots) = (mode.clone(), mode.clone(), mode.clone());
    let problem = OdeBuilder::<Matrix>::new()
        .rtol(tolerance)
        .atol([tolerance; STATES])
        .rhs_implicit(
            move |y, _p, _t, d| rig.derivative(for_rhs.get(), y, d),
            move |y, _p, _t, v, d| rig.jacobian_product(for_jacobian.get(), y, v, d),
        )
        .init(|_p, _t, y| y.fill(0.0), STATES)
        .root(move |y, _p, _t, r| rig.roots(for_roots.get(), y, r), ROOTS)
        .build()?;
    match method {
        Method::Bdf => march(problem.bdf::<Solver>()?, &rig, &mode),
        Method::TrBdf2 => march(problem.tr_bdf2::<Solver>()?, &rig, &mode),
        Method::Esdirk34 => march(problem.esdirk34::<Solver>()?, &rig, &mode),
        Method::Tsit45 => march(problem.tsit45()?, &rig, &mode),
    }
}

/// Whether this peer knows the system.
#[must_use]
pub fn knows(system: &System) -> bool {
    matches!(system.law, Law::Stribeck { .. }) && system.first_disc.is_none()
}

/// Sweeps tolerances with every method.
///
/// # Errors
/// When the system is not one that [`knows`] accepts.
pub fn sweep(system: &System, effort: Effort) -> Result<Vec<Run>> {
    let rig = Rig::new(system)?;
    let mut runs = Vec::new();
    for method in Method::ALL {
        for tolerance in effort.tolerances(1e-4, method.tightest()) {
            match best_of(&rig, method, tolerance, effort.repetitions()) {
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

fn best_of(rig: &Rig, method: Method, tolerance: f64, repetitions: u32) -> Result<(f64, End)> {
    let mut best: Option<(f64, End)> = None;
    for _ in 0..repetitions {
        let start = ProcessTime::now();
        let end = simulate(rig, method, tolerance)?;
        let seconds = start.elapsed().as_secs_f64();
        if best.as_ref().is_none_or(|b| seconds < b.0) {
            best = Some((seconds, end));
        }
    }
    best.ok_or_else(|| anyhow!("no repetition asked for"))
}
