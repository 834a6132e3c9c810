//! Before and after on a record that was not learned from, natively and through the built FMUs.
//!
//! The window error is the root mean square, over all samples and channels of the restarted windows, of model minus
//! reading in units of the sensors' deviations. Its floor is what the right model would show: sensor noise, less what the
//! windows' starts absorb, plus the random friction seen in the records. The share closed is
//! (before² − after²)/(before² − floor²).

use std::path::{Path, PathBuf};

use build_fmu::build::{BuildError, Source};
use build_fmu::library::Library;
use build_fmu::platform::FmiVersion;
use inference::data::Data;
use inference::marginal::Disturbance;
use inference::record::{CHANNELS, RawRecord, channel};
use inference::window::Begin;
use stickslip::parameter::ParameterError;
use stickslip::plant::{ModelFile, Rig, RigState};
use thiserror::Error;

use super::case::{Case, Judging};
use super::gap::{FreeRun, Gap, Measures, ThroughFmu, WindowError};
use super::restart::{Starts, WindowCourse, best_starts, course, window_courses};
use crate::analysis::measures::{
    amplitude_pulse_level, pearson_correlation, root_mean_square_error,
};
use crate::component::{Component, ComponentError, Native, open};

/// How many standard deviations of the floor's scatter the error before must be above it for a gap to be there at all.
const GAP_SIGNIFICANCE: f64 = 4.0;

/// Fluctuation of the friction, relative to it, below which it counts as an error of the model and not as noise: so small a
/// one can stand in for anything.
pub const LEAST_FLUCTUATION: f64 = 0.015;

/// Why nothing can be shown.
#[derive(Debug, Error)]
pub enum ShowError {
    /// A model or FMU refused something.
    #[error(transparent)]
    Component(#[from] ComponentError),
    /// An FMU could not be built.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// A number of a model leaves its range in the plant's units.
    #[error("in the plant's own units: {0}")]
    Units(#[from] ParameterError),
    /// A directory for the FMUs could not be made.
    #[error("no directory for the FMUs: {0}")]
    Directory(std::io::Error),
    /// No window of the held-out record could be run through.
    #[error("neither model can run through any window of the held-out record")]
    NoWindow,
}

/// One model on the held-out record.
pub struct Shown {
    /// Each window from its best start.
    pub windows: Vec<Option<WindowCourse>>,
    /// The channels of one run over the longest stretch, SI units; empty where the model cannot run through.
    pub free_run: [Vec<f64>; CHANNELS],
    /// Its friction torque [N m].
    pub friction: Vec<f64>,
}

/// Both models on the held-out record.
pub struct Comparison {
    /// The figures.
    pub gap: Gap,
    /// The held-out record in windows.
    pub judging: Judging,
    /// The stretch over which the free run goes.
    pub free_stretch: usize,
    /// The analyst's model.
    pub before: Shown,
    /// The amended model.
    pub after: Shown,
}

/// Compares the analyst's and the amended model on the case's held-out record; `work` is an existing directory in which
/// FMUs may be built.
///
/// # Errors
/// [`ShowError`] where a model cannot run at all or its FMU cannot be built.
pub fn compare(
    case: &Case,
    amended: &ModelFile,
    amended_text: &str,
    disturbance: &Disturbance,
    library: &Library,
    work: &Path,
) -> Result<Comparison, ShowError> {
    let judging = judging(case, &amended.rig)?;
    let (data, units) = (&judging.data, &judging.units);
    let mut native_before = Native::from_text(&case.model_text, "the analyst's model")?;
    let mut native_after = Native::from_text(amended_text, "the amended model")?;
    let before = restarted(&judging, &case.model.rig, &mut native_before)?;
    let after = restarted(&judging, &amended.rig, &mut native_after)?;
    let (windows_before, windows_after) = (before.windows, after.windows);
    let both = in_both(&windows_before, &windows_after);
    let used = both.iter().filter(|used| **used).count();
    if used == 0 {
        return Err(ShowError::NoWindow);
    }
    let noise = if disturbance.relative < LEAST_FLUCTUATION {
        Disturbance::NONE
    } else {
        *disturbance
    };
    let floor = floor(&after.starts, data, &noise, &windows_after, &both);
    let error = |windows: &[Option<WindowCourse>]| root_mean_square(windows, &both);
    let held_out = window_error(error(&windows_before), error(&windows_after), floor);

    let free_stretch = longest(&judging.records);
    let run = &judging.records[free_stretch];
    let begin = units.state_to_si(&first_state(data, free_stretch));
    let fmus = built([&case.model_text, amended_text], library, work)?;
    let through = |fmu: &Path, starts: &[RigState<f64>], delay: f64| {
        let mut fmu = open(fmu)?;
        let courses = window_courses(fmu.as_mut(), &judging, starts, delay)?;
        Ok::<_, ShowError>((error(&courses), fmu))
    };
    let [fmi3_before, fmi2_before, fmi3_after, fmi2_after] = &fmus;
    let delays = [&case.model.rig, &amended.rig].map(delay);
    let (error3_before, _) = through(fmi3_before, &before.set, delays[0])?;
    let (error2_before, _) = through(fmi2_before, &before.set, delays[0])?;
    let (error3_after, mut fmu) = through(fmi3_after, &after.set, delays[1])?;
    let (error2_after, _) = through(fmi2_after, &after.set, delays[1])?;
    let (free_through_fmu, _) = free(fmu.as_mut(), run, &begin);
    let reference_speed = mean_speed(run);
    let (free_before, friction_before) = free(&mut native_before, run, &begin);
    let (free_after, friction_after) = free(&mut native_after, run, &begin);
    let gap = Gap {
        held_out,
        free_run: FreeRun {
            before: measures(&free_before, run, reference_speed),
            after: measures(&free_after, run, reference_speed),
            after_through_fmu: measures(&free_through_fmu, run, reference_speed),
            reference_speed,
        },
        through_fmu: ThroughFmu {
            fmi3: window_error(error3_before, error3_after, floor),
            fmi2_before: error2_before,
            fmi2_after: error2_after,
        },
        windows: both.len(),
        windows_left_aside: both.len() - used,
    };
    Ok(Comparison {
        gap,
        free_stretch,
        before: Shown {
            windows: windows_before,
            free_run: free_before,
            friction: friction_before,
        },
        after: Shown {
            windows: windows_after,
            free_run: free_after,
            friction: friction_after,
        },
        judging,
    })
}

/// The held-out record in windows from which the analyst's model and the amended one can both start.
fn judging(case: &Case, amended: &Rig<f64>) -> Result<Judging, ParameterError> {
    let branches = case.model.rig.law.has_branches() || amended.law.has_branches();
    case.judging(if branches {
        Begin::SpeedingUp
    } else {
        Begin::Clear
    })
}

/// A model on the held-out record in windows, each from its best start.
struct Restarted {
    starts: Starts,
    /// The starts as a component takes them.
    set: Vec<RigState<f64>>,
    windows: Vec<Option<WindowCourse>>,
}

fn restarted(
    judging: &Judging,
    rig: &Rig<f64>,
    native: &mut Native,
) -> Result<Restarted, ShowError> {
    let plant = judging.units.to_plant(rig)?;
    let starts = best_starts(&judging.data, &plant);
    let set = starts.to_set(&plant, &judging.units);
    let windows = window_courses(native, judging, &set, delay(rig))?;
    Ok(Restarted {
        starts,
        set,
        windows,
    })
}

/// Which windows both of two models could run through.
fn in_both(one: &[Option<WindowCourse>], other: &[Option<WindowCourse>]) -> Vec<bool> {
    let pairs = one.iter().zip(other);
    pairs.map(|(a, b)| a.is_some() && b.is_some()).collect()
}

/// Whether `rig` predicts the held-out record, in windows, worse than the analyst's model.
///
/// # Errors
/// A number of a model leaves its range, or a model cannot run at all.
pub fn is_worse(case: &Case, rig: &Rig<f64>) -> Result<bool, ShowError> {
    let judging = judging(case, rig)?;
    let windows = |rig: &Rig<f64>| {
        let mut native = Native::from_text(&rig.to_toml(), "a model")?;
        restarted(&judging, rig, &mut native).map(|restarted| restarted.windows)
    };
    let (before, after) = (windows(&case.model.rig)?, windows(rig)?);
    let both = in_both(&before, &after);
    let lost = before
        .iter()
        .zip(&after)
        .any(|(b, a)| b.is_some() && a.is_none());
    Ok(lost || root_mean_square(&after, &both) > root_mean_square(&before, &both))
}

/// Delay of the disc's sensors [s].
pub(crate) fn delay(rig: &Rig<f64>) -> f64 {
    rig.effects.sensor_delay.map_or(0.0, |effect| effect.delay)
}

/// FMUs of two models in folders of their own below `work`: of the first in FMI 3 and FMI 2, then of the second.
fn built(
    [first, second]: [&str; 2],
    library: &Library,
    work: &Path,
) -> Result<[PathBuf; 4], ShowError> {
    let build = |folder: &str, text: &str, version: FmiVersion| {
        let folder = work.join(folder);
        std::fs::create_dir_all(&folder).map_err(ShowError::Directory)?;
        let source = Source::from_text(text.to_owned(), "model")?;
        let fmu = source.build(std::slice::from_ref(library), version, &folder)?;
        Ok::<_, ShowError>(fmu.path)
    };
    let both = |folder: &str, text: &str| {
        rayon::join(
            || build(folder, text, FmiVersion::Fmi3),
            || build(folder, text, FmiVersion::Fmi2),
        )
    };
    let (before, after) = rayon::join(|| both("before", first), || both("after", second));
    Ok([before.0?, before.1?, after.0?, after.1?])
}

/// Root mean square over the windows that count; NaN where one of them could not be run.
pub(crate) fn root_mean_square(windows: &[Option<WindowCourse>], counts: &[bool]) -> f64 {
    let (mut square, mut residuals) = (0.0, 0);
    for (window, _) in windows.iter().zip(counts).filter(|(_, counts)| **counts) {
        let Some(window) = window else {
            return f64::NAN;
        };
        square += window.square;
        residuals += window.residuals;
    }
    (square / residuals as f64).sqrt()
}

fn floor(
    starts: &Starts,
    data: &Data,
    disturbance: &Disturbance,
    windows: &[Option<WindowCourse>],
    counts: &[bool],
) -> f64 {
    let (mut square, mut residuals) = (0.0, 0.0);
    for (((floor, gram), window), _) in starts
        .floors(data, disturbance)
        .iter()
        .zip(&starts.grams)
        .zip(windows)
        .zip(counts)
        .filter(|(_, counts)| **counts)
    {
        if let (Some(floor), Some(gram), Some(window)) = (floor, gram, window) {
            // A delay leaves a few readings out.
            square += floor * window.residuals as f64 / gram.residuals as f64;
            residuals += window.residuals as f64;
        }
    }
    (square / residuals).sqrt()
}

fn window_error(before: f64, after: f64, noise_floor: f64) -> WindowError {
    let gap = before.powi(2) - noise_floor.powi(2);
    // Unless the error before is above the floor by a few parts in a hundred there is nothing to close.
    let scatter = 0.01 * noise_floor.powi(2);
    let closed = (gap > GAP_SIGNIFICANCE * scatter).then(|| (before.powi(2) - after.powi(2)) / gap);
    WindowError {
        before,
        after,
        noise_floor,
        closed,
    }
}

fn longest(records: &[RawRecord]) -> usize {
    (0..records.len())
        .max_by_key(|&at| records[at].time.len())
        .unwrap_or(0)
}

/// State at the first sample of a stretch as measured, in the plant's units.
pub(crate) fn first_state(data: &Data, run: usize) -> RigState<f64> {
    data.windows
        .iter()
        .find(|window| window.run == run && window.first == 0)
        .map_or([0.0; stickslip::plant::STATES], |window| window.anchor)
}

/// A run over all of a stretch; empty where the component stops on the way.
fn free(
    component: &mut dyn Component,
    run: &RawRecord,
    begin: &RigState<f64>,
) -> ([Vec<f64>; CHANNELS], Vec<f64>) {
    course(component, run, 0, run.time.len() - 1, begin).unwrap_or_default()
}

/// Mean speed [rad/s] by the first that was measured of the gearbox output's velocity, its angle, and the disc's.
fn mean_speed(run: &RawRecord) -> f64 {
    let time = run.time.last().copied().unwrap_or(0.0) - run.time[0];
    let by_velocity = |c: usize| {
        let readings = &run.readings[c];
        let sum: f64 = readings.iter().map(|speed| speed.abs()).sum();
        (!readings.is_empty()).then(|| sum / readings.len() as f64)
    };
    let by_angle = |c: usize| {
        let (first, last) = (run.readings[c].first()?, run.readings[c].last()?);
        Some((last - first).abs() / time)
    };
    by_velocity(channel::OMEGA3)
        .or_else(|| by_angle(channel::THETA3))
        .or_else(|| by_velocity(channel::OMEGA))
        .or_else(|| by_angle(channel::THETA))
        .unwrap_or(0.0)
}

fn measures(model: &[Vec<f64>; CHANNELS], run: &RawRecord, reference_speed: f64) -> Measures {
    let (model, measured) = (&model[channel::OMEGA], &run.readings[channel::OMEGA]);
    let finite = |value: f64| value.is_finite().then_some(value);
    if model.is_empty() || measured.is_empty() {
        return Measures {
            rmse: None,
            nrmse: None,
            pc: None,
            apl: None,
        };
    }
    let rmse = root_mean_square_error(model, measured);
    Measures {
        rmse: finite(rmse),
        nrmse: finite(rmse / reference_speed),
        pc: finite(pearson_correlation(model, measured)),
        apl: finite(amplitude_pulse_level(model, measured)),
    }
}
