//! Effects of one's own, which a diagnosis tries beside those of the catalogue: files with sections `[[effect]]`.

use std::fs;
use std::path::{Path, PathBuf};

use serde::Deserialize;
use stickslip::plant::Supposition;

use super::case::CaseError;
use super::material::named_text;

/// Names and texts of all files *.toml of a directory.
///
/// # Errors
/// There is none, or one cannot be read.
pub fn files(directory: &Path) -> Result<Vec<(String, String)>, CaseError> {
    let entries = fs::read_dir(directory).map_err(|source| CaseError::Read {
        path: directory.to_owned(),
        source,
    })?;
    let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    paths.retain(|path| path.extension().is_some_and(|ending| ending == "toml"));
    paths.sort();
    if paths.is_empty() {
        return Err(CaseError::NoEffects {
            path: directory.to_owned(),
        });
    }
    paths.iter().map(|path| named_text(path)).collect()
}

/// The names of the effects that these files describe, of rigs and of small plants. What else is wrong with them each case says, since
/// it depends on the plant.
///
/// # Errors
/// A file has no sections `[[effect]]` with names.
pub fn names(files: &[(String, String)]) -> Result<Vec<String>, CaseError> {
    #[derive(Deserialize)]
    struct Named {
        name: String,
    }
    #[derive(Deserialize)]
    struct File {
        effect: Vec<Named>,
    }
    let mut all = Vec::new();
    for (file, text) in files {
        let read: Result<File, _> = toml::from_str(text);
        let read = read.map_err(|error| CaseError::NoEffectFile {
            file: file.clone(),
            reason: error.to_string().trim_end().to_owned(),
        })?;
        all.extend(read.effect.into_iter().map(|effect| effect.name));
    }
    Ok(all)
}

/// The effects of these files, each with the name of its file.
///
/// # Errors
/// A file is wrong, or two describe an effect of one name.
pub fn read(files: &[(String, String)]) -> Result<Vec<(&str, Supposition)>, CaseError> {
    let mut all: Vec<(&str, Supposition)> = Vec::new();
    for (file, text) in files {
        for effect in Supposition::read_all(text, file)? {
            let name = effect.definition.name();
            if let Some((earlier, _)) = all.iter().find(|(_, e)| e.definition.name() == name) {
                return Err(CaseError::SameEffect {
                    file: file.clone(),
                    name: name.to_owned(),
                    earlier: (*earlier).to_owned(),
                });
            }
            all.push((file, effect));
        }
    }
    Ok(all)
}
