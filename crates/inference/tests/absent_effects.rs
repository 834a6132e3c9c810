//! An effect that may be zero is no answer, one that is surely there is.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail")]

use inference::effects::EFFECTS;
use inference::problem::{Catalogue, Problem};
use inference::search::{Objection, fit_effects};
use stickslip::plant::{Rig, Supposition};

mod common;
use common::{instruments, prepare_threads, record};

const REDUCED: &str = include_str!("../../../modelDescription/reduced-rig.toml");
const FULL: &str = include_str!("../../../modelDescription/full-rig.toml");
/// A constant pull and a drag, each of which is there without the other.
const TWO_SIZES: &str = "[[effect]]\nname = \"pull_and_drag\"\ntitle = \"a pull and a drag\"\nport = \"disc.torque\"\n\
    equation = \"-pull - drag*velocity\"\n\
    parameters.pull = { unit = \"N.m\", description = \"constant torque\" }\n\
    parameters.drag = { unit = \"N.m.s/rad\", description = \"torque over velocity\" }\n";

/// A record of the rig with `hidden` effects, under the rig without them.
fn problem(believed: &str, hidden: &str) -> Problem {
    prepare_threads();
    let rig = Rig::from_toml(believed, "believed").unwrap();
    let truth = Rig::from_toml(&format!("{believed}\n{hidden}"), "truth").unwrap();
    let catalogue = Catalogue {
        supposed: Supposition::read_all(TWO_SIZES, "effects").unwrap(),
        ..Catalogue::default()
    };
    let known = vec![("disc.inertia".to_owned(), 0.006)];
    Problem::new(
        &rig,
        known,
        &[record(&truth, 1)],
        &instruments(),
        &catalogue,
    )
    .unwrap()
}

#[test]
fn the_numbers_that_make_an_effect_vanish_are_free_in_its_fits() {
    let problem = problem(FULL, "");
    for effect in EFFECTS.iter().chain(&problem.effects) {
        let starts = effect.starts(&problem.hypothesis(), &problem.long.scales, None);
        for start in starts {
            let free = start.estimates(|_, _| 0.0);
            for (name, value) in effect.vanishing() {
                let own = free.iter().find(|own| own.name == name);
                let own = own.unwrap_or_else(|| panic!("{} has no {name}", effect.name));
                assert_ne!(own.value, value, "{name} starts where nothing tells of it");
            }
        }
    }
}

#[test]
fn what_is_not_there_may_be_zero_and_what_is_there_may_not() {
    let objection = |hidden: &str, name: &str| {
        let fitted = fit_effects(&problem(REDUCED, hidden), &[name], &mut |_| {});
        fitted.unwrap().objection
    };
    for name in ["viscous_drag", "pull_and_drag", "unbalance"] {
        assert_eq!(objection("", name), Some(Objection::MayVanish(vec![name])));
    }
    for name in ["viscous_drag", "pull_and_drag"] {
        let found = objection("[viscous_drag]\ncoefficient = 0.006\n", name);
        assert_eq!(found, None, "{name}");
    }
}
