//! Stribeck's law (Eq. 2-3; Stribeck 1902) with the exponential curve g(ω) = exp(−|ω|/ω_s).

use crate::parameter::{Range, section};
use crate::series::{Scalar, Series, exponential};

section! {
    /// Friction that falls with the slip velocity: μ = μ_c + (μ_s − μ_c) exp(−|ω|/ω_s), breakaway at μ_s.
    pub struct Stribeck {
        /// Sliding friction coefficient at high slip velocity
        mu_c: "1", Range::NonNegative;
        /// Static friction coefficient, at which a stuck contact breaks away
        mu_s: "1", Range::NonNegative;
        /// Stribeck velocity: slip velocity at which the excess over mu_c has fallen to 1/e
        omega_s: "rad/s", Range::Positive;
    }
}

/// A level μ_c + `span` exp(−ω/ω_s) that depends on the slip speed ω alone.
#[derive(Clone, Copy, Debug)]
pub struct ExponentialCurve<S> {
    /// Level at high speed.
    pub mu_c: S,
    /// Excess over `mu_c` at zero speed.
    pub span: S,
    /// 1/ω_s [s/rad].
    pub inverse_omega_s: S,
}

/// Series that [`coefficient`] works on.
pub(super) const WORKSPACE: usize = 2;

/// Coefficient `k` of μ_c + (μ_s − μ_c) exp(−ω/ω_s) along the slip speed ω ≥ 0.
#[inline(always)]
pub(super) fn coefficient<S: Scalar>(
    k: usize,
    law: &Stribeck<S>,
    speed: &Series<S>,
    work: &mut [Series<S>],
) -> S {
    let [weighted, excess, ..] = work else {
        return S::ZERO;
    };
    if k == 0 {
        weighted[0] = -(S::constant(1.0) / law.omega_s);
        excess[0] = (law.mu_s - law.mu_c) * (speed[0] * weighted[0]).exp();
        return law.mu_c + excess[0];
    }
    weighted[k] = speed[k] * weighted[0] * k as f64;
    excess[k] = exponential(k, weighted, excess);
    excess[k]
}

/// The exponential part, from the series that [`coefficient`] worked on.
pub(super) fn excess(work: &[Series<f64>]) -> Series<f64> {
    work[1]
}
