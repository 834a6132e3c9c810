//! What a report was made of, so that it can be made again: the program, what was typed, the files with their checksums, the instruments.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use sha2::{Digest as _, Sha256};

use super::case::CaseError;
use super::material::Material;
use super::record_part::Part;
use super::report::markup::{escape, table};
use crate::files::record::file_and_sheet;

/// What a report was made of.
#[derive(Debug, Clone)]
pub struct Made {
    /// What was typed; `None` where another program called.
    command: Option<String>,
    /// Of each file what it is, its name, its size and its checksum.
    files: Vec<[String; 4]>,
}

impl Made {
    /// Of a case; `fmu` is its plant, where that is an FMU.
    ///
    /// # Errors
    /// A file cannot be read.
    pub fn of(material: &Material, fmu: Option<&Path>) -> Result<Self, CaseError> {
        let text = |what: &str, name: &str, text: &str| row(what, name, text.as_bytes());
        let mut files = vec![text("model", &material.model_name, &material.model_text)];
        if let Some(path) = fmu {
            files.push(row("plant", &path.display().to_string(), &read(path)?));
        }
        for record in &material.records {
            files.push(of_record("learned from", record)?);
        }
        if let Some(record) = &material.held_out {
            files.push(of_record("held out", record)?);
        }
        let sensors = material.sensors.iter().map(|own| ("instruments", own));
        let effects = material.effects.iter().map(|own| ("effects", own));
        files.extend(
            sensors
                .chain(effects)
                .map(|(what, own)| text(what, &own.0, &own.1)),
        );
        Ok(Self {
            command: material.command.clone(),
            files,
        })
    }

    /// The section of a report; `instruments` in words, where they are known.
    #[must_use]
    pub fn section(&self, instruments: Option<&str>) -> String {
        let mut text = format!(
            "<h2>How this was made</h2>\n<p>By stickslip {}",
            env!("CARGO_PKG_VERSION")
        );
        match &self.command {
            Some(command) => {
                let _ = writeln!(text, ":</p>\n<pre>{}</pre>", escape(command));
            }
            None => text.push_str(", called by another program.</p>\n"),
        }
        let columns = [
            ("what", false),
            ("file", false),
            ("bytes", true),
            ("SHA-256", false),
        ];
        let rows: Vec<Vec<String>> = self.files.iter().map(|row| row.to_vec()).collect();
        text.push_str(&table(&columns, &rows));
        if let Some(instruments) = instruments {
            let _ = writeln!(text, "<p>Instruments: {}.</p>", escape(instruments));
        }
        text
    }
}

fn of_record(what: &str, part: &Part) -> Result<[String; 4], CaseError> {
    let mut name = part.path.display().to_string();
    if let Some((from, to)) = part.span {
        let _ = write!(name, "@{from}:{to}");
    }
    if part.table.is_some() {
        return Ok([
            what.to_owned(),
            name,
            "–".to_owned(),
            "in memory".to_owned(),
        ]);
    }
    Ok(row(what, &name, &read(&file_and_sheet(&part.path).0)?))
}

fn row(what: &str, name: &str, bytes: &[u8]) -> [String; 4] {
    let sum = Sha256::digest(bytes);
    let sum = sum.iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    });
    [
        what.to_owned(),
        name.to_owned(),
        bytes.len().to_string(),
        sum,
    ]
}

fn read(path: &Path) -> Result<Vec<u8>, CaseError> {
    fs::read(path).map_err(|source| CaseError::Read {
        path: path.to_owned(),
        source,
    })
}

/// The command as it was typed, with the program's plain name; words with spaces are quoted.
#[must_use]
pub fn typed() -> String {
    let quoted = |word: String| {
        let is_plain = |letter: char| letter.is_alphanumeric() || "-_./:@=,+".contains(letter);
        match !word.is_empty() && word.chars().all(is_plain) {
            true => word,
            false => format!("'{}'", word.replace('\'', r"'\''")),
        }
    };
    let words = std::env::args_os()
        .skip(1)
        .map(|word| quoted(word.to_string_lossy().into_owned()));
    std::iter::once("stickslip".to_owned())
        .chain(words)
        .collect::<Vec<_>>()
        .join(" ")
}

#[cfg(test)]
mod tests {
    use super::row;

    #[test]
    fn the_checksum_is_that_of_fips_180_4() {
        let [.., bytes, sum] = row("model", "model.toml", b"abc");
        assert_eq!(bytes, "3");
        assert_eq!(
            sum,
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
        );
    }
}
