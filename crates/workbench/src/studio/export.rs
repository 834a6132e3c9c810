//! What is taken along: files, and the lines of Python and of the shell that repeat it.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use super::choices::Role;
use super::error::StudioError;
use super::folder::RESULTS;
use super::session::Session;
use crate::diagnose::record_part::Part;

/// Name of the script.
pub const SCRIPT: &str = "repeat.py";
/// Name of the model file that script and shell read.
pub const MODEL: &str = "model.studio.toml";

impl Session {
    /// The results that can be taken along.
    pub fn files(&self) -> Vec<Value> {
        let hands = self.folder.hands();
        let places = std::iter::once(None).chain(hands.iter().map(Some));
        let mut files = Vec::new();
        for hand in places {
            for (name, what) in RESULTS {
                let Ok(path) = self.folder.result(hand.map(String::as_str), name) else {
                    continue;
                };
                let bytes = std::fs::metadata(path).map_or(0, |file| file.len());
                files.push(json!({"hand": hand, "name": name, "what": what, "bytes": bytes}));
            }
        }
        files
    }

    /// The model that is believed, with the columns that were chosen.
    ///
    /// # Errors
    /// It cannot be read.
    pub fn model_file(&self) -> Result<String, StudioError> {
        Ok(self.material()?.model_text)
    }

    /// The Python lines that repeat the diagnosis.
    ///
    /// # Errors
    /// The model that is believed cannot be read.
    pub fn script(&self) -> Result<String, StudioError> {
        let material = self.material()?;
        let mut text = format!(
            "\"\"\"What was done in the studio on {}, in lines. Beside this file: {MODEL}, the model that is believed.\"\"\"\n\n\
             import pathlib\n\nimport stickslip\n\nhere = pathlib.Path(__file__).parent\n",
            material.name.replace(['\\', '"'], " ")
        );
        let learned: Vec<String> = self.parts(Role::Learn).iter().map(python_part).collect();
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "case = stickslip.Case(\n    here / {},\n    records=[{}],",
            quoted(MODEL),
            learned.join(", ")
        );
        if let Some(part) = &material.held_out {
            let _ = writeln!(text, "    held_out={},", python_part(part));
        }
        if let Some((name, _)) = &material.sensors {
            let _ = writeln!(text, "    sensors={},", quoted(&absolute(Path::new(name))));
        }
        if !material.effects.is_empty() {
            let files: Vec<String> = material
                .effects
                .iter()
                .map(|(name, _)| quoted(&absolute(Path::new(name))))
                .collect();
            let _ = writeln!(text, "    effects=[{}],", files.join(", "));
        }
        if !material.without.is_empty() {
            let names: Vec<String> = material.without.iter().map(|name| quoted(name)).collect();
            let _ = writeln!(text, "    without=[{}],", names.join(", "));
        }
        text.push_str(
            ")\nfinding = case.diagnose(out=here / \"result\")\nprint(finding)\n\
             finding.amended.build_fmu(here / \"fmu\")\n",
        );
        Ok(text)
    }

    /// The command that repeats the diagnosis.
    ///
    /// # Errors
    /// The model that is believed cannot be read.
    pub fn shell(&self) -> Result<String, StudioError> {
        let material = self.material()?;
        let mut words = vec![
            "stickslip diagnose --model".to_owned(),
            MODEL.to_owned(),
            "--records".to_owned(),
        ];
        words.extend(
            material
                .records
                .iter()
                .map(|part| shell_word(&part_text(part))),
        );
        if let Some(part) = &material.held_out {
            words.extend(["--held-out".to_owned(), shell_word(&part_text(part))]);
        }
        if let Some((name, _)) = &material.sensors {
            words.extend([
                "--sensors".to_owned(),
                shell_word(&absolute(Path::new(name))),
            ]);
        }
        if let Some((name, _)) = material.effects.first() {
            let directory = Path::new(name).parent().unwrap_or(Path::new("."));
            words.extend(["--catalogue".to_owned(), shell_word(&absolute(directory))]);
        }
        for name in &material.without {
            words.extend(["--without".to_owned(), shell_word(name)]);
        }
        words.push("--out result".to_owned());
        Ok(words.join(" "))
    }
}

fn absolute(path: &Path) -> String {
    let full: PathBuf = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    full.display().to_string()
}

/// A part as the command line and Python take it.
fn part_text(part: &Part) -> String {
    let path = absolute(&part.path);
    match part.span {
        Some((from, to)) => format!("{path}@{from}:{to}"),
        None => path,
    }
}

fn python_part(part: &Part) -> String {
    quoted(&part_text(part))
}

/// A string of Python; JSON's escapes are Python's.
fn quoted(text: &str) -> String {
    json!(text).to_string()
}

fn shell_word(text: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "/._-+@:".contains(c);
    if !text.is_empty() && text.chars().all(is_plain) {
        text.to_owned()
    } else {
        format!("'{}'", text.replace('\'', "'\\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_with_blanks_and_quotes_survive() {
        assert_eq!(shell_word("/a/run-b.csv@0:5"), "/a/run-b.csv@0:5");
        assert_eq!(shell_word("it's"), "'it'\\''s'");
        assert_eq!(quoted("a \"b\" \\ c"), r#""a \"b\" \\ c""#);
    }
}
