//! Friction laws of the pin on the disc as functions of slip speed and acceleration.

use core::f64::consts::PI;
use libm::{atan2, exp};

/// Coefficient of friction of the pin contact.
#[derive(Debug, Clone, PartialEq)]
pub enum ContactLaw {
    /// Constant coefficient.
    Coulomb {
        /// Sliding and breakaway coefficient [-].
        mu_c: f64,
    },
    /// Constant while sliding, higher at breakaway.
    CoulombStiction {
        /// Sliding coefficient [-].
        mu_c: f64,
        /// Breakaway coefficient [-].
        mu_s: f64,
    },
    /// μ_c + (μ_s − μ_c) exp(−|ω|/ω_s).
    Stribeck {
        /// Coefficient at high speed [-].
        mu_c: f64,
        /// Breakaway coefficient [-].
        mu_s: f64,
        /// Stribeck speed [rad/s].
        omega_s: f64,
    },
    /// Eq. 6-2: two Gaussians of the phase-plane angle α.
    TwoGaussian(TwoGaussian),
    /// `(1 − weight)`·base + `weight`·other: a hidden law smaller than its full difference.
    Blend {
        /// The analyst's law.
        base: Box<ContactLaw>,
        /// The law at full size.
        other: Box<ContactLaw>,
        /// Share of `other`, 0 to 1.
        weight: f64,
    },
}

/// Numbers of Eq. 6-2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TwoGaussian {
    /// Heights a1, a2 [-].
    pub height: [f64; 2],
    /// Centres b1, b2 [rad].
    pub centre: [f64; 2],
    /// Widths c1, c2 [rad].
    pub width: [f64; 2],
    /// Centre and velocity semi-axis of the ellipse [rad/s].
    pub omega_centre: f64,
    /// Acceleration semi-axis of the ellipse [rad/s²].
    pub acceleration_semi_axis: f64,
}

impl TwoGaussian {
    /// Coefficient at the phase-plane angle α [rad].
    pub fn at_angle(&self, angle: f64) -> f64 {
        (0..2)
            .map(|k| {
                let distance = (angle - self.centre[k]) / self.width[k];
                self.height[k] * exp(-distance * distance)
            })
            .sum()
    }
}

impl ContactLaw {
    /// Coefficient at which the contact breaks away from rest [-].
    pub fn breakaway(&self) -> f64 {
        match self {
            Self::Coulomb { mu_c } => *mu_c,
            Self::CoulombStiction { mu_s, .. } | Self::Stribeck { mu_s, .. } => *mu_s,
            Self::TwoGaussian(law) => law.at_angle(PI).max(law.at_angle(-PI)),
            Self::Blend {
                base,
                other,
                weight,
            } => (1.0 - weight) * base.breakaway() + weight * other.breakaway(),
        }
    }

    /// Coefficient a bristle bears in steady sliding at `speed` = |ω| [rad/s] ≥ 0 and
    /// `acceleration` = sign(ω)·dω/dt [rad/s²].
    pub fn coefficient(&self, speed: f64, acceleration: f64) -> f64 {
        match self {
            Self::Coulomb { mu_c } | Self::CoulombStiction { mu_c, .. } => *mu_c,
            Self::Stribeck {
                mu_c,
                mu_s,
                omega_s,
            } => mu_c + (mu_s - mu_c) * exp(-speed / omega_s),
            Self::TwoGaussian(law) => {
                let angle = atan2(
                    acceleration / law.acceleration_semi_axis,
                    (speed - law.omega_centre) / law.omega_centre,
                );
                law.at_angle(angle)
            }
            Self::Blend {
                base,
                other,
                weight,
            } => {
                (1.0 - weight) * base.coefficient(speed, acceleration)
                    + weight * other.coefficient(speed, acceleration)
            }
        }
    }

    /// The same law with all its levels times `factor`.
    pub fn with_level(&self, factor: f64) -> Self {
        let mut law = self.clone();
        match &mut law {
            Self::Coulomb { mu_c } => *mu_c *= factor,
            Self::CoulombStiction { mu_c, mu_s } | Self::Stribeck { mu_c, mu_s, .. } => {
                *mu_c *= factor;
                *mu_s *= factor;
            }
            Self::TwoGaussian(law) => law.height = law.height.map(|height| height * factor),
            Self::Blend { base, other, .. } => {
                **base = base.with_level(factor);
                **other = other.with_level(factor);
            }
        }
        law
    }

    /// Numbers with the keys of `model.toml`; those of a blend are of what is hidden in it.
    pub fn numbers(&self) -> Vec<(&'static str, f64)> {
        match self {
            Self::Coulomb { mu_c } => vec![("mu_c", *mu_c)],
            Self::CoulombStiction { mu_c, mu_s } => vec![("mu_c", *mu_c), ("mu_s", *mu_s)],
            Self::Stribeck {
                mu_c,
                mu_s,
                omega_s,
            } => vec![("mu_c", *mu_c), ("mu_s", *mu_s), ("omega_s", *omega_s)],
            Self::TwoGaussian(law) => vec![
                ("a1", law.height[0]),
                ("b1", law.centre[0]),
                ("c1", law.width[0]),
                ("a2", law.height[1]),
                ("b2", law.centre[1]),
                ("c2", law.width[1]),
                ("omega_centre", law.omega_centre),
                ("acceleration_semi_axis", law.acceleration_semi_axis),
            ],
            Self::Blend { other, .. } => other.numbers(),
        }
    }

    /// Name as in `model.toml`; a blend is called by what is hidden in it.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Coulomb { .. } => "coulomb",
            Self::CoulombStiction { .. } => "coulomb_stiction",
            Self::Stribeck { .. } => "stribeck",
            Self::TwoGaussian(_) => "two_gaussian_mu",
            Self::Blend { other, .. } => other.name(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn laws_break_away_at_their_level_at_rest_and_slide_at_their_own() {
        let stiction = ContactLaw::CoulombStiction {
            mu_c: 0.13,
            mu_s: 0.2,
        };
        assert_eq!(stiction.breakaway(), 0.2);
        assert_eq!(stiction.coefficient(0.1, 0.0), 0.13);
        let stribeck = ContactLaw::Stribeck {
            mu_c: 0.12,
            mu_s: 0.2,
            omega_s: 1.2,
        };
        assert!(
            (stribeck.coefficient(1.2, 0.0) - (0.12 + 0.08 / core::f64::consts::E)).abs() < 1e-12
        );
    }

    #[test]
    fn a_blend_without_weight_is_its_base() {
        let base = ContactLaw::Coulomb { mu_c: 0.14 };
        let blend = ContactLaw::Blend {
            base: Box::new(base.clone()),
            other: Box::new(ContactLaw::Coulomb { mu_c: 0.3 }),
            weight: 0.0,
        };
        assert_eq!(blend.coefficient(2.0, 1.0), base.coefficient(2.0, 1.0));
        assert_eq!(blend.breakaway(), base.breakaway());
    }
}
