//! Tables of numbers, as CSV or Parquet.

use std::fmt::Write as _;
use std::path::Path;
use std::sync::Arc;

use clap::ValueEnum;
use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical, ZstdLevel};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;

use super::atomic::{self, WriteError};

/// As what tables are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum TableFormat {
    /// Text with commas.
    #[default]
    Csv,
    /// Columns of binary numbers, compressed.
    Parquet,
}

impl TableFormat {
    /// The name of the table `stem` in this format.
    #[must_use]
    pub fn file_name(self, stem: &str) -> String {
        match self {
            Self::Csv => format!("{stem}.csv"),
            Self::Parquet => format!("{stem}.parquet"),
        }
    }
}

/// What a column has in each row.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// Numbers; one that is not finite is missing.
    Numbers(Vec<f64>),
    /// Whole numbers.
    Whole(Vec<i64>),
    /// Words without commas.
    Words(Vec<&'static str>),
}

/// Columns of equal length, by name.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Table {
    columns: Vec<(String, Values)>,
    rows: usize,
}

impl Table {
    /// A table of `rows` rows without a column.
    #[must_use]
    pub fn new(rows: usize) -> Self {
        Self {
            columns: Vec::new(),
            rows,
        }
    }

    /// The same with one more column of numbers.
    #[must_use]
    pub fn numbers(self, name: impl Into<String>, values: impl Iterator<Item = f64>) -> Self {
        self.with(name.into(), Values::Numbers(values.collect()))
    }

    /// The same with one more column of whole numbers.
    #[must_use]
    pub fn whole(self, name: impl Into<String>, values: impl Iterator<Item = i64>) -> Self {
        self.with(name.into(), Values::Whole(values.collect()))
    }

    /// The same with one more column of words.
    #[must_use]
    pub fn words(
        self,
        name: impl Into<String>,
        values: impl Iterator<Item = &'static str>,
    ) -> Self {
        self.with(name.into(), Values::Words(values.collect()))
    }

    fn with(mut self, name: String, values: Values) -> Self {
        self.columns.push((name, values));
        self
    }

    /// Writes the table `stem` into a directory.
    ///
    /// # Errors
    /// [`WriteError`] where the operating system refuses.
    pub fn write(
        &self,
        directory: &Path,
        stem: &str,
        format: TableFormat,
    ) -> Result<(), WriteError> {
        let path = directory.join(format.file_name(stem));
        match format {
            TableFormat::Csv => atomic::write_file(&path, self.csv().as_bytes()),
            TableFormat::Parquet => {
                let bytes = self.parquet().map_err(|error| WriteError::Io {
                    path: path.clone(),
                    step: "be made as Parquet",
                    source: std::io::Error::other(error),
                })?;
                atomic::write_file(&path, &bytes)
            }
        }
    }

    fn csv(&self) -> String {
        let names: Vec<&str> = self.columns.iter().map(|(name, _)| name.as_str()).collect();
        let mut text = names.join(",");
        text.push('\n');
        for row in 0..self.rows {
            for (at, (_, values)) in self.columns.iter().enumerate() {
                if at > 0 {
                    text.push(',');
                }
                let _ = match values {
                    Values::Numbers(values) if !values[row].is_finite() => Ok(()),
                    Values::Numbers(values) => write!(text, "{:?}", values[row]),
                    Values::Whole(values) => write!(text, "{}", values[row]),
                    Values::Words(values) => write!(text, "{}", values[row]),
                };
            }
            text.push('\n');
        }
        text
    }

    fn parquet(&self) -> Result<Vec<u8>, ParquetError> {
        let fields = self.columns.iter().map(|(name, values)| {
            let (physical, logical, repetition) = match values {
                Values::Numbers(_) => (Physical::DOUBLE, None, Repetition::OPTIONAL),
                Values::Whole(_) => (Physical::INT64, None, Repetition::REQUIRED),
                Values::Words(_) => (
                    Physical::BYTE_ARRAY,
                    Some(LogicalType::String),
                    Repetition::REQUIRED,
                ),
            };
            Type::primitive_type_builder(name, physical)
                .with_logical_type(logical)
                .with_repetition(repetition)
                .build()
                .map(Arc::new)
        });
        let schema = Type::group_type_builder("table")
            .with_fields(fields.collect::<Result<_, _>>()?)
            .build()?;
        let properties = WriterProperties::builder()
            .set_compression(Compression::ZSTD(ZstdLevel::default()))
            .set_created_by(concat!("stickslip ", env!("CARGO_PKG_VERSION")).to_owned())
            .build();
        let mut writer =
            SerializedFileWriter::new(Vec::new(), Arc::new(schema), Arc::new(properties))?;
        let mut group = writer.next_row_group()?;
        for (_, values) in &self.columns {
            let Some(mut column) = group.next_column()? else {
                break;
            };
            match values {
                Values::Numbers(values) => {
                    let there: Vec<i16> = values
                        .iter()
                        .map(|value| i16::from(value.is_finite()))
                        .collect();
                    let finite = values.iter().copied().filter(|value| value.is_finite());
                    let finite: Vec<f64> = finite.collect();
                    column
                        .typed::<DoubleType>()
                        .write_batch(&finite, Some(&there), None)?;
                }
                Values::Whole(values) => {
                    column
                        .typed::<Int64Type>()
                        .write_batch(values, None, None)?;
                }
                Values::Words(values) => {
                    let words: Vec<ByteArray> =
                        values.iter().map(|word| ByteArray::from(*word)).collect();
                    column
                        .typed::<ByteArrayType>()
                        .write_batch(&words, None, None)?;
                }
            }
            column.close()?;
        }
        group.close()?;
        writer.into_inner()
    }
}
