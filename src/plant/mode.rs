//! The discrete state of a rig.

use crate::expression::SITES;
use crate::friction::{ContactMode, Direction, Regime};

/// Side of a coupling with play.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coupling {
    /// θ2 − θ3 above the dead band (everywhere positive without play).
    Ahead,
    /// Within the dead band: no torque.
    Free,
    /// θ2 − θ3 below the dead band.
    Behind,
}

impl Coupling {
    /// The side on which a coupling with this twist θ2 − θ3 and dead band, both in rad, is.
    pub(super) fn at(twist: f64, gap: f64) -> Self {
        let half = 0.5 * gap;
        if twist > half {
            Self::Ahead
        } else if twist < -half {
            Self::Behind
        } else {
            Self::Free
        }
    }
}

/// The places where surfaces rub.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Contact {
    /// Pin on disc D2.
    Disc,
    /// Pin on disc D1 (full rig).
    Disc1,
    /// Motor bearing and brushes.
    Motor,
}

/// Modes of all contacts and of the coupling.
#[derive(Clone, Copy, Debug)]
pub struct RigMode {
    /// Pin on disc D2.
    pub disc: ContactMode,
    /// Pin on disc D1; stuck and without meaning in the reduced rig.
    pub disc1: ContactMode,
    /// Motor bearing.
    pub motor: ContactMode,
    /// Coupling between shaft and gearbox.
    pub coupling: Coupling,
    /// Slip accelerations of D2 and D1 [rad/s²] in the direction of sliding: which root of the
    /// algebraic loop is being followed.
    pub near: [f64; 2],
    /// Whether the root that `near` follows has just ended at a fold, for D2 and D1: the segment
    /// starts on the next stable root.
    pub folded: [bool; 2],
    /// Branch of every kink of the effects by equation, in the order of the effects.
    pub branches: [i32; SITES],
}

impl RigMode {
    /// Mode of one contact.
    pub fn contact(&self, contact: Contact) -> ContactMode {
        match contact {
            Contact::Disc => self.disc,
            Contact::Disc1 => self.disc1,
            Contact::Motor => self.motor,
        }
    }

    /// Puts one contact into a mode.
    pub fn set_contact(&mut self, contact: Contact, mode: ContactMode) {
        match contact {
            Contact::Disc => self.disc = mode,
            Contact::Disc1 => self.disc1 = mode,
            Contact::Motor => self.motor = mode,
        }
    }

    /// Puts the followed root of a pin contact at zero acceleration, on the side of speeding up or
    /// of slowing down.
    pub(super) fn restart_root(&mut self, contact: Contact, regime: Regime) {
        let side = if regime == Regime::SlowingDown {
            -0.0
        } else {
            0.0
        };
        match contact {
            Contact::Disc => self.near[0] = side,
            Contact::Disc1 => self.near[1] = side,
            Contact::Motor => {}
        }
    }
}

/// What a guard of the rig watches: it is lost when the mode is no longer the right one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RigGuard {
    /// A sliding contact comes to rest (or into the law's band of zero velocity).
    Rest(Contact),
    /// A stuck contact breaks away in this direction.
    Breakaway(Contact, Direction),
    /// A contact leaves the band of zero velocity in this direction; of bristles that give way: the disc
    /// turns to move along with them.
    LeaveBand(Contact, Direction),
    /// A contact inside the band of zero velocity is no longer pushed hard enough; of bristles that give
    /// way: they hold again.
    Calm(Contact),
    /// The slip acceleration of a contact that sped up (`Forward`) or slowed down changes its sign.
    Turn(Contact, Direction),
    /// A contact that slides at constant speed starts to speed up (`Forward`) or to slow down.
    Release(Contact, Direction),
    /// The twist reaches or leaves the dead band; the coupling's next side.
    Play(Coupling),
    /// The normal force of a pin contact (D2: `Disc`, D1: `Disc1`) passes through zero.
    Load(Contact),
    /// An effect's equation leaves its branch at the kink of this place; of the pieces of a table, upwards or not.
    Branch(u8, bool),
}
