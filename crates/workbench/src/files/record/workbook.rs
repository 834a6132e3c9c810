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
mod tests;
