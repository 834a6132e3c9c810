//! Records cut into windows, and what a hypothesis makes of each.

use std::sync::Arc;

use rayon::prelude::*;
use stickslip::plant::Rig;

use crate::gram::{Gram, Pieces, Seen, first_free, window_gram};
use crate::hypothesis::Hypothesis;
use crate::load_error::integrate_out;
use crate::marginal::{Disturbance, Reduced, reduce};
use crate::record::{CHANNELS, Run};
use crate::scales::Scales;
use crate::window::{Begin, Cut, FINE_PIECE, PIECE, START_COMPONENTS, STARTS, Start, Window};

/// Derivative slots for hypotheses of ordinary size. Slots come in fours, which are summed together.
const FEW_SLOTS: usize = 20;
/// Derivative slots for the largest hypotheses.
const MANY_SLOTS: usize = 32;
/// Most small pieces of a window.
const MOST_FINE_PIECES: f64 = 50.0;
/// Windows in a row that are one block: neighbours are not independent. What half of the blocks teach is judged on the other
/// half, and the scatter of blocks gives the error of a difference.
pub(crate) const BLOCK: usize = 4;
/// Folds of the windows: what each teaches is judged on the others.
pub(crate) const FOLDS: usize = 2;

/// Most free numbers that a hypothesis on this rig may have.
#[must_use]
pub fn most_free(rig: &Rig<f64>) -> usize {
    MANY_SLOTS - first_free(rig) - 1
}

/// The records and windows that fits work on.
#[derive(Clone, Debug)]
pub struct Data {
    /// Records.
    pub runs: Arc<Vec<Run>>,
    /// Windows of all records.
    pub windows: Vec<Window>,
    /// Standard deviations of the channels.
    pub deviations: [f64; CHANNELS],
    /// Sizes of the records.
    pub scales: Scales,
    /// How windows are divided, for torques of their own beside the model's.
    pub pieces: Pieces,
}

impl Data {
    /// Records of `rig` cut into windows of `length`.
    #[must_use]
    pub fn new(
        runs: Arc<Vec<Run>>,
        rig: &Rig<f64>,
        scales: Scales,
        deviations: [f64; CHANNELS],
        length: f64,
        begin: Begin,
    ) -> Self {
        let cut = Cut::of(rig, &scales, length, begin);
        let windows = runs
            .iter()
            .enumerate()
            .flat_map(|(index, run)| cut.windows(index, run))
            .collect();
        Self {
            runs,
            windows,
            deviations,
            scales,
            pieces: Pieces {
                length: PIECE,
                on_motor: false,
            },
        }
    }

    /// The same windows in one piece each: much cheaper, where no torque is free beside the model's.
    #[must_use]
    pub fn undivided(self) -> Self {
        self.in_pieces(f64::INFINITY)
    }

    fn in_pieces(self, length: f64) -> Self {
        let pieces = Pieces {
            length,
            ..self.pieces
        };
        Self { pieces, ..self }
    }

    /// The same windows, where a torque of its own may act on the motor, too.
    #[must_use]
    pub fn with_motor_torques(self) -> Self {
        let pieces = Pieces {
            on_motor: true,
            ..self.pieces
        };
        Self { pieces, ..self }
    }

    /// The same windows in pieces so small that coordinates hardly change within one.
    #[must_use]
    pub fn finely_divided(self) -> Self {
        let length = |window: &Window| {
            let samples = (window.last - window.first) as f64;
            samples * self.runs[window.run].interval()
        };
        let longest = self.windows.iter().map(length).fold(0.0, f64::max);
        self.in_pieces(FINE_PIECE.max(longest / MOST_FINE_PIECES))
    }

    /// The same windows in pieces.
    #[must_use]
    pub fn divided(self) -> Self {
        self.in_pieces(PIECE)
    }

    /// The starts of the windows as measured.
    #[must_use]
    pub fn anchors(&self) -> Vec<Start> {
        self.windows
            .iter()
            .map(|window| Start::from(window.anchor))
            .collect()
    }

    /// The same records with only the windows of these numbers.
    #[must_use]
    pub fn part(&self, kept: &[usize]) -> Self {
        Self {
            runs: Arc::clone(&self.runs),
            windows: kept.iter().map(|&j| self.windows[j].clone()).collect(),
            ..*self
        }
    }

    /// Folds of the windows: blocks in turn, and runs begin with each in turn, since what shows only where runs begin must
    /// teach both halves.
    #[must_use]
    pub fn folds(&self) -> Vec<usize> {
        let mut folds = Vec::new();
        let (mut present, mut first) = (None, 0);
        for (j, window) in self.windows.iter().enumerate() {
            if present != Some(window.run) {
                (present, first) = (Some(window.run), j);
            }
            folds.push(((j - first) / BLOCK + window.run) % FOLDS);
        }
        folds
    }
}

fn offset(start: &Start, window: &Window) -> [f64; STARTS] {
    std::array::from_fn(|j| start.state[START_COMPONENTS[j]] - window.anchor[START_COMPONENTS[j]])
}

/// Gram matrices of all windows under a hypothesis; `None` where the model cannot run.
#[must_use]
pub fn grams(data: &Data, hypothesis: &Hypothesis, starts: &[Start]) -> Vec<Option<Gram>> {
    let slots =
        first_free(&hypothesis.rig) + hypothesis.dimension() + usize::from(data.pieces.on_motor);
    if slots <= FEW_SLOTS {
        grams_with_slots::<FEW_SLOTS>(data, hypothesis, starts)
    } else {
        grams_with_slots::<MANY_SLOTS>(data, hypothesis, starts)
    }
}

fn grams_with_slots<const N: usize>(
    data: &Data,
    hypothesis: &Hypothesis,
    starts: &[Start],
) -> Vec<Option<Gram>> {
    let Ok(rig) = hypothesis.rig_with_slots::<N>(first_free(&hypothesis.rig)) else {
        return vec![None; data.windows.len()];
    };
    let free = hypothesis.dimension();
    data.windows
        .par_iter()
        .zip(starts)
        .map_init(
            || None,
            |last, (window, start)| {
                let seen = Seen {
                    run: &data.runs[window.run],
                    scales: &data.scales,
                    deviations: &data.deviations,
                    pieces: data.pieces,
                };
                window_gram(free, &rig, &seen, window, start, last).ok()
            },
        )
        .collect()
}

/// Windows with their nuisances integrated out.
#[must_use]
pub fn reduced(
    data: &Data,
    starts: &[Start],
    grams: &[Option<Gram>],
    disturbance: &Disturbance,
) -> Vec<Option<Reduced>> {
    let (mut forms, errors): (Vec<_>, Vec<_>) = grams
        .par_iter()
        .zip(starts)
        .zip(&data.windows)
        .map(|((gram, start), window)| {
            let load_deviation = window.load.map_or(0.0, |level| level.deviation);
            let (offset, deviations) = (offset(start, window), &window.deviations);
            gram.as_ref()
                .and_then(|gram| reduce(gram, &offset, deviations, disturbance, load_deviation))
                .unzip()
        })
        .unzip();
    integrate_out(&data.windows, &data.folds(), &mut forms, &errors);
    forms
}
