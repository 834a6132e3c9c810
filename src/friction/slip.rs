//! A sliding contact under any law: torque and acceleration, order by order.
//!
//! J a + T(ω, a) + E = 0, where E collects all other torques that resist the motion. For laws that
//! look at the acceleration this is an algebraic loop: solved exactly at order 0, where it may have
//! several roots of which only those with J + ∂T/∂a > 0 are stable, and linear at every higher order.

use super::contact::Regime;
use super::law::Law;
use super::two_gaussian::TwoGaussian;
use super::{stribeck, wojewoda};
use crate::series::{Scalar, Series, TERMS, convolution};

/// Relative difference of two levels that is rounding.
const SAME_LEVEL: f64 = 1e-14;

/// What a sliding contact is made of, in coordinates in which it slides forward.
#[derive(Clone, Copy, Debug)]
pub struct Slip<'a, S> {
    /// The friction law.
    pub law: &'a Law<S>,
    /// How the slip speed changes.
    pub regime: Regime,
    /// Inertia of the sliding body [kg m²].
    pub inertia: S,
    /// 1/`inertia`.
    pub inverse_inertia: S,
    /// Coulomb torque that acts beside the law, whatever the normal force [N m].
    pub constant_torque: S,
    /// Normal force × radius [N m], as a series; for laws of the torque it is 1.
    pub load: &'a Series<S>,
    /// Whether only order 0 of `load` differs from zero.
    pub load_is_constant: bool,
    /// Slip acceleration [rad/s²] near which to look for the root of the loop; its sign tells the
    /// branch where the law jumps at zero acceleration.
    pub near: f64,
    /// Whether the root at `near` has ended at a fold, so that the next one is wanted.
    pub folded: bool,
}

/// Series of a sliding contact.
#[derive(Clone, Debug)]
pub struct SlipJet<S> {
    /// Slip speed [rad/s], ≥ 0.
    pub speed: Series<S>,
    /// Slip acceleration [rad/s²].
    pub acceleration: Series<S>,
    /// Friction torque [N m]; positive against the motion.
    pub torque: Series<S>,
    /// Level of the law; in the regime `Holding`, its upper branch.
    pub level: Series<S>,
    /// Lower branch of the level in the regime `Holding`.
    pub lower_level: Series<S>,
    /// 1 + (∂T/∂a)/J at order 0: the root is stable while this is positive.
    pub margin: f64,
    /// Whether the loop has no root because zero acceleration lies between its two branches.
    pub between: bool,
    /// Whether the root that `near` follows is gone, so that another one was taken.
    pub lost: bool,
    /// Whether the two branches of a hysteretic law differ by no more than rounding, so that which
    /// of them is followed is of no consequence.
    pub branches_meet: bool,
    work: Vec<Series<S>>,
}

impl<S: Scalar> SlipJet<S> {
    /// Series for a contact under `law`.
    pub fn new(law: &Law<S>) -> Self {
        let zero = [S::ZERO; TERMS];
        Self {
            speed: zero,
            acceleration: zero,
            torque: zero,
            level: zero,
            lower_level: zero,
            margin: 1.0,
            between: false,
            lost: false,
            branches_meet: false,
            // Laws with a curve of their own seldom come here: see `expand_order`.
            work: if law.exponential_curve().is_some() {
                Vec::new()
            } else {
                vec![zero; law.workspace()]
            },
        }
    }

    /// The series that the law's recurrences worked on.
    pub(super) fn work(&self) -> &[Series<S>] {
        &self.work
    }
}

impl<S: Scalar> Slip<'_, S> {
    /// Computes coefficient `k` of the torque and the acceleration from coefficient `k` of the slip
    /// speed (already in `jet`), of the disc's angle and of the other resisting torques.
    #[inline]
    pub fn expand_order(&self, k: usize, resisting: S, angle: &Series<S>, jet: &mut SlipJet<S>) {
        if k == 0 && jet.work.len() < self.law.workspace() {
            jet.work.resize(self.law.workspace(), [S::ZERO; TERMS]);
        }
        let constant = if k == 0 {
            self.constant_torque
        } else {
            S::ZERO
        };
        let level = match self.law {
            Law::Coulomb(law) => Self::constant_level(k, law.mu_c),
            Law::CoulombStiction(law) => Self::constant_level(k, law.mu_c),
            Law::Stribeck(law) => stribeck::coefficient(k, law, &jet.speed, &mut jet.work),
            Law::Karnopp(law) => {
                let curve = super::Stribeck {
                    mu_c: law.mu_c,
                    mu_s: law.mu_s,
                    omega_s: law.omega_s,
                };
                stribeck::coefficient(k, &curve, &jet.speed, &mut jet.work)
            }
            Law::Switch(law) => {
                let curve = super::Stribeck {
                    mu_c: law.mu_c,
                    mu_s: law.mu_s,
                    omega_s: law.omega_s,
                };
                stribeck::coefficient(k, &curve, &jet.speed, &mut jet.work)
            }
            Law::Wojewoda(law) => {
                let excess = wojewoda::excess(k, law, &jet.speed, angle, &mut jet.work);
                let middle = Self::constant_level(k, law.mu_c);
                if k == 0 {
                    // A random part may bring the branches together for a moment only.
                    jet.branches_meet = law.stochastic_amplitude.value() == 0.0
                        && excess.value() <= SAME_LEVEL * law.mu_c.value();
                }
                match self.regime {
                    Regime::SlowingDown => middle - excess,
                    Regime::Holding => {
                        jet.lower_level[k] = middle - excess;
                        middle + excess
                    }
                    Regime::SpeedingUp | Regime::Free => middle + excess,
                }
            }
            Law::TwoGaussianTorque(law) => {
                return self.expand_loop(k, resisting, &law.shape(), jet);
            }
            Law::TwoGaussianMu(law) => return self.expand_loop(k, resisting, &law.shape(), jet),
        };
        jet.level[k] = level;
        if self.regime == Regime::Holding {
            self.hold(k, resisting, jet);
            return;
        }
        let torque = if self.load_is_constant {
            self.load[0] * level
        } else {
            convolution(&self.load[..=k], &jet.level[..=k])
        };
        jet.torque[k] = torque + constant;
        jet.acceleration[k] = -((resisting + jet.torque[k]) * self.inverse_inertia);
    }

    #[inline(always)]
    fn constant_level(k: usize, level: S) -> S {
        if k == 0 { level } else { S::ZERO }
    }

    fn hold(&self, k: usize, resisting: S, jet: &mut SlipJet<S>) {
        jet.torque[k] = -resisting;
        jet.acceleration[k] = S::ZERO;
    }

    fn expand_loop(&self, k: usize, resisting: S, law: &TwoGaussian<S>, jet: &mut SlipJet<S>) {
        if k == 0 {
            jet.branches_meet = self.is_unloaded();
        }
        if self.regime == Regime::Holding {
            let [upper, lower] = law.levels_at_rest();
            jet.level[k] = Self::constant_level(k, upper);
            jet.lower_level[k] = Self::constant_level(k, lower);
            self.hold(k, resisting, jet);
            return;
        }
        let acceleration_0 = if k == 0 {
            let (root, between, lost) = self.loop_root(resisting, jet.speed[0], law);
            (jet.between, jet.lost) = (between, lost);
            root
        } else {
            jet.acceleration[0]
        };
        let (known, slope) = law.known_coefficient(k, &jet.speed, acceleration_0, &mut jet.work);
        let acceleration = if k == 0 {
            jet.margin = 1.0 + (self.load[0] * slope * self.inverse_inertia).value();
            acceleration_0
        } else {
            let earlier = if self.load_is_constant {
                S::ZERO
            } else {
                convolution(&self.load[1..=k], &jet.level[..k])
            };
            -((resisting + earlier + self.load[0] * known) / (self.inertia + self.load[0] * slope))
        };
        law.complete(k, acceleration, &mut jet.work);
        jet.acceleration[k] = acceleration;
        jet.level[k] = if k == 0 {
            known
        } else {
            known + slope * acceleration
        };
        jet.torque[k] = -(resisting + self.inertia * acceleration);
    }

    /// Whether nothing presses the surfaces together: the law then says nothing.
    fn is_unloaded(&self) -> bool {
        self.load[0].value() == 0.0
            && (self.load_is_constant || self.load.iter().all(|c| c.value() == 0.0))
    }

    /// The stable root of the loop that continues the branch of `near`, or else the next one; and
    /// whether there is none because zero acceleration lies between the branches; and whether it is another branch.
    fn loop_root(&self, resisting: S, speed: S, law: &TwoGaussian<S>) -> (S, bool, bool) {
        if self.is_unloaded() {
            let acceleration = -((resisting + self.constant_torque) * self.inverse_inertia);
            return (acceleration, false, false);
        }
        let (e, v) = (resisting.value(), speed.value());
        let loop_function = LoopFunction {
            law: law.plain(),
            speed: v,
            inertia: self.inertia.value(),
            load: self.load[0].value(),
            offset: e + self.constant_torque.value(),
        };
        let found = if self.folded {
            loop_function.beyond_fold(self.near)
        } else {
            loop_function.follow(self.near).map(Root::At)
        };
        let lost = found.is_none();
        let root = match found.unwrap_or_else(|| loop_function.search(self.near)) {
            Root::At(root) => root,
            Root::Between => return (S::constant(libm::copysign(0.0, self.near)), true, lost),
        };
        // One Newton step in the number type of the run carries the derivatives.
        let a = S::constant(root);
        let (level, slope) = law.level_and_slope(speed, a);
        let residual = self.inertia * a + self.load[0] * level + resisting + self.constant_torque;
        let stiffness = S::constant((self.inertia + self.load[0] * slope).value());
        let correction = residual / stiffness;
        (a - (correction - correction.value()), false, lost)
    }
}

/// Where the loop leads.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Root {
    /// A stable root.
    At(f64),
    /// None: the law's jump at zero acceleration straddles it.
    Between,
}

/// The algebraic loop F(a) = J a + L μ(ω, a) + E of a sliding contact, without derivatives.
pub struct LoopFunction {
    /// Its law.
    pub law: TwoGaussian<f64>,
    /// Slip speed ω [rad/s].
    pub speed: f64,
    /// Inertia J [kg m²].
    pub inertia: f64,
    /// Normal force × radius L [N m], or 1 for a law of the torque.
    pub load: f64,
    /// All torques E [N m] that resist the motion beside the law.
    pub offset: f64,
}

impl LoopFunction {
    fn value_and_slope(&self, a: f64) -> (f64, f64) {
        let (level, slope) = self.law.level_and_slope(self.speed, a);
        (
            self.inertia * a + self.load * level + self.offset,
            self.inertia + self.load * slope,
        )
    }

    /// Whether `a` lies on the same side of the jump as `near`.
    fn same_side(&self, a: f64, near: f64) -> bool {
        !self.law.jumps_at(self.speed) || a.is_sign_negative() == near.is_sign_negative()
    }

    /// The stable root [rad/s²] to which Newton's method leads from `near` on its side of zero; `None` where the branch has ended.
    pub fn follow(&self, near: f64) -> Option<f64> {
        let mut a = near;
        for _ in 0..25 {
            let (value, slope) = self.value_and_slope(a);
            if slope.is_nan() || slope <= 0.0 {
                return None;
            }
            let next = a - value / slope;
            if !self.same_side(next, near) {
                // A root at the jump itself, missed by rounding, is kept on its own side.
                let tiny = 1e-12 * self.law.acceleration_semi_axis;
                return (next.abs() <= tiny && near.abs() <= tiny).then_some(near);
            }
            // Close to a fold the root is known no better than the rounding of F allows.
            let rounding = 2.0 * f64::EPSILON * self.inertia * self.reach() / slope;
            if (next - a).abs() <= 4.0 * f64::EPSILON * (1e-3 + next.abs()) + rounding {
                return Some(next);
            }
            a = next;
        }
        None
    }

    /// The stable root nearest to `near`, first on its side of the jump, else on the other.
    fn search(&self, near: f64) -> Root {
        let side = if near.is_sign_negative() { -1.0 } else { 1.0 };
        for s in [side, -side] {
            let mut best: Option<f64> = None;
            for root in self.stable_roots(s) {
                if best.is_none_or(|b: f64| (root - near).abs() < (b - near).abs()) {
                    best = Some(root);
                }
            }
            if let Some(root) = best {
                return Root::At(root);
            }
        }
        Root::Between
    }

    /// The stable root to which the acceleration runs from a fold at `near`. Under the slightest lag
    /// it moves against the sign of F: beyond a maximum of F upwards, beyond a minimum downwards.
    fn beyond_fold(&self, near: f64) -> Option<Root> {
        const CELLS: usize = 400;
        let step = 1e-3 * self.law.acceleration_semi_axis;
        let bend = self.value_and_slope(near + step).1 - self.value_and_slope(near - step).1;
        let direction = if bend < 0.0 { 1.0 } else { -1.0 };
        let reach = self.reach() + near.abs();
        let (mut earlier, mut left_behind) = (near, false);
        for j in 1..=CELLS {
            let fraction = j as f64 / CELLS as f64;
            let here = near + direction * (step + reach * fraction * fraction);
            let ahead = self.value_and_slope(here).0 * direction;
            if ahead < 0.0 {
                left_behind = true;
            } else if left_behind {
                let (low, high) = if direction > 0.0 {
                    (earlier, here)
                } else {
                    (here, earlier)
                };
                return Some(self.root_between(low, high));
            }
            earlier = here;
        }
        None
    }

    /// The root between `low`, where F is negative, and `high`, where it is positive.
    fn root_between(&self, low: f64, high: f64) -> Root {
        if low < 0.0 && high > 0.0 && self.law.jumps_at(self.speed) {
            return if self.value_and_slope(-0.0).0 > 0.0 {
                Root::At(self.refine(low, -0.0))
            } else if self.value_and_slope(0.0).0 < 0.0 {
                Root::At(self.refine(0.0, high))
            } else {
                Root::Between
            };
        }
        Root::At(self.refine(low, high))
    }

    /// An acceleration beyond every root.
    fn reach(&self) -> f64 {
        (self.load * (self.law.heights[0].abs() + self.law.heights[1].abs()) + self.offset.abs())
            / self.inertia
            + 1.0
    }

    /// Roots with rising F on one side (`side` = ±1) of zero acceleration.
    fn stable_roots(&self, side: f64) -> Vec<f64> {
        const CELLS: usize = 400;
        let scale = 0.05 * self.law.acceleration_semi_axis;
        let top = libm::asinh(self.reach() / scale);
        let node = |j: usize| {
            if j == 0 {
                0.0 * side
            } else {
                side * scale * libm::sinh(top * j as f64 / CELLS as f64)
            }
        };
        let mut roots = Vec::new();
        let mut previous = (node(0), self.value_and_slope(node(0)).0);
        for j in 1..=CELLS {
            let here = (node(j), self.value_and_slope(node(j)).0);
            let (low, high) = if side > 0.0 {
                (previous, here)
            } else {
                (here, previous)
            };
            if low.1 <= 0.0 && high.1 > 0.0 {
                roots.push(self.refine(low.0, high.0));
            }
            previous = here;
        }
        roots
    }

    fn refine(&self, mut low: f64, mut high: f64) -> f64 {
        let mut a = 0.5 * (low + high);
        for _ in 0..100 {
            let (value, slope) = self.value_and_slope(a);
            if value <= 0.0 {
                low = a
            } else {
                high = a
            }
            let newton = a - value / slope;
            let next = if newton > low && newton < high {
                newton
            } else {
                0.5 * (low + high)
            };
            if (next - a).abs() <= 2.0 * f64::EPSILON * (1e-6 + a.abs()) {
                return next;
            }
            a = next;
        }
        a
    }
}
