//! Rules of the archive itself.

use super::finding::{Finding, Rule};
use super::package::Package;
use crate::zip_directory::DirectoryEntry;

const STORED: u16 = 0;
const DEFLATED: u16 = 8;
const ENCRYPTED: u16 = 1;
const ZIP_2_0: u16 = 20;
const UNIX: u8 = 3;
const FILE_TYPE: u32 = 0o170_000;
const REGULAR: u32 = 0o100_000;
const DIRECTORY: u32 = 0o040_000;

pub(super) fn check(package: &Package) -> Vec<Finding> {
    let mut findings: Vec<Finding> = package.directory.iter().flat_map(entry).collect();
    findings.extend(duplicates(&package.directory));
    for name in package.names() {
        if let Err(reason) = package.test(name) {
            findings.push(Finding::new(Rule::Damaged, format!("{name}: {reason}")));
        }
    }
    findings
}

fn entry(entry: &DirectoryEntry) -> Vec<Finding> {
    let mut findings = Vec::new();
    let mut find = |rule, message: String| {
        findings.push(Finding::new(rule, format!("{}: {message}", entry.name)));
    };
    let name = entry.name.trim_end_matches('/');
    if name.contains('\\') {
        find(
            Rule::EntryName,
            "has a backslash; folders are separated by /".to_owned(),
        );
    }
    if name.starts_with('/')
        || name.contains(':')
        || name.split('/').any(|part| matches!(part, "" | "." | ".."))
    {
        find(
            Rule::EntryName,
            "is no plain relative path; an unpacker may write elsewhere".to_owned(),
        );
    }
    if !matches!(entry.method, STORED | DEFLATED) {
        let message = format!(
            "is compressed with method {}; only store (0) and deflate (8) are allowed",
            entry.method
        );
        find(Rule::Compression, message);
    }
    if entry.version_needed > ZIP_2_0 {
        let (major, minor) = (entry.version_needed / 10, entry.version_needed % 10);
        find(
            Rule::ZipVersion,
            format!("needs zip {major}.{minor}; 2.0 is the highest allowed"),
        );
    }
    if entry.flags & ENCRYPTED != 0 {
        find(Rule::Encrypted, "is encrypted".to_owned());
    }
    let kind = (entry.external_attributes >> 16) & FILE_TYPE;
    if entry.system == UNIX && !matches!(kind, 0 | REGULAR | DIRECTORY) {
        find(
            Rule::NotAFile,
            format!("is a link or device (mode {kind:o}), not a file"),
        );
    }
    findings
}

fn duplicates(directory: &[DirectoryEntry]) -> Vec<Finding> {
    let mut names: Vec<(String, &str)> = directory
        .iter()
        .map(|entry| (entry.name.to_lowercase(), entry.name.as_str()))
        .collect();
    names.sort();
    names
        .windows(2)
        .filter(|pair| pair[0].0 == pair[1].0)
        .map(|pair| {
            let message = format!(
                "{} and {} are one file on some systems",
                pair[0].1, pair[1].1
            );
            Finding::new(Rule::DuplicateEntry, message)
        })
        .collect()
}
