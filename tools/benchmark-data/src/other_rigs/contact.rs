//! Friction laws of rigs of any size: what the analyst believes and what holds.

use crate::hidden_effect::Effect;
use crate::law::{ContactLaw, TwoGaussian};
use crate::random::Stream;
use core::f64::consts::PI;

/// Distance from the ellipse's centre, in semi-axes, within which α turns too fast to be followed [-].
const CENTRE: f64 = 0.07;

/// Levels of a law [-].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Levels {
    /// In sliding at the top speed.
    pub sliding: f64,
    /// At breakaway.
    pub breakaway: f64,
}

/// Speeds a law is scaled by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Speeds {
    /// Top speed of the drive [rad/s].
    pub top: f64,
    /// Natural angular frequency of the disc on its shaft [rad/s].
    pub natural: f64,
}

/// The analyst's law and the true one, before anybody is off by a few per cent.
#[derive(Debug, Clone, PartialEq)]
pub struct Laws {
    /// What the analyst believes.
    pub believed: ContactLaw,
    /// What holds.
    pub truth: ContactLaw,
    /// Levels of what holds.
    pub levels: Levels,
}

/// Draws a pin's laws for these `effects`; `base` is the analyst's law where the kind fixes it.
/// `share` of a hidden law is hidden: 1 = all of it.
pub fn draw_laws(
    effects: &[Effect],
    base: Option<&str>,
    share: f64,
    speeds: Speeds,
    stream: &mut Stream,
) -> Laws {
    let mu_c = digits(stream.log_uniform(0.08, 0.5));
    let mu_s = digits(mu_c * stream.uniform(1.2, 2.0));
    let omega_s = digits(speeds.top * stream.log_uniform(0.05, 0.4));
    let drawn = match stream.uniform(0.0, 1.0) {
        share if share < 0.6 => "stribeck",
        share if share < 0.85 => "coulomb_stiction",
        _ => "coulomb",
    };
    let hidden = effects
        .iter()
        .find(|effect| effect.replaced_law().is_some());
    let gaussian = draw_two_gaussian(mu_c, mu_s, speeds, stream);
    let off = |stream: &mut Stream| stream.uniform(0.9, 1.1);
    let (sliding_off, breakaway_off) = (off(stream), off(stream));
    let stiction = ContactLaw::CoulombStiction { mu_c, mu_s };
    let stribeck = ContactLaw::Stribeck {
        mu_c,
        mu_s,
        omega_s,
    };
    let levels = Levels {
        sliding: mu_c,
        breakaway: mu_s,
    };
    let (believed, truth) = match hidden {
        Some(Effect::Stribeck) => (stiction, stribeck),
        Some(Effect::Stiction) => (ContactLaw::Coulomb { mu_c }, stiction),
        Some(_) => {
            let (mu_c, mu_s) = (digits(mu_c * sliding_off), digits(mu_s * breakaway_off));
            let mu_s = mu_s.max(digits(1.1 * mu_c));
            let believed = match base {
                Some("coulomb_stiction") => ContactLaw::CoulombStiction { mu_c, mu_s },
                _ => ContactLaw::Stribeck {
                    mu_c,
                    mu_s,
                    omega_s,
                },
            };
            (believed, ContactLaw::TwoGaussian(gaussian))
        }
        None => {
            // These do nothing where friction does not change with the velocity.
            let needs_a_fall = [Effect::BreakawayAfterDwell, Effect::FrictionMemory];
            let needs_a_fall = effects.iter().any(|effect| needs_a_fall.contains(effect));
            let drawn = if needs_a_fall { "stribeck" } else { drawn };
            let law = match base.unwrap_or(drawn) {
                "coulomb" => ContactLaw::Coulomb { mu_c },
                "coulomb_stiction" => stiction,
                "two_gaussian_mu" => ContactLaw::TwoGaussian(gaussian),
                _ => stribeck,
            };
            (law.clone(), law)
        }
    };
    let truth = if hidden.is_some() && share < 1.0 {
        ContactLaw::Blend {
            base: Box::new(believed.clone()),
            other: Box::new(truth),
            weight: share,
        }
    } else {
        truth
    };
    Laws {
        believed,
        truth,
        levels,
    }
}

/// Two Gaussians that fall from about `mu_s` at rest to about `mu_c` at the highest velocity.
fn draw_two_gaussian(mu_c: f64, mu_s: f64, speeds: Speeds, stream: &mut Stream) -> TwoGaussian {
    // On the side of slowing down: were friction higher where the disc speeds up, its jump at α = ±π
    // would hold the disc at a constant velocity below the ellipse's centre.
    let rest_centre = -stream.uniform(2.3, PI);
    let rest_width = stream.uniform(0.7, 2.0);
    let slide_centre = stream.uniform(-0.9, 0.9);
    let slide_width = stream.uniform(1.8, 3.6);
    let bell = |angle: f64, centre: f64, width: f64| {
        let distance = (angle - centre) / width;
        libm::exp(-distance * distance)
    };
    // Heights from the two levels: a 2 × 2 system at α = 0 and α = −π.
    let end = -PI;
    let (rest_end, slide_end) = (
        bell(end, rest_centre, rest_width),
        bell(end, slide_centre, slide_width),
    );
    let (rest_zero, slide_zero) = (
        bell(0.0, rest_centre, rest_width),
        bell(0.0, slide_centre, slide_width),
    );
    let determinant = rest_end * slide_zero - slide_end * rest_zero;
    let rest_height = (mu_s * slide_zero - mu_c * slide_end) / determinant;
    let slide_height = (mu_c * rest_end - mu_s * rest_zero) / determinant;
    let omega_centre = digits(speeds.top * stream.log_uniform(0.35, 1.3));
    let steepness = stream.log_uniform(0.8, 5.0);
    TwoGaussian {
        height: [digits(rest_height), digits(slide_height)],
        centre: [digits(rest_centre), digits(slide_centre)],
        width: [digits(rest_width), digits(slide_width)],
        omega_centre,
        acceleration_semi_axis: digits(steepness * speeds.natural * omega_centre),
    }
}

/// Whether the law never pulls and what it bears stays within reason, at every angle.
pub fn is_sound(law: &ContactLaw, levels: Levels) -> bool {
    let ContactLaw::TwoGaussian(law) = innermost(law) else {
        return true;
    };
    (-314..=314).all(|hundredth| {
        let level = law.at_angle(f64::from(hundredth) * 0.01);
        (0.3 * levels.sliding..=1.3 * levels.breakaway).contains(&level)
    })
}

/// 1 + (dT/da)/J of a disc of `inertia` [kg m²] at `speed` [rad/s] and `acceleration` [rad/s²] under
/// `torque_per_mu` [N m]: the algebraic loop has one solution where it is above 0. At the ellipse's centre it is 0.
pub fn loop_margin(
    law: &ContactLaw,
    torque_per_mu: f64,
    inertia: f64,
    speed: f64,
    acceleration: f64,
) -> f64 {
    let ContactLaw::TwoGaussian(ellipse) = innermost(law) else {
        return 1.0;
    };
    let from_centre = libm::hypot(
        speed.abs() / ellipse.omega_centre - 1.0,
        acceleration / ellipse.acceleration_semi_axis,
    );
    if from_centre < CENTRE {
        return 0.0;
    }
    let along = if speed < 0.0 { -1.0 } else { 1.0 };
    let change = 1e-4 * inertia.recip() * torque_per_mu * law.breakaway();
    let at = |acceleration: f64| law.coefficient(speed.abs(), along * acceleration);
    let rise = at(acceleration + change) - at(acceleration - change);
    // At the seam α = ±π the law jumps; what the loop does there is no matter of its slope.
    if (along * acceleration).abs() < 2.0 * change {
        return 1.0;
    }
    1.0 + along * torque_per_mu * rise / (2.0 * change * inertia)
}

fn innermost(law: &ContactLaw) -> &ContactLaw {
    match law {
        ContactLaw::Blend { other, .. } => other,
        law => law,
    }
}

fn digits(value: f64) -> f64 {
    super::drawing::four_digits(value)
}
