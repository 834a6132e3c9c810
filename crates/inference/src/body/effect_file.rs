//! Effects of small plants as files: what a diagnosis needs of them beside their equations.

use std::fmt::Write as _;

use stickslip::body::coordinate::LOAD;
use stickslip::body::{CATALOGUE_FILE, Described, Effect, FileError, Kind, Path, Port, catalogue};

use super::model::Term;
use super::term::{Entry, Formula, Place, Role};

/// What an effect at each port is.
const ROLES: [(Port, Role); 2] = [(Port::Force, Role::Added), (Port::Friction, Role::Friction)];

/// An effect on a plant of this kind and path. It lives as long as the program, as the built-in ones do: a case has a few hundred bytes
/// of it.
///
/// # Errors
/// What is wrong with it, or why such a plant cannot have it.
pub fn effect(
    described: &Described,
    file: &str,
    kind: Kind,
    path: Path,
) -> Result<&'static Effect, FileError> {
    Ok(Box::leak(Box::new(described.effect(file, kind, path)?)))
}

/// An effect as one of the user's, for plants of this kind and path.
#[must_use]
pub fn of_user(effect: &'static Effect, kind: Kind, path: Path) -> Entry {
    let role = ROLES.into_iter().find(|(port, _)| *port == effect.port);
    Entry {
        name: effect.name,
        description: effect.title,
        signature: effect.signature,
        confusable: effect.confusable,
        kinds: vec![kind].leak(),
        path: Some(path),
        needs_load: effect.program.uses(LOAD),
        role: role.map_or(Role::Added, |(_, role)| role),
        parameters: effect.parameters,
        formula: Formula::Equation {
            text: effect.equation,
            operations: effect.program.operations(),
        },
        own: true,
        place: Place::Everywhere,
    }
}

/// The effects of the library's own file, which name the kinds that can have them.
///
/// # Errors
/// The file is wrong.
pub fn built_in() -> Result<Vec<Entry>, FileError> {
    let all = catalogue()?.iter().map(|described| {
        let kinds = described.kinds(CATALOGUE_FILE)?;
        let path = described.path(CATALOGUE_FILE)?;
        let (kind, on) = (
            kinds.first().copied().unwrap_or(Kind::Drive),
            path.unwrap_or(Path::Turn),
        );
        Ok(Entry {
            kinds: kinds.leak(),
            path,
            own: false,
            ..of_user(effect(described, CATALOGUE_FILE, kind, on)?, kind, on)
        })
    });
    all.collect()
}

/// The section `[[effect]]` of an effect with its numbers; `more` adds to each what is known of it.
#[must_use]
pub fn section(term: &Term, kind: Kind, path: Path, more: &dyn Fn(&str) -> String) -> String {
    let entry = term.entry;
    let port = ROLES.into_iter().find(|(_, role)| *role == entry.role);
    let mut text = format!(
        "\n[[effect]]\nname = {:?}\ntitle = {:?}\nport = {:?}\nequation = {:?}\n",
        entry.name,
        entry.description,
        port.map_or("", |(port, _)| port.name()),
        entry.equation().unwrap_or_default()
    );
    for (own, value) in entry.parameters.iter().zip(&term.values) {
        let _ = writeln!(
            text,
            "parameters.{} = {{ value = {value:?}, unit = {:?}, range = {}, description = {:?}{} }}",
            own.key,
            own.dimension.unit(kind, path),
            own.range.written(),
            own.description,
            more(own.key)
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::catalogue::{CATALOGUE, entry};

    #[test]
    fn every_kind_that_an_effect_names_can_have_it() {
        for described in catalogue().unwrap() {
            for kind in described.kinds("effects").unwrap() {
                let on = described.path("effects").unwrap().unwrap_or(Path::Turn);
                let entry = of_user(effect(described, "effects", kind, on).unwrap(), kind, on);
                let shared = CATALOGUE.iter().find(|own| own.name == entry.name);
                let operations = |entry: &Entry| match entry.formula {
                    Formula::Equation { operations, .. } => operations,
                    _ => &[],
                };
                assert_eq!(shared.map(operations), Some(operations(&entry)));
            }
        }
    }

    #[test]
    fn a_joint_has_its_weight_for_a_load_and_others_must_measure_one() {
        let friction = entry("external_load_friction").unwrap();
        assert!(friction.fits(Kind::Joint, Path::Turn, false));
        for kind in [Kind::Balance, Kind::Fmu] {
            assert!(friction.fits(kind, Path::Turn, true));
            assert!(!friction.fits(kind, Path::Turn, false));
        }
    }
}
