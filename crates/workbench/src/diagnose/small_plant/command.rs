//! The commands `diagnose`, `locate`, `name`, `amend` and `show` on small plants.

use std::fs;
use std::io::ErrorKind;
use std::path::Path;
use std::time::Instant;

use anyhow::{Context, anyhow};
use build_fmu::build::Source;
use build_fmu::library::{self, Library};
use build_fmu::platform::FmiVersion;

use super::amend::{amended_text, described, named};
use super::case::{NO_FMU, SmallCase, load};
use super::console::screen;
use super::finding::SmallFinding;
use super::fmu::wrapper::{self, WrapperError};
use super::model_file::SmallModel;
use super::report::page;
use super::showing::{balance, models_on_the_way, step};
use super::timing::share_of_a_sample;
use crate::diagnose::amend::{FILE as AMENDED, build};
use crate::diagnose::finding::VerdictName;
use crate::diagnose::made::Made;
use crate::diagnose::material::Material;
use crate::diagnose::report::FILE as REPORT;
use crate::files::atomic;
use crate::outcome::Outcome;
use inference::body::model::Model;
use inference::body::naming::{
    MOST_EFFECTS, Naming, fit_base, fit_with, name as name_effects, shows,
};
use inference::body::problem::Problem;
use inference::body::swing::Swing;
use inference::body::term::Entry;
use inference::sets::is_same;
use stickslip::body::Kind;

/// How a note begins that tells which FMUs there are.
const FMUS: &str = "FMUs of the amended model";
/// Most times that effects are named anew.
const MOST_ROUNDS: usize = 4;

/// A stage, or all of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage<'a> {
    /// All stages in turn.
    All,
    /// Where model and records disagree.
    Locate,
    /// Which effects are missing.
    Name,
    /// The amended model, with the finding's effects or those given.
    Amend(&'a [String]),
    /// Before and after, and the report.
    Show,
}

/// Runs a stage; the screen's text comes with its outcome. `library` is for the FMUs; without it the one beside
/// this program is.
///
/// # Errors
/// Whatever is wrong with the input; the exit code is then 2.
pub fn run(
    material: &Material,
    stage: Stage<'_>,
    out: &Path,
    library: Option<&Path>,
    progress: &mut dyn FnMut(&str),
) -> anyhow::Result<(Outcome, String)> {
    let begun = Instant::now();
    let amends = matches!(stage, Stage::All | Stage::Amend(_));
    if matches!(stage, Stage::All | Stage::Name) {
        refuse_several_ports(material)?;
    }
    let mut case = load(material, progress)?;
    // Before minutes pass: is there what the amended FMU needs?
    let moves = case.kind().stands_still().is_none();
    let own_library = match amends && moves {
        true => Some(library::find(library)?),
        false => None,
    };
    let mut libraries = if amends && case.chased.is_some() {
        let named: Vec<_> = library.map(Path::to_owned).into_iter().collect();
        library::select_wrappers(&[], &named)?
    } else {
        Vec::new()
    };
    let mut found = match stage {
        Stage::All | Stage::Name => named_finding(&mut case, progress)?,
        Stage::Locate => located(&case, progress),
        Stage::Amend(effects) if !effects.is_empty() => forced(&case, effects, progress)?,
        Stage::Amend(_) | Stage::Show => {
            let found = SmallFinding::read(out)?;
            case = case.driven_later(found.small_plant.driven_later);
            found
        }
    };
    let mut text = String::new();
    if amends {
        text = amended_text(&case, &found).map_err(|what| anyhow!(what))?;
        atomic::write_file(&out.join(AMENDED), text.as_bytes())?;
        if let Some(library) = &own_library {
            progress("FMUs of the amended model");
            let notes = &mut found.finding.notes;
            notes.retain(|note| !note.starts_with(NO_FMU) && !note.starts_with(FMUS));
            notes.push(build_fmus(&text, out, library)?);
        }
        if !libraries.is_empty() {
            progress("the FMU with the effects");
            let libraries = std::mem::take(&mut libraries);
            let amended = SmallModel::parse(&text, AMENDED)?;
            let notes = &mut found.finding.notes;
            match wrapper::build(&amended, AMENDED, out, libraries, out) {
                Ok(wrapped) => notes.extend(wrapped.left_out.iter().map(|name| {
                    format!(
                        "{name} is an effect of the readings; the FMU with the effects does not have it"
                    )
                })),
                Err(error @ WrapperError::Elsewhere { .. }) => {
                    notes.push(format!("{NO_FMU}: {error}"));
                }
                Err(error) => return Err(error.into()),
            }
        }
    }
    if stage == Stage::Show {
        let path = out.join(AMENDED);
        text = fs::read_to_string(&path).with_context(|| {
            format!(
                "{}: run `stickslip amend` into this directory first",
                path.display()
            )
        })?;
    }
    if matches!(stage, Stage::All | Stage::Show) {
        if stage == Stage::Show {
            case.pursue(&SmallModel::parse(&text, AMENDED)?.model, progress)?;
        }
        let [before, after] = show(&case, &mut found, &text, progress)?;
        progress("report");
        let fmu = case.model.ports.as_ref().and_then(|own| own.fmu.as_deref());
        let page = page(&case, &Made::of(material, fmu)?, &found, [&before, &after]);
        atomic::write_file(&out.join(REPORT), page.as_bytes())?;
    }
    found.finding.seconds = begun.elapsed().as_secs_f64();
    found.write(out)?;
    let settled = match stage {
        Stage::All | Stage::Show => found.is_settled(),
        Stage::Name => found.finding.verdict != VerdictName::NotInCatalogue,
        Stage::Locate => found.finding.verdict == VerdictName::NothingMissing,
        Stage::Amend(_) => true,
    };
    let outcome = Outcome::of(settled);
    Ok((outcome, screen(&case.name, &found)))
}

/// Refuses to name effects at several ports at once: on our own rig, where nothing was missing, such names were false.
fn refuse_several_ports(material: &Material) -> anyhow::Result<()> {
    let model = SmallModel::parse(&material.model_text, &material.model_name)?;
    let ports = model.port_names();
    if ports.len() < 2 {
        return Ok(());
    }
    Err(anyhow!(
        "{}: has {} ports ({}), and effects are named at one; `stickslip locate` tells at which of them the FMU and the records disagree: \
         leave that one as [port] and diagnose again",
        material.model_name,
        ports.len(),
        ports.join(", ")
    ))
}

/// Builds the FMUs of an amended model, or removes those of an earlier one where it can have none; what a note says of it.
fn build_fmus(text: &str, out: &Path, library: &Library) -> anyhow::Result<String> {
    let source = match Source::from_text(text.to_owned(), AMENDED) {
        Ok(source) => source,
        Err(error) => {
            for version in FmiVersion::ALL {
                for name in ["Drive", "Pendulum", "Joint"] {
                    let stale = out.join(format!("{name}.{}.fmu", version.tag()));
                    match fs::remove_file(&stale) {
                        Err(error) if error.kind() != ErrorKind::NotFound => {
                            return Err(error)
                                .context(format!("{} is of an earlier model", stale.display()));
                        }
                        _ => {}
                    }
                }
            }
            return Ok(format!("{NO_FMU}: {error}"));
        }
    };
    let names = build(&source, out, library)?.into_iter().map(|path| {
        let name = path.file_name().unwrap_or_default();
        name.to_string_lossy().into_owned()
    });
    Ok(format!("{FMUS}: {}", names.collect::<Vec<_>>().join(", ")))
}

/// Names what is missing. Where that contradicts what is known of the model's numbers, an effect may stand in for one of them: so once
/// more with less faith in them.
fn named_finding(
    case: &mut SmallCase,
    progress: &mut dyn FnMut(&str),
) -> anyhow::Result<SmallFinding> {
    let (open, hidden): (Vec<_>, Vec<_>) = case
        .candidates()
        .into_iter()
        .partition(|entry| shows(entry, case.kind(), case.records.len()));
    let most = match case.chased {
        Some(_) => 1,
        None => MOST_EFFECTS,
    };
    if case.kind() == Kind::Joint {
        // Its forces tell the time as well as its runs, which cost far more.
        let forces = on(&balance(case), case, &open, most, progress);
        tell_time(case, &forces);
    }
    let mut naming = settled(case, &open, most, progress)?;
    let best = naming.best();
    if !best.names.is_empty() && case.contradicts(&best.fit.model) {
        case.doubt();
        progress("the same with less faith in the model's numbers");
        naming = settled(case, &open, most, progress)?;
    }
    if tell_time(case, &naming) {
        progress("the same with what drives the plant a part of a sample later");
        naming = names(case, &open, most, progress);
    }
    progress("numbers and their intervals");
    let mut found = named(case, &naming);
    found.finding.notes.extend(hidden.iter().map(|entry| {
        format!(
            "{} was not tried: in a single swing time passes as the amplitude falls, so that it cannot be told from a loss that \
             changes with the amplitude; a second record that starts from another amplitude can tell",
            entry.name
        )
    }));
    Ok(found)
}

/// The force that an FMU lacks depends on its parameters: so until the names do not change any more. Numbers that are far off leave
/// structure that the right ones do not, which effects would stand in for: so with an effect more each time.
fn settled(
    case: &mut SmallCase,
    open: &[&'static Entry],
    most: usize,
    progress: &mut dyn FnMut(&str),
) -> anyhow::Result<Naming> {
    let mut naming = names(case, open, most, progress);
    for more in 1..=MOST_ROUNDS {
        if case.chased.is_none() {
            break;
        }
        case.pursue(&naming.best().fit.model, progress)?;
        let again = names(case, open, most + more, progress);
        let is_settled = is_same(&again.best().names, &naming.best().names);
        naming = again;
        if is_settled {
            break;
        }
    }
    Ok(naming)
}

/// Reads what drives the plant a part of a sample later where the records say so, once; whether it was read anew.
fn tell_time(case: &mut SmallCase, naming: &Naming) -> bool {
    let share = match case.driven_later {
        0.0 => share_of_a_sample(case, naming),
        _ => None,
    };
    if let Some(share) = share {
        *case = case.driven_later(share);
    }
    share.is_some()
}

fn names(
    case: &SmallCase,
    open: &[&'static Entry],
    most: usize,
    progress: &mut dyn FnMut(&str),
) -> Naming {
    on(problem(case).as_ref(), case, open, most, progress)
}

fn on(
    problem: &dyn Problem,
    case: &SmallCase,
    open: &[&'static Entry],
    most: usize,
    progress: &mut dyn FnMut(&str),
) -> Naming {
    let (model, scales) = (&case.model.model, &case.scales);
    name_effects(problem, model, scales, (open, most), progress)
}

/// What sets of effects are fitted to. Where a joint sticks and for how long tells more of its friction than the forces while it moves.
fn problem(case: &SmallCase) -> Box<dyn Problem> {
    match case.kind() {
        Kind::Joint => Box::new(
            Swing::pieces(&case.records, &case.model.measurement, &case.scales)
                .knowing(&case.known),
        ),
        _ => Box::new(balance(case)),
    }
}

fn located(case: &SmallCase, progress: &mut dyn FnMut(&str)) -> SmallFinding {
    progress("nominal parameters");
    let base = fit_base(&balance(case), &case.model.model, &case.scales);
    let mut found = described(case, &base, &base);
    let mut places = found.finding.structure.iter();
    found.finding.verdict = match places.any(|place| place.significant) {
        true => VerdictName::NotInCatalogue,
        false => VerdictName::NothingMissing,
    };
    found
}

fn forced(
    case: &SmallCase,
    effects: &[String],
    progress: &mut dyn FnMut(&str),
) -> anyhow::Result<SmallFinding> {
    let entries = entries(case, effects)?;
    let problem = balance(case);
    progress("nominal parameters");
    let base = fit_base(&problem, &case.model.model, &case.scales);
    let mut fitted = base.clone();
    for entry in entries {
        progress(entry.name);
        fitted = fit_with(&problem, &fitted.model, entry, &case.scales);
    }
    Ok(described(case, &base, &fitted))
}

fn entries(case: &SmallCase, effects: &[String]) -> anyhow::Result<Vec<&'static Entry>> {
    let model = &case.model.model;
    effects
        .iter()
        .map(|name| {
            let entry = case
                .effect(name)
                .map_err(|what| anyhow!("--effect {name}: {what}"))?;
            Some(entry)
                .filter(|entry| {
                    entry.fits(model.kind, model.path, case.model.has_load()) && !model.has(name)
                })
                .ok_or_else(|| {
                    let open: Vec<&str> = case.possible().iter().map(|entry| entry.name).collect();
                    anyhow!(
                        "--effect {name}: cannot be added to this {}; what can be is {}",
                        model.kind.word(),
                        open.join(", ")
                    )
                })
        })
        .collect()
}

fn show(
    case: &SmallCase,
    found: &mut SmallFinding,
    amended: &str,
    progress: &mut dyn FnMut(&str),
) -> anyhow::Result<[Model; 2]> {
    let names: Vec<String> = found
        .finding
        .effects
        .iter()
        .map(|effect| effect.name.clone())
        .collect();
    let entries = entries(case, &names)?;
    let mut models = models_on_the_way(case, &entries, progress);
    let base = models[0].clone();
    // The last one is the file's, which a person may have changed.
    let last = SmallModel::parse(amended, AMENDED)?.model;
    if names.is_empty() {
        models.push(last.clone());
    } else if let Some(end) = models.last_mut() {
        end.clone_from(&last);
    }
    progress("held-out record");
    let effects = std::iter::once(None).chain(names.iter().map(|name| Some(name.as_str())));
    found.small_plant.steps = effects
        .zip(&models)
        .map(|(effect, model)| step(case, effect, model))
        .collect();
    Ok([base, last])
}
