//! `finding.json`: what a diagnosis found, as it is written and read.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use inference::learned::TableEffect;
use inference::sets::Verdict;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use stickslip::plant::Port;
use thiserror::Error;

use super::gap::Gap;
use crate::files::atomic::{self, WriteError};

/// Name of the file in the output directory.
pub const FILE: &str = "finding.json";

/// What a diagnosis comes to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum VerdictName {
    /// The model explains the records.
    NothingMissing,
    /// Other nominal parameters explain the records; no effect is missing.
    Parameters,
    /// The effects named are missing.
    Named,
    /// One of several effects is missing; these records cannot tell which.
    Ambiguous,
    /// Something is missing that no effect of the catalogue explains.
    NotInCatalogue,
    /// Where model and records disagree was looked at; what is missing was not.
    Located,
}

impl VerdictName {
    /// The verdict as written in the file.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::NothingMissing => "nothing_missing",
            Self::Parameters => "parameters",
            Self::Named => "named",
            Self::Ambiguous => "ambiguous",
            Self::NotInCatalogue => "not_in_catalogue",
            Self::Located => "located",
        }
    }
}

impl From<Verdict> for VerdictName {
    fn from(verdict: Verdict) -> Self {
        match verdict {
            Verdict::NothingMissing => Self::NothingMissing,
            Verdict::Parameters => Self::Parameters,
            Verdict::Named => Self::Named,
            Verdict::Ambiguous => Self::Ambiguous,
            Verdict::NotInCatalogue => Self::NotInCatalogue,
        }
    }
}

/// All that was found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    /// What it comes to.
    pub verdict: VerdictName,
    /// What was added to the model, strongest first.
    pub effects: Vec<FoundEffect>,
    /// Names of effects that these records cannot tell apart from those added.
    pub alternatives: Vec<String>,
    /// An experiment that would tell the alternatives apart.
    pub experiment: Option<Experiment>,
    /// Every set of effects that was fitted, best first.
    pub ranking: Vec<Ranked>,
    /// Coordinates over which the analyst's model leaves structure, strongest first.
    #[serde(rename = "where")]
    pub structure: Vec<Disagreement>,
    /// Coordinates over which the amended model still does, strongest first.
    pub structure_left: Vec<Disagreement>,
    /// Whether what was found explains the records; absent where no search was made.
    #[serde(default)]
    pub check: Option<CheckResult>,
    /// The function that stands for what no effect of the catalogue explains, in the amended model; absent where none does.
    #[serde(default)]
    pub learned: Option<LearnedTerm>,
    /// Refitted nominal parameters by dotted name.
    pub parameters: BTreeMap<String, ParameterValue>,
    /// How much of the held-out record's gap is closed; absent before the stage `show`.
    pub gap: Option<Gap>,
    /// Standard deviation of the random friction seen in the records, relative to the friction torque.
    pub friction_fluctuation: f64,
    /// Names of effects that were taken out of the catalogue.
    pub without: Vec<String>,
    /// What had to be said about the records.
    pub notes: Vec<String>,
    /// Time from reading the files to the finished finding [s].
    pub seconds: f64,
}

/// An effect that was added.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FoundEffect {
    /// Name in the catalogue.
    pub name: String,
    /// What it is.
    #[serde(default)]
    pub description: String,
    /// Posterior probability of the set of effects that it belongs to, 0 … 1; 0 for an effect that a person named.
    pub probability: f64,
    /// Its numbers by their short names.
    pub parameters: BTreeMap<String, ParameterValue>,
}

/// A number with its uncertainty.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ParameterValue {
    /// Value in `unit`.
    pub value: f64,
    /// Interval that covers the number with 95 % probability; absent for a number that was not fitted.
    pub interval95: Option<[f64; 2]>,
    /// Unit.
    pub unit: String,
    /// Dotted name in the model file.
    pub model_parameter: String,
}

/// A function of one coordinate that was learned from the records, and the effect by equation that carries it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LearnedTerm {
    /// Name of the effect in the amended model.
    pub name: String,
    /// Where it acts.
    pub port: String,
    /// What it is a function of.
    pub coordinate: String,
    /// Its equation, in which the function is called `term`.
    pub equation: String,
    /// Unit of the coordinate.
    pub coordinate_unit: String,
    /// Unit of the function.
    pub unit: String,
    /// Period of the coordinate; absent for a coordinate without one.
    pub period: Option<f64>,
    /// Knots, between which the function is a cubic spline.
    pub knots: Vec<f64>,
    /// Values at the knots.
    pub values: Vec<f64>,
    /// Intervals that cover the values with 95 % probability each.
    pub interval95: Vec<[f64; 2]>,
    /// Values of the coordinate for which it holds: beyond them it keeps its last value.
    pub range: [f64; 2],
    /// Gain in log evidence over the analyst's refitted model.
    pub gain: f64,
}

impl LearnedTerm {
    /// The effect that carries it; `None` where its port is none.
    #[must_use]
    pub fn table(&self) -> Option<TableEffect> {
        Some(TableEffect {
            name: self.name.clone(),
            port: Port::ALL
                .into_iter()
                .find(|port| port.name() == self.port)?,
            equation: self.equation.clone(),
            units: [self.coordinate_unit.clone(), self.unit.clone()],
            period: self.period,
            knots: self.knots.clone(),
            values: self.values.clone(),
        })
    }
}

/// A set of effects with what it gains.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Ranked {
    /// Names in the catalogue, joined by ` + `; [`NO_EFFECT`] for the analyst's model.
    pub name: String,
    /// Gain over the analyst's refitted model in ln likelihood on windows it was not fitted to.
    pub gain: f64,
    /// Interval that covers the gain with 95 % probability.
    pub interval95: [f64; 2],
    /// Log evidence with prior odds, less that of the best set; absent for a set that is no answer.
    #[serde(default)]
    pub score: Option<f64>,
    /// Posterior probability of the set, 0 … 1.
    #[serde(default)]
    pub probability: Option<f64>,
    /// Gain of the best set over this one in ln likelihood on windows left out.
    #[serde(default)]
    pub margin: Option<f64>,
    /// Standard error of the margin.
    #[serde(default)]
    pub margin_error: Option<f64>,
}

/// Name of the analyst's model, to which nothing is added, in a ranking.
pub const NO_EFFECT: &str = "no_effect";

/// What is left of the records, compared with what a right model leaves.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CheckResult {
    /// Probability that records of the fitted model itself leave as much structure; `None` where so little is left that nobody has
    /// to ask.
    pub p_value: Option<f64>,
    /// Squared residuals over their number: about 1 where nothing but noise is left.
    pub misfit: f64,
    /// Windows of the records.
    #[serde(default)]
    pub windows: usize,
    /// How many of them the model misses.
    #[serde(default)]
    pub missed_windows: usize,
    /// The most that a free torque over one coordinate gains in log evidence.
    pub structure: f64,
}

/// Structure over one coordinate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Disagreement {
    /// Coordinate, for instance `disc_angle`.
    pub coordinate: String,
    /// Equation whose torque is meant: `disc`, `shaft` or `motor`.
    pub equation: String,
    /// For `frequency`, the band [Hz] that is meant: lowest and highest.
    pub band: Option<[f64; 2]>,
    /// Gain of a free function of the coordinate: in log evidence, for small plants in ln likelihood on windows left out.
    pub gain: f64,
    /// Interval that covers the gain with 95 % probability; absent for a gain in log evidence.
    #[serde(default)]
    pub interval95: Option<[f64; 2]>,
    /// Gain over its standard deviation; absent for a gain in log evidence.
    #[serde(default)]
    pub significance: Option<f64>,
    /// Whether the gain is beyond what chance gives among all coordinates looked at.
    pub significant: bool,
}

/// An experiment that would tell alternatives apart.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Experiment {
    /// File beside the finding: the inputs `u` [V] and `N2` [N] over `time` [s].
    pub file: String,
    /// What it does, in words.
    pub description: String,
    /// Probability that it decides between the alternatives, 0 … 1.
    pub expected_power: f64,
}

/// Why a finding cannot be read.
#[derive(Debug, Error)]
pub enum FindingError {
    /// The file cannot be read.
    #[error(
        "{path}: {source}; run `stickslip name` or `stickslip diagnose` into this directory first"
    )]
    Read {
        /// The file.
        path: String,
        /// The operating system's reason.
        source: std::io::Error,
    },
    /// The file is no finding.
    #[error("{path}: {source}")]
    Syntax {
        /// The file.
        path: String,
        /// What the parser says, with the line.
        source: serde_json::Error,
    },
    /// The file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

/// Reads a finding of any kind from `finding.json` of a directory.
pub(super) fn read<T: DeserializeOwned>(directory: &Path) -> Result<T, FindingError> {
    let path = directory.join(FILE);
    let name = path.display().to_string();
    let text = fs::read_to_string(&path).map_err(|source| FindingError::Read {
        path: name.clone(),
        source,
    })?;
    serde_json::from_str(&text).map_err(|source| FindingError::Syntax { path: name, source })
}

/// Writes a finding of any kind to `finding.json` of a directory, whole or not at all.
pub(super) fn write<T: Serialize>(finding: &T, directory: &Path) -> Result<(), FindingError> {
    let path = directory.join(FILE);
    let mut text =
        serde_json::to_string_pretty(finding).map_err(|source| FindingError::Syntax {
            path: path.display().to_string(),
            source,
        })?;
    text.push('\n');
    Ok(atomic::write_file(&path, text.as_bytes())?)
}

impl Finding {
    /// Reads `finding.json` of a directory.
    ///
    /// # Errors
    /// [`FindingError`], naming the file and what is wrong.
    pub fn read(directory: &Path) -> Result<Self, FindingError> {
        read(directory)
    }

    /// Writes `finding.json` into a directory, whole or not at all.
    ///
    /// # Errors
    /// [`FindingError::Write`] or, for numbers that JSON cannot hold, [`FindingError::Syntax`].
    pub fn write(&self, directory: &Path) -> Result<(), FindingError> {
        write(self, directory)
    }

    /// Whether the model is now right as far as the records tell: nothing missing, or the gap closed.
    #[must_use]
    pub fn is_settled(&self) -> bool {
        match self.verdict {
            VerdictName::NothingMissing => true,
            VerdictName::NotInCatalogue => false,
            VerdictName::Parameters
            | VerdictName::Named
            | VerdictName::Ambiguous
            | VerdictName::Located => self
                .gap
                .as_ref()
                .is_none_or(|gap| gap.through_fmu.fmi3.is_closed()),
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::diagnose::gap::{FreeRun, Measures, ThroughFmu, WindowError};

    pub(in super::super) fn finding() -> Finding {
        let errors = WindowError {
            before: 5.0,
            after: 1.1,
            noise_floor: 1.0,
            closed: Some(0.99125),
        };
        let measures = Measures {
            rmse: Some(0.5),
            nrmse: Some(0.1),
            pc: None,
            apl: Some(0.2),
        };
        Finding {
            verdict: VerdictName::Named,
            effects: vec![FoundEffect {
                name: "unbalance".into(),
                description: "a disc whose centre of mass is off the axis".into(),
                probability: 0.99,
                parameters: BTreeMap::from([(
                    "unbal_T".into(),
                    ParameterValue {
                        value: 0.04,
                        interval95: Some([0.039, 0.041]),
                        unit: "N.m".into(),
                        model_parameter: "unbalance.torque".into(),
                    },
                )]),
            }],
            alternatives: vec![],
            experiment: None,
            ranking: vec![],
            structure: vec![],
            structure_left: vec![],
            check: None,
            learned: None,
            parameters: BTreeMap::new(),
            gap: Some(Gap {
                held_out: errors,
                free_run: FreeRun {
                    before: measures,
                    after: measures,
                    after_through_fmu: measures,
                    reference_speed: 5.0,
                },
                through_fmu: ThroughFmu {
                    fmi3: errors,
                    fmi2_before: 5.0,
                    fmi2_after: 1.1,
                },
                windows: 80,
                windows_left_aside: 0,
            }),
            friction_fluctuation: 0.0,
            without: vec![],
            notes: vec![],
            seconds: 1.0,
        }
    }

    #[test]
    fn the_file_has_the_names_that_readers_expect_and_survives() {
        let place = tempfile::tempdir().unwrap();
        finding().write(place.path()).unwrap();
        assert_eq!(Finding::read(place.path()).unwrap(), finding());
        let text = fs::read_to_string(place.path().join(FILE)).unwrap();
        let json: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert_eq!(json["verdict"], "named");
        assert_eq!(json["effects"][0]["parameters"]["unbal_T"]["value"], 0.04);
        assert_eq!(json["gap"]["through_fmu"]["closed"], 0.99125);
        assert!(json["where"].is_array());
    }

    #[test]
    fn a_ranking_of_an_earlier_version_can_be_read() {
        let old = r#"{"name": "unbalance", "gain": 80.0, "interval95": [70.0, 90.0]}"#;
        let ranked: Ranked = serde_json::from_str(old).unwrap();
        assert_eq!((ranked.gain, ranked.margin), (80.0, None));
    }

    #[test]
    fn settled_is_what_the_exit_code_says() {
        let mut finding = finding();
        assert!(finding.is_settled());
        if let Some(gap) = &mut finding.gap {
            gap.through_fmu.fmi3.closed = Some(0.5);
        }
        assert!(!finding.is_settled());
        finding.verdict = VerdictName::NothingMissing;
        assert!(finding.is_settled());
        finding.verdict = VerdictName::NotInCatalogue;
        assert!(!finding.is_settled());
    }

    #[test]
    fn a_missing_finding_says_what_to_run() {
        let error = Finding::read(Path::new("/nowhere"))
            .unwrap_err()
            .to_string();
        assert!(error.contains("stickslip name"), "{error}");
    }
}
