//! Windows whose start was not found: under a model that explains all others, they are left with residuals that no noise makes.
//!
//! About a breakaway, or where a law of friction has two branches, the motion depends on the start as over a cliff, and the steps
//! that derivatives suggest end on its wrong side. The end of the window before, or starts drawn about the best one find the other.

use crate::data::{Data, grams, reduced};
use crate::fit::Fit;
use crate::gram::Gram;
use crate::loss;
use crate::policy::{FAR, WRONG};
use crate::random::Random;
use crate::window::{STARTS, Start};

/// Lost windows in a row that may start from where the one before ends.
const IN_A_ROW: usize = 2;
/// Starts that are drawn for each such window.
const DRAWS: u64 = 96;
/// Scales of the draws, relative to how well the start is known, in turn.
const SCALES: [f64; 4] = [0.3, 0.1, 0.03, 0.01];

/// Looks for the starts that `fit` has lost, if it explains most windows; whether it has found a better one.
pub(crate) fn find(data: &Data, fit: &mut Fit) -> bool {
    fit.typical_misfit(data) <= WRONG && find_beside(1.0, data, fit)
}

/// The same where most windows leave `typical` squared residuals over their number.
pub(crate) fn find_beside(typical: f64, data: &Data, fit: &mut Fit) -> bool {
    let forms = fit.reduced(data);
    let lost: Vec<usize> = (0..forms.len())
        .filter(|&j| !data.windows[j].is_start_known())
        .filter(|&j| {
            forms[j]
                .as_ref()
                .is_none_or(|form| form.square > FAR * typical * form.residuals as f64)
        })
        .collect();
    if lost.is_empty() || 2 * lost.len() > forms.len() {
        return false;
    }
    let part = data.part(&lost);
    let at = |starts: Vec<Start>| {
        let grams = grams(&part, &fit.hypothesis, &starts);
        let forms = reduced(&part, &starts, &grams, &fit.disturbance);
        let losses: Vec<f64> = forms.iter().map(loss::of_window).collect();
        (starts, grams, losses)
    };
    let mut best = at(lost.iter().map(|&j| fit.starts[j].clone()).collect());
    let before = best.2.clone();
    let keep = |best: &mut (Vec<Start>, Vec<Option<Gram>>, Vec<f64>), tried: Vec<Start>| {
        let (starts, grams, losses) = at(tried);
        for (k, ((start, gram), loss)) in starts.into_iter().zip(grams).zip(losses).enumerate() {
            if loss < best.2[k] {
                (best.0[k], best.1[k], best.2[k]) = (start, gram, loss);
            }
        }
    };
    for _ in 0..IN_A_ROW {
        let tried = lost.iter().zip(&best.0).map(|(&j, own)| {
            let end = predecessor(data, j).and_then(|before| {
                let gram = match lost.binary_search(&before) {
                    Ok(k) => &best.1[k],
                    Err(_) => &fit.grams[before],
                };
                gram.as_ref().map(|gram| gram.end)
            });
            Start {
                state: end.unwrap_or(own.state),
                torques: own.torques.clone(),
            }
        });
        let tried = tried.collect();
        keep(&mut best, tried);
    }
    for draw in 0..DRAWS {
        let scale = SCALES[draw as usize % SCALES.len()];
        let drawn = lost.iter().zip(&part.windows).zip(&best.0);
        let drawn = drawn.map(|((&j, window), start)| {
            let mut random = Random::new(draw * data.windows.len() as u64 + j as u64);
            let change: [f64; STARTS] =
                std::array::from_fn(|c| scale * window.deviations[c] * random.normal());
            let from_anchor = draw < DRAWS / 2;
            let from = if from_anchor {
                &window.anchor
            } else {
                &start.state
            };
            Start {
                state: window.moved(from, &change),
                torques: start.torques.clone(),
            }
        });
        let drawn = drawn.collect();
        keep(&mut best, drawn);
    }
    let mut is_found = false;
    for (k, &j) in lost.iter().enumerate() {
        if best.2[k] < before[k] {
            (fit.starts[j], fit.grams[j]) = (best.0[k].clone(), best.1[k].clone());
            is_found = true;
        }
    }
    fit.loss = loss::total(&fit.reduced(data), &fit.hypothesis);
    is_found
}

/// The window that ends where this one starts.
fn predecessor(data: &Data, j: usize) -> Option<usize> {
    let before = j.checked_sub(1)?;
    let (own, other) = (&data.windows[j], &data.windows[before]);
    (other.run == own.run && other.last == own.first).then_some(before)
}
