//! The rigs' equations in every mode, with their Jacobians, root functions and switches.

use std::cell::Cell;
use std::f64::consts::PI;

use anyhow::{Context, Result};

use super::loop_law::{LoopLaw, Solution};
use crate::systems::System;

/// States of the full rig; the reduced rig has the first five.
pub const MOST_STATES: usize = 7;
/// Index of θ2.
pub const THETA: usize = 0;
const OMEGA: usize = 1;
const THETA3: usize = 2;
const OMEGA3: usize = 3;
const CURRENT: usize = 4;
const THETA1: usize = 5;
const OMEGA1: usize = 6;

/// State of one contact.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Contact {
    Backward,
    Stuck,
    Forward,
}

impl Contact {
    fn sign(self) -> f64 {
        match self {
            Self::Backward => -1.0,
            Self::Stuck => 0.0,
            Self::Forward => 1.0,
        }
    }

    fn slips_along(torque: f64) -> Self {
        if torque > 0.0 {
            Self::Forward
        } else {
            Self::Backward
        }
    }

    /// After a stuck contact's torque met its limit, or a slipping one's velocity zero.
    fn next(self, torque: f64, breakaway: f64) -> Self {
        if self != Self::Stuck && torque.abs() <= breakaway {
            Self::Stuck
        } else {
            Self::slips_along(torque)
        }
    }
}

/// Contacts of both discs and of the motor.
#[derive(Clone, Copy, Debug)]
struct Mode {
    disc: Contact,
    motor: Contact,
    disc1: Contact,
}

const AT_REST: Mode = Mode {
    disc: Contact::Stuck,
    motor: Contact::Stuck,
    disc1: Contact::Stuck,
};

#[derive(Debug)]
enum Law {
    Stribeck { mu_c: f64, mu_s: f64, omega_s: f64 },
    Loop(LoopLaw),
}

impl Law {
    fn breakaway(&self) -> f64 {
        match self {
            Self::Stribeck { mu_s, .. } => *mu_s,
            Self::Loop(law) => law.breakaway(),
        }
    }
}

/// A disc with its shaft towards the motor.
#[derive(Clone, Copy, Debug)]
struct Disc {
    inertia: f64,
    stiffness: f64,
    damping: f64,
    load_radius: f64,
}

/// The rig's numbers and the mode that it is in.
#[derive(Debug)]
pub struct Rig {
    disc: Disc,
    disc1: Option<Disc>,
    law: Law,
    ratio: f64,
    motor_inertia: f64,
    resistance: f64,
    inductance: f64,
    torque_constant: f64,
    back_emf: f64,
    coulomb: f64,
    viscous: f64,
    voltage: f64,
    mode: Cell<Mode>,
}

impl Rig {
    /// The rig of a system.
    ///
    /// # Errors
    /// When a parameter is missing.
    pub fn new(system: &System) -> Result<Self> {
        let parameters = system.parameters();
        let number = |name| {
            parameters
                .iter()
                .find(|(key, _)| *key == name)
                .map(|(_, value)| *value)
                .with_context(|| format!("system {} has no parameter `{name}`", system.key))
        };
        let radius = number("radius")?;
        let ratio = number("eta")?;
        let law = if system.law == "stribeck" {
            Law::Stribeck {
                mu_c: number("mu_c")?,
                mu_s: number("mu_s")?,
                omega_s: number("omega_s")?,
            }
        } else {
            Law::Loop(LoopLaw {
                a: [number("a1")?, number("a2")?],
                b: [number("b1")?, number("b2")?],
                c: [number("c1g")?, number("c2g")?],
                omega_centre: number("Vc")?,
                acceleration_semi_axis: number("A")?,
                last: Cell::new((0.0, PI)),
            })
        };
        Ok(Self {
            disc: Disc {
                inertia: number("J2")?,
                stiffness: number("k2")?,
                damping: number("c2")?,
                load_radius: radius * number("N2")?,
            },
            disc1: system.first_disc.map(|disc| Disc {
                inertia: disc.inertia,
                stiffness: disc.stiffness,
                damping: disc.damping,
                load_radius: radius * disc.normal_force,
            }),
            law,
            ratio,
            motor_inertia: ratio * ratio * number("Jm")?,
            resistance: number("R")?,
            inductance: number("L")?,
            torque_constant: number("KT")?,
            back_emf: number("KE")?,
            coulomb: number("Tfm")?,
            viscous: number("Cm")?,
            voltage: number("u")?,
            mode: Cell::new(AT_REST),
        })
    }

    /// Begins a run, at rest.
    pub fn start(&self) {
        self.mode.set(AT_REST);
    }

    /// Number of states.
    pub fn states(&self) -> usize {
        if self.disc1.is_some() { 7 } else { 5 }
    }

    /// Number of root functions: two a contact.
    pub fn roots_count(&self) -> usize {
        if self.disc1.is_some() { 6 } else { 4 }
    }

    fn shaft_torque(&self, y: &[f64]) -> f64 {
        self.disc.damping * (y[OMEGA3] - y[OMEGA]) + self.disc.stiffness * (y[THETA3] - y[THETA])
    }

    fn shaft1_torque(&self, y: &[f64]) -> f64 {
        self.disc1.map_or(0.0, |disc| {
            disc.damping * (y[OMEGA] - y[OMEGA1]) + disc.stiffness * (y[THETA] - y[THETA1])
        })
    }

    fn disc_torque(&self, y: &[f64]) -> f64 {
        self.shaft_torque(y) - self.shaft1_torque(y)
    }

    fn motor_torque(&self, y: &[f64]) -> f64 {
        self.ratio * (self.torque_constant * y[CURRENT] - self.viscous * self.ratio * y[OMEGA3])
            - self.shaft_torque(y)
    }

    fn breakaway(&self, disc: &Disc) -> f64 {
        disc.load_radius * self.law.breakaway()
    }

    /// Stribeck friction torque against a slip, and its slope over the velocity.
    fn stribeck(&self, disc: &Disc, contact: Contact, omega: f64) -> (f64, f64) {
        let Law::Stribeck {
            mu_c,
            mu_s,
            omega_s,
        } = self.law
        else {
            return (0.0, 0.0);
        };
        let sign = contact.sign();
        let fading = (mu_s - mu_c) * (-sign * omega / omega_s).exp();
        (
            sign * disc.load_radius * (mu_c + fading),
            -disc.load_radius * fading / omega_s,
        )
    }

    fn solve_loop(&self, law: &LoopLaw, y: &[f64], contact: Contact) -> Solution {
        let sign = contact.sign();
        law.solve(
            self.disc.inertia,
            self.disc.load_radius,
            sign * y[OMEGA],
            sign * self.disc_torque(y),
        )
    }

    /// Derivative of the state in the present mode.
    pub fn derivative(&self, y: &[f64], d: &mut [f64]) {
        let mode = self.mode.get();
        d.fill(0.0);
        if mode.disc != Contact::Stuck {
            d[THETA] = y[OMEGA];
            d[OMEGA] = match &self.law {
                Law::Loop(law) => {
                    mode.disc.sign() * self.solve_loop(law, y, mode.disc).acceleration
                }
                Law::Stribeck { .. } => {
                    let friction = self.stribeck(&self.disc, mode.disc, y[OMEGA]).0;
                    (self.disc_torque(y) - friction) / self.disc.inertia
                }
            };
        }
        if mode.motor != Contact::Stuck {
            d[THETA3] = y[OMEGA3];
            d[OMEGA3] = (self.motor_torque(y) - self.ratio * self.coulomb * mode.motor.sign())
                / self.motor_inertia;
        }
        d[CURRENT] =
            (self.voltage - self.resistance * y[CURRENT] - self.back_emf * self.ratio * y[OMEGA3])
                / self.inductance;
        if let (Some(disc), true) = (&self.disc1, mode.disc1 != Contact::Stuck) {
            let friction = self.stribeck(disc, mode.disc1, y[OMEGA1]).0;
            d[THETA1] = y[OMEGA1];
            d[OMEGA1] = (self.shaft1_torque(y) - friction) / disc.inertia;
        }
    }

    /// Jacobian of the derivative times `v`.
    pub fn jacobian_product(&self, y: &[f64], v: &[f64], d: &mut [f64]) {
        let mode = self.mode.get();
        d.fill(0.0);
        if mode.disc != Contact::Stuck {
            d[THETA] = v[OMEGA];
            d[OMEGA] = match &self.law {
                Law::Loop(law) => {
                    let found = self.solve_loop(law, y, mode.disc);
                    found.per_drive * self.disc_torque(v) + found.per_speed * v[OMEGA]
                }
                Law::Stribeck { .. } => {
                    let slope = self.stribeck(&self.disc, mode.disc, y[OMEGA]).1;
                    (self.disc_torque(v) - slope * v[OMEGA]) / self.disc.inertia
                }
            };
        }
        if mode.motor != Contact::Stuck {
            d[THETA3] = v[OMEGA3];
            d[OMEGA3] = self.motor_torque(v) / self.motor_inertia;
        }
        d[CURRENT] = (-self.resistance * v[CURRENT] - self.back_emf * self.ratio * v[OMEGA3])
            / self.inductance;
        if let (Some(disc), true) = (&self.disc1, mode.disc1 != Contact::Stuck) {
            let slope = self.stribeck(disc, mode.disc1, y[OMEGA1]).1;
            d[THETA1] = v[OMEGA1];
            d[OMEGA1] = (self.shaft1_torque(v) - slope * v[OMEGA1]) / disc.inertia;
        }
    }

    /// Root functions, positive while the mode lasts: two for the disc, two for the motor, two for disc D1.
    pub fn roots(&self, y: &[f64], r: &mut [f64]) {
        let mode = self.mode.get();
        let contact = |contact: Contact, speed: f64, torque: f64, breakaway: f64| match contact {
            Contact::Stuck => (breakaway - torque, breakaway + torque),
            slipping => (slipping.sign() * speed, 1.0),
        };
        (r[0], r[1]) = contact(
            mode.disc,
            y[OMEGA],
            self.disc_torque(y),
            self.breakaway(&self.disc),
        );
        if let (Law::Loop(law), true) = (&self.law, mode.disc != Contact::Stuck) {
            r[1] = PI - self.solve_loop(law, y, mode.disc).angle.abs();
        }
        (r[2], r[3]) = contact(
            mode.motor,
            y[OMEGA3],
            self.motor_torque(y),
            self.ratio * self.coulomb,
        );
        if let Some(disc) = &self.disc1 {
            (r[4], r[5]) = contact(
                mode.disc1,
                y[OMEGA1],
                self.shaft1_torque(y),
                self.breakaway(disc),
            );
        }
    }

    /// Enters the mode after root `index`; an arrested velocity becomes zero.
    pub fn switch(&self, index: usize, y: &mut [f64]) {
        let mut mode = self.mode.get();
        match index {
            0 | 1 => self.switch_disc(&mut mode, index, y),
            2 | 3 => {
                if mode.motor != Contact::Stuck {
                    y[OMEGA3] = 0.0;
                }
                let breakaway = self.ratio * self.coulomb;
                mode.motor = mode.motor.next(self.motor_torque(y), breakaway);
            }
            _ => {
                if mode.disc1 != Contact::Stuck {
                    y[OMEGA1] = 0.0;
                }
                let breakaway = self.disc1.map_or(0.0, |disc| self.breakaway(&disc));
                mode.disc1 = mode.disc1.next(self.shaft1_torque(y), breakaway);
            }
        }
        self.mode.set(mode);
    }

    fn switch_disc(&self, mode: &mut Mode, index: usize, y: &mut [f64]) {
        // In slip the second root is the cut of the loop's angle, beyond which the motion speeds up or slows down.
        let cut = index == 1 && mode.disc != Contact::Stuck;
        if !cut {
            if mode.disc != Contact::Stuck {
                y[OMEGA] = 0.0;
            }
            mode.disc = mode
                .disc
                .next(self.disc_torque(y), self.breakaway(&self.disc));
        }
        if let (Law::Loop(law), true) = (&self.law, mode.disc != Contact::Stuck) {
            let side = if cut && law.last.get().1 > 0.0 {
                -PI
            } else {
                PI
            };
            law.begin(
                side,
                self.disc.inertia,
                self.disc.load_radius,
                mode.disc.sign() * self.disc_torque(y),
            );
        }
    }
}
