//! A small plant as a joint of a simulator of robots: its parameters, and what they leave out.

use std::collections::BTreeMap;

use stickslip::body::{Dimension, Kind, Path, Reader};
use stickslip::parameter::Provenance;

use super::error::ExportError;
use super::law::{Law, Left};
use super::line::{Line, Speeds, closest, rounded};
use crate::diagnose::small_plant::model_file::dotted;
use crate::diagnose::small_plant::model_reader;
use inference::body::model::{Model, Term};

/// What the model file does not have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Given {
    /// Range of speeds.
    pub speeds: Speeds,
    /// Whole moment of inertia about the axis [kg m²].
    pub inertia: Option<f64>,
    /// Inertia of the rotor [kg m²] and ratio of the gearbox [1 or rad/m].
    pub motor: Option<[f64; 2]>,
    /// Whether the target has an armature, so that it must be known.
    pub needs_armature: bool,
}

/// A motor under a voltage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drive {
    /// Torque over voltage at standstill [N m/V].
    pub gain: f64,
    /// Torque that it loses over speed [N m s/rad].
    pub back_emf: f64,
}

/// A joint's parameters with what they are worth.
#[derive(Debug, Clone)]
pub struct Joint {
    /// Kind of the small plant.
    pub kind: Kind,
    /// Along what it moves.
    pub path: Path,
    /// Range of speeds.
    pub speeds: Speeds,
    /// Damping and dry friction.
    pub line: Line,
    /// The law where the error is largest, with the velocity's sign.
    pub there: f64,
    /// What holds at rest, the smaller one of both directions.
    pub at_rest: f64,
    /// Whole inertia [kg m² or kg].
    pub inertia: f64,
    /// The motor's part, with rotor and ratio from which it comes; none where no motor was given.
    pub armature: Option<(f64, [f64; 2])>,
    /// The motor under a voltage, if it is known.
    pub drive: Option<Drive>,
    /// Numbers of the model that the line stands for.
    pub sources: Vec<String>,
    /// Names of the effects among them.
    pub counted: Vec<&'static str>,
    /// What of the plant these parameters do not have.
    pub missing: Vec<String>,
    /// The same in a word each, of effects alone.
    pub left: Vec<&'static str>,
}

impl Joint {
    /// The joint of a model file's text; `file` names it in messages.
    ///
    /// # Errors
    /// What is wrong with the file or with what was given beside it.
    pub fn of(text: &str, file: &str, given: &Given) -> Result<Self, ExportError> {
        let reader = Reader::new(text, file)?;
        let kind = reader.plant()?.kind;
        if let Some(why) = kind.stands_still() {
            let (file, kind) = (file.to_owned(), kind.word());
            return Err(ExportError::Kind { file, kind, why });
        }
        let (model, origins) = model_reader::model(&reader, false)?;
        let inertia = inertia(&model, file, given.inertia)?;
        let armature = armature(&model, file, inertia, given)?;
        let scale = if kind.runs_alone() { inertia } else { 1.0 };
        let law = Law::of(&model, scale);
        let force = |velocity, direction| law.force(velocity, direction);
        let line = closest(given.speeds, force).map_err(|velocity| ExportError::NotFinite {
            file: file.to_owned(),
            velocity,
            unit: Dimension::Speed.unit(kind, model.path),
        })?;
        let base = model.terms().first();
        let number = |place: usize| base.and_then(|base| base.values.get(place).copied());
        let drive = match (kind, number(3), number(4)) {
            (Kind::Joint, Some(gain), Some(back_emf)) => Some(Drive {
                gain: rounded(scale * gain),
                back_emf: rounded(scale * back_emf),
            }),
            _ => None,
        };
        let mut sources = Vec::new();
        if let Some(base) = base {
            sources.extend(stated(base, &model, &origins, &["viscous"]));
        }
        for term in &law.terms {
            sources.extend(stated(term, &model, &origins, &[]));
        }
        Ok(Self {
            kind,
            path: model.path,
            speeds: given.speeds,
            line,
            there: force(line.at, if line.at < 0.0 { -1.0 } else { 1.0 }),
            at_rest: force(0.0, 1.0).min(-force(0.0, -1.0)),
            inertia,
            armature,
            drive,
            sources,
            counted: law.terms.iter().map(|term| term.entry.name).collect(),
            missing: missing(&model, &law, scale),
            left: law.left.iter().map(|left| left.term.entry.name).collect(),
        })
    }

    /// Unit of a force.
    #[must_use]
    pub fn force_unit(&self) -> &'static str {
        match self.path {
            Path::Turn => "N.m",
            Path::Line => "N",
        }
    }

    /// Unit of a damping.
    #[must_use]
    pub fn damping_unit(&self) -> &'static str {
        match self.path {
            Path::Turn => "N.m.s/rad",
            Path::Line => "N.s/m",
        }
    }

    /// Unit of a speed.
    #[must_use]
    pub fn speed_unit(&self) -> &'static str {
        Dimension::Speed.unit(self.kind, self.path)
    }

    /// Unit of an inertia.
    #[must_use]
    pub fn inertia_unit(&self) -> &'static str {
        inertia_unit(self.path)
    }
}

fn inertia_unit(path: Path) -> &'static str {
    match path {
        Path::Turn => "kg.m2",
        Path::Line => "kg",
    }
}

/// The whole inertia.
fn inertia(model: &Model, file: &str, given: Option<f64>) -> Result<f64, ExportError> {
    let own = match model.kind {
        Kind::Drive => model.terms().first().map(|_| model.value(0, 0)),
        _ => None,
    };
    let file = file.to_owned();
    match (own, given) {
        (Some(inertia), None) => Ok(inertia),
        (Some(inertia), Some(_)) => Err(ExportError::Inertia { file, inertia }),
        (None, Some(inertia)) => checked("--inertia", inertia, "kg.m2"),
        (None, None) => Err(ExportError::NoInertia {
            file,
            kind: model.kind.word(),
        }),
    }
}

/// The motor's part of the inertia with rotor and ratio, none where no motor is given and none is needed.
fn armature(
    model: &Model,
    file: &str,
    inertia: f64,
    given: &Given,
) -> Result<Option<(f64, [f64; 2])>, ExportError> {
    let ratio_unit = match model.path {
        Path::Turn => "1",
        Path::Line => "rad/m",
    };
    let file = file.to_owned();
    let [rotor, ratio] = match (model.kind, given.motor) {
        (Kind::Pendulum, Some(_)) => return Err(ExportError::Motor { file }),
        (Kind::Pendulum, None) => return Ok(None),
        (_, Some(motor)) => motor,
        (_, None) if given.needs_armature => {
            return Err(ExportError::NoMotor {
                file,
                unit: ratio_unit,
            });
        }
        (_, None) => return Ok(None),
    };
    let rotor = checked("--rotor-inertia", rotor, "kg.m2")?;
    let ratio = checked("--ratio", ratio, ratio_unit)?;
    let armature = rounded(rotor * ratio * ratio);
    if armature > inertia {
        return Err(ExportError::Armature {
            rotor,
            ratio,
            armature,
            inertia,
            unit: inertia_unit(model.path),
        });
    }
    Ok(Some((armature, [rotor, ratio])))
}

fn checked(option: &'static str, value: f64, unit: &'static str) -> Result<f64, ExportError> {
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(ExportError::Number {
            option,
            value,
            unit,
        })
    }
}

/// Numbers of a term with their intervals: those with these keys, or all.
fn stated(
    term: &Term,
    model: &Model,
    origins: &BTreeMap<String, Provenance>,
    keys: &[&str],
) -> Vec<String> {
    let numbers = term.entry.parameters.iter().zip(&term.values);
    let wanted = numbers.filter(|(own, _)| keys.is_empty() || keys.contains(&own.key));
    wanted
        .map(|(own, value)| {
            let name = dotted(term.entry, own.key);
            let unit = own.dimension.unit(model.kind, model.path);
            let interval = origins.get(&name).and_then(|origin| origin.interval95);
            let interval = interval.map_or(String::new(), |[low, high]| {
                format!(" (95 %: {low} to {high})")
            });
            format!("{name} = {value} {unit}{interval}")
        })
        .collect()
}

/// What of a plant a joint's parameters do not have, a line each.
fn missing(model: &Model, law: &Law<'_>, scale: f64) -> Vec<String> {
    let base = model.terms().first();
    let number = |place: usize| base.and_then(|base| base.values.get(place).copied());
    let mut lines = Vec::new();
    match (model.kind, number(0), number(2)) {
        (Kind::Joint | Kind::Pendulum, Some(stiffness), _) => lines.push(format!(
            "the moment of the weight, {} N.m where the arm is level: the mass of the body and its place give it",
            rounded(scale * stiffness)
        )),
        (_, _, Some(offset)) if offset != 0.0 => lines.push(format!(
            "drive.offset, a constant force of {offset} {} against the forward motion",
            Dimension::Force.unit(model.kind, model.path)
        )),
        _ => {}
    }
    lines.extend(law.left.iter().map(|left| described(left, model)));
    lines
}

fn described(left: &Left<'_>, model: &Model) -> String {
    use super::law::Reason;
    let entry = left.term.entry;
    let why = match &left.reason {
        Reason::Depends(on) => format!("depends on {}", on.join(" and ")),
        Reason::Friction => {
            "multiplies a friction that does not depend on the speed alone".to_owned()
        }
        Reason::Constant => "is a force that does not depend on the motion".to_owned(),
        Reason::Readings => {
            "is in the readings, not in the joint: model it at the sensor".to_owned()
        }
    };
    let equation = match entry.equation() {
        Some(equation) => format!(": {equation}"),
        None => String::new(),
    };
    let numbers = stated(left.term, model, &BTreeMap::new(), &[]).join(", ");
    let level = left.level.map_or(String::new(), |force| {
        format!(
            "; {} N.m where the motor holds the arm level",
            rounded(force)
        )
    });
    format!("{} {why}{equation}, with {numbers}{level}", entry.name)
}
