//! Motion of a body as recurrences for Taylor coefficients.
//!
//! inertia·a + passive force + effects = drive, where the passive force is that of the base: viscous drag, an offset, the moment of
//! a weight. Effects that depend on the acceleration do so in proportion, so that each order is solved for its coefficient exactly.

use operations::COORDINATES;

use super::coordinate::{
    ACCELERATION, COUNT, DIRECTION, FRICTION, LOAD, MOTOR, POSITION, TIME, VELOCITY,
};
use super::plant::Term;
use super::{Body, Effect, Kind, Port};
use crate::expression::{ExpressionJet, SITES};
use crate::friction::Direction;
use crate::integrator::Guard;
use crate::series::{RECIPROCAL, Scalar, Series, TERMS, convolution, cosine_sine, shifted};

const _: () = assert!(
    COORDINATES.len() < MOTOR,
    "a joint's loads follow those of every plant"
);

/// Number of inputs that a body may have.
pub const INPUTS: usize = 2;
/// Place of a drive's force.
pub const FORCE: usize = 0;
/// Place of the voltage at a joint's motor.
pub const VOLTAGE: usize = 0;
/// Place of the share of connection of a joint's motor.
pub const CONNECTED: usize = 1;

/// Inputs from `time` on: each is Σ c\[j\] (t − `time`)^j.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inputs {
    /// Time [s] at which the polynomials are centred.
    pub time: f64,
    /// Force of a drive [N or N m]; voltage of a joint's motor [V] and its share of connection.
    pub polynomials: [[f64; 4]; INPUTS],
}

/// What the body does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    /// It moves, or is about to.
    Slides(Direction),
    /// Friction holds it.
    Sticks,
}

/// Branches of all kinks.
pub type Branches = [i32; SITES];

/// What the body does, and on which branches its equations are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mode {
    /// What it does.
    pub motion: Motion,
    /// Branches forward and backward; of a body that slides, those of its direction count.
    pub branches: [Branches; 2],
}

/// What a guard watches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GuardKind {
    /// The velocity of a body that slides.
    Turn,
    /// The force that friction has left to hold the body this way.
    Breakaway(Direction),
    /// A kink: of which side's equations, at which place, whether its branch ends upwards.
    Kink(Direction, usize, bool),
}

/// Series over one segment.
#[derive(Clone, Debug)]
pub struct BodyJet<S> {
    /// Position and velocity.
    pub(super) states: [Series<S>; 2],
    /// Acceleration.
    pub acceleration: Series<S>,
    /// What opposes the motion by its direction; of a body that sticks, the reaction that holds it.
    pub friction: Series<S>,
    pub(super) inputs: [Series<S>; INPUTS],
    /// j φ\[j\] of the angle from rest, its cosine and sine.
    turn: [Series<S>; 3],
    weight: Series<S>,
    emf: Series<S>,
    motor: Series<S>,
    pub(super) sides: [Vec<ExpressionJet<S>>; 2],
    /// What friction has left to hold the body forward and backward.
    pub(super) margins: [Series<S>; 2],
    pub(super) guards: Vec<Guard<GuardKind>>,
    /// The longest segment [s] on which what is watched can be trusted.
    pub(super) reach: f64,
}

/// Coefficients of the forces that effects add against the motion.
#[derive(Clone, Copy)]
struct Sums<S> {
    frictional: S,
    other: S,
}

impl<S: Scalar> Sums<S> {
    fn total(self) -> S {
        self.frictional + self.other
    }
}

/// Where in a series, which way, when, and at which acceleration.
#[derive(Clone, Copy)]
struct At<S> {
    k: usize,
    direction: Direction,
    time: f64,
    acceleration: S,
}

/// Place of what is kept for this direction.
pub(super) fn side(direction: Direction) -> usize {
    usize::from(direction == Direction::Backward)
}

impl<S: Scalar> BodyJet<S> {
    /// Empty series.
    pub fn new(body: &Body<S>) -> Self {
        let zero = [S::ZERO; TERMS];
        let jets: Vec<_> = effects(body)
            .map(|(_, own)| own.program.new_jet())
            .collect();
        Self {
            states: [zero; 2],
            acceleration: zero,
            friction: zero,
            inputs: [zero; INPUTS],
            turn: [zero; 3],
            weight: zero,
            emf: zero,
            motor: zero,
            sides: [jets.clone(), jets],
            margins: [zero; 2],
            guards: Vec::new(),
            reach: f64::INFINITY,
        }
    }

    /// Begins series at these values.
    pub(super) fn begin(&mut self, state: [S; 2]) {
        for (series, value) in self.states.iter_mut().zip(state) {
            *series = [S::ZERO; TERMS];
            series[0] = value;
        }
    }
}

impl BodyJet<f64> {
    /// Takes the inputs from `time` \[s\] on.
    pub(super) fn take(&mut self, inputs: &Inputs, time: f64) {
        for (series, polynomial) in self.inputs.iter_mut().zip(&inputs.polynomials) {
            let polynomial = shifted(polynomial, time - inputs.time);
            series[..polynomial.len()].copy_from_slice(&polynomial);
        }
    }
}

/// The effects with their terms, in order.
pub(super) fn effects<S: Scalar>(
    body: &Body<S>,
) -> impl Iterator<Item = (&Term<S>, &'static Effect)> {
    body.terms()
        .filter_map(|term| Some((term, term.definition.effect?)))
}

impl<S: Scalar> Body<S> {
    /// Coefficient `k` of the passive force and of the drive.
    fn base(&self, k: usize, jet: &mut BodyJet<S>) -> (S, S) {
        let (x, v) = (jet.states[0][k], jet.states[1][k]);
        if self.kind == Kind::Drive {
            let offset = if k == 0 { self.own(2) } else { S::ZERO };
            return (self.own(1) * v + offset, jet.inputs[FORCE][k]);
        }
        let [weighted, cosine, sine] = &mut jet.turn;
        let sine = if k == 0 {
            let (sin, cos) = (x - self.own(1)).sin_cos();
            (cosine[0], sine[0]) = (cos, sin);
            sin
        } else {
            weighted[k] = x * k as f64;
            (cosine[k], sine[k]) = cosine_sine(k, weighted, cosine, sine);
            sine[k]
        };
        jet.weight[k] = self.own(0) * sine;
        let passive = jet.weight[k] + self.own(2) * v;
        if self.kind == Kind::Joint {
            jet.emf[k] = self.own(3) * jet.inputs[VOLTAGE][k] - self.own(4) * v;
            jet.motor[k] = convolution(&jet.inputs[CONNECTED][..=k], &jet.emf[..=k]);
        }
        (passive, jet.motor[k])
    }

    /// Coefficient of what all effects add against the motion. With `find`, the branches are put where the values are.
    fn effects(
        &self,
        at: At<S>,
        branches: &mut Branches,
        find: bool,
        jet: &mut BodyJet<S>,
    ) -> Sums<S> {
        let At { k, direction, .. } = at;
        let at_first = |value: f64| S::constant(if k == 0 { value } else { 0.0 });
        let mut values = [S::ZERO; COUNT];
        values[POSITION] = jet.states[0][k];
        values[VELOCITY] = jet.states[1][k];
        if find && values[VELOCITY].value() == 0.0 {
            // No speed at all, but on the side to which the body is about to go.
            values[VELOCITY] += S::constant(direction.sign() * f64::MIN_POSITIVE);
        }
        values[ACCELERATION] = at.acceleration;
        values[DIRECTION] = at_first(direction.sign());
        values[TIME] = match k {
            0 => S::constant(at.time),
            1 => S::constant(1.0),
            _ => S::ZERO,
        };
        values[MOTOR] = jet.motor[k];
        values[LOAD] = jet.weight[k];
        let mut sums = Sums {
            frictional: S::ZERO,
            other: S::ZERO,
        };
        let (mut friction, mut first) = (S::ZERO, 0);
        for ((term, effect), jet) in effects(self).zip(&mut jet.sides[side(direction)]) {
            let program = &effect.program;
            let own = &mut branches[first..first + program.sites().len()];
            first += own.len();
            if effect.port == Port::Force {
                values[FRICTION] = friction;
            }
            if find {
                program.branches(&values, term.values(), own, jet);
            }
            let force = program.expand_order(k, &values, term.values(), own, jet);
            if effect.port == Port::Friction {
                friction += force;
            }
            if effect.is_frictional() {
                sums.frictional += force;
            } else {
                sums.other += force;
            }
        }
        sums
    }

    /// Coefficients of orders 0 to `order` of a body that slides, from the states and inputs that `jet` has. Where its inertia does not
    /// outweigh what effects add to it, they are no numbers.
    pub(super) fn slide(
        &self,
        direction: Direction,
        time: f64,
        branches: &Branches,
        order: usize,
        jet: &mut BodyJet<S>,
    ) {
        let mut branches = *branches;
        let mut inertia = self.inertia();
        for k in 0..=order {
            let (passive, drive) = self.base(k, jet);
            let bare = drive - passive;
            let at = |acceleration| At {
                k,
                direction,
                time,
                acceleration,
            };
            let mut sums = self.effects(at(S::ZERO), &mut branches, false, jet);
            if k == 0 && self.reacts {
                inertia += self.slope(at(bare - sums.total()), sums, &mut branches, jet);
                if inertia.value() <= 0.0 {
                    inertia = S::constant(f64::NAN);
                }
            }
            let acceleration = (bare - sums.total()) / inertia;
            if self.reacts {
                sums = self.effects(at(acceleration), &mut branches, false, jet);
            }
            jet.acceleration[k] = acceleration;
            jet.friction[k] = sums.frictional;
            let share = RECIPROCAL[k + 1];
            jet.states[0][k + 1] = jet.states[1][k] * share;
            jet.states[1][k + 1] = acceleration * share;
        }
    }

    /// Order 0 of the series at an instant, states and mode given.
    pub fn instant(
        &self,
        mode: &Mode,
        time: f64,
        state: [S; 2],
        inputs: [S; INPUTS],
    ) -> BodyJet<S> {
        let mut jet = BodyJet::new(self);
        jet.begin(state);
        for (series, input) in jet.inputs.iter_mut().zip(inputs) {
            series[0] = input;
        }
        match mode.motion {
            Motion::Slides(direction) => {
                let branches = &mode.branches[side(direction)];
                self.slide(direction, time, branches, 0, &mut jet);
            }
            Motion::Sticks => self.stick(time, &mode.branches, 0, &mut jet),
        }
        jet
    }

    /// Names of the effects whose force depends on the acceleration.
    pub fn reacting(&self) -> impl Iterator<Item = &'static str> {
        let reacting = effects(self).filter(|(_, own)| own.program.uses(ACCELERATION));
        reacting.map(|(_, own)| own.name)
    }

    /// By how much the effects' force, which is `still` at no acceleration, grows with the acceleration: in proportion, so that any
    /// other acceleration tells.
    fn slope(&self, at: At<S>, still: Sums<S>, branches: &mut Branches, jet: &mut BodyJet<S>) -> S {
        let probe = match at.acceleration.value() {
            0.0 => 1.0,
            other => other,
        };
        let acceleration = S::constant(probe);
        let moved = self.effects(At { acceleration, ..at }, branches, false, jet);
        (moved.total() - still.total()) * (1.0 / probe)
    }

    /// The same of a body that sticks.
    pub(super) fn stick(
        &self,
        time: f64,
        branches: &[Branches; 2],
        order: usize,
        jet: &mut BodyJet<S>,
    ) {
        let mut branches = *branches;
        for k in 0..=order {
            let (passive, drive) = self.base(k, jet);
            for direction in [Direction::Backward, Direction::Forward] {
                let at = At {
                    k,
                    direction,
                    time,
                    acceleration: S::ZERO,
                };
                let place = side(direction);
                let sums = self.effects(at, &mut branches[place], false, jet);
                let left = passive + sums.total() - drive;
                jet.margins[place][k] = left * direction.sign();
                jet.friction[k] = drive - passive - sums.other;
            }
            jet.acceleration[k] = S::ZERO;
        }
    }
}

impl Body<f64> {
    /// Puts all kinks on the branches where the states and inputs that `jet` has are, at the acceleration that these give to a body that
    /// slides this way; at none where it is `held`.
    pub(super) fn find_branches(
        &self,
        direction: Direction,
        time: f64,
        held: bool,
        branches: &mut Branches,
        jet: &mut BodyJet<f64>,
    ) {
        let (passive, drive) = self.base(0, jet);
        let mut at = At {
            k: 0,
            direction,
            time,
            acceleration: 0.0,
        };
        // The force grows with the acceleration on every branch, so that each step comes nearer to the only solution.
        for _ in 0..2 * SITES {
            let before = *branches;
            self.effects(at, branches, true, jet);
            if held || !self.reacts || (*branches == before && at.acceleration != 0.0) {
                return;
            }
            let still = self.effects(
                At {
                    acceleration: 0.0,
                    ..at
                },
                branches,
                false,
                jet,
            );
            let bare = drive - passive - still.total();
            let probe = At {
                acceleration: bare,
                ..at
            };
            at.acceleration = bare / (self.inertia() + self.slope(probe, still, branches, jet));
        }
    }

    /// What a body at rest does where the states and inputs are those of `jet`.
    pub(super) fn rest(&self, time: f64, jet: &mut BodyJet<f64>) -> Mode {
        let mut branches = [[0; SITES]; 2];
        for direction in [Direction::Forward, Direction::Backward] {
            self.find_branches(direction, time, true, &mut branches[side(direction)], jet);
        }
        self.stick(time, &branches, 0, jet);
        let [forward, backward] = jet.margins.map(|margin| margin[0]);
        if forward >= 0.0 && backward >= 0.0 {
            return Mode {
                motion: Motion::Sticks,
                branches,
            };
        }
        let direction = if forward <= backward {
            Direction::Forward
        } else {
            Direction::Backward
        };
        self.sliding(direction, time, jet)
    }

    /// The mode of a body that slides this way where the states and inputs are those of `jet`.
    pub(super) fn sliding(&self, direction: Direction, time: f64, jet: &mut BodyJet<f64>) -> Mode {
        let mut branches = [[0; SITES]; 2];
        self.find_branches(direction, time, false, &mut branches[side(direction)], jet);
        Mode {
            motion: Motion::Slides(direction),
            branches,
        }
    }
}
