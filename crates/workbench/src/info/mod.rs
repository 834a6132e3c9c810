//! `stickslip info`: what a model or an FMU is and has.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use clap::Args;
use stickslip::body::{Body, is_small_plant};
use stickslip::controller::{ControlLaw, is_controller};
use stickslip::plant::{Definition, ModelFile, Provenance, RigKind};

use crate::component::{
    Archive, Component, Description, FmiVersion, Fmu, Kind, Native, Role, Variable,
};
use crate::outcome::Outcome;

/// What a model or an FMU is and has.
#[derive(Debug, Args)]
pub struct InfoArguments {
    /// Model (.toml) or FMU (.fmu); an FMU's binary is not run.
    pub model: PathBuf,
}

/// Runs the subcommand.
///
/// # Errors
/// Whatever is wrong with the file.
pub fn command(arguments: &InfoArguments) -> anyhow::Result<Outcome> {
    let path = &arguments.model;
    let text = match path.extension().and_then(|extension| extension.to_str()) {
        Some("toml") => describe_model(path)?,
        Some("fmu") => describe_fmu(path)?,
        _ => bail!(
            "{}: is neither a model (.toml) nor an FMU (.fmu)",
            path.display()
        ),
    };
    print!("{text}");
    Ok(Outcome::Done)
}

/// Describes a model file: rig, laws and effects, the controller or the small plant, variables, and every parameter with where its number
/// comes from.
fn describe_model(path: &Path) -> anyhow::Result<String> {
    let text =
        fs::read_to_string(path).with_context(|| format!("{}: cannot be read", path.display()))?;
    let name = path.display().to_string();
    let (structure, provenance) = describe_structure(&text, &name)?;
    let native = Native::from_text(&text, &name)?;
    let variables = describe_variables(native.variables(), &provenance);
    Ok(format!(
        "{name} ({} bytes)\n\n{structure}\n{variables}",
        text.len()
    ))
}

/// What the text of a model file describes, and where its numbers come from.
fn describe_structure(
    text: &str,
    name: &str,
) -> anyhow::Result<(String, BTreeMap<String, Provenance>)> {
    if is_small_plant(text) {
        return Ok((
            describe_body(&Body::from_toml(text, name)?),
            BTreeMap::new(),
        ));
    }
    if is_controller(text) {
        let law = match ControlLaw::from_toml(text, name)? {
            ControlLaw::Speed(_) => "proportional and integral, on the speed",
            ControlLaw::SoftTorque(_) => {
                "soft torque: yields to the torque as a matched damper would"
            }
        };
        return Ok((format!("control  {law}\n"), BTreeMap::new()));
    }
    let model = ModelFile::parse(text, name)?;
    Ok((describe_rig(&model), model.provenance))
}

fn describe_body(body: &Body<f64>) -> String {
    let (kind, path) = (body.kind.word(), body.path.word());
    let mut text = format!("plant    {kind} on a {path}\n");
    for effect in body.terms().filter_map(|term| term.definition.effect) {
        let (name, port, equation) = (effect.name, effect.port.name(), effect.equation);
        let _ = writeln!(
            text,
            "equation {name}: {port} {equation} ({})",
            effect.title
        );
    }
    text
}

fn describe_rig(model: &ModelFile) -> String {
    let rig = &model.rig;
    let kind = match rig.kind() {
        RigKind::Reduced => "reduced: motor, gearbox, shaft, disc D2",
        RigKind::Full => "full: motor, gearbox, shaft, disc D2, second shaft, disc D1",
    };
    let disc1 = rig.disc1.iter().flat_map(|disc1| disc1.effects.active());
    let active = rig.effects.active().into_iter().chain(disc1);
    let mut effects: Vec<&str> = active.map(|(name, _)| name).collect();
    let equations: Vec<&Definition> = rig.equations.active().map(|e| e.definition).collect();
    effects.extend(equations.iter().map(|effect| effect.name()));
    let mut text = format!("rig      {kind}\nlaw      {} (pin on D2)\n", rig.law.name());
    if let Some(disc1) = &rig.disc1 {
        let _ = writeln!(text, "law      {} (pin on D1)", disc1.law.name());
    }
    let _ = writeln!(
        text,
        "effects  {}",
        if effects.is_empty() {
            "none".to_owned()
        } else {
            effects.join(", ")
        }
    );
    for effect in equations {
        let (name, port, equation) = (effect.name(), effect.port().name(), effect.equation());
        let _ = writeln!(
            text,
            "equation {name}: {port} {equation} ({})",
            effect.title()
        );
    }
    text
}

/// Describes an FMU: version, sizes, the model inside if it is one of this project's, and the variables.
fn describe_fmu(path: &Path) -> anyhow::Result<String> {
    let size = fs::metadata(path)
        .with_context(|| format!("{}: cannot be read", path.display()))?
        .len();
    let description: Description = Fmu::describe(path)?;
    let version = match description.version {
        FmiVersion::Two => "2.0",
        FmiVersion::Three => "3.0",
    };
    let mut out = format!(
        "{} ({size} bytes)\n\nFMI      {version}, co-simulation\n",
        path.display()
    );
    let _ = writeln!(
        out,
        "model    {} (binary {})",
        description.model_name, description.model_identifier
    );
    let _ = writeln!(out, "token    {}", description.token);
    let _ = writeln!(out, "made by  {}", description.generation_tool);
    let archive = Archive::unpack(path)?;
    for (name, size) in files(archive.directory(), "") {
        let _ = writeln!(out, "file     {size:>9}  {name}");
    }
    let mut provenance = BTreeMap::new();
    let model_file = archive.directory().join("resources/model.toml");
    if let Ok(text) = fs::read_to_string(&model_file)
        && let Ok((structure, sources)) = describe_structure(&text, "resources/model.toml")
    {
        out += &structure;
        provenance = sources;
    }
    out.push('\n');
    out += &describe_variables(&description.variables, &provenance);
    Ok(out)
}

/// Files below a directory with their sizes, sorted by name.
fn files(directory: &Path, prefix: &str) -> Vec<(String, u64)> {
    let mut found = Vec::new();
    for entry in fs::read_dir(directory).into_iter().flatten().flatten() {
        let name = format!("{prefix}{}", entry.file_name().to_string_lossy());
        match entry.metadata() {
            Ok(metadata) if metadata.is_dir() => {
                found.extend(files(&entry.path(), &format!("{name}/")))
            }
            Ok(metadata) => found.push((name, metadata.len())),
            Err(_) => {}
        }
    }
    found.sort();
    found
}

/// Names longer than this stand out of their column: an FMU may have one of a mebibyte, and a hundred thousand others.
const WIDEST_COLUMN: usize = 60;

fn describe_variables(variables: &[Variable], provenance: &BTreeMap<String, Provenance>) -> String {
    let mut text = String::new();
    let groups = [
        ("inputs", Role::Input),
        ("outputs", Role::Output),
        ("internal quantities", Role::Local),
        ("parameters", Role::Parameter),
    ];
    for (title, role) in groups {
        let rows: Vec<&Variable> = variables
            .iter()
            .filter(|variable| variable.role == role)
            .collect();
        if rows.is_empty() {
            continue;
        }
        let _ = writeln!(text, "{title}");
        let widest = rows.iter().map(|row| row.name.len()).max().unwrap_or(0);
        let width = widest.min(WIDEST_COLUMN);
        for row in rows {
            let unit = if row.kind == Kind::Boolean {
                "true/false"
            } else {
                &row.unit
            };
            let value = match (row.role, row.start) {
                (Role::Parameter, Some(value)) => format!("{value:>12} "),
                _ => String::new(),
            };
            let source = provenance
                .get(&row.name)
                .map(describe_provenance)
                .unwrap_or_default();
            let line = format!(
                "  {:width$}  {value}{unit:<11} {}{source}",
                row.name, row.description
            );
            let _ = writeln!(text, "{}", line.trim_end());
        }
        text.push('\n');
    }
    text
}

fn describe_provenance(provenance: &Provenance) -> String {
    let parts: Vec<&str> = [&provenance.status, &provenance.source]
        .into_iter()
        .flatten()
        .map(String::as_str)
        .collect();
    if parts.is_empty() {
        String::new()
    } else {
        format!(" [{}]", parts.join(": "))
    }
}
