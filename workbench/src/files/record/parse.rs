//! Reading CSV.

use super::{Column, Missing, Record, RecordError, name_problem};

impl Record {
    /// Reads a record from the text of a CSV file; `file` names it in messages.
    ///
    /// # Errors
    /// As for [`Record::read`].
    pub fn parse(text: &str, file: &str, missing: Missing) -> Result<Self, RecordError> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut lines = text
            .lines()
            .enumerate()
            .filter(|(_, line)| !line.trim().is_empty());
        let Some((_, header)) = lines.next() else {
            return Err(RecordError::Empty {
                file: file.to_owned(),
            });
        };
        let names = parse_header(header, file)?;
        let mut series: Vec<Vec<f64>> = vec![Vec::new(); names.len()];
        for (index, line) in lines {
            let line_number = index + 1;
            let found = line.split(',').count();
            if found != names.len() {
                return Err(RecordError::FieldCount {
                    file: file.to_owned(),
                    line: line_number,
                    found,
                    expected: names.len(),
                });
            }
            for (position, field) in line.split(',').enumerate() {
                // A sample without its time has no place in the record, whatever is done about other missing values.
                let rule = if position == 0 {
                    Missing::Refuse
                } else {
                    missing
                };
                let value =
                    parse_value(field.trim(), rule).map_err(|problem| RecordError::Value {
                        file: file.to_owned(),
                        line: line_number,
                        column: names[position].clone(),
                        found: field.trim().to_owned(),
                        problem,
                    })?;
                if position == 0
                    && let Some(&before) = series[0].last()
                    && value <= before
                {
                    return Err(RecordError::TimeOrder {
                        file: file.to_owned(),
                        line: line_number,
                        found: value,
                        before,
                    });
                }
                series[position].push(value);
            }
        }
        let mut series = series.into_iter();
        let time = series.next().unwrap_or_default();
        if time.is_empty() {
            return Err(RecordError::NoSamples {
                file: file.to_owned(),
            });
        }
        let columns = names
            .into_iter()
            .skip(1)
            .zip(series)
            .map(|(name, values)| Column { name, values })
            .collect();
        Ok(Self {
            source: file.to_owned(),
            time,
            columns,
        })
    }
}

fn parse_header(header: &str, file: &str) -> Result<Vec<String>, RecordError> {
    let mut names: Vec<String> = Vec::new();
    for (index, field) in header.split(',').enumerate() {
        let name = field.trim().trim_matches('"').to_owned();
        if index == 0 {
            if name != "time" {
                return Err(RecordError::TimeNotFirst {
                    file: file.to_owned(),
                    found: name,
                });
            }
        } else if let Some(problem) = name_problem(&name, names.iter().skip(1).map(String::as_str))
        {
            return Err(RecordError::ColumnName {
                file: file.to_owned(),
                position: index + 1,
                name,
                problem,
            });
        }
        names.push(name);
    }
    Ok(names)
}

fn parse_value(field: &str, missing: Missing) -> Result<f64, &'static str> {
    if field.is_empty() {
        return match missing {
            Missing::Refuse => Err("is empty"),
            Missing::KeepAsNan => Ok(f64::NAN),
        };
    }
    match field.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(value) if value.is_nan() && missing == Missing::KeepAsNan => Ok(f64::NAN),
        Ok(_) => Err("is not finite"),
        Err(_) => Err("is not a number"),
    }
}
