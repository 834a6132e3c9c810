//! Windows whose start a fit has lost: the motion from there on depends on it in a way that steps along derivatives do not
//! undo, above all under laws with branches.

use nalgebra::DVector;
use stickslip::plant::{RigState, index};

use super::data::{Data, grams, reduced};
use super::fit::Fit;
use super::losses::{total_loss, window_loss};
use super::marginal::Reduced;
use super::window::Window;

/// Residual size per residual, over the median window's, from which on a window stands out.
const STANDS_OUT: f64 = 3.0;
/// Share of the windows above which they do not stand out: then the model is wrong, and no start is lost.
const FEW: f64 = 0.1;
/// Changes of the measured velocity from which a start is looked for [rad/s].
const SHIFTS: [f64; 7] = [0.0, -0.1, 0.1, -0.3, 0.3, -0.8, 0.8];
/// Steps along derivatives from each.
const STEPS: usize = 3;

impl Fit {
    /// Looks for better starts of the few windows that stand out, about the measured motion.
    pub fn find_lost_starts(&mut self, data: &Data) {
        let mut forms = self.reduced(data);
        let lost = standing_out(&forms);
        if lost.is_empty() || lost.len() as f64 > FEW * forms.len() as f64 {
            return;
        }
        let part = data.part(&lost);
        let still = DVector::zeros(self.hypothesis.dimension());
        for shift in SHIFTS {
            let mut tried: Vec<RigState<f64>> = part
                .windows
                .iter()
                .map(|window| shifted(window, shift))
                .collect();
            for _ in 0..STEPS {
                let tried_grams = grams(&part, &self.hypothesis, &tried);
                let tried_forms = reduced(&part, &tried, &tried_grams, &self.disturbance);
                let next = part.windows.iter().zip(&tried).zip(&tried_forms);
                let next: Vec<RigState<f64>> = next
                    .map(|((window, start), form)| match form {
                        Some(form) => window.moved(start, &form.start_change(&still)),
                        None => *start,
                    })
                    .collect();
                for (((&at, start), gram), form) in
                    lost.iter().zip(tried).zip(tried_grams).zip(tried_forms)
                {
                    let loss = |form: &Option<Reduced>| window_loss(form, self.judging);
                    if loss(&form) < loss(&forms[at]) {
                        (self.starts[at], self.grams[at], forms[at]) = (start, gram, form);
                    }
                }
                tried = next;
            }
        }
        self.loss = total_loss(&forms, &self.hypothesis, self.judging);
    }
}

/// Windows that leave much more than most do, or that the model cannot run through.
fn standing_out(forms: &[Option<Reduced>]) -> Vec<usize> {
    let size = |form: &Reduced| form.square / form.residuals as f64;
    let mut sizes: Vec<f64> = forms.iter().flatten().map(size).collect();
    sizes.sort_by(f64::total_cmp);
    let median = sizes.get(sizes.len() / 2).copied().unwrap_or(0.0);
    (0..forms.len())
        .filter(|&j| {
            forms[j]
                .as_ref()
                .is_none_or(|form| size(form) > STANDS_OUT * median.max(1.0))
        })
        .collect()
}

/// The measured start with another velocity, unless the disc sticks.
fn shifted(window: &Window, shift: f64) -> RigState<f64> {
    let mut start = window.anchor;
    if !window.sticks() {
        start[index::OMEGA] += shift;
    }
    start
}
