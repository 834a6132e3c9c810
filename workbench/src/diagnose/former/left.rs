//! Whether a model leaves more of the records than it would if it were right.

use super::data::Data;
use super::fit::Fit;
use super::rehearsal::rehearse;
use super::search::LITTLE_ROUGHNESS;
use super::structure::{Structure, structures};

/// Gain of a residual torque over one coordinate from which on structure is left.
pub const STRUCTURE_GAIN: f64 = 30.0;
/// Share of what the effects explain below which structure does not count: so exactly nothing is modelled or measured.
/// Effects that stand in for the right one leave four times as much or more.
const STRUCTURE_SHARE: f64 = 2e-4;
/// Misfit per residual above which something is left whatever its structure.
const MISFIT: f64 = 1.25;
/// Relative friction disturbance above which it no longer passes for roughness.
pub const ROUGHNESS: f64 = 0.06;
/// Multiple of the structure that the model itself leaves in a rehearsal beyond which structure counts.
const CHANCE: f64 = 2.0;
/// Multiple of that beyond which no further rehearsal can matter.
const CLEARLY: f64 = 5.0;
/// Structure that another rehearsal may leave although those so far left less.
const LITTLE_CHANCE: f64 = 60.0;
/// Misfit per residual that no fluctuation of the friction brings about: right models leave 1.2 to 1.7 under it.
const HOPELESS: f64 = 2.5;

/// What a model leaves of the records.
pub struct Left {
    /// Structure, strongest first.
    pub structures: Vec<Structure>,
    /// Whether it is more than a right model leaves.
    pub counts: bool,
}

impl Left {
    /// What `fit` leaves after effects that gained `explained`.
    pub fn by(data: &Data, fit: &Fit, explained: f64) -> Self {
        Self::among(data, fit, structures(data, fit), explained)
    }

    /// The same where its structure is known.
    pub fn among(data: &Data, fit: &Fit, structures: Vec<Structure>, explained: f64) -> Self {
        let least = STRUCTURE_GAIN.max(STRUCTURE_SHARE * explained);
        let strong: Vec<&Structure> = structures
            .iter()
            .filter(|s| s.gain > least && s.interval95[0] > 0.0)
            .collect();
        let misfit = fit.typical_misfit(data);
        let counts = if jumps(fit) {
            (!strong.is_empty() || misfit > MISFIT)
                && beyond_chance(data, fit, &strong, least, misfit)
        } else {
            !strong.is_empty() || misfit > MISFIT || fit.disturbance.relative > ROUGHNESS
        };
        Self { structures, counts }
    }
}

/// Whether friction that fluctuates throws windows from one branch of the law to the other.
pub fn jumps(fit: &Fit) -> bool {
    fit.hypothesis.rig.law.has_branches() && fit.disturbance.relative > LITTLE_ROUGHNESS
}

/// Whether `strong` structure, or the misfit, is more than the model leaves of records that it made itself.
fn beyond_chance(data: &Data, fit: &Fit, strong: &[&Structure], least: f64, misfit: f64) -> bool {
    if misfit > HOPELESS {
        return true;
    }
    let mut by_chance = vec![0.0_f64; strong.len()];
    let mut misfit_by_chance = 1.0_f64;
    for rehearsal in rehearse(data, fit) {
        misfit_by_chance = misfit_by_chance.max(rehearsal.typical_misfit);
        for (most, s) in by_chance.iter_mut().zip(strong) {
            *most = most.max(rehearsal.gain_over(s.coordinate));
        }
        let structured = strong
            .iter()
            .zip(&by_chance)
            .any(|(s, most)| s.gain > least + CHANCE * most);
        if !structured && misfit <= MISFIT * misfit_by_chance {
            return false;
        }
        let clearly = strong
            .iter()
            .zip(&by_chance)
            .any(|(s, most)| s.gain > least + CLEARLY * CHANCE * most.max(LITTLE_CHANCE));
        if clearly {
            return true;
        }
    }
    true
}
