//! The effects of a rig that are given by equations, with their values.

use super::{Definition, Port};
use crate::expression::{COORDINATES, Coordinate, MOST_PARAMETERS, SITES};
use crate::parameter::{ParameterError, ParameterInfo, Section};
use crate::series::Scalar;

/// Most effects by equation that one rig may have.
const MOST_EFFECTS: usize = 4;

/// SI values of the units in which a rig's own numbers are, for equations that are always in SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SiUnits {
    /// Of time [s].
    pub time: f64,
    /// Of torque [N m].
    pub torque: f64,
    /// Of normal force [N].
    pub force: f64,
    /// Of current [A].
    pub current: f64,
    /// Of voltage [V].
    pub voltage: f64,
}

impl SiUnits {
    /// A rig in SI units.
    pub const SI: Self = Self {
        time: 1.0,
        torque: 1.0,
        force: 1.0,
        current: 1.0,
        voltage: 1.0,
    };

    pub(super) fn of(&self, coordinate: Coordinate) -> f64 {
        match coordinate {
            Coordinate::Angle | Coordinate::Twist => 1.0,
            Coordinate::Velocity | Coordinate::TwistRate => 1.0 / self.time,
            Coordinate::Current => self.current,
            Coordinate::Voltage => self.voltage,
            Coordinate::Load => self.force,
            Coordinate::Time => self.time,
        }
    }

    pub(super) fn of_port(&self, port: Port) -> f64 {
        match port {
            // A resistance is the voltage that it drops.
            Port::MotorVoltage | Port::MotorResistance => self.voltage,
            Port::DiscFriction | Port::Disc1Friction => 1.0,
            _ => self.torque,
        }
    }
}

/// One effect with its values, in SI units always.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EquationEffect<S> {
    /// What it is.
    pub definition: &'static Definition,
    /// Whether it acts; one that does not is only known to the rig.
    pub is_on: bool,
    values: [S; MOST_PARAMETERS],
}

impl<S: Scalar> EquationEffect<S> {
    /// Its values.
    pub fn values(&self) -> &[S] {
        &self.values[..self.definition.infos().len()]
    }
}

impl<S: Scalar> Section<S> for EquationEffect<S> {
    fn infos(&self) -> &'static [ParameterInfo] {
        self.definition.infos()
    }
    fn get(&self, index: usize) -> S {
        self.values[index]
    }
    fn set(&mut self, index: usize, value: S) {
        self.values[index] = value;
    }
}

/// All of a rig's effects by equation, those that are on and those that are only known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EquationEffects<S> {
    effects: [Option<EquationEffect<S>>; MOST_EFFECTS],
    /// Units of the rig that has them.
    pub units: SiUnits,
}

impl<S> Default for EquationEffects<S> {
    fn default() -> Self {
        Self {
            effects: std::array::from_fn(|_| None),
            units: SiUnits::SI,
        }
    }
}

impl<S: Scalar> EquationEffects<S> {
    /// Those that are known.
    pub fn known(&self) -> impl Iterator<Item = &EquationEffect<S>> {
        self.effects.iter().flatten()
    }

    /// Whether there is room for no other.
    pub fn is_full(&self) -> bool {
        self.effects.iter().all(Option::is_some)
    }

    /// Those that act.
    pub fn active(&self) -> impl Iterator<Item = &EquationEffect<S>> {
        self.known().filter(|effect| effect.is_on)
    }

    pub(in crate::plant) fn active_mut(&mut self) -> impl Iterator<Item = &mut EquationEffect<S>> {
        let effects = self.effects.iter_mut().flatten();
        effects.filter(|effect| effect.is_on)
    }

    /// Whether any acts at `port`.
    pub(in crate::plant) fn act_at(&self, port: Port) -> bool {
        self.active().any(|effect| effect.definition.port() == port)
    }

    /// Whether any that acts depends on time.
    pub fn depend_on_time(&self) -> bool {
        self.active()
            .any(|effect| effect.definition.program().uses(Coordinate::Time as usize))
    }

    /// Makes an effect known, without switching it on.
    ///
    /// # Errors
    /// Another effect has its name, or there are too many.
    pub fn add(&mut self, definition: &'static Definition) -> Result<(), ParameterError> {
        let wrong = |message: String| ParameterError::Inconsistent {
            section: format!("effect {}", definition.name()),
            message,
        };
        if let Some(other) = self
            .known()
            .find(|other| other.definition.name() == definition.name())
        {
            return if other.definition == definition {
                Ok(())
            } else {
                Err(wrong("another effect has this name already".to_owned()))
            };
        }
        match self.effects.iter_mut().find(|place| place.is_none()) {
            Some(place) => {
                *place = Some(EquationEffect {
                    definition,
                    is_on: false,
                    values: [S::ZERO; MOST_PARAMETERS],
                });
                Ok(())
            }
            None => Err(wrong(format!(
                "a rig has at most {MOST_EFFECTS} effects by equation"
            ))),
        }
    }

    /// Switches a known effect on with the values that `value` gives; `None` if there is none of this name.
    pub fn insert<E>(
        &mut self,
        name: &str,
        mut value: impl FnMut(&'static ParameterInfo) -> Result<S, E>,
    ) -> Option<Result<(), E>> {
        let known = self.effects.iter_mut().flatten();
        let effect = known.into_iter().find(|e| e.definition.name() == name)?;
        for (place, info) in effect.definition.infos().iter().enumerate() {
            match value(info) {
                Ok(number) => effect.values[place] = number,
                Err(error) => return Some(Err(error)),
            }
        }
        effect.is_on = true;
        Some(Ok(()))
    }

    /// Switches the effect `name` off; whether it was on.
    pub fn remove(&mut self, name: &str) -> bool {
        let found = self.active_mut().find(|e| e.definition.name() == name);
        found.is_some_and(|effect| std::mem::replace(&mut effect.is_on, false))
    }

    /// The same over another kind of number.
    pub fn to_scalar<T: Scalar>(&self) -> EquationEffects<T> {
        EquationEffects {
            effects: self.effects.map(|effect| {
                effect.map(|effect| EquationEffect {
                    definition: effect.definition,
                    is_on: effect.is_on,
                    values: effect.values.map(|value| T::constant(value.value())),
                })
            }),
            units: self.units,
        }
    }

    /// Checks that all kinks together are not too many.
    pub(in crate::plant) fn check(&self) -> Result<(), ParameterError> {
        let sites: usize = self
            .active()
            .map(|effect| effect.definition.program().sites().len())
            .sum();
        if sites <= SITES {
            return Ok(());
        }
        Err(ParameterError::Inconsistent {
            section: "effect".to_owned(),
            message: format!("the equations have {sites} kinks together; {SITES} are the most"),
        })
    }

    /// `coordinates`, which are in the rig's units, in SI units.
    pub(super) fn in_si(&self, coordinates: &mut [S; COORDINATES], port: Port) {
        if self.units == SiUnits::SI {
            return;
        }
        for &coordinate in port.coordinates() {
            let value = &mut coordinates[coordinate as usize];
            *value = *value * self.units.of(coordinate);
        }
    }
}
