//! Records cut into windows, and what a hypothesis makes of each.

use std::sync::Arc;

use rayon::prelude::*;
use stickslip::plant::RigState;

use super::gram::{FEW_SLOTS, FIRST_FREE, Gram, MANY_SLOTS, window_gram};
use super::hypothesis::Hypothesis;
use super::marginal::{Disturbance, Reduced, reduce};
use super::run::{CHANNELS, Run};
use super::window::{Cut, START_COMPONENTS, Window};

/// The records and windows that fits work on.
#[derive(Clone, Debug)]
pub struct Data {
    /// Records.
    pub runs: Arc<Vec<Run>>,
    /// How they were cut.
    pub cut: Cut,
    /// Windows of all records.
    pub windows: Vec<Window>,
    /// Standard deviations of the channels.
    pub deviations: [f64; CHANNELS],
    /// Standard deviation of the friction relative to itself beyond which it is not taken to fluctuate at all.
    pub most_roughness: f64,
    /// Standard deviation of the law's breakaway level relative to itself, where breakaways that scatter tell of it; else 0.
    pub breakaway_deviation: f64,
}

impl Data {
    /// Records cut into windows.
    pub fn new(runs: Arc<Vec<Run>>, cut: Cut, deviations: [f64; CHANNELS]) -> Self {
        let windows = runs
            .iter()
            .enumerate()
            .flat_map(|(index, run)| cut.windows(index, run))
            .collect();
        Self {
            runs,
            cut,
            windows,
            deviations,
            most_roughness: f64::INFINITY,
            breakaway_deviation: 0.0,
        }
    }

    /// The same records cut into windows of another length [s].
    pub fn recut(&self, length: f64) -> Self {
        let cut = Cut { length, ..self.cut };
        let mut anew = Self {
            most_roughness: self.most_roughness,
            breakaway_deviation: self.breakaway_deviation,
            ..Self::new(Arc::clone(&self.runs), cut, self.deviations)
        };
        for window in &mut anew.windows {
            let holds = |other: &&Window| {
                other.run == window.run && (other.first..other.last).contains(&window.first)
            };
            if let Some(holder) = self.windows.iter().find(holds) {
                window.breakaway = holder.breakaway;
            }
        }
        anew
    }

    /// The same records where friction is not taken to fluctuate by more than `most_roughness` of itself.
    pub fn with_roughness_up_to(&self, most_roughness: f64) -> Self {
        Self {
            most_roughness,
            ..self.clone()
        }
    }

    /// The starts of the windows as measured.
    pub fn anchors(&self) -> Vec<RigState<f64>> {
        self.windows.iter().map(|window| window.anchor).collect()
    }

    /// The same records with only the windows of these numbers.
    pub fn part(&self, kept: &[usize]) -> Self {
        Self {
            runs: Arc::clone(&self.runs),
            windows: kept.iter().map(|&j| self.windows[j].clone()).collect(),
            ..*self
        }
    }
}

fn offset(start: &RigState<f64>, window: &Window) -> [f64; START_COMPONENTS.len()] {
    std::array::from_fn(|j| start[START_COMPONENTS[j]] - window.anchor[START_COMPONENTS[j]])
}

/// Gram matrices of all windows under a hypothesis.
pub fn grams(data: &Data, hypothesis: &Hypothesis, starts: &[RigState<f64>]) -> Vec<Option<Gram>> {
    if hypothesis.dimension() + FIRST_FREE <= FEW_SLOTS {
        grams_with_slots::<FEW_SLOTS>(data, hypothesis, starts)
    } else {
        grams_with_slots::<MANY_SLOTS>(data, hypothesis, starts)
    }
}

fn grams_with_slots<const N: usize>(
    data: &Data,
    hypothesis: &Hypothesis,
    starts: &[RigState<f64>],
) -> Vec<Option<Gram>> {
    let Ok(rig) = hypothesis.rig_with_slots::<N>(FIRST_FREE) else {
        return vec![None; data.windows.len()];
    };
    data.windows
        .par_iter()
        .zip(starts)
        .map_init(
            || None,
            |last, (window, start)| {
                let run = &data.runs[window.run];
                let free = hypothesis.dimension();
                window_gram(free, &rig, run, window, start, &data.deviations, last).ok()
            },
        )
        .collect()
}

/// Windows with their nuisances integrated out.
pub fn reduced(
    data: &Data,
    starts: &[RigState<f64>],
    grams: &[Option<Gram>],
    disturbance: &Disturbance,
) -> Vec<Option<Reduced>> {
    grams
        .par_iter()
        .zip(starts)
        .zip(&data.windows)
        .map(|((gram, start), window)| {
            gram.as_ref()
                .and_then(|g| reduce(g, &offset(start, window), &window.deviations, disturbance))
        })
        .collect()
}
