//! Excel workbooks (.xlsx).

use std::collections::BTreeSet;
use std::io::{self, Cursor, Read as _};

use calamine::{CellErrorType, DataRef, Reader as _, SheetType, Xlsx};
use zip::ZipArchive;

use super::error::RecordError;
use super::table::{MOST_VALUES, Places, Table};

/// What a workbook has inside.
const CONTENT: &str = "xl/workbook.xml";
/// Most bytes of a workbook once it is unpacked: a few bytes of an archive may stand for any number of them.
const MOST_BYTES: u64 = 1 << 30;
/// Fewest columns of a table: a list of names and numbers is none.
const FEWEST_COLUMNS: usize = 2;
/// Seconds of a day, in which a workbook counts time.
const DAY: f64 = 86_400.0;
/// Parts of a second that its number of days still tells.
const TOLD: f64 = 1e5;

type Book = Xlsx<Cursor<Vec<u8>>>;

/// What a cell holds.
#[derive(Debug)]
enum Content {
    Number(f64),
    /// Days since some day.
    Days(f64),
    Text(Box<str>),
}

/// A cell that is not empty.
#[derive(Debug)]
struct Cell {
    row: u32,
    column: u32,
    content: Content,
}

/// A sheet's cells by row and column, from the row of names on.
struct Sheet {
    name: String,
    cells: Vec<Cell>,
}

/// Whether a file is of this kind.
pub(super) fn is_one(bytes: &[u8]) -> bool {
    bytes.starts_with(b"PK\x03\x04")
        && ZipArchive::new(Cursor::new(bytes))
            .is_ok_and(|book| book.index_for_name(CONTENT).is_some())
}

/// Names of the sheets with a table, of a workbook that has several; none of any other file.
#[must_use]
pub fn sheets(bytes: &[u8]) -> Vec<String> {
    if !is_one(bytes) {
        return Vec::new();
    }
    let found = open(bytes.to_vec(), "").and_then(|mut book| with_tables(&mut book, ""));
    let names: Vec<String> = found
        .into_iter()
        .flatten()
        .map(|sheet| sheet.name)
        .collect();
    if names.len() > 1 { names } else { Vec::new() }
}

/// The table in a workbook of this content: that of the sheet, or the only one.
pub(super) fn table(bytes: Vec<u8>, file: &str, sheet: Option<&str>) -> Result<Table, RecordError> {
    let mut book = open(bytes, file)?;
    let all = names(&book);
    let wrong = |problem: String| RecordError::Sheet {
        file: file.to_owned(),
        problem,
        sheets: all.join(", "),
    };
    const NEEDED: &str = "a row of names above rows of numbers";
    if let Some(name) = sheet {
        if !all.iter().any(|own| own == name) {
            return Err(wrong(format!("has no sheet `{name}`")));
        }
        let own = read(&mut book, name, file)?;
        let own = own.ok_or_else(|| wrong(format!("its sheet `{name}` has not {NEEDED}")))?;
        return own.table(file, Vec::new());
    }
    let mut found = with_tables(&mut book, file)?;
    match (found.pop(), found.last()) {
        (None, _) => Err(wrong(format!("has no sheet with {NEEDED}"))),
        (Some(only), None) => {
            let said = (all.len() > 1).then(|| format!("sheet `{}`", only.name));
            only.table(file, said.into_iter().collect())
        }
        (Some(last), Some(other)) => Err(wrong(format!(
            "has tables in {} sheets; say which one is meant, such as `{file}#{}` or `{file}#{}`",
            found.len() + 1,
            other.name,
            last.name
        ))),
    }
}

fn damaged(file: &str, reason: &impl ToString) -> RecordError {
    RecordError::Damaged {
        file: file.to_owned(),
        kind: "Excel workbook",
        reason: reason.to_string(),
    }
}

fn open(bytes: Vec<u8>, file: &str) -> Result<Book, RecordError> {
    // The reader of workbooks unpacks texts and styles whole, and sizes that an archive states may be wrong.
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(|error| damaged(file, &error))?;
    let mut left = MOST_BYTES;
    for at in 0..archive.len() {
        let part = archive
            .by_index(at)
            .map_err(|error| damaged(file, &error))?;
        let size = io::copy(&mut part.take(left + 1), &mut io::sink());
        let size = size.map_err(|error| damaged(file, &error))?;
        left = left
            .checked_sub(size)
            .ok_or_else(|| RecordError::TooLarge {
                file: file.to_owned(),
                found: format!("over {} MiB once it is unpacked", MOST_BYTES >> 20),
                most: format!("{} MiB", MOST_BYTES >> 20),
            })?;
    }
    Xlsx::new(archive.into_inner()).map_err(|error| damaged(file, &error))
}

fn names(book: &Book) -> Vec<String> {
    let sheets = book.sheets_metadata().iter();
    sheets
        .filter(|sheet| sheet.typ == SheetType::WorkSheet)
        .map(|sheet| sheet.name.clone())
        .collect()
}

/// The sheets that have a table.
fn with_tables(book: &mut Book, file: &str) -> Result<Vec<Sheet>, RecordError> {
    let sheets = names(book).into_iter();
    sheets
        .filter_map(|name| read(book, &name, file).transpose())
        .collect()
}

/// A sheet, if it has a table.
fn read(book: &mut Book, name: &str, file: &str) -> Result<Option<Sheet>, RecordError> {
    let failed = |error| damaged(file, &format!("sheet `{name}`: {error}"));
    let mut reader = book.worksheet_cells_reader(name).map_err(failed)?;
    let mut cells = Vec::new();
    while let Some(cell) = reader.next_cell().map_err(failed)? {
        let (row, column) = cell.get_position();
        let content = match cell.get_value() {
            DataRef::Empty | DataRef::Error(CellErrorType::NA) => continue,
            DataRef::Int(value) => Content::Number(*value as f64),
            DataRef::Float(value) => Content::Number(*value),
            DataRef::Bool(value) => Content::Number(f64::from(u8::from(*value))),
            DataRef::DateTime(days) => Content::Days(days.as_f64()),
            DataRef::Error(error) => Content::Text(error.to_string().into()),
            DataRef::SharedString(text) => Content::Text((*text).trim().into()),
            DataRef::String(text) | DataRef::DateTimeIso(text) | DataRef::DurationIso(text) => {
                Content::Text(text.trim().into())
            }
        };
        if !matches!(&content, Content::Text(text) if text.is_empty() || text.eq_ignore_ascii_case("nan"))
        {
            cells.push(Cell {
                row,
                column,
                content,
            });
        }
        if cells.len() > MOST_VALUES {
            return Err(too_large(
                file,
                format!("over {MOST_VALUES} cells in the sheet `{name}`"),
            ));
        }
    }
    cells.sort_by_key(|cell| (cell.row, cell.column));
    let rows: Vec<&[Cell]> = cells.chunk_by(|one, other| one.row == other.row).collect();
    let mut header = (FEWEST_COLUMNS - 1, None);
    for pair in rows.windows(2) {
        let columns = columns_named(pair[0], pair[1]);
        if columns > header.0 {
            header = (columns, Some(pair[0][0].row));
        }
    }
    Ok(header.1.map(|row| {
        cells.retain(|cell| cell.row >= row);
        Sheet {
            name: name.to_owned(),
            cells,
        }
    }))
}

fn too_large(file: &str, found: String) -> RecordError {
    RecordError::TooLarge {
        file: file.to_owned(),
        found,
        most: format!("{MOST_VALUES} values"),
    }
}

/// How many numbers of `below` have a name in `row`, which must hold nothing but names.
fn columns_named(row: &[Cell], below: &[Cell]) -> usize {
    let is_text = |cell: &&Cell| matches!(cell.content, Content::Text(_));
    if !row.iter().all(|cell| is_text(&cell)) {
        return 0;
    }
    let numbers = below.iter().filter(|cell| !is_text(cell));
    let is_named = |cell: &&Cell| {
        row.binary_search_by_key(&cell.column, |own| own.column)
            .is_ok()
    };
    numbers.filter(is_named).count()
}

impl Sheet {
    fn table(self, file: &str, mut said: Vec<String>) -> Result<Table, RecordError> {
        let mut rows = self.cells.chunk_by(|one, other| one.row == other.row);
        let header = rows.next().unwrap_or_default();
        let rows: Vec<&[Cell]> = rows.collect();
        let places: BTreeSet<u32> = self.cells.iter().map(|cell| cell.column).collect();
        if rows.len().saturating_mul(places.len()) > MOST_VALUES {
            let found = format!("{} rows of {} columns", rows.len(), places.len());
            return Err(too_large(file, found));
        }
        let mut columns = Vec::new();
        for place in places {
            let at = |row: &[Cell]| row.binary_search_by_key(&place, |cell| cell.column).ok();
            let name = match at(header).map(|at| &header[at].content) {
                Some(Content::Text(name)) => name.to_string(),
                _ => String::new(),
            };
            let (mut first, mut is_plain) = (None, false);
            let mut values = Vec::with_capacity(rows.len());
            for row in &rows {
                let value = match at(row).map(|at| &row[at].content) {
                    None => Ok(f64::NAN),
                    Some(Content::Number(value)) if first.is_none() => {
                        is_plain = true;
                        Ok(*value)
                    }
                    Some(Content::Days(days)) if !is_plain => {
                        let seconds = (days - *first.get_or_insert(*days)) * DAY;
                        Ok((seconds * TOLD).round() / TOLD)
                    }
                    Some(Content::Number(value)) => {
                        Err((value.to_string(), "is no date, unlike those above it"))
                    }
                    Some(Content::Days(days)) => {
                        Err((days.to_string(), "is a date, unlike the numbers above it"))
                    }
                    Some(Content::Text(text)) => Err((text.to_string(), "is text, not a number")),
                };
                values.push(value.map_err(|(found, problem)| RecordError::Value {
                    file: file.to_owned(),
                    place: format!("row {}", row[0].row + 1),
                    column: name.clone(),
                    found,
                    problem,
                })?);
            }
            if first.is_some() {
                said.push(format!("`{name}` taken as seconds since the first row"));
            }
            columns.push((name, values));
        }
        let mut places = Places::from("row", 1);
        places.rows = rows.iter().map(|row| row[0].row as usize + 1).collect();
        Ok(Table::of_numbers(file, columns, places, said))
    }
}

#[cfg(test)]
mod tests {
    use std::fmt::Write as _;
    use std::io::Write as _;

    use zip::ZipWriter;
    use zip::write::SimpleFileOptions;

    use super::super::{Dialect, Missing, Record};
    use super::*;

    /// A workbook with these sheets, each its rows; a cell that begins with `=` is a date, with `!` text, with `#` an error.
    fn book(sheets: &[(&str, &[&str])]) -> Vec<u8> {
        let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
        let mut part = |name: &str, text: &str| {
            archive
                .start_file(name, SimpleFileOptions::default())
                .unwrap();
            archive.write_all(text.as_bytes()).unwrap();
        };
        const OFFICE: &str = "http://schemas.openxmlformats.org/officeDocument/2006/relationships";
        const PACKAGE: &str = "http://schemas.openxmlformats.org/package/2006/relationships";
        const MAIN: &str = "http://schemas.openxmlformats.org/spreadsheetml/2006/main";
        part(
            "_rels/.rels",
            &format!(
                r#"<Relationships xmlns="{PACKAGE}"><Relationship Id="r" Type="{OFFICE}/officeDocument" Target="xl/workbook.xml"/></Relationships>"#
            ),
        );
        part(
            "xl/styles.xml",
            &format!(
                r#"<styleSheet xmlns="{MAIN}"><cellXfs count="2"><xf numFmtId="0"/><xf numFmtId="22"/></cellXfs></styleSheet>"#
            ),
        );
        let (mut listed, mut related) = (String::new(), String::new());
        for (at, (name, rows)) in sheets.iter().enumerate() {
            write!(
                listed,
                r#"<sheet name="{name}" sheetId="{}" r:id="r{at}"/>"#,
                at + 1
            )
            .unwrap();
            write!(related, r#"<Relationship Id="r{at}" Type="{OFFICE}/worksheet" Target="worksheets/{at}.xml"/>"#).unwrap();
            let mut cells = String::new();
            for row in *rows {
                cells.push_str("<row>");
                for cell in row.split('|') {
                    match cell.split_at_checked(1) {
                        Some(("=", days)) => write!(cells, r#"<c s="1"><v>{days}</v></c>"#),
                        Some(("!", text)) => {
                            write!(cells, r#"<c t="inlineStr"><is><t>{text}</t></is></c>"#)
                        }
                        Some(("#", _)) => write!(cells, r#"<c t="e"><v>{cell}</v></c>"#),
                        Some(_) => write!(cells, r#"<c><v>{cell}</v></c>"#),
                        None => write!(cells, "<c></c>"),
                    }
                    .unwrap();
                }
                cells.push_str("</row>");
            }
            part(
                &format!("xl/worksheets/{at}.xml"),
                &format!(r#"<worksheet xmlns="{MAIN}"><sheetData>{cells}</sheetData></worksheet>"#),
            );
        }
        part(
            "xl/workbook.xml",
            &format!(
                r#"<workbook xmlns="{MAIN}" xmlns:r="{OFFICE}"><sheets>{listed}</sheets></workbook>"#
            ),
        );
        part(
            "xl/_rels/workbook.xml.rels",
            &format!(r#"<Relationships xmlns="{PACKAGE}">{related}</Relationships>"#),
        );
        archive.finish().unwrap().into_inner()
    }

    fn read(bytes: Vec<u8>, sheet: Option<&str>) -> Result<(Record, String), RecordError> {
        let table = Table::of_bytes(bytes, "run.xlsx", sheet, Dialect::Any)?;
        let (names, said) = (table.names().to_vec(), table.said().join(", "));
        Ok((table.record(&names, Missing::KeepAsNan)?, said))
    }

    fn refused(sheets: &[(&str, &[&str])]) -> String {
        read(book(sheets), None).unwrap_err().to_string()
    }

    const BENCH: (&str, &[&str]) = ("bench", &["!time|!u", "0|1.5", "0.5|2.5e-3"]);

    #[test]
    fn the_table_is_found_below_what_else_a_sheet_has() {
        let rows: &[&str] = &[
            "!Bench 3",
            "!Gain|3.5",
            "",
            "!u|!time [s]|!N2",
            "1|0|",
            "#N/A|0.5|!NaN",
            "",
            "-2|1|3",
        ];
        let notes: &[&str] = &["!mass|3", "!inertia|0.01"];
        let bytes = book(&[("notes", notes), ("bench", rows)]);
        let table = Table::of_bytes(bytes, "run.xlsx", None, Dialect::Any).unwrap();
        assert_eq!(table.names(), ["u", "time [s]", "N2"]);
        assert_eq!(table.said(), ["sheet `bench`"]);
        let names = ["u", "time", "N2"].map(str::to_owned);
        let record = table.record(&names, Missing::KeepAsNan).unwrap();
        assert_eq!(record.time(), [0.0, 0.5, 1.0]);
        assert_eq!(record.missing(), [("u", 1), ("N2", 0), ("N2", 1)]);
    }

    #[test]
    fn several_tables_want_a_name() {
        let other: (&str, &[&str]) = ("other", &["!time|!u", "0|7"]);
        let message = refused(&[BENCH, other]);
        assert_eq!(
            message,
            "run.xlsx: has tables in 2 sheets; say which one is meant, such as `run.xlsx#bench` or `run.xlsx#other`; it has the \
             sheets bench, other"
        );
        let bytes = book(&[BENCH, other]);
        assert_eq!(sheets(&bytes), ["bench", "other"]);
        assert!(sheets(&book(&[BENCH])).is_empty());
        let (record, said) = read(bytes.clone(), Some("other")).unwrap();
        assert_eq!(
            (record.column("u"), said.as_str()),
            (Some([7.0].as_slice()), "")
        );
        let message = read(bytes, Some("third")).unwrap_err().to_string();
        assert!(
            message.contains("has no sheet `third`; it has the sheets bench, other"),
            "{message}"
        );
        let message = Table::of_bytes(
            b"time,u\n0,1\n".to_vec(),
            "run.csv",
            Some("bench"),
            Dialect::Any,
        );
        assert!(message.unwrap_err().to_string().contains("has no sheets"));
    }

    #[test]
    fn dates_become_seconds() {
        let rows: &[&str] = &[
            "!time|!u",
            "=46000.5|1",
            "=46000.500000115741|2",
            "=46000.500011574074|3",
        ];
        let (record, said) = read(book(&[("bench", rows)]), None).unwrap();
        assert_eq!(record.time(), [0.0, 0.01, 1.0]);
        assert_eq!(said, "`time` taken as seconds since the first row");
    }

    #[test]
    fn messages_name_row_column_and_value() {
        let with = |row: &str| refused(&[("bench", &["!bench 3", "!time|!u", "0|1", row])]);
        assert!(with("1|!abc").contains("run.xlsx row 4, column `u`: `abc` is text, not a number"));
        assert!(with("1|!2.5").contains("row 4, column `u`: `2.5` is text"));
        assert!(with("1|#DIV/0!").contains("row 4, column `u`: `#DIV/0!` is text"));
        assert!(with("=46000|1").contains("row 4, column `time`: `46000` is a date"));
        assert!(with("|1").contains("row 4, column `time`: `NaN` is not finite"));
        assert!(with("0|1").contains("row 4, column `time`: 0 s comes after 0 s"));
        assert!(with("1|2|3").contains("column 3 is named ``, which is empty"));
        for rows in [
            &["!only text", "!more"] as &[&str],
            &[],
            &["!mass|3", "!inertia|0.1"],
        ] {
            let message = refused(&[("notes", rows)]);
            assert!(
                message.contains("has no sheet with a row of names above rows of numbers"),
                "{message}"
            );
        }
    }

    #[test]
    fn damage_is_told_wherever_it_is() {
        let whole = book(&[BENCH]);
        for length in 0..whole.len() {
            assert!(read(whole[..length].to_vec(), None).is_err(), "{length}");
        }
        for at in 0..whole.len() {
            for flip in [0x01, 0x80, 0xff] {
                let mut changed = whole.clone();
                changed[at] ^= flip;
                // A changed number may be one, too.
                let _ = read(changed, None);
            }
        }
    }

    #[test]
    fn a_few_bytes_that_stand_for_gigabytes_are_refused() {
        let mut archive = ZipWriter::new_append(Cursor::new(book(&[BENCH]))).unwrap();
        archive
            .start_file("xl/sharedStrings.xml", SimpleFileOptions::default())
            .unwrap();
        let piece = vec![b' '; 1 << 24];
        for _ in 0..65 {
            archive.write_all(&piece).unwrap();
        }
        let bytes = archive.finish().unwrap().into_inner();
        let message = read(bytes, None).unwrap_err().to_string();
        assert!(
            message.contains("too large, over 1024 MiB once it is unpacked"),
            "{message}"
        );
    }

    #[test]
    fn a_far_cell_is_no_table_of_all_between() {
        // The last cell of a sheet alone in its row.
        let rows: &[&str] = &["!time|!u", "0|1"];
        let mut sheet = Sheet {
            name: "bench".to_owned(),
            cells: read_cells(rows),
        };
        sheet.cells.extend((2..40_000).map(|row| Cell {
            row,
            column: row.min(16_383),
            content: Content::Number(1.0),
        }));
        let message = sheet.table("run.xlsx", Vec::new()).unwrap_err().to_string();
        assert!(message.contains("39999 rows of 16384 columns"), "{message}");
    }

    fn read_cells(rows: &[&str]) -> Vec<Cell> {
        let mut book = open(book(&[("bench", rows)]), "run.xlsx").unwrap();
        super::read(&mut book, "bench", "run.xlsx")
            .unwrap()
            .unwrap()
            .cells
    }
}
