//! From a kind and a seed to a complete hidden case.

use crate::answers::Answer;
use crate::effects::Effects;
use crate::excitation::{Brake, Run, draw_runs};
use crate::law::{ContactLaw, TwoGaussian};
use crate::random::{Purpose, Stream};
use crate::rig::{FRICTION_LEVEL, NOMINAL, draw_ratios};
use crate::simulator::TrueRig;
use core::f64::consts::TAU;

/// Random friction of a rough case: standard deviation [-].
const ROUGH_STANDARD_DEVIATION: f64 = 0.04;
/// Random friction of a rough case: correlation time [s].
const ROUGH_CORRELATION_TIME: f64 = 0.1;

/// One hidden effect. The first block is in the catalogue, the second in none.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[expect(
    missing_docs,
    reason = "Effect::name and the records' README say what each is"
)]
pub enum Effect {
    AccelerationHysteresis,
    Backlash,
    BearingFriction,
    FrictionWear,
    GearRipple,
    LoadCellBias,
    LoadExponent,
    MotorViscous,
    NormalForceWobble,
    Presliding,
    QuadraticDrag,
    ResistanceDrift,
    SensorDelay,
    ShaftHardening,
    Stiction,
    Stribeck,
    SupplySag,
    Unbalance,
    ViscousDrag,

    BreathingInertia,
    DynamicAbsorber,
    FrictionBump,
    PeriodicTorque,
    ShaftSoftening,
    TorqueSaturation,
    BreakawayAfterDwell,
    FrictionMemory,
    DriveLag,
    EncoderEccentricity,
    TachometerGain,
    ThreeLobes,
    LiftingPin,
    FadingMotor,
}

/// Effects of the practice records; any two can stand in a pair.
pub const CATALOGUE: [Effect; 18] = [
    Effect::AccelerationHysteresis,
    Effect::Backlash,
    Effect::BearingFriction,
    Effect::FrictionWear,
    Effect::GearRipple,
    Effect::LoadCellBias,
    Effect::LoadExponent,
    Effect::MotorViscous,
    Effect::NormalForceWobble,
    Effect::QuadraticDrag,
    Effect::ResistanceDrift,
    Effect::SensorDelay,
    Effect::ShaftHardening,
    Effect::Stiction,
    Effect::Stribeck,
    Effect::SupplySag,
    Effect::Unbalance,
    Effect::ViscousDrag,
];

/// What is hidden, on which rig, under which belief.
#[derive(Debug, Clone, PartialEq)]
pub struct Kind {
    /// `kind` in the answers.
    pub name: String,
    /// The effects, none for a clean case.
    pub effects: Vec<Effect>,
    /// Whether the pin brakes the disc.
    pub brake: Brake,
    /// The analyst's friction law.
    pub base: &'static str,
}

/// How a case is drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct Recipe {
    /// What is hidden.
    pub kind: Kind,
    /// Seed of every random number of the case.
    pub seed: u64,
    /// Size over practice size, drawn from this range.
    pub scale: (f64, f64),
    /// How far the analyst is off, drawn from this range.
    pub spread: (f64, f64),
    /// Whether friction fluctuates at random.
    pub rough: bool,
    /// Factor on the noise of the instruments.
    pub noise: f64,
}

/// A complete case, ready to simulate.
#[derive(Debug, Clone)]
pub struct HiddenCase {
    /// The rig that makes the records.
    pub rig: TrueRig,
    /// What the analyst believes about the contact.
    pub believed_law: ContactLaw,
    /// The runs.
    pub runs: Vec<Run>,
    /// The sealed answer.
    pub answer: Answer,
}

/// The friction laws of the practice records by name; `None` for an unknown name.
pub fn practice_law(name: &str) -> Option<ContactLaw> {
    Some(match name {
        "coulomb" => ContactLaw::Coulomb { mu_c: 0.14 },
        "coulomb_stiction" => ContactLaw::CoulombStiction {
            mu_c: 0.13,
            mu_s: 0.2,
        },
        "stribeck" => STRIBECK,
        "two_gaussian_mu" => ContactLaw::TwoGaussian(TWO_GAUSSIAN),
        _ => return None,
    })
}

const STRIBECK: ContactLaw = ContactLaw::Stribeck {
    mu_c: 0.12,
    mu_s: 0.2,
    omega_s: 1.2,
};

const TWO_GAUSSIAN: TwoGaussian = TwoGaussian {
    height: [0.27115, 0.18567],
    centre: [-3.07246, 0.4796],
    width: [1.28946, 2.62303],
    omega_centre: 7.15956,
    acceleration_semi_axis: 58.2873,
};

impl Effect {
    /// Name in the answers, without the `outside_` of effects in no catalogue.
    pub fn name(self) -> &'static str {
        match self {
            Self::AccelerationHysteresis => "acceleration_hysteresis",
            Self::Backlash => "backlash",
            Self::BearingFriction => "bearing_friction",
            Self::FrictionWear => "friction_wear",
            Self::GearRipple => "gear_ripple",
            Self::LoadCellBias => "load_cell_bias",
            Self::LoadExponent => "load_exponent",
            Self::MotorViscous => "motor_viscous",
            Self::NormalForceWobble => "normal_force_wobble",
            Self::Presliding => "presliding",
            Self::QuadraticDrag => "quadratic_drag",
            Self::ResistanceDrift => "resistance_drift",
            Self::SensorDelay => "sensor_delay",
            Self::ShaftHardening => "shaft_hardening",
            Self::Stiction => "stiction",
            Self::Stribeck => "stribeck",
            Self::SupplySag => "supply_sag",
            Self::Unbalance => "unbalance",
            Self::ViscousDrag => "viscous_drag",
            Self::BreathingInertia => "breathing_inertia",
            Self::DynamicAbsorber => "dynamic_absorber",
            Self::FrictionBump => "friction_bump",
            Self::PeriodicTorque => "periodic_torque",
            Self::ShaftSoftening => "shaft_softening",
            Self::TorqueSaturation => "torque_saturation",
            Self::BreakawayAfterDwell => "breakaway_after_dwell",
            Self::FrictionMemory => "friction_memory",
            Self::DriveLag => "drive_lag",
            Self::EncoderEccentricity => "encoder_eccentricity",
            Self::TachometerGain => "tachometer_gain",
            Self::ThreeLobes => "three_lobes",
            Self::LiftingPin => "lifting_pin",
            Self::FadingMotor => "fading_motor",
        }
    }

    /// The analyst's law that this effect presumes, if it replaces the law.
    pub fn replaced_law(self) -> Option<&'static str> {
        match self {
            Self::AccelerationHysteresis => Some("stribeck"),
            Self::Stribeck => Some("coulomb_stiction"),
            Self::Stiction => Some("coulomb"),
            _ => None,
        }
    }

    /// The true law at full size, somewhat different in every case.
    fn full_law(self, stream: &mut Stream) -> Option<ContactLaw> {
        Some(match self {
            Self::AccelerationHysteresis => ContactLaw::TwoGaussian(TwoGaussian {
                height: TWO_GAUSSIAN
                    .height
                    .map(|height| height * stream.uniform(0.93, 1.07)),
                centre: TWO_GAUSSIAN
                    .centre
                    .map(|centre| centre + stream.uniform(-0.06, 0.06)),
                width: TWO_GAUSSIAN
                    .width
                    .map(|width| width * stream.uniform(0.95, 1.05)),
                omega_centre: TWO_GAUSSIAN.omega_centre * stream.uniform(0.95, 1.05),
                acceleration_semi_axis: TWO_GAUSSIAN.acceleration_semi_axis
                    * stream.uniform(0.95, 1.05),
            }),
            Self::Stribeck => ContactLaw::Stribeck {
                mu_c: 0.12 * stream.uniform(0.97, 1.03),
                mu_s: 0.2 * stream.uniform(0.97, 1.03),
                omega_s: 1.2 * stream.uniform(0.8, 1.25),
            },
            Self::Stiction => ContactLaw::CoulombStiction {
                mu_c: 0.13 * stream.uniform(0.97, 1.03),
                mu_s: 0.2 * stream.uniform(0.94, 1.06),
            },
            _ => return None,
        })
    }

    /// Puts the effect at `scale` times its practice size into `hidden`.
    fn put(self, scale: f64, brake: Brake, stream: &mut Stream, hidden: &mut Effects) {
        match self {
            Self::AccelerationHysteresis | Self::Stribeck | Self::Stiction => {}
            Self::Backlash => hidden.backlash = 0.25 * scale,
            Self::BearingFriction => {
                hidden.bearing_T = scale * if brake == Brake::On { 0.06 } else { 0.05 };
            }
            Self::FrictionWear => {
                let running_in = stream.chance(0.25);
                hidden.dmudt = scale * if running_in { -0.3 } else { 0.3 };
            }
            Self::GearRipple => hidden.cog_T = 0.06 * scale,
            Self::LoadCellBias => {
                let high = stream.chance(0.5);
                hidden.cell_bias = scale * if high { 4.0 } else { -4.0 };
            }
            Self::LoadExponent => hidden.load_exp = 1.0 - 0.3 * scale,
            Self::MotorViscous => hidden.motor_visc = 0.0006 * scale,
            Self::NormalForceWobble => {
                hidden.wobble_a = 0.25 * scale;
                hidden.wobble_ph = stream.uniform(0.0, TAU);
            }
            Self::Presliding => hidden.bristle_k = 60.0 / scale,
            Self::QuadraticDrag => hidden.quad = 0.0012 * scale,
            Self::ResistanceDrift => hidden.dRdt = 0.6 * scale,
            Self::SensorDelay => hidden.delay = 0.03 * scale,
            Self::ShaftHardening => hidden.k3 = 0.03 * scale,
            Self::SupplySag => hidden.uscale = 1.0 - 0.06 * scale,
            Self::Unbalance => {
                hidden.unbal_T = scale * if brake == Brake::On { 0.04 } else { 0.03 };
                hidden.unbal_ph = stream.uniform(0.0, TAU);
            }
            Self::ViscousDrag => hidden.visc = 0.008 * scale,
            Self::BreathingInertia => {
                hidden.breathing_J = scale * stream.uniform(0.25, 0.4);
                hidden.breathing_period = stream.uniform(3.0, 8.0);
                hidden.breathing_ph = stream.uniform(0.0, TAU);
            }
            Self::DynamicAbsorber => {
                hidden.absorber_J = scale * stream.uniform(0.1, 0.25) * NOMINAL.disc_inertia;
                hidden.absorber_f = stream.uniform(1.5, 3.0);
                hidden.absorber_zeta = stream.uniform(0.02, 0.05);
            }
            Self::FrictionBump => {
                hidden.bump_height = scale * stream.uniform(0.35, 0.6);
                hidden.bump_centre = stream.uniform(4.0, 6.5);
                hidden.bump_width = stream.uniform(0.6, 1.2);
            }
            Self::PeriodicTorque => {
                hidden.periodic_T = scale * stream.uniform(0.05, 0.09);
                hidden.periodic_f = stream.uniform(0.6, 2.2);
                hidden.periodic_ph = stream.uniform(0.0, TAU);
            }
            Self::ShaftSoftening => {
                hidden.softening = scale * stream.uniform(0.2, 0.35);
                hidden.softening_tau = stream.uniform(10.0, 25.0);
            }
            Self::TorqueSaturation => hidden.saturation_i = stream.uniform(1.45, 1.7) / scale,
            Self::BreakawayAfterDwell => {
                hidden.dwell_gain = scale * stream.uniform(0.08, 0.15);
                hidden.dwell_tau = stream.uniform(0.02, 0.1);
            }
            Self::FrictionMemory => hidden.memory_tau = scale * stream.uniform(0.03, 0.08),
            Self::DriveLag => hidden.drive_tau = scale * stream.uniform(0.03, 0.08),
            Self::EncoderEccentricity => {
                hidden.eccentricity = scale * stream.uniform(0.02, 0.05);
                hidden.eccentricity_ph = stream.uniform(0.0, TAU);
            }
            Self::TachometerGain => hidden.tacho_gain = 1.0 + scale * stream.uniform(0.02, 0.04),
            Self::ThreeLobes => {
                hidden.lobes_a = scale * stream.uniform(0.15, 0.3);
                hidden.lobes_ph = stream.uniform(0.0, TAU);
            }
            Self::LiftingPin => hidden.lifting = scale * stream.uniform(0.002, 0.005),
            Self::FadingMotor => {
                hidden.fading = scale * stream.uniform(0.1, 0.2);
                hidden.fading_tau = stream.uniform(10.0, 25.0);
            }
        }
    }
}

impl Kind {
    fn new(name: &str, effects: &[Effect], brake: Brake, base: &'static str) -> Self {
        Self {
            name: name.to_owned(),
            effects: effects.to_vec(),
            brake,
            base,
        }
    }

    /// A case with nothing hidden.
    pub fn clean(brake: Brake) -> Self {
        let name = match brake {
            Brake::On => "none",
            Brake::Off => "none_no_brake",
        };
        Self::new(name, &[], brake, "stribeck")
    }

    /// Every kind of the practice records that hides one effect.
    pub fn singles() -> Vec<Self> {
        let mut kinds: Vec<Self> = CATALOGUE
            .iter()
            .map(|&effect| {
                let (name, brake) = match effect {
                    Effect::BearingFriction => ("bearing_friction_braked", Brake::On),
                    Effect::QuadraticDrag => (effect.name(), Brake::Off),
                    _ => (effect.name(), Brake::On),
                };
                let base = effect.replaced_law().unwrap_or("stribeck");
                Self::new(name, &[effect], brake, base)
            })
            .collect();
        for (name, effect, brake, base) in [
            (
                "bearing_friction",
                Effect::BearingFriction,
                Brake::Off,
                "stribeck",
            ),
            (
                "unbalance_no_brake",
                Effect::Unbalance,
                Brake::Off,
                "stribeck",
            ),
            (
                "normal_force_wobble_gauss",
                Effect::NormalForceWobble,
                Brake::On,
                "two_gaussian_mu",
            ),
            (
                "acceleration_hysteresis_c",
                Effect::AccelerationHysteresis,
                Brake::On,
                "coulomb_stiction",
            ),
        ] {
            kinds.push(Self::new(name, &[effect], brake, base));
        }
        kinds
    }

    /// Kinds of a catalogue that the practice records do not have: presliding, and contacts that follow another law in part.
    pub fn further() -> Vec<Self> {
        let mut kinds: Vec<Self> = Self::singles()
            .into_iter()
            .filter(Self::replaces_law)
            .collect();
        kinds.push(Self::new(
            "presliding",
            &[Effect::Presliding],
            Brake::On,
            "stribeck",
        ));
        kinds
    }

    /// Whether the contact follows another law than the analyst's.
    pub fn replaces_law(&self) -> bool {
        self.effects
            .iter()
            .any(|effect| effect.replaced_law().is_some())
    }

    /// Kinds in no catalogue, `outside_<name>`.
    pub fn outsiders() -> Vec<Self> {
        [
            Effect::BreathingInertia,
            Effect::DynamicAbsorber,
            Effect::FrictionBump,
            Effect::PeriodicTorque,
            Effect::ShaftSoftening,
            Effect::TorqueSaturation,
            Effect::BreakawayAfterDwell,
            Effect::FrictionMemory,
            Effect::DriveLag,
            Effect::EncoderEccentricity,
            Effect::TachometerGain,
            Effect::ThreeLobes,
            Effect::LiftingPin,
            Effect::FadingMotor,
        ]
        .iter()
        .map(|&effect| {
            let name = format!("outside_{}", effect.name());
            Self::new(&name, &[effect], Brake::On, "stribeck")
        })
        .collect()
    }

    /// Every pair of catalogue effects, `a_and_b` in alphabetical order. Left out: two laws at
    /// once, and `motor_viscous` with `supply_sag`, which no record without current can part.
    pub fn pairs() -> Vec<Self> {
        let mut kinds = Vec::new();
        for (index, &first) in CATALOGUE.iter().enumerate() {
            for &second in &CATALOGUE[index + 1..] {
                let laws = first.replaced_law().xor(second.replaced_law());
                let two_laws = first.replaced_law().is_some() && second.replaced_law().is_some();
                let equivalent = (first, second) == (Effect::MotorViscous, Effect::SupplySag);
                if two_laws || equivalent {
                    continue;
                }
                let name = format!("{}_and_{}", first.name(), second.name());
                let base = laws.unwrap_or("stribeck");
                kinds.push(Self::new(&name, &[first, second], Brake::On, base));
            }
        }
        kinds
    }
}

impl Recipe {
    /// Draws the case.
    pub fn draw(&self) -> HiddenCase {
        let stream = &mut Stream::new(self.seed, Purpose::Recipe);
        let scale = round_to(stream.uniform(self.scale.0, self.scale.1), 1e-3);
        let spread = round_to(stream.uniform(self.spread.0, self.spread.1), 1e-3);
        let ratios = draw_ratios(stream, spread);
        let believed_law = practice_law(self.kind.base).unwrap_or(STRIBECK);

        let mut hidden = Effects::default();
        let mut law = believed_law.clone();
        for effect in &self.kind.effects {
            effect.put(scale, self.kind.brake, stream, &mut hidden);
            if let Some(full_law) = effect.full_law(stream) {
                law = if scale >= 1.0 {
                    full_law
                } else {
                    ContactLaw::Blend {
                        base: Box::new(law),
                        other: Box::new(full_law),
                        weight: scale,
                    }
                };
            }
        }
        if self.rough {
            hidden.stoch_std = ROUGH_STANDARD_DEVIATION;
            hidden.stoch_tau = ROUGH_CORRELATION_TIME;
        }
        let level = ratios.get(FRICTION_LEVEL).copied().unwrap_or(1.0);
        let answer = Answer {
            kind: self.kind.name.clone(),
            rough: hidden.stoch_std,
            seed: self.seed,
            scale,
            spread,
            base: believed_law.name().to_owned(),
            truth: law.name().to_owned(),
            effects: hidden.answers(),
            parameter_ratio: ratios.clone(),
        };
        HiddenCase {
            rig: TrueRig {
                parameters: NOMINAL.scaled(&ratios),
                law: law.with_level(level),
                effects: hidden,
            },
            believed_law,
            runs: draw_runs(
                &mut Stream::new(self.seed, Purpose::Excitation),
                self.kind.brake,
            ),
            answer,
        }
    }
}

fn round_to(value: f64, step: f64) -> f64 {
    let per_unit = (1.0 / step).round();
    (value * per_unit).round() / per_unit
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_cover_the_practice_records_and_more() {
        assert_eq!(Kind::singles().len(), 22);
        assert_eq!(Kind::further().len(), 5);
        assert_eq!(Kind::outsiders().len(), 14);
        // 18·17/2 pairs less three of two laws and one equivalent.
        assert_eq!(Kind::pairs().len(), 149);
    }

    #[test]
    fn a_pair_with_a_law_starts_from_the_simpler_law() {
        let pairs = Kind::pairs();
        let pair = pairs
            .iter()
            .find(|kind| kind.name == "stiction_and_viscous_drag")
            .unwrap();
        assert_eq!(pair.base, "coulomb");
    }

    #[test]
    fn small_law_differences_blend() {
        let kind = Kind::singles()
            .into_iter()
            .find(|kind| kind.name == "stiction")
            .unwrap();
        let case = Recipe {
            kind,
            seed: 1,
            scale: (0.1, 0.1),
            spread: (0.0, 0.0),
            rough: false,
            noise: 1.0,
        }
        .draw();
        let breakaway = case.rig.law.breakaway();
        assert!(breakaway > 0.1445 && breakaway < 0.148, "{breakaway}");
        assert_eq!(case.answer.truth, "coulomb_stiction");
    }
}
