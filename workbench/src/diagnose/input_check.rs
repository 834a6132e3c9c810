//! What several records of one case have in common: a measurement given twice, inputs that never change.

use std::collections::BTreeSet;

use inference::record::RawRecord;

use crate::files::record::Record;

/// Share of readings in common from which on two records are one measurement.
const IN_COMMON: f64 = 0.2;

/// Whether two records are one measurement, or parts of one: readings of the same moment agree to the last digit, and
/// noise does not repeat. Rows at rest are left out, since without noise they are all alike.
pub fn same(left: &Record, right: &Record) -> bool {
    let (left, right) = (readings(left), readings(right));
    let (fewer, more) = if left.len() < right.len() {
        (left, right)
    } else {
        (right, left)
    };
    let common = fewer.intersection(&more).count();
    common as f64 > IN_COMMON * fewer.len() as f64
}

/// The different rows of readings with motion, bit by bit; 0 for a column that was not measured.
fn readings(record: &Record) -> BTreeSet<[u64; 4]> {
    let columns = ["theta", "theta_dot", "theta3", "theta3_dot"].map(|name| record.column(name));
    let is_there = |column: &&Option<&[f64]>| column.is_some();
    if columns.iter().filter(is_there).count() == 0 {
        return BTreeSet::new();
    }
    (0..record.len())
        .map(|row| columns.map(|column| column.map_or(0.0, |column| column[row])))
        .filter(|row| {
            row.iter()
                .zip(&columns)
                .all(|(value, column)| column.is_none() || *value != 0.0)
        })
        .map(|row| row.map(f64::to_bits))
        .collect()
}

/// Share of an input's largest size within which it counts as the same throughout.
const LEVEL: f64 = 0.02;

/// A note where the inputs were the same throughout, on what cannot be told apart then.
pub fn note_on_inputs(records: &[RawRecord]) -> Option<String> {
    let constant = |series: fn(&RawRecord) -> &[f64]| {
        let values = || records.iter().flat_map(|record| series(record).iter());
        let (low, high) = values().fold((f64::MAX, f64::MIN), |(low, high), v| {
            (low.min(*v), high.max(*v))
        });
        high - low <= LEVEL * low.abs().max(high.abs())
    };
    let what = match (
        constant(|record| &record.voltage),
        constant(|record| &record.normal_force),
    ) {
        (false, false) => return None,
        (true, false) => {
            "the voltage is the same throughout: effects of motor and supply cannot be told from each other"
        }
        (false, true) => {
            "the normal force is the same throughout: what grows with it cannot be told from what does not"
        }
        (true, true) => {
            "voltage and normal force are the same throughout: many effects cannot be told from each other"
        }
    };
    Some(format!("records to learn from: {what}"))
}
