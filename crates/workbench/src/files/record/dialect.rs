//! Records as other programs write them: UTF-16, semicolons or tabs between values, decimal commas.

use std::borrow::Cow;

/// The text of a file: UTF-8, or UTF-16 with or without the mark at its beginning; `true` beside it for UTF-16.
///
/// # Errors
/// What the file is instead.
pub fn decode(bytes: &[u8]) -> Result<(String, bool), &'static str> {
    const NO_TEXT: &str =
        "is no text; a CSV file is needed, or Parquet, or an Excel workbook (.xlsx)";
    let little = match bytes {
        [0xff, 0xfe, ..] | [_, 0, _, 0, ..] => Some(true),
        [0xfe, 0xff, ..] | [0, _, 0, _, ..] => Some(false),
        _ => None,
    };
    let Some(little) = little else {
        let text = std::str::from_utf8(bytes).map_err(|_| NO_TEXT)?;
        return if text.contains('\0') {
            Err(NO_TEXT)
        } else {
            Ok((text.to_owned(), false))
        };
    };
    let units: Vec<u16> = bytes
        .chunks_exact(2)
        .map(|pair| {
            let pair = [pair[0], pair[1]];
            if little {
                u16::from_le_bytes(pair)
            } else {
                u16::from_be_bytes(pair)
            }
        })
        .collect();
    let text = String::from_utf16(&units).map_err(|_| NO_TEXT)?;
    Ok((text, true))
}

/// What begins a line that is a comment, or the header where no other is.
const COMMENT: [char; 2] = ['#', '%'];

/// The same table with commas between values and decimal points, line by line, and what was found instead.
#[must_use]
pub fn with_commas(text: &str) -> (Cow<'_, str>, Vec<&'static str>) {
    let text = without_comments(text);
    let mut lines = text.lines().filter(|line| !line.trim().is_empty());
    let (header, first) = (lines.next(), lines.next());
    let words = |line: &str| line.split_whitespace().count();
    let (separator, name) = match header {
        Some(line) if line.contains(';') => (';', "semicolons between values"),
        Some(line) if line.contains('\t') => ('\t', "tabs between values"),
        Some(line)
            if !line.contains(',')
                && words(line) > 1
                && first.is_some_and(|own| words(own) == words(line)) =>
        {
            let parts = |line: &str| line.split_whitespace().collect::<Vec<_>>().join(",");
            let lines: Vec<String> = text.lines().map(parts).collect();
            return (Cow::Owned(lines.join("\n")), vec!["spaces between values"]);
        }
        _ => return (text, Vec::new()),
    };
    let mut said = vec![name];
    if text.lines().skip(1).any(|line| line.contains(',')) {
        said.push("decimal commas");
    }
    let lines: Vec<String> = text
        .lines()
        .map(|line| line.replace(',', ".").replace(separator, ","))
        .collect();
    (Cow::Owned(lines.join("\n")), said)
}

/// The same lines with those before the header that are comments left empty. The last of them is the header where numbers follow it.
fn without_comments(text: &str) -> Cow<'_, str> {
    let is_comment = |line: &&str| line.trim().is_empty() || line.starts_with(COMMENT);
    let count = text.lines().take_while(is_comment).count();
    let last = text
        .lines()
        .take(count)
        .filter(|line| !line.trim().is_empty())
        .last();
    let Some(last) = last else {
        return Cow::Borrowed(text);
    };
    let apart = |c: char| c.is_whitespace() || c == ',' || c == ';';
    let is_number = |value: &str| value.is_empty() || value.parse::<f64>().is_ok();
    let following = text.lines().nth(count).unwrap_or_default();
    let header = match following.split(apart).all(is_number) {
        true => last.trim_start_matches(COMMENT).trim_start(),
        false => "",
    };
    // Empty lines in their place, so that messages count as the file does.
    let mut lines = vec![""; count.saturating_sub(1)];
    lines.push(header);
    lines.extend(text.lines().skip(count));
    Cow::Owned(lines.join("\n"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_before_a_header_are_passed_over_and_spaces_part_values() {
        let (text, said) = with_commas("# rig 3\n# in SI\ntime,u\n0.5,1\n");
        assert_eq!(text, "\n\ntime,u\n0.5,1");
        assert!(said.is_empty());
        // As numpy.savetxt writes it.
        let (text, said) = with_commas("# rig 3\n# time u\n0.5 1\n-1e-3  nan\n");
        assert_eq!(text, "\ntime,u\n0.5,1\n-1e-3,nan");
        assert_eq!(said, ["spaces between values"]);
        assert_eq!(with_commas("motor speed\n0.5\n").0, "motor speed\n0.5\n");
    }

    #[test]
    fn tables_of_spreadsheets_read_like_our_own() {
        let (text, said) = with_commas("time;u\r\n0,5;1\r\n\r\n1,5;-2,25e-3\r\n");
        assert_eq!(text, "time,u\n0.5,1\n\n1.5,-2.25e-3");
        assert_eq!(said, ["semicolons between values", "decimal commas"]);
        assert_eq!(with_commas("time\tu\n0.5\t1\n").0, "time,u\n0.5,1");
        assert_eq!(with_commas("time,u\n0.5,1\n").0, "time,u\n0.5,1\n");
    }

    #[test]
    fn utf_16_is_read_in_either_order_with_and_without_its_mark() {
        let text = "time,u\n0,1\n";
        for mark in ["", "\u{feff}"] {
            let units: Vec<u16> = format!("{mark}{text}").encode_utf16().collect();
            let little: Vec<u8> = units.iter().flat_map(|unit| unit.to_le_bytes()).collect();
            let big: Vec<u8> = units.iter().flat_map(|unit| unit.to_be_bytes()).collect();
            for bytes in [little, big] {
                assert_eq!(decode(&bytes), Ok((format!("{mark}{text}"), true)));
            }
        }
        assert!(decode(b"PK\x03\x04\x14\x00\x00").is_err());
    }
}
