//! The records of a studio: those of the case and those that were dropped onto the page.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::UNIX_EPOCH;

use axum::body::Bytes;
use serde_json::{Value, json};

use super::choices::{Believed, Role, Use};
use super::error::StudioError;
use super::seen::{Seen, channels, see};
use super::session::{Reading, Session};
use crate::diagnose::record_part::Part;
use crate::diagnose::rig_columns::RigColumns;
use crate::files::record::{file_and_sheet, sheets};

/// A record and what it is for where nobody said otherwise.
#[derive(Debug, Clone)]
pub struct Known {
    /// Its name on the page: that of its file.
    pub name: String,
    /// The file.
    pub path: PathBuf,
    role: Role,
}

fn known(part: &Part, role: Role) -> Known {
    let name = part.path.file_name();
    Known {
        name: name.map_or_else(String::new, |name| name.to_string_lossy().into_owned()),
        path: part.path.clone(),
        role,
    }
}

impl Session {
    /// All records.
    pub fn records(&self) -> Vec<Known> {
        let material = &self.base.material;
        let learned = material.records.iter().map(|part| known(part, Role::Learn));
        let held_out = material
            .held_out
            .iter()
            .map(|part| known(part, Role::HoldOut));
        let mut all: Vec<Known> = learned.chain(held_out).collect();
        let dropped = self.choices().dropped.into_iter();
        all.extend(dropped.map(|name| Known {
            path: self.folder.dropped().join(&name),
            name,
            role: Role::Learn,
        }));
        all
    }

    fn record(&self, name: &str) -> Result<Known, StudioError> {
        let found = self
            .records()
            .into_iter()
            .find(|record| record.name == name);
        found.ok_or_else(|| StudioError::Unknown(name.to_owned()))
    }

    /// What each record, or part of one, is for.
    pub fn uses(&self) -> Vec<Use> {
        let choices = self.choices();
        let mut all = Vec::new();
        for record in self.records() {
            let chosen = choices.uses.iter().filter(|own| own.record == record.name);
            let before = all.len();
            all.extend(chosen.cloned());
            if all.len() == before {
                all.push(Use {
                    record: record.name,
                    span: None,
                    role: record.role,
                });
            }
        }
        all
    }

    /// The parts of records with this role.
    pub fn parts(&self, role: Role) -> Vec<Part> {
        let records = self.records();
        let uses = self.uses();
        let of = |used: &Use| {
            let record = records.iter().find(|record| record.name == used.record)?;
            Some(Part {
                path: record.path.clone(),
                span: used.span.map(|[from, to]| (from, to)),
                table: None,
            })
        };
        uses.iter()
            .filter(|used| used.role == role)
            .filter_map(of)
            .collect()
    }

    /// Keeps a file that was dropped onto the page: a record, a record for each sheet of a workbook, or a model that is
    /// believed from then on.
    ///
    /// # Errors
    /// The name is no record's or model's, the file cannot be written, or the model is none.
    pub fn drop_file(&self, name: &str, content: &[u8]) -> Result<(), StudioError> {
        let is_model = name.to_ascii_lowercase().ends_with(".toml");
        if is_model {
            let text = std::str::from_utf8(content).map_err(|_| {
                StudioError::Input(format!("{name}: is no text; a model file is needed"))
            })?;
            super::models::described(text, name)?;
        } else if self.base_has(name) {
            return Err(StudioError::Input(format!(
                "{name}: the case has a record of this name; give the file another one"
            )));
        }
        let path = self.folder.drop_file(name, content)?;
        let name = path
            .file_name()
            .map(|name| name.to_string_lossy().into_owned());
        let name = name.unwrap_or_default();
        let mut records: Vec<String> = sheets(content)
            .iter()
            .map(|sheet| format!("{name}#{sheet}"))
            .collect();
        if records.is_empty() {
            records.push(name.clone());
        }
        self.change(false, |choices| {
            if is_model {
                choices.believed = Believed::Dropped(name);
                choices.settings.remove(super::models::BELIEVED);
            } else {
                records.retain(|record| !choices.dropped.contains(record));
                choices.dropped.append(&mut records);
            }
        })
    }

    fn base_has(&self, name: &str) -> bool {
        let material = &self.base.material;
        let mut parts = material.records.iter().chain(&material.held_out);
        parts.any(|part| {
            part.path
                .file_name()
                .is_some_and(|own| own.to_string_lossy() == name)
        })
    }

    /// Takes a file that was dropped onto the page away again; the file itself stays in the folder.
    ///
    /// # Errors
    /// The choice cannot be kept.
    pub fn forget(&self, name: &str) -> Result<(), StudioError> {
        self.change(false, |choices| {
            choices.dropped.retain(|own| own != name);
            choices.uses.retain(|own| own.record != name);
        })
    }

    /// A record, read.
    ///
    /// # Errors
    /// It cannot be used; the message says what would be right.
    pub fn seen(&self, name: &str) -> Result<Arc<Seen>, StudioError> {
        self.reading(name)?.seen.map_err(StudioError::Input)
    }

    /// What is read of a record; a second time from memory, as long as file, model and columns are the same.
    fn reading(&self, name: &str) -> Result<Reading, StudioError> {
        let record = self.record(name)?;
        let material = self.material()?;
        let (file, _) = file_and_sheet(&record.path);
        let stamp = std::fs::metadata(file).ok().map(|file| {
            let time = file
                .modified()
                .ok()
                .and_then(|time| time.duration_since(UNIX_EPOCH).ok());
            (file.len(), time)
        });
        let key = format!(
            "{} {stamp:?} {}",
            record.path.display(),
            material.model_text
        );
        if let Some(reading) = self.remembered(&key) {
            return Ok(reading);
        }
        let columns = RigColumns::split_off(&material.model_text, &material.model_name);
        let columns = columns.map(|(columns, _)| columns).unwrap_or_default();
        let headings = columns.headings(&record.path).unwrap_or_default();
        let seen = if material.is_of_small_plant() {
            Err("this model is a small plant's: its records are read by the diagnosis, and its report has the curves".to_owned())
        } else {
            let seen = see(&material, &Part::whole(record.path));
            seen.map(Arc::new)
                .map_err(|error| StudioError::from(error).to_string())
        };
        let reading = Reading {
            headings: Arc::new(headings),
            seen,
        };
        self.remember(key, reading.clone());
        Ok(reading)
    }

    /// The curves of a record.
    ///
    /// # Errors
    /// As for [`Self::seen`].
    pub fn curves(&self, name: &str) -> Result<Bytes, StudioError> {
        let seen = self.seen(name)?;
        let deviations: serde_json::Map<String, Value> = channels()
            .filter(|(channel, _)| seen.has(*channel))
            .map(|(channel, name)| (name.to_owned(), json!(seen.judging.deviations[channel])))
            .collect();
        Ok(seen.measured().answer(json!({
            "record": name,
            "begins": seen.begins(),
            "deviations": deviations,
        })))
    }

    /// All records for the page.
    pub fn records_told(&self) -> Vec<Value> {
        let uses = self.uses();
        let dropped = self.choices().dropped;
        let all = self.records();
        let told = all.iter().map(|record| {
            let own: Vec<&Use> = uses
                .iter()
                .filter(|own| own.record == record.name)
                .collect();
            let mut told = json!({
                "name": record.name,
                "dropped": dropped.contains(&record.name),
                "uses": own,
                "headings": [],
            });
            let reading = self.reading(&record.name);
            if let Ok(reading) = &reading {
                told["headings"] = json!(*reading.headings);
            }
            match reading.and_then(|reading| reading.seen.map_err(StudioError::Input)) {
                Ok(seen) => {
                    let time = seen.record.time();
                    told["begin"] = json!(time.first());
                    told["end"] = json!(time.last());
                    told["rows"] = json!(time.len());
                    told["step"] = json!(seen.record.median_step());
                    told["stretches"] = json!(seen.judging.records.len());
                    told["said"] = json!(seen.said);
                    told["notes"] = json!(seen.notes);
                }
                Err(problem) => told["problem"] = json!(problem.to_string()),
            }
            told
        });
        told.collect()
    }
}
