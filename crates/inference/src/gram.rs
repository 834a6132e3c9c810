//! One window under one hypothesis: residuals and their derivatives, condensed to a Gram matrix.

mod sums;

use self::sums::{Slots, Sums, ZEROS};
use crate::bristle_start::deflect_bristles;
use crate::record::{CHANNELS, Run, channel};
use crate::scales::Scales;
use crate::window::{START_COMPONENTS, Start, Window, starts_of};
use nalgebra::DMatrix;
use stickslip::friction::{ContactMode, Regime, acceleration_angle};
use stickslip::integrator::{IntegrationError, Options, Simulation};
use stickslip::plant::{Contact, Rig, RigInputs, RigState, STATES, index};
use stickslip::series::{Dual, Scalar, evaluate};

/// Slots before the free numbers of a rig: start components and the torque on the disc. One on the motor has the slot behind them.
#[must_use]
pub fn first_free<S: Scalar>(rig: &Rig<S>) -> usize {
    starts_of(rig) + 1
}
/// Order of the Taylor polynomials of the motion.
const ORDER: usize = 14;
/// Most steps between two samples. A step of order 14 spans about two radians of the fastest oscillation, so that these are
/// hundreds of its periods, of which the samples would tell nothing: only trials that run away come here.
const MOST_SEGMENTS: u64 = 1000;

/// How windows are divided, for torques of their own beside the model's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pieces {
    /// Length of the pieces in each of which such a torque is held, before it is rounded to whole samples.
    pub length: f64,
    /// Whether one acts on the gearbox output, too, beside the one on the disc.
    pub on_motor: bool,
}

/// What a window is compared with.
#[derive(Clone, Copy, Debug)]
pub struct Seen<'a> {
    /// The record that the window is of.
    pub run: &'a Run,
    /// Sizes of the records.
    pub scales: &'a Scales,
    /// Standard deviations of the channels.
    pub deviations: &'a [f64; CHANNELS],
    /// How the window is divided.
    pub pieces: Pieces,
}

/// Where the motion is in one piece of a window: the coordinates against which a residual torque
/// may be structured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Time.
    pub time: f64,
    /// Disc velocity.
    pub speed: f64,
    /// Disc acceleration.
    pub acceleration: f64,
    /// Phase-plane angle α.
    pub alpha: f64,
    /// Disc angle.
    pub disc_angle: f64,
    /// Gearbox output angle.
    pub gear_angle: f64,
    /// Gearbox output velocity.
    pub gear_speed: f64,
    /// Twist θ2 − θ3.
    pub twist: f64,
    /// Normal force.
    pub normal_force: f64,
    /// Armature current.
    pub current: f64,
    /// |Friction torque| on the disc.
    pub friction: f64,
    /// Whether the disc slides through all of the piece.
    pub sliding: bool,
}

/// Sums of products of the whitened residuals and derivatives of one window.
#[derive(Clone, Debug)]
pub struct Gram {
    /// Columns: start components, torques on the disc, those on the motor where there are any, free numbers, residual.
    pub products: DMatrix<f64>,
    /// Number of start components.
    pub starts: usize,
    /// Number of pieces.
    pub pieces: usize,
    /// How the window was divided into them.
    pub divided: Pieces,
    /// Number of residuals.
    pub residuals: usize,
    /// The middle of each piece.
    pub places: Vec<Place>,
    /// State at the last sample.
    pub end: RigState<f64>,
}

impl Gram {
    /// Column of the first torque on the disc.
    pub fn disc(&self) -> usize {
        self.starts
    }

    /// Column of the first torque on the motor, where there are any.
    pub fn motor(&self) -> Option<usize> {
        self.divided.on_motor.then_some(self.starts + self.pieces)
    }

    /// Column of the first free number.
    pub fn free(&self) -> usize {
        self.motor().unwrap_or(self.starts) + self.pieces
    }

    /// Column of the residual.
    pub fn residual(&self) -> usize {
        self.products.ncols() - 1
    }

    /// The Gram matrix with only these of the free numbers.
    #[must_use]
    pub fn narrowed(&self, numbers: &[usize]) -> Self {
        let kept: Vec<usize> = (0..self.free())
            .chain(numbers.iter().map(|number| self.free() + number))
            .chain([self.residual()])
            .collect();
        Self {
            products: DMatrix::from_fn(kept.len(), kept.len(), |i, j| {
                self.products[(kept[i], kept[j])]
            }),
            places: self.places.clone(),
            ..*self
        }
    }
}

/// The run of the last window, on whose memory the next one is run.
pub type LastRun<const N: usize> = Box<Simulation<Dual<N>, Rig<Dual<N>>>>;

/// Runs the model, which has `free` free numbers, through `window` from `start`. `last` may hold a run of the same model through
/// another window, which does not change the result.
pub fn window_gram<const N: usize>(
    free: usize,
    rig: &Rig<Dual<N>>,
    seen: &Seen<'_>,
    window: &Window,
    start: &Start,
    last: &mut Option<LastRun<N>>,
) -> Result<Gram, IntegrationError> {
    let run = seen.run;
    let samples = window.last - window.first;
    let per_piece =
        ((seen.pieces.length / run.interval()).round() as usize).clamp(1, samples.max(1));
    let pieces = samples.div_ceil(per_piece);
    let is_full = rig.disc1.is_some();
    let slots = Slots {
        starts: starts_of(rig),
        free,
        on_motor: seen.pieces.on_motor,
    };
    let mut sums = Sums::new(slots, pieces);
    let delay = rig.effects.sensor_delay.map_or(Dual::ZERO, |d| d.delay);
    let torque = |piece: usize| start.torques.get(piece).copied().unwrap_or(0.0);
    let mut simulation = started(rig, run, window, start, slots, last.take())?;
    start_on_measured_branch(&mut simulation, &window.accelerations)?;
    let mut places = Vec::with_capacity(pieces);
    let mut next_disc = window.first;
    for piece in 0..pieces {
        let from = window.first + piece * per_piece;
        let to = (from + per_piece).min(window.last);
        let is_last = piece + 1 == pieces;
        let mut sliding = true;
        for sample in from..to {
            if sample > from && is_changed(run, sample) {
                let new = inputs(run, sample, slots, torque(piece));
                simulation.set_inputs(run.time[sample], new)?;
            }
            let (begin, end) = (run.time[sample], run.time[sample + 1]);
            let mut emit = |sample: usize, channel: usize, value: Dual<N>| {
                if run.has(channel) {
                    let weight = 1.0 / seen.deviations[channel];
                    let reading = run.readings[channel][sample];
                    sums.add(&value, reading, weight, zero(window, channel));
                }
            };
            // The channels of D2 show what was `delay` earlier, all others are read at the sample.
            if sample > window.first || piece == 0 {
                simulation.advance_to(begin)?;
                let at = |component: usize| simulation.component_at(component, begin);
                emit(sample, channel::THETA3, at(index::THETA3));
                emit(sample, channel::OMEGA3, at(index::OMEGA3));
                emit(sample, channel::CURRENT, at(index::CURRENT));
                if is_full {
                    emit(sample, channel::THETA1, at(index::THETA1));
                    emit(sample, channel::OMEGA1, at(index::OMEGA1));
                }
            }
            loop {
                let last_one = is_last && sample + 1 == to;
                if next_disc > window.last {
                    break;
                }
                let when = Dual::constant(run.time[next_disc]) - delay;
                let inside = when.value < end || (last_one && when.value <= end + 1e-12);
                if !inside {
                    break;
                }
                let (theta, omega) = disc_reading(&mut simulation, when)?;
                emit(next_disc, channel::THETA, theta);
                emit(next_disc, channel::OMEGA, omega);
                next_disc += 1;
            }
            simulation.advance_to(end)?;
            sliding &= !simulation.mode().disc.is_stuck();
            if is_last && sample + 1 == to {
                let at = |component: usize| simulation.component_at(component, end);
                emit(sample + 1, channel::THETA3, at(index::THETA3));
                emit(sample + 1, channel::OMEGA3, at(index::OMEGA3));
                emit(sample + 1, channel::CURRENT, at(index::CURRENT));
                if is_full {
                    emit(sample + 1, channel::THETA1, at(index::THETA1));
                    emit(sample + 1, channel::OMEGA1, at(index::OMEGA1));
                }
            }
            if sample == from + (to - from) / 2 {
                places.push(place(seen.scales, &simulation, run, sample, end));
            }
        }
        if let Some(place) = places.last_mut() {
            place.sliding = sliding;
        }
        sums.close(piece);
        if !is_last {
            let end = simulation.state_at(run.time[to]);
            sums.advance(&end, piece);
            let next = inputs(run, to, slots, torque(piece + 1));
            simulation.continue_from(run.time[to], next, |state| {
                *state = end.map(|value| Dual::constant(value.value));
                seed(state, slots.starts);
            })?;
        }
    }
    let end = simulation.state_at(run.time[window.last]);
    *last = Some(simulation);
    let residuals = sums.residuals;
    let mut products = sums.symmetric();
    without_torques(&mut products, slots.starts, &start.torques);
    Ok(Gram {
        products,
        starts: slots.starts,
        pieces,
        divided: seen.pieces,
        residuals,
        places,
        end: end.map(|component| component.value),
    })
}

/// Which encoder's zero is not known: where a run starts from angles that are known, its encoders may have been anywhere within a step.
fn zero(window: &Window, channel: usize) -> Option<usize> {
    let encoders: [usize; ZEROS] = [channel::THETA, channel::THETA3, channel::THETA1];
    let own = encoders.iter().position(|own| *own == channel);
    own.filter(|_| window.is_start_known())
}

/// Whether other inputs hold from a sample on than before it.
fn is_changed(run: &Run, sample: usize) -> bool {
    let changes = |values: &[f64]| values[sample] != values[sample - 1];
    changes(&run.voltage)
        || changes(&run.normal_force)
        || !run.normal_force_1.is_empty() && changes(&run.normal_force_1)
}

/// Tells the residuals as they would be without the torques under which the window ran, so that quadratic forms are in the
/// torques themselves wherever they were linearised.
fn without_torques(products: &mut DMatrix<f64>, first: usize, torques: &[f64]) {
    let residual = products.ncols() - 1;
    let mut change = products.column(residual) * 0.0;
    for (piece, torque) in torques.iter().enumerate() {
        change += products.column(first + piece) * *torque;
    }
    let square: f64 = torques
        .iter()
        .enumerate()
        .map(|(piece, torque)| {
            torque * (2.0 * products[(first + piece, residual)] + change[first + piece])
        })
        .sum();
    for j in 0..residual {
        products[(j, residual)] += change[j];
        products[(residual, j)] += change[j];
    }
    products[(residual, residual)] += square;
}

/// The run of `rig` at the first sample of `window`, on the memory of `last` where that is the same rig's.
fn started<const N: usize>(
    rig: &Rig<Dual<N>>,
    run: &Run,
    window: &Window,
    start: &Start,
    slots: Slots,
    last: Option<LastRun<N>>,
) -> Result<Box<Simulation<Dual<N>, Rig<Dual<N>>>>, IntegrationError> {
    let mut state: RigState<Dual<N>> = start.state.map(Dual::constant);
    seed(&mut state, slots.starts);
    deflect_bristles(rig, &mut state);
    let time = run.time[window.first];
    let torque = start.torques.first().copied().unwrap_or(0.0);
    let inputs = inputs(run, window.first, slots, torque);
    match last {
        Some(mut simulation) => {
            simulation.start_over(time, state, inputs)?;
            Ok(simulation)
        }
        None => {
            let options = Options {
                tolerance: 1e-6,
                order: ORDER,
                budget: MOST_SEGMENTS,
                ..Options::default()
            };
            Simulation::new(*rig, options, time, state, inputs).map(Box::new)
        }
    }
}

/// Puts sliding contacts whose law has branches on the one that the measured acceleration tells.
fn start_on_measured_branch<const N: usize>(
    simulation: &mut Simulation<Dual<N>, Rig<Dual<N>>>,
    accelerations: &[f64; 2],
) -> Result<(), IntegrationError> {
    let rig = simulation.system();
    let laws = [Some(rig.law), rig.disc1.map(|disc1| disc1.law)];
    let mut mode = *simulation.mode();
    let mut is_changed = false;
    for (place, contact) in [Contact::Disc, Contact::Disc1].into_iter().enumerate() {
        let (Some(law), ContactMode::Slipping(direction, _)) =
            (&laws[place], mode.contact(contact))
        else {
            continue;
        };
        if !law.has_branches() {
            continue;
        }
        let along = accelerations[place] * direction.sign();
        let regime = match (law.two_gaussian().is_some(), along < 0.0) {
            (true, _) => Regime::Free,
            (false, true) => Regime::SlowingDown,
            (false, false) => Regime::SpeedingUp,
        };
        mode.set_contact(contact, ContactMode::Slipping(direction, regime));
        mode.near[place] = along;
        is_changed = true;
    }
    if is_changed {
        simulation.set_mode(mode)
    } else {
        Ok(())
    }
}

/// Angle and velocity of the disc at `when`. A time just before the window is reached along the
/// first terms of the motion at its start.
fn disc_reading<const N: usize>(
    simulation: &mut Simulation<Dual<N>, Rig<Dual<N>>>,
    when: Dual<N>,
) -> Result<(Dual<N>, Dual<N>), IntegrationError> {
    let tau = when - simulation.segment_start();
    if tau.value < 0.0 {
        let series =
            stickslip::integrator::HybridSystem::states(simulation.system(), simulation.jet());
        return Ok((
            evaluate(&series[index::THETA][..5], tau),
            evaluate(&series[index::OMEGA][..4], tau),
        ));
    }
    simulation.advance_to(when.value)?;
    let tau = when - simulation.segment_start();
    Ok((
        simulation.component_after(index::THETA, tau),
        simulation.component_after(index::OMEGA, tau),
    ))
}

fn inputs<const N: usize>(
    run: &Run,
    sample: usize,
    slots: Slots,
    torque: f64,
) -> RigInputs<Dual<N>> {
    let force_1 = run.normal_force_1.get(sample).copied();
    let mut inputs = RigInputs::held(
        Dual::constant(run.voltage[sample]),
        Dual::constant(run.normal_force[sample]),
        Dual::constant(force_1.unwrap_or_default()),
    );
    inputs.disc_torque = Dual::variable(torque, slots.starts);
    if slots.on_motor {
        inputs.motor_torque = Dual::variable(0.0, slots.starts + 1 + slots.free);
    }
    inputs
}

fn seed<const N: usize>(state: &mut [Dual<N>; STATES], starts: usize) {
    for (slot, component) in START_COMPONENTS.into_iter().take(starts).enumerate() {
        state[component] = Dual::variable(state[component].value, slot);
    }
}

fn place<const N: usize>(
    scales: &Scales,
    simulation: &Simulation<Dual<N>, Rig<Dual<N>>>,
    run: &Run,
    sample: usize,
    time: f64,
) -> Place {
    let state = simulation.state_at(time).map(|x| x.value);
    let tau = Dual::<N>::constant(time) - simulation.segment_start();
    let series = stickslip::integrator::HybridSystem::states(simulation.system(), simulation.jet());
    let acceleration =
        stickslip::series::evaluate_derivative(&series[index::OMEGA][..=ORDER], tau).value;
    let friction = simulation.jet().friction_torque_at(tau.value).abs();
    let speed = state[index::OMEGA];
    let s = if speed < 0.0 { -1.0 } else { 1.0 };
    let (centre, semi_axis) = (0.5 * scales.speed, scales.acceleration);
    Place {
        time,
        speed,
        acceleration,
        alpha: acceleration_angle(s * speed, s * acceleration, centre, semi_axis),
        disc_angle: state[index::THETA],
        gear_angle: state[index::THETA3],
        gear_speed: state[index::OMEGA3],
        twist: state[index::THETA] - state[index::THETA3],
        normal_force: run.normal_force[sample],
        current: state[index::CURRENT],
        friction,
        sliding: true,
    }
}
