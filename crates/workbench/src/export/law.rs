//! A small plant's friction over the speed, and what of the plant does not depend on the speed alone.

use operations::Operation;
use stickslip::body::Kind;
use stickslip::body::coordinate::{
    ACCELERATION, DIRECTION, FRICTION, LOAD, MOTOR, POSITION, PREDICTED, TIME, VELOCITY,
};

use inference::body::equation::uses;
use inference::body::model::{Model, Term};
use inference::body::term::{Entry, Formula, Role, Sample};

/// Coordinates that friction over the speed does not have.
const OTHERS: [(usize, &str); 6] = [
    (POSITION, "the position"),
    (ACCELERATION, "the acceleration"),
    (TIME, "the time"),
    (LOAD, "the load"),
    (PREDICTED, "the predicted force"),
    (MOTOR, "the motor's torque"),
];

/// Why an effect is not in the law.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Reason {
    /// It depends on these.
    Depends(Vec<&'static str>),
    /// It multiplies a friction of which some is not in the law.
    Friction,
    /// It does not depend on the motion.
    Constant,
    /// It is one of the readings.
    Readings,
}

/// An effect that is not in the law.
#[derive(Debug, Clone)]
pub struct Left<'a> {
    /// The effect.
    pub term: &'a Term,
    /// Why.
    pub reason: Reason,
    /// Its force where the arm is level and the motor holds it, if that tells it.
    pub level: Option<f64>,
}

/// Force against the motion over the velocity.
#[derive(Debug)]
pub struct Law<'a> {
    viscous: f64,
    /// By what the model's forces are multiplied: the moment of inertia, where they are over it.
    scale: f64,
    /// The effects in it.
    pub terms: Vec<&'a Term>,
    /// The others.
    pub left: Vec<Left<'a>>,
}

impl<'a> Law<'a> {
    /// The law of a model, whose forces are multiplied by `scale`.
    #[must_use]
    pub fn of(model: &'a Model, scale: f64) -> Self {
        let (base, effects) = match model.terms().split_first() {
            Some((base, effects)) => (Some(base), effects),
            None => (None, &[][..]),
        };
        let base = |place: usize| base.and_then(|base| base.values.get(place).copied());
        let viscous = match model.kind {
            Kind::Drive => base(1),
            _ => base(2),
        };
        // Friction first, on whose sum the others may depend.
        let is_whole = effects
            .iter()
            .filter(|term| term.entry.role == Role::Friction)
            .all(|term| reason(term.entry, true).is_none());
        let mut law = Self {
            viscous: viscous.unwrap_or_default(),
            scale,
            terms: Vec::new(),
            left: Vec::new(),
        };
        for term in effects {
            match reason(term.entry, is_whole) {
                None => law.terms.push(term),
                Some(reason) => {
                    let weight = base(0).filter(|_| model.kind == Kind::Joint);
                    let level = weight.and_then(|weight| level(term, weight));
                    law.left.push(Left {
                        term,
                        reason,
                        level: level.map(|force| scale * force),
                    });
                }
            }
        }
        law
    }

    /// Force against the motion at a velocity and a direction, 1 or −1 [N or N m].
    #[must_use]
    pub fn force(&self, velocity: f64, direction: f64) -> f64 {
        let sample = Sample {
            velocity,
            direction,
            load: 1.0,
            ..Sample::default()
        };
        let (mut friction, mut sum) = (0.0, self.viscous * velocity);
        for frictional in [true, false] {
            for term in &self.terms {
                if (term.entry.role == Role::Friction) == frictional {
                    let force = term.entry.force(&term.values, &sample, friction);
                    sum += force;
                    if frictional {
                        // A friction does not depend on the friction.
                        friction += force;
                    }
                }
            }
        }
        self.scale * sum
    }
}

/// Force of an effect where the arm is level and the motor holds it, over what `weight` is over; none where more must be known.
fn level(term: &Term, weight: f64) -> Option<f64> {
    let operations = operations(term.entry)?;
    let known = [VELOCITY, DIRECTION, MOTOR, LOAD];
    let is_known = operations.iter().all(|operation| match operation {
        Operation::Coordinate(place) => known.contains(place),
        _ => true,
    });
    let sample = Sample {
        direction: 1.0,
        motor: weight,
        load: weight,
        ..Sample::default()
    };
    let force = term.entry.force(&term.values, &sample, 0.0);
    Some(force).filter(|force| is_known && force.is_finite())
}

fn operations(entry: &Entry) -> Option<&'static [Operation]> {
    match entry.formula {
        Formula::Equation { operations, .. } => Some(operations),
        _ => None,
    }
}

/// Why an effect is not in the law; none where it is. `is_whole` where all friction is in it.
fn reason(entry: &Entry, is_whole: bool) -> Option<Reason> {
    let Some(operations) = operations(entry) else {
        return Some(Reason::Readings);
    };
    let others = OTHERS.iter().filter(|(place, _)| uses(operations, *place));
    let others: Vec<&str> = others.map(|(_, words)| *words).collect();
    if !others.is_empty() {
        return Some(Reason::Depends(others));
    }
    if uses(operations, FRICTION) {
        return (!is_whole).then_some(Reason::Friction);
    }
    let moves = uses(operations, VELOCITY) || uses(operations, DIRECTION);
    (!moves).then_some(Reason::Constant)
}
