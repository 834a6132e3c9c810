//! `build-fmu check`: what validators miss in any FMU, ours or foreign. Untrusted files are expected.

mod binaries;
mod description;
mod exchange;
mod finding;
mod index;
mod layered_standards;
mod listed_files;
mod package;
mod references;
mod structure;
mod units;
mod variables;
mod xml;
mod zip_rules;

pub use finding::{Finding, Rule};
pub use package::{OpenError, Package};

use crate::reference::trial::Trial;

/// Whether the check may load the FMU's library, which runs foreign code.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Loading {
    /// Load the library of this platform and instantiate it with the token of the model description.
    Load,
    /// Look at the files only.
    FilesOnly,
}

/// What a check came to.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Report {
    /// Everything that is wrong, in the order of the rules.
    pub findings: Vec<Finding>,
    /// Reference results that were reproduced, and what could not be tried and why.
    pub notes: Vec<String>,
}

/// Everything that is wrong with an FMU, in the order of the rules.
pub fn check(package: &Package, loading: Loading) -> Vec<Finding> {
    report(package, loading).findings
}

/// The experiments with reference results that an FMU holds, and what is wrong with them before they are run.
pub fn trials(package: &Package) -> (Vec<Finding>, Vec<Trial>) {
    match description::Description::read(package) {
        Ok(description) => layered_standards::check(package, &description),
        Err(finding) => (vec![finding], Vec::new()),
    }
}

/// Everything that is wrong with an FMU, and what became of its reference results.
pub fn report(package: &Package, loading: Loading) -> Report {
    let mut findings = zip_rules::check(package);
    let mut notes = Vec::new();
    match description::Description::read(package) {
        Ok(description) => {
            findings.extend(variables::check(&description));
            findings.extend(units::check(&description));
            findings.extend(structure::check(&description));
            findings.extend(exchange::check(&description));
            findings.extend(listed_files::check(package, &description));
            let binaries = binaries::check(package, &description, loading);
            let (broken, trials) = layered_standards::check(package, &description);
            findings.extend(broken);
            if !trials.is_empty() {
                // A library that is not sound, or must not be loaded, is not run.
                if loading == Loading::Load && binaries.is_empty() {
                    for trial in trials {
                        match references::repeat(package.path(), &trial) {
                            Ok((found, note)) => {
                                findings.extend(found);
                                notes.extend(note);
                            }
                            Err(reason) => notes.push(format!("{trial}: not repeated: {reason}")),
                        }
                    }
                } else {
                    notes.push("the reference results inside were not tried".to_owned());
                }
            }
            findings.extend(binaries);
        }
        Err(finding) => findings.push(finding),
    }
    findings.sort_by_key(|finding| finding.rule);
    Report { findings, notes }
}
