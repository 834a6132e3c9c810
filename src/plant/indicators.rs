//! Event indicators: the guards of all modes at fixed places, for solvers that look for changes of sign.
//!
//! An indicator is positive as long as the mode is the right one, and not so when it must change. A guard is lost a little
//! beyond zero only: right behind a switch many guards are zero, and a solver that halves its step must find them positive.
//! Places that the present mode does not use are 1.

use super::guards::Watcher;
use super::jet::PinJet;
use super::{Contact, Rig, RigGuard, RigInputs, RigJet, RigMode};
use crate::expression::SITES;
use crate::friction::{ContactMode, Direction, Law, Regime};
use crate::series::Scalar;

/// Number of indicators of the rig with most of them.
pub const MOST_INDICATORS: usize = 16 + 2 * SITES;

/// Velocity \[rad/s\] by which a sliding contact must have passed zero.
const VELOCITY: f64 = 1e-10;
/// Twist \[rad\] by which a coupling must have passed the edge of its dead band.
const TWIST: f64 = 1e-10;
/// What decides a kink of an equation by which it must have passed it, in units of the rig's own inertia, period and current.
const KINK: f64 = 1e-10;
/// Share of the breakaway torque (and of the acceleration that it gives) by which torques must have passed their limits.
const SHARE: f64 = 1e-10;
/// Acceleration \[rad/s²\] of the same where nothing presses and nothing breaks away.
const FLOOR: f64 = 1e-12;
/// The share for sticking bristles under a force that moves: a solver from outside tells no rate of the force, so that bristles give
/// way in small steps.
const GIVING_WAY: f64 = 1e-4;

/// What an indicator tells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Indicator {
    /// This guard is lost.
    Guard(RigGuard),
    /// The followed root of the algebraic loop of D2 (0) or D1 (1) is gone.
    Fold(usize),
}

/// A group of places.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Group {
    /// A pin contact, or the motor.
    Contact(Contact),
    /// The coupling.
    Play,
    /// The normal force of a pin contact.
    Load(Contact),
    /// The factor of friction that wear leaves.
    Wear,
    /// A kink of an effect's equation.
    Branch(usize),
}

/// The indicators of a rig: how many there are, and what they watch.
#[derive(Clone, Debug, PartialEq)]
pub struct Indicators {
    /// Group and first place.
    groups: Vec<(Group, usize, usize)>,
    count: usize,
    /// Whether bristles give way in small steps.
    stepwise: bool,
    /// By how much what decides each kink of an equation must have passed it, in its SI unit.
    kinks: Vec<f64>,
}

impl Indicators {
    /// Those of `rig`.
    pub fn new<S: Scalar>(rig: &Rig<S>) -> Self {
        let mut groups = Vec::new();
        let mut count = 0;
        let mut add = |group, places: usize| {
            groups.push((group, count, places));
            count += places;
        };
        let disc1 = rig.disc1.as_ref().map(|disc1| (Contact::Disc1, &disc1.law));
        for (contact, law) in [(Contact::Disc, &rig.law)].into_iter().chain(disc1) {
            // Two ends of a mode, the second branch, and the fold.
            let places = if law.two_gaussian().is_some() {
                4
            } else if law.has_branches() {
                3
            } else {
                2
            };
            add(Group::Contact(contact), places);
            if !law.is_torque() {
                add(Group::Load(contact), 1);
            }
        }
        add(Group::Contact(Contact::Motor), 2);
        if rig.effects.backlash.is_some() {
            add(Group::Play, 2);
        }
        if rig.effects.friction_wear.is_some() {
            add(Group::Wear, 1);
        }
        for (place, (both_ways, _)) in rig.equations.kinks().enumerate() {
            add(Group::Branch(place), if both_ways { 2 } else { 1 });
        }
        Self {
            groups,
            count,
            stepwise: false,
            kinks: kink_margins(rig),
        }
    }

    /// Lets bristles give way in small steps, as they must where a normal force moves between events.
    pub fn set_stepwise(&mut self, stepwise: bool) {
        self.stepwise = stepwise;
    }

    /// Whether they do.
    pub fn is_stepwise(&self) -> bool {
        self.stepwise
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.count
    }

    /// What each of them is about, in words.
    pub fn descriptions(&self) -> Vec<String> {
        let mut texts = Vec::new();
        for (group, _, places) in &self.groups {
            let (who, kinds): (&str, &[&str]) = match group {
                Group::Contact(Contact::Disc) => ("Disc D2", &PIN),
                Group::Contact(Contact::Disc1) => ("Disc D1", &PIN),
                Group::Contact(Contact::Motor) => ("Motor", &PIN),
                Group::Play => (
                    "Coupling",
                    &["leaves its side of the play or gets ahead", "gets behind"],
                ),
                Group::Load(Contact::Disc1) => ("Pin on disc D1", &["is lifted"]),
                Group::Load(_) => ("Pin on disc D2", &["is lifted"]),
                Group::Wear => ("Friction of disc D2", &["is worn away"]),
                Group::Branch(_) => (
                    "Equation of an effect",
                    &["passes a kink", "passes a kink upwards"],
                ),
            };
            texts.extend(
                kinds
                    .iter()
                    .take(*places)
                    .map(|kind| format!("{who} {kind}")),
            );
        }
        texts
    }

    fn place(&self, wanted: Group) -> Option<usize> {
        let found = self.groups.iter().find(|(group, ..)| *group == wanted);
        found.map(|(_, first, _)| *first)
    }

    /// Fills `values` with the indicators where `jet` was evaluated in `mode`.
    pub fn evaluate<S: Scalar>(
        &self,
        rig: &Rig<S>,
        mode: &RigMode,
        inputs: &RigInputs<S>,
        jet: &RigJet<S>,
        values: &mut [S],
    ) {
        values.fill(S::constant(1.0));
        let mut gathering = Gathering {
            indicators: self,
            margins: Margins::new(rig, jet, self),
            values,
        };
        rig.watch(mode, jet, &mut gathering);
        let values = gathering.values;
        for (group, first, places) in &self.groups {
            let pin = |contact: &Contact| match (contact, jet.disc1.as_deref()) {
                (Contact::Disc1, Some(pin)) => pin,
                _ => &jet.disc,
            };
            match group {
                Group::Contact(contact) if *places == 4 => {
                    let slip = &pin(contact).slip;
                    if has_root(mode.contact(*contact)) && !slip.between {
                        let distance = if slip.lost {
                            -1.0
                        } else {
                            slip.margin.max(SHARE)
                        };
                        values[first + 3] = S::constant(distance);
                    }
                }
                Group::Load(Contact::Disc1) => values[*first] = inputs.normal_force_1[0],
                Group::Load(_) => {
                    let bias = rig.effects.load_cell_bias.map_or(S::ZERO, |cell| cell.bias);
                    values[*first] = inputs.normal_force[0] - bias;
                }
                Group::Wear => {
                    let factor = jet.disc.moving[1].as_ref();
                    values[*first] = factor.map_or(S::constant(1.0), |factor| factor[0]);
                }
                _ => {}
            }
        }
    }

    /// Whether a mode must change where `jet` was evaluated.
    pub fn is_event_due(&self, rig: &Rig<f64>, mode: &RigMode, jet: &RigJet<f64>) -> bool {
        self.first_lost(rig, mode, jet).is_some()
    }

    /// The first that is lost, if any.
    pub(super) fn first_lost(
        &self,
        rig: &Rig<f64>,
        mode: &RigMode,
        jet: &RigJet<f64>,
    ) -> Option<Indicator> {
        let mut search = Search {
            margins: Margins::new(rig, jet, self),
            lost: None,
        };
        rig.watch(mode, jet, &mut search);
        let guard = search.lost.map(Indicator::Guard);
        let disc1 = rig.disc1.as_ref().zip(jet.disc1.as_deref());
        let pins = [
            Some((mode.disc, &rig.law, &jet.disc)),
            disc1.map(|(disc1, pin)| (mode.disc1, &disc1.law, pin)),
        ];
        let nears = mode.near;
        let fold = pins.into_iter().enumerate().find_map(|(place, pin)| {
            let (mode, law, pin) = pin?;
            let shape = law.two_gaussian().filter(|_| has_root(mode))?;
            let slip = &pin.slip;
            // Where the law jumps at zero acceleration, a root on the other side is a turn and no fold.
            let turned = shape.jumps_at(slip.speed[0])
                && slip.acceleration[0].is_sign_negative() != nears[place].is_sign_negative();
            let gone = slip.lost && !slip.between && !(turned && guard.is_some());
            gone.then_some(Indicator::Fold(place))
        });
        fold.or(guard)
    }
}

/// Whether a contact follows a root of the algebraic loop.
fn has_root(mode: ContactMode) -> bool {
    matches!(mode, ContactMode::Slipping(_, regime) if regime != Regime::Holding)
}

/// What the places of a contact tell.
const PIN: [&str; 4] = [
    "comes to rest, breaks away forward, or ends giving way",
    "breaks away backward, stops giving way, or changes the sign of its slip acceleration",
    "leaves constant slip speed towards lower speed",
    "reaches the end of a branch of its law",
];

/// By how much each kink of the equations of `rig` must have been passed.
fn kink_margins<S: Scalar>(rig: &Rig<S>) -> Vec<f64> {
    let (inertia, length) = (rig.disc.inertia.value(), rig.contact.radius.value());
    let stiffness = rig.shaft.stiffness.value();
    let resistance = rig.motor.resistance.value();
    // A disc without a spring has no period of its own; the motor's time constant is another time of the rig.
    let time = if stiffness > 0.0 {
        libm::sqrt(inertia / stiffness)
    } else {
        rig.motor.inductance.value() / resistance
    };
    // The current whose heat is the power that stops the disc in that time.
    let current = libm::sqrt(inertia / (libm::pow(time, 3.0) * resistance));
    let units = [inertia / (length * length), length, time, current];
    let kinks = rig.equations.kinks();
    kinks
        .map(|(_, dimension)| KINK * dimension.scale(units))
        .collect()
}

/// How far beyond zero the guards of each contact are lost.
struct Margins<'a> {
    /// Torque \[N m\] and acceleration \[rad/s²\] of D2, D1 and the motor.
    contacts: [(f64, f64); 3],
    kinks: &'a [f64],
}

impl<'a> Margins<'a> {
    fn new<S: Scalar>(rig: &Rig<S>, jet: &RigJet<S>, indicators: &'a Indicators) -> Self {
        let share = if indicators.stepwise && rig.effects.presliding.is_some() {
            GIVING_WAY
        } else {
            SHARE
        };
        let pin = |law: &Law<S>, jet: &PinJet<S>, inertia: S| {
            let breakaway = law.breakaway() * jet.load[0] + jet.constant_torque;
            let torque = share * breakaway.value().abs() + FLOOR * inertia.value();
            (torque, torque / inertia.value())
        };
        let disc = pin(&rig.law, &jet.disc, rig.disc.inertia);
        let disc1 = match (&rig.disc1, &jet.disc1) {
            (Some(disc1), Some(jet)) => pin(&disc1.law, jet, disc1.disc.inertia),
            _ => disc,
        };
        let ratio = rig.gearbox.ratio.value();
        let inertia = ratio * ratio * rig.motor.inertia.value();
        let motor = SHARE * ratio * rig.motor.coulomb_torque.value() + FLOOR * inertia;
        Self {
            contacts: [disc, disc1, (motor, motor / inertia)],
            kinks: &indicators.kinks,
        }
    }

    fn of(&self, guard: RigGuard) -> f64 {
        let contact = |contact: Contact| self.contacts[contact as usize];
        match guard {
            RigGuard::Rest(_) | RigGuard::LeaveBand(..) => VELOCITY,
            RigGuard::Breakaway(of, _) | RigGuard::Calm(of) | RigGuard::Release(of, _) => {
                contact(of).0
            }
            RigGuard::Turn(of, _) => contact(of).1,
            RigGuard::Play(_) => TWIST,
            RigGuard::Branch(place, _) => self.kinks[usize::from(place)],
            RigGuard::Load(_) => 0.0,
        }
    }
}

/// Puts every guard at its place.
struct Gathering<'a, S> {
    indicators: &'a Indicators,
    margins: Margins<'a>,
    values: &'a mut [S],
}

impl<S: Scalar> Watcher<S> for Gathering<'_, S> {
    fn watch(&mut self, kind: RigGuard, coefficient: impl Fn(usize) -> S) {
        let (group, place) = match kind {
            RigGuard::Rest(contact)
            | RigGuard::Breakaway(contact, Direction::Forward)
            | RigGuard::LeaveBand(contact, _) => (Group::Contact(contact), 0),
            RigGuard::Breakaway(contact, Direction::Backward)
            | RigGuard::Calm(contact)
            | RigGuard::Turn(contact, _)
            | RigGuard::Release(contact, Direction::Forward) => (Group::Contact(contact), 1),
            RigGuard::Release(contact, Direction::Backward) => (Group::Contact(contact), 2),
            RigGuard::Play(super::Coupling::Behind) => (Group::Play, 1),
            RigGuard::Play(_) => (Group::Play, 0),
            RigGuard::Branch(place, upwards) => {
                (Group::Branch(usize::from(place)), usize::from(upwards))
            }
            RigGuard::Load(_) => return,
        };
        if let Some(first) = self.indicators.place(group)
            && let Some(value) = self.values.get_mut(first + place)
        {
            *value = coefficient(0) + self.margins.of(kind);
        }
    }
}

/// Looks for the first guard that is lost.
struct Search<'a> {
    margins: Margins<'a>,
    lost: Option<RigGuard>,
}

impl Watcher<f64> for Search<'_> {
    fn watch(&mut self, kind: RigGuard, coefficient: impl Fn(usize) -> f64) {
        let looking = self.lost.is_none() && !matches!(kind, RigGuard::Load(_));
        if looking && coefficient(0) + self.margins.of(kind) <= 0.0 {
            self.lost = Some(kind);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_smaller_rig_passes_its_kinks_by_as_much_less() {
        let margins = |share: f64| {
            let text = include_str!("../../modelDescription/reduced-rig.toml").to_owned()
                + "[[effect]]\nname = \"pull\"\ntitle = \"pull\"\nport = \"disc.torque\"\nequation = \"a*(max(load/f, 1) + abs(angle)) - min(b*load, a)\"\n\
                   parameters.a = { value = 1, unit = \"N.m\", description = \"a\" }\n\
                   parameters.b = { value = 1, unit = \"m\", description = \"b\" }\n\
                   parameters.f = { value = 1, unit = \"N\", range = \"positive\", description = \"f\" }\n";
            let mut rig = Rig::<f64>::from_toml(&text, "rig").unwrap();
            rig.disc.inertia *= share;
            rig.shaft.stiffness *= share;
            kink_margins(&rig)
        };
        let (usual, small) = (margins(1.0), margins(1e-6));
        let shares: Vec<f64> = small.iter().zip(&usual).map(|(a, b)| a / b).collect();
        for (share, expected) in shares.iter().zip([1.0, 1.0, 1e-6]) {
            assert!((share / expected - 1.0).abs() < 1e-12, "{shares:?}");
        }
        assert_eq!(usual[0], KINK);
    }
}
