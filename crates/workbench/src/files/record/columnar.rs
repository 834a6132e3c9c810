//! Parquet files.

use std::panic::{AssertUnwindSafe, catch_unwind};

use bytes::Bytes;
use parquet::basic::{ConvertedType, LogicalType, TimeUnit, Type};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::DataType;
use parquet::errors::ParquetError;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::schema::types::ColumnDescriptor;

use super::error::RecordError;
use super::table::{MOST_VALUES, Places, Table};

/// What a file begins with.
const MARK: &[u8] = b"PAR1";
/// Rows that are decoded at once.
const CHUNK: usize = 8192;
/// What pandas calls an index that has no name.
const NAMELESS_INDEX: &str = "__index_level_0__";

/// What the whole numbers of a column count.
#[derive(Clone, Copy)]
enum Count {
    /// Themselves; the bits that hold them.
    Ones(u64),
    /// Themselves, where the highest bit is a sign.
    Signed,
    /// Instants, so many in a second.
    Ticks(f64),
}

/// Whether a file is of this kind.
pub(super) fn is_one(bytes: &[u8]) -> bool {
    bytes.starts_with(MARK)
}

/// The table in a file of this content.
pub(super) fn table(bytes: Vec<u8>, file: &str) -> Result<Table, RecordError> {
    let damaged = |reason: String| RecordError::Damaged {
        file: file.to_owned(),
        kind: "Parquet file",
        reason,
    };
    // The reader asserts what a file states of itself, such as that lengths are positive, and a studio must outlive that.
    let read = catch_unwind(AssertUnwindSafe(|| read(bytes, file, &damaged)));
    read.unwrap_or_else(|_| Err(damaged("it contradicts itself".to_owned())))
}

fn read(
    bytes: Vec<u8>,
    file: &str,
    damaged: &dyn Fn(String) -> RecordError,
) -> Result<Table, RecordError> {
    let reader = SerializedFileReader::new(Bytes::from(bytes));
    let reader = reader.map_err(|error| damaged(error.to_string()))?;
    let metadata = reader.metadata().file_metadata();
    let described = metadata.schema_descr().columns();
    let rows = usize::try_from(metadata.num_rows()).unwrap_or_default();
    if rows.saturating_mul(described.len()) > MOST_VALUES {
        return Err(RecordError::TooLarge {
            file: file.to_owned(),
            found: format!("{rows} rows of {} columns", described.len()),
            most: format!("{MOST_VALUES} values"),
        });
    }
    let (mut columns, mut said) = (Vec::new(), Vec::new());
    for (at, column) in described.iter().enumerate() {
        let name = column.path().string();
        let count = count(column).map_err(|(found, remedy)| RecordError::NoNumbers {
            file: file.to_owned(),
            column: name.clone(),
            found,
            remedy,
        })?;
        let mut first = None;
        let mut whole = |value: i64| match count {
            Count::Ones(bits) => (value.cast_unsigned() & bits) as f64,
            Count::Signed => value as f64,
            Count::Ticks(rate) => {
                let first = *first.get_or_insert(value);
                (i128::from(value) - i128::from(first)) as f64 / rate
            }
        };
        let mut values = Vec::new();
        for group in 0..reader.num_row_groups() {
            let group = reader.get_row_group(group);
            let column = group.and_then(|group| group.get_column_reader(at));
            column
                .and_then(|column| append(column, &mut whole, rows, &mut values))
                .map_err(|error| damaged(format!("column `{name}`: {error}")))?;
        }
        if values.len() != rows {
            let found = values.len();
            return Err(damaged(format!(
                "column `{name}` has {found} values where {rows} are announced"
            )));
        }
        if matches!(count, Count::Ticks(_)) {
            said.push(format!("`{name}` taken as seconds since the first row"));
        }
        let is_time =
            name == NAMELESS_INDEX && !described.iter().any(|other| other.name() == "time");
        if is_time {
            said.push("the index without a name taken as time".to_owned());
        }
        columns.push((if is_time { "time".to_owned() } else { name }, values));
    }
    // As pandas counts them.
    let places = Places::from("row", 0);
    Ok(Table::of_numbers(file, columns, places, said))
}

/// What a column counts; what it holds instead of numbers, and what to do about it.
fn count(column: &ColumnDescriptor) -> Result<Count, (String, &'static str)> {
    const LEAVE_OUT: &str = "convert it with pandas.to_numeric, or leave the column out";
    if column.path().parts().len() > 1 || column.max_rep_level() > 0 {
        let remedy = "give each of its parts a column of its own, or leave the column out";
        return Err(("lists or structures".to_owned(), remedy));
    }
    let kind = column.physical_type();
    if matches!(kind, Type::BYTE_ARRAY | Type::FIXED_LEN_BYTE_ARRAY) {
        return Err(("text or objects".to_owned(), LEAVE_OUT));
    }
    match (column.logical_type_ref(), column.converted_type()) {
        (Some(LogicalType::Timestamp(time) | LogicalType::Time(time)), _) => {
            Ok(Count::Ticks(match time.unit {
                TimeUnit::MILLIS => 1e3,
                TimeUnit::MICROS => 1e6,
                TimeUnit::NANOS => 1e9,
            }))
        }
        (_, ConvertedType::TIMESTAMP_MILLIS | ConvertedType::TIME_MILLIS) => Ok(Count::Ticks(1e3)),
        (_, ConvertedType::TIMESTAMP_MICROS | ConvertedType::TIME_MICROS) => Ok(Count::Ticks(1e6)),
        (Some(LogicalType::Date), _) | (_, ConvertedType::DATE) => Err((
            "days".to_owned(),
            "convert them to seconds, or leave the column out",
        )),
        (Some(LogicalType::Decimal(_)), _) | (_, ConvertedType::DECIMAL) => Err((
            "decimal numbers".to_owned(),
            "convert it with astype(float)",
        )),
        (_, ConvertedType::UINT_64) => Ok(Count::Ones(u64::MAX)),
        (_, ConvertedType::UINT_32) => Ok(Count::Ones(u64::from(u32::MAX))),
        // Instants of old writers, which count nanoseconds.
        _ if kind == Type::INT96 => Ok(Count::Ticks(1e9)),
        _ => Ok(Count::Signed),
    }
}

/// Adds the values of a row group; `whole` says what a whole number is.
fn append(
    reader: ColumnReader,
    whole: &mut dyn FnMut(i64) -> f64,
    most: usize,
    values: &mut Vec<f64>,
) -> Result<(), ParquetError> {
    match reader {
        ColumnReader::BoolColumnReader(reader) => {
            decode(reader, |value| f64::from(u8::from(*value)), most, values)
        }
        ColumnReader::Int32ColumnReader(reader) => {
            decode(reader, |value| whole(i64::from(*value)), most, values)
        }
        ColumnReader::Int64ColumnReader(reader) => {
            decode(reader, |value| whole(*value), most, values)
        }
        ColumnReader::Int96ColumnReader(reader) => {
            decode(reader, |value| whole(value.to_nanos()), most, values)
        }
        ColumnReader::FloatColumnReader(reader) => {
            decode(reader, |value| f64::from(*value), most, values)
        }
        ColumnReader::DoubleColumnReader(reader) => decode(reader, |value| *value, most, values),
        ColumnReader::ByteArrayColumnReader(_) | ColumnReader::FixedLenByteArrayColumnReader(_) => {
            Err(ParquetError::General("holds bytes".to_owned()))
        }
    }
}

/// Adds values until there are no more, or more than `most`; what is missing is NaN.
fn decode<T: DataType>(
    mut reader: ColumnReaderImpl<T>,
    mut number: impl FnMut(&T::T) -> f64,
    most: usize,
    values: &mut Vec<f64>,
) -> Result<(), ParquetError> {
    while values.len() <= most {
        let (mut levels, mut present) = (Vec::new(), Vec::new());
        let (records, ..) = reader.read_records(CHUNK, Some(&mut levels), None, &mut present)?;
        if records == 0 {
            break;
        }
        let mut present = present.iter().map(&mut number);
        if levels.is_empty() {
            values.extend(present);
        } else {
            // Not nested: a level above 0 is a value that is there.
            let held = |level: &i16| (*level > 0).then(|| present.next()).flatten();
            let held = levels.iter().map(held);
            values.extend(held.map(|value| value.unwrap_or(f64::NAN)));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use parquet::basic::{Compression, GzipLevel, ZstdLevel};
    use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
    use parquet::file::properties::WriterProperties;
    use parquet::file::writer::SerializedFileWriter;
    use parquet::schema::parser::parse_message_type;

    use super::super::{Dialect, Missing, Record};
    use super::*;

    enum Values<'a> {
        Reals(&'a [f64]),
        /// A level for each row: 1 where there is a value.
        Held(&'a [f64], &'a [i16]),
        Whole(&'a [i64]),
        Text(&'a [&'a str]),
    }

    fn file(schema: &str, compression: Compression, columns: &[Values]) -> Vec<u8> {
        let schema = parse_message_type(&format!("message record {{ {schema} }}")).unwrap();
        let properties = WriterProperties::builder()
            .set_compression(compression)
            .build();
        let mut writer =
            SerializedFileWriter::new(Vec::new(), Arc::new(schema), Arc::new(properties)).unwrap();
        let mut group = writer.next_row_group().unwrap();
        for values in columns {
            let mut column = group.next_column().unwrap().unwrap();
            match values {
                Values::Reals(values) => {
                    column.typed::<DoubleType>().write_batch(values, None, None)
                }
                Values::Held(values, levels) => {
                    column
                        .typed::<DoubleType>()
                        .write_batch(values, Some(levels), None)
                }
                Values::Whole(values) => {
                    column.typed::<Int64Type>().write_batch(values, None, None)
                }
                Values::Text(values) => {
                    let values: Vec<ByteArray> =
                        values.iter().map(|text| ByteArray::from(*text)).collect();
                    column
                        .typed::<ByteArrayType>()
                        .write_batch(&values, None, None)
                }
            }
            .unwrap();
            column.close().unwrap();
        }
        group.close().unwrap();
        writer.into_inner().unwrap()
    }

    fn read(bytes: Vec<u8>) -> Result<(Record, String), RecordError> {
        let table = Table::of_bytes(bytes, "run.parquet", None, Dialect::Any)?;
        let (names, said) = (table.names().to_vec(), table.said().join(", "));
        Ok((table.record(&names, Missing::KeepAsNan)?, said))
    }

    fn refused(bytes: Vec<u8>) -> String {
        read(bytes).unwrap_err().to_string()
    }

    #[test]
    fn every_compression_reads_the_same_and_holes_stay_where_they_are() {
        for compression in [
            Compression::UNCOMPRESSED,
            Compression::SNAPPY,
            Compression::ZSTD(ZstdLevel::default()),
            Compression::GZIP(GzipLevel::default()),
        ] {
            let columns = [
                Values::Held(&[1.0 / 3.0, -1e-300], &[1, 0, 1]),
                Values::Reals(&[0.0, 0.1, 0.2]),
            ];
            let bytes = file(
                "optional double u; required double time;",
                compression,
                &columns,
            );
            let (record, said) = read(bytes).unwrap();
            assert_eq!(record.time(), [0.0, 0.1, 0.2]);
            let u = record.column("u").unwrap();
            assert_eq!((u[0], u[2]), (1.0 / 3.0, -1e-300));
            assert_eq!(record.missing(), [("u", 1)]);
            assert_eq!(said, "");
        }
    }

    #[test]
    fn instants_of_every_unit_become_seconds() {
        let kinds = [
            ("TIMESTAMP(MILLIS,true)", 1_000),
            ("TIMESTAMP(MICROS,false)", 1_000_000),
            ("TIMESTAMP(NANOS,true)", 1_000_000_000),
            ("TIME(MICROS,true)", 1_000_000),
        ];
        for (kind, second) in kinds {
            // Nanoseconds since 1970 are beyond what a float can count.
            let begin = 1_700_000_000 * second;
            let times = [begin, begin + second / 100, begin + second / 10];
            let schema = format!("required int64 time ({kind}); required int64 u;");
            let columns = [Values::Whole(&times), Values::Whole(&[-1, 0, 1 << 40])];
            let (record, said) = read(file(&schema, Compression::SNAPPY, &columns)).unwrap();
            assert_eq!(record.time(), [0.0, 0.01, 0.1]);
            assert_eq!(
                record.column("u"),
                Some([-1.0, 0.0, 1_099_511_627_776.0].as_slice())
            );
            assert_eq!(said, "`time` taken as seconds since the first row");
        }
    }

    #[test]
    fn what_is_no_table_of_numbers_is_refused_by_name() {
        let plain = Compression::UNCOMPRESSED;
        let text = [Values::Reals(&[0.0]), Values::Text(&["abc"])];
        assert_eq!(
            refused(file(
                "required double time; required binary operator (UTF8);",
                plain,
                &text
            )),
            "run.parquet: column `operator` holds text or objects; numbers are needed: convert it with pandas.to_numeric, or \
             leave the column out"
        );
        let nested = [Values::Reals(&[0.0])];
        let message = refused(file(
            "required group disc { required double angle; }",
            plain,
            &nested,
        ));
        assert!(
            message.contains("column `disc.angle` holds lists or structures"),
            "{message}"
        );
        let schema = "required double time;";
        assert!(refused(file(schema, plain, &[Values::Reals(&[])])).contains("no sample"));
        let message = refused(file(schema, plain, &[Values::Reals(&[0.0, 0.0])]));
        assert!(
            message.contains("run.parquet row 1, column `time`: 0 s comes after 0 s"),
            "{message}"
        );
        let message = refused(file("required double u;", plain, &[Values::Reals(&[0.0])]));
        assert_eq!(message, "run.parquet: has no column `time`; it has u");
        let columns = [Values::Reals(&[0.0]), Values::Reals(&[f64::INFINITY])];
        let message = refused(file(
            "required double time; required double u;",
            plain,
            &columns,
        ));
        assert!(
            message.contains("row 0, column `u`: `inf` is not finite"),
            "{message}"
        );
    }

    #[test]
    fn an_index_without_a_name_is_the_time() {
        let columns = [Values::Reals(&[1.0, 2.0]), Values::Reals(&[0.0, 0.5])];
        let schema = "required double u; required double __index_level_0__;";
        let (record, said) = read(file(schema, Compression::SNAPPY, &columns)).unwrap();
        assert_eq!(record.time(), [0.0, 0.5]);
        assert_eq!(said, "the index without a name taken as time");
    }

    #[test]
    fn damage_is_told_wherever_it_is() {
        let many: Vec<f64> = (0..500).map(f64::from).collect();
        let columns = [Values::Reals(&many), Values::Held(&many, &[1; 500])];
        let schema = "required double time; optional double u;";
        for compression in [
            Compression::UNCOMPRESSED,
            Compression::SNAPPY,
            Compression::ZSTD(ZstdLevel::default()),
        ] {
            let whole = file(schema, compression, &columns);
            for length in 0..whole.len() {
                assert!(read(whole[..length].to_vec()).is_err(), "{length}");
            }
            for at in 0..whole.len() {
                for flip in [0x01, 0x80, 0xff] {
                    let mut changed = whole.clone();
                    changed[at] ^= flip;
                    // A changed number may be one, too.
                    let _ = read(changed);
                }
            }
        }
    }
}
