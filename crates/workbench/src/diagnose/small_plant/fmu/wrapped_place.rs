//! Where the effects act that an FMU around an FMU can have: at one port, by equations.

use super::wrapper::WrapperError;
use crate::diagnose::small_plant::model_file::SmallModel;
use inference::body::base::PARAMETERS;
use inference::body::term::{Formula, Place, Role};

/// The port at which all effects of a model act.
pub(super) fn place_of(model: &SmallModel, file: &str) -> Result<usize, WrapperError> {
    let mut at = None;
    for term in model
        .model
        .terms()
        .iter()
        .filter(|term| term.entry.name != PARAMETERS)
    {
        let elsewhere = |what| WrapperError::Elsewhere {
            file: file.to_owned(),
            effect: term.entry.name,
            what,
        };
        match (term.entry.formula, term.entry.place, term.entry.role) {
            (_, _, Role::Shift | Role::Reading) => {}
            (Formula::Equation { .. }, Place::Everywhere, _) => {}
            (Formula::Equation { .. }, Place::Port(own), _) => {
                if at.replace(own).is_some_and(|other| other != own) {
                    return Err(elsewhere("acts at another port than the effects before it"));
                }
            }
            (Formula::Repeats(_), _, _) => {
                return Err(elsewhere(
                    "repeats within a turn, for which there is no equation",
                ));
            }
            _ => return Err(elsewhere("changes something inside the FMU")),
        }
    }
    Ok(at.unwrap_or(0))
}
