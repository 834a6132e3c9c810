//! The rig with bristle contacts, stepped by leapfrog at 10 µs.
//!
//! Positions drift half a step, velocities and current are kicked a whole step with the forces
//! at mid-step, positions drift the other half. The current is trapezoidal in its own decay, the
//! bristles are implicit. Current and speed of the motor, which answer within 2 ms, see each other at
//! mid-step; half a step off, they would make the motor seem lighter by 0.2 %.

use crate::bristle::Bristle;
use crate::effects::Effects;
use crate::error::MakerError;
use crate::excitation::{Excitation, SAMPLE_INTERVAL};
use crate::law::ContactLaw;
use crate::random::Stream;
use crate::rig::RigParameters;
use core::f64::consts::TAU;
use libm::{cos, exp, sin};
use std::collections::VecDeque;

/// Time step [s].
pub const STEP: f64 = 1e-5;
const STEPS_PER_SAMPLE: usize = 1000;
/// Steps after which the random friction factor is drawn anew.
const STEPS_PER_DRAW: usize = 20;
/// Deflection of the pin's bristles at breakaway [rad]; an encoder step is 6.3e-3 rad.
const PIN_DEFLECTION: f64 = 4e-6;
/// Deflection of the disc bearing's bristles at breakaway [rad].
const BEARING_DEFLECTION: f64 = 4e-6;
/// Deflection of the motor's bristles at breakaway, gearbox output [rad]; an encoder step is
/// 7.9e-4 rad.
const MOTOR_DEFLECTION: f64 = 4e-6;
/// Lag of the acceleration that the two-Gaussian law sees [s]: it closes the algebraic loop.
const ACCELERATION_LAG: f64 = 5e-5;
/// Speed below which a disc counts as resting [rad/s].
const RESTING: f64 = 1e-2;
/// Normal force at which the load exponent changes nothing [N].
const REFERENCE_FORCE: f64 = 50.0;

/// The rig as it truly is.
#[derive(Debug, Clone)]
pub struct TrueRig {
    /// True parameters.
    pub parameters: RigParameters,
    /// True friction law of the pin.
    pub law: ContactLaw,
    /// Hidden effects.
    pub effects: Effects,
}

/// Mechanical and electrical state.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct State {
    /// Angle of disc D2 [rad].
    pub disc_angle: f64,
    /// Speed of disc D2 [rad/s].
    pub disc_speed: f64,
    /// Angle of the gearbox output [rad].
    pub gearbox_angle: f64,
    /// Speed of the gearbox output [rad/s].
    pub gearbox_speed: f64,
    /// Armature current [A].
    pub current: f64,
}

/// One sample as ideal instruments would see it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// State now.
    pub state: State,
    /// Disc angle the disc's channels report (lagging if there is a delay) [rad].
    pub seen_disc_angle: f64,
    /// Disc speed the disc's channels report [rad/s].
    pub seen_disc_speed: f64,
}

/// One run in progress.
pub struct Simulator<'rig> {
    rig: &'rig TrueRig,
    state: State,
    time: f64,
    pin: Bristle,
    bearing: Bristle,
    motor: Bristle,
    /// Change of the gearbox output's speed in the last step [rad/s].
    gearbox_gain: f64,
    lagged_acceleration: f64,
    absorber_angle: f64,
    absorber_speed: f64,
    drive_voltage: f64,
    friction_level: f64,
    rest: f64,
    random_factor: f64,
    steps_to_draw: usize,
    contact_noise: Stream,
    history: VecDeque<(f64, f64)>,
    delay_steps: usize,
}

impl<'rig> Simulator<'rig> {
    /// A run that starts at `state`, time zero, contacts unloaded.
    pub fn new(rig: &'rig TrueRig, state: State, mut contact_noise: Stream) -> Self {
        let delay_steps = (rig.effects.delay / STEP).round() as usize;
        let random_factor = rig.effects.stoch_std * contact_noise.normal();
        Self {
            rig,
            state,
            time: 0.0,
            pin: Bristle::new(PIN_DEFLECTION),
            bearing: Bristle::new(BEARING_DEFLECTION),
            motor: Bristle::new(MOTOR_DEFLECTION),
            gearbox_gain: 0.0,
            lagged_acceleration: 0.0,
            absorber_angle: state.disc_angle,
            absorber_speed: state.disc_speed,
            drive_voltage: 0.0,
            friction_level: 0.0,
            rest: 0.0,
            random_factor,
            steps_to_draw: STEPS_PER_DRAW,
            contact_noise,
            history: std::iter::repeat_n((state.disc_angle, state.disc_speed), delay_steps)
                .collect(),
            delay_steps,
        }
    }

    /// Runs through `excitation`; sample `k` is taken before entry `k` of the inputs acts.
    pub fn run(mut self, excitation: &Excitation) -> Result<Vec<Sample>, MakerError> {
        let mut samples = Vec::with_capacity(excitation.voltage.len());
        for (&voltage, &force) in excitation.voltage.iter().zip(&excitation.normal_force) {
            samples.push(self.sample());
            if !self.state.disc_speed.is_finite() {
                return Err(MakerError::Diverged {
                    case: String::new(),
                    time: (samples.len() - 1) as f64 * SAMPLE_INTERVAL,
                });
            }
            for _ in 0..STEPS_PER_SAMPLE {
                self.step(voltage, force);
            }
        }
        Ok(samples)
    }

    fn sample(&self) -> Sample {
        let (seen_disc_angle, seen_disc_speed) = self
            .history
            .front()
            .copied()
            .unwrap_or((self.state.disc_angle, self.state.disc_speed));
        Sample {
            state: self.state,
            seen_disc_angle,
            seen_disc_speed,
        }
    }

    fn step(&mut self, voltage: f64, force: f64) {
        let half = 0.5 * STEP;
        self.state.disc_angle += half * self.state.disc_speed;
        self.state.gearbox_angle += half * self.state.gearbox_speed;
        self.absorber_angle += half * self.absorber_speed;
        self.time += half;

        let shaft = self.shaft_torque();
        self.kick_motor(voltage, shaft);
        self.kick_disc(force, shaft);

        self.state.disc_angle += half * self.state.disc_speed;
        self.state.gearbox_angle += half * self.state.gearbox_speed;
        self.absorber_angle += half * self.absorber_speed;
        self.time += half;
        if self.delay_steps > 0 {
            self.history.pop_front();
            self.history
                .push_back((self.state.disc_angle, self.state.disc_speed));
        }
    }

    /// Torque the shaft takes from the disc [N m].
    fn shaft_torque(&self) -> f64 {
        let (rig, hidden) = (&self.rig.parameters, &self.rig.effects);
        let twist = self.state.disc_angle - self.state.gearbox_angle;
        let slack = 0.5 * hidden.backlash;
        let strained = twist - twist.clamp(-slack, slack);
        // Inside the dead band the halves of the coupling do not touch.
        let damping = if strained == 0.0 && slack > 0.0 {
            0.0
        } else {
            rig.shaft_damping
        };
        let warm = self.left_when_warm(hidden.softening, hidden.softening_tau);
        rig.shaft_stiffness * warm * strained
            + hidden.k3 * twist * twist * twist
            + damping * (self.state.disc_speed - self.state.gearbox_speed)
    }

    /// What warming that takes `share` in the end has left by now.
    fn left_when_warm(&self, share: f64, time_constant: f64) -> f64 {
        if share == 0.0 {
            1.0
        } else {
            1.0 - share * (1.0 - exp(-self.time / time_constant))
        }
    }

    fn kick_motor(&mut self, voltage: f64, shaft: f64) {
        let (rig, hidden) = (&self.rig.parameters, &self.rig.effects);
        let ratio = rig.gear_ratio;
        let speed = self.state.gearbox_speed;
        let middle_speed = speed + 0.5 * self.gearbox_gain;
        let resistance = rig.resistance * (1.0 + hidden.dRdt * self.time / 60.0);
        let decay = 0.5 * STEP * resistance / rig.inductance;
        self.drive_voltage = if hidden.drive_tau == 0.0 {
            voltage
        } else {
            self.drive_voltage + STEP / hidden.drive_tau * (voltage - self.drive_voltage)
        };
        let drive =
            hidden.uscale * self.drive_voltage - rig.back_emf_constant * ratio * middle_speed;
        let before = self.state.current;
        self.state.current =
            ((1.0 - decay) * before + STEP / rig.inductance * drive) / (1.0 + decay);

        let middle_current = 0.5 * (before + self.state.current);
        let felt_current = middle_current.clamp(-hidden.saturation_i, hidden.saturation_i);
        let warm = self.left_when_warm(hidden.fading, hidden.fading_tau);
        let mut motor_torque = rig.torque_constant * warm * felt_current
            - (rig.motor_viscous_damping + hidden.motor_visc) * ratio * middle_speed;
        if hidden.cog_T != 0.0 {
            motor_torque += hidden.cog_T * sin(2.0 * ratio * self.state.gearbox_angle);
        }
        let inertia = ratio * ratio * rig.motor_inertia;
        let coulomb = ratio * rig.motor_coulomb_torque;
        let friction = self.motor.advance(STEP, speed, coulomb, coulomb, inertia);
        self.gearbox_gain = STEP / inertia * (ratio * motor_torque + shaft - friction);
        self.state.gearbox_speed += self.gearbox_gain;
    }

    fn kick_disc(&mut self, force: f64, shaft: f64) {
        let (rig, hidden) = (&self.rig.parameters, &self.rig.effects);
        let speed = self.state.disc_speed;
        let mut torque = -shaft - hidden.visc * speed - hidden.quad * speed * speed.abs();
        if hidden.unbal_T != 0.0 {
            torque -= hidden.unbal_T * cos(self.state.disc_angle - hidden.unbal_ph);
        }
        if hidden.periodic_T != 0.0 {
            let phase = TAU * hidden.periodic_f * self.time - hidden.periodic_ph;
            torque += hidden.periodic_T * cos(phase);
        }
        let mut inertia = rig.disc_inertia;
        if hidden.breathing_J != 0.0 {
            let rate = TAU / hidden.breathing_period;
            let phase = rate * self.time - hidden.breathing_ph;
            inertia *= 1.0 + hidden.breathing_J * sin(phase);
            torque -= rig.disc_inertia * hidden.breathing_J * rate * cos(phase) * speed;
        }
        if hidden.absorber_J != 0.0 {
            torque += self.kick_absorber();
        }
        if hidden.bearing_T != 0.0 {
            let level = hidden.bearing_T;
            torque -= self.bearing.advance(STEP, speed, level, level, inertia);
        }
        if force > 0.0 {
            torque -= self.pin_torque(force, inertia);
        }
        let acceleration = torque / inertia;
        self.lagged_acceleration +=
            STEP / ACCELERATION_LAG * (acceleration - self.lagged_acceleration);
        self.state.disc_speed += STEP * acceleration;
    }

    /// Kicks the hanging inertia and returns the torque it puts on the disc [N m].
    fn kick_absorber(&mut self) -> f64 {
        let hidden = &self.rig.effects;
        let rate = TAU * hidden.absorber_f;
        let stiffness = hidden.absorber_J * rate * rate;
        let damping = 2.0 * hidden.absorber_zeta * hidden.absorber_J * rate;
        let torque = stiffness * (self.absorber_angle - self.state.disc_angle)
            + damping * (self.absorber_speed - self.state.disc_speed);
        self.absorber_speed -= STEP / hidden.absorber_J * torque;
        torque
    }

    fn pin_torque(&mut self, force: f64, inertia: f64) -> f64 {
        let (rig, hidden) = (&self.rig.parameters, &self.rig.effects);
        let mut normal_force = force;
        if hidden.wobble_a != 0.0 {
            normal_force *= 1.0 + hidden.wobble_a * cos(self.state.disc_angle - hidden.wobble_ph);
        }
        if hidden.lobes_a != 0.0 {
            let phase = 3.0 * self.state.disc_angle - hidden.lobes_ph;
            normal_force *= 1.0 + hidden.lobes_a * cos(phase);
        }
        if hidden.lifting != 0.0 {
            let speed = self.state.disc_speed;
            normal_force *= (1.0 - hidden.lifting * speed * speed).max(0.0);
        }
        if hidden.load_exp != 1.0 {
            normal_force =
                REFERENCE_FORCE * libm::pow(normal_force / REFERENCE_FORCE, hidden.load_exp);
        }
        let mut torque_per_mu =
            normal_force * rig.contact_radius * (1.0 + hidden.dmudt * self.time / 60.0);
        if hidden.stoch_std > 0.0 {
            torque_per_mu *= 1.0 + self.random_friction();
        }
        let speed = self.state.disc_speed;
        if hidden.bump_height != 0.0 {
            let distance = (speed.abs() - hidden.bump_centre) / hidden.bump_width;
            torque_per_mu *= 1.0 + hidden.bump_height * exp(-distance * distance);
        }
        let law = &self.rig.law;
        let along = if speed < 0.0 { -1.0 } else { 1.0 };
        let level = law.coefficient(speed.abs(), along * self.lagged_acceleration);
        let mut breakaway = torque_per_mu * law.breakaway();
        let mut level = torque_per_mu * level;
        if hidden.dwell_gain != 0.0 {
            self.rest = if speed.abs() < RESTING {
                self.rest + STEP
            } else {
                0.0
            };
            let grown = 1.0 + hidden.dwell_gain * libm::log(1.0 + self.rest / hidden.dwell_tau);
            breakaway *= grown;
            if self.rest > 0.0 {
                level *= grown;
            }
        }
        if hidden.memory_tau != 0.0 {
            self.friction_level += STEP / hidden.memory_tau * (level - self.friction_level);
            level = self.friction_level;
        }
        if hidden.bristle_k.is_finite() && breakaway > 0.0 {
            self.pin.soften(breakaway / hidden.bristle_k);
        }
        self.pin.advance(STEP, speed, breakaway, level, inertia)
    }

    /// Ornstein–Uhlenbeck factor, exact between its draws.
    fn random_friction(&mut self) -> f64 {
        self.steps_to_draw -= 1;
        if self.steps_to_draw == 0 {
            self.steps_to_draw = STEPS_PER_DRAW;
            let hidden = &self.rig.effects;
            let kept = exp(-(STEPS_PER_DRAW as f64) * STEP / hidden.stoch_tau);
            let fresh = hidden.stoch_std * libm::sqrt(1.0 - kept * kept);
            self.random_factor = kept * self.random_factor + fresh * self.contact_noise.normal();
        }
        self.random_factor
    }
}
