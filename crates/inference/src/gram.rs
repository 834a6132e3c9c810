//! One window under one hypothesis: residuals and their derivatives, condensed to a Gram matrix.

use crate::bristle_start::deflect_bristles;
use crate::record::{CHANNELS, Run, channel};
use crate::scales::Scales;
use crate::window::{START_COMPONENTS, STARTS, Start, Window, starts_of};
use nalgebra::DMatrix;
use stickslip::friction::{ContactMode, Regime, acceleration_angle};
use stickslip::integrator::{IntegrationError, Options, Simulation};
use stickslip::plant::{Contact, Rig, RigInputs, RigState, STATES, index};
use stickslip::series::{Dual, Scalar, evaluate};

/// Slots before the free numbers of a rig: start components and two disturbance torques.
#[must_use]
pub fn first_free<S: Scalar>(rig: &Rig<S>) -> usize {
    starts_of(rig) + 2
}
/// Order of the Taylor polynomials of the motion.
const ORDER: usize = 14;
/// Most steps between two samples. A step of order 14 spans about two radians of the fastest oscillation, so that these are
/// hundreds of its periods, of which the samples would tell nothing: only trials that run away come here.
const MOST_SEGMENTS: u64 = 1000;
/// Most columns of a Gram matrix: two for each of the small pieces, of which rounding to whole samples can make half as many again,
/// and those of start, free numbers and residual.
const MOST_COLUMNS: usize = 192;

type Chain = [[f64; MOST_COLUMNS]; STARTS];

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
    /// Columns: start components, disc disturbances, motor disturbances, free numbers, residual.
    pub products: DMatrix<f64>,
    /// Number of start components.
    pub starts: usize,
    /// Number of disturbance pieces.
    pub pieces: usize,
    /// Length of a piece, before it is rounded to whole samples.
    pub piece_length: f64,
    /// Number of residuals.
    pub residuals: usize,
    /// The middle of each piece.
    pub places: Vec<Place>,
}

impl Gram {
    /// Column of the first disc disturbance.
    pub fn disc(&self) -> usize {
        self.starts
    }

    /// Column of the first motor disturbance.
    pub fn motor(&self) -> usize {
        self.disc() + self.pieces
    }

    /// Column of the first free number.
    pub fn free(&self) -> usize {
        self.disc() + 2 * self.pieces
    }

    /// Column of the residual.
    pub fn residual(&self) -> usize {
        self.products.ncols() - 1
    }
}

/// The run of the last window, on whose memory the next one is run.
pub type LastRun<const N: usize> = Box<Simulation<Dual<N>, Rig<Dual<N>>>>;

/// Runs the model, which has `free` free numbers, through `window` from `start`.
///
/// `whitening` holds the standard deviations of the channels; a torque of its own acts on disc and motor in each piece of
/// `piece_length`. `last` may hold a run of the same model through another window,
/// which does not change the result.
#[allow(clippy::too_many_arguments)]
pub fn window_gram<const N: usize>(
    free: usize,
    rig: &Rig<Dual<N>>,
    run: &Run,
    scales: &Scales,
    window: &Window,
    start: &Start,
    whitening: &[f64; CHANNELS],
    piece_length: f64,
    last: &mut Option<LastRun<N>>,
) -> Result<Gram, IntegrationError> {
    let samples = window.last - window.first;
    let per_piece = ((piece_length / run.interval()).round() as usize).clamp(1, samples.max(1));
    let pieces = samples.div_ceil(per_piece);
    let starts = starts_of(rig);
    let is_full = rig.outer.is_some();
    let columns = starts + 2 * pieces + free + 1;
    let mut products = DMatrix::zeros(columns, columns);
    // Derivatives of the present piece's start with respect to all columns but the residual's.
    let mut chain = [[0.0; MOST_COLUMNS]; STARTS];
    for (j, row) in chain.iter_mut().enumerate() {
        row[j] = 1.0;
    }
    let delay = rig.effects.sensor_delay.map_or(Dual::ZERO, |d| d.delay);
    let torque = |piece: usize| start.torques.get(piece).copied().unwrap_or(0.0);
    let mut simulation = started(rig, run, window, start, last.take())?;
    start_on_measured_branch(&mut simulation, &window.accelerations)?;
    let mut places = Vec::with_capacity(pieces);
    let mut row = vec![0.0; columns];
    let mut residuals = 0;
    let mut next_disc = window.first;
    for piece in 0..pieces {
        let from = window.first + piece * per_piece;
        let to = (from + per_piece).min(window.last);
        let is_last = piece + 1 == pieces;
        let mut sliding = true;
        for sample in from..to {
            if sample > from {
                let new = inputs(run, sample, starts, torque(piece));
                let old = simulation.inputs();
                if new.voltage[0].value != old.voltage[0].value
                    || new.normal_force[0].value != old.normal_force[0].value
                    || new.normal_force_1[0].value != old.normal_force_1[0].value
                {
                    simulation.set_inputs(run.time[sample], new)?;
                }
            }
            let (begin, end) = (run.time[sample], run.time[sample + 1]);
            let mut emit = |sample: usize, channel: usize, value: Dual<N>| {
                let weight = 1.0 / whitening[channel];
                if !run.has(channel) {
                    return;
                }
                local_row(
                    &value,
                    weight,
                    piece,
                    pieces,
                    free,
                    &chain[..starts],
                    &mut row,
                );
                row[columns - 1] = (run.readings[channel][sample] - value.value) * weight;
                accumulate(&row, &mut products);
                residuals += 1;
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
                places.push(place(scales, &simulation, run, sample, end));
            }
        }
        if let Some(place) = places.last_mut() {
            place.sliding = sliding;
        }
        if !is_last {
            let end = simulation.state_at(run.time[to]);
            advance_chain(&end, piece, pieces, free, &mut chain[..starts]);
            let next = inputs(run, to, starts, torque(piece + 1));
            simulation.continue_from(run.time[to], next, |state| {
                *state = end.map(|value| Dual::constant(value.value));
                seed(state, starts);
            })?;
        }
    }
    for i in 0..columns {
        for j in 0..i {
            products[(i, j)] = products[(j, i)];
        }
    }
    *last = Some(simulation);
    without_torques(&mut products, starts, &start.torques);
    Ok(Gram {
        products,
        starts,
        pieces,
        piece_length,
        residuals,
        places,
    })
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
    last: Option<LastRun<N>>,
) -> Result<Box<Simulation<Dual<N>, Rig<Dual<N>>>>, IntegrationError> {
    let mut state: RigState<Dual<N>> = start.state.map(Dual::constant);
    seed(&mut state, starts_of(rig));
    deflect_bristles(rig, &mut state);
    let time = run.time[window.first];
    let torque = start.torques.first().copied().unwrap_or(0.0);
    let inputs = inputs(run, window.first, starts_of(rig), torque);
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
    let laws = [Some(rig.law), rig.outer.map(|outer| outer.law)];
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
    let series = stickslip::integrator::HybridSystem::states(simulation.system(), simulation.jet());
    Ok((
        evaluate(&series[index::THETA][..=ORDER], tau),
        evaluate(&series[index::OMEGA][..=ORDER], tau),
    ))
}

fn inputs<const N: usize>(
    run: &Run,
    sample: usize,
    starts: usize,
    torque: f64,
) -> RigInputs<Dual<N>> {
    let force_1 = run.normal_force_1.get(sample).copied();
    let mut inputs = RigInputs::held(
        Dual::constant(run.voltage[sample]),
        Dual::constant(run.normal_force[sample]),
        Dual::constant(force_1.unwrap_or_default()),
    );
    inputs.disc_torque = Dual::variable(torque, starts);
    inputs.motor_torque = Dual::variable(0.0, starts + 1);
    inputs
}

fn seed<const N: usize>(state: &mut [Dual<N>; STATES], starts: usize) {
    for (slot, component) in START_COMPONENTS.into_iter().take(starts).enumerate() {
        state[component] = Dual::variable(state[component].value, slot);
    }
}

/// The derivatives of `value` with respect to all columns, times `weight`.
fn local_row<const N: usize>(
    value: &Dual<N>,
    weight: f64,
    piece: usize,
    pieces: usize,
    free: usize,
    chain: &[[f64; MOST_COLUMNS]],
    row: &mut [f64],
) {
    let starts = chain.len();
    let columns = starts + 2 * pieces + free;
    row[..columns].fill(0.0);
    for (slot, chain_row) in chain.iter().enumerate() {
        let d = value.derivative[slot] * weight;
        if d != 0.0 {
            for (r, c) in row[..columns].iter_mut().zip(chain_row) {
                *r += d * c;
            }
        }
    }
    row[starts + piece] += value.derivative[starts] * weight;
    row[starts + pieces + piece] += value.derivative[starts + 1] * weight;
    for j in 0..free {
        row[starts + 2 * pieces + j] += value.derivative[starts + 2 + j] * weight;
    }
}

fn advance_chain<const N: usize>(
    end: &RigState<Dual<N>>,
    piece: usize,
    pieces: usize,
    free: usize,
    chain: &mut [[f64; MOST_COLUMNS]],
) {
    let mut next: Chain = [[0.0; MOST_COLUMNS]; STARTS];
    for (row, component) in next[..chain.len()].iter_mut().zip(START_COMPONENTS) {
        local_row(&end[component], 1.0, piece, pieces, free, chain, row);
    }
    chain.copy_from_slice(&next[..chain.len()]);
}

fn accumulate(row: &[f64], products: &mut DMatrix<f64>) {
    for (j, &b) in row.iter().enumerate() {
        if b != 0.0 {
            let column = &mut products.column_mut(j);
            for (i, &a) in row[..=j].iter().enumerate() {
                column[i] += a * b;
            }
        }
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
