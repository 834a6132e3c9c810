//! An FMU in pursuit of a record: a controller at each of its ports pushes it along the measured motion.
//!
//! The controller is proportional and derivative, tuned to the inertia that the port shows at short times. What it adds in one pass
//! the next pass has from the start, so that its own lag shrinks as (1 − T)ⁿ, where T is the closed loop and n the number of passes.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use super::ports::Between;
use crate::component::{Component, ComponentError};
use inference::body::filter::LowPass;

/// Bandwidth of the controller over the cut-off below which its force is looked at: there |1 − T| is 1/9 after one pass.
const BANDWIDTH: f64 = 3.0;
/// Passes over a record: |1 − T| falls to 1/729.
const PASSES: usize = 3;
/// Most of the controller's angle 2π·bandwidth·step that one step may cover.
const STEP: f64 = 0.2;
/// Damping of the closed loop.
const DAMPING: f64 = 1.0;
/// First push that tells the port's inertia [N, N m], factor from one to the next, and most of them: up to 10³⁶. Only where a search for
/// a hard enough push begins and ends: nothing tells the size of the forces before one has moved the FMU.
const GENTLE: f64 = 1e-18;
const HARDER: f64 = 8.0;
const PUSHES: usize = 60;

/// What an FMU is run after.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Pursued {
    /// Variables set before the run, with their values in the FMU's units.
    pub settings: Vec<(usize, f64)>,
    /// The places where a force may be missing.
    pub ports: Vec<PursuedPort>,
    /// Inputs with their values at the samples, in the FMU's units.
    pub inputs: Vec<Driven>,
    /// Time of the first sample [s].
    pub begin: f64,
    /// Time between samples [s].
    pub interval: f64,
    /// The step that the FMU states, if any [s]: some take multiples of it alone.
    pub own_step: Option<f64>,
}

/// A place where a force may be missing, and the motion there.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct PursuedPort {
    /// The input at which the missing force acts, and what one unit of its own is in N or N m.
    pub input: (usize, f64),
    /// Output of position and what one of its unit is in m or rad.
    pub position: Option<(usize, f64)>,
    /// Output of velocity and what one of its unit is in m/s or rad/s.
    pub velocity: Option<(usize, f64)>,
    /// Variable of the load there and what one of its unit is in N or N m.
    pub load: Option<(usize, f64)>,
    /// Measured position [m or rad].
    pub measured_position: Vec<f64>,
    /// Measured velocity [m/s or rad/s].
    pub measured_velocity: Vec<f64>,
    /// Whether the position was measured, so that the FMU's is to be the same; else it may differ by a constant.
    pub is_absolute: bool,
    /// Frequency below which the force is looked at [Hz].
    pub cut_off: f64,
}

/// An input over time.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Driven {
    /// The input.
    pub variable: usize,
    /// Its values at the samples.
    pub values: Vec<f64>,
    /// What it does between them.
    pub between: Between,
}

/// What a pursuit came to at one port.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Pursuit {
    /// Force that moves the FMU as was measured, at each sample [N or N m].
    pub force: Vec<f64>,
    /// The FMU's position then [m or rad]; where no position was measured, it begins where that does.
    pub position: Vec<f64>,
    /// Its velocity [m/s or rad/s].
    pub velocity: Vec<f64>,
    /// Its acceleration [m/s² or rad/s²].
    pub acceleration: Vec<f64>,
    /// The load then [N or N m]; zero where none is named.
    pub load: Vec<f64>,
    /// Inertia that the port shows [kg or kg m²]; negative where a positive force moves the FMU backward.
    pub inertia: f64,
}

/// Why a pursuit failed.
#[derive(Debug, thiserror::Error)]
pub enum PursuitError {
    /// The FMU failed.
    #[error(transparent)]
    Component(#[from] ComponentError),
    /// The port moves nothing.
    #[error(
        "no force at the port{place} moves its coordinate: up to {most:e} was tried; name the input that acts where the output is"
    )]
    NothingMoves {
        /// The port's number, where there are several, with a blank before it.
        place: String,
        /// The largest force that was tried.
        most: f64,
    },
    /// The FMU gives something that is no number.
    #[error("the FMU's outputs at the port are not finite at t = {time} s")]
    NotFinite {
        /// When.
        time: f64,
    },
}

/// Runs `component` after a record; `tell` hears of the time that was reached. The answer has a part for each port.
///
/// # Errors
/// [`PursuitError`].
pub fn pursue(
    component: &mut dyn Component,
    pursued: &Pursued,
    tell: &mut dyn FnMut(f64),
) -> Result<Vec<Pursuit>, PursuitError> {
    let mut chase = Chase::new(component, pursued);
    let places = 0..pursued.ports.len();
    let inertias = places
        .clone()
        .map(|place| chase.inertia(place, tell))
        .collect::<Result<Vec<f64>, PursuitError>>()?;
    let nothing: Vec<Vec<f64>> = vec![vec![0.0; chase.steps()]; inertias.len()];
    let mut courses = chase.pass(&inertias, &nothing, tell)?;
    for _ in 1..PASSES {
        let ahead: Vec<Vec<f64>> = courses
            .iter()
            .zip(&pursued.ports)
            .map(|(course, port)| {
                LowPass::new(BANDWIDTH * port.cut_off, 4, chase.step).apply(&course.force)
            })
            .collect();
        courses = chase.pass(&inertias, &ahead, tell)?;
    }
    let of_ports = courses.iter().zip(inertias);
    Ok(of_ports
        .map(|(course, inertia)| course.sampled(inertia, chase.substeps, chase.step))
        .collect())
}

/// Force and motion at a port in steps of the controller.
struct Course {
    /// Force over each step.
    force: Vec<f64>,
    /// Motion at the ends of the steps.
    motion: Vec<Moved>,
}

impl Course {
    /// Means over the steps half a sample before and after each sample.
    fn sampled(&self, inertia: f64, substeps: usize, step: f64) -> Pursuit {
        let half = substeps / 2;
        let spans: Vec<(usize, usize)> = (0..=self.force.len())
            .step_by(substeps)
            .map(|at| (at.saturating_sub(half), (at + half).min(self.force.len())))
            .collect();
        let mean = |of: &dyn Fn(usize) -> f64| -> Vec<f64> {
            let over =
                |&(from, to): &(usize, usize)| (from..to).map(of).sum::<f64>() / (to - from) as f64;
            spans.iter().map(over).collect()
        };
        let middle = |of: fn(&Moved) -> f64, at: usize| {
            0.5 * (of(&self.motion[at]) + of(&self.motion[at + 1]))
        };
        let gained = |at: usize| (self.motion[at + 1].velocity - self.motion[at].velocity) / step;
        Pursuit {
            force: mean(&|at| self.force[at]),
            position: mean(&|at| middle(|own| own.position, at)),
            velocity: mean(&|at| middle(|own| own.velocity, at)),
            acceleration: mean(&gained),
            load: mean(&|at| middle(|own| own.load, at)),
            inertia,
        }
    }
}

/// Motion at a part of the way between two samples, on the cubic that has their positions and velocities (Hermite's). A straight line
/// would cut the corners, and the controller would push the FMU along the cut.
fn between(position: [f64; 2], velocity: [f64; 2], interval: f64, part: f64) -> Moved {
    let [from, to] = position;
    let [leaving, arriving] = velocity.map(|own| own * interval);
    let bend = 3.0 * (to - from) - 2.0 * leaving - arriving;
    let twist = leaving + arriving - 2.0 * (to - from);
    Moved {
        position: from + part * (leaving + part * (bend + part * twist)),
        velocity: (leaving + part * (2.0 * bend + part * 3.0 * twist)) / interval,
        load: 0.0,
    }
}

/// How many steps an interval [s] between samples is cut into where forces are looked at below `cut_off` [Hz], and their length [s].
///
/// They are even in number: half of them before a sample and half behind it are one interval, over which what a held input does
/// between samples has no mean. Over a longer stretch it has one, which changes as the input does and passes for a delay.
///
/// They are multiples of the step that the FMU states (`own_step` [s]), where the interval is an even multiple of it.
#[must_use]
pub fn substeps(interval: f64, cut_off: f64, own_step: Option<f64>) -> (usize, f64) {
    let pairs = (interval * TAU * BANDWIDTH * cut_off / (2.0 * STEP)).ceil();
    let least = 2 * (pairs as usize).max(1);
    let own = own_step.map_or(0.0, |own| interval / own);
    let is_whole = (own - own.round()).abs() < 1e-6 * own;
    let own = if is_whole { own.round() as usize } else { 0 };
    let count = (least..=own)
        .step_by(2)
        .find(|count| own % count == 0)
        .unwrap_or(least);
    (count, interval / count as f64)
}

/// The controllers and what they control.
struct Chase<'a> {
    component: &'a mut dyn Component,
    pursued: &'a Pursued,
    outputs: Vec<usize>,
    /// Angular frequency of each port's closed loop [rad/s].
    bandwidths: Vec<f64>,
    substeps: usize,
    step: f64,
    is_begun: bool,
}

/// The FMU's motion at a port at one time.
#[derive(Clone, Copy, Default)]
struct Moved {
    position: f64,
    velocity: f64,
    load: f64,
}

impl<'a> Chase<'a> {
    fn new(component: &'a mut dyn Component, pursued: &'a Pursued) -> Self {
        let ports = pursued.ports.iter();
        let fastest = ports.clone().map(|port| port.cut_off).fold(0.0, f64::max);
        let (substeps, step) = substeps(pursued.interval, fastest, pursued.own_step);
        let outputs = ports
            .clone()
            .flat_map(|port| [port.position, port.velocity, port.load]);
        Self {
            component,
            pursued,
            outputs: outputs.flatten().map(|(at, _)| at).collect(),
            bandwidths: ports.map(|port| TAU * BANDWIDTH * port.cut_off).collect(),
            substeps,
            step,
            is_begun: false,
        }
    }

    fn steps(&self) -> usize {
        let samples = self.pursued.ports.iter();
        let samples = samples.map(|port| port.measured_position.len()).min();
        samples.unwrap_or(0).saturating_sub(1) * self.substeps
    }

    fn time(&self, step: usize) -> f64 {
        self.pursued.begin + step as f64 * self.step
    }

    /// Puts the FMU at the start of the record.
    fn begin(&mut self) -> Result<(), ComponentError> {
        if self.is_begun {
            self.component.reset()?;
        }
        self.is_begun = true;
        self.component.set(&self.pursued.settings)?;
        self.set_inputs(0, &vec![0.0; self.bandwidths.len()])?;
        self.component
            .initialise(self.time(0), self.time(self.steps()))
    }

    /// Sets the recorded inputs over a step, and the forces.
    fn set_inputs(&mut self, step: usize, forces: &[f64]) -> Result<(), ComponentError> {
        let (sample, part) = (step / self.substeps, step % self.substeps);
        // In the middle of the step a straight line has its mean over it.
        let part = (part as f64 + 0.5) / self.substeps as f64;
        let ports = self.pursued.ports.iter().zip(forces);
        let mut values: Vec<(usize, f64)> = ports
            .map(|(port, force)| (port.input.0, force / port.input.1))
            .collect();
        for input in &self.pursued.inputs {
            let from = input.values[sample];
            let to = input.values[(sample + 1).min(input.values.len() - 1)];
            values.push((
                input.variable,
                match input.between {
                    Between::Held => from,
                    Between::Linear => from + part * (to - from),
                },
            ));
        }
        self.component.set(&values)
    }

    fn step(&mut self, step: usize) -> Result<(), ComponentError> {
        let (from, to) = (self.time(step), self.time(step + 1));
        self.component.step(from, to)
    }

    /// The motion at each port after `step` steps, given that one step earlier.
    fn moved(&mut self, step: usize, before: Option<&[Moved]>) -> Result<Vec<Moved>, PursuitError> {
        let mut values = vec![0.0; self.outputs.len()];
        self.component.get(&self.outputs, &mut values)?;
        let time = self.time(step);
        if values.iter().any(|value| !value.is_finite()) {
            return Err(PursuitError::NotFinite { time });
        }
        let mut values = values.into_iter();
        let mut read = |output: Option<(usize, f64)>| Some(output?.1 * values.next()?);
        let mut all = Vec::with_capacity(self.bandwidths.len());
        for (place, port) in self.pursued.ports.iter().enumerate() {
            let position = read(port.position);
            let velocity = read(port.velocity);
            let load = read(port.load).unwrap_or(0.0);
            let before = before.map(|all| all[place]);
            let (position, velocity) = match (position, velocity, before) {
                (Some(position), Some(velocity), _) => (position, velocity),
                (Some(position), None, Some(before)) => {
                    (position, (position - before.position) / self.step)
                }
                (Some(position), None, None) => (position, port.measured_velocity[0]),
                (None, velocity, before) => {
                    let velocity = velocity.unwrap_or(0.0);
                    let position = before.map_or(0.0, |before| {
                        before.position + 0.5 * self.step * (before.velocity + velocity)
                    });
                    (position, velocity)
                }
            };
            all.push(Moved {
                position,
                velocity,
                load,
            });
        }
        Ok(all)
    }

    /// Inertia that a port shows at the first instant [kg or kg m²]; negative where it pushes backward.
    fn inertia(&mut self, place: usize, tell: &mut dyn FnMut(f64)) -> Result<f64, PursuitError> {
        let speeds = &self.pursued.ports[place].measured_velocity;
        let speed = (speeds.iter().map(|v| v * v).sum::<f64>() / speeds.len() as f64).sqrt();
        let still = self.pushed(place, 0.0)?;
        let mut before = (0.0, 0.0);
        // From far below any plant's forces to far beyond: the first that outruns the record's motion is hard enough.
        let mut force = GENTLE;
        for _ in 0..PUSHES {
            tell(self.time(0));
            let gained = self.pushed(place, force)? - still;
            if gained.abs() > speed * self.bandwidths[place] {
                let (weaker, less) = before;
                return Ok((force - weaker) / (gained - less));
            }
            before = (force, gained);
            force *= HARDER;
        }
        Err(PursuitError::NothingMoves {
            place: match self.bandwidths.len() {
                1 => String::new(),
                _ => format!(" number {}", place + 1),
            },
            most: force,
        })
    }

    /// Acceleration at the first instant under a constant force at one port, from the velocities after one step and after two: what
    /// grows with the velocity cancels.
    fn pushed(&mut self, place: usize, force: f64) -> Result<f64, PursuitError> {
        self.begin()?;
        let mut forces = vec![0.0; self.bandwidths.len()];
        forces[place] = force;
        let mut course = vec![self.moved(0, None)?];
        for step in 0..2 {
            self.set_inputs(step, &forces)?;
            self.step(step)?;
            let moved = self.moved(step + 1, course.last().map(Vec::as_slice))?;
            course.push(moved);
        }
        let gained = |at: usize| course[at][place].velocity - course[0][place].velocity;
        Ok((4.0 * gained(1) - gained(2)) / (2.0 * self.step))
    }

    /// One pass over the record.
    fn pass(
        &mut self,
        inertias: &[f64],
        ahead: &[Vec<f64>],
        tell: &mut dyn FnMut(f64),
    ) -> Result<Vec<Course>, PursuitError> {
        self.begin()?;
        let pursued = self.pursued;
        let steps = self.steps();
        let mut moved = self.moved(0, None)?;
        let away: Vec<f64> = pursued
            .ports
            .iter()
            .zip(&moved)
            .map(|(port, moved)| {
                if port.is_absolute && port.position.is_some() {
                    0.0
                } else {
                    moved.position - port.measured_position[0]
                }
            })
            .collect();
        let mut courses: Vec<Course> = moved
            .iter()
            .map(|own| Course {
                force: Vec::with_capacity(steps),
                motion: vec![*own],
            })
            .collect();
        let mut forces = vec![0.0; courses.len()];
        for step in 0..steps {
            let (sample, part) = (step / self.substeps, step % self.substeps);
            let part = part as f64 / self.substeps as f64;
            let ends = |series: &[f64]| [series[sample], series[sample + 1]];
            for (place, port) in pursued.ports.iter().enumerate() {
                let wanted = between(
                    ends(&port.measured_position),
                    ends(&port.measured_velocity),
                    pursued.interval,
                    part,
                );
                let (inertia, bandwidth) = (inertias[place], self.bandwidths[place]);
                let stiffness = inertia * bandwidth * bandwidth;
                let drag = inertia * 2.0 * DAMPING * bandwidth;
                let own = moved[place];
                forces[place] = ahead[place][step]
                    + stiffness * (wanted.position + away[place] - own.position)
                    + drag * (wanted.velocity - own.velocity);
            }
            self.set_inputs(step, &forces)?;
            self.step(step)?;
            moved = self.moved(step + 1, Some(&moved))?;
            for ((course, force), own) in courses.iter_mut().zip(&forces).zip(&moved) {
                course.force.push(*force);
                course.motion.push(*own);
            }
            tell(self.time(step + 1));
        }
        for (course, away) in courses.iter_mut().zip(away) {
            for own in &mut course.motion {
                own.position -= away;
            }
        }
        Ok(courses)
    }
}
