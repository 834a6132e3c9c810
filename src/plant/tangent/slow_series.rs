//! Derivatives of a segment on the slow manifold.
//!
//! Chang's coordinates serve the derivatives as they serve the motion; being a mere choice of
//! coordinates, they need no derivatives of their own. The friction and what parameters add drive the
//! transformed variables as they drive those of the motion.

use super::motion::Tangent;
use super::parameter_forcing::{ON_CIRCUIT, ON_DISC, ON_DISC_1, ON_MOTOR};
use super::pin::PinTangent;
use crate::plant::RigState;
use crate::plant::fading::Fading;
use crate::plant::index::{self, OMEGA, OMEGA1, OMEGA3, THETA, THETA1, THETA3};
use crate::plant::jet::RigJet;
use crate::plant::linear_parts::LinearParts;
use crate::plant::slow_manifold::{
    CURRENT, DISC, DISC_1, DiscMotion, Feedback, MOTOR, Regimes, SlowManifold, TWIST, TWIST_1,
};
use crate::plant::slow_motion::derivatives_missed;
use crate::series::{RECIPROCAL, Scalar, Series, TERMS};

/// The transformations of the rig, and series of derivatives in their coordinates.
#[derive(Clone, Debug)]
pub(in crate::plant) struct SlowTangent<S, const N: usize> {
    found: Vec<Found<N>>,
    slow: [[S; N]; TERMS],
    fast: [[S; 2]; TERMS],
    forcing: [[S; 2]; TERMS],
}

/// The last transformation of a combination of resting parts, if there is one.
#[derive(Clone, Debug)]
struct Found<const N: usize> {
    regimes: Regimes,
    feedback: [Feedback; 2],
    coordinates: Option<Box<Coordinates<N>>>,
}

/// A manifold with what the recurrences need of it.
#[derive(Clone, Debug)]
struct Coordinates<const N: usize> {
    manifold: SlowManifold<f64, N>,
    /// How the slow variables answer to accelerations of D2 and D1: e + H L e.
    answers: [[f64; N]; 2],
    /// A_f.
    fast: [[f64; 2]; 2],
    /// 1 + L H: how (ω3, i) follow the transformed fast variables.
    following: [[f64; 2]; 2],
}

impl<const N: usize> Coordinates<N> {
    fn new((manifold, fast): (SlowManifold<f64, N>, [[f64; 2]; 2])) -> Self {
        let (l, h) = (&manifold.fast_from_slow, &manifold.slow_from_fast);
        let answer = |disc: usize| {
            std::array::from_fn(|j| {
                let direct = if j == disc { 1.0 } else { 0.0 };
                direct + h[j][0] * l[0][disc] + h[j][1] * l[1][disc]
            })
        };
        let answers = [
            answer(DISC),
            if N > DISC_1 { answer(DISC_1) } else { [0.0; N] },
        ];
        let following = std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let direct = if i == j { 1.0 } else { 0.0 };
                direct + (0..N).map(|m| l[i][m] * h[m][j]).sum::<f64>()
            })
        });
        Self {
            manifold,
            fast,
            answers,
            following,
        }
    }

    /// What the change of the friction's slopes makes of derivatives beside the manifold while they fade, about: velocities of D2
    /// and D1 that are left.
    fn neglected<S: Scalar>(&self, amplitude: &[S; 2], tangent: &Tangent<S>) -> [S; 2] {
        let manifold = &self.manifold;
        let inverse = &manifold.fast_inverse;
        let duration = inverse
            .iter()
            .flatten()
            .fold(0.0_f64, |a, b| a.max(b.abs()));
        let [on_disc, on_disc_1] =
            shaft_accelerations(&[S::ZERO; N], amplitude, manifold, &tangent.jet.parts);
        let left = |pin: &PinTangent, disc: usize, by_shafts: &S| {
            let row = &manifold.slow_from_fast[disc];
            let velocity = S::combined([(row[0], &amplitude[0]), (row[1], &amplitude[1])]);
            let change = |slope: Option<Series<f64>>| {
                let rate = slope.map_or(0.0, |slope| slope[1]);
                rate * duration * duration * pin.inverse_margin
            };
            let by_acceleration = change(pin.by_acceleration) * pin.inverse_margin;
            S::combined([
                (change(pin.by_velocity), &velocity),
                (by_acceleration, by_shafts),
            ])
        };
        [
            left(&tangent.pins[0], DISC, &on_disc),
            if N > DISC_1 {
                left(&tangent.pins[1], DISC_1, &on_disc_1)
            } else {
                S::ZERO
            },
        ]
    }
}

impl<S: Scalar, const N: usize> SlowTangent<S, N> {
    const FULL: bool = N > DISC_1;

    pub fn new() -> Self {
        Self {
            // A run meets three or four: disc and motor stuck and sliding.
            found: Vec::with_capacity(4),
            slow: [[S::ZERO; N]; TERMS],
            fast: [[S::ZERO; 2]; TERMS],
            forcing: [[S::ZERO; 2]; TERMS],
        }
    }

    /// Place in `found` of the transformation for `regimes` along a motion whose friction answers with `feedback`.
    fn coordinates(
        &mut self,
        parts: &LinearParts<f64>,
        regimes: Regimes,
        feedback: [Feedback; 2],
    ) -> usize {
        let known = self.found.iter().position(|of| of.regimes == regimes);
        if let Some(place) = known
            && self.found[place].feedback == feedback
        {
            return place;
        }
        let manifold = SlowManifold::new(parts, &regimes, feedback);
        let found = Found {
            regimes,
            feedback,
            coordinates: manifold.map(|found| Box::new(Coordinates::new(found))),
        };
        match known {
            Some(place) => {
                self.found[place] = found;
                place
            }
            None => {
                self.found.push(found);
                self.found.len() - 1
            }
        }
    }

    /// Fills `jet` with the motion in `tangent`, which is linearised up to order `top`, and with the
    /// derivatives of `state` if they lie on the slow manifold; whether they do.
    #[allow(clippy::too_many_arguments)]
    pub fn expand(
        &mut self,
        regimes: Regimes,
        state: &RigState<S>,
        top: usize,
        tolerance: f64,
        tangent: &mut Tangent<S>,
        jet: &mut RigJet<S>,
    ) -> bool {
        let feedback = tangent.pins.each_ref().map(PinTangent::feedback);
        let place = self.coordinates(&tangent.jet.parts, regimes, feedback);
        let Some(coordinates) = self.found[place].coordinates.take() else {
            return false;
        };
        let lies_there = self.expand_along(&coordinates, state, top, tolerance, tangent, jet);
        self.found[place].coordinates = Some(coordinates);
        lies_there
    }

    fn expand_along(
        &mut self,
        coordinates: &Coordinates<N>,
        state: &RigState<S>,
        top: usize,
        tolerance: f64,
        tangent: &mut Tangent<S>,
        jet: &mut RigJet<S>,
    ) -> bool {
        let (l, h) = (
            &coordinates.manifold.fast_from_slow,
            &coordinates.manifold.slow_from_fast,
        );
        let mut slow = [S::ZERO; N];
        slow[TWIST] = state[THETA] - state[THETA3];
        slow[DISC] = state[OMEGA];
        if Self::FULL {
            slow[TWIST_1] = state[THETA1] - state[THETA];
            slow[DISC_1] = state[OMEGA1];
        }
        let mut fast = [state[OMEGA3], state[index::CURRENT]];
        for (fast, row) in fast.iter_mut().zip(l) {
            *fast -= S::weighted(row, &slow);
        }
        for (slow, row) in slow.iter_mut().zip(h) {
            *slow -= S::weighted(row, &fast);
        }
        self.slow[0] = slow;
        self.fast[..=top + 1].fill([S::ZERO; 2]);
        self.fast[0] = fast;
        self.pass(0..top + 1, coordinates, tangent, jet);
        self.follow(coordinates, top);
        let accuracy = tolerance.max(tangent.accuracy());
        let beside = |found: &[S; 2]| [fast[0] - found[0], fast[1] - found[1]];
        let fades = derivatives_missed(&beside(&self.fast[0]), state) > accuracy;
        let corrected = if fades {
            top + 1
        } else {
            tangent.jet.corrected.min(top + 1)
        };
        if corrected > 0 {
            self.pass(0..corrected, coordinates, tangent, jet);
            self.follow(coordinates, corrected - 1);
        }
        let amplitude = beside(&self.fast[0]);
        let fades = derivatives_missed(&amplitude, state) > accuracy;
        if fades {
            let neglected = coordinates.neglected(&amplitude, tangent);
            if derivatives_missed(&neglected, state) > accuracy {
                return false;
            }
        }
        jet.fading = fades.then(|| {
            let Coordinates {
                manifold,
                fast,
                following,
                ..
            } = coordinates;
            Box::new(Fading::new(amplitude, manifold, fast, following))
        });
        // What fades turns the disc, too, and the other angles follow it by their twists.
        jet.states[THETA][0] = state[THETA];
        if let Some(fading) = &jet.fading {
            jet.states[THETA][0] -= fading.at(THETA, 0.0);
        }
        self.assemble(coordinates, top, tangent, jet);
        true
    }

    /// Orders `range` of the slow variables, with the fast ones as they are known.
    #[inline(always)]
    fn pass(
        &mut self,
        range: std::ops::Range<usize>,
        coordinates: &Coordinates<N>,
        tangent: &mut Tangent<S>,
        jet: &mut RigJet<S>,
    ) {
        let Coordinates {
            manifold,
            answers: [from_disc, from_disc_1],
            ..
        } = coordinates;
        let (l, h) = (&manifold.fast_from_slow, &manifold.slow_from_fast);
        let Tangent {
            jet: plain,
            pins,
            forcing: by_parameters,
            accelerations,
            ..
        } = tangent;
        let parts = &plain.parts;
        let [accelerations, accelerations_1] = &mut **accelerations;
        let loops = pins.each_ref().map(|pin| pin.by_acceleration.is_some());
        let loops = loops[0] || Self::FULL && loops[1];
        for k in range {
            let per_next = RECIPROCAL[k + 1];
            let (now, later) = self.slow.split_at_mut(k + 1);
            let (slow, fast) = (&now[k], &self.fast[k]);
            let velocity = |disc: usize| {
                S::combined([
                    (1.0, &slow[disc]),
                    (h[disc][0], &fast[0]),
                    (h[disc][1], &fast[1]),
                ])
            };
            jet.states[OMEGA][k] = velocity(DISC);
            let mut by_shafts = [S::ZERO; 2];
            if Self::FULL {
                jet.states[OMEGA1][k] = velocity(DISC_1);
            }
            if loops {
                by_shafts = shaft_accelerations(slow, fast, manifold, parts);
            }
            let push = pins[0].push(
                k,
                &by_parameters[ON_DISC][k],
                &by_shafts[0],
                &jet.states[OMEGA],
                accelerations,
            );
            let (motor, circuit) = (&by_parameters[ON_MOTOR][k], &by_parameters[ON_CIRCUIT][k]);
            let (next, forcing) = (&mut later[0], &mut self.forcing[k]);
            if Self::FULL {
                let push_1 = pins[1].push(
                    k,
                    &by_parameters[ON_DISC_1][k],
                    &by_shafts[1],
                    &jet.states[OMEGA1],
                    accelerations_1,
                );
                for j in 0..N {
                    next[j] = S::combined([
                        (manifold.slow[j][TWIST] * per_next, &slow[TWIST]),
                        (manifold.slow[j][DISC] * per_next, &slow[DISC]),
                        (manifold.slow[j][TWIST_1] * per_next, &slow[TWIST_1]),
                        (manifold.slow[j][DISC_1] * per_next, &slow[DISC_1]),
                        (from_disc[j] * per_next, &push),
                        (from_disc_1[j] * per_next, &push_1),
                        (-h[j][0] * per_next, motor),
                        (-h[j][1] * per_next, circuit),
                    ]);
                }
                for (f, direct) in [motor, circuit].into_iter().enumerate() {
                    forcing[f] = S::combined([
                        (1.0, direct),
                        (-l[f][DISC], &push),
                        (-l[f][DISC_1], &push_1),
                    ]);
                }
            } else {
                for j in 0..N {
                    next[j] = S::combined([
                        (manifold.slow[j][TWIST] * per_next, &slow[TWIST]),
                        (manifold.slow[j][DISC] * per_next, &slow[DISC]),
                        (from_disc[j] * per_next, &push),
                        (-h[j][0] * per_next, motor),
                        (-h[j][1] * per_next, circuit),
                    ]);
                }
                for (f, direct) in [motor, circuit].into_iter().enumerate() {
                    forcing[f] = S::combined([(1.0, direct), (-l[f][DISC], &push)]);
                }
            }
        }
    }

    /// The fast variables without transient, from order `top` downwards.
    #[inline(always)]
    fn follow(&mut self, coordinates: &Coordinates<N>, top: usize) {
        let inverse = &coordinates.manifold.fast_inverse;
        for k in (0..=top).rev() {
            let (now, later) = self.fast.split_at_mut(k + 1);
            let (now, next, forcing) = (&mut now[k], &later[0], &self.forcing[k]);
            let scale = (k + 1) as f64;
            for (now, [a, b]) in now.iter_mut().zip(inverse) {
                *now = S::combined([
                    (a * scale, &next[0]),
                    (b * scale, &next[1]),
                    (-a, &forcing[0]),
                    (-b, &forcing[1]),
                ]);
            }
        }
    }

    /// Puts the series of the states into `jet` once the transformed variables are known.
    fn assemble(
        &self,
        coordinates: &Coordinates<N>,
        top: usize,
        tangent: &Tangent<S>,
        jet: &mut RigJet<S>,
    ) {
        let plain = &tangent.jet.states;
        let (l, h) = (
            &coordinates.manifold.fast_from_slow,
            &coordinates.manifold.slow_from_fast,
        );
        let following = &coordinates.following;
        let x = &mut jet.states;
        for k in 0..=top {
            let per_next = RECIPROCAL[k + 1];
            let (slow, fast) = (&self.slow[k], &self.fast[k]);
            let physical = |disc: usize| {
                S::combined([
                    (1.0, &slow[disc]),
                    (h[disc][0], &fast[0]),
                    (h[disc][1], &fast[1]),
                ])
            };
            x[OMEGA][k] = physical(DISC);
            for (place, f) in [(OMEGA3, MOTOR), (index::CURRENT, CURRENT)] {
                let mut sum =
                    S::combined([(following[f][0], &fast[0]), (following[f][1], &fast[1])]);
                sum += S::weighted(&l[f], slow);
                x[place][k] = sum;
            }
            if k == 0 {
                x[THETA3][0] = x[THETA][0] - physical(TWIST);
            }
            x[THETA][k + 1] = S::combined([(per_next, &x[OMEGA][k])]);
            x[THETA3][k + 1] = S::combined([(per_next, &x[OMEGA3][k])]);
            if Self::FULL {
                x[OMEGA1][k] = physical(DISC_1);
                if k == 0 {
                    x[THETA1][0] = x[THETA][0] + physical(TWIST_1);
                }
                x[THETA1][k + 1] = S::combined([(per_next, &x[OMEGA1][k])]);
            }
            let used = if Self::FULL { OMEGA1 } else { index::CURRENT };
            for (series, plain) in x[..=used].iter_mut().zip(plain) {
                series[k].set_value(plain[k]);
            }
        }
    }
}

/// Derivatives of the accelerations of D2 and D1 by the torques of the shafts.
#[inline(always)]
fn shaft_accelerations<S: Scalar, const N: usize>(
    slow: &[S; N],
    fast: &[S; 2],
    manifold: &SlowManifold<f64, N>,
    parts: &LinearParts<f64>,
) -> [S; 2] {
    let s: [S; N] = std::array::from_fn(|j| {
        let row = &manifold.slow_from_fast[j];
        S::combined([(1.0, &slow[j]), (row[0], &fast[0]), (row[1], &fast[1])])
    });
    let mut motor = fast[MOTOR];
    motor += S::weighted(&manifold.fast_from_slow[MOTOR], &s);
    let shaft = S::combined([
        (parts.stiffness, &s[TWIST]),
        (parts.damping, &s[DISC]),
        (-parts.damping, &motor),
    ]);
    if N > DISC_1 {
        let disc1 = S::combined([
            (parts.stiffness_1, &s[TWIST_1]),
            (parts.damping_1, &s[DISC_1]),
            (-parts.damping_1, &s[DISC]),
        ]);
        [
            S::combined([
                (-parts.inverse_inertia, &shaft),
                (parts.inverse_inertia, &disc1),
            ]),
            S::combined([(-parts.inverse_inertia_1, &disc1)]),
        ]
    } else {
        [S::combined([(-parts.inverse_inertia, &shaft)]), S::ZERO]
    }
}

impl PinTangent {
    /// What of the friction's answer is the same all along the segment.
    fn feedback(&self) -> Feedback {
        if self.motion != DiscMotion::Driven {
            return Feedback::NONE;
        }
        Feedback {
            by_velocity: self.by_velocity.map_or(0.0, |slope| slope[0]),
            share: self.inverse_margin,
        }
    }

    /// Derivatives of coefficient `k` of the acceleration that the parameters and the change of the friction's slopes give the disc,
    /// beside its linear equation.
    #[inline(always)]
    fn push<S: Scalar>(
        &self,
        k: usize,
        forcing: &S,
        by_shafts: &S,
        omega: &Series<S>,
        accelerations: &mut Series<S>,
    ) -> S {
        let mut push = *forcing;
        if self.motion != DiscMotion::Driven {
            return push;
        }
        if let Some(slope) = &self.by_velocity {
            push += S::filtered(&slope[1..=k], &omega[..k]);
        }
        if let Some(slope) = &self.by_acceleration {
            push += S::filtered(&slope[1..=k], &accelerations[..k]);
            push = S::combined([(self.inverse_margin, &push)]);
            let Feedback { by_velocity, share } = self.feedback();
            accelerations[k] = S::combined([
                (share, by_shafts),
                (share * by_velocity, &omega[k]),
                (1.0, &push),
            ]);
        }
        push
    }
}
