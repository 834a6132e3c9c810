//! Layered standards: a manifest for each folder, and of FMI-LS-REF the related files and the experiments among them.

use super::description::Description;
use super::finding::{Finding, Rule};
use super::package::Package;
use crate::reference::read::{self, ReadError, Related, Source, Stated};
use crate::reference::table::Table;
use crate::reference::trial::Trial;
use crate::reference::{CSV, MANIFEST, NAME, PARAMETERS, manifest_file};

/// Most bytes of manifests, experiments and time series that are read of an FMU: some 50,000 rows of 20 variables.
const MOST_BYTES: usize = 16 << 20;
/// Largest file of XML that is read [bytes].
const LARGEST_XML: usize = 1 << 20;
/// Most experiments that are repeated: for each the FMU is unpacked and loaded.
const MOST_TRIALS: usize = 20;

/// What is wrong, and the experiments that can be repeated.
pub(super) fn check(package: &Package, description: &Description) -> (Vec<Finding>, Vec<Trial>) {
    let mut check = Check {
        package,
        description,
        left: MOST_BYTES,
        findings: Vec::new(),
        trials: Vec::new(),
    };
    for file in package.names() {
        let folder = file
            .strip_prefix("extra/")
            .and_then(|file| file.strip_suffix(MANIFEST)?.strip_suffix('/'));
        if let Some(folder) = folder.filter(|folder| !folder.contains('/')) {
            check.manifest(file, folder);
        }
    }
    (check.findings, check.trials)
}

struct Check<'a> {
    package: &'a Package,
    description: &'a Description,
    /// Bytes that may still be read.
    left: usize,
    findings: Vec<Finding>,
    trials: Vec<Trial>,
}

impl Check<'_> {
    fn find(&mut self, rule: Rule, message: String) {
        self.findings.push(Finding::new(rule, message));
    }

    fn broken(&mut self, file: &str, reason: &str) {
        self.find(Rule::LayeredStandard, format!("{file}: {reason}"));
    }

    /// The text of a file, as long as not too much was read before.
    fn text(&mut self, file: &str) -> Result<String, String> {
        let bytes = self.package.read(file)?;
        self.left = self.left.checked_sub(bytes.len()).ok_or_else(|| {
            format!("more than {MOST_BYTES} bytes of layered standards are not read")
        })?;
        String::from_utf8(bytes).map_err(|error| format!("is not UTF-8: {error}"))
    }

    fn xml(&mut self, file: &str) -> Result<String, String> {
        match self.text(file)? {
            text if text.len() > LARGEST_XML => Err(format!(
                "has {} bytes; more than {LARGEST_XML} are not read",
                text.len()
            )),
            text => Ok(text),
        }
    }

    fn manifest(&mut self, file: &str, folder: &str) {
        let text = match self.xml(file) {
            Ok(text) => text,
            Err(reason) => return self.broken(file, &reason),
        };
        match read::standard(&text) {
            Ok(standard) if standard.name != folder => {
                let name = standard.name;
                self.broken(
                    file,
                    &format!("is that of {name}, in the folder of another"),
                );
            }
            Ok(_) if folder == NAME => self.related(&text),
            Ok(_) => {}
            Err(error) => self.broken(file, &error.to_string()),
        }
    }

    fn related(&mut self, text: &str) {
        let file = manifest_file();
        let related = match read::related(text) {
            Ok(related) => related,
            Err(error) => return self.broken(&file, &error.to_string()),
        };
        for Related { source, .. } in &related {
            self.listed(&file, source);
        }
        for related in related.iter().filter(|related| related.is_check()) {
            if let Some(file) = self.present(&related.source)
                && related.has_experiments()
            {
                self.experiments(&file);
            }
        }
    }

    /// Says if a file inside the FMU is named and not there.
    fn listed(&mut self, by: &str, source: &Source) {
        if let Some(file) = &source.file
            && !self.package.has(file)
        {
            let message = format!("{by} names {file}, which is not there");
            self.find(Rule::ListedFile, message);
        }
    }

    fn present(&self, source: &Source) -> Option<String> {
        let file = source.file.as_ref()?;
        self.package.has(file).then(|| file.clone())
    }

    fn experiments(&mut self, file: &str) {
        let read = |text: String| read::experiments(&text, file).map_err(|error| error.to_string());
        match self.xml(file).and_then(read) {
            Ok(experiments) => {
                for experiment in experiments {
                    self.experiment(file, experiment);
                }
            }
            Err(reason) => self.broken(file, &reason),
        }
    }

    fn experiment(&mut self, file: &str, stated: Stated) {
        let sources = [&stated.parameters, &stated.stimuli, &stated.references];
        let mut missing = false;
        for source in sources.into_iter().flatten() {
            self.listed(file, source);
            missing |= self.present(source).is_none();
        }
        if missing || stated.references.is_none() || !stated.over_time {
            return;
        }
        let default = |attribute: &str| -> Option<f64> {
            let text = self.description.experiment.as_ref()?.get(attribute)?;
            text.trim().parse().ok()
        };
        let mut trial = Trial::new(file, &stated, default);
        let mut sound = true;
        if let Some(source) = &stated.stimuli {
            sound &= self.table(source, "input", &mut trial.stimuli, &mut trial.unread);
        }
        if let Some(source) = &stated.references {
            sound &= self.table(source, "variable", &mut trial.references, &mut trial.unread);
        }
        if let Some(source) = &stated.parameters {
            sound &= self.parameters(source, &mut trial);
        }
        if sound && self.trials.len() == MOST_TRIALS {
            self.broken(
                file,
                &format!("more than {MOST_TRIALS} experiments are not repeated"),
            );
        } else if sound {
            self.trials.push(trial);
        }
    }

    /// Reads a table whose columns are variables of the FMU; whether nothing was wrong with it.
    fn table(
        &mut self,
        source: &Source,
        part: &str,
        table: &mut Table,
        unread: &mut Option<String>,
    ) -> bool {
        let Some(file) = self.present(source) else {
            return false;
        };
        if source.kind != CSV {
            *unread = Some(format!("{file} is {}, which is not read", source.kind));
            return true;
        }
        let text = match self.package.read(&file) {
            Ok(bytes) if bytes.len() > self.left => {
                *unread = Some(format!(
                    "more than {MOST_BYTES} bytes of time series are not read"
                ));
                return true;
            }
            Ok(bytes) => bytes,
            Err(reason) => {
                self.broken(&file, &reason);
                return false;
            }
        };
        self.left -= text.len();
        let parsed = String::from_utf8(text)
            .map_err(|error| format!("is not UTF-8: {error}"))
            .and_then(|text| Table::parse(&text).map_err(|error| error.to_string()));
        match parsed {
            Ok(parsed) => {
                let unknown: Vec<&str> = parsed
                    .columns
                    .iter()
                    .map(|column| column.name.as_str())
                    .filter(|name| !self.fits(name, part))
                    .collect();
                if !unknown.is_empty() {
                    let message = format!(
                        "{file} has columns that are no {part}: {}",
                        unknown.join(", ")
                    );
                    self.find(Rule::ReferenceResults, message);
                    return false;
                }
                *table = parsed;
                true
            }
            Err(reason) => {
                self.find(Rule::ReferenceResults, format!("{file}: {reason}"));
                false
            }
        }
    }

    fn fits(&self, name: &str, part: &str) -> bool {
        match self.description.variable(name) {
            Some(variable) => part != "input" || variable.get("causality") == Some("input"),
            None => false,
        }
    }

    fn parameters(&mut self, source: &Source, trial: &mut Trial) -> bool {
        let Some(file) = self.present(source) else {
            return false;
        };
        if source.kind != PARAMETERS {
            trial.unread = Some(format!("{file} is {}, which is not read", source.kind));
            return true;
        }
        let read =
            |text: String| read::parameters(&text).map_err(|error: ReadError| error.to_string());
        match self.xml(&file).and_then(read) {
            Ok(set) => {
                if let Some(name) = set.others.first() {
                    trial.unread =
                        Some(format!("{file} gives {name} in another type or in a unit"));
                }
                trial.parameters = set.values;
                true
            }
            Err(reason) => {
                self.broken(&file, &reason);
                false
            }
        }
    }
}
