//! Which parameters are drawn, how far they spread, and the draw itself.

use inference::random::Random;
use stickslip::parameter::ParameterError;
use stickslip::plant::{ModelFile, Rig};

use super::settings::EnsembleError;
use crate::diagnose::uncertainty::stated;
use crate::map::settings::unknown_parameter;

/// Draws in a row that the rig may refuse.
const MOST_REFUSED: usize = 1000;

/// A parameter with its uncertainty.
#[derive(Debug, Clone, PartialEq)]
pub struct Uncertain {
    /// Dotted name.
    pub name: String,
    /// Standard deviation over the value, from 0 to below 1.
    pub relative: f64,
}

/// The parameters that vary: those of `draw`, or all whose uncertainty the model states, each with what `given` says or the model
/// states.
///
/// # Errors
/// [`EnsembleError`] where a name is unknown, a number cannot be one, or nothing is known of a parameter.
pub(super) fn parameters(
    model: &ModelFile,
    file: &str,
    draw: &[String],
    given: &[Uncertain],
) -> Result<Vec<Uncertain>, EnsembleError> {
    let named = draw.iter().chain(given.iter().map(|one| &one.name));
    if let Some(name) = named
        .clone()
        .find(|name| model.rig.position(name).is_none())
    {
        return Err(unknown_parameter(&model.rig, name).into());
    }
    for (index, one) in given.iter().enumerate() {
        if given[..index].iter().any(|other| other.name == one.name) {
            return Err(EnsembleError::Twice {
                name: one.name.clone(),
            });
        }
        if !(0.0..1.0).contains(&one.relative) {
            return Err(EnsembleError::Relative {
                name: one.name.clone(),
                value: one.relative,
            });
        }
    }
    let stated = stated(model, file)?;
    let wanted: Vec<&String> = if draw.is_empty() {
        stated
            .iter()
            .map(|(name, _)| name)
            .chain(given.iter().map(|one| &one.name))
            .collect()
    } else {
        named.collect()
    };
    if wanted.is_empty() {
        return Err(EnsembleError::NothingStated {
            file: file.to_owned(),
        });
    }
    let mut all = Vec::new();
    for parameter in model.rig.parameters() {
        let name = parameter.name;
        if !wanted.contains(&&name) {
            continue;
        }
        let own = given
            .iter()
            .find(|one| one.name == name)
            .map(|one| one.relative);
        let relative = own.or_else(|| {
            stated
                .iter()
                .find(|(known, _)| *known == name)
                .map(|(_, value)| *value)
        });
        let Some(relative) = relative else {
            return Err(EnsembleError::NotStated {
                file: file.to_owned(),
                name,
            });
        };
        all.push(Uncertain { name, relative });
    }
    Ok(all)
}

/// The rigs that were drawn.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Draw {
    /// The values of the parameters that vary, for each rig.
    pub values: Vec<Vec<f64>>,
    /// How many were drawn and refused, since their parameters contradict each other.
    pub refused: usize,
}

/// Draws `runs` rigs around `rig`. A parameter is its nominal value times a lognormal factor with median 1, which keeps its sign.
/// The first rigs are the same whatever the number of runs.
///
/// # Errors
/// [`EnsembleError::Refused`] where the rig refuses a thousand draws in a row.
pub(super) fn rigs(
    rig: &Rig<f64>,
    parameters: &[Uncertain],
    (runs, seed): (usize, u64),
) -> Result<Draw, EnsembleError> {
    let mut random = Random::new(seed);
    let mut draw = Draw {
        values: Vec::with_capacity(runs),
        refused: 0,
    };
    let mut in_a_row = 0;
    while draw.values.len() < runs {
        // All are drawn before any is checked, so that a refused rig uses as many random numbers as any other.
        let values: Vec<f64> = parameters
            .iter()
            .map(|one| {
                let factor = (one.relative.powi(2).ln_1p().sqrt() * random.normal()).exp();
                rig.parameter(&one.name).unwrap_or(f64::NAN) * factor
            })
            .collect();
        match with_values(rig, parameters, &values) {
            Ok(_) => {
                draw.values.push(values);
                in_a_row = 0;
            }
            Err(source) if in_a_row == MOST_REFUSED => {
                return Err(EnsembleError::Refused {
                    count: MOST_REFUSED,
                    source,
                });
            }
            Err(_) => {
                draw.refused += 1;
                in_a_row += 1;
            }
        }
    }
    Ok(draw)
}

/// The rig with other values of the parameters that vary.
///
/// # Errors
/// Where it refuses them.
pub(super) fn with_values(
    rig: &Rig<f64>,
    parameters: &[Uncertain],
    values: &[f64],
) -> Result<Rig<f64>, ParameterError> {
    let mut drawn = *rig;
    for (parameter, value) in parameters.iter().zip(values) {
        drawn.set_parameter(&parameter.name, *value)?;
    }
    drawn.check()?;
    Ok(drawn)
}
