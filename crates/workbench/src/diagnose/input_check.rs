//! What several records of one case have in common: a measurement given twice, inputs that never change.

use std::collections::BTreeSet;

use inference::record::{CHANNELS, RawRecord};

use super::record_check::{COLUMNS, INPUTS};
use crate::files::record::Record;

/// Share of readings in common from which on two records are one measurement.
const IN_COMMON: f64 = 0.2;
/// Rows in succession that are compared as one: a single row of rounded angles may repeat by chance, several hardly do.
const IN_SUCCESSION: usize = 8;

/// Whether two records are one measurement, or parts of one: readings of the same moments agree to the last digit, and
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

/// The different successions of rows with motion, bit by bit; 0 for a column that was not measured.
fn readings(record: &Record) -> BTreeSet<Vec<u64>> {
    let columns = COLUMNS.map(|name| record.column(name));
    let motion = &columns[INPUTS..INPUTS + CHANNELS];
    let moves = |row: usize| motion.iter().flatten().all(|column| column[row] != 0.0);
    let rows: Vec<[u64; COLUMNS.len()]> = (0..record.len())
        .filter(|row| motion.iter().any(Option::is_some) && moves(*row))
        .map(|row| columns.map(|column| column.map_or(0, |column| column[row].to_bits())))
        .collect();
    rows.windows(IN_SUCCESSION)
        .map(<[_]>::as_flattened)
        .map(<[u64]>::to_vec)
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
