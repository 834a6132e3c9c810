//! A record as the engine sees it: in SI units, without holes, with its sticking phases and the windows in which models restart.

use inference::instruments::estimate;
use inference::problem::Catalogue;
use inference::record::RawRecord;
use inference::trace::Motion;
use inference::window::Begin;
use stickslip::plant::ModelFile;

use crate::diagnose::case::{Case, Judging, clean, stretches};
use crate::diagnose::material::Material;
use crate::diagnose::record_check::{COLUMNS, check};
use crate::diagnose::record_part::Part;
use crate::diagnose::rig_columns::RigColumns;
use crate::diagnose::sensors::Sensors;
use crate::diagnose::uncertainty::uncertainties;
use crate::files::record::Record;

use super::binary::Curves;

/// A record that was read, with all its stretches.
#[derive(Debug)]
pub struct Seen {
    /// The file in SI units with the rig's names, with its holes.
    pub record: Record,
    /// What was made of the file, in words.
    pub said: String,
    /// What has to be said about it.
    pub notes: Vec<String>,
    /// Its stretches, cut into windows.
    pub judging: Judging,
}

/// Reads one record by the model and the instruments of `material`.
///
/// # Errors
/// It cannot be used; the message names the file and what would be right.
pub fn see(material: &Material, part: &Part) -> anyhow::Result<Seen> {
    let (columns, model_text) = RigColumns::split_off(&material.model_text, &material.model_name)?;
    let model = ModelFile::parse(&model_text, &material.model_name)?;
    let (uncertainties, _) = uncertainties(&model, &material.model_name)?;
    let (record, said) = columns.read(part)?;
    let checked = check(&record, &model.rig)?;
    let mut runs = stretches(&checked);
    let estimated = estimate(&runs);
    let sensors = material.sensors.as_ref();
    let stated = sensors
        .map(|(file, text)| Sensors::parse(text, file))
        .transpose()?;
    let instruments = match &stated {
        Some(stated) => stated.completed(&estimated),
        None => estimated,
    };
    let load_noise = stated.and_then(|stated| stated.load_cell_noise);
    let mut notes = checked.notes;
    notes.extend(clean(&instruments, load_noise, &mut runs, &mut []));
    let case = Case {
        name: material.name.clone(),
        model,
        model_text,
        uncertainties,
        instruments,
        records: Vec::new(),
        held_out: runs,
        catalogue: Catalogue::default(),
        notes: Vec::new(),
    };
    Ok(Seen {
        record,
        said,
        notes,
        judging: case.judging(Begin::Clear)?,
    })
}

impl Seen {
    /// What was measured, all stretches one after the other: inputs, channels, and 1 under `stuck` where the disc sticks.
    pub fn measured(&self) -> Curves {
        let mut curves = Curves::default();
        let records = &self.judging.records;
        let all = |of: &dyn Fn(&RawRecord) -> Vec<f64>| -> Vec<f64> {
            records.iter().flat_map(of).collect()
        };
        curves.add("time", all(&|run| run.time.clone()));
        curves.add("u", all(&|run| run.voltage.clone()));
        curves.add("N2", all(&|run| run.normal_force.clone()));
        if records.iter().any(|run| !run.normal_force_1.is_empty()) {
            curves.add("N1", all(&|run| run.normal_force_1.clone()));
        }
        for (channel, name) in channels() {
            if records.iter().any(|run| !run.readings[channel].is_empty()) {
                curves.add(name, all(&|run| run.readings[channel].clone()));
            }
        }
        let runs = &self.judging.data.runs;
        let stuck = runs.iter().flat_map(|run| &run.traces.motion);
        curves.add(
            "stuck",
            stuck
                .map(|motion| f64::from(u8::from(*motion == Motion::Stuck)))
                .collect(),
        );
        curves
    }

    /// Numbers of the first samples of its stretches.
    pub fn begins(&self) -> Vec<usize> {
        let mut begins = Vec::new();
        let mut rows = 0;
        for run in &self.judging.records {
            begins.push(rows);
            rows += run.time.len();
        }
        begins
    }

    /// Whether a channel was measured.
    pub fn has(&self, channel: usize) -> bool {
        self.judging
            .records
            .iter()
            .any(|run| !run.readings[channel].is_empty())
    }
}

/// The channels that may be measured, with their names.
pub fn channels() -> impl Iterator<Item = (usize, &'static str)> {
    // Between the inputs of every rig and that of the full rig alone.
    COLUMNS[2..COLUMNS.len() - 1].iter().copied().enumerate()
}
