//! `build-fmu check`: what validators miss in any FMU, ours or foreign. Untrusted files are expected.

mod binaries;
mod description;
mod exchange;
mod finding;
mod index;
mod listed_files;
mod package;
mod structure;
mod units;
mod variables;
mod xml;
mod zip_rules;

pub use finding::{Finding, Rule};
pub use package::{OpenError, Package};

/// Whether the check may load the FMU's library, which runs foreign code.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Loading {
    /// Load the library of this platform and instantiate it with the token of the model description.
    Load,
    /// Look at the files only.
    FilesOnly,
}

/// Everything that is wrong with an FMU, in the order of the rules.
pub fn check(package: &Package, loading: Loading) -> Vec<Finding> {
    let mut findings = zip_rules::check(package);
    match description::Description::read(package) {
        Ok(description) => {
            findings.extend(variables::check(&description));
            findings.extend(units::check(&description));
            findings.extend(structure::check(&description));
            findings.extend(exchange::check(&description));
            findings.extend(listed_files::check(package, &description));
            findings.extend(binaries::check(package, &description, loading));
        }
        Err(finding) => findings.push(finding),
    }
    findings.sort_by_key(|finding| finding.rule);
    findings
}
