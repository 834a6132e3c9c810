//! One disc with its pin, its bearing and what hangs on it.

use crate::bristle::Bristle;
use crate::effects::Effects;
use crate::law::ContactLaw;
use crate::numerics::Numerics;
use crate::random::Stream;
use core::f64::consts::TAU;
use libm::{cos, exp, sin};

/// What of the rig a disc sees.
#[derive(Clone, Copy)]
pub(crate) struct Surroundings<'rig> {
    /// Inertia of the disc [kg m²].
    pub inertia: f64,
    /// Distance from pin to rotation centre [m].
    pub radius: f64,
    /// Friction law of the pin.
    pub law: &'rig ContactLaw,
    /// Effects on this disc.
    pub effects: &'rig Effects,
    /// Step and scales.
    pub numerics: &'rig Numerics,
}

/// Motion of a disc and the memory of its contacts.
pub(crate) struct DiscMotion<'rig> {
    around: Surroundings<'rig>,
    pub angle: f64,
    pub speed: f64,
    /// Acceleration after the lag [rad/s²].
    lagged_acceleration: f64,
    /// The same after the lag twice [rad/s²].
    twice_lagged: f64,
    pin: Bristle,
    /// Direction in which the pin slides where rest is a state; 0 = at rest.
    sliding: f64,
    bearing: Bristle,
    absorber_angle: f64,
    absorber_speed: f64,
    friction_level: f64,
    rest: f64,
    random_factor: f64,
    steps_to_draw: usize,
    contact_noise: Stream,
}

impl<'rig> DiscMotion<'rig> {
    pub fn new(
        around: Surroundings<'rig>,
        angle: f64,
        speed: f64,
        mut contact_noise: Stream,
    ) -> Self {
        let random_factor = around.effects.stoch_std * contact_noise.normal();
        Self {
            around,
            angle,
            speed,
            lagged_acceleration: 0.0,
            twice_lagged: 0.0,
            pin: Bristle::new(around.numerics.disc),
            sliding: 0.0,
            bearing: Bristle::new(around.numerics.disc),
            absorber_angle: angle,
            absorber_speed: speed,
            friction_level: 0.0,
            rest: 0.0,
            random_factor,
            steps_to_draw: around.numerics.steps_per_draw,
            contact_noise,
        }
    }

    /// Acceleration the two-Gaussian law sees [rad/s²].
    pub fn seen_acceleration(&self) -> f64 {
        2.0 * self.lagged_acceleration - self.twice_lagged
    }

    /// Positions move on by `time` [s].
    pub fn drift(&mut self, time: f64) {
        self.angle += time * self.speed;
        self.absorber_angle += time * self.absorber_speed;
    }

    /// Velocities are kicked a whole step by `applied` [N m] and what acts on the disc itself, at
    /// `time` [s] under the normal force `force` [N].
    pub fn kick(&mut self, applied: f64, force: f64, time: f64) {
        let Surroundings {
            effects: hidden,
            numerics,
            inertia: still,
            ..
        } = self.around;
        let step = numerics.step;
        let speed = self.speed;
        let mut torque = applied - hidden.visc * speed - hidden.quad * speed * speed.abs();
        if hidden.unbal_T != 0.0 {
            torque -= hidden.unbal_T * cos(self.angle - hidden.unbal_ph);
        }
        if hidden.harmonic_T != 0.0 {
            let phase = hidden.harmonic_n * self.angle - hidden.harmonic_ph;
            torque -= hidden.harmonic_T * cos(phase);
        }
        if hidden.periodic_T != 0.0 {
            let phase = TAU * hidden.periodic_f * time - hidden.periodic_ph;
            torque += hidden.periodic_T * cos(phase);
        }
        let mut inertia = still;
        if hidden.breathing_J != 0.0 {
            let rate = TAU / hidden.breathing_period;
            let phase = rate * time - hidden.breathing_ph;
            inertia *= 1.0 + hidden.breathing_J * sin(phase);
            torque -= still * hidden.breathing_J * rate * cos(phase) * speed;
        }
        if hidden.absorber_J != 0.0 {
            torque += self.kick_absorber();
        }
        if hidden.bearing_T != 0.0 {
            let level = hidden.bearing_T;
            torque -= self.bearing.advance(step, speed, level, level, inertia);
        }
        if force > 0.0 {
            torque -= self.pin_torque(force, inertia, time);
        }
        let acceleration = torque / inertia;
        self.twice_lagged +=
            step / numerics.acceleration_lag * (self.lagged_acceleration - self.twice_lagged);
        self.lagged_acceleration +=
            step / numerics.acceleration_lag * (acceleration - self.lagged_acceleration);
        self.speed += step * acceleration;
    }

    /// Kicks the hanging inertia and returns the torque it puts on the disc [N m].
    fn kick_absorber(&mut self) -> f64 {
        let hidden = self.around.effects;
        let rate = TAU * hidden.absorber_f;
        let stiffness = hidden.absorber_J * rate * rate;
        let damping = 2.0 * hidden.absorber_zeta * hidden.absorber_J * rate;
        let torque = stiffness * (self.absorber_angle - self.angle)
            + damping * (self.absorber_speed - self.speed);
        self.absorber_speed -= self.around.numerics.step / hidden.absorber_J * torque;
        torque
    }

    /// Normal force at the pin where the brake is set to `force`, both [N].
    fn true_force(&self, force: f64) -> f64 {
        let hidden = self.around.effects;
        let mut normal_force = force;
        if hidden.wobble_a != 0.0 {
            normal_force *= 1.0 + hidden.wobble_a * cos(self.angle - hidden.wobble_ph);
        }
        if hidden.lobes_a != 0.0 {
            let phase = 3.0 * self.angle - hidden.lobes_ph;
            normal_force *= 1.0 + hidden.lobes_a * cos(phase);
        }
        if hidden.lifting != 0.0 {
            let speed = self.speed;
            normal_force *= (1.0 - hidden.lifting * speed * speed).max(0.0);
        }
        if hidden.load_exp != 1.0 {
            let reference = hidden.load_ref;
            normal_force = reference * libm::pow(normal_force / reference, hidden.load_exp);
        }
        if hidden.load_limit.is_finite() {
            normal_force = hidden.load_limit * libm::tanh(normal_force / hidden.load_limit);
        }
        normal_force
    }

    fn pin_torque(&mut self, force: f64, inertia: f64, time: f64) -> f64 {
        let Surroundings {
            effects: hidden,
            numerics,
            law,
            radius,
            ..
        } = self.around;
        let step = numerics.step;
        let mut torque_per_mu =
            self.true_force(force) * radius * (1.0 + hidden.dmudt * time / 60.0);
        if hidden.stoch_std > 0.0 {
            torque_per_mu *= 1.0 + self.random_friction();
        }
        let speed = self.speed;
        if hidden.bump_height != 0.0 {
            let distance = (speed.abs() - hidden.bump_centre) / hidden.bump_width;
            torque_per_mu *= 1.0 + hidden.bump_height * exp(-distance * distance);
        }
        if hidden.patch_height != 0.0 {
            let distance = sin(0.5 * (self.angle - hidden.patch_centre)) / hidden.patch_width;
            torque_per_mu *= 1.0 + hidden.patch_height * exp(-4.0 * distance * distance);
        }
        if hidden.jump != 0.0 && time > hidden.jump_time {
            torque_per_mu *= 1.0 + hidden.jump;
        }
        if hidden.sway != 0.0 {
            let phase = TAU * time / hidden.sway_period - hidden.sway_ph;
            torque_per_mu *= 1.0 + hidden.sway * cos(phase);
        }
        if hidden.asymmetry != 0.0 && speed < 0.0 {
            torque_per_mu *= 1.0 + hidden.asymmetry;
        }
        let along = if speed < 0.0 { -1.0 } else { 1.0 };
        let sliding = law.coefficient(speed.abs(), along * self.seen_acceleration());
        let level = self.level_by_state(sliding, law.breakaway());
        let mut breakaway = torque_per_mu * law.breakaway();
        let mut level = torque_per_mu * level;
        if hidden.dwell_gain != 0.0 {
            self.rest = if speed.abs() < numerics.resting {
                self.rest + step
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
            self.friction_level += step / hidden.memory_tau * (level - self.friction_level);
            level = self.friction_level;
        }
        if hidden.bristle_k.is_finite() && breakaway > 0.0 {
            self.pin.soften(breakaway / hidden.bristle_k);
        }
        self.pin.advance(step, speed, breakaway, level, inertia)
    }

    /// The coefficient that holds: `breakaway` at rest, `level` in sliding.
    fn level_by_state(&mut self, level: f64, breakaway: f64) -> f64 {
        if self.sliding == 0.0 {
            // A disc that has just stopped bends its bristles back first.
            if let Some(direction) = self.pin.gives_way()
                && direction * self.speed > 0.0
            {
                self.sliding = direction;
                self.pin.slip_to(level / breakaway);
            }
        } else if self.sliding * self.speed < 0.0 {
            self.sliding = 0.0;
        }
        if self.sliding == 0.0 {
            breakaway
        } else {
            level
        }
    }

    /// Ornstein–Uhlenbeck factor, exact between its draws.
    fn random_friction(&mut self) -> f64 {
        let numerics = self.around.numerics;
        self.steps_to_draw -= 1;
        if self.steps_to_draw == 0 {
            self.steps_to_draw = numerics.steps_per_draw;
            let hidden = self.around.effects;
            let kept = exp(-(numerics.steps_per_draw as f64) * numerics.step / hidden.stoch_tau);
            let fresh = hidden.stoch_std * libm::sqrt(1.0 - kept * kept);
            self.random_factor = kept * self.random_factor + fresh * self.contact_noise.normal();
        }
        self.random_factor
    }
}
