//! Where the algebraic loops of Eqs 6-1 and 6-2 fold.

use super::switching::velocity_of;
use super::{Contact, Rig, RigJet, RigMode, RigState};
use crate::friction::{ContactMode, LoopFunction, Regime, TwoGaussian};
use crate::integrator::Fold;
use crate::series::{Scalar, Series, TERMS, TangentWeights, VerticalTangent, evaluate};

/// Most times that a step is halved before a fold.
const HALVINGS: i32 = 10;

/// The loop of a sliding contact in the course of a segment, without derivatives.
struct Loop {
    contact: Contact,
    law: TwoGaussian<f64>,
    inertia: f64,
    constant_torque: f64,
    /// 1 + (∂T/∂a)/J at the segment's start.
    margin: f64,
    order: usize,
    load: Series<f64>,
    speed: Series<f64>,
    acceleration: Series<f64>,
    torque: Series<f64>,
}

/// The loops of the contacts that slide in `mode`.
fn loops<S: Scalar>(rig: &Rig<S>, mode: &RigMode, jet: &RigJet<S>) -> impl Iterator<Item = Loop> {
    let disc = Some((&rig.law, rig.disc.inertia, &jet.disc));
    let disc1 = (rig.disc1.as_ref().zip(jet.disc1.as_deref()))
        .map(|(disc1, pin)| (&disc1.law, disc1.disc.inertia, pin));
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
                constant_torque: pin.constant_torque.value(),
                margin: slip.margin,
                order,
                load: plain(&pin.load),
                speed: plain(&slip.speed),
                acceleration: plain(&slip.acceleration),
                torque: plain(&slip.torque),
            })
        })
}

impl Loop {
    /// Local time of the fold, if the series tell one. Only where friction falls with the acceleration can the loop fold soon.
    fn fold(&self) -> Option<f64> {
        let tangent = || VerticalTangent::first(&self.acceleration[..=self.order]);
        (self.margin < 1.0)
            .then(tangent)?
            .map(|tangent| tangent.instant())
    }

    /// Whether the loop has no root any more at local time `tau` where the series of its root lead.
    fn has_ended(&self, tau: f64) -> bool {
        let at = |series: &Series<f64>| evaluate(&series[..=self.order], tau);
        let acceleration = at(&self.acceleration);
        // Where the law jumps, the motion turns first.
        if acceleration * self.acceleration[0] <= 0.0 {
            return false;
        }
        let function = LoopFunction {
            law: self.law,
            speed: at(&self.speed),
            inertia: self.inertia,
            load: at(&self.load),
            // The other torques have no singular point at a fold, so that their series lead beyond it.
            offset: self.constant_torque - at(&self.torque) - self.inertia * acceleration,
        };
        function.follow(acceleration).is_none()
    }

    /// The largest of `step`, its half, its quarter … at which the loop still has its root.
    fn short_of_fold(&self, step: f64) -> f64 {
        let mut parts = (0..=HALVINGS).map(|times| step * 0.5_f64.powi(times));
        parts.find(|part| !self.has_ended(*part)).unwrap_or(step)
    }
}

/// The next fold, as far as one comes soon: its local time and whose loop folds.
fn next_fold<S: Scalar>(rig: &Rig<S>, mode: &RigMode, jet: &RigJet<S>) -> Option<(f64, Contact)> {
    if let Some((rig, plain)) = jet.motion() {
        return next_fold(rig, mode, plain);
    }
    let folds = loops(rig, mode, jet).filter_map(|one| Some((one.fold()?, one.contact)));
    folds.reduce(|first, other| if other.0 < first.0 { other } else { first })
}

/// `step` \[s\], or the part of it at whose end the branches that the loops follow have not ended.
fn short_of_folds<S: Scalar>(rig: &Rig<S>, mode: &RigMode, jet: &RigJet<S>, step: f64) -> f64 {
    if let Some((rig, plain)) = jet.motion() {
        return short_of_folds(rig, mode, plain, step);
    }
    loops(rig, mode, jet).fold(step, |step, one| one.short_of_fold(step))
}

/// What a fold does to derivatives.
struct Arrival<S> {
    /// Those of the fold's instant.
    instant: S,
    /// Those of the folding disc's velocity at that instant.
    velocity: S,
}

impl<S: Scalar> Arrival<S> {
    /// At the fold ahead of the disc whose velocity has the series `velocity`.
    ///
    /// The acceleration's derivatives grow without bounds towards a fold, and the series of the velocity's do not converge there. The
    /// inverse function, time over acceleration, has no singular point: both derivatives come from it.
    fn at_fold(velocity: &Series<S>, order: usize) -> Option<Self> {
        let mut rates = [S::ZERO; TERMS];
        let rates = &mut rates[..order];
        for (k, rate) in rates.iter_mut().enumerate() {
            *rate = velocity[k + 1] * (k + 1) as f64;
        }
        let plain: Vec<f64> = rates.iter().map(|rate| rate.value()).collect();
        let TangentWeights { instant, integral } = VerticalTangent::first(&plain)?.weights();
        Some(Self {
            instant: S::weighted(&instant[..order], rates),
            velocity: velocity[0] + S::weighted(&integral[..order], rates),
        })
    }
}

impl<S: Scalar> Rig<S> {
    /// The fold within `step` [s] of the segment in `jet`, or how much of the step is free of one.
    pub(super) fn fold_within(&self, mode: &RigMode, jet: &RigJet<S>, step: f64) -> Fold<S> {
        match next_fold(self, mode, jet) {
            Some((tau, contact)) if tau <= step => {
                let series = &jet.states[velocity_of(contact)];
                let arrival = S::HAS_DERIVATIVES
                    .then(|| Arrival::at_fold(series, jet.order))
                    .flatten();
                Fold::At(
                    arrival.map_or(S::constant(tau), |arrival| arrival.instant.with_value(tau)),
                )
            }
            // The series does not converge beyond; which root comes next must stay certain.
            Some((tau, _)) => Fold::Beyond(step.min(0.5 * tau)),
            None => Fold::Beyond(short_of_folds(self, mode, jet, step)),
        }
    }

    /// The mode beyond the fold that ends the segment in `jet`; puts the derivatives of the folding disc's velocity into `state`.
    pub(super) fn pass_fold(
        &self,
        mode: &RigMode,
        state: &mut RigState<S>,
        jet: &RigJet<S>,
    ) -> RigMode {
        let mut mode = *mode;
        let contact = next_fold(self, &mode, jet).map(|(_, contact)| contact);
        mode.folded = [Contact::Disc, Contact::Disc1].map(|disc| contact == Some(disc));
        if let Some(contact) = contact
            && S::HAS_DERIVATIVES
        {
            let place = velocity_of(contact);
            if let Some(arrival) = Arrival::at_fold(&jet.states[place], jet.order) {
                state[place] = arrival.velocity.with_value(state[place].value());
            }
        }
        mode
    }
}
