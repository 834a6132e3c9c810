//! One hidden effect: its name, its size, and the law that it puts in the place of the analyst's.

use crate::effects::Effects;
use crate::excitation::Brake;
use crate::law::{ContactLaw, TwoGaussian};
use crate::random::Stream;
use crate::rig::NOMINAL;
use core::f64::consts::TAU;
use strum::{EnumIter, IntoEnumIterator, IntoStaticStr};

/// One hidden effect, named as in the answers but for the `outside_` of effects in no catalogue. The first block is in the
/// catalogue, the others in none, the last on other rigs only.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, EnumIter, IntoStaticStr)]
#[strum(serialize_all = "snake_case")]
#[expect(missing_docs, reason = "the records' README says what each is")]
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

    FrictionPatch,
    HigherHarmonics,
    FrictionJump,
    SwayingFriction,
    AsymmetricFriction,
    LoadSaturation,
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

/// The Stribeck law of the practice records.
pub(crate) const STRIBECK: ContactLaw = ContactLaw::Stribeck {
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
        self.into()
    }

    /// Effects of the practice records; any two can stand in a pair.
    pub fn catalogue() -> impl Iterator<Item = Self> {
        Self::iter().filter(|effect| *effect <= Self::ViscousDrag && *effect != Self::Presliding)
    }

    /// Effects in no catalogue.
    pub fn outsiders() -> impl Iterator<Item = Self> {
        Self::iter().filter(|effect| *effect > Self::ViscousDrag)
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
    pub(crate) fn full_law(self, stream: &mut Stream) -> Option<ContactLaw> {
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
    pub(crate) fn put(self, scale: f64, brake: Brake, stream: &mut Stream, hidden: &mut Effects) {
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
            // On other rigs only, where sizes follow the rig.
            Self::FrictionPatch
            | Self::HigherHarmonics
            | Self::FrictionJump
            | Self::SwayingFriction
            | Self::AsymmetricFriction
            | Self::LoadSaturation => {}
        }
    }
}
