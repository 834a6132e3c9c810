//! Fitting a hypothesis to many windows: damped Gauss–Newton steps with exact derivatives.

use super::data::{Data, grams, reduced};
use super::gram::Gram;
use super::hypothesis::Hypothesis;
use super::losses::{held_out_losses, normal_equations, total_loss, window_loss};
use super::marginal::{Disturbance, Reduced};
use super::robust::Robust;
use nalgebra::{Cholesky, DMatrix, DVector};
use stickslip::plant::RigState;

/// Share of the windows that tell whether a model explains the records.
const SOUND_SHARE: f64 = 0.97;
/// Typical misfit per residual of a model that explains the records: those of right models are 0.92 to 0.95.
const EXPLAINED: f64 = 0.98;
/// Misfit per residual of a window in which the model goes another way than the records.
const FAR_OFF: f64 = 3.0;
/// Relative decrease of the loss below which a fit has converged.
const CONVERGED: f64 = 1e-5;

/// A fitted hypothesis.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The hypothesis at its best values.
    pub hypothesis: Hypothesis,
    /// Start of each window.
    pub starts: Vec<RigState<f64>>,
    /// Gram matrix of each window at the best values; `None` where the model cannot run.
    pub grams: Vec<Option<Gram>>,
    /// Random disturbance that goes with the fit.
    pub disturbance: Disturbance,
    /// Bounded loss by which the fit is judged.
    pub judging: Robust,
    /// −2 ln likelihood plus prior.
    pub loss: f64,
    /// Steps taken.
    pub iterations: usize,
}

/// The relative friction disturbance that explains the windows best, with the loss that suits what is then left. Where
/// no disturbance explains them there is none: it would only hide where the model is wrong. Nor is there one beyond
/// [`Data::most_roughness`].
fn best_disturbance(
    data: &Data,
    starts: &[RigState<f64>],
    grams: &[Option<Gram>],
    hypothesis: &Hypothesis,
) -> (Disturbance, Robust) {
    let mut best = (f64::INFINITY, Disturbance::NONE, Robust::JUDGING);
    let mut undisturbed = Robust::JUDGING;
    for relative in [0.0, 0.003, 0.006, 0.012, 0.02, 0.03, 0.045, 0.065] {
        let disturbance = Disturbance {
            relative,
            ..Disturbance::NONE
        };
        let forms = reduced(data, starts, grams, &disturbance);
        let robust = Robust::adapted(&forms);
        if relative == 0.0 {
            undisturbed = robust;
        }
        let residuals = forms.iter().flatten().map(|form| form.residuals).sum();
        let loss = total_loss(&forms, hypothesis, robust) + robust.cost(residuals);
        if loss < best.0 {
            best = (loss, disturbance, robust);
        }
    }
    if best.2.misses_something() || best.1.relative > data.most_roughness {
        (Disturbance::NONE, undisturbed)
    } else {
        (best.1, best.2)
    }
}

/// How often a fit looks at the starts of another.
const SHARED_STEPS: usize = 2;
/// Loss that a window may gain in a step before other starts are tried for it.
const SUSPECT: f64 = 6.0;

/// Tries the starts of `fallback` for windows that a step has made worse: where the disc is about to
/// break away, the motion depends on the start in a way that a linear step can overshoot.
#[allow(clippy::too_many_arguments)]
fn rescue(
    data: &Data,
    hypothesis: &Hypothesis,
    disturbance: &Disturbance,
    robust: Robust,
    before: &[Option<Reduced>],
    fallback: &[RigState<f64>],
    starts: &mut [RigState<f64>],
    window_grams: &mut [Option<Gram>],
    forms: &mut [Option<Reduced>],
) {
    let worse: Vec<usize> = (0..forms.len())
        .filter(|&j| {
            window_loss(&forms[j], robust) > window_loss(&before[j], robust) + SUSPECT
                && starts[j] != fallback[j]
        })
        .collect();
    if worse.is_empty() {
        return;
    }
    let part = data.part(&worse);
    let part_starts: Vec<RigState<f64>> = worse.iter().map(|&j| fallback[j]).collect();
    let part_grams = grams(&part, hypothesis, &part_starts);
    let part_forms = reduced(&part, &part_starts, &part_grams, disturbance);
    for (((j, start), gram), form) in worse
        .into_iter()
        .zip(part_starts)
        .zip(part_grams)
        .zip(part_forms)
    {
        if window_loss(&form, robust) < window_loss(&forms[j], robust) {
            (starts[j], window_grams[j], forms[j]) = (start, gram, form);
        }
    }
}

/// The step that the quadratic forms suggest within what a step may change ([`Hypothesis::step_ranges`]): numbers that
/// would leave it stop at its end, and the others move as is best then.
fn bounded_step(
    hypothesis: &Hypothesis,
    curvature: &DMatrix<f64>,
    gradient: &DVector<f64>,
) -> Option<DVector<f64>> {
    let ranges = hypothesis.step_ranges();
    let mut step = DVector::zeros(gradient.len());
    let mut open: Vec<usize> = (0..gradient.len()).collect();
    while !open.is_empty() {
        let n = open.len();
        let own = DMatrix::from_fn(n, n, |i, j| curvature[(open[i], open[j])]);
        let pull = DVector::from_fn(n, |i, _| {
            let held: f64 = (0..step.len())
                .filter(|j| !open.contains(j))
                .map(|j| curvature[(open[i], j)] * step[j])
                .sum();
            gradient[open[i]] - held
        });
        let solved = Cholesky::new(own)?.solve(&pull);
        let mut still_open = Vec::with_capacity(n);
        for (&at, &wanted) in open.iter().zip(&solved) {
            let (low, high) = ranges[at];
            step[at] = wanted.clamp(low, high);
            if step[at] == wanted {
                still_open.push(at);
            }
        }
        if still_open.len() == n {
            break;
        }
        open = still_open;
    }
    Some(step)
}

/// Fits `hypothesis` from its present values and the given window starts. On the way the windows' own sizes say which
/// of them count; the loss of the result is that of `judging`.
pub fn fit(
    data: &Data,
    hypothesis: Hypothesis,
    starts: Vec<RigState<f64>>,
    most_iterations: usize,
    judging: Robust,
) -> Fit {
    let mut hypothesis = hypothesis;
    hypothesis.clamp();
    let present = grams(data, &hypothesis, &starts);
    fit_from(data, hypothesis, starts, present, most_iterations, judging)
}

/// As [`fit`], from Gram matrices that are known.
fn fit_from(
    data: &Data,
    hypothesis: Hypothesis,
    starts: Vec<RigState<f64>>,
    present: Vec<Option<Gram>>,
    most_iterations: usize,
    judging: Robust,
) -> Fit {
    let (mut hypothesis, mut starts, mut present) = (hypothesis, starts, present);
    let (mut disturbance, mut robust) = best_disturbance(data, &starts, &present, &hypothesis);
    let mut forms = reduced(data, &starts, &present, &disturbance);
    let mut loss = total_loss(&forms, &hypothesis, robust);
    let anchors = data.anchors();
    let mut damping = 1e-4;
    let mut iterations = 0;
    let mut quiet = 0;
    while iterations < most_iterations {
        iterations += 1;
        let (curvature, gradient) = normal_equations(
            forms.iter().flatten(),
            &hypothesis.prior_precisions(),
            &hypothesis.x,
            robust,
        );
        let mut damped = curvature.clone();
        for j in 0..damped.nrows() {
            damped[(j, j)] *= 1.0 + damping;
        }
        let Some(step) = bounded_step(&hypothesis, &damped, &gradient) else {
            break;
        };
        let mut trial = hypothesis.clone();
        for (x, d) in trial.x.iter_mut().zip(step.iter()) {
            *x += d;
        }
        trial.clamp();
        let taken = DVector::from_iterator(
            step.len(),
            trial.x.iter().zip(&hypothesis.x).map(|(a, b)| a - b),
        );
        let mut trial_starts: Vec<RigState<f64>> = starts
            .iter()
            .zip(&forms)
            .zip(&data.windows)
            .map(|((start, form), window)| match form {
                Some(form) => window.moved(start, &form.start_change(&taken)),
                None => *start,
            })
            .collect();
        let mut trial_grams = grams(data, &trial, &trial_starts);
        let mut trial_forms = reduced(data, &trial_starts, &trial_grams, &disturbance);
        for fallback in [&starts, &anchors] {
            rescue(
                data,
                &trial,
                &disturbance,
                robust,
                &forms,
                fallback,
                &mut trial_starts,
                &mut trial_grams,
                &mut trial_forms,
            );
        }
        let trial_loss = total_loss(&trial_forms, &trial, robust);
        let better = trial_loss < loss;
        let settled = (loss - trial_loss).abs() < CONVERGED * loss.abs().max(1.0) + 0.02;
        if better {
            hypothesis = trial;
            starts = trial_starts;
            present = trial_grams;
            damping = (damping * 0.1).max(1e-9);
            let (next, sharper) = best_disturbance(data, &starts, &present, &hypothesis);
            if next != disturbance || sharper != robust {
                disturbance = next;
                robust = sharper;
                forms = reduced(data, &starts, &present, &disturbance);
                loss = total_loss(&forms, &hypothesis, robust);
                quiet = if settled { quiet + 1 } else { 0 };
                if quiet >= 2 {
                    break;
                }
                continue;
            }
            forms = trial_forms;
            loss = trial_loss;
        } else {
            damping *= 30.0;
        }
        quiet = if settled { quiet + 1 } else { 0 };
        if quiet >= 2 || damping > 1e8 || (settled && !better) {
            break;
        }
    }
    let loss = total_loss(&forms, &hypothesis, judging);
    Fit {
        hypothesis,
        starts,
        grams: present,
        disturbance,
        judging,
        loss,
        iterations,
    }
}

impl Fit {
    /// A fit of the same records, which are `data`, that goes out from this one.
    pub fn further(self, data: &Data, most_iterations: usize) -> Self {
        fit_from(
            data,
            self.hypothesis,
            self.starts,
            self.grams,
            most_iterations,
            self.judging,
        )
    }

    /// The same fit on the windows of these numbers, which `part` holds.
    pub fn part(&self, part: &Data, kept: &[usize]) -> Self {
        let starts: Vec<RigState<f64>> = kept.iter().map(|&j| self.starts[j]).collect();
        let grams: Vec<Option<Gram>> = kept.iter().map(|&j| self.grams[j].clone()).collect();
        let loss = total_loss(
            &reduced(part, &starts, &grams, &self.disturbance),
            &self.hypothesis,
            self.judging,
        );
        Self {
            hypothesis: self.hypothesis.clone(),
            starts,
            grams,
            loss,
            ..*self
        }
    }

    /// `base`, which lacks the last effect of this fit, refitted from what it shares with it; `None` if that is no better.
    pub fn without_last_effect(&self, data: &Data, base: &Self) -> Option<Self> {
        let shared = base.hypothesis.dimension();
        if self.hypothesis.free.get(..base.hypothesis.free.len())? != base.hypothesis.free {
            return None;
        }
        let hypothesis = Hypothesis {
            x: self.hypothesis.x[..shared].to_vec(),
            ..base.hypothesis.clone()
        };
        let anew = fit(data, hypothesis, self.starts.clone(), 15, base.judging);
        (anew.loss < base.loss - 1.0).then_some(anew)
    }

    /// Starts windows that `other` fits better from where it starts them, as far as that is better here too: two fits are
    /// compared by their models, not by which of them has found a window's start.
    pub fn share_starts(&mut self, data: &Data, other: &Self) {
        let mut forms = self.reduced(data);
        let before = other.reduced(data);
        for _ in 0..SHARED_STEPS {
            let moved: Vec<RigState<f64>> = forms
                .iter()
                .zip(&before)
                .zip(self.starts.iter().zip(&other.starts))
                .zip(&data.windows)
                .map(|(((form, before), (own, others)), window)| {
                    let worse = window_loss(form, self.judging)
                        > window_loss(before, self.judging) + SUSPECT;
                    match form {
                        Some(form) if worse && own == others => window.moved(
                            own,
                            &form.start_change(&DVector::zeros(form.gradient.len())),
                        ),
                        _ => *others,
                    }
                })
                .collect();
            rescue(
                data,
                &self.hypothesis,
                &self.disturbance,
                self.judging,
                &before,
                &moved,
                &mut self.starts,
                &mut self.grams,
                &mut forms,
            );
        }
        self.loss = total_loss(&forms, &self.hypothesis, self.judging);
    }

    /// The same fit with a bounded loss after its own windows, by which starts that go out from it are compared.
    pub fn judged_by_itself(mut self, data: &Data) -> Self {
        let forms = self.reduced(data);
        self.judging = Robust::adapted(&forms);
        self.loss = total_loss(&forms, &self.hypothesis, self.judging);
        self
    }

    /// Whether no more than the sensors' noise is left, even without random friction.
    pub fn is_explained(&self, data: &Data) -> bool {
        self.typical_misfit(data) < EXPLAINED && self.disturbance.relative < 0.01
    }

    /// Whether no more than the sensors' noise and friction that fluctuates as real contacts do is left.
    pub fn is_explained_but_rough(&self, data: &Data) -> bool {
        self.typical_misfit(data) < EXPLAINED && self.disturbance.relative < 0.05
    }

    /// The loss that the quadratic forms promise after one more step.
    pub fn promised_loss(&self, data: &Data) -> f64 {
        let h = &self.hypothesis;
        let forms = self.reduced(data);
        let (curvature, gradient) = normal_equations(
            forms.iter().flatten(),
            &h.prior_precisions(),
            &h.x,
            self.judging,
        );
        match Cholesky::new(curvature) {
            Some(cholesky) => self.loss - gradient.dot(&cholesky.solve(&gradient)),
            None => self.loss,
        }
    }

    /// Sum of squares per residual: about 1 where nothing but the sensors' noise is left.
    pub fn misfit(&self, data: &Data) -> f64 {
        let forms = self.reduced(data);
        let square: f64 = forms.iter().flatten().map(|r| r.square).sum();
        let residuals: usize = forms.iter().flatten().map(|r| r.residuals).sum();
        square / residuals.max(1) as f64
    }

    /// Whether the model goes another way than the records in some window.
    pub fn has_a_window_far_off(&self, data: &Data) -> bool {
        self.reduced(data)
            .iter()
            .flatten()
            .any(|form| form.square > FAR_OFF * form.residuals as f64)
    }

    /// The misfit without the few worst windows, whose start may not have been found.
    pub fn typical_misfit(&self, data: &Data) -> f64 {
        let forms = self.reduced(data);
        let mut windows: Vec<&Reduced> = forms.iter().flatten().collect();
        windows.sort_by(|a, b| {
            let size = |form: &Reduced| form.square / form.residuals as f64;
            size(a).total_cmp(&size(b))
        });
        windows.truncate((SOUND_SHARE * windows.len() as f64).ceil() as usize);
        let square: f64 = windows.iter().map(|form| form.square).sum();
        let residuals: usize = windows.iter().map(|form| form.residuals).sum();
        square / residuals.max(1) as f64
    }

    /// Windows with the nuisances integrated out, at the best values.
    pub fn reduced(&self, data: &Data) -> Vec<Option<Reduced>> {
        reduced(data, &self.starts, &self.grams, &self.disturbance)
    }

    /// Loss of each window, judged by what the windows of the other folds teach about the free
    /// numbers.
    pub fn held_out_losses(&self, data: &Data, folds: &[usize]) -> Vec<f64> {
        let h = &self.hypothesis;
        held_out_losses(
            &self.reduced(data),
            &h.prior_precisions(),
            &h.x,
            folds,
            Robust::JUDGING,
        )
    }
}
