//! The parameters of all sections of a model as one flat list.

use super::{ParameterError, ParameterInfo, Section};
use crate::series::Scalar;

/// One parameter of a model.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Dotted name, section and key.
    pub name: String,
    /// Section of `model.toml`.
    pub section: &'static str,
    /// Key, unit, range and description.
    pub info: ParameterInfo,
}

/// All parameters of `sections`, in order.
pub(crate) fn parameters<S: Scalar>(
    sections: &[(&'static str, &dyn Section<S>)],
) -> Vec<Parameter> {
    let mut parameters = Vec::new();
    for (section, values) in sections {
        for info in values.infos() {
            parameters.push(Parameter {
                name: format!("{section}.{}", info.key),
                section,
                info: *info,
            });
        }
    }
    parameters
}

/// Value of the parameter at this position of [`parameters`].
pub(crate) fn value_at<S: Scalar>(
    sections: &[(&'static str, &dyn Section<S>)],
    position: usize,
) -> Option<S> {
    let mut position = position;
    for (_, values) in sections {
        if position < values.infos().len() {
            return Some(values.get(position));
        }
        position -= values.infos().len();
    }
    None
}

/// Position in [`parameters`] of the parameter with this dotted name.
pub(crate) fn position<S: Scalar>(
    sections: &[(&'static str, &dyn Section<S>)],
    name: &str,
) -> Option<usize> {
    let (section, key) = name.split_once('.')?;
    let mut position = 0;
    for (name, values) in sections {
        for info in values.infos() {
            if *name == section && info.key == key {
                return Some(position);
            }
            position += 1;
        }
    }
    None
}

/// Replaces a parameter by position after checking its range.
pub(crate) fn set_at<S: Scalar>(
    sections: Vec<(&'static str, &mut dyn Section<S>)>,
    position: usize,
    value: S,
) -> Result<(), ParameterError> {
    let mut left = position;
    for (section, values) in sections {
        let infos = values.infos();
        if let Some(info) = infos.get(left) {
            check_range(section, info, value.value())?;
            values.set(left, value);
            return Ok(());
        }
        left -= infos.len();
    }
    Err(ParameterError::Unknown {
        name: format!("number {position}"),
    })
}

/// Checks the range of every parameter.
pub(crate) fn check<S: Scalar>(
    sections: &[(&'static str, &dyn Section<S>)],
) -> Result<(), ParameterError> {
    for (section, values) in sections {
        for (j, info) in values.infos().iter().enumerate() {
            check_range(section, info, values.get(j).value())?;
        }
    }
    Ok(())
}

fn check_range(section: &str, info: &ParameterInfo, value: f64) -> Result<(), ParameterError> {
    if info.range.contains(value) {
        return Ok(());
    }
    Err(ParameterError::OutOfRange {
        name: format!("{section}.{}", info.key),
        value,
        range: info.range,
    })
}
