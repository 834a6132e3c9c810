//! The oscillator's equations as recurrences for Taylor coefficients.

use stickslip::friction::{ContactMode, Direction, Law, Regime, Slip, SlipJet};
use stickslip::integrator::Guard;
use stickslip::series::{Series, TERMS};
use thiserror::Error;

use super::Drive;

/// Largest number of bodies.
pub const BODIES: usize = 3;
/// Positions, velocities and the anchor's position.
pub(super) const STATES: usize = 2 * BODIES + 1;
/// Place of the anchor's position in the state.
const ANCHOR: usize = 2 * BODIES;

/// Positions, velocities, position of the anchor.
pub type OscillatorState = [f64; STATES];

/// Bodies of unit inertia, X'' = −C X' − K X + F, one of which rubs on a surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Oscillator {
    /// Number of bodies, 1 to [`BODIES`].
    pub bodies: usize,
    /// Matrix K.
    pub stiffness: [[f64; BODIES]; BODIES],
    /// Matrix C.
    pub damping: [[f64; BODIES]; BODIES],
    /// Constant forces.
    pub constant_force: [f64; BODIES],
    /// Force on the last body.
    pub force: Drive,
    /// Velocity of the anchor, to which the first body hangs with stiffness 1.
    pub anchor: Option<Drive>,
    /// Velocity of the surface on which the first body rubs.
    pub surface: Drive,
    law: Law<f64>,
}

/// Why there is no such oscillator.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum OscillatorError {
    /// Laws with an algebraic loop in the acceleration belong to the rig.
    #[error(
        "the law {0} closes an algebraic loop over the acceleration; dimensionless oscillators take the other laws"
    )]
    Loop(&'static str),
}

/// What a guard watches.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OscillatorGuard {
    /// The sliding body comes to rest on the surface.
    Rest,
    /// The stuck body breaks away.
    Breakaway(Direction),
    /// The body leaves the law's band of zero velocity.
    LeaveBand(Direction),
    /// The body inside the band is no longer pushed hard enough.
    Calm,
    /// The slip acceleration changes its sign.
    Turn,
    /// A body that slides at constant speed starts to speed up (forward) or to slow down.
    Release(Direction),
}

/// Series of the motion over one segment.
#[derive(Debug, Clone)]
pub struct OscillatorJet {
    pub(super) states: [Series<f64>; STATES],
    /// Velocity of the body over the surface.
    pub(super) slip_velocity: Series<f64>,
    /// Friction force on the surface; it acts on the body with the opposite sign.
    pub(super) friction: Series<f64>,
    pub(super) slip: SlipJet<f64>,
    /// All other forces that resist a positive slip.
    pub(super) resisting: Series<f64>,
    pub(super) guards: Vec<Guard<OscillatorGuard>>,
}

impl Oscillator {
    /// An oscillator whose first body rubs under `law` with unit load.
    ///
    /// # Errors
    /// [`OscillatorError::Loop`] for the two-Gaussian laws.
    pub fn new(bodies: usize, law: Law<f64>) -> Result<Self, OscillatorError> {
        if law.two_gaussian().is_some() {
            return Err(OscillatorError::Loop(law.name()));
        }
        Ok(Self {
            bodies: bodies.clamp(1, BODIES),
            stiffness: [[0.0; BODIES]; BODIES],
            damping: [[0.0; BODIES]; BODIES],
            constant_force: [0.0; BODIES],
            force: Drive::constant(0.0),
            anchor: None,
            surface: Drive::constant(0.0),
            law,
        })
    }

    /// The friction law.
    #[must_use]
    pub fn law(&self) -> &Law<f64> {
        &self.law
    }

    pub(super) fn empty_jet(&self) -> OscillatorJet {
        let zero = [0.0; TERMS];
        OscillatorJet {
            states: [zero; STATES],
            slip_velocity: zero,
            friction: zero,
            slip: SlipJet::new(&self.law),
            resisting: zero,
            guards: Vec::new(),
        }
    }

    /// Fills `jet` with coefficients 0 to `order` of the motion from `time` and `state` on.
    pub(super) fn expand_motion(
        &self,
        mode: ContactMode,
        time: f64,
        state: &OscillatorState,
        order: usize,
        jet: &mut OscillatorJet,
    ) {
        for (series, value) in jet.states.iter_mut().zip(state) {
            series[0] = *value;
        }
        for k in 0..=order {
            let mut push = [0.0; BODIES];
            for (body, value) in push.iter_mut().enumerate().take(self.bodies) {
                for other in 0..self.bodies {
                    *value -= self.stiffness[body][other] * jet.states[other][k]
                        + self.damping[body][other] * jet.states[BODIES + other][k];
                }
                if k == 0 {
                    *value += self.constant_force[body];
                }
            }
            push[self.bodies - 1] += self.force.coefficient(k, time);
            if self.anchor.is_some() {
                push[0] += jet.states[ANCHOR][k];
            }
            push[0] = self.contact_order(k, mode, time, push[0], jet);
            let step = 1.0 / (k + 1) as f64;
            if k + 1 < TERMS {
                for (body, acceleration) in push.iter().enumerate() {
                    jet.states[BODIES + body][k + 1] = acceleration * step;
                    jet.states[body][k + 1] = jet.states[BODIES + body][k] * step;
                }
                jet.states[ANCHOR][k + 1] = self
                    .anchor
                    .map_or(0.0, |anchor| anchor.coefficient(k, time) * step);
            }
        }
        self.set_guards(mode, order, jet);
    }

    /// Order `k` of the contact under the force `push` of everything else; returns the first body's acceleration.
    fn contact_order(
        &self,
        k: usize,
        mode: ContactMode,
        time: f64,
        push: f64,
        jet: &mut OscillatorJet,
    ) -> f64 {
        const UNIT_LOAD: Series<f64> = {
            let mut load = [0.0; TERMS];
            load[0] = 1.0;
            load
        };
        let surface_acceleration = (k + 1) as f64 * self.surface.coefficient(k + 1, time);
        jet.slip_velocity[k] = jet.states[BODIES][k] - self.surface.coefficient(k, time);
        let resisting = surface_acceleration - push;
        jet.resisting[k] = resisting;
        let relative = match mode {
            ContactMode::Stuck => {
                let relative = -self.law.band().1 * jet.slip_velocity[k];
                jet.friction[k] = -(resisting + relative);
                relative
            }
            ContactMode::Breaking(direction) => {
                let level = if k == 0 { self.law.breakaway() } else { 0.0 };
                jet.friction[k] = level * direction.sign();
                -(resisting + jet.friction[k])
            }
            ContactMode::Slipping(direction, regime) => {
                let sign = direction.sign();
                let contact = Slip {
                    law: &self.law,
                    regime,
                    inertia: 1.0,
                    inverse_inertia: 1.0,
                    constant_torque: 0.0,
                    load: &UNIT_LOAD,
                    load_is_constant: true,
                    near: 0.0,
                    folded: false,
                };
                jet.slip.speed[k] = jet.slip_velocity[k] * sign;
                contact.expand_order(k, resisting * sign, &jet.states[0], &mut jet.slip);
                jet.friction[k] = jet.slip.torque[k] * sign;
                jet.slip.acceleration[k] * sign
            }
        };
        relative + surface_acceleration
    }

    fn set_guards(&self, mode: ContactMode, order: usize, jet: &mut OscillatorJet) {
        let OscillatorJet {
            slip_velocity,
            friction,
            slip,
            resisting,
            guards,
            ..
        } = jet;
        guards.clear();
        let mut push = |kind, coefficient: &dyn Fn(usize) -> f64| {
            let mut series = [0.0; TERMS];
            for (k, value) in series.iter_mut().enumerate().take(order + 1) {
                *value = coefficient(k);
            }
            guards.push(Guard { kind, series });
        };
        let at_zero = |k: usize, value: f64| if k == 0 { value } else { 0.0 };
        let (band, breakaway) = (self.law.band().0, self.law.breakaway());
        match mode {
            ContactMode::Stuck => {
                for direction in [Direction::Forward, Direction::Backward] {
                    push(OscillatorGuard::Breakaway(direction), &|k| {
                        at_zero(k, breakaway) - friction[k] * direction.sign()
                    });
                }
            }
            ContactMode::Breaking(direction) => {
                let sign = direction.sign();
                push(OscillatorGuard::LeaveBand(direction), &|k| {
                    at_zero(k, band) - slip_velocity[k] * sign
                });
                push(OscillatorGuard::Calm, &|k| {
                    -resisting[k] * sign - at_zero(k, breakaway)
                });
            }
            ContactMode::Slipping(_, regime) => {
                push(OscillatorGuard::Rest, &|k| slip.speed[k] - at_zero(k, band));
                match regime {
                    Regime::Free => {}
                    Regime::SpeedingUp => push(OscillatorGuard::Turn, &|k| slip.acceleration[k]),
                    Regime::SlowingDown => push(OscillatorGuard::Turn, &|k| -slip.acceleration[k]),
                    Regime::Holding => {
                        push(OscillatorGuard::Release(Direction::Forward), &|k| {
                            slip.level[k] - slip.torque[k]
                        });
                        push(OscillatorGuard::Release(Direction::Backward), &|k| {
                            slip.torque[k] - slip.lower_level[k]
                        });
                    }
                }
            }
        }
    }
}
