//! How far an amended model closes the gap to the held-out record, in the terms of `finding.json`.

use serde::{Deserialize, Serialize};

/// Share of the gap from which on it counts as closed: the worst tenth of right amendments is above it.
const CLOSED: f64 = 0.9;

/// How far the held-out record was explained before and after.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Gap {
    /// Restarted windows, the models run natively.
    pub held_out: WindowError,
    /// One run from the record's start.
    pub free_run: FreeRun,
    /// Restarted windows through the built FMUs.
    pub through_fmu: ThroughFmu,
    /// Windows of the record.
    pub windows: usize,
    /// Windows left aside because one of the models could not run through them.
    pub windows_left_aside: usize,
}

/// Error of restarted windows: root mean square of model minus reading in units of the sensors' deviations.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct WindowError {
    /// The analyst's model.
    pub before: f64,
    /// The amended model.
    pub after: f64,
    /// What sensors and random friction alone give.
    pub noise_floor: f64,
    /// (before² − after²)/(before² − noise_floor²); absent where `before` is within the floor's own scatter.
    pub closed: Option<f64>,
}

/// The same through FMUs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ThroughFmu {
    /// Through the FMUs for FMI 3.0.
    #[serde(flatten)]
    pub fmi3: WindowError,
    /// Error of the analyst's model through the FMU for FMI 2.0.
    pub fmi2_before: f64,
    /// Error of the amended model through the FMU for FMI 2.0.
    pub fmi2_after: f64,
}

/// Measures of the free run before and after.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FreeRun {
    /// The analyst's model.
    pub before: Measures,
    /// The amended model.
    pub after: Measures,
    /// The amended model through its FMU for FMI 3.0.
    pub after_through_fmu: Measures,
    /// Mean speed of the gearbox output that `nrmse` is related to [rad/s].
    pub reference_speed: f64,
}

/// The dissertation's measures of the disc's velocity; absent where the series has none.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Measures {
    /// Root mean square error [rad/s].
    pub rmse: Option<f64>,
    /// The same over the reference speed.
    pub nrmse: Option<f64>,
    /// Pearson's correlation.
    pub pc: Option<f64>,
    /// Amplitude pulse level.
    pub apl: Option<f64>,
}

impl WindowError {
    /// Whether the gap is closed, or there was none.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        self.closed.is_none_or(|closed| closed >= CLOSED)
    }
}
