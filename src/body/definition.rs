//! What a body's terms are, once for all bodies that have them.

use std::sync::{Mutex, OnceLock, PoisonError};

use operations::Operation;

use super::coordinate::{ACCELERATION, FRICTION};
use super::effect::{Described, Effect};
use super::{Dimension, FileError, Kind, Parameter, Path};
use crate::expression::Program;
use crate::parameter::ParameterInfo;

/// A base or an effect without its numbers.
#[derive(Debug)]
pub struct Definition {
    /// Name, and section in the model file.
    pub name: &'static str,
    /// Its numbers.
    pub infos: &'static [ParameterInfo],
    /// The effect; `None` of a base.
    pub effect: Option<&'static Effect>,
}

impl PartialEq for Definition {
    /// Whether both are the same one: equal descriptions give the same.
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self, other)
    }
}

type Key = (Option<Described>, Kind, Path);

/// The definition of an effect, or of a base, on plants of this kind and path. It lives as long as the program: bodies are copied by
/// the million, and what does not change is shared.
fn shared(
    key: Key,
    make: impl FnOnce(&Key) -> Result<Definition, FileError>,
) -> Result<&'static Definition, FileError> {
    static KNOWN: OnceLock<Mutex<Vec<(Key, &'static Definition)>>> = OnceLock::new();
    let known = KNOWN.get_or_init(|| Mutex::new(Vec::new()));
    let mut known = known.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((_, found)) = known.iter().find(|(other, _)| *other == key) {
        return Ok(found);
    }
    let definition: &'static Definition = Box::leak(Box::new(make(&key)?));
    known.push((key, definition));
    Ok(definition)
}

fn infos(
    parameters: &[Parameter],
    (kind, path): (Kind, Path),
    is_base: bool,
) -> &'static [ParameterInfo] {
    let infos = parameters.iter().map(|own| ParameterInfo {
        key: own.key,
        // Units of variables are coherent ones: a share per minute is a number there, as its name says.
        unit: match own.dimension {
            Dimension::PerMinute => "1",
            other => other.unit(kind, path),
        },
        range: own.range,
        description: own.description,
        built_in: is_base && own.dimension == Dimension::Inertia,
    });
    infos.collect::<Vec<_>>().leak()
}

/// The definition of a base with these parameters.
pub(super) fn of_base(
    parameters: &'static [Parameter],
    kind: Kind,
    path: Path,
) -> Result<&'static Definition, FileError> {
    shared((None, kind, path), |_| {
        Ok(Definition {
            name: kind.word(),
            infos: infos(parameters, (kind, path), true),
            effect: None,
        })
    })
}

/// The definition of an effect; `file` names its file in messages.
pub(super) fn of_effect(
    described: &Described,
    file: &str,
    kind: Kind,
    path: Path,
) -> Result<&'static Definition, FileError> {
    let key = (Some(described.without_numbers()), kind, path);
    shared(key, |_| {
        let effect: &'static Effect = Box::leak(Box::new(described.effect(file, kind, path)?));
        Ok(Definition {
            name: effect.name,
            infos: infos(effect.parameters, (kind, path), false),
            effect: Some(effect),
        })
    })
}

/// How an equation depends on the acceleration.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Dependence {
    /// Not at all.
    None,
    /// In proportion, with another slope beyond each kink.
    Proportional,
    /// In another way.
    Other,
}

/// How `program` depends on the acceleration, where the friction that it may depend on does so like `friction`.
pub(super) fn dependence(program: &Program, friction: Dependence) -> Dependence {
    use Dependence::{None, Other, Proportional};
    let mut known: Vec<Dependence> = Vec::new();
    for operation in program.operations() {
        let strongest = operation.operands().map(|operand| known[operand]).max();
        let strongest = strongest.unwrap_or(None);
        known.push(match *operation {
            Operation::Coordinate(ACCELERATION) => Proportional,
            Operation::Coordinate(FRICTION) => friction,
            Operation::Add(..)
            | Operation::Subtract(..)
            | Operation::Negate(_)
            | Operation::Absolute(..)
            | Operation::Minimum(..)
            | Operation::Maximum(..) => strongest,
            Operation::Multiply(a, b) if known[a] == None || known[b] == None => strongest,
            Operation::Divide(_, b) if known[b] == None => strongest,
            _ if strongest == None => None,
            _ => Other,
        });
    }
    known.last().copied().unwrap_or(None)
}
