//! How large the hidden effects are: drawn as shares of what the rig itself shows.

use crate::effects::Effects;
use crate::hidden_effect::Effect;
use crate::other_rigs::drawing::{LARGEST_LOAD, OtherRig};
use crate::random::Stream;
use core::f64::consts::TAU;

/// What the sizes are shares of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scales {
    /// Friction torque T of the disc's pin at the middle load [N m].
    pub torque: f64,
    /// Largest torque in the disc's shaft: breakaway at the largest load [N m].
    pub largest_torque: f64,
    /// Stiffness of the disc's shaft [N m/rad].
    pub stiffness: f64,
    /// Inertia of the disc [kg m²].
    pub inertia: f64,
    /// Middle normal force on the disc [N].
    pub load: f64,
    /// Top speed [rad/s].
    pub speed: f64,
    /// Natural period [s].
    pub period: f64,
    /// Gear ratio [-].
    pub gear_ratio: f64,
    /// Largest current under load [A].
    pub current: f64,
    /// Duration of the longest run to learn from [s].
    pub duration: f64,
    /// Noise of the gearbox tachometer [rad/s].
    pub gearbox_noise: f64,
    /// Gearbox speed that a torque of 1 N m at twice the motor's middle frequency makes, there [rad/s/(N m)].
    pub ripple_response: f64,
}

impl Scales {
    /// Scales of the disc that the drive turns.
    pub fn of(rig: &OtherRig, duration: f64, gearbox_noise: f64) -> Self {
        let parameters = &rig.believed;
        let ratio = parameters.gear_ratio;
        let reflected = ratio * ratio * parameters.motor_inertia;
        let rate = 2.0 * ratio * 0.6 * rig.top_speed;
        let brake = ratio * ratio * parameters.torque_constant * parameters.back_emf_constant
            / parameters.resistance;
        Self {
            torque: rig.torque,
            largest_torque: rig.breakaway * LARGEST_LOAD * rig.torque,
            stiffness: parameters.shaft_stiffness,
            inertia: parameters.disc_inertia,
            load: rig.middle_load,
            speed: rig.top_speed,
            period: rig.period,
            gear_ratio: ratio,
            current: rig.current,
            duration,
            gearbox_noise,
            ripple_response: 1.0 / libm::hypot(reflected * rate, brake),
        }
    }
}

impl Effect {
    /// Puts the effect at `size` times a size drawn from the range of its kind into `hidden`.
    pub(crate) fn put_to_scale(
        self,
        size: f64,
        scales: &Scales,
        stream: &mut Stream,
        hidden: &mut Effects,
    ) {
        let share = |stream: &mut Stream, low: f64, high: f64| size * stream.log_uniform(low, high);
        let phase = |stream: &mut Stream| stream.uniform(0.0, TAU);
        let torque = scales.torque;
        let Scales { speed, period, .. } = *scales;
        match self {
            Self::AccelerationHysteresis | Self::Stribeck | Self::Stiction => {}
            Self::Backlash => {
                hidden.backlash = share(stream, 0.1, 0.5) * torque / scales.stiffness;
            }
            Self::BearingFriction => hidden.bearing_T = share(stream, 0.05, 0.4) * torque,
            Self::FrictionWear => {
                let change = share(stream, 0.1, 0.5) * stream.sign();
                hidden.dmudt = change * 60.0 / scales.duration;
            }
            Self::GearRipple => {
                let drawn = stream.log_uniform(0.1, 0.5) * torque;
                // A ripple that no instrument could show is no full-size effect.
                let seen = 0.5 * scales.gearbox_noise / scales.ripple_response;
                hidden.cog_T = size * drawn.max(seen.min(2.0 * torque)) / scales.gear_ratio;
            }
            Self::LoadCellBias => {
                hidden.cell_bias = share(stream, 0.05, 0.25) * stream.sign() * scales.load;
            }
            Self::LoadExponent => hidden.load_exp = load_exponent(size, stream),
            Self::MotorViscous => {
                let reflected = share(stream, 0.05, 0.3) * torque / speed;
                hidden.motor_visc = reflected / (scales.gear_ratio * scales.gear_ratio);
            }
            Self::NormalForceWobble => {
                hidden.wobble_a = share(stream, 0.1, 0.4);
                hidden.wobble_ph = phase(stream);
            }
            Self::Presliding => {
                let bend = share(stream, 0.05, 0.3) * torque / scales.stiffness;
                hidden.bristle_k = torque / bend;
            }
            Self::QuadraticDrag => hidden.quad = share(stream, 0.1, 0.4) * torque / (speed * speed),
            Self::ResistanceDrift => {
                let change = share(stream, 0.1, 0.5);
                let sign = if stream.chance(0.25) { -1.0 } else { 1.0 };
                hidden.dRdt = sign * change * 60.0 / scales.duration;
            }
            Self::SensorDelay => hidden.delay = share(stream, 0.01, 0.04) * period,
            Self::ShaftHardening => {
                let twist = scales.largest_torque / scales.stiffness;
                hidden.k3 = share(stream, 0.1, 0.4) * scales.stiffness / (twist * twist);
            }
            Self::SupplySag => hidden.uscale = 1.0 - share(stream, 0.05, 0.15),
            Self::Unbalance => {
                hidden.unbal_T = share(stream, 0.1, 0.6) * torque;
                hidden.unbal_ph = phase(stream);
            }
            Self::ViscousDrag => hidden.visc = share(stream, 0.1, 0.4) * torque / speed,
            _ => self.put_outsider(size, scales, stream, hidden),
        }
    }

    /// The same for effects in no catalogue.
    fn put_outsider(self, size: f64, scales: &Scales, stream: &mut Stream, hidden: &mut Effects) {
        let share = |stream: &mut Stream, low: f64, high: f64| size * stream.log_uniform(low, high);
        let phase = |stream: &mut Stream| stream.uniform(0.0, TAU);
        let torque = scales.torque;
        let Scales { speed, period, .. } = *scales;
        match self {
            Self::BreathingInertia => {
                hidden.breathing_J = share(stream, 0.2, 0.4);
                hidden.breathing_period = stream.uniform(2.0, 8.0) * period;
                hidden.breathing_ph = phase(stream);
            }
            Self::DynamicAbsorber => {
                hidden.absorber_J = share(stream, 0.1, 0.4) * scales.inertia;
                hidden.absorber_f = stream.uniform(1.3, 4.0) / period;
                hidden.absorber_zeta = stream.uniform(0.01, 0.06);
            }
            Self::FrictionBump => {
                hidden.bump_height = share(stream, 0.3, 0.7);
                hidden.bump_centre = stream.uniform(0.4, 0.9) * speed;
                hidden.bump_width = stream.uniform(0.07, 0.2) * speed;
            }
            Self::PeriodicTorque => {
                hidden.periodic_T = share(stream, 0.15, 0.5) * torque;
                hidden.periodic_f = stream.log_uniform(0.5, 2.5) / period;
                hidden.periodic_ph = phase(stream);
            }
            Self::ShaftSoftening => {
                hidden.softening = share(stream, 0.2, 0.4);
                hidden.softening_tau = stream.uniform(0.2, 0.6) * scales.duration;
            }
            Self::TorqueSaturation => {
                hidden.saturation_i = stream.uniform(0.55, 0.75) * scales.current / size;
            }
            Self::BreakawayAfterDwell => {
                hidden.dwell_gain = share(stream, 0.08, 0.25);
                hidden.dwell_tau = stream.log_uniform(0.01, 0.1) * period;
            }
            Self::FrictionMemory => hidden.memory_tau = share(stream, 0.02, 0.08) * period,
            Self::DriveLag => hidden.drive_tau = share(stream, 0.05, 0.3) * period,
            Self::EncoderEccentricity => {
                hidden.eccentricity = share(stream, 0.03, 0.1);
                hidden.eccentricity_ph = phase(stream);
            }
            Self::TachometerGain => {
                hidden.tacho_gain = 1.0 + share(stream, 0.03, 0.1) * stream.sign();
            }
            Self::ThreeLobes => {
                hidden.lobes_a = share(stream, 0.15, 0.4);
                hidden.lobes_ph = phase(stream);
            }
            Self::LiftingPin => hidden.lifting = share(stream, 0.1, 0.4) / (speed * speed),
            Self::FadingMotor => {
                hidden.fading = share(stream, 0.1, 0.3);
                hidden.fading_tau = stream.uniform(0.2, 0.6) * scales.duration;
            }
            Self::FrictionPatch => {
                hidden.patch_height = share(stream, 0.4, 1.0);
                hidden.patch_centre = phase(stream);
                hidden.patch_width = stream.uniform(0.3, 0.9);
            }
            Self::HigherHarmonics => {
                hidden.harmonic_T = share(stream, 0.2, 0.6) * torque;
                hidden.harmonic_n = 3.0 + stream.index(4) as f64;
                hidden.harmonic_ph = phase(stream);
            }
            Self::FrictionJump => {
                hidden.jump = share(stream, 0.15, 0.5) * stream.sign();
                hidden.jump_time = stream.uniform(0.3, 0.7) * scales.duration;
            }
            Self::SwayingFriction => {
                hidden.sway = share(stream, 0.15, 0.4);
                hidden.sway_period = stream.uniform(0.3, 0.9) * scales.duration;
                hidden.sway_ph = phase(stream);
            }
            Self::AsymmetricFriction => {
                hidden.asymmetry = share(stream, 0.2, 0.5) * stream.sign();
            }
            Self::LoadSaturation => {
                hidden.load_limit = stream.uniform(0.8, 1.5) / size * scales.load;
            }
            _ => {}
        }
    }
}

/// 0.6 to 0.85 or 1.15 to 1.4 at size 1.
fn load_exponent(size: f64, stream: &mut Stream) -> f64 {
    if stream.chance(0.5) {
        1.0 - size * stream.uniform(0.15, 0.4)
    } else {
        1.0 + size * stream.uniform(0.15, 0.4)
    }
}
