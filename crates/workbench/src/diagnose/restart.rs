//! Restarted windows: where each starts, how far a component then goes wrong, and how far the right one would.
//!
//! A window starts from the state from which the model fits its readings best, with the measured motion as prior; the
//! start is found natively and then set in whatever component is run, so that the model and its FMUs are judged alike.

use inference::bristle_start::deflect_bristles;
use inference::data::{Data, grams, reduced};
use inference::fit::Fit;
use inference::gram::Gram;
use inference::hypothesis::Hypothesis;
use inference::marginal::Disturbance;
use inference::record::{CHANNELS, RawRecord, channel};
use inference::units::PlantUnits;
use inference::window::{PIECE, START_COMPONENTS, Start, Window};
use nalgebra::{DMatrix, DVector};
use stickslip::plant::{Rig, RigState, index};

use super::case::Judging;
use crate::component::{Component, ComponentError, position};

/// Most improvements of a window's start.
const MOST_IMPROVEMENTS: usize = 20;
/// Decrease of a window's sum of squares below which its start is good.
const GOOD: f64 = 0.01;

/// Channels of disc D2, which a delay concerns: θ2 and ω2.
const DISC_CHANNELS: usize = 2;

/// Where windows start under a model, in the plant's units, and what the right model would leave.
#[derive(Debug, Clone)]
pub struct Starts {
    /// State at each window's first sample, as fits have it; [`Self::to_set`] is for components.
    pub states: Vec<Start>,
    /// Derivatives of each window there; `None` where the model cannot run.
    pub grams: Vec<Option<Gram>>,
}

/// The best starts of all windows under `rig`, which is in the plant's units.
#[must_use]
pub fn best_starts(data: &Data, rig: &Rig<f64>) -> Starts {
    let hypothesis = Hypothesis {
        effects: Vec::new(),
        rig: *rig,
        free: Vec::new(),
        x: Vec::new(),
    };
    let mut best = improved(data, &hypothesis, data.anchors());
    let calm = Disturbance::NONE;
    let others = Fit::at(data, hypothesis.clone(), best.states.clone(), calm)
        .with_other_starts(data)
        .starts;
    let others = improved(data, &hypothesis, others);
    let others = others.states.into_iter().zip(others.grams);
    for (at, (state, gram)) in others.enumerate() {
        if misfit(&gram, &state, data, at) < misfit(&best.grams[at], &best.states[at], data, at) {
            (best.states[at], best.grams[at]) = (state, gram);
        }
    }
    best
}

/// The windows after steps from these starts towards the best ones.
fn improved(data: &Data, hypothesis: &Hypothesis, starts: Vec<Start>) -> Starts {
    let mut states = starts;
    let mut present = grams(data, hypothesis, &states);
    let mut forms = reduced(data, &states, &present, &Disturbance::NONE);
    let nothing = DVector::zeros(0);
    let mut open: Vec<usize> = (0..states.len()).collect();
    // Shares of the full step that are tried in turn where it makes a window worse.
    let mut shares = vec![1.0; states.len()];
    for _ in 0..MOST_IMPROVEMENTS {
        let part = data.part(&open);
        let trial: Vec<Start> = open
            .iter()
            .map(|&at| match &forms[at] {
                Some(form) => {
                    let change = form.start_change(&nothing).map(|x| shares[at] * x);
                    Start::from(data.windows[at].moved(&states[at].state, &change))
                }
                None => states[at].clone(),
            })
            .collect();
        let trial_grams = grams(&part, hypothesis, &trial);
        let trial_forms = reduced(&part, &trial, &trial_grams, &Disturbance::NONE);
        let mut still_open = Vec::new();
        for (((at, state), gram), form) in open.iter().zip(trial).zip(trial_grams).zip(trial_forms)
        {
            let (before, after) = (
                misfit(&present[*at], &states[*at], data, *at),
                misfit(&gram, &state, data, *at),
            );
            if after < before {
                states[*at] = state;
                present[*at] = gram;
                forms[*at] = form;
                shares[*at] = 1.0;
                if before - after > GOOD {
                    still_open.push(*at);
                }
            } else if before.is_finite() && shares[*at] > 0.2 {
                shares[*at] *= 0.3;
                still_open.push(*at);
            }
        }
        open = still_open;
        if open.is_empty() {
            break;
        }
    }
    Starts {
        states,
        grams: present,
    }
}

/// Sum of squares of a window at its start, with the prior's part; infinite where the model cannot run.
fn misfit(gram: &Option<Gram>, start: &Start, data: &Data, at: usize) -> f64 {
    let window = &data.windows[at];
    let Some(gram) = gram else {
        return f64::INFINITY;
    };
    let prior: f64 = START_COMPONENTS
        .iter()
        .zip(window.deviations)
        .map(|(&component, deviation)| {
            ((start.state[component] - window.anchor[component]) / deviation).powi(2)
        })
        .sum();
    gram.products[(gram.residual(), gram.residual())] + prior
}

impl Starts {
    /// The states to set in a component of `rig`, which is in the plant's units: SI units.
    #[must_use]
    pub fn to_set(&self, rig: &Rig<f64>, units: &PlantUnits) -> Vec<RigState<f64>> {
        self.states
            .iter()
            .map(|start| {
                let mut state = start.state;
                deflect_bristles(rig, &mut state);
                units.state_to_si(&state)
            })
            .collect()
    }

    /// Sum of squares that each window would show, on average, if the model were right and only the sensors and random
    /// friction of `disturbance` differed.
    #[must_use]
    pub fn floors(&self, data: &Data, disturbance: &Disturbance) -> Vec<Option<f64>> {
        self.grams
            .iter()
            .zip(&data.windows)
            .map(|(gram, window)| {
                gram.as_ref()
                    .and_then(|gram| floor(gram, window, disturbance))
            })
            .collect()
    }
}

fn floor(gram: &Gram, window: &Window, disturbance: &Disturbance) -> Option<f64> {
    let starts = gram.starts;
    let pieces = gram.pieces;
    let own = gram.products.view((0, 0), (starts, starts)).into_owned();
    let mut penalised = own.clone();
    for (j, deviation) in window.deviations[..starts].iter().enumerate() {
        penalised[(j, j)] += 1.0 / (deviation * deviation);
    }
    let inverse = penalised.cholesky()?.inverse();
    let hat = &inverse * &own;
    let noise = gram.residuals as f64 - 2.0 * hat.trace() + (&hat * &hat).trace();
    if disturbance.relative == 0.0 {
        return Some(noise);
    }
    let torque = gram
        .products
        .view((starts, starts), (pieces, pieces))
        .into_owned();
    let cross = gram
        .products
        .view((0, starts), (starts, pieces))
        .into_owned();
    let solved = &inverse * &cross;
    let left = torque - cross.transpose() * &solved * 2.0 + solved.transpose() * own * &solved;
    let covariance = DMatrix::from_fn(pieces, pieces, |i, j| {
        let lag = i.abs_diff(j) as f64 * PIECE / disturbance.correlation_time;
        disturbance.relative.powi(2)
            * gram.places[i].friction
            * gram.places[j].friction
            * (-lag).exp()
    });
    Some(noise + (left * covariance).trace())
}

/// A window as a component ran it.
#[derive(Debug, Clone)]
pub struct WindowCourse {
    /// Values of the channels at the window's samples, SI units; empty for those of a disc D1 that is not there.
    pub values: [Vec<f64>; CHANNELS],
    /// Friction torque on the disc at the window's samples [N m].
    pub friction: Vec<f64>,
    /// Sum of the squared differences from the readings in units of the sensors' deviations.
    pub square: f64,
    /// Number of differences.
    pub residuals: usize,
}

/// Positions of what is set and read in a component.
struct Ports {
    voltage: usize,
    normal_force: usize,
    normal_force_1: Option<usize>,
    states: Vec<(usize, usize)>,
    /// The channels that there are, and the friction torque.
    outputs: Vec<usize>,
}

/// Variables of the channels and the states that they show.
const MOTION: [(&str, usize); CHANNELS] = [
    ("theta", index::THETA),
    ("theta_dot", index::OMEGA),
    ("theta3", index::THETA3),
    ("theta3_dot", index::OMEGA3),
    ("i", index::CURRENT),
    ("theta1", index::THETA1),
    ("theta1_dot", index::OMEGA1),
];

impl Ports {
    fn of(component: &dyn Component) -> Result<Self, ComponentError> {
        let at = |name: &str| position(component, name);
        let normal_force_1 = at("N1").ok();
        let channels = if normal_force_1.is_some() {
            &MOTION[..]
        } else {
            &MOTION[..channel::THETA1]
        };
        let mut states = Vec::new();
        for &(name, state) in channels {
            states.push((at(name)?, state));
        }
        let mut outputs: Vec<usize> = states.iter().map(|(place, _)| *place).collect();
        outputs.push(at("T_f")?);
        for (name, state) in [
            ("shaft_hysteresis_torque", index::RELAXING_TORQUE),
            ("presliding_deflection", index::BRISTLE),
            ("presliding_deflection1", index::BRISTLE1),
        ] {
            if let Ok(place) = at(name) {
                states.push((place, state));
            }
        }
        Ok(Self {
            voltage: at("u")?,
            normal_force: at("N2")?,
            normal_force_1,
            states,
            outputs,
        })
    }

    fn start(
        &self,
        component: &mut dyn Component,
        run: &RawRecord,
        from: usize,
        to: usize,
        state: &RigState<f64>,
    ) -> Result<(), ComponentError> {
        component.reset()?;
        let mut values: Vec<(usize, f64)> = self
            .states
            .iter()
            .map(|&(at, index)| (at, state[index]))
            .collect();
        values.extend(self.held(run, from));
        component.set(&values)?;
        component.initialise(run.time[from], run.time[to])
    }

    fn held(&self, run: &RawRecord, sample: usize) -> Vec<(usize, f64)> {
        let mut held = vec![
            (self.voltage, run.voltage[sample]),
            (self.normal_force, run.normal_force[sample]),
        ];
        let force_1 = run.normal_force_1.get(sample);
        held.extend(self.normal_force_1.zip(force_1.copied()));
        held
    }
}

/// Whether an input differs from that of the sample before.
fn is_changed(run: &RawRecord, sample: usize) -> bool {
    [&run.voltage, &run.normal_force, &run.normal_force_1]
        .iter()
        .any(|input| input.get(sample) != input.get(sample - 1))
}

/// Runs `component` from `state` over the samples `from` … `to` of a record, SI units: its channels and the friction
/// torque on the disc [N m].
///
/// # Errors
/// Whatever the component refuses.
pub fn course(
    component: &mut dyn Component,
    run: &RawRecord,
    from: usize,
    to: usize,
    state: &RigState<f64>,
) -> Result<([Vec<f64>; CHANNELS], Vec<f64>), ComponentError> {
    let ports = Ports::of(component)?;
    ports.start(component, run, from, to, state)?;
    let mut values: [Vec<f64>; CHANNELS] = Default::default();
    let mut friction = Vec::with_capacity(to - from + 1);
    let mut row = vec![0.0; ports.outputs.len()];
    for sample in from..=to {
        if sample > from {
            component.step(run.time[sample - 1], run.time[sample])?;
            if is_changed(run, sample) {
                component.set(&ports.held(run, sample))?;
            }
        }
        component.get(&ports.outputs, &mut row)?;
        if let [channels @ .., torque] = &row[..] {
            for (channel, value) in values.iter_mut().zip(channels) {
                channel.push(*value);
            }
            friction.push(*torque);
        }
    }
    Ok((values, friction))
}

/// Runs `component` through every window from its start [SI units]; `None` where it could not.
///
/// What the disc's sensors show before `delay` [s] has passed since a window's start lies before that start and is left out.
///
/// # Errors
/// The component lacks a variable of the rig.
pub fn window_courses(
    component: &mut dyn Component,
    judging: &Judging,
    starts: &[RigState<f64>],
    delay: f64,
) -> Result<Vec<Option<WindowCourse>>, ComponentError> {
    Ports::of(component)?;
    Ok(judging
        .data
        .windows
        .iter()
        .zip(starts)
        .map(|(window, state)| {
            let run = &judging.records[window.run];
            let (values, friction) =
                course(component, run, window.first, window.last, state).ok()?;
            let shown_from = run.time[window.first] + delay;
            let (mut square, mut residuals) = (0.0, 0);
            for (channel, series) in values.iter().enumerate() {
                let readings = &run.readings[channel];
                if readings.is_empty() {
                    continue;
                }
                for (value, sample) in series.iter().zip(window.first..) {
                    if channel < DISC_CHANNELS && run.time[sample] < shown_from {
                        continue;
                    }
                    square += ((readings[sample] - value) / judging.deviations[channel]).powi(2);
                    residuals += 1;
                }
            }
            square.is_finite().then_some(WindowCourse {
                values,
                friction,
                square,
                residuals,
            })
        })
        .collect())
}
