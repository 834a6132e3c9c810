//! Time series as text: a header of names, the time first, then one row of numbers for each instant.

use std::collections::BTreeSet;
use std::fmt::Write;

use thiserror::Error;

use crate::model_description::number;

/// Most columns: each takes memory of its own, however few rows there are.
const MOST_COLUMNS: usize = 10_000;

/// Why a text is no table; `line` counts from 1.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum TableError {
    /// There is no row below the header.
    #[error("has no row of numbers")]
    Empty,
    /// There are too many columns.
    #[error("has more than {MOST_COLUMNS} columns")]
    Columns,
    /// A column has no name or that of another.
    #[error("has a column {column} whose name {name:?} is empty or taken")]
    Name {
        /// Which column, from 1.
        column: usize,
        /// Its name.
        name: String,
    },
    /// A row is shorter or longer than the header.
    #[error("line {line}: has {found} values where the header has {expected}")]
    Length {
        /// The row.
        line: usize,
        /// Its values.
        found: usize,
        /// Names of the header.
        expected: usize,
    },
    /// A value is no finite number.
    #[error("line {line}, column {name}: {text:?} is no number")]
    Number {
        /// The row.
        line: usize,
        /// The column.
        name: String,
        /// What stands there.
        text: String,
    },
    /// Time goes back.
    #[error("line {line}: the time goes back")]
    Order {
        /// The row.
        line: usize,
    },
}

/// A variable over time.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Name of the variable.
    pub name: String,
    /// One value for each time; Booleans as 0 and 1.
    pub values: Vec<f64>,
}

/// Variables over time.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Table {
    /// Times [s], none before the one above it. Two equal ones are a jump.
    pub time: Vec<f64>,
    /// The variables.
    pub columns: Vec<Column>,
}

impl Table {
    /// The table as text; reading it back gives the same numbers.
    #[must_use]
    pub fn to_csv(&self) -> String {
        let mut text = String::from("time");
        for column in &self.columns {
            // Writing to a string cannot fail.
            let _ = write!(text, ",{}", column.name);
        }
        text.push('\n');
        for (row, time) in self.time.iter().enumerate() {
            text.push_str(&number(*time));
            for column in &self.columns {
                let _ = write!(text, ",{}", number(column.values[row]));
            }
            text.push('\n');
        }
        text
    }

    /// Reads a table with commas or semicolons between its values; names may stand in quotes.
    ///
    /// # Errors
    /// [`TableError`] with the line.
    pub fn parse(text: &str) -> Result<Self, TableError> {
        let text = text.trim_start_matches('\u{feff}');
        let mut lines = text
            .lines()
            .enumerate()
            .filter(|(_, line)| !line.trim().is_empty());
        let (_, header) = lines.next().ok_or(TableError::Empty)?;
        let separator = if header.contains(';') { ';' } else { ',' };
        if header.matches(separator).count() > MOST_COLUMNS {
            return Err(TableError::Columns);
        }
        let names = fields(header, separator);
        let mut known = BTreeSet::new();
        for (at, name) in names.iter().enumerate().skip(1) {
            if name.is_empty() || !known.insert(name) {
                return Err(TableError::Name {
                    column: at + 1,
                    name: name.clone(),
                });
            }
        }
        let mut table = Self {
            time: Vec::new(),
            columns: names[1..]
                .iter()
                .map(|name| Column {
                    name: name.clone(),
                    values: Vec::new(),
                })
                .collect(),
        };
        for (line, row) in lines {
            table.add(line + 1, row, separator, &names)?;
        }
        if table.time.is_empty() {
            return Err(TableError::Empty);
        }
        Ok(table)
    }

    fn add(
        &mut self,
        line: usize,
        row: &str,
        separator: char,
        names: &[String],
    ) -> Result<(), TableError> {
        let words: Vec<&str> = row.split(separator).map(str::trim).collect();
        if words.len() != names.len() {
            return Err(TableError::Length {
                line,
                found: words.len(),
                expected: names.len(),
            });
        }
        for (at, (word, name)) in words.into_iter().zip(names).enumerate() {
            let word = word.trim_matches('"');
            let value = match word {
                "true" => 1.0,
                "false" => 0.0,
                _ => word.parse::<f64>().unwrap_or(f64::NAN),
            };
            if !value.is_finite() {
                return Err(TableError::Number {
                    line,
                    name: name.clone(),
                    text: word.to_owned(),
                });
            }
            match at.checked_sub(1) {
                Some(column) => self.columns[column].values.push(value),
                None if self.time.last().is_some_and(|last| value < *last) => {
                    return Err(TableError::Order { line });
                }
                None => self.time.push(value),
            }
        }
        Ok(())
    }

    /// The value of a column at a time: on the line between two rows, or that of the last row where `held`. Beyond the ends it
    /// stays, and at a jump it is the later one.
    #[must_use]
    pub fn at(&self, column: &Column, time: f64, held: bool) -> f64 {
        let after = self.time.partition_point(|row| *row <= time);
        let Some(before) = after.checked_sub(1) else {
            return column.values[0];
        };
        let value = column.values[before];
        match self.time.get(after) {
            Some(next) if !held => {
                let share = (time - self.time[before]) / (next - self.time[before]);
                value + share * (column.values[after] - value)
            }
            _ => value,
        }
    }
}

/// The fields of a header, in which a name in quotes may hold the separator and doubled quotes.
fn fields(header: &str, separator: char) -> Vec<String> {
    let mut fields = vec![String::new()];
    let mut quoted = false;
    let mut letters = header.trim_end_matches('\r').chars().peekable();
    while let Some(letter) = letters.next() {
        let field = fields.last_mut();
        match (letter, field) {
            ('"', Some(field)) if quoted && letters.peek() == Some(&'"') => {
                letters.next();
                field.push('"');
            }
            ('"', _) => quoted = !quoted,
            (letter, _) if letter == separator && !quoted => fields.push(String::new()),
            (letter, Some(field)) => field.push(letter),
            (_, None) => {}
        }
    }
    fields
        .into_iter()
        .map(|field| field.trim().to_owned())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_back() {
        let table = Table {
            time: vec![0.0, 0.1, 0.30000000000000004],
            columns: vec![
                Column {
                    name: "theta".to_owned(),
                    values: vec![0.0, -1.5e-9, 1.0 / 3.0],
                },
                Column {
                    name: "disc.inertia".to_owned(),
                    values: vec![1.0, 0.0, 1e300],
                },
            ],
        };
        assert_eq!(Table::parse(&table.to_csv()).unwrap(), table);
    }

    #[test]
    fn headers_of_other_programs_are_read() {
        let text = "\u{feff}\"time\";\"a[1,2]\";\"say \"\"b\"\"\"\r\n0;1;true\r\n\r\n1;2;false\r\n";
        let table = Table::parse(text).unwrap();
        assert_eq!(table.time, [0.0, 1.0]);
        assert_eq!(table.columns[0].name, "a[1,2]");
        assert_eq!(table.columns[1].name, "say \"b\"");
        assert_eq!(table.columns[1].values, [1.0, 0.0]);
    }

    #[test]
    fn what_is_wrong_is_said_with_its_line() {
        for (text, expected) in [
            ("", "no row"),
            ("time,u\n", "no row"),
            ("time,u,u\n0,1,2\n", "column 3"),
            ("time,u,\n0,1,2\n", "column 3"),
            ("time,u\n0,1\n1\n", "line 3: has 1 values"),
            ("time,u\n0,1\n1,x\n", "line 3, column u: \"x\""),
            ("time,u\n0,1\n1,inf\n", "line 3, column u"),
            ("time,u\n0,1\n\n-1,2\n", "line 4: the time goes back"),
        ] {
            let error = Table::parse(text).unwrap_err().to_string();
            assert!(error.contains(expected), "{text:?}: {error}");
        }
    }

    #[test]
    fn values_between_rows_lie_on_a_line_or_are_held() {
        let table = Table::parse("time,u\n0,0\n1,2\n1,10\n2,10\n").unwrap();
        let at = |time, held| table.at(&table.columns[0], time, held);
        assert_eq!(
            [-1.0, 0.5, 1.0, 1.5, 3.0].map(|t| at(t, false)),
            [0.0, 1.0, 10.0, 10.0, 10.0]
        );
        assert_eq!([0.5, 1.0, 1.5].map(|t| at(t, true)), [0.0, 10.0, 10.0]);
    }
}
