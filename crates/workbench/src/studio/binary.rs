//! Curves for the page: a header in JSON, then the columns as 64-bit numbers, so that nothing is rounded or parsed.

use axum::body::Bytes;
use serde_json::{Value, json};

/// Most rows of one answer: a screen shows no more.
const MOST_ROWS: usize = 20_000;
/// Bytes of a number.
const NUMBER: usize = 8;

/// Columns of one length under their names.
#[derive(Debug, Default)]
pub struct Curves {
    names: Vec<String>,
    columns: Vec<Vec<f64>>,
}

impl Curves {
    /// Adds a column.
    pub fn add(&mut self, name: impl Into<String>, values: Vec<f64>) {
        self.names.push(name.into());
        self.columns.push(values);
    }

    /// The answer: length of the header (32 bits, little endian), the header filled up with blanks so that the numbers lie at a
    /// multiple of eight, the columns one after the other. Of long columns every so many-th row is sent, which the header says.
    pub fn answer(&self, mut header: Value) -> Bytes {
        let rows = self.columns.first().map_or(0, Vec::len);
        let every = rows.div_ceil(MOST_ROWS).max(1);
        let sent = rows.div_ceil(every);
        header["columns"] = json!(self.names);
        header["rows"] = json!(sent);
        header["every"] = json!(every);
        let mut text = header.to_string();
        while !(4 + text.len()).is_multiple_of(NUMBER) {
            text.push(' ');
        }
        let mut bytes = Vec::with_capacity(4 + text.len() + NUMBER * sent * self.columns.len());
        bytes.extend((text.len() as u32).to_le_bytes());
        bytes.extend(text.as_bytes());
        for column in &self.columns {
            for value in column.iter().step_by(every) {
                bytes.extend(value.to_le_bytes());
            }
        }
        bytes.into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_lie_at_multiples_of_eight_and_long_columns_are_thinned_out() {
        let mut curves = Curves::default();
        curves.add("time", (0..50_000).map(f64::from).collect());
        let bytes = curves.answer(json!({"what": "test"}));
        let length = u32::from_le_bytes(bytes[..4].try_into().unwrap()) as usize;
        let header: Value = serde_json::from_slice(&bytes[4..4 + length]).unwrap();
        assert_eq!((4 + length) % 8, 0);
        assert_eq!(
            (header["every"].as_u64(), header["rows"].as_u64()),
            (Some(3), Some(16_667))
        );
        assert_eq!(bytes.len(), 4 + length + 8 * 16_667);
        let second = f64::from_le_bytes(bytes[4 + length + 8..4 + length + 16].try_into().unwrap());
        assert_eq!(second, 3.0);
    }
}
