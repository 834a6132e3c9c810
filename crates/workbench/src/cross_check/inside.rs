//! The FMI Cross-Check of an FMU by the reference results that it holds (FMI-LS-REF).

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow, ensure};
use build_fmu::lint::{self, Package};
use build_fmu::platform::{FmiVersion, Platform};

use crate::component::{self, Description, Fmu};
use crate::files::atomic::write_file;
use crate::outcome::Outcome;

/// Repeats the experiments inside the FMU and writes its files of the cross-check with what came out, `_out.csv`.
pub(super) fn check(path: &Path, out: &Path) -> anyhow::Result<Outcome> {
    let (findings, trials) = lint::trials(&Package::open(path)?);
    if let Some(finding) = findings.first() {
        return Err(anyhow!("{}: {finding}", path.display()));
    }
    ensure!(
        !trials.is_empty(),
        "{} holds no reference results (FMI-LS-REF); build-fmu packs them into its FMUs",
        path.display()
    );
    let description = Fmu::describe(path)?;
    let name = &description.model_identifier;
    let several = trials.len() > 1;
    let mut kept = true;
    for trial in trials {
        let experiment = trial.experiment();
        let mut fmu = Fmu::open(path)?;
        let found = trial
            .run(&mut fmu)
            .map_err(|reason| anyhow!("{}, {trial}: {reason}", path.display()))?;
        let own = if several {
            format!("{name}-{}", plain(&experiment.name))
        } else {
            name.clone()
        };
        let folder = out.join(folder(&description)?).join(own);
        fs::create_dir_all(&folder).with_context(|| format!("{}", folder.display()))?;
        let options = super::options(
            experiment.start,
            experiment.stop,
            experiment.step,
            experiment.tolerance(),
        );
        let fmu = fs::read(path).with_context(|| format!("{}", path.display()))?;
        for (end, content) in [
            (".fmu", fmu.as_slice()),
            ("_in.csv", experiment.stimuli.to_csv().as_bytes()),
            ("_ref.csv", trial.references().to_csv().as_bytes()),
            ("_ref.opt", options.as_bytes()),
            ("_out.csv", found.to_csv().as_bytes()),
        ] {
            write_file(&folder.join(format!("{name}{end}")), content)?;
        }
        println!("{}", folder.display());
        for deviation in trial.deviations(&found) {
            kept &= !deviation.is_excess();
            println!(
                "  {:<24} {} {:.1e}, allowed {:.1e}, at {} s",
                deviation.name,
                if deviation.is_excess() {
                    "DIFFERS by"
                } else {
                    "differs by"
                },
                deviation.size(),
                deviation.allowed,
                deviation.time
            );
        }
    }
    Ok(Outcome::of(kept))
}

/// Folders of the cross-check down to the tool that made the FMU and its version.
fn folder(description: &Description) -> anyhow::Result<PathBuf> {
    let version = match description.version {
        component::FmiVersion::Two => FmiVersion::Fmi2,
        component::FmiVersion::Three => FmiVersion::Fmi3,
    };
    let platform = Platform::current().context("FMUs are not known to run on this machine")?;
    let tool = description.generation_tool.trim();
    let (tool, number) = match tool.rsplit_once(' ') {
        Some((tool, number)) if number.starts_with(|c: char| c.is_ascii_digit()) => (tool, number),
        _ => (tool, "unknown"),
    };
    let parts = [
        version.number(),
        "cs",
        platform.folder(version),
        &plain(tool),
        &plain(number),
    ];
    Ok(parts.iter().collect())
}

/// A text as the name of a folder that is one on every system.
fn plain(text: &str) -> String {
    let letters = text.chars().map(|letter| match letter {
        letter if letter.is_ascii_alphanumeric() || "-_.".contains(letter) => letter,
        _ => '_',
    });
    let name: String = letters.collect();
    if name.chars().all(|letter| letter == '.') {
        "unknown".to_owned()
    } else {
        name
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_name_leads_out_of_the_folder() {
        assert_eq!(plain("../a b"), ".._a_b");
        assert_eq!(plain(".."), "unknown");
        assert_eq!(plain(""), "unknown");
        assert_eq!(plain("held-inputs"), "held-inputs");
    }
}
