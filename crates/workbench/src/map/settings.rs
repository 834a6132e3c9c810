//! Which runs a map is made of.

use std::f64::consts::PI;
use std::path::Path;

use stickslip::integrator::Options;
use stickslip::parameter::ParameterError;
use stickslip::plant::{ModelFileError, Rig, RigInputs, RigKind};
use thiserror::Error;

use super::picture::picture;
use super::point::{MOST_EXTREMA, Point, run_point};
use super::result;
use super::span::Span;
use super::study::Study;
use crate::component::closest;

/// Order of the integrator's polynomials: for the tolerances of maps, cheaper than its default.
const ORDER: usize = 16;
/// Segments that one run may take: a hundred times what a run of a minute needs.
const BUDGET: u64 = 200_000;

/// What a map varies.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Quantity {
    /// Speed at the gearbox output that the voltage would give the undisturbed rig [rpm].
    SpeedRpm,
    /// Normal force on disc D2 [N].
    NormalForce,
    /// Normal force on disc D1 [N].
    NormalForce1,
    /// Parameter with this dotted name.
    Parameter(String),
}

impl Quantity {
    /// Name of its column in CSV files.
    #[must_use]
    pub fn name(&self) -> &str {
        match self {
            Self::SpeedRpm => "speed_rpm",
            Self::NormalForce => "normal_force",
            Self::NormalForce1 => "normal_force_1",
            Self::Parameter(name) => name,
        }
    }
}

/// A quantity with the values it takes and the label of its axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Varied {
    /// What varies.
    pub quantity: Quantity,
    /// Its values, in order.
    pub values: Vec<f64>,
    /// Label with unit.
    pub label: String,
}

/// Why the runs cannot be made.
#[derive(Debug, Error)]
pub enum SettingsError {
    /// The model file is wrong.
    #[error("{0}")]
    Model(Box<ModelFileError>),
    /// Not one or two ranges.
    #[error("{found} ranges were given; a map is over one or two, as from:to:count")]
    Ranges {
        /// How many there are.
        found: usize,
    },
    /// A quantity was given twice.
    #[error("{name} was given twice")]
    Twice {
        /// Its name.
        name: String,
    },
    /// No parameter has this name.
    #[error("the model has no parameter `{name}`{hint}")]
    UnknownParameter {
        /// The name.
        name: String,
        /// The nearest name, as half a sentence; may be empty.
        hint: String,
    },
    /// An end of a range is not allowed.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// A force is negative.
    #[error("{name} = {value}: a force of 0 N or more is needed")]
    NegativeForce {
        /// Name of the force.
        name: String,
        /// Its value [N].
        value: f64,
    },
    /// The second force does not fit the rig.
    #[error("{0}")]
    SecondForce(&'static str),
    /// A number that must be positive is not.
    #[error("{name} = {value}: {right} is needed")]
    Number {
        /// Name of the argument.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What is right.
        right: &'static str,
    },
}

/// The runs of a map: a grid of rows and columns. With one range every row has one run.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    rig: Rig<f64>,
    model: String,
    text: String,
    fixed: Vec<(Quantity, f64)>,
    column: Option<Varied>,
    row: Varied,
    /// Length of each run [s].
    pub duration: f64,
    tolerance: f64,
}

impl Settings {
    /// The runs over `spans` of the model in `text`, which messages call `model`; the first range is across, the second
    /// upward.
    ///
    /// # Errors
    /// [`SettingsError`], naming what is wrong and what is right.
    pub fn new(
        text: &str,
        model: &str,
        spans: &[(Quantity, Span)],
        duration: f64,
        tolerance: f64,
    ) -> Result<Self, SettingsError> {
        let rig =
            Rig::from_toml(text, model).map_err(|error| SettingsError::Model(Box::new(error)))?;
        check_numbers(duration, tolerance)?;
        check_quantities(&rig, spans)?;
        let fixed = spans.iter().filter(|(_, span)| !span.varies());
        let fixed = fixed
            .map(|(quantity, span)| (quantity.clone(), span.values()[0]))
            .collect();
        let mut varied: Vec<Varied> = spans
            .iter()
            .filter(|(_, span)| span.varies())
            .map(|(quantity, span)| Varied {
                quantity: quantity.clone(),
                values: span.values(),
                label: label(&rig, quantity),
            })
            .collect();
        let found = varied.len();
        let (Some(row), true) = (varied.pop(), found <= 2) else {
            return Err(SettingsError::Ranges { found });
        };
        Ok(Self {
            rig,
            model: model.to_owned(),
            text: text.to_owned(),
            fixed,
            column: varied.pop(),
            row,
            duration,
            tolerance,
        })
    }

    /// A few words for titles.
    #[must_use]
    pub fn title(&self) -> String {
        let fixed: Vec<String> = self
            .fixed
            .iter()
            .map(|(quantity, value)| format!("{} = {value}", label(&self.rig, quantity)))
            .collect();
        if fixed.is_empty() {
            self.model.clone()
        } else {
            format!("{}: {}", self.model, fixed.join(", "))
        }
    }

    /// What varies along a row; none if one quantity varies.
    #[must_use]
    pub fn column_axis(&self) -> Option<&Varied> {
        self.column.as_ref()
    }

    /// What varies from row to row.
    #[must_use]
    pub fn row_axis(&self) -> &Varied {
        &self.row
    }

    /// Number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.row.values.len()
    }

    /// Number of runs in a row.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.column.as_ref().map_or(1, |column| column.values.len())
    }

    /// Number of runs.
    #[must_use]
    pub fn points(&self) -> usize {
        self.rows() * self.columns()
    }

    /// How the runs are integrated.
    #[must_use]
    pub fn options(&self) -> Options {
        run_options(self.tolerance)
    }

    /// Rig and inputs of one run.
    ///
    /// # Errors
    /// Parameters that contradict each other.
    pub fn conditions(
        &self,
        row: usize,
        column: usize,
    ) -> Result<(Rig<f64>, RigInputs<f64>), ParameterError> {
        let across = self
            .column
            .iter()
            .map(|varied| (&varied.quantity, varied.values[column]));
        let upward = (&self.row.quantity, self.row.values[row]);
        let fixed = self
            .fixed
            .iter()
            .map(|(quantity, value)| (quantity, *value));
        let mut rig = self.rig;
        let (mut speed, mut force, mut force_1) = (0.0, 0.0, 0.0);
        for (quantity, value) in fixed.chain(across).chain([upward]) {
            match quantity {
                Quantity::SpeedRpm => speed = value * PI / 30.0,
                Quantity::NormalForce => force = value,
                Quantity::NormalForce1 => force_1 = value,
                Quantity::Parameter(name) => rig.set_parameter(name, value)?,
            }
        }
        rig.check()?;
        Ok((
            rig,
            RigInputs::held(rig.voltage_for_speed(speed), force, force_1),
        ))
    }
}

impl Study for Settings {
    const JOURNAL: &'static str = "map.journal";
    const OTHER: &'static str = "a map with other settings";
    const ROWS: &'static str = "rows";
    const FAILED: &'static str = "in map.csv their motion is `failed`";

    fn identity(&self) -> String {
        format!(
            "version {}; {:?}; {:?}; {:?}; duration {:?}; tolerance {:?}; model {}",
            env!("CARGO_PKG_VERSION"),
            self.column,
            self.row,
            self.fixed,
            self.duration,
            self.tolerance,
            self.text
        )
    }

    fn shape(&self) -> (usize, usize) {
        (self.rows(), self.columns())
    }

    fn try_run(&self, row: usize, column: usize) -> Result<Point, String> {
        // Only a bifurcation diagram shows them.
        let extrema = if self.column.is_none() {
            MOST_EXTREMA
        } else {
            0
        };
        let (rig, inputs) = self
            .conditions(row, column)
            .map_err(|error| error.to_string())?;
        run_point(rig, inputs, self.duration, self.options(), extrema)
            .map_err(|error| error.to_string())
    }

    fn write(&self, rows: &[Vec<Point>], out: &Path) -> anyhow::Result<()> {
        result::write(self, rows, out)?;
        Ok(picture(self, rows)?.write(&out.join("map"))?)
    }
}

/// How runs of which thousands are wanted are integrated.
#[must_use]
pub(crate) fn run_options(tolerance: f64) -> Options {
    Options {
        tolerance,
        order: ORDER,
        budget: BUDGET,
        ..Options::default()
    }
}

/// Checks the length of a run [s] and the integrator's tolerance.
pub(crate) fn check_numbers(duration: f64, tolerance: f64) -> Result<(), SettingsError> {
    if !(duration.is_finite() && duration > 0.0) {
        return Err(SettingsError::Number {
            name: "--duration",
            value: duration,
            right: "a positive number of seconds",
        });
    }
    if !(1e-14..=1e-3).contains(&tolerance) {
        return Err(SettingsError::Number {
            name: "--tolerance",
            value: tolerance,
            right: "a number from 1e-14 to 1e-3",
        });
    }
    Ok(())
}

/// The error of a name that no parameter of the rig has.
pub(crate) fn unknown_parameter(rig: &Rig<f64>, name: &str) -> SettingsError {
    let names: Vec<String> = rig
        .parameters()
        .into_iter()
        .map(|parameter| parameter.name)
        .collect();
    let hint = closest(name, names.iter().map(String::as_str))
        .map(|near| format!("; did you mean `{near}`?"))
        .unwrap_or_default();
    SettingsError::UnknownParameter {
        name: name.to_owned(),
        hint,
    }
}

/// Checks that a rig can take these values of its inputs and parameters.
pub(crate) fn check_quantities(
    rig: &Rig<f64>,
    spans: &[(Quantity, Span)],
) -> Result<(), SettingsError> {
    for (index, (quantity, span)) in spans.iter().enumerate() {
        let name = quantity.name().to_owned();
        if spans[..index].iter().any(|(other, _)| other == quantity) {
            return Err(SettingsError::Twice { name });
        }
        for value in span.values() {
            match quantity {
                Quantity::SpeedRpm => {}
                Quantity::NormalForce | Quantity::NormalForce1 if value >= 0.0 => {}
                Quantity::NormalForce | Quantity::NormalForce1 => {
                    return Err(SettingsError::NegativeForce { name, value });
                }
                Quantity::Parameter(parameter) if rig.position(parameter).is_none() => {
                    return Err(unknown_parameter(rig, parameter));
                }
                Quantity::Parameter(parameter) => {
                    let mut trial = *rig;
                    trial.set_parameter(parameter, value)?;
                }
            }
        }
    }
    let second = spans
        .iter()
        .any(|(quantity, _)| *quantity == Quantity::NormalForce1);
    match (rig.kind(), second) {
        (RigKind::Full, false) => Err(SettingsError::SecondForce(
            "this is the full rig: --normal-force-1 is needed too",
        )),
        (RigKind::Reduced, true) => Err(SettingsError::SecondForce(
            "--normal-force-1: this rig has no disc D1",
        )),
        _ => Ok(()),
    }
}

/// Label of a quantity's axis.
pub(crate) fn label(rig: &Rig<f64>, quantity: &Quantity) -> String {
    match quantity {
        Quantity::SpeedRpm => "speed [rpm]".to_owned(),
        Quantity::NormalForce => "normal force N₂ [N]".to_owned(),
        Quantity::NormalForce1 => "normal force N₁ [N]".to_owned(),
        Quantity::Parameter(name) => {
            let parameter = rig
                .parameters()
                .into_iter()
                .find(|parameter| parameter.name == *name);
            format!(
                "{name} [{}]",
                parameter.map_or("", |parameter| parameter.info.unit)
            )
        }
    }
}
