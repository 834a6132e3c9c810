//! The FMU around an FMU: the original, byte for byte, with effects at its port.

use std::fs;
use std::path::{Path as FilePath, PathBuf};

use build_fmu::archive::{Archive as Packed, ArchiveError as PackError, write_atomically};
use build_fmu::library::Library;
use build_fmu::platform::{FmiVersion as Folders, Platform};
use operations::{AddedEffect, Own, Port as WrappedPort, SETTINGS_FILE, Settings};
use stickslip::cosim::Token;
use thiserror::Error;

use super::plant::{Plant, PlantError};
use super::wrapped_place::place_of;
use super::wrapper_description::{Abilities, Added, Changes, abilities, changed};
use crate::component::{Archive, ArchiveError, ComponentError, Description, FmiVersion};
use crate::diagnose::report::markup::escape;
use crate::diagnose::small_plant::model_file::SmallModel;
use inference::body::base::PARAMETERS;
use inference::body::model::Term;
use inference::body::term::{Formula, Role};
use stickslip::body::Kind;

/// Beginning of the names that the original does not have.
const PREFIX: &str = "effects";
/// Folder of the original among the resources.
const ORIGINAL: &str = "original";
const DESCRIPTION: &str = "modelDescription.xml";

/// Why there is no FMU around an FMU.
#[derive(Debug, Error)]
pub enum WrapperError {
    /// The ports do not fit the FMU.
    #[error(transparent)]
    Plant(#[from] PlantError),
    /// The FMU's archive.
    #[error(transparent)]
    Archive(#[from] ArchiveError),
    /// The FMU's description.
    #[error(transparent)]
    Component(#[from] ComponentError),
    /// The FMU could not be written.
    #[error(transparent)]
    Pack(#[from] PackError),
    /// A number that the diagnosis finds is not there.
    #[error(
        "{file}: [port] lacks {key}; the amended model that `stickslip diagnose` writes has it, build that"
    )]
    Number {
        /// The ports file.
        file: String,
        /// The key.
        key: &'static str,
    },
    /// An effect that does not act through one port alone.
    #[error(
        "{file}: {effect} {what}; an FMU can have the effects of one port, with forces over time and the motion there. Leave it out, \
         or build it into the FMU itself"
    )]
    Elsewhere {
        /// The ports file.
        file: String,
        /// The effect.
        effect: &'static str,
        /// Where it acts.
        what: &'static str,
    },
    /// A number that cannot be.
    #[error("{file}: [port] {key} = {value} must be {expected}")]
    Value {
        /// The ports file.
        file: String,
        /// The key.
        key: &'static str,
        /// What stands there.
        value: f64,
        /// What would be right.
        expected: &'static str,
    },
    /// The original has a name that the effects need.
    #[error("{fmu}: has a variable `{name}` already; the effects cannot add theirs")]
    Taken {
        /// The FMU.
        fmu: String,
        /// The name.
        name: String,
    },
    /// The original has no binary for a platform.
    #[error(
        "{fmu}: has no binary for {platform}, so that the FMU with the effects cannot have one"
    )]
    Platform {
        /// The FMU.
        fmu: String,
        /// The platform.
        platform: Platform,
    },
    /// The description cannot be changed.
    #[error("{fmu}: modelDescription.xml {problem}")]
    Description {
        /// The FMU.
        fmu: String,
        /// What is wrong with it.
        problem: String,
    },
    /// The settings hold what cannot be written.
    #[error("{SETTINGS_FILE} could not be written: {0}")]
    Settings(#[from] serde_json::Error),
    /// A file of the original cannot be read.
    #[error("{}: cannot be read: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
}

/// An FMU that was written.
#[derive(Debug)]
pub struct Wrapped {
    /// The file.
    pub path: PathBuf,
    /// Its size [bytes].
    pub size: usize,
    /// Effects of the model that are none of the plant's and are not inside.
    pub left_out: Vec<&'static str>,
}

/// Writes the FMU that `model`, read from `file`, describes into `out`, with a binary for each of `libraries`. Relative paths of the
/// model begin at `directory`.
///
/// # Errors
/// [`WrapperError`]; nothing is written then.
pub fn build(
    model: &SmallModel,
    file: &str,
    directory: &FilePath,
    libraries: Vec<Library>,
    out: &FilePath,
) -> Result<Wrapped, WrapperError> {
    let Some(ports) = &model.ports else {
        return Err(PlantError::NoFmu {
            file: file.to_owned(),
        }
        .into());
    };
    let at = place_of(model, file)?;
    let port = &ports.ports[at];
    let plant = Plant::find(model, ports, file, directory)?;
    let place = &plant.places[at];
    let archive = Archive::unpack(&plant.file)?;
    let bytes = read(&archive.directory().join(DESCRIPTION))?;
    let text = String::from_utf8_lossy(&bytes).into_owned();
    let original = Original {
        fmu: plant.file.display().to_string(),
        description: Description::parse(&text, &plant.file).map_err(ComponentError::from)?,
        text,
    };
    let lacks = |key| WrapperError::Number {
        file: file.to_owned(),
        key,
    };
    let wrong = |key, value, expected| WrapperError::Value {
        file: file.to_owned(),
        key,
        value,
        expected,
    };
    let inertia = port.inertia.ok_or_else(|| lacks("inertia"))?;
    if !inertia.is_finite() || inertia == 0.0 {
        return Err(wrong("inertia", inertia, "a finite number other than 0"));
    }
    let step = port.coupling_step.ok_or_else(|| lacks("coupling_step"))?;
    if !(step.is_finite() && step > 0.0) {
        return Err(wrong("coupling_step", step, "a number above 0 [s]"));
    }
    let mut making = Making {
        added: Vec::new(),
        next: original
            .description
            .variables
            .iter()
            .map(|own| own.reference)
            .max()
            .map_or(0, |last| last + 1),
    };
    let (effects, left_out) = making.effects(model);
    let coupling_step = making.own(
        "coupling_step",
        "longest time over which the force of the effects is constant",
        "s",
        step,
    );
    let force_unit = &original.description.variables[place.input.0].unit;
    let force = making.computed(
        "force",
        "force that the effects add to the port's input",
        force_unit,
    );
    for own in &making.added {
        let is_taken = |known: &crate::component::Variable| known.name == own.name;
        if original.description.variables.iter().any(is_taken) {
            return Err(WrapperError::Taken {
                fmu: original.fmu,
                name: own.name.clone(),
            });
        }
    }
    let variables = &original.description.variables;
    let reference = |at: usize| variables[at].reference;
    let placed = |(at, unit): (usize, f64)| (reference(at), unit);
    let parameters: Vec<(usize, f64)> = plant.settings(model).collect();
    let Abilities {
        can_restore,
        can_vary_steps,
    } = abilities(&original.text);
    let mut settings = Settings {
        token: String::new(),
        original_identifier: original.description.model_identifier.clone(),
        original_token: original.description.token.clone(),
        original_folder: ORIGINAL.to_owned(),
        can_restore,
        can_vary_steps,
        starts: parameters
            .iter()
            .map(|(at, value)| (reference(*at), *value))
            .collect(),
        port: WrappedPort {
            input: placed(place.input),
            start: variables[place.input.0].start.unwrap_or(0.0),
            position: place.position.map(placed),
            velocity: place.velocity.map(placed),
            load: place.load.map(placed),
            inertia,
        },
        coupling_step,
        force,
        effects,
    };
    let said = serde_json::to_string(&settings)? + &original.text;
    settings.token = Token::of_text(&said).to_string();
    let changes = Changes {
        version: original.description.version,
        model_name: format!("{} with effects", original.description.model_name),
        identifier: format!("{}_with_effects", original.description.model_identifier),
        token: settings.token.clone(),
        tool: format!(
            "stickslip {}, around an FMU of {}",
            env!("CARGO_PKG_VERSION"),
            match original.description.generation_tool.as_str() {
                "" => "an unnamed tool",
                tool => tool,
            }
        ),
        starts: parameters
            .iter()
            .map(|(at, value)| (variables[*at].name.clone(), *value))
            .collect(),
        added: making.added,
    };
    let mut packed = Packed::default();
    let description =
        changed(&original.text, &changes).map_err(|problem| WrapperError::Description {
            fmu: original.fmu.clone(),
            problem,
        })?;
    packed.add(DESCRIPTION, description)?;
    packed.add(
        &format!("resources/{SETTINGS_FILE}"),
        serde_json::to_string_pretty(&settings)?,
    )?;
    packed.add("documentation/index.html", page(&settings, &changes))?;
    add_binaries(
        &mut packed,
        &original,
        archive.directory(),
        &changes,
        libraries,
    )?;
    add_all(&mut packed, archive.directory(), archive.directory())?;
    let bytes = packed.to_bytes()?;
    let stem = plant.file.file_stem().unwrap_or_default().to_string_lossy();
    let path = out.join(format!("{stem}.amended.fmu"));
    write_atomically(&path, &bytes)?;
    Ok(Wrapped {
        path,
        size: bytes.len(),
        left_out,
    })
}

struct Original {
    fmu: String,
    text: String,
    description: Description,
}

/// Variables on their way into the description.
struct Making {
    added: Vec<Added>,
    next: u32,
}

impl Making {
    /// A parameter of the effects.
    fn own(&mut self, name: &str, description: &str, unit: &str, start: f64) -> Own {
        let name = format!("{PREFIX}.{name}");
        let reference = self.next;
        self.next += 1;
        self.added.push(Added {
            name: name.clone(),
            reference,
            description: description.to_owned(),
            unit: unit.to_owned(),
            start: Some(start),
        });
        Own {
            name,
            reference,
            start,
        }
    }

    /// A variable that is computed; its value reference.
    fn computed(&mut self, name: &str, description: &str, unit: &str) -> u32 {
        let reference = self.next;
        self.next += 1;
        self.added.push(Added {
            name: format!("{PREFIX}.{name}"),
            reference,
            description: description.to_owned(),
            unit: unit.to_owned(),
            start: None,
        });
        reference
    }

    /// The model's effects, friction first, and the names of those that are no forces.
    fn effects(&mut self, model: &SmallModel) -> (Vec<AddedEffect>, Vec<&'static str>) {
        let terms = model.model.terms().iter();
        let effects = terms.filter(|term| term.entry.name != PARAMETERS);
        let is_friction = |term: &&Term| term.entry.role == Role::Friction;
        let (friction, others): (Vec<&Term>, Vec<&Term>) = effects.partition(is_friction);
        let mut left_out = Vec::new();
        let mut added = Vec::new();
        for term in friction.into_iter().chain(others) {
            let path = model.model.path;
            let Formula::Equation { text, operations } = term.entry.formula else {
                left_out.push(term.entry.name);
                continue;
            };
            let parameters = term.entry.parameters.iter().zip(&term.values);
            added.push(AddedEffect {
                name: term.entry.name.to_owned(),
                equation: text.to_owned(),
                operations: operations.to_vec(),
                is_friction: term.entry.role == Role::Friction,
                parameters: parameters
                    .map(|(own, value)| {
                        self.own(
                            &format!("{}.{}", term.entry.name, own.key),
                            own.description,
                            own.dimension.unit(Kind::Fmu, path),
                            *value,
                        )
                    })
                    .collect(),
            });
        }
        (added, left_out)
    }
}

fn read(path: &FilePath) -> Result<Vec<u8>, WrapperError> {
    fs::read(path).map_err(|source| WrapperError::Read {
        path: path.to_owned(),
        source,
    })
}

/// The wrapper's binaries: for platforms that the original has one for.
fn add_binaries(
    packed: &mut Packed,
    original: &Original,
    directory: &FilePath,
    changes: &Changes,
    libraries: Vec<Library>,
) -> Result<(), WrapperError> {
    let version = match original.description.version {
        FmiVersion::Two => Folders::Fmi2,
        FmiVersion::Three => Folders::Fmi3,
    };
    for library in libraries {
        let platform = library.platform;
        let folder = format!("binaries/{}", platform.folder(version));
        let extension = platform.library_extension();
        let own = format!("{}.{extension}", original.description.model_identifier);
        if !directory.join(&folder).join(own).is_file() {
            return Err(WrapperError::Platform {
                fmu: original.fmu.clone(),
                platform,
            });
        }
        let name = format!("{folder}/{}.{extension}", changes.identifier);
        packed.add(&name, library.content)?;
    }
    Ok(())
}

/// Adds all files of the original below `folder`.
fn add_all(packed: &mut Packed, root: &FilePath, folder: &FilePath) -> Result<(), WrapperError> {
    let failed = |source| WrapperError::Read {
        path: folder.to_owned(),
        source,
    };
    for entry in fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        if path.is_dir() {
            add_all(packed, root, &path)?;
            continue;
        }
        let parts = path.strip_prefix(root).unwrap_or(&path).components();
        let parts: Vec<_> = parts
            .map(|part| part.as_os_str().to_string_lossy())
            .collect();
        let name = format!("resources/{ORIGINAL}/{}", parts.join("/"));
        packed.add(&name, read(&path)?)?;
    }
    Ok(())
}

/// What the FMU tells people.
fn page(settings: &Settings, changes: &Changes) -> String {
    let rows: String = changes
        .added
        .iter()
        .map(|own| {
            format!(
                "<tr><td><code>{}</code></td><td>{}</td><td>{}</td><td>{}</td></tr>\n",
                escape(&own.name),
                own.start.map_or(String::new(), |start| start.to_string()),
                escape(&own.unit),
                escape(&own.description)
            )
        })
        .collect();
    let equations: String = settings
        .effects
        .iter()
        .map(|effect| {
            format!(
                "<li>{}: force against the motion = <code>{}</code></li>\n",
                escape(&effect.name),
                escape(&effect.equation)
            )
        })
        .collect();
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{title}</title></head><body>\n<h1>{title}</h1>\n\
         <p>This FMU contains another one, unchanged, in <code>resources/{ORIGINAL}</code>, and adds the force of effects to its \
         input with value reference {input}. All its variables are there under their names; the importer's value of the input and \
         the force of the effects add up.</p>\n<ul>\n{equations}</ul>\n\
         <p>Over a coupling step the force is constant: the implicit midpoint rule for what is smooth, and at rest the force that \
         holds, so that the plant sticks. The error falls with the square of <code>{PREFIX}.coupling_step</code>{restores}.</p>\n\
         <table><tr><th>Variable</th><th>Start</th><th>Unit</th><th></th></tr>\n{rows}</table>\n\
         <p>Directional and output derivatives, derivatives of inputs, event mode and model exchange of the original are not \
         provided.</p>\n</body></html>\n",
        title = escape(&changes.model_name),
        input = settings.port.input.0,
        restores = if settings.can_restore {
            "; the original goes back to the start of a step until force and motion agree"
        } else {
            ""
        },
    )
}
