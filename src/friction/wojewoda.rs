//! The hysteretic law of Wojewoda, Stefański, Wiercigroch and Kapitaniak (2008), Eqs 2-5 to 2-8.

use super::random_function::{HARMONICS, RandomFunction};
use super::stribeck::{self, Stribeck};
use crate::parameter::{BUILT_IN, Range, section};
use crate::series::{Scalar, Series, TERMS, cosine_sine};

section! {
    /// Friction that is higher while the contact speeds up than while it slows down:
    /// μ± = μ_c ± (μ_s − μ_c)(g(ω) + f_r(θ)), g = exp(−|ω|/ω_s), f_r a seeded random function of
    /// the disc's angle. Eq. 2-6 (an elastic contact of stiffness k_s) is taken in its stiff limit:
    /// an exactly stuck contact that breaks away at μ_s.
    pub struct Wojewoda {
        /// Sliding friction coefficient between the two branches
        mu_c: "1", Range::NonNegative;
        /// Static friction coefficient, at which a stuck contact breaks away
        mu_s: "1", Range::NonNegative;
        /// Stribeck velocity of both branches
        omega_s: "rad/s", Range::Positive;
        /// Standard deviation of the random part f_r
        stochastic_amplitude: "1", Range::Between(0.0, 0.5);
        /// Angle over which the random part stays correlated
        correlation_angle: "rad", Range::Positive;
        /// Number of the random function: the same seed gives the same friction
        seed: "1", Range::NonNegative, BUILT_IN;
    }
}

/// Series that [`excess`] works on: the curve's, the angle's, the wave numbers and two for each
/// harmonic of f_r.
pub(super) const WORKSPACE: usize = stribeck::WORKSPACE + 2 + 2 * HARMONICS;

/// Coefficient `k` of (μ_s − μ_c)(g + f_r) along the slip speed ω ≥ 0 and the disc's angle: what
/// the upper branch adds to μ_c and the lower one takes away.
pub(super) fn excess<S: Scalar>(
    k: usize,
    law: &Wojewoda<S>,
    speed: &Series<S>,
    angle: &Series<S>,
    work: &mut [Series<S>],
) -> S {
    let (curve, random) = work.split_at_mut(stribeck::WORKSPACE);
    let span = law.mu_s - law.mu_c;
    let shape = Stribeck {
        mu_c: S::ZERO,
        mu_s: span,
        omega_s: law.omega_s,
    };
    let deterministic = stribeck::coefficient(k, &shape, speed, curve);
    if law.stochastic_amplitude.value() == 0.0 {
        return deterministic;
    }
    let [weighted, wave_numbers, waves @ ..] = random else {
        return deterministic;
    };
    weighted[k] = angle[k] * k as f64;
    let mut sum = S::ZERO;
    if k == 0 {
        let function = RandomFunction::new(law.seed.value() as u64, law.correlation_angle.value());
        let stretch = S::constant(law.correlation_angle.value()) / law.correlation_angle;
        for (m, &(wave_number, phase)) in function.harmonics.iter().enumerate() {
            wave_numbers[m] = stretch * wave_number;
            let (sine, cosine) = (angle[0] * wave_numbers[m] + phase).sin_cos();
            (waves[2 * m][0], waves[2 * m + 1][0]) = (cosine, sine);
            sum += cosine;
        }
    } else {
        for m in 0..HARMONICS {
            let (c, s) = cosine_sine(k, weighted, &waves[2 * m], &waves[2 * m + 1]);
            waves[2 * m][k] = c * wave_numbers[m];
            waves[2 * m + 1][k] = s * wave_numbers[m];
            sum += waves[2 * m][k];
        }
    }
    deterministic + span * law.stochastic_amplitude * sum * RandomFunction::amplitude()
}

/// The random part f_r along a motion, and its derivative by the disc's angle [per rad].
pub(super) struct RandomPart {
    pub value: Series<f64>,
    pub by_angle: Series<f64>,
}

/// The exponential part of [`excess`] and, if there is one, the random part, from the series that
/// `excess` worked on.
pub(super) fn parts(
    law: &Wojewoda<f64>,
    work: &[Series<f64>],
    order: usize,
) -> (Series<f64>, Option<RandomPart>) {
    let (curve, random) = work.split_at(stribeck::WORKSPACE);
    let exponential = stribeck::excess(curve);
    let [_, wave_numbers, waves @ ..] = random else {
        return (exponential, None);
    };
    if law.stochastic_amplitude == 0.0 {
        return (exponential, None);
    }
    let mut part = RandomPart {
        value: [0.0; TERMS],
        by_angle: [0.0; TERMS],
    };
    let scale = RandomFunction::amplitude();
    for m in 0..HARMONICS {
        let (cosine, sine) = (&waves[2 * m], &waves[2 * m + 1]);
        for k in 0..=order {
            part.value[k] += scale * cosine[k];
            part.by_angle[k] -= scale * wave_numbers[m] * sine[k];
        }
    }
    (exponential, Some(part))
}
