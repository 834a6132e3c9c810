//! Libraries: there, named after the model, for the right machine, complete, willing.

use std::collections::BTreeSet;

use object::Object;

use super::Loading;
use super::description::Description;
use super::finding::{Finding, Rule};
use super::package::Package;
use crate::binary_check::{self, Expectation};
use crate::binary_error::BinaryError;
use crate::library::Library;
use crate::platform::{FmiVersion, Platform};
use crate::symbols;

/// Folders of 32-bit systems and of macOS for both processors: known, their content is not looked at.
const OTHER_FOLDERS: [&str; 8] = [
    "win32",
    "linux32",
    "darwin32",
    "x86-windows",
    "x86-linux",
    "x86-darwin",
    "aarch32-linux",
    "aarch64-windows",
];

pub(super) fn check(
    package: &Package,
    description: &Description,
    loading: Loading,
) -> Vec<Finding> {
    let files: Vec<(&str, &str, &str)> = package
        .names()
        .filter_map(|name| {
            let (folder, file) = name.strip_prefix("binaries/")?.split_once('/')?;
            (!file.contains('/')).then_some((name, folder, file))
        })
        .collect();
    let mut findings = Vec::new();
    let folders: BTreeSet<&str> = files.iter().map(|(_, folder, _)| *folder).collect();
    if folders.is_empty() && !package.names().any(|name| name.starts_with("sources/")) {
        findings.push(Finding::new(
            Rule::Binary,
            "there is neither a library below binaries/ nor source code",
        ));
    }
    for folder in folders {
        let platform = Platform::ALL
            .into_iter()
            .find(|platform| platform.folder(description.version) == folder);
        let Some(platform) = platform else {
            if !OTHER_FOLDERS.contains(&folder) {
                let known = Platform::ALL
                    .map(|platform| platform.folder(description.version))
                    .join(", ");
                let message = format!(
                    "binaries/{folder} is no platform of {}; known: {known}",
                    description.version
                );
                findings.push(Finding::new(Rule::Binary, message));
            }
            continue;
        };
        for (_, identifier) in &description.interfaces {
            let identifier = identifier.as_deref().unwrap_or_default();
            let expected = format!("{identifier}.{}", platform.library_extension());
            match files
                .iter()
                .find(|(_, place, file)| *place == folder && *file == expected)
            {
                Some((path, _, _)) => {
                    findings.extend(library(
                        package,
                        description,
                        platform,
                        identifier,
                        path,
                        loading,
                    ));
                }
                None => {
                    let found: Vec<&str> = files
                        .iter()
                        .filter(|(_, place, _)| *place == folder)
                        .map(|f| f.2)
                        .collect();
                    let message = format!(
                        "binaries/{folder} holds {} but not {expected}",
                        found.join(", ")
                    );
                    findings.push(Finding::new(Rule::BinaryName, message));
                }
            }
        }
    }
    findings
}

fn library(
    package: &Package,
    description: &Description,
    platform: Platform,
    identifier: &str,
    path: &str,
    loading: Loading,
) -> Vec<Finding> {
    // An unreadable file is reported with the archive's rules.
    let Ok(content) = package.read(path) else {
        return Vec::new();
    };
    let file = match object::File::parse(content.as_slice()) {
        Ok(file) => file,
        Err(error) => {
            return vec![Finding::new(
                Rule::BinaryPlatform,
                format!("{path} is no library: {error}"),
            )];
        }
    };
    let (format, architecture) = platform.machine();
    if file.format() != format || file.architecture() != architecture {
        let message = format!(
            "{path} is {:?} for {:?}; its folder says {format:?} for {architecture:?}",
            file.format(),
            file.architecture()
        );
        return vec![Finding::new(Rule::BinaryPlatform, message)];
    }
    let missing = missing_symbols(&file, description);
    if !missing.is_empty() {
        let message = format!(
            "{path} lacks {} functions: {}",
            missing.len(),
            missing.join(", ")
        );
        return vec![Finding::new(Rule::Symbols, message)];
    }
    if loading == Loading::FilesOnly || Platform::current() != Some(platform) {
        return Vec::new();
    }
    let library = Library::new(path.into(), platform, content);
    instantiation(package, description, identifier, &library)
        .into_iter()
        .collect()
}

fn missing_symbols(file: &object::File<'_>, description: &Description) -> Vec<&'static str> {
    let interfaces: Vec<&str> = description
        .interfaces
        .iter()
        .map(|(interface, _)| interface.as_str())
        .collect();
    symbols::missing_from(file, symbols::required_by(description.version, &interfaces))
}

/// Instantiates with the token of the description, co-simulation only; the resources go to a folder of our own.
fn instantiation(
    package: &Package,
    description: &Description,
    identifier: &str,
    library: &Library,
) -> Option<Finding> {
    if !description
        .interfaces
        .iter()
        .any(|(interface, _)| interface == "CoSimulation")
    {
        return None;
    }
    let token = match description.version {
        FmiVersion::Fmi2 => description.root.get("guid"),
        FmiVersion::Fmi3 => description.root.get("instantiationToken"),
    };
    let resources: Vec<(String, Vec<u8>)> = package
        .names()
        .filter_map(|name| {
            let file = name.strip_prefix("resources/")?;
            Some((file.to_owned(), package.read(name).ok()?))
        })
        .collect();
    let expectation = Expectation {
        model_identifier: identifier,
        token: token?,
        resources: &resources,
    };
    let error: BinaryError =
        binary_check::check(library, description.version, &expectation).err()?;
    Some(Finding::new(Rule::Instantiation, error.to_string()))
}
