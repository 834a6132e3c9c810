//! The rig with bristle contacts, stepped by leapfrog (10 µs on the dissertation's rig).
//!
//! Positions drift half a step, velocities and current are kicked a whole step with the forces
//! at mid-step, positions drift the other half. The current is trapezoidal in its own decay, the
//! bristles are implicit. Current and speed of the motor, which answer within 2 ms, see each other at
//! mid-step; half a step off, they would make the motor seem lighter by 0.2 %.

use crate::bristle::Bristle;
use crate::disc::{DiscMotion, Surroundings};
use crate::effects::Effects;
use crate::error::MakerError;
use crate::excitation::Excitation;
use crate::law::ContactLaw;
use crate::numerics::{DISSERTATION, Numerics};
use crate::random::Stream;
use crate::rig::RigParameters;
use libm::{exp, sin};
use std::collections::VecDeque;

/// The rig as it truly is.
#[derive(Debug, Clone)]
pub struct TrueRig {
    /// True parameters.
    pub parameters: RigParameters,
    /// True friction law of the pin.
    pub law: ContactLaw,
    /// Hidden effects; those of a disc act on disc D2.
    pub effects: Effects,
    /// Disc D1, which hangs on D2; `None`: the reduced rig.
    pub disc1: Option<Disc1>,
}

/// Disc D1 of the full rig with its shaft and its pin.
#[derive(Debug, Clone, PartialEq)]
pub struct Disc1 {
    /// Inertia J1 [kg m²].
    pub inertia: f64,
    /// Torsional stiffness k1 between the discs [N m/rad].
    pub shaft_stiffness: f64,
    /// Torsional damping c1 [N m s/rad].
    pub shaft_damping: f64,
    /// Distance from pin to rotation centre [m].
    pub contact_radius: f64,
    /// True friction law of its pin.
    pub law: ContactLaw,
    /// What is hidden on D1 and its shaft.
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
    /// Angle of disc D1 [rad].
    pub disc1_angle: f64,
    /// Speed of disc D1 [rad/s].
    pub disc1_speed: f64,
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
    /// Acceleration that the friction law of disc D2 sees [rad/s²].
    pub acceleration: f64,
}

/// One run in progress.
pub struct Simulator<'rig> {
    rig: &'rig TrueRig,
    numerics: &'rig Numerics,
    disc: DiscMotion<'rig>,
    disc1: Option<DiscMotion<'rig>>,
    gearbox_angle: f64,
    gearbox_speed: f64,
    current: f64,
    time: f64,
    motor: Bristle,
    /// Change of the gearbox output's speed in the last step [rad/s].
    gearbox_gain: f64,
    drive_voltage: f64,
    history: VecDeque<(f64, f64)>,
    delay_steps: usize,
}

impl<'rig> Simulator<'rig> {
    /// A run of the dissertation's rig that starts at `state`, time zero, contacts unloaded.
    pub fn new(rig: &'rig TrueRig, state: State, contact_noise: Stream) -> Self {
        Self::with_numerics(rig, &DISSERTATION, state, contact_noise)
    }

    /// The same with steps and scales of another rig.
    pub fn with_numerics(
        rig: &'rig TrueRig,
        numerics: &'rig Numerics,
        state: State,
        contact_noise: Stream,
    ) -> Self {
        let delay_steps = (rig.effects.delay / numerics.step).round() as usize;
        let disc1_noise = contact_noise.clone();
        let around = Surroundings {
            inertia: rig.parameters.disc_inertia,
            radius: rig.parameters.contact_radius,
            law: &rig.law,
            effects: &rig.effects,
            numerics,
        };
        let disc1 = rig.disc1.as_ref().map(|disc1| {
            let around = Surroundings {
                inertia: disc1.inertia,
                radius: disc1.contact_radius,
                law: &disc1.law,
                effects: &disc1.effects,
                numerics,
            };
            DiscMotion::new(around, state.disc1_angle, state.disc1_speed, disc1_noise)
        });
        Self {
            rig,
            numerics,
            disc: DiscMotion::new(around, state.disc_angle, state.disc_speed, contact_noise),
            disc1,
            gearbox_angle: state.gearbox_angle,
            gearbox_speed: state.gearbox_speed,
            current: state.current,
            time: 0.0,
            motor: Bristle::new(numerics.motor),
            gearbox_gain: 0.0,
            drive_voltage: 0.0,
            history: std::iter::repeat_n((state.disc_angle, state.disc_speed), delay_steps)
                .collect(),
            delay_steps,
        }
    }

    /// Runs through `excitation`; sample `k` is taken before entry `k` of the inputs acts.
    pub fn run(mut self, excitation: &Excitation) -> Result<Vec<Sample>, MakerError> {
        let mut samples = Vec::with_capacity(excitation.voltage.len());
        for (index, &voltage) in excitation.voltage.iter().enumerate() {
            let force = excitation.normal_force.get(index).copied().unwrap_or(0.0);
            let disc1_force = excitation.disc1_force.get(index).copied().unwrap_or(0.0);
            samples.push(self.sample());
            if !self.disc.speed.is_finite() {
                return Err(MakerError::Diverged {
                    case: String::new(),
                    time: self.time,
                });
            }
            for _ in 0..self.numerics.steps_per_sample {
                self.step(voltage, force, disc1_force);
            }
        }
        Ok(samples)
    }

    fn sample(&self) -> Sample {
        let (seen_disc_angle, seen_disc_speed) = self
            .history
            .front()
            .copied()
            .unwrap_or((self.disc.angle, self.disc.speed));
        Sample {
            state: State {
                disc_angle: self.disc.angle,
                disc_speed: self.disc.speed,
                gearbox_angle: self.gearbox_angle,
                gearbox_speed: self.gearbox_speed,
                current: self.current,
                disc1_angle: self.disc1.as_ref().map_or(0.0, |disc| disc.angle),
                disc1_speed: self.disc1.as_ref().map_or(0.0, |disc| disc.speed),
            },
            seen_disc_angle,
            seen_disc_speed,
            acceleration: self.disc.seen_acceleration(),
        }
    }

    fn step(&mut self, voltage: f64, force: f64, disc1_force: f64) {
        let half = 0.5 * self.numerics.step;
        self.drift(half);
        let shaft = self.shaft_torque();
        let disc1_shaft = self.disc1_shaft_torque();
        self.kick_motor(voltage, shaft);
        let time = self.time;
        if let Some(disc1) = &mut self.disc1 {
            disc1.kick(-disc1_shaft, disc1_force, time);
            self.disc.kick(disc1_shaft - shaft, force, time);
        } else {
            self.disc.kick(-shaft, force, time);
        }
        self.drift(half);
        if self.delay_steps > 0 {
            self.history.pop_front();
            self.history.push_back((self.disc.angle, self.disc.speed));
        }
    }

    fn drift(&mut self, time: f64) {
        self.disc.drift(time);
        if let Some(disc1) = &mut self.disc1 {
            disc1.drift(time);
        }
        self.gearbox_angle += time * self.gearbox_speed;
        self.time += time;
    }

    /// Torque that shaft 1 takes from disc D1 and gives to D2 [N m].
    fn disc1_shaft_torque(&self) -> f64 {
        let (Some(part), Some(disc)) = (&self.rig.disc1, &self.disc1) else {
            return 0.0;
        };
        let twist = disc.angle - self.disc.angle;
        part.shaft_stiffness * twist
            + part.effects.k3 * twist * twist * twist
            + part.shaft_damping * (disc.speed - self.disc.speed)
    }

    /// Torque the shaft takes from the disc [N m].
    fn shaft_torque(&self) -> f64 {
        let (rig, hidden) = (&self.rig.parameters, &self.rig.effects);
        let twist = self.disc.angle - self.gearbox_angle;
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
            + damping * (self.disc.speed - self.gearbox_speed)
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
        let step = self.numerics.step;
        let ratio = rig.gear_ratio;
        let speed = self.gearbox_speed;
        let middle_speed = speed + 0.5 * self.gearbox_gain;
        let resistance = rig.resistance * (1.0 + hidden.dRdt * self.time / 60.0);
        let decay = 0.5 * step * resistance / rig.inductance;
        self.drive_voltage = if hidden.drive_tau == 0.0 {
            voltage
        } else {
            self.drive_voltage + step / hidden.drive_tau * (voltage - self.drive_voltage)
        };
        let drive =
            hidden.uscale * self.drive_voltage - rig.back_emf_constant * ratio * middle_speed;
        let before = self.current;
        self.current = ((1.0 - decay) * before + step / rig.inductance * drive) / (1.0 + decay);

        let middle_current = 0.5 * (before + self.current);
        let felt_current = middle_current.clamp(-hidden.saturation_i, hidden.saturation_i);
        let warm = self.left_when_warm(hidden.fading, hidden.fading_tau);
        let mut motor_torque = rig.torque_constant * warm * felt_current
            - (rig.motor_viscous_damping + hidden.motor_visc) * ratio * middle_speed;
        if hidden.cog_T != 0.0 {
            motor_torque += hidden.cog_T * sin(2.0 * ratio * self.gearbox_angle);
        }
        let inertia = ratio * ratio * rig.motor_inertia;
        let coulomb = ratio * rig.motor_coulomb_torque;
        let friction = self.motor.advance(step, speed, coulomb, coulomb, inertia);
        self.gearbox_gain = step / inertia * (ratio * motor_torque + shaft - friction);
        self.gearbox_speed += self.gearbox_gain;
    }
}
