//! A studio at work: the case, what was chosen, what was read, and the diagnosis that runs.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use serde_json::{Value, json};
use stickslip::plant::ModelFile;

use super::choices::{Believed, Change, Choices, Role};
use super::diagnosis::Job;
use super::error::StudioError;
use super::folder::{Folder, OWN_MODEL};
use super::models::{self, AMENDED, BELIEVED, Base, HAND};
use super::seen::Seen;
use crate::diagnose::amend;
use crate::diagnose::case::prepare_threads;
use crate::diagnose::catalogue::CATALOGUE;
use crate::diagnose::finding;
use crate::diagnose::material::Material;
use crate::diagnose::rig_columns::{Heading, RigColumns};
use crate::diagnose::rig_variable::{unit_names, variables};
use crate::diagnose::small_plant::case::supposed;
use crate::diagnose::small_plant::model_file::SmallModel;
use crate::diagnose::supposed as own_effects;
use crate::files::atomic;
use inference::body::term::Entry;
use stickslip::body::is_small_plant;

/// Most readings of records that are remembered.
const MOST_REMEMBERED: usize = 24;

/// What was read of a record.
#[derive(Debug, Clone)]
pub struct Reading {
    /// The fields of its header, with what they are taken as.
    pub headings: Arc<Vec<Heading>>,
    /// The record, or why it cannot be used.
    pub seen: Result<Arc<Seen>, String>,
}

/// A studio.
#[derive(Debug)]
pub struct Session {
    /// The case.
    pub base: Base,
    /// Where everything is kept.
    pub folder: Folder,
    /// The library for FMUs, where one is named.
    pub library: Option<PathBuf>,
    choices: Mutex<Choices>,
    readings: Mutex<BTreeMap<String, Reading>>,
    /// What runs, or ran last.
    pub job: Mutex<Option<Arc<Job>>>,
}

/// What a mutex holds, also after somebody failed with it.
pub fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Session {
    /// Begins, with what was kept in the folder.
    ///
    /// # Errors
    /// What was kept cannot be read.
    pub fn open(base: Base, folder: Folder, library: Option<PathBuf>) -> anyhow::Result<Self> {
        prepare_threads();
        let choices = folder.choices()?;
        Ok(Self {
            base,
            folder,
            library,
            choices: Mutex::new(choices),
            readings: Mutex::default(),
            job: Mutex::default(),
        })
    }

    /// What was chosen.
    pub fn choices(&self) -> Choices {
        lock(&self.choices).clone()
    }

    /// Changes what was chosen, and keeps it.
    ///
    /// # Errors
    /// It cannot be kept; it is changed all the same.
    pub fn change(&self, anew: bool, change: impl FnOnce(&mut Choices)) -> Result<(), StudioError> {
        let mut choices = lock(&self.choices);
        change(&mut choices);
        self.folder.keep(&choices, anew)
    }

    /// Takes over what the page changed.
    ///
    /// # Errors
    /// As for [`Self::change`].
    pub fn choose(&self, change: Change) -> Result<(), StudioError> {
        self.change(change.anew, |choices| choices.change(change))
    }

    /// A reading that is remembered.
    pub fn remembered(&self, key: &str) -> Option<Reading> {
        lock(&self.readings).get(key).cloned()
    }

    /// Remembers a reading.
    pub fn remember(&self, key: String, reading: Reading) {
        let mut readings = lock(&self.readings);
        if readings.len() >= MOST_REMEMBERED {
            readings.clear();
        }
        readings.insert(key, reading);
    }

    /// Name and text of the model that is believed, with the columns that were chosen.
    fn believed(&self) -> Result<(String, String), StudioError> {
        let choices = self.choices();
        let (name, text) = match &choices.believed {
            Believed::Case => {
                let material = &self.base.material;
                (material.model_name.clone(), material.model_text.clone())
            }
            Believed::Dropped(name) => named_text(self.folder.dropped().join(name))?,
            Believed::Own => named_text(self.folder.path().join(OWN_MODEL))?,
        };
        let table = choices.columns_table();
        if table.is_empty() {
            return Ok((name, text));
        }
        let (_, rest) = RigColumns::split(&text);
        Ok((name, format!("{rest}\n{table}")))
    }

    /// What a diagnosis would be of.
    ///
    /// # Errors
    /// The model that is believed cannot be read.
    pub fn material(&self) -> Result<Material, StudioError> {
        let (model_name, model_text) = self.believed()?;
        Ok(Material {
            model_name,
            model_text,
            records: self.parts(Role::Learn),
            held_out: self.parts(Role::HoldOut).into_iter().next(),
            without: self.choices().without,
            ..self.base.material.clone()
        })
    }

    /// The text of one of the models, without its columns.
    ///
    /// # Errors
    /// There is no such model, or it cannot be read.
    pub fn model_text(&self, model: &str) -> Result<String, StudioError> {
        if model == BELIEVED {
            let (_, text) = self.believed()?;
            return Ok(RigColumns::split(&text).1);
        }
        let hand = model.strip_prefix(HAND);
        if hand.is_none() && model != AMENDED {
            return Err(StudioError::Unknown(model.to_owned()));
        }
        Ok(named_text(self.folder.result(hand, amend::FILE)?)?.1)
    }

    /// Takes a model with the numbers that were set by hand for the one that is believed from now on.
    ///
    /// # Errors
    /// A number is out of its range, or the model cannot be written.
    pub fn believe(
        &self,
        model: &str,
        settings: &BTreeMap<String, f64>,
    ) -> Result<(), StudioError> {
        self.folder.check()?;
        let text = self.model_text(model)?;
        let mut file = ModelFile::parse(&text, model).map_err(StudioError::of)?;
        for (name, value) in settings {
            file.rig
                .set_parameter(name, *value)
                .map_err(StudioError::of)?;
            if let Some(origin) = file.provenance.get_mut(name) {
                origin.interval95 = None;
                origin.source = None;
                origin.status = None;
            }
        }
        file.rig.check().map_err(StudioError::of)?;
        let (columns, _) = RigColumns::split(&self.base.material.model_text);
        let text = format!("{}\n{columns}", file.to_toml());
        let path = self.folder.path().join(OWN_MODEL);
        atomic::write_file(&path, text.as_bytes()).map_err(StudioError::of)?;
        self.change(false, |choices| {
            choices.believed = Believed::Own;
            choices.settings.remove(BELIEVED);
        })
    }

    /// Goes back to the case's own model.
    ///
    /// # Errors
    /// The choice cannot be kept.
    pub fn believe_case(&self) -> Result<(), StudioError> {
        self.change(false, |choices| {
            choices.believed = Believed::Case;
            choices.settings.remove(BELIEVED);
        })
    }

    /// What a diagnosis depends on, to tell whether a finding is of what is chosen now.
    pub fn inputs(&self) -> Value {
        let model = self.believed().map(|(_, text)| text).unwrap_or_default();
        json!({
            "model": model,
            "uses": self.uses(),
            "without": self.choices().without,
            "effects": self.base.material.effects,
            "sensors": self.base.material.sensors,
        })
    }

    /// The effects that can be named, for the page.
    fn effects(&self) -> Vec<Value> {
        let (name, text) = self.believed().unwrap_or_default();
        if is_small_plant(&text) {
            // What is wrong with the model is told beside the model; with the effects of one's own, where a diagnosis begins.
            let model = SmallModel::parse(&text, &name).ok();
            let all = model.map(|own| {
                let tried = supposed(&self.base.material, &own).unwrap_or_default();
                own.possible(&tried)
            });
            let tell = |entry: &&Entry| told_of(entry.name, entry.description, entry.signature);
            return all.iter().flatten().map(tell).collect();
        }
        let known = CATALOGUE.iter();
        let known = known.map(|entry| told_of(entry.name, entry.description, entry.signature));
        let own = own_effects::read(&self.base.material.effects).unwrap_or_default();
        let own = own.iter().map(|(file, effect)| {
            let definition = effect.definition;
            told_of(
                definition.name(),
                definition.title(),
                &format!("{file}: {}", definition.equation()),
            )
        });
        known.chain(own).collect()
    }

    /// All that the page shows, but for curves.
    pub fn told(&self) -> Value {
        let choices = self.choices();
        let hands = self.folder.hands();
        let inputs = self.inputs();
        let mut names = vec![(BELIEVED.to_owned(), "as believed".to_owned())];
        if self.folder.result(None, amend::FILE).is_ok() {
            names.push((AMENDED.to_owned(), "as amended by the diagnosis".to_owned()));
        }
        names.extend(
            hands
                .iter()
                .map(|hand| (format!("{HAND}{hand}"), format!("by hand: {hand}"))),
        );
        let tell = |(key, label): (String, String)| {
            let mut told = match self.model_text(&key) {
                Ok(text) => models::described(&text, &key).unwrap_or_else(
                    |error| json!({"problem": StudioError::from(error).to_string()}),
                ),
                Err(problem) => json!({"problem": problem.to_string()}),
            };
            told["key"] = json!(key);
            told["label"] = json!(label);
            told
        };
        let models: Vec<Value> = names.into_iter().map(tell).collect();
        let by_hand: Vec<Value> = hands
            .iter()
            .map(|hand| {
                let path = self.folder.result(Some(hand), finding::FILE);
                json!({
                    "name": hand,
                    "finding": path.ok().and_then(|path| json_of(&path)),
                    "is_of_now": choices.fitted.get(hand) == Some(&inputs),
                })
            })
            .collect();
        let found = self.folder.result(None, finding::FILE);
        let found = found.ok().and_then(|path| json_of(&path));
        let asked = choices.asked.as_ref();
        let is_of_now = asked.is_some_and(|asked| asked.inputs == inputs);
        let variables: Vec<Value> = variables()
            .map(|name| json!({"name": name, "units": unit_names(name).collect::<Vec<_>>()}))
            .collect();
        json!({
            "name": self.base.material.name,
            "folder": self.folder.path(),
            "case": self.base.directory,
            "records": self.records_told(),
            "variables": variables,
            "models": models,
            "effects": self.effects(),
            "choices": choices,
            "finding": found,
            "is_of_now": is_of_now,
            "by_hand": by_hand,
            "files": self.files(),
            "diagnosis": self.progress(),
            "most_upload": super::MOST_UPLOAD,
        })
    }
}

fn told_of(name: &str, description: &str, signature: &str) -> Value {
    json!({"name": name, "description": description, "signature": signature})
}

fn named_text(path: PathBuf) -> Result<(String, String), StudioError> {
    let text = std::fs::read_to_string(&path).map_err(|error| {
        StudioError::Input(format!("{}: cannot be read: {error}", path.display()))
    })?;
    Ok((path.display().to_string(), text))
}

fn json_of(path: &std::path::Path) -> Option<Value> {
    serde_json::from_str(&std::fs::read_to_string(path).ok()?).ok()
}
