//! Which column of a record is which quantity, in which unit.

use serde::Deserialize;
use std::f64::consts::TAU;
use thiserror::Error;

use stickslip::body::{Kind, Path, plain};

/// One column.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Column {
    /// Its name in the file's header.
    pub column: String,
    /// Its unit.
    pub unit: String,
    /// What one of `unit` is in SI units; for units that are none of the quantity's own, such as volts of a force.
    pub factor: Option<f64>,
}

impl Column {
    /// The column as a table of one line.
    #[must_use]
    pub fn to_toml(&self) -> String {
        let factor = self
            .factor
            .map_or(String::new(), |factor| format!(", factor = {factor:?}"));
        format!(
            "{{ column = {:?}, unit = {:?}{factor} }}",
            self.column, self.unit
        )
    }
}

/// The columns of a record by quantity.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Columns {
    /// Time.
    pub time: Column,
    /// Position or angle.
    pub position: Option<Column>,
    /// Velocity.
    pub velocity: Option<Column>,
    /// Force or torque: what drives a drive, what a contact opposes to its motion.
    pub force: Option<Column>,
    /// Normal load of a contact, or force or torque from outside of a balance.
    pub load: Option<Column>,
    /// Force or torque that somebody's own model predicts for the measured motion.
    pub predicted: Option<Column>,
    /// Voltage at a motor's terminals.
    pub voltage: Option<Column>,
    /// Share of the supply that is at a motor's terminals, with its sign.
    pub duty: Option<Column>,
    /// Voltage of a motor's supply.
    pub supply: Option<Column>,
    /// Whether a motor's terminals are connected: 1, or 0 where they are open.
    pub connected: Option<Column>,
}

/// What is wrong with a column.
#[derive(Debug, Error, PartialEq)]
pub enum ColumnError {
    /// A quantity is missing or there is one too many.
    #[error("[columns]: {0}")]
    Quantity(&'static str),
    /// A unit that the quantity does not have.
    #[error(
        "[columns] {quantity}: unit \"{unit}\" is none of {known}; for another unit give factor = what one of it is in {first}"
    )]
    Unit {
        /// Quantity.
        quantity: &'static str,
        /// What stands there.
        unit: String,
        /// The quantity's units.
        known: String,
        /// The SI unit.
        first: &'static str,
    },
    /// A factor beside a unit that has its own.
    #[error(
        "[columns] {quantity}: \"{unit}\" needs no factor; leave it out, give the unit that the column really has, or factor = -1 to turn the sign"
    )]
    Superfluous {
        /// Quantity.
        quantity: &'static str,
        /// What stands there.
        unit: String,
    },
    /// A factor that is no number to multiply with.
    #[error("[columns] {quantity}: factor = {factor} must be a finite number other than 0")]
    Factor {
        /// Quantity.
        quantity: &'static str,
        /// What stands there.
        factor: f64,
    },
}

/// Quantities with their units, SI first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Time.
    Time,
    /// Position.
    Position,
    /// Velocity.
    Velocity,
    /// Force.
    Force,
    /// Normal load of a contact.
    Load,
    /// Load of a balance.
    ExternalLoad,
    /// Predicted force.
    Predicted,
    /// Voltage.
    Voltage,
    /// Duty.
    Duty,
    /// Supply.
    Supply,
    /// Connected.
    Connected,
}

impl Quantity {
    /// Key in the model file.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Time => "time",
            Self::Position => "position",
            Self::Velocity => "velocity",
            Self::Force => "force",
            Self::Load | Self::ExternalLoad => "load",
            Self::Predicted => "predicted",
            Self::Voltage => "voltage",
            Self::Duty => "duty",
            Self::Supply => "supply",
            Self::Connected => "connected",
        }
    }

    /// Units of the quantity along such a path with what one of each is in SI units, SI first.
    #[must_use]
    pub fn units(self, path: Path) -> &'static [(&'static str, f64)] {
        match (self, path) {
            (Self::Time, _) => &[("s", 1.0), ("ms", 1e-3), ("min", 60.0)],
            (Self::Voltage | Self::Supply, _) => &[("V", 1.0), ("mV", 1e-3)],
            (Self::Duty, _) => &[("1", 1.0), ("%", 0.01)],
            (Self::Connected, _) => &[("1", 1.0)],
            (Self::Position, Path::Line) => &[("m", 1.0), ("mm", 1e-3), ("um", 1e-6)],
            (Self::Position, Path::Turn) => &[("rad", 1.0), ("deg", TAU / 360.0), ("rev", TAU)],
            (Self::Velocity, Path::Line) => &[("m/s", 1.0), ("mm/s", 1e-3)],
            (Self::Velocity, Path::Turn) => {
                &[("rad/s", 1.0), ("deg/s", TAU / 360.0), ("rpm", TAU / 60.0)]
            }
            (Self::Force | Self::Predicted | Self::ExternalLoad, Path::Turn) => {
                &[("N m", 1.0), ("mN m", 1e-3), ("kN m", 1e3)]
            }
            (Self::Force | Self::Predicted | Self::ExternalLoad, Path::Line) | (Self::Load, _) => {
                &[("N", 1.0), ("kN", 1e3)]
            }
        }
    }
}

impl Column {
    /// What one of the column's unit is in SI units.
    ///
    /// # Errors
    /// [`ColumnError`] where the unit is none of the quantity's and no factor is given, or the factor is superfluous.
    pub fn factor(&self, quantity: Quantity, path: Path) -> Result<f64, ColumnError> {
        let units = quantity.units(path);
        let known = units
            .iter()
            .find(|(unit, _)| plain(unit) == plain(&self.unit));
        match (known, self.factor) {
            (Some((_, factor)), None) => Ok(*factor),
            (Some((_, factor)), Some(-1.0)) => Ok(-factor),
            (Some(_), Some(_)) => Err(ColumnError::Superfluous {
                quantity: quantity.word(),
                unit: self.unit.clone(),
            }),
            (None, Some(factor)) if factor.is_finite() && factor != 0.0 => Ok(factor),
            (None, Some(factor)) => Err(ColumnError::Factor {
                quantity: quantity.word(),
                factor,
            }),
            (None, None) => Err(ColumnError::Unit {
                quantity: quantity.word(),
                unit: self.unit.clone(),
                known: units
                    .iter()
                    .map(|(unit, _)| *unit)
                    .collect::<Vec<_>>()
                    .join(", "),
                first: units[0].0,
            }),
        }
    }
}

impl Columns {
    /// Checks that a plant of this kind has what it needs, in units that are known.
    ///
    /// # Errors
    /// [`ColumnError`], saying what would be right.
    pub fn check(&self, kind: Kind, path: Path) -> Result<(), ColumnError> {
        let named = |column: &Option<Column>| column.as_ref().map(|own| own.column.clone());
        let missing = match kind {
            Kind::Drive if self.position.is_none() => Some("a drive needs position and force"),
            Kind::Drive if self.force.is_none() => Some("a drive needs the force that drives it"),
            Kind::Pendulum if self.position.is_none() => {
                Some("a pendulum needs position, its angle")
            }
            Kind::Pendulum if self.force.is_some() => {
                Some("a pendulum that swings freely has no force; leave the line out")
            }
            Kind::Contact if self.force.is_none() => Some("a contact needs force, its torque"),
            Kind::Contact if self.velocity.is_none() && self.position.is_none() => {
                Some("a contact needs velocity or position")
            }
            Kind::Balance if self.force.is_none() || self.predicted.is_none() => Some(
                "a balance needs force, as it was measured, and predicted, what the model says",
            ),
            Kind::Balance if self.velocity.is_none() && self.position.is_none() => {
                Some("a balance needs velocity or position")
            }
            Kind::Balance if named(&self.force) == named(&self.predicted) => {
                Some("force and predicted are the same column; a balance compares two")
            }
            Kind::Fmu if self.velocity.is_none() && self.position.is_none() => {
                Some("an FMU is compared by its motion: name velocity or position")
            }
            Kind::Fmu if self.force.is_some() => Some(
                "what drives an FMU stands in [inputs]; leave the force out, or name the input that it is",
            ),
            Kind::Joint if self.position.is_none() => Some("a joint needs position, its angle"),
            Kind::Joint if self.force.is_some() => Some(
                "a joint is driven by a voltage; leave the force out, or call the plant a balance",
            ),
            Kind::Joint if self.voltage.is_some() == self.duty.is_some() => Some(
                "a joint needs its motor's voltage, or duty and supply, of which it is the product; one of both",
            ),
            Kind::Joint if self.duty.is_some() != self.supply.is_some() => {
                Some("duty and supply belong together; the motor's voltage is their product")
            }
            _ if kind != Kind::Joint && self.has_motor() => {
                Some("voltage, duty, supply and connected belong to a joint alone; leave them out")
            }
            _ if self.predicted.is_some() && kind != Kind::Balance => {
                Some("predicted belongs to a balance alone; leave the line out")
            }
            Kind::Fmu if self.load.is_some() => Some(
                "the load of an FMU is a variable of its own; leave the line out and name the variable in [port], as load",
            ),
            Kind::Drive | Kind::Pendulum | Kind::Joint if self.load.is_some() => {
                Some("load belongs to a contact or a balance; leave the line out")
            }
            _ => None,
        };
        if let Some(what) = missing {
            return Err(ColumnError::Quantity(what));
        }
        for (quantity, column) in self.given(kind) {
            column.factor(quantity, path)?;
        }
        Ok(())
    }

    fn has_motor(&self) -> bool {
        let columns = [&self.voltage, &self.duty, &self.supply, &self.connected];
        columns.iter().any(|column| column.is_some())
    }

    /// All columns of a plant of this kind that are named.
    pub fn given(&self, kind: Kind) -> impl Iterator<Item = (Quantity, &Column)> {
        let load = match kind {
            Kind::Contact => Quantity::Load,
            _ => Quantity::ExternalLoad,
        };
        let optional = [
            (Quantity::Position, &self.position),
            (Quantity::Velocity, &self.velocity),
            (Quantity::Force, &self.force),
            (load, &self.load),
            (Quantity::Predicted, &self.predicted),
            (Quantity::Voltage, &self.voltage),
            (Quantity::Duty, &self.duty),
            (Quantity::Supply, &self.supply),
            (Quantity::Connected, &self.connected),
        ];
        std::iter::once((Quantity::Time, &self.time)).chain(
            optional
                .into_iter()
                .filter_map(|(quantity, column)| column.as_ref().map(|column| (quantity, column))),
        )
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::{Column, Quantity};
    use stickslip::body::Path;

    #[test]
    fn units_are_free_in_spelling_and_a_sign_can_be_turned() {
        let factor = |unit: &str, factor: Option<f64>| {
            let column = Column {
                column: "torque".to_owned(),
                unit: unit.to_owned(),
                factor,
            };
            column.factor(Quantity::Force, Path::Turn)
        };
        for unit in ["N m", "N.m", "Nm", "N·m"] {
            assert_eq!(factor(unit, None).unwrap(), 1.0);
        }
        assert_eq!(factor("mNm", Some(-1.0)).unwrap(), -1e-3);
        assert!(factor("Nm", Some(2.0)).is_err());
        assert!(factor("N", None).is_err());
    }
}
