//! A joint's parameters as XML: a default class of MuJoCo, a joint of URDF.

use std::io;

use clap::ValueEnum;
use quick_xml::Writer;
use quick_xml::events::{BytesDecl, BytesEnd, BytesStart, BytesText, Event};
use stickslip::body::{Kind, Path};

use super::joint::Joint;

/// What reads the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Target {
    /// MuJoCo: damping, frictionloss and armature as a default class, with the motor of a joint.
    Mujoco,
    /// URDF: damping and friction.
    Urdf,
}

impl Target {
    /// What the target calls dry friction.
    #[must_use]
    pub fn friction(self) -> &'static str {
        match self {
            Self::Mujoco => "frictionloss",
            Self::Urdf => "friction",
        }
    }
}

/// The file's text; `model` names the model file.
///
/// # Errors
/// Memory cannot be written.
pub fn text(target: Target, joint: &Joint, name: &str, model: &str) -> io::Result<String> {
    let mut writer = Writer::new_with_indent(Vec::new(), b' ', 2);
    writer.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    let comment = comment(target, joint, name, model);
    writer.write_event(Event::Comment(BytesText::from_escaped(comment)))?;
    let (damping, friction) = (number(joint.line.damping), number(joint.line.friction));
    match target {
        Target::Mujoco => mujoco(&mut writer, joint, name, [&damping, &friction])?,
        Target::Urdf => {
            open(&mut writer, "joint", &[("name", name)])?;
            let attributes = [("damping", &*damping), ("friction", &*friction)];
            leaf(&mut writer, "dynamics", &attributes)?;
            close(&mut writer, "joint")?;
        }
    }
    let mut text = String::from_utf8(writer.into_inner()).map_err(io::Error::other)?;
    text.push('\n');
    Ok(text)
}

type Output = Writer<Vec<u8>>;

fn mujoco(
    writer: &mut Output,
    joint: &Joint,
    name: &str,
    [damping, friction]: [&str; 2],
) -> io::Result<()> {
    let kind = match joint.path {
        Path::Turn => "hinge",
        Path::Line => "slide",
    };
    let armature = joint.armature.map(|(armature, _)| number(armature));
    let mut attributes = vec![
        ("type", kind),
        ("damping", damping),
        ("frictionloss", friction),
    ];
    attributes.extend(armature.as_deref().map(|armature| ("armature", armature)));
    open(writer, "mujoco", &[])?;
    open(writer, "default", &[])?;
    open(writer, "default", &[("class", name)])?;
    leaf(writer, "joint", &attributes)?;
    if let Some(drive) = joint.drive {
        let gain = number(drive.gain);
        let bias = format!("0 0 {}", number(-drive.back_emf));
        let attributes = [
            ("gaintype", "fixed"),
            ("gainprm", &*gain),
            ("biastype", "affine"),
            ("biasprm", &*bias),
        ];
        leaf(writer, "general", &attributes)?;
    }
    close(writer, "default")?;
    close(writer, "default")?;
    open(writer, "custom", &[])?;
    let range = format!("{} {}", number(joint.speeds.low), number(joint.speeds.high));
    let error = number(above(joint.line.error));
    for (what, data) in [("speed_range", &*range), ("largest_error", &*error)] {
        let key = format!("{name}_{what}");
        leaf(writer, "numeric", &[("name", &*key), ("data", data)])?;
    }
    close(writer, "custom")?;
    close(writer, "mujoco")
}

fn open(writer: &mut Output, name: &str, attributes: &[(&str, &str)]) -> io::Result<()> {
    let element = BytesStart::new(name).with_attributes(attributes.iter().copied());
    writer.write_event(Event::Start(element))
}

fn leaf(writer: &mut Output, name: &str, attributes: &[(&str, &str)]) -> io::Result<()> {
    let element = BytesStart::new(name).with_attributes(attributes.iter().copied());
    writer.write_event(Event::Empty(element))
}

fn close(writer: &mut Output, name: &str) -> io::Result<()> {
    writer.write_event(Event::End(BytesEnd::new(name)))
}

/// A number that reads back exactly.
#[must_use]
pub fn number(value: f64) -> String {
    let magnitude = value.abs();
    if magnitude != 0.0 && !(1e-4..1e7).contains(&magnitude) {
        format!("{value:e}")
    } else {
        // No sign of a zero.
        format!("{}", value + 0.0)
    }
}

/// A positive number to three digits that is not below it.
#[must_use]
pub fn above(value: f64) -> f64 {
    let up = |factor: f64| format!("{:.2e}", value * factor).parse().unwrap_or(value);
    let near: f64 = up(1.0);
    if near >= value { near } else { up(1.005) }
}

/// What the parameters are worth and what they leave out.
fn comment(target: Target, joint: &Joint, name: &str, model: &str) -> String {
    let (force, speed) = (joint.force_unit(), joint.speed_unit());
    let friction = target.friction();
    let own = match target {
        Target::Mujoco => "damping, frictionloss and armature",
        Target::Urdf => "damping and friction",
    };
    let mut lines = vec![
        format!("{name}: {own} of the joint in {model}, by stickslip export."),
        match target {
            Target::Mujoco => format!(
                "Include this file and give the joint class=\"{name}\"; units are SI, angles in radians."
            ),
            Target::Urdf => {
                "Copy the element dynamics into the joint of that name; units are SI.".to_owned()
            }
        },
        String::new(),
        format!(
            "Range: speeds from {} to {} {speed}, in both directions. Nothing was fitted beyond it.",
            number(joint.speeds.low),
            number(joint.speeds.high)
        ),
        format!(
            "Largest error in this range: {} {force}, at {} {speed}, where the law has {} {force}.",
            number(above(joint.line.error)),
            number(super::line::rounded(joint.line.at)),
            number(super::line::rounded(joint.there))
        ),
        format!(
            "It is the error of damping and {friction} beside the model's law over the speed alone: {}.",
            [&["viscous"], &*joint.counted].concat().join(", ")
        ),
        format!(
            "At rest that law holds up to {} {force}; {friction} is {} {force}.",
            number(super::line::rounded(joint.at_rest)),
            number(joint.line.friction)
        ),
    ];
    if joint.line.damping == 0.0 {
        lines.push("Damping is 0 because the law does not grow with the speed.".to_owned());
    }
    lines.push(String::new());
    lines.push("From:".to_owned());
    lines.extend(joint.sources.iter().map(|source| format!("- {source}")));
    lines.extend(inertia(target, joint));
    if let (Some(drive), Target::Mujoco) = (joint.drive, target) {
        lines.push(format!(
            "- an actuator general class=\"{name}\" is the motor: ctrl in V, {} N.m/V, less {} N.m.s/rad of back-EMF; \
             disable it while the motor's terminals are open",
            number(drive.gain),
            number(drive.back_emf)
        ));
    }
    lines.push(String::new());
    lines.push(format!("Not in {own}:"));
    let mut missing = joint.missing.clone();
    if let (Some(drive), Target::Urdf) = (joint.drive, target) {
        missing.push(format!(
            "the motor: {} N.m/V, less {} N.m.s/rad of back-EMF while its terminals are connected",
            number(drive.gain),
            number(drive.back_emf)
        ));
    }
    missing.push(match target {
        Target::Mujoco => "exact rest: MuJoCo's frictionloss is a soft constraint, under which a loaded joint creeps".to_owned(),
        Target::Urdf => "how friction holds at rest: each simulator reads it its own way".to_owned(),
    });
    missing.push(
        "backlash, an elastic shaft, delays and a sag of the supply: the motion of the model does not have them either, so no number stands for them"
            .to_owned(),
    );
    lines.extend(missing.iter().map(|line| format!("- {line}")));
    let mut text = lines.iter().fold(String::new(), |text, line| {
        let line = format!("  {line}");
        text + "\n" + line.trim_end()
    });
    text.push('\n');
    // A comment of XML has no such signs.
    while text.contains("--") {
        text = text.replace("--", "- -");
    }
    text
}

/// Where the inertia is.
fn inertia(target: Target, joint: &Joint) -> Vec<String> {
    let unit = joint.inertia_unit();
    let whole = number(joint.inertia);
    let over = if joint.kind.runs_alone() {
        ", by which the model's numbers are multiplied"
    } else {
        ""
    };
    let mut lines = vec![format!("- the whole inertia, {whole} {unit}{over}")];
    let rest = |armature: f64| number(super::line::rounded(joint.inertia - armature));
    lines.push(match (joint.armature, target) {
        (Some((armature, [rotor, ratio])), Target::Mujoco) => format!(
            "- armature = {} kg.m2 of the rotor times the square of {}; the body has the rest, {} {unit}",
            number(rotor),
            number(ratio),
            rest(armature)
        ),
        (Some((armature, [rotor, ratio])), Target::Urdf) => format!(
            "- URDF has no armature: {} {unit}, that is {} kg.m2 of the rotor times the square of {}; the link alone has {} {unit}",
            number(armature),
            number(rotor),
            number(ratio),
            rest(armature)
        ),
        (None, Target::Mujoco) => format!("- no armature, because a {} has no motor", joint.kind.word()),
        (None, Target::Urdf) if joint.kind == Kind::Pendulum => {
            "- no motor, so that the link has all of it".to_owned()
        }
        (None, Target::Urdf) => {
            "- URDF has no armature; the motor's part of the inertia was not given".to_owned()
        }
    });
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_is_never_rounded_down() {
        for value in [0.0, 1e-17, 0.123_001, 0.123_499, 0.123_5, 9.996, 1.0] {
            let found = above(value);
            assert!(found >= value && found <= value * 1.011, "{value}: {found}");
        }
    }
}
