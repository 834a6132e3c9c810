//! Workbooks that are tables, and those that are none.

use std::fmt::Write as _;
use std::io::Write as _;

use zip::ZipWriter;
use zip::write::SimpleFileOptions;

use super::*;
use crate::files::record::{Dialect, Missing, Record};

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
        write!(
            related,
            r#"<Relationship Id="r{at}" Type="{OFFICE}/worksheet" Target="worksheets/{at}.xml"/>"#
        )
        .unwrap();
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
