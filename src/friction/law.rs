//! The friction laws as one type.

use super::two_gaussian::{self, TwoGaussian};
use super::{
    Coulomb, CoulombStiction, ExponentialCurve, HARMONICS, Karnopp, RandomFunction, Stribeck,
    Switch, TwoGaussianMu, TwoGaussianTorque, Wojewoda, stribeck, wojewoda,
};
use crate::parameter::{ParameterError, ParameterInfo, Section};
use crate::series::Scalar;

/// Names of the laws as `model.toml` spells them.
pub const LAW_NAMES: [&str; 8] = [
    "coulomb",
    "coulomb_stiction",
    "stribeck",
    "karnopp",
    "switch",
    "wojewoda",
    "two_gaussian_torque",
    "two_gaussian_mu",
];

/// A friction law with its parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law<S> {
    /// Eq. 2-1.
    Coulomb(Coulomb<S>),
    /// Eq. 2-2.
    CoulombStiction(CoulombStiction<S>),
    /// Eq. 2-3.
    Stribeck(Stribeck<S>),
    /// Eq. 2-4.
    Karnopp(Karnopp<S>),
    /// Leine's switch model.
    Switch(Switch<S>),
    /// Eqs 2-5 to 2-8.
    Wojewoda(Wojewoda<S>),
    /// Eq. 6-1.
    TwoGaussianTorque(TwoGaussianTorque<S>),
    /// Eq. 6-2.
    TwoGaussianMu(TwoGaussianMu<S>),
}

macro_rules! each_law {
    ($law:expr, $section:ident => $result:expr) => {
        match $law {
            Law::Coulomb($section) => $result,
            Law::CoulombStiction($section) => $result,
            Law::Stribeck($section) => $result,
            Law::Karnopp($section) => $result,
            Law::Switch($section) => $result,
            Law::Wojewoda($section) => $result,
            Law::TwoGaussianTorque($section) => $result,
            Law::TwoGaussianMu($section) => $result,
        }
    };
}

impl<S: Scalar> Law<S> {
    /// The law called `name` with the values that `value` gives; `None` if there is no such law.
    pub fn from_values<E>(
        name: &str,
        value: impl FnMut(&'static ParameterInfo) -> Result<S, E>,
    ) -> Option<Result<Self, E>> {
        Some(match name {
            "coulomb" => Coulomb::from_values(value).map(Self::Coulomb),
            "coulomb_stiction" => CoulombStiction::from_values(value).map(Self::CoulombStiction),
            "stribeck" => Stribeck::from_values(value).map(Self::Stribeck),
            "karnopp" => Karnopp::from_values(value).map(Self::Karnopp),
            "switch" => Switch::from_values(value).map(Self::Switch),
            "wojewoda" => Wojewoda::from_values(value).map(Self::Wojewoda),
            "two_gaussian_torque" => {
                TwoGaussianTorque::from_values(value).map(Self::TwoGaussianTorque)
            }
            "two_gaussian_mu" => TwoGaussianMu::from_values(value).map(Self::TwoGaussianMu),
            _ => return None,
        })
    }

    /// The law's name in `model.toml`.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Coulomb(_) => LAW_NAMES[0],
            Self::CoulombStiction(_) => LAW_NAMES[1],
            Self::Stribeck(_) => LAW_NAMES[2],
            Self::Karnopp(_) => LAW_NAMES[3],
            Self::Switch(_) => LAW_NAMES[4],
            Self::Wojewoda(_) => LAW_NAMES[5],
            Self::TwoGaussianTorque(_) => LAW_NAMES[6],
            Self::TwoGaussianMu(_) => LAW_NAMES[7],
        }
    }

    /// The law's parameters.
    pub fn section(&self) -> &dyn Section<S> {
        each_law!(self, law => law)
    }

    /// The law's parameters, to be changed.
    pub fn section_mut(&mut self) -> &mut dyn Section<S> {
        each_law!(self, law => law)
    }

    /// The same law over another kind of number.
    pub fn to_scalar<T: Scalar>(&self) -> Law<T> {
        match self {
            Self::Coulomb(law) => Law::Coulomb(law.to_scalar()),
            Self::CoulombStiction(law) => Law::CoulombStiction(law.to_scalar()),
            Self::Stribeck(law) => Law::Stribeck(law.to_scalar()),
            Self::Karnopp(law) => Law::Karnopp(law.to_scalar()),
            Self::Switch(law) => Law::Switch(law.to_scalar()),
            Self::Wojewoda(law) => Law::Wojewoda(law.to_scalar()),
            Self::TwoGaussianTorque(law) => Law::TwoGaussianTorque(law.to_scalar()),
            Self::TwoGaussianMu(law) => Law::TwoGaussianMu(law.to_scalar()),
        }
    }

    /// Level at which a stuck contact breaks away: a coefficient of friction, or a torque [N m] if
    /// the law is one of the torque.
    pub fn breakaway(&self) -> S {
        match self {
            Self::Coulomb(law) => law.mu_c,
            Self::CoulombStiction(law) => law.mu_s,
            Self::Stribeck(law) => law.mu_s,
            Self::Karnopp(law) => law.mu_s,
            Self::Switch(law) => law.mu_s,
            Self::Wojewoda(law) => law.mu_s,
            Self::TwoGaussianTorque(law) => law.shape().breakaway(),
            Self::TwoGaussianMu(law) => law.shape().breakaway(),
        }
    }

    /// Level at high slip speed of the laws that have a constant one; zero for the others.
    pub fn sliding(&self) -> S {
        match self {
            Self::Coulomb(law) => law.mu_c,
            Self::CoulombStiction(law) => law.mu_c,
            Self::Stribeck(law) => law.mu_c,
            Self::Karnopp(law) => law.mu_c,
            Self::Switch(law) => law.mu_c,
            Self::Wojewoda(law) => law.mu_c,
            Self::TwoGaussianTorque(_) | Self::TwoGaussianMu(_) => S::ZERO,
        }
    }

    /// Whether the level is a torque that does not scale with the normal force.
    pub fn is_torque(&self) -> bool {
        matches!(self, Self::TwoGaussianTorque(_))
    }

    /// The two Gaussians, if the law is made of them.
    pub fn two_gaussian(&self) -> Option<TwoGaussian<S>> {
        match self {
            Self::TwoGaussianTorque(law) => Some(law.shape()),
            Self::TwoGaussianMu(law) => Some(law.shape()),
            _ => None,
        }
    }

    /// Whether the level depends on the sign of the slip acceleration, so that a sliding contact
    /// has branches.
    pub fn has_branches(&self) -> bool {
        matches!(
            self,
            Self::Wojewoda(_) | Self::TwoGaussianTorque(_) | Self::TwoGaussianMu(_)
        )
    }

    /// Half width [rad/s] of the band of velocities that counts as zero, and the rate [1/s] at which
    /// a velocity inside it decays while stuck. Zero for laws that stick exactly.
    pub fn band(&self) -> (S, S) {
        match self {
            Self::Karnopp(law) => (law.omega_tolerance, S::ZERO),
            Self::Switch(law) => (law.omega_tolerance, law.decay_rate),
            _ => (S::ZERO, S::ZERO),
        }
    }

    /// The law as an exponential curve, if it is one.
    pub fn exponential_curve(&self) -> Option<ExponentialCurve<S>> {
        let (mu_c, mu_s, omega_s) = match self {
            Self::Stribeck(law) => (law.mu_c, law.mu_s, law.omega_s),
            Self::Karnopp(law) => (law.mu_c, law.mu_s, law.omega_s),
            Self::Switch(law) => (law.mu_c, law.mu_s, law.omega_s),
            _ => return None,
        };
        Some(ExponentialCurve {
            mu_c,
            span: mu_s - mu_c,
            inverse_omega_s: S::constant(1.0) / omega_s,
        })
    }

    /// Number of series that the recurrences of this law work on.
    pub(super) fn workspace(&self) -> usize {
        match self {
            Self::Coulomb(_) | Self::CoulombStiction(_) => 0,
            Self::Stribeck(_) | Self::Karnopp(_) | Self::Switch(_) => stribeck::WORKSPACE,
            Self::Wojewoda(_) => wojewoda::WORKSPACE,
            Self::TwoGaussianTorque(_) | Self::TwoGaussianMu(_) => two_gaussian::WORKSPACE,
        }
    }

    /// Checks what single ranges cannot: breakaway must not lie below sliding, and friction must not
    /// drive.
    pub fn check(&self, section: &str) -> Result<(), ParameterError> {
        let (sliding, breakaway) = match self {
            Self::CoulombStiction(law) => (law.mu_c, law.mu_s),
            Self::Stribeck(law) => (law.mu_c, law.mu_s),
            Self::Karnopp(law) => (law.mu_c, law.mu_s),
            Self::Switch(law) => (law.mu_c, law.mu_s),
            Self::Wojewoda(law) => (law.mu_c, law.mu_s),
            _ => return Ok(()),
        };
        if breakaway.value() < sliding.value() {
            return Err(ParameterError::Inconsistent {
                section: section.to_owned(),
                message: format!(
                    "the breakaway level mu_s = {} is below the sliding level mu_c = {}; mu_s must not be smaller",
                    breakaway.value(),
                    sliding.value()
                ),
            });
        }
        if let Self::Wojewoda(law) = self {
            let largest = HARMONICS as f64 * RandomFunction::amplitude();
            let excess = 1.0 + law.stochastic_amplitude.value() * largest;
            let lowest = sliding.value() - (breakaway.value() - sliding.value()) * excess;
            if lowest < 0.0 {
                return Err(ParameterError::Inconsistent {
                    section: section.to_owned(),
                    message: format!(
                        "the lower branch reaches mu_c - (mu_s - mu_c)(1 + {largest:.3} stochastic_amplitude) = {lowest}, \
                         so that friction would drive; raise mu_c = {} or lower mu_s = {} or stochastic_amplitude = {}",
                        sliding.value(),
                        breakaway.value(),
                        law.stochastic_amplitude.value()
                    ),
                });
            }
        }
        Ok(())
    }
}
