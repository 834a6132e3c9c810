//! The problem as the engine sees it: a rig, records and instruments in the plant's own units.

use std::sync::Arc;

use crate::data::Data;
use crate::effects::{EFFECTS, Effect};
use crate::hypothesis::Hypothesis;
use crate::policy::DOUBT;
use crate::record::{CHANNELS, Instruments, RawRecord, Run, channel, channel_units};
use crate::scales::{Scales, mean_load};
use crate::units::PlantUnits;
use crate::window::{Begin, LENGTH, SHORT, UNSEEN};
use stickslip::parameter::ParameterError;
use stickslip::plant::{Rig, Supposition};

/// What is to be explained.
#[derive(Clone, Debug)]
pub struct Problem {
    /// The plant's units.
    pub units: PlantUnits,
    /// The analyst's rig in them.
    pub rig: Rig<f64>,
    /// Relative standard deviations of its nominal parameters.
    pub uncertainties: Vec<(String, f64)>,
    /// The instruments in the plant's units.
    pub instruments: Instruments,
    /// Records in windows of usual length.
    pub long: Data,
    /// The same records in short windows.
    pub short: Data,
    /// The effects that may be missing, in a fixed order.
    pub effects: Vec<Effect>,
}

/// The effects that are considered.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Catalogue {
    /// Names of those that are not.
    pub without: Vec<String>,
    /// Those that files describe, beside [`EFFECTS`].
    pub supposed: Vec<Supposition>,
}

impl Problem {
    /// The problem that these records pose; rig, records and instruments in SI units.
    ///
    /// # Errors
    /// A number of the rig leaves its range in the plant's units.
    pub fn new(
        rig: &Rig<f64>,
        uncertainties: Vec<(String, f64)>,
        records: &[RawRecord],
        instruments: &Instruments,
        catalogue: &Catalogue,
    ) -> Result<Self, ParameterError> {
        let load = mean_load(records.iter().map(|record| record.normal_force.as_slice()));
        let units = PlantUnits::of(rig, load);
        let plant = units.to_plant(rig)?;
        let in_units = channel_units(&units);
        let instruments = Instruments {
            step: std::array::from_fn(|c| instruments.step[c] / in_units[c]),
            noise: std::array::from_fn(|c| instruments.noise[c] / in_units[c]),
        };
        let runs: Vec<Run> = records
            .iter()
            .map(|record| Run::new(record, &units, &plant, &instruments))
            .collect();
        let has = |c: usize| runs.iter().all(|run| run.has(c));
        // An encoder tells a step, other instruments a few deviations: of the angle, or of the speed over a radian of the
        // natural oscillation.
        let resolution = [channel::THETA, channel::OMEGA, channel::THETA3]
            .into_iter()
            .filter(|c| has(*c))
            .take(1)
            .map(|c| 12f64.sqrt() * instruments.deviations()[c])
            .fold(f64::INFINITY, f64::min);
        let scales = Scales::of(&plant, &runs, resolution);
        let runs = Arc::new(runs);
        let deviations: [f64; CHANNELS] = instruments.deviations();
        let cut = |length: f64| {
            Data::new(
                Arc::clone(&runs),
                &plant,
                scales,
                deviations,
                length,
                Begin::Clear,
            )
        };
        let [long, short] = lengths(&runs);
        let (long, short) = (cut(long), cut(short).undivided());
        let mut effects = EFFECTS.to_vec();
        for supposition in &catalogue.supposed {
            effects.push(Effect::supposed(supposition, &plant, &scales, &units)?);
        }
        effects.retain(|effect| !catalogue.without.iter().any(|name| name == effect.name));
        Ok(Self {
            units,
            rig: plant,
            uncertainties,
            instruments,
            long,
            short,
            effects,
        })
    }

    /// Records of the same plant, in its units, in windows of usual length that start as `begin` wants it.
    #[must_use]
    pub fn windows_of(&self, runs: Arc<Vec<Run>>, begin: Begin) -> Data {
        let [length, _] = lengths(&runs);
        let Data {
            scales, deviations, ..
        } = self.long;
        Data::new(runs, &self.rig, scales, deviations, length, begin)
    }

    /// The effect of this name.
    #[must_use]
    pub fn effect(&self, name: &str) -> Option<&Effect> {
        self.effects.iter().find(|effect| effect.name == name)
    }

    /// The effects that a hypothesis has beside the analyst's model, in the catalogue's order.
    #[must_use]
    pub fn effects_of(&self, hypothesis: &Hypothesis) -> Vec<&Effect> {
        let has = |effect: &&Effect| hypothesis.effects.iter().any(|own| own == effect.name);
        self.effects.iter().filter(has).collect()
    }

    /// The same problem with at most about `most` windows, spread over the records.
    #[must_use]
    pub fn part(&self, most: usize) -> Self {
        let thinned = |data: &Data, most: usize| {
            let every = data.windows.len().div_ceil(most).max(1);
            let kept: Vec<usize> = (0..data.windows.len()).step_by(every).collect();
            data.part(&kept)
        };
        Self {
            long: thinned(&self.long, most),
            short: thinned(&self.short, 2 * most),
            ..self.clone()
        }
    }

    /// The same problem where less is known of the nominal parameters: ten times the stated deviations, and of what the motor has beside
    /// them as much as of the least known one.
    #[must_use]
    pub fn doubting(&self) -> Self {
        let doubted = self.uncertainties.iter();
        let mut uncertainties: Vec<(String, f64)> = doubted
            .map(|(name, deviation)| (name.clone(), (DOUBT * deviation).min(1.0)))
            .collect();
        let most = uncertainties
            .iter()
            .map(|(_, own)| *own)
            .fold(0.0, f64::max);
        for parameter in self.rig.parameters() {
            let is_known = uncertainties
                .iter()
                .any(|(name, _)| *name == parameter.name);
            if parameter.name.starts_with("motor.") && !is_known {
                uncertainties.push((parameter.name, most));
            }
        }
        Self {
            uncertainties,
            ..self.clone()
        }
    }

    /// The analyst's model with its nominal parameters free within their uncertainty.
    #[must_use]
    pub fn hypothesis(&self) -> Hypothesis {
        Hypothesis::base(&self.rig, &self.uncertainties)
    }
}

/// Lengths of usual and of short windows: longer where nothing was measured of the disc.
fn lengths(runs: &[Run]) -> [f64; 2] {
    let is_seen = |run: &Run| run.has(channel::THETA) || run.has(channel::OMEGA);
    if runs.iter().all(is_seen) {
        [LENGTH, SHORT]
    } else {
        [UNSEEN, LENGTH]
    }
}
