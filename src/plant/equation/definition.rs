//! An effect as its file describes it, without values.

use super::Port;
use crate::expression::{
    Coordinate, Dimension, ExpressionError, Interpolation, Names, Program, Quantity, Table,
    TableError, parse,
};
use crate::parameter::{ParameterInfo, Range, units::UnitError};
use std::sync::{Mutex, OnceLock, PoisonError};
use thiserror::Error;

/// What is wrong with the description of an effect, beyond its form.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum DefinitionError {
    /// The equation.
    #[error("equation = \"{equation}\", {source}")]
    Equation {
        /// Its text.
        equation: String,
        /// What is wrong, and where.
        source: ExpressionError,
    },
    /// A unit of a parameter or a table.
    #[error("{what}: {source}")]
    Unit {
        /// Which.
        what: String,
        /// What is wrong.
        source: UnitError,
    },
    /// Points of a table.
    #[error(transparent)]
    Table(#[from] TableError),
}

/// Points of a table, as the file gives them.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Points {
    pub name: String,
    pub x: Vec<f64>,
    pub y: Vec<f64>,
    pub units: [String; 2],
    pub interpolation: Interpolation,
    pub period: Option<f64>,
}

/// The words and numbers of a description.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Draft {
    pub name: String,
    pub title: String,
    pub port: Port,
    pub equation: String,
    pub source: Option<String>,
    /// Key, unit, range, description.
    pub parameters: Vec<(String, String, Range, String)>,
    pub tables: Vec<Points>,
}

/// An effect that a file describes: one for all rigs that have it.
#[derive(Debug)]
pub struct Definition {
    draft: Draft,
    infos: &'static [ParameterInfo],
    program: Program,
}

impl PartialEq for Definition {
    fn eq(&self, other: &Self) -> bool {
        self.draft == other.draft
    }
}

impl Definition {
    /// The definition that `draft` describes. Equal drafts give the same one, which lives as long as the program: rigs are copied
    /// by the million, and what does not change is shared.
    pub(super) fn of(draft: Draft) -> Result<&'static Self, DefinitionError> {
        static KNOWN: OnceLock<Mutex<Vec<&'static Definition>>> = OnceLock::new();
        let known = KNOWN.get_or_init(|| Mutex::new(Vec::new()));
        let mut known = known.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(found) = known.iter().find(|known| known.draft == draft) {
            return Ok(found);
        }
        let program = program(&draft)?;
        let infos = draft
            .parameters
            .iter()
            .map(|(key, unit, range, description)| ParameterInfo {
                key: key.clone().leak(),
                unit: unit.clone().leak(),
                range: *range,
                description: description.clone().leak(),
                built_in: false,
            })
            .collect::<Vec<_>>()
            .leak();
        let definition: &'static Self = Box::leak(Box::new(Self {
            draft,
            infos,
            program,
        }));
        known.push(definition);
        Ok(definition)
    }

    /// Name, as dotted parameter names and findings spell it.
    pub fn name(&self) -> &str {
        &self.draft.name
    }

    /// One line for people.
    pub fn title(&self) -> &str {
        &self.draft.title
    }

    /// Where it acts.
    pub fn port(&self) -> Port {
        self.draft.port
    }

    /// The equation's text.
    pub fn equation(&self) -> &str {
        &self.draft.equation
    }

    /// Its parameters.
    pub fn infos(&self) -> &'static [ParameterInfo] {
        self.infos
    }

    /// Value of the equation at these coordinates with these parameters, SI units; of a resistance, the voltage that it drops.
    pub fn value(&self, at: impl Fn(Coordinate) -> f64, parameters: &[f64]) -> f64 {
        let coordinates = Coordinate::ALL.map(at);
        let mut branches = vec![0; self.program.sites().len()];
        let mut jet = self.program.new_jet::<f64>();
        self.program
            .branches(&coordinates, parameters, &mut branches, &mut jet);
        jet.value()[0]
    }

    /// Whether the equation depends on this coordinate.
    pub fn uses(&self, coordinate: Coordinate) -> bool {
        self.program.uses(coordinate as usize)
    }

    pub(super) fn draft(&self) -> &Draft {
        &self.draft
    }

    pub(crate) fn program(&self) -> &Program {
        &self.program
    }
}

fn program(draft: &Draft) -> Result<Program, DefinitionError> {
    let dimension = |what: &str, unit: &str| {
        Dimension::of_unit(unit).map_err(|source| DefinitionError::Unit {
            what: what.to_owned(),
            source,
        })
    };
    let mut parameters = Vec::new();
    for (key, unit, range, _) in &draft.parameters {
        parameters.push((key.as_str(), dimension(key, unit)?, *range));
    }
    let mut tables = Vec::new();
    for points in &draft.tables {
        let [x, y] = &points.units;
        let dimensions = (dimension(&points.name, x)?, dimension(&points.name, y)?);
        tables.push(Table::new(
            &points.name,
            dimensions,
            &points.x,
            &points.y,
            points.interpolation,
            points.period,
        )?);
    }
    let unit = draft.port.unit();
    let coordinates: Vec<Quantity> = draft
        .port
        .coordinates()
        .iter()
        .map(|own| own.quantity())
        .collect();
    let names = Names {
        parameters: &parameters,
        coordinates: &coordinates,
        tables: &tables,
        result: (dimension("port", unit)?, unit),
    };
    let equation = |source| DefinitionError::Equation {
        equation: draft.equation.clone(),
        source,
    };
    let program = parse(&draft.equation, &names).map_err(equation)?;
    match draft.port {
        Port::MotorResistance => Ok(program.times_coordinate(Coordinate::Current as usize)),
        Port::DiscFriction | Port::Disc1Friction => program.not_below_zero().map_err(equation),
        _ => Ok(program),
    }
}
