//! Where the algebraic loops of Eqs 6-1 and 6-2 fold.

use super::switching::velocity_of;
use super::{Contact, Rig, RigJet, RigMode};
use crate::friction::{ContactMode, Regime, TwoGaussian};
use crate::series::{Scalar, Series, TERMS, TangentWeights, VerticalTangent, evaluate};

/// Margin 1 + (∂T/∂a)/J below which the algebraic loop may be about to fold.
const FOLD_MARGIN: f64 = 1.0;
/// Times, in steps, at which the margin is looked at: at the end of a step that only just passed a fold it is still almost zero.
const LOOKS: [f64; 2] = [1.0, 1.25];
/// Most times that a step is halved: a fold nearer than that tells itself.
const HALVINGS: i32 = 10;

/// The loop of a sliding contact in the course of a segment, without derivatives.
struct Loop {
    contact: Contact,
    law: TwoGaussian<f64>,
    inertia: f64,
    /// 1 + (∂T/∂a)/J at the segment's start.
    margin: f64,
    order: usize,
    load: Series<f64>,
    speed: Series<f64>,
    acceleration: Series<f64>,
}

/// The loops of the contacts that slide in `mode`.
fn loops<S: Scalar>(rig: &Rig<S>, mode: &RigMode, jet: &RigJet<S>) -> impl Iterator<Item = Loop> {
    let disc = Some((&rig.law, rig.disc.inertia, &jet.disc));
    let disc1 = (rig.outer.as_ref().zip(jet.disc1.as_deref()))
        .map(|(outer, pin)| (&outer.law, outer.disc.inertia, pin));
    let order = jet.order;
    let modes = [mode.disc, mode.disc1];
    let contacts = [(Contact::Disc, disc), (Contact::Disc1, disc1)];
    contacts
        .into_iter()
        .zip(modes)
        .filter_map(move |((contact, parts), mode)| {
            let (law, inertia, pin) = parts?;
            let law = law.two_gaussian()?;
            let ContactMode::Slipping(_, Regime::Free) = mode else {
                return None;
            };
            let slip = &pin.slip;
            let plain = |series: &Series<S>| series.map(S::value);
            (!slip.between).then(|| Loop {
                contact,
                law: law.plain(),
                inertia: inertia.value(),
                margin: slip.margin,
                order,
                load: plain(&pin.load),
                speed: plain(&slip.speed),
                acceleration: plain(&slip.acceleration),
            })
        })
}

impl Loop {
    /// Local time of the fold, if the series tell one.
    fn fold(&self) -> Option<f64> {
        let tangent = || VerticalTangent::first(&self.acceleration[..=self.order]);
        (self.margin < FOLD_MARGIN)
            .then(tangent)?
            .map(|tangent| tangent.instant())
    }

    /// Whether the margin is lost at local time `tau`, where the series lead, on the same side of zero acceleration.
    fn is_lost_at(&self, tau: f64) -> bool {
        let at = |series: &Series<f64>| evaluate(&series[..=self.order], tau);
        let acceleration = at(&self.acceleration);
        // Where the law jumps, the motion turns first.
        if acceleration * self.acceleration[0] <= 0.0 {
            return false;
        }
        let (_, slope) = self.law.level_and_slope(at(&self.speed), acceleration);
        self.inertia + at(&self.load) * slope <= 0.0
    }

    /// The largest of `step`, its half, its quarter … by which the margin is not lost.
    fn short_of_fold(&self, step: f64) -> f64 {
        let mut parts = (0..=HALVINGS).map(|times| step * 0.5_f64.powi(times));
        let is_short = |part: &f64| !LOOKS.iter().any(|look| self.is_lost_at(look * part));
        parts.find(is_short).unwrap_or(step)
    }
}

/// The next fold, as far as one comes soon: its local time and whose loop folds.
pub(super) fn next_fold<S: Scalar>(
    rig: &Rig<S>,
    mode: &RigMode,
    jet: &RigJet<S>,
) -> Option<(f64, Contact)> {
    if let Some((rig, plain)) = jet.motion() {
        return next_fold(rig, mode, plain);
    }
    let folds = loops(rig, mode, jet).filter_map(|one| Some((one.fold()?, one.contact)));
    folds.reduce(|first, other| if other.0 < first.0 { other } else { first })
}

/// `step` \[s\], or the part of it at whose end the branches that the loops follow have not ended.
pub(super) fn short_of_folds<S: Scalar>(
    rig: &Rig<S>,
    mode: &RigMode,
    jet: &RigJet<S>,
    step: f64,
) -> f64 {
    if let Some((rig, plain)) = jet.motion() {
        return short_of_folds(rig, mode, plain, step);
    }
    loops(rig, mode, jet).fold(step, |step, one| one.short_of_fold(step))
}

/// A fold at which a run with derivatives arrives.
pub(super) struct Arrival<S> {
    /// Position in the state of the velocity whose rate has a vertical tangent there.
    pub velocity: usize,
    /// That velocity's derivatives at the fold, wherever it moves to.
    pub at_fold: S,
    /// Derivatives of the fold's instant.
    pub instant: S,
}

impl<S: Scalar> Arrival<S> {
    /// The next fold of the motion in `jet`.
    ///
    /// A held instant will not do: just before the fold the velocity's derivatives change without bounds, and their series
    /// converges slowly if at all. That of the instant does.
    pub fn at_next_fold(rig: &Rig<S>, mode: &RigMode, jet: &RigJet<S>) -> Option<Self> {
        let (_, contact) = next_fold(rig, mode, jet)?;
        let velocity = velocity_of(contact);
        let mut rates = [S::ZERO; TERMS];
        let mut plain = [0.0; TERMS];
        let rates = &mut rates[..jet.order];
        for (k, rate) in rates.iter_mut().enumerate() {
            *rate = jet.states[velocity][k + 1] * (k + 1) as f64;
            plain[k] = rate.value();
        }
        let tangent = VerticalTangent::first(&plain[..jet.order])?;
        let TangentWeights { instant, integral } = tangent.weights();
        Some(Self {
            velocity,
            at_fold: jet.states[velocity][0] + S::weighted(&integral[..jet.order], rates),
            instant: S::weighted(&instant[..jet.order], rates),
        })
    }
}
