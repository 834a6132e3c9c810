//! The slow manifold of the rig: where the motor's fast transients have died away.
//!
//! The motor side (speed and current) relaxes within some ten milliseconds, the discs move within
//! tenths of a second. A Taylor series that carries the fast modes cannot step beyond their time
//! constant however little they are excited. Chang's transformation separates the linear part:
//! with slow variables s (twists and disc velocities) and fast ones q (motor speed and current),
//!
//! q = q̃ + L s, s = s̃ + H q̃ gives ds̃/dt = A_s s̃ + …, dq̃/dt = A_f q̃ + …
//!
//! (K. W. Chang, SIAM J. Math. Anal. 3 (1972) 520). Under a forcing that is a polynomial,
//! dq̃/dt = A_f q̃ + f has exactly one solution that is a polynomial: the motion without transient.
//! It follows from the highest order downwards, q̃_k = A_f⁻¹ ((k + 1) q̃_{k+1} − f_k), and is good for
//! steps as long as the slow motion allows.

use super::linear_parts::LinearParts;
use crate::series::Scalar;

/// Positions of the slow variables: twist θ2 − θ3, ω2 and, in the full rig, θ1 − θ2, ω1.
pub(super) const TWIST: usize = 0;
pub(super) const DISC: usize = 1;
pub(super) const TWIST_1: usize = 2;
pub(super) const DISC_1: usize = 3;
/// Positions of the fast variables.
pub(super) const MOTOR: usize = 0;
pub(super) const CURRENT: usize = 1;

/// Iterations in which the transformation must be found: it contracts by the ratio of slow to fast.
const ITERATIONS: usize = 60;
/// Relative change at which the transformation counts as found.
const FOUND: f64 = 1e-15;

type Matrix<S, const M: usize, const N: usize> = [[S; N]; M];

/// What decides which equations of motion hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Regimes {
    /// D2 and D1.
    pub discs: [DiscMotion; 2],
    /// Whether the motor rests.
    pub motor_rests: bool,
}

/// What determines the velocity of a disc.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum DiscMotion {
    /// The torques.
    Driven,
    /// It sticks: what remains of its velocity decays.
    Stuck,
    /// It slides at constant velocity.
    Kept,
}

/// How the friction of a driven disc answers to its motion, to first order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Feedback {
    /// −(∂T/∂ω)/J [1/s].
    pub by_velocity: f64,
    /// 1/(1 + (∂T/∂a)/J): share of a torque's acceleration that friction leaves.
    pub share: f64,
}

impl Feedback {
    /// None at all.
    pub const NONE: Self = Self {
        by_velocity: 0.0,
        share: 1.0,
    };
}

/// Chang's transformation for one combination of resting parts.
#[derive(Clone, Debug)]
pub(super) struct SlowManifold<S, const N: usize> {
    /// L: what the fast variables follow.
    pub fast_from_slow: Matrix<S, 2, N>,
    /// H.
    pub slow_from_fast: Matrix<S, N, 2>,
    /// A_s.
    pub slow: Matrix<S, N, N>,
    /// A_f⁻¹.
    pub fast_inverse: Matrix<S, 2, 2>,
}

impl<S: Scalar, const N: usize> SlowManifold<S, N> {
    /// The transformation and A_f, or `None` if the fast variables are not stable and far from the slow ones.
    pub fn new(
        parts: &LinearParts<S>,
        regimes: &Regimes,
        feedback: [Feedback; 2],
    ) -> Option<(Self, Matrix<S, 2, 2>)> {
        let (mut a11, mut a12, a21, a22) = blocks::<S, N>(parts, regimes);
        for (place, (motion, feedback)) in [DISC, DISC_1]
            .into_iter()
            .zip(regimes.discs.into_iter().zip(feedback))
        {
            if place < N && motion == DiscMotion::Driven {
                a11[place][place] = a11[place][place] + feedback.by_velocity;
                a11[place] = a11[place].map(|a| a * feedback.share);
                a12[place] = a12[place].map(|a| a * feedback.share);
            }
        }
        let a22_inverse = inverse(&a22)?;
        let mut fast_from_slow = [[S::ZERO; N]; 2];
        let found = iterate(&mut fast_from_slow, |l| {
            let closed = add(&a11, &multiply(&a12, l));
            multiply(&a22_inverse, &subtract(&multiply(l, &closed), &a21))
        });
        let slow = add(&a11, &multiply(&a12, &fast_from_slow));
        let fast = subtract(&a22, &multiply(&fast_from_slow, &a12));
        let fast_inverse = inverse(&fast)?;
        let mut slow_from_fast = [[S::ZERO; 2]; N];
        let found = found
            && iterate(&mut slow_from_fast, |h| {
                multiply(&add(&a12, &multiply(&slow, h)), &fast_inverse)
            });
        let stable = (fast[0][0] + fast[1][1]).value() < 0.0
            && (fast[0][0] * fast[1][1] - fast[0][1] * fast[1][0]).value() > 0.0;
        let manifold = Self {
            fast_from_slow,
            slow_from_fast,
            slow,
            fast_inverse,
        };
        (found && stable).then_some((manifold, fast))
    }

    /// (s, q) of transformed coordinates.
    #[inline(always)]
    pub fn physical(&self, slow: &[S; N], fast: &[S; 2]) -> ([S; N], [S; 2]) {
        let s: [S; N] = std::array::from_fn(|j| {
            let row = &self.slow_from_fast[j];
            slow[j] + (row[0] * fast[0] + row[1] * fast[1])
        });
        let q = std::array::from_fn(|j| fast[j] + dot(&self.fast_from_slow[j], &s));
        (s, q)
    }

    /// Transformed coordinates of (s, q).
    pub fn transformed(&self, s: &[S; N], q: &[S; 2]) -> ([S; N], [S; 2]) {
        let fast: [S; 2] = std::array::from_fn(|j| q[j] - dot(&self.fast_from_slow[j], s));
        let slow = std::array::from_fn(|j| s[j] - dot(&self.slow_from_fast[j], &fast));
        (slow, fast)
    }
}

/// The blocks of the linear equations of motion: d(s, q)/dt = [[A11, A12], [A21, A22]] (s, q).
#[allow(clippy::type_complexity)]
fn blocks<S: Scalar, const N: usize>(
    parts: &LinearParts<S>,
    regimes: &Regimes,
) -> (
    Matrix<S, N, N>,
    Matrix<S, N, 2>,
    Matrix<S, 2, N>,
    Matrix<S, 2, 2>,
) {
    let one = S::constant(1.0);
    let full = N > DISC_1;
    let mut a11 = [[S::ZERO; N]; N];
    let mut a12 = [[S::ZERO; 2]; N];
    let mut a21 = [[S::ZERO; N]; 2];
    let mut a22 = [[S::ZERO; 2]; 2];
    a11[TWIST][DISC] = one;
    a12[TWIST][MOTOR] = -one;
    if regimes.discs[0] == DiscMotion::Stuck {
        a11[DISC][DISC] = -parts.decay;
    } else if regimes.discs[0] == DiscMotion::Driven {
        let scale = parts.inverse_inertia;
        a11[DISC][TWIST] = -(parts.stiffness * scale);
        a11[DISC][DISC] = -((parts.damping + parts.damping_1) * scale);
        a12[DISC][MOTOR] = parts.damping * scale;
        if full {
            a11[DISC][TWIST_1] = parts.stiffness_1 * scale;
            a11[DISC][DISC_1] = parts.damping_1 * scale;
        }
    }
    if full {
        a11[TWIST_1][DISC_1] = one;
        a11[TWIST_1][DISC] = -one;
        if regimes.discs[1] == DiscMotion::Stuck {
            a11[DISC_1][DISC_1] = -parts.decay_1;
        } else if regimes.discs[1] == DiscMotion::Driven {
            let scale = parts.inverse_inertia_1;
            a11[DISC_1][TWIST_1] = -(parts.stiffness_1 * scale);
            a11[DISC_1][DISC_1] = -(parts.damping_1 * scale);
            a11[DISC_1][DISC] = parts.damping_1 * scale;
        }
    }
    let electric = -(parts.resistance * parts.inverse_inductance);
    a22[CURRENT][CURRENT] = electric;
    a22[CURRENT][MOTOR] = -(parts.back_emf * parts.inverse_inductance);
    if regimes.motor_rests {
        // The speed stays at zero; any fast decay says so.
        a22[MOTOR][MOTOR] = electric;
    } else {
        let scale = parts.inverse_motor_inertia;
        a21[MOTOR][TWIST] = parts.stiffness * scale;
        a21[MOTOR][DISC] = parts.damping * scale;
        a22[MOTOR][MOTOR] = -((parts.motor_damping + parts.damping) * scale);
        a22[MOTOR][CURRENT] = parts.current_to_torque * scale;
    }
    (a11, a12, a21, a22)
}

/// Repeats `next` until its argument no longer changes; whether that happened.
fn iterate<S: Scalar, const M: usize, const N: usize>(
    matrix: &mut Matrix<S, M, N>,
    next: impl Fn(&Matrix<S, M, N>) -> Matrix<S, M, N>,
) -> bool {
    for _ in 0..ITERATIONS {
        let new = next(matrix);
        let (mut change, mut size) = (0.0_f64, 0.0_f64);
        for (a, b) in new.iter().flatten().zip(matrix.iter().flatten()) {
            change = change.max((*a - *b).value().abs());
            size = size.max(a.value().abs());
        }
        *matrix = new;
        if !size.is_finite() {
            return false;
        }
        if change <= FOUND * size {
            return true;
        }
    }
    false
}

/// Scalar product.
#[inline(always)]
pub(super) fn dot<S: Scalar, const N: usize>(a: &[S; N], b: &[S; N]) -> S {
    let mut sum = a[0] * b[0];
    for j in 1..N {
        sum += a[j] * b[j];
    }
    sum
}

fn multiply<S: Scalar, const M: usize, const K: usize, const N: usize>(
    a: &Matrix<S, M, K>,
    b: &Matrix<S, K, N>,
) -> Matrix<S, M, N> {
    let mut product = [[S::ZERO; N]; M];
    for (row, a) in product.iter_mut().zip(a) {
        for (&factor, b) in a.iter().zip(b) {
            for (sum, &x) in row.iter_mut().zip(b) {
                *sum += factor * x;
            }
        }
    }
    product
}

fn add<S: Scalar, const M: usize, const N: usize>(
    a: &Matrix<S, M, N>,
    b: &Matrix<S, M, N>,
) -> Matrix<S, M, N> {
    std::array::from_fn(|i| std::array::from_fn(|j| a[i][j] + b[i][j]))
}

fn subtract<S: Scalar, const M: usize, const N: usize>(
    a: &Matrix<S, M, N>,
    b: &Matrix<S, M, N>,
) -> Matrix<S, M, N> {
    std::array::from_fn(|i| std::array::from_fn(|j| a[i][j] - b[i][j]))
}

fn inverse<S: Scalar>(a: &Matrix<S, 2, 2>) -> Option<Matrix<S, 2, 2>> {
    let determinant = a[0][0] * a[1][1] - a[0][1] * a[1][0];
    if determinant.value() == 0.0 || !determinant.value().is_finite() {
        return None;
    }
    let scale = S::constant(1.0) / determinant;
    Some([
        [a[1][1] * scale, -(a[0][1] * scale)],
        [-(a[1][0] * scale), a[0][0] * scale],
    ])
}
