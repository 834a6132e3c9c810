//! A rig and its instruments, drawn.

use crate::instruments::Instruments;
use crate::numerics::{Bristles, Numerics};
use crate::other_rigs::contact::Levels;
use crate::random::Stream;
use crate::rig::{NOMINAL, RigParameters};
use core::f64::consts::TAU;

/// Share of the time in which a motor's current answers that one step takes [-].
const STEPS_PER_MOTOR_TIME: f64 = 120.0;
/// Fewest and most steps per natural period [-].
const STEPS_PER_PERIOD: (f64, f64) = (60_000.0, 400_000.0);
/// Share of a bristle's steady deflection up to which it only bends [-].
const ELASTIC_SHARE: f64 = 0.99998;
/// Angle of a bristle's swing per step [rad].
const BRISTLE_PHASE: f64 = 0.1;

/// What is drawn of a rig, before it has a size. Shares are of what the comment names.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Draws {
    /// Inertia of the disc [kg m²], 1e-4 to 1e3.
    pub inertia: f64,
    /// Natural frequency of the disc on its shaft [Hz], 0.1 to 10.
    pub frequency: f64,
    /// Damping ratio of the same [-], 0.002 to 0.05.
    pub damping_ratio: f64,
    /// Gear ratio [-], 1 to 20.
    pub gear_ratio: f64,
    /// Motor's inertia seen by the shaft, share of the disc's, 0.05 to 0.5.
    pub motor_inertia: f64,
    /// Drop of the motor's speed under the largest load, share of the top speed, 0.02 to 0.2.
    pub droop: f64,
    /// L/R, share of the natural period, 0.002 to 0.05.
    pub electrical_time: f64,
    /// K_T over K_E [-], 0.96 to 1.04.
    pub constants_ratio: f64,
    /// Voltage over what the power alone suggests [-], 0.5 to 2.
    pub voltage: f64,
    /// Coulomb torque of the motor seen by the shaft, share of the friction torque, 0.02 to 0.2.
    pub motor_coulomb: f64,
    /// Viscous torque of the motor at top speed seen by the shaft, the same share, 0.005 to 0.05.
    pub motor_viscous: f64,
    /// Top speed over natural angular frequency [rad], 0.5 to 4.
    pub top_speed: f64,
    /// Drop of friction over √(k J) times top speed [-], 0.15 to 0.8.
    pub drop: f64,
    /// Pin radius over what a steel disc of this inertia suggests [-], 0.4 to 2.
    pub radius: f64,
}

/// A rig with the scales of what it will do.
#[derive(Debug, Clone, PartialEq)]
pub struct OtherRig {
    /// What the analyst believes, four digits each.
    pub believed: RigParameters,
    /// Natural period [s].
    pub period: f64,
    /// Top speed of the drive, gearbox output [rad/s].
    pub top_speed: f64,
    /// Friction torque of the pin in sliding at the middle load, T [N m].
    pub torque: f64,
    /// Breakaway torque over T [-].
    pub breakaway: f64,
    /// Middle normal force [N].
    pub middle_load: f64,
    /// Friction coefficient in sliding, times the radius [m].
    pub torque_per_load: f64,
    /// Exponent of the true normal force [-] and the force at which it changes nothing [N].
    pub load_power: (f64, f64),
    /// Friction torque of disc D1 over T [-]; 0 without one.
    pub torque1: f64,
    /// Largest current under load [A].
    pub current: f64,
}

/// Top speed of the dissertation's rig, 60 rpm [rad/s].
const DISSERTATION_TOP_SPEED: f64 = TAU;
/// Largest load over the middle one [-].
pub const LARGEST_LOAD: f64 = 1.7;

impl Draws {
    /// Draws a rig.
    pub fn draw(stream: &mut Stream) -> Self {
        Self {
            inertia: stream.log_uniform(1e-4, 1e3),
            frequency: stream.log_uniform(0.1, 10.0),
            damping_ratio: stream.log_uniform(0.002, 0.05),
            gear_ratio: stream.log_uniform(1.0, 20.0),
            motor_inertia: stream.log_uniform(0.05, 0.5),
            droop: stream.log_uniform(0.02, 0.2),
            electrical_time: stream.log_uniform(0.002, 0.05),
            constants_ratio: stream.uniform(0.96, 1.04),
            voltage: stream.log_uniform(0.5, 2.0),
            motor_coulomb: stream.log_uniform(0.02, 0.2),
            motor_viscous: stream.log_uniform(0.005, 0.05),
            top_speed: stream.log_uniform(0.5, 4.0),
            drop: stream.log_uniform(0.15, 0.8),
            radius: stream.log_uniform(0.4, 2.0),
        }
    }

    /// The rig of these draws under a contact of `levels`, its loads times `load_factor`. Friction
    /// follows the normal force to the power `load_power.0`, and is as believed at `load_power.1` [N]
    /// (`None`: at the middle load). `hanging` is the inertia that hangs on the disc over the disc's
    /// [-], `torque1` its friction over the disc's [-].
    pub fn build(
        &self,
        levels: Levels,
        load_factor: f64,
        load_power: (f64, Option<f64>),
        hanging: f64,
        torque1: f64,
    ) -> OtherRig {
        let inertia = four_digits(self.inertia);
        let total = inertia * (1.0 + hanging);
        let rate = TAU * self.frequency;
        let stiffness = four_digits(total * rate * rate);
        let rate = libm::sqrt(stiffness / total);
        let period = TAU / rate;
        let top_speed = self.top_speed * rate;
        let gear_ratio = four_digits(self.gear_ratio.clamp(1.0, 20.0));

        let fall = load_factor * self.drop * total * rate * top_speed;
        let torque = fall / (levels.breakaway / levels.sliding - 1.0);
        // A steel disc a tenth as thick as it is wide has J = 2450 kg/m² R⁵ (half of 7800 π/5).
        let rim = libm::pow(inertia / 2450.0, 0.2);
        let radius = four_digits(self.radius * rim);
        let torque_per_load = levels.sliding * radius;
        let (middle_load, load_power) = loads(torque / torque_per_load, load_power);

        let coulomb = self.motor_coulomb * torque;
        let viscous = self.motor_viscous * torque / top_speed;
        let largest = LARGEST_LOAD * torque * (1.0 + torque1) + coulomb + viscous * top_speed;
        let power = largest * top_speed;
        let volts = (12.0 * libm::pow(power, 0.2)).clamp(1.5, 600.0) * self.voltage;
        let back_emf = four_digits(volts / (gear_ratio * top_speed * (1.0 + self.droop)));
        let torque_constant = four_digits(back_emf * self.constants_ratio);
        let constants = gear_ratio * gear_ratio * back_emf * torque_constant;
        let resistance = four_digits(self.droop * top_speed * constants / largest);
        let motor_inertia = four_digits(self.motor_inertia * inertia / (gear_ratio * gear_ratio));
        // A current that answers much later than the motor's speed would ring for many swings.
        let mechanical_time = self.motor_inertia * inertia * resistance / constants;
        let electrical_time = (self.electrical_time * period)
            .min((16.0 * mechanical_time).max(0.0025 * period))
            .max(0.002 * period);
        OtherRig {
            believed: RigParameters {
                disc_inertia: inertia,
                shaft_stiffness: stiffness,
                shaft_damping: four_digits(2.0 * self.damping_ratio * total * rate),
                gear_ratio,
                motor_inertia,
                resistance,
                inductance: four_digits(electrical_time * resistance),
                torque_constant,
                back_emf_constant: back_emf,
                motor_coulomb_torque: four_digits(coulomb / gear_ratio),
                motor_viscous_damping: four_digits(viscous / (gear_ratio * gear_ratio)),
                contact_radius: radius,
            },
            period,
            top_speed,
            torque,
            breakaway: levels.breakaway / levels.sliding,
            middle_load,
            torque_per_load,
            load_power,
            torque1,
            current: largest / (gear_ratio * torque_constant),
        }
    }
}

/// Middle load at which the true friction is that of `plain` [N] under plain proportionality, and the
/// power with its reference.
fn loads(plain: f64, load_power: (f64, Option<f64>)) -> (f64, (f64, f64)) {
    let (exponent, reference) = load_power;
    let reference = reference.unwrap_or(plain);
    let load = reference * libm::pow(plain / reference, 1.0 / exponent);
    (load, (exponent, reference))
}

impl OtherRig {
    /// Top speed and natural angular frequency of the dissertation's rig, both rad/s.
    pub fn dissertation_speeds() -> (f64, f64) {
        let natural = libm::sqrt(NOMINAL.shaft_stiffness / NOMINAL.disc_inertia);
        (natural, DISSERTATION_TOP_SPEED)
    }

    /// The dissertation's rig under a contact of `levels` and loads that follow from `drop` times
    /// `load_factor`, as in [`Draws::build`].
    pub fn dissertation(
        drop: f64,
        levels: Levels,
        load_factor: f64,
        load_power: (f64, Option<f64>),
    ) -> Self {
        let (natural, top_speed) = Self::dissertation_speeds();
        let fall = load_factor * drop * NOMINAL.disc_inertia * natural * top_speed;
        let torque = fall / (levels.breakaway / levels.sliding - 1.0);
        let torque_per_load = levels.sliding * NOMINAL.contact_radius;
        let (middle_load, load_power) = loads(torque / torque_per_load, load_power);
        let largest = LARGEST_LOAD * torque / NOMINAL.gear_ratio + NOMINAL.motor_coulomb_torque;
        Self {
            believed: NOMINAL,
            period: TAU / natural,
            top_speed,
            torque,
            breakaway: levels.breakaway / levels.sliding,
            middle_load,
            torque_per_load,
            load_power,
            torque1: 0.0,
            current: largest / NOMINAL.torque_constant,
        }
    }

    /// Friction torque in sliding under the normal force `load` [N], in N m.
    pub fn sliding_torque(&self, load: f64) -> f64 {
        let (exponent, reference) = self.load_power;
        self.torque_per_load * reference * libm::pow(load / reference, exponent)
    }

    /// Voltage that turns the gearbox output steadily at `speed` [rad/s] under `load` [N], in V.
    pub fn voltage(&self, speed: f64, load: f64) -> f64 {
        let rig = &self.believed;
        let motor_speed = rig.gear_ratio * speed.abs();
        let torque = rig.motor_coulomb_torque
            + rig.motor_viscous_damping * motor_speed
            + self.sliding_torque(load) * (1.0 + self.torque1) / rig.gear_ratio;
        let volts =
            rig.back_emf_constant * motor_speed + rig.resistance * torque / rig.torque_constant;
        volts.copysign(speed)
    }

    /// Draws the rig's instruments.
    pub fn draw_instruments(&self, stream: &mut Stream) -> Instruments {
        let disc_ticks = stream.log_uniform(250.0, 10_000.0).round();
        let motor_ticks = stream.log_uniform(250.0, 4_000.0).round();
        let mut tachometer = || four_digits(stream.log_uniform(0.001, 0.02) * self.top_speed);
        let (disc_speed, gearbox_speed) = (tachometer(), tachometer());
        Instruments {
            disc_encoder_step: TAU / disc_ticks,
            gear_encoder_step: TAU / (motor_ticks * self.believed.gear_ratio),
            disc_speed,
            gearbox_speed,
            normal_force: four_digits(stream.log_uniform(0.001, 0.01) * self.middle_load),
            current: four_digits(stream.log_uniform(0.002, 0.02) * self.current),
            quantised: true,
        }
    }

    /// Step and scales for this rig, sampled every `interval` [s] by `instruments`: the step
    /// resolves the motor and every bristle, the bristles lie below what the instruments show.
    /// `coarser` times that step, with bristles as soft as it needs, for trials; below 1 the bristles
    /// stay and the step alone is finer.
    pub fn numerics(&self, interval: f64, instruments: &Instruments, coarser: f64) -> Numerics {
        let rig = &self.believed;
        let reflected = rig.gear_ratio * rig.gear_ratio * rig.motor_inertia;
        let electrical = rig.inductance / rig.resistance;
        let mechanical =
            rig.motor_inertia * rig.resistance / (rig.torque_constant * rig.back_emf_constant);
        let motor_time = electrical.min(libm::sqrt(electrical * mechanical));
        let disc_torque = self.breakaway * LARGEST_LOAD * self.torque;
        let motor_torque = rig.gear_ratio * rig.motor_coulomb_torque;
        let slow = 0.003 * self.top_speed;
        let disc = bristles(
            disc_torque / rig.disc_inertia,
            instruments.disc_speed.min(slow),
            instruments.disc_encoder_step / 200.0,
        );
        let motor = bristles(
            motor_torque / reflected,
            instruments.gearbox_speed.min(slow),
            instruments.gear_encoder_step / 100.0,
        );
        let finest = self.period / STEPS_PER_PERIOD.1;
        let step = (motor_time / STEPS_PER_MOTOR_TIME)
            .min(BRISTLE_PHASE * disc.swing)
            .min(BRISTLE_PHASE * motor.swing)
            .clamp(finest, self.period / STEPS_PER_PERIOD.0);
        let (disc, motor) = (disc.at_least(step), motor.at_least(step));
        let steps_per_sample = (interval / (coarser * step)).ceil();
        let step = interval / steps_per_sample;
        let (disc, motor) = (disc.at_least(step), motor.at_least(step));
        let scales = |bristle: Swinging| Bristles {
            deflection: bristle.deflection,
            elastic_share: ELASTIC_SHARE,
            damped_speed: 2.0 * bristle.deflection / bristle.swing,
            soft_damped_speed: self.top_speed,
        };
        Numerics {
            step,
            steps_per_sample: steps_per_sample as usize,
            steps_per_draw: ((self.period / 1000.0 / step) as usize).max(1),
            disc: scales(disc),
            motor: scales(motor),
            acceleration_lag: 8.0 * step,
            resting: disc.deflection / disc.swing,
        }
    }
}

/// A bristle and the inverse of the angular frequency at which it swings when stuck.
#[derive(Clone, Copy)]
struct Swinging {
    deflection: f64,
    swing: f64,
}

impl Swinging {
    /// Softer where `step` [s] could not follow it.
    fn at_least(self, step: f64) -> Self {
        let factor = (step / (BRISTLE_PHASE * self.swing)).max(1.0);
        Self {
            deflection: self.deflection * factor * factor,
            swing: self.swing * factor,
        }
    }
}

/// The softest bristle that neither deflects by more than `angle` [rad] nor swings faster than
/// `speed` [rad/s] where it bears `acceleration` [rad/s²] times its inertia.
fn bristles(acceleration: f64, speed: f64, angle: f64) -> Swinging {
    let deflection = angle.min(speed * speed / acceleration);
    Swinging {
        deflection,
        swing: libm::sqrt(deflection / acceleration),
    }
}

/// `value` to four significant digits.
pub fn four_digits(value: f64) -> f64 {
    if value == 0.0 || !value.is_finite() {
        return value;
    }
    format!("{value:.3e}").parse().unwrap_or(value)
}
