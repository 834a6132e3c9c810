//! The studio's folder: what is chosen and found outlives the page and the program.

use std::fs::{self, File, OpenOptions};
use std::io::{Read as _, Seek as _, Write as _};
use std::path::{Path, PathBuf};

use fs4::fs_std::FileExt as _;
use thiserror::Error;

use super::choices::Choices;
use super::error::StudioError;
use crate::diagnose::naming::EXPERIMENT_FILE;
use crate::diagnose::{amend, finding, report};
use crate::files::atomic;
use crate::files::record::ENDINGS;

/// File with what was chosen.
const CHOICES: &str = "studio.json";
/// File that one studio holds as long as it runs.
const LOCK: &str = "studio.lock";
/// Folder with the files that were dropped onto the page.
const DROPPED: &str = "dropped";
/// Folder with the models whose effects were chosen by hand, one folder each.
const BY_HAND: &str = "by-hand";
/// A model whose numbers were set by hand.
pub const OWN_MODEL: &str = "model.toml";
/// Longest name of a file that is dropped.
const LONGEST_NAME: usize = 100;

/// Files of a diagnosis that are handed out, and what they are.
pub const RESULTS: [(&str, &str); 15] = [
    (amend::FILE, "the amended model"),
    (
        "ReducedRig.fmi2.fmu",
        "the amended model as an FMU, FMI 2.0",
    ),
    (
        "ReducedRig.fmi3.fmu",
        "the amended model as an FMU, FMI 3.0",
    ),
    ("FullRig.fmi2.fmu", "the amended model as an FMU, FMI 2.0"),
    ("FullRig.fmi3.fmu", "the amended model as an FMU, FMI 3.0"),
    ("Drive.fmi2.fmu", "the amended model as an FMU, FMI 2.0"),
    ("Drive.fmi3.fmu", "the amended model as an FMU, FMI 3.0"),
    ("Pendulum.fmi2.fmu", "the amended model as an FMU, FMI 2.0"),
    ("Pendulum.fmi3.fmu", "the amended model as an FMU, FMI 3.0"),
    ("Joint.fmi2.fmu", "the amended model as an FMU, FMI 2.0"),
    ("Joint.fmi3.fmu", "the amended model as an FMU, FMI 3.0"),
    ("plant.amended.fmu", "your FMU with the effects"),
    (report::FILE, "the report"),
    (finding::FILE, "the finding, for programs"),
    (
        EXPERIMENT_FILE,
        "inputs of the experiment that would decide",
    ),
];

/// Why a folder cannot be a studio's.
#[derive(Debug, Error)]
pub enum FolderError {
    /// Another studio has it.
    #[error(
        "{path}: is open in another studio{place}; go on there, end it with Ctrl-C, or name another folder with --out"
    )]
    Taken {
        /// The folder.
        path: PathBuf,
        /// Where the other one answers, as half a sentence; may be empty.
        place: String,
    },
    /// The operating system refuses.
    #[error("{path}: cannot be a folder of the studio: {source}; --out names another one")]
    Io {
        /// The folder or file.
        path: PathBuf,
        /// Its reason.
        source: std::io::Error,
    },
    /// What was kept cannot be read.
    #[error("{path}: is not what a studio keeps: {source}; move the file away to begin anew")]
    Choices {
        /// The file.
        path: PathBuf,
        /// What the parser says.
        source: serde_json::Error,
    },
}

/// A folder that this studio alone writes to.
#[derive(Debug)]
pub struct Folder {
    path: PathBuf,
    lock: File,
}

impl Folder {
    /// Takes the folder, which is made where it is missing.
    ///
    /// # Errors
    /// [`FolderError`] where another studio has it or it cannot be made.
    pub fn open(path: &Path) -> Result<Self, FolderError> {
        let failed = |source| FolderError::Io {
            path: path.to_owned(),
            source,
        };
        fs::create_dir_all(path).map_err(failed)?;
        let path = path.canonicalize().map_err(failed)?;
        let mut lock = OpenOptions::new()
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .open(path.join(LOCK))
            .map_err(failed)?;
        if !lock.try_lock_exclusive().map_err(failed)? {
            let mut place = String::new();
            // Some systems let nobody read what is locked.
            let _ = lock.read_to_string(&mut place);
            let place = place.trim();
            return Err(FolderError::Taken {
                place: if place.is_empty() {
                    String::new()
                } else {
                    format!(" ({place})")
                },
                path,
            });
        }
        Ok(Self { path, lock })
    }

    /// Writes into the lock where this studio answers, for another one to tell.
    pub fn tell(&mut self, place: &str) {
        let text = format!("process {}, {place}", std::process::id());
        // It only makes a message clearer.
        let _ = self.lock.set_len(0);
        let _ = self.lock.rewind();
        let _ = self.lock.write_all(text.as_bytes());
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Where files go that are dropped onto the page.
    pub fn dropped(&self) -> PathBuf {
        self.path.join(DROPPED)
    }

    /// Where models go whose effects were chosen by hand.
    pub fn by_hand(&self) -> PathBuf {
        self.path.join(BY_HAND)
    }

    /// What was chosen, if anything was kept.
    ///
    /// # Errors
    /// [`FolderError`] where it cannot be read.
    pub fn choices(&self) -> Result<Choices, FolderError> {
        let path = self.path.join(CHOICES);
        match fs::read_to_string(&path) {
            Ok(text) => {
                serde_json::from_str(&text).map_err(|source| FolderError::Choices { path, source })
            }
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(Choices::default()),
            Err(source) => Err(FolderError::Io { path, source }),
        }
    }

    /// Keeps what was chosen. A folder that is gone is made anew only where `anew` says so.
    ///
    /// # Errors
    /// [`StudioError::Gone`], or what the operating system says.
    pub fn keep(&self, choices: &Choices, anew: bool) -> Result<(), StudioError> {
        if !anew {
            self.check()?;
        }
        let text = serde_json::to_string_pretty(choices).map_err(StudioError::of)?;
        atomic::write_file(&self.path.join(CHOICES), text.as_bytes()).map_err(StudioError::of)
    }

    /// Whether the folder is there.
    ///
    /// # Errors
    /// [`StudioError::Gone`].
    pub fn check(&self) -> Result<(), StudioError> {
        if self.path.is_dir() {
            Ok(())
        } else {
            Err(StudioError::Gone {
                path: self.path.clone(),
            })
        }
    }

    /// Keeps a file that was dropped onto the page, under a name that is safe; the path.
    ///
    /// # Errors
    /// The name is none for a record, or the file cannot be written.
    pub fn drop_file(&self, name: &str, content: &[u8]) -> Result<PathBuf, StudioError> {
        self.check()?;
        let path = self.dropped().join(safe_name(name)?);
        atomic::write_file(&path, content).map_err(StudioError::of)?;
        Ok(path)
    }

    /// Names of the models whose effects were chosen by hand.
    pub fn hands(&self) -> Vec<String> {
        let entries = fs::read_dir(self.by_hand()).into_iter().flatten().flatten();
        let mut names: Vec<String> = entries
            .filter(|entry| entry.path().join(finding::FILE).is_file())
            .map(|entry| entry.file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }

    /// The path of a result; of the diagnosis, or of the model chosen by `hand`.
    ///
    /// # Errors
    /// [`StudioError::Unknown`] for anything that is no result.
    pub fn result(&self, hand: Option<&str>, name: &str) -> Result<PathBuf, StudioError> {
        let unknown = || StudioError::Unknown(name.to_owned());
        let directory = match hand {
            None => self.path.clone(),
            Some(hand) => {
                // Only what is really there, by its name in the listing.
                let own = self.hands().into_iter().find(|own| own == hand);
                self.by_hand().join(own.ok_or_else(unknown)?)
            }
        };
        let known = RESULTS.iter().find(|(own, _)| *own == name);
        let path = directory.join(known.ok_or_else(unknown)?.0);
        if path.is_file() {
            Ok(path)
        } else {
            Err(unknown())
        }
    }
}

/// A file name that stays inside its folder on every system.
fn safe_name(name: &str) -> Result<String, StudioError> {
    let safe: String = name
        .chars()
        .map(|c| {
            if c.is_ascii_alphanumeric() || "._-".contains(c) {
                c
            } else {
                '_'
            }
        })
        .collect();
    let safe = safe.trim_start_matches('.');
    let ending = Path::new(safe).extension();
    let ending = ending.map(|own| own.to_string_lossy().to_ascii_lowercase());
    let is_known = ending.is_some_and(|own| {
        ENDINGS
            .iter()
            .chain(&["txt", "toml"])
            .any(|end| own == *end)
    });
    if is_known && safe.len() <= LONGEST_NAME {
        Ok(safe.to_owned())
    } else {
        Err(StudioError::Input(format!(
            "{name}: a record is a file .csv, .txt, .parquet or .xlsx, a model a file .toml, with a name of at most {LONGEST_NAME} letters"
        )))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_stay_inside_the_folder() {
        assert_eq!(safe_name("run-a.csv").unwrap(), "run-a.csv");
        assert_eq!(safe_name("../../etc/x.csv").unwrap(), "_.._etc_x.csv");
        assert_eq!(safe_name("a#b.xlsx").unwrap(), "a_b.xlsx");
        assert_eq!(safe_name("Messung 1@2.CSV").unwrap(), "Messung_1_2.CSV");
        for wrong in [
            "",
            ".csv",
            "x.exe",
            "x",
            &format!("{}.csv", "x".repeat(200)),
        ] {
            assert!(safe_name(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_folder_has_one_studio() {
        let place = tempfile::tempdir().unwrap();
        let mut one = Folder::open(place.path()).unwrap();
        one.tell("http://127.0.0.1:1");
        let error = Folder::open(place.path()).unwrap_err().to_string();
        assert!(
            error.contains("another studio") && error.contains("http://127.0.0.1:1"),
            "{error}"
        );
        drop(one);
        assert!(Folder::open(place.path()).is_ok());
    }

    #[test]
    fn only_results_are_handed_out() {
        let place = tempfile::tempdir().unwrap();
        let folder = Folder::open(place.path()).unwrap();
        fs::write(place.path().join("secret.txt"), "x").unwrap();
        fs::write(place.path().join(report::FILE), "x").unwrap();
        assert!(folder.result(None, report::FILE).is_ok());
        for name in ["secret.txt", "../x", "studio.json", finding::FILE] {
            assert!(folder.result(None, name).is_err(), "{name}");
        }
        assert!(folder.result(Some(".."), report::FILE).is_err());
    }

    #[test]
    fn what_was_chosen_is_kept_and_a_lost_folder_is_told() {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("studio");
        let folder = Folder::open(&path).unwrap();
        let mut choices = Choices::default();
        choices.without.push("stribeck".to_owned());
        folder.keep(&choices, false).unwrap();
        assert_eq!(folder.choices().unwrap().without, choices.without);
        fs::remove_dir_all(&path).unwrap();
        assert!(matches!(
            folder.keep(&choices, false),
            Err(StudioError::Gone { .. })
        ));
        folder.keep(&choices, true).unwrap();
        assert_eq!(folder.choices().unwrap().without, choices.without);
    }
}
