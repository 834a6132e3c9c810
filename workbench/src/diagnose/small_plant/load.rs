//! The load of records: over its mean, so that a law holds there, and left out where an FMU's records have none.

use super::case::SmallCaseError;
use super::fmu::missing::Recorded;
use super::model_file::SmallModel;
use stickslip::body::Kind;

/// Takes the load of an FMU for not measured where all records are without: no friction that it presses together shows there. Says so.
pub(super) fn leave_no_load_out(model: &mut SmallModel, all: &mut [Recorded]) -> Option<String> {
    let column = model.columns.load.as_ref()?.column.clone();
    let mut loads = all.iter().flat_map(|record| &record.motions[0].load);
    if model.model.kind != Kind::Fmu || loads.any(|load| *load != 0.0) {
        return None;
    }
    model.columns.load = None;
    for motion in all.iter_mut().flat_map(|record| &mut record.motions) {
        motion.load.fill(1.0);
    }
    Some(format!(
        "the load, column {column}, is 0 in all records; effects that depend on it were not tried"
    ))
}

/// Load over its mean on the records learned from.
pub(super) fn relate_load(model: &SmallModel, all: &mut [Recorded]) -> Result<(), SmallCaseError> {
    if model.columns.load.is_none() {
        return Ok(());
    }
    let learned = &all[..all.len().saturating_sub(1)];
    let loads: Vec<f64> = learned
        .iter()
        .flat_map(|record| record.motions[0].load.iter().copied())
        .collect();
    let mean = loads.iter().sum::<f64>() / loads.len().max(1) as f64;
    if mean <= 0.0 || mean.is_nan() {
        return Err(SmallCaseError::Unusable {
            file: all[0].motions[0].name.clone(),
            what: format!(
                "the load is {mean} on average; a contact is pressed together by a positive load"
            ),
        });
    }
    let motions = all.iter_mut().flat_map(|record| &mut record.motions);
    for load in motions.flat_map(|motion| &mut motion.load) {
        *load /= mean;
    }
    Ok(())
}
