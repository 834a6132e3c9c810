//! Fitting a hypothesis to many windows: Gauss–Newton steps, shortened where they do not gain, with exact derivatives.

use crate::data::{Data, grams, reduced};
use crate::evidence::Told;
use crate::gram::Gram;
use crate::hypothesis::Hypothesis;
use crate::loss;
use crate::lost_starts;
use crate::marginal::{Disturbance, Reduced};
use crate::problem::Problem;
use crate::record::Run;
use crate::window::{Begin, Start, Window};
use nalgebra::{DMatrix, DVector};
use std::sync::Arc;

/// Steps of a fit to all windows.
pub(crate) const STEPS: usize = 20;
/// Decrease of −2 ln likelihood below which a step gains nothing.
const CONVERGED: f64 = 0.05;
/// The same relative to the loss, where a model that misses something goes on gaining a little.
const RELATIVELY: f64 = 1e-5;
/// Share of a step that is tried after one that made things worse, and the factor by which the next may be longer after one that
/// gained. What records hardly tell bends the way of a step and is as far along it as priors let it: shorter steps in the same
/// direction get there, steps towards the steepest descent do not.
const SHORTER: f64 = 0.25;
const LONGER: f64 = 2.0;
/// Share of a step below which no more is tried.
const SHORTEST: f64 = 1e-4;
/// Loss that a window may gain in a step before other starts are tried for it.
const SUSPECT: f64 = 6.0;
/// Standard deviations of fluctuating friction, relative to it, among which a fit chooses.
const FLUCTUATIONS: [f64; 8] = [0.0, 0.004, 0.008, 0.016, 0.03, 0.05, 0.08, 0.15];

/// Factors by which a fit changes the fluctuation that it has chosen, until none of them gains.
const FINER: [f64; 6] = [0.8, 0.91, 0.97, 1.03, 1.1, 1.25];

/// A fitted hypothesis.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The hypothesis at its best values.
    pub hypothesis: Hypothesis,
    /// Start of each window, and its torques.
    pub starts: Vec<Start>,
    /// Gram matrix of each window at the best values; `None` where the model cannot run.
    pub grams: Vec<Option<Gram>>,
    /// Fluctuation of the friction that goes with the fit.
    pub disturbance: Disturbance,
    /// −2 ln likelihood plus prior.
    pub loss: f64,
    /// Whether the last step gained nothing more.
    pub is_converged: bool,
}

/// What a fit is at while it goes on.
struct State<'a> {
    data: &'a Data,
    fit: Fit,
    forms: Vec<Option<Reduced>>,
    /// Share of the step that the quadratic forms suggest which is tried next.
    share: f64,
}

impl Fit {
    /// `hypothesis` at its present values, from these starts of the windows.
    #[must_use]
    pub fn at(
        data: &Data,
        hypothesis: Hypothesis,
        starts: Vec<Start>,
        disturbance: Disturbance,
    ) -> Self {
        let mut hypothesis = hypothesis;
        hypothesis.clamp();
        let grams = grams(data, &hypothesis, &starts);
        let forms = reduced(data, &starts, &grams, &disturbance);
        Self {
            loss: loss::total(&forms, &hypothesis),
            hypothesis,
            starts,
            grams,
            disturbance,
            is_converged: false,
        }
    }

    /// The fit of a hypothesis that has only these of the free numbers, in their order.
    #[must_use]
    pub fn narrowed(&self, data: &Data, hypothesis: Hypothesis, numbers: Vec<usize>) -> Self {
        let narrowed = |gram: &Gram| gram.narrowed(&numbers);
        let grams: Vec<Option<Gram>> = self
            .grams
            .iter()
            .map(|gram| gram.as_ref().map(narrowed))
            .collect();
        let forms = reduced(data, &self.starts, &grams, &self.disturbance);
        Self {
            loss: loss::total(&forms, &hypothesis),
            hypothesis,
            starts: self.starts.clone(),
            grams,
            disturbance: self.disturbance,
            is_converged: false,
        }
    }

    /// The fit settled on a replica of its records, and the windows of that: in pieces only where friction fluctuates there.
    #[must_use]
    pub fn settled(&self, problem: &Problem, replica: Vec<Run>, steps: usize) -> (Self, Data) {
        let data = problem.windows_of(Arc::new(replica), Begin::Clear);
        let data = if self.disturbance == Disturbance::NONE {
            data.undivided()
        } else {
            data
        };
        let begun = Self::at(
            &data,
            self.hypothesis.clone(),
            data.anchors(),
            self.disturbance,
        );
        let settled = begun
            .with_lost_starts(&data)
            .improved_alike(&data, steps)
            .with_lost_starts(&data);
        (settled, data)
    }

    /// The fit with other starts for windows that are much worse than most, where those promise more.
    #[must_use]
    pub fn with_other_starts(mut self, data: &Data) -> Self {
        lost_starts::find_beside(self.typical_misfit(data), data, &mut self);
        self
    }

    /// The fit with better starts for windows whose start it has lost, where there are such.
    #[must_use]
    pub(crate) fn with_lost_starts(mut self, data: &Data) -> Self {
        lost_starts::find(data, &mut self);
        self
    }

    /// The fit after at most `steps` further steps, in which friction fluctuates only if it did before.
    #[must_use]
    pub fn improved_alike(self, data: &Data, steps: usize) -> Self {
        let fluctuates = self.disturbance != Disturbance::NONE;
        self.stepped(data, steps, fluctuates)
    }

    /// The fit after at most `steps` further steps.
    #[must_use]
    pub fn improved(self, data: &Data, steps: usize) -> Self {
        self.stepped(data, steps, true)
    }

    /// The same where friction does not fluctuate.
    #[must_use]
    pub fn improved_calmly(self, data: &Data, steps: usize) -> Self {
        self.stepped(data, steps, false)
    }

    fn stepped(self, data: &Data, steps: usize, fluctuates: bool) -> Self {
        let forms = self.reduced(data);
        let mut state = State {
            data,
            fit: self,
            forms,
            share: 1.0,
        };
        let anchors = data.anchors();
        let (mut quiet, mut has_looked) = (0, false);
        for _ in 0..steps {
            let before = state.fit.loss;
            let Some(trial) = state.trial(&anchors) else {
                break;
            };
            let gained = before - trial.0.loss;
            let settled = gained.abs() < state.share * (CONVERGED + RELATIVELY * before.abs());
            if gained > 0.0 {
                (state.fit, state.forms) = trial;
                state.share = (state.share * LONGER).min(1.0);
                if fluctuates {
                    state.adapt();
                }
            } else {
                state.share *= SHORTER;
            }
            quiet = if settled { quiet + 1 } else { 0 };
            if quiet >= 2 || settled && gained <= 0.0 || state.share < SHORTEST {
                if !has_looked {
                    has_looked = true;
                    if lost_starts::find(data, &mut state.fit) {
                        state.forms = state.fit.reduced(data);
                        (state.share, quiet) = (1.0, 0);
                        continue;
                    }
                }
                state.fit.is_converged = true;
                break;
            }
        }
        state.fit
    }

    /// The same numbers and starts where friction does not fluctuate.
    #[must_use]
    pub fn calm(&self, data: &Data) -> Self {
        let mut calm = self.clone();
        calm.disturbance = Disturbance::NONE;
        calm.loss = loss::total(&calm.reduced(data), &calm.hypothesis);
        calm
    }

    /// The loss that the quadratic forms promise after one more step.
    #[must_use]
    pub fn promised_loss(&self, data: &Data) -> f64 {
        let forms = self.reduced(data);
        let (curvature, gradient) = self.normal_equations(&forms);
        let ranges = self.hypothesis.step_ranges();
        match loss::step_within(&ranges, &curvature, &gradient) {
            Some(step) => self.loss - step.dot(&(gradient * 2.0 - curvature * &step)),
            None => self.loss,
        }
    }

    /// Windows with the nuisances integrated out, at the best values.
    #[must_use]
    pub fn reduced(&self, data: &Data) -> Vec<Option<Reduced>> {
        reduced(data, &self.starts, &self.grams, &self.disturbance)
    }

    fn normal_equations(&self, forms: &[Option<Reduced>]) -> (DMatrix<f64>, DVector<f64>) {
        loss::normal_equations(
            forms.iter().flatten(),
            &self.hypothesis.prior_precisions(),
            &self.hypothesis.x,
        )
    }

    /// Log evidence of the hypothesis by Laplace's approximation, window by window.
    #[must_use]
    pub fn told(&self, data: &Data) -> Told {
        let precisions = self.hypothesis.prior_precisions();
        Told::at(
            &data.windows,
            &self.reduced(data),
            &precisions,
            &self.hypothesis.x,
        )
    }

    /// Log evidence of the hypothesis.
    #[must_use]
    pub fn evidence(&self, data: &Data) -> f64 {
        self.told(data).total()
    }

    /// Whether friction would fluctuate as much as can be told or more: then it stands in for what the model lacks.
    #[must_use]
    pub fn fluctuates_most(&self) -> bool {
        FLUCTUATIONS
            .last()
            .is_some_and(|most| self.disturbance.relative >= *most)
    }

    /// Squared residuals over their number: about 1 where nothing but the instruments' noise is left.
    #[must_use]
    pub fn misfit(&self, data: &Data) -> f64 {
        let forms = self.reduced(data);
        let square: f64 = forms.iter().flatten().map(|r| r.square).sum();
        let residuals: usize = forms.iter().flatten().map(|r| r.residuals).sum();
        square / residuals.max(1) as f64
    }

    /// Squared residuals over their number in the window in the middle of all: the start of a few may not have been found.
    #[must_use]
    pub fn typical_misfit(&self, data: &Data) -> f64 {
        let mut windows: Vec<f64> = self
            .reduced(data)
            .iter()
            .flatten()
            .map(|form| form.square / form.residuals.max(1) as f64)
            .collect();
        windows.sort_by(f64::total_cmp);
        windows
            .get(windows.len() / 2)
            .copied()
            .unwrap_or(f64::INFINITY)
    }

    /// Loss of each window, judged by what the windows of the other folds teach about the free numbers.
    #[must_use]
    pub fn held_out_losses(&self, data: &Data) -> Vec<Option<f64>> {
        loss::held_out(
            &self.reduced(data),
            &self.hypothesis.prior_precisions(),
            &self.hypothesis.x,
            &self.hypothesis.step_ranges(),
            &data.folds(),
        )
    }

    /// The same as log likelihoods; windows that nothing foretells are left out of every comparison.
    #[must_use]
    pub fn foretold(&self, data: &Data) -> Told {
        Told {
            windows: self
                .held_out_losses(data)
                .into_iter()
                .map(|loss| loss.map_or(f64::NAN, |loss| -0.5 * loss))
                .collect(),
            is_start_known: data.windows.iter().map(Window::is_start_known).collect(),
            numbers: 0.0,
        }
    }
}

impl State<'_> {
    /// Chooses the fluctuation of friction anew.
    fn adapt(&mut self) {
        let mut best = (self.fit.loss, self.fit.disturbance);
        let mut found = None;
        let own = self.fit.disturbance.relative;
        let most = FLUCTUATIONS.iter().copied().fold(0.0, f64::max);
        let finer = FINER.iter().map(|factor| (factor * own).min(most));
        for relative in FLUCTUATIONS.into_iter().chain(finer) {
            let disturbance = Disturbance {
                relative,
                ..self.fit.disturbance
            };
            if disturbance == self.fit.disturbance {
                continue;
            }
            let forms = reduced(self.data, &self.fit.starts, &self.fit.grams, &disturbance);
            let loss = loss::total(&forms, &self.fit.hypothesis);
            if loss < best.0 {
                best = (loss, disturbance);
                found = Some(forms);
            }
        }
        if let Some(forms) = found {
            (self.fit.loss, self.fit.disturbance) = best;
            self.forms = forms;
        }
    }

    /// One step, shortened to the present share.
    fn trial(&self, anchors: &[Start]) -> Option<(Fit, Vec<Option<Reduced>>)> {
        let (fit, data) = (&self.fit, self.data);
        let (curvature, gradient) = fit.normal_equations(&self.forms);
        let step = bounded_step(&fit.hypothesis, &curvature, &gradient)? * self.share;
        let mut hypothesis = fit.hypothesis.clone();
        for (x, d) in hypothesis.x.iter_mut().zip(step.iter()) {
            *x += d;
        }
        hypothesis.clamp();
        let taken = DVector::from_iterator(
            step.len(),
            hypothesis
                .x
                .iter()
                .zip(&fit.hypothesis.x)
                .map(|(a, b)| a - b),
        );
        let starts: Vec<Start> = fit
            .starts
            .iter()
            .zip(&self.forms)
            .zip(&data.windows)
            .map(|((start, form), window)| match form {
                Some(form) => Start {
                    state: window.moved(&start.state, &form.start_change(&taken)),
                    torques: form.torques(&taken),
                },
                None => start.clone(),
            })
            .collect();
        let grams = grams(data, &hypothesis, &starts);
        let mut forms = reduced(data, &starts, &grams, &fit.disturbance);
        let mut trial = Fit {
            hypothesis,
            starts,
            grams,
            ..fit.clone_without_windows()
        };
        for fallback in [&fit.starts[..], anchors] {
            rescue(data, &self.forms, fallback, &mut trial, &mut forms);
        }
        trial.loss = loss::total(&forms, &trial.hypothesis);
        Some((trial, forms))
    }
}

impl Fit {
    fn clone_without_windows(&self) -> Self {
        Self {
            hypothesis: self.hypothesis.clone(),
            starts: Vec::new(),
            grams: Vec::new(),
            ..*self
        }
    }
}

/// Tries the starts of `fallback` for windows that a step has made worse: where the disc is about to break away, the motion
/// depends on the start in a way that a linear step can overshoot.
pub(crate) fn rescue(
    data: &Data,
    before: &[Option<Reduced>],
    fallback: &[Start],
    fit: &mut Fit,
    forms: &mut Vec<Option<Reduced>>,
) {
    let worse = worse(before, fallback, fit, forms);
    if worse.is_empty() {
        return;
    }
    let part = data.part(&worse);
    let part_starts: Vec<Start> = worse.iter().map(|&j| fallback[j].clone()).collect();
    let part_grams = grams(&part, &fit.hypothesis, &part_starts);
    let part_forms = reduced(&part, &part_starts, &part_grams, &fit.disturbance);
    for (((j, start), gram), form) in worse
        .into_iter()
        .zip(part_starts)
        .zip(part_grams)
        .zip(part_forms)
    {
        if loss::of_window(&form) < loss::of_window(&forms[j]) {
            (fit.starts[j], fit.grams[j]) = (start, gram);
        }
    }
    *forms = reduced(data, &fit.starts, &fit.grams, &fit.disturbance);
}

/// The windows that are clearly worse than in `others`, where they start otherwise.
pub(crate) fn worse(
    others: &[Option<Reduced>],
    starts: &[Start],
    fit: &Fit,
    forms: &[Option<Reduced>],
) -> Vec<usize> {
    (0..forms.len())
        .filter(|&j| {
            loss::of_window(&forms[j]) > loss::of_window(&others[j]) + SUSPECT
                && fit.starts[j] != starts[j]
        })
        .collect()
}

/// The step that the quadratic forms suggest within the numbers' ranges, shortened to what one step may change.
fn bounded_step(
    hypothesis: &Hypothesis,
    curvature: &DMatrix<f64>,
    gradient: &DVector<f64>,
) -> Option<DVector<f64>> {
    let step = loss::step_within(&hypothesis.step_ranges(), curvature, gradient)?;
    // All numbers are held back alike: what they do together is what makes the step right.
    let share = hypothesis
        .longest_step()
        .iter()
        .zip(&step)
        .map(|(most, change)| most / change.abs())
        .fold(1.0, f64::min);
    Some(step * share)
}
