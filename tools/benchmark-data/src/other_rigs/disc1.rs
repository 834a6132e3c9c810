//! Disc D1, which hangs on D2 by a shaft of its own (Eq. 4-4).

use crate::effects::Effects;
use crate::law::ContactLaw;
use crate::other_rigs::drawing::{LARGEST_LOAD, OtherRig, four_digits};
use crate::other_rigs::sizes::Scales;
use crate::random::Stream;
use crate::rig::relative_uncertainty;
use crate::simulator::Disc1;
use std::collections::BTreeMap;

/// What is drawn of disc D1, as shares of what disc D2 has.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Disc1Draws {
    /// Inertia over D2's [-], 0.4 to 3.
    pub inertia: f64,
    /// Stiffness of shaft 1 over that of the drive's shaft [-], 1.5 to 12.
    pub stiffness: f64,
    /// Damping ratio of D1 on shaft 1 [-], 0.002 to 0.05.
    pub damping_ratio: f64,
    /// Friction torque at the middle load over D2's [-], 0.3 to 1.
    pub torque: f64,
    /// Pin radius over D2's [-], 0.7 to 1.4.
    pub radius: f64,
}

/// What the analyst believes of disc D1.
#[derive(Debug, Clone, PartialEq)]
pub struct BelievedOuter {
    /// The parts; nothing is hidden.
    pub part: Disc1,
    /// Middle normal force on D1 [N].
    pub middle_load: f64,
    /// Friction torque at it [N m].
    pub torque: f64,
}

/// Ratio of true over believed, D1's name and the name of D2's that is as uncertain.
const RATIOS: [(&str, &str); 4] = [("J1", "J2"), ("k1", "k2"), ("c1", "c2"), ("mu1", "mu")];

impl Disc1Draws {
    /// Draws disc D1.
    pub fn draw(stream: &mut Stream) -> Self {
        Self {
            inertia: stream.log_uniform(0.4, 3.0),
            stiffness: stream.log_uniform(1.5, 12.0),
            damping_ratio: stream.log_uniform(0.002, 0.05),
            torque: stream.log_uniform(0.3, 1.0),
            radius: stream.uniform(0.7, 1.4),
        }
    }

    /// Draws truth over belief at `spread` (0.02 = the stated standard deviations).
    pub fn ratios(&self, spread: f64, stream: &mut Stream) -> BTreeMap<String, f64> {
        RATIOS
            .iter()
            .map(|&(name, like)| {
                let deviation = stream.normal().clamp(-2.5, 2.5);
                let ratio = 1.0 + relative_uncertainty(like, spread) * deviation;
                (name.to_owned(), (ratio * 1e5).round() / 1e5)
            })
            .collect()
    }

    /// Disc D1 of `rig`, its friction law drawn.
    pub fn build(&self, rig: &OtherRig, stream: &mut Stream) -> BelievedOuter {
        let inertia = four_digits(self.inertia * rig.believed.disc_inertia);
        let stiffness = four_digits(self.stiffness * rig.believed.shaft_stiffness);
        let rate = libm::sqrt(stiffness / inertia);
        let radius = four_digits(self.radius * rig.believed.contact_radius);
        let mu_c = four_digits(stream.log_uniform(0.08, 0.5));
        let mu_s = four_digits(mu_c * stream.uniform(1.1, 1.6));
        let law = if stream.chance(0.7) {
            ContactLaw::Stribeck {
                mu_c,
                mu_s,
                omega_s: four_digits(rig.top_speed * stream.log_uniform(0.05, 0.4)),
            }
        } else {
            ContactLaw::CoulombStiction { mu_c, mu_s }
        };
        let torque = self.torque * rig.torque;
        BelievedOuter {
            part: Disc1 {
                inertia,
                shaft_stiffness: stiffness,
                shaft_damping: four_digits(2.0 * self.damping_ratio * inertia * rate),
                contact_radius: radius,
                law,
                effects: Effects::default(),
            },
            middle_load: torque / (mu_c * radius),
            torque,
        }
    }
}

impl BelievedOuter {
    /// Disc D1 as it truly is.
    pub fn truth(&self, ratios: &BTreeMap<String, f64>, effects: Effects) -> Disc1 {
        let ratio = |name: &str| ratios.get(name).copied().unwrap_or(1.0);
        Disc1 {
            inertia: self.part.inertia * ratio("J1"),
            shaft_stiffness: self.part.shaft_stiffness * ratio("k1"),
            shaft_damping: self.part.shaft_damping * ratio("c1"),
            contact_radius: self.part.contact_radius,
            law: self.part.law.with_level(ratio("mu1")),
            effects,
        }
    }

    /// Scales of effects on D1 and shaft 1; torques are still shares of D2's friction.
    pub fn scales(&self, disc: &Scales) -> Scales {
        // What shaft 1 turns D1 with when both stick and slip together.
        let swing = self.part.inertia * disc.speed * core::f64::consts::TAU / disc.period;
        Scales {
            largest_torque: LARGEST_LOAD * self.torque + 0.5 * swing,
            stiffness: self.part.shaft_stiffness,
            inertia: self.part.inertia,
            load: self.middle_load,
            ..*disc
        }
    }
}
