//! Which runs an ensemble is made of.

use std::f64::consts::PI;
use std::path::Path;

use stickslip::parameter::ParameterError;
use stickslip::plant::{ModelFile, Rig, RigInputs};
use thiserror::Error;

use super::bands::at_places;
use super::picture::picture;
use super::result;
use super::uncertain::{self, Uncertain};
use crate::diagnose::uncertainty::UncertaintyError;
use crate::files::table::TableFormat;
use crate::map::settings::{check_numbers, check_quantities, label, run_options};
use crate::map::{Point, Quantity, SettingsError, Span, Study, run_point};

/// Most rigs that one ensemble may draw.
const MOST_RUNS: usize = 1_000_000;

/// Why the runs cannot be made.
#[derive(Debug, Error)]
pub enum EnsembleError {
    /// Model, inputs or lengths are wrong.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// The model file states an uncertainty that cannot be one.
    #[error(transparent)]
    Stated(#[from] UncertaintyError),
    /// A parameter was given twice.
    #[error("--uncertain {name} was given twice")]
    Twice {
        /// Its name.
        name: String,
    },
    /// An uncertainty that was given cannot be one.
    #[error(
        "--uncertain {name}={value}: a number from 0 to below 1 is needed, the standard deviation over the value"
    )]
    Relative {
        /// Name of the parameter.
        name: String,
        /// What was given.
        value: f64,
    },
    /// Nothing is known of a parameter that is to be drawn.
    #[error(
        "{file}: states no relative_uncertainty of {name}; state it there, or give it as --uncertain {name}=0.05"
    )]
    NotStated {
        /// The model file.
        file: String,
        /// Name of the parameter.
        name: String,
    },
    /// Nothing is known of any parameter.
    #[error(
        "{file}: states no relative_uncertainty of any parameter; state them there, or give them as --uncertain contact.mu_s=0.05"
    )]
    NothingStated {
        /// The model file.
        file: String,
    },
    /// The number of runs is no such number.
    #[error("--runs {runs}: a number from 1 to {MOST_RUNS} is needed")]
    Runs {
        /// What was given.
        runs: usize,
    },
    /// The draws contradict themselves.
    #[error(
        "{count} rigs drawn in a row are refused; the uncertainties are too large for this model. The last: {source}"
    )]
    Refused {
        /// How many.
        count: usize,
        /// Why the last was refused.
        source: ParameterError,
    },
}

/// Inputs and lengths of the runs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conditions {
    /// Speeds at the gearbox output that the voltage would give the undisturbed nominal rig [rpm].
    pub speed_rpm: Span,
    /// Normal forces on disc D2 [N].
    pub normal_force: Span,
    /// Normal force on disc D1 [N], for the full rig.
    pub normal_force_1: Option<f64>,
    /// Length of each run [s].
    pub duration: f64,
    /// Local tolerance of the integrator.
    pub tolerance: f64,
}

/// The runs of an ensemble: every rig that was drawn at every place, which is a speed and a normal force.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    model: String,
    text: String,
    nominal: Rig<f64>,
    drawn: Vec<Vec<f64>>,
    conditions: Conditions,
    seed: u64,
    /// The parameters that were drawn, with their uncertainties.
    pub parameters: Vec<Uncertain>,
    /// How many rigs were drawn and refused, since their parameters contradict each other.
    pub refused: usize,
    /// Speeds [rpm].
    pub speeds: Vec<f64>,
    /// Normal forces on disc D2 [N].
    pub forces: Vec<f64>,
    /// As what the tables are written.
    pub tables: TableFormat,
}

impl Settings {
    /// So many runs with this seed of the model in `text`, which messages call `model`; what is drawn are the names of `draw`, or all
    /// whose uncertainty the model states, with those in `given` in place of what it states.
    ///
    /// # Errors
    /// [`EnsembleError`], naming what is wrong and what is right.
    pub fn new(
        text: &str,
        model: &str,
        conditions: &Conditions,
        (runs, seed): (usize, u64),
        (draw, given): (&[String], &[Uncertain]),
    ) -> Result<Self, EnsembleError> {
        let file =
            ModelFile::parse(text, model).map_err(|error| SettingsError::Model(Box::new(error)))?;
        if !(1..=MOST_RUNS).contains(&runs) {
            return Err(EnsembleError::Runs { runs });
        }
        check_numbers(conditions.duration, conditions.tolerance)?;
        let mut spans = vec![
            (Quantity::SpeedRpm, conditions.speed_rpm),
            (Quantity::NormalForce, conditions.normal_force),
        ];
        let force_1 = conditions.normal_force_1.map(Span::one);
        spans.extend(force_1.map(|span| (Quantity::NormalForce1, span)));
        check_quantities(&file.rig, &spans)?;
        let parameters = uncertain::parameters(&file, model, draw, given)?;
        let drawn = uncertain::rigs(&file.rig, &parameters, (runs, seed))?;
        Ok(Self {
            model: model.to_owned(),
            text: text.to_owned(),
            nominal: file.rig,
            drawn: drawn.values,
            conditions: *conditions,
            seed,
            parameters,
            refused: drawn.refused,
            speeds: conditions.speed_rpm.values(),
            forces: conditions.normal_force.values(),
            tables: TableFormat::default(),
        })
    }

    /// A few words for titles.
    #[must_use]
    pub fn title(&self) -> String {
        let fixed = [
            (Quantity::SpeedRpm, &self.speeds),
            (Quantity::NormalForce, &self.forces),
        ];
        let mut text = format!("{}: {} rigs", self.model, self.runs());
        for (quantity, values) in fixed {
            if let [value] = values[..] {
                text.push_str(&format!(", {} = {value}", self.label(&quantity)));
            }
        }
        if let Some(force) = self.conditions.normal_force_1 {
            text.push_str(&format!(
                ", {} = {force}",
                self.label(&Quantity::NormalForce1)
            ));
        }
        text
    }

    /// Label of a quantity's axis.
    #[must_use]
    pub fn label(&self, quantity: &Quantity) -> String {
        label(&self.nominal, quantity)
    }

    /// Number of rigs that were drawn.
    #[must_use]
    pub fn runs(&self) -> usize {
        self.drawn.len()
    }

    /// Number of places.
    #[must_use]
    pub fn places(&self) -> usize {
        self.speeds.len() * self.forces.len()
    }

    /// Length of each run [s].
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.conditions.duration
    }

    /// Speed [rpm] and normal force [N] of a place; the speeds follow one another first.
    #[must_use]
    pub fn place(&self, place: usize) -> (f64, f64) {
        let count = self.speeds.len();
        (self.speeds[place % count], self.forces[place / count])
    }

    /// The drawn parameters of a rig, in the order of [`Self::parameters`].
    #[must_use]
    pub fn sample(&self, run: usize) -> &[f64] {
        &self.drawn[run]
    }
}

impl Study for Settings {
    const JOURNAL: &'static str = "ensemble.journal";
    const OTHER: &'static str = "an ensemble with other settings";
    const ROWS: &'static str = "rigs";
    const FAILED: &'static str = "they count for no probability";

    fn identity(&self) -> String {
        format!(
            "ensemble, version {}; {:?}; runs {}; seed {}; {:?}; model {}",
            env!("CARGO_PKG_VERSION"),
            self.conditions,
            self.runs(),
            self.seed,
            self.parameters,
            self.text
        )
    }

    fn shape(&self) -> (usize, usize) {
        (self.runs(), self.places())
    }

    fn try_run(&self, run: usize, place: usize) -> Result<Point, String> {
        let (speed, force) = self.place(place);
        // Whoever sets the voltage knows the nominal rig, not the drawn one.
        let voltage = self.nominal.voltage_for_speed(speed * PI / 30.0);
        let force_1 = self.conditions.normal_force_1.unwrap_or(0.0);
        let inputs = RigInputs::held(voltage, force, force_1);
        let options = run_options(self.conditions.tolerance);
        let rig = uncertain::with_values(&self.nominal, &self.parameters, self.sample(run))
            .map_err(|error| error.to_string())?;
        run_point(rig, inputs, self.duration(), options, 0).map_err(|error| error.to_string())
    }

    fn write(&self, rows: &[Vec<Point>], out: &Path) -> anyhow::Result<()> {
        let bands = at_places(rows, self.places());
        result::write(self, rows, &bands, out)?;
        Ok(picture(self, rows, &bands).write(&out.join("ensemble"))?)
    }
}
