//! From the text of `model.toml` to the model that it describes.

use super::body::BodyModel;
use super::controller::ControllerModel;
use super::model::{CoSimulationModel, ModelError};
use super::rig::RigModel;
use super::rig::exchange::RigExchange;
use crate::body::{Body, is_small_plant};
use crate::controller::{ControlLaw, is_controller};
use crate::plant::Rig;

/// Name of the resource that describes the component.
pub const MODEL_FILE: &str = "model.toml";

/// The model that `text`, the content of `file_name`, describes.
///
/// # Errors
/// The text is not a complete and consistent description; the message names file, key and value.
pub fn open(text: &str, file_name: &str) -> Result<Box<dyn CoSimulationModel>, ModelError> {
    let table_error = |error| ModelError(format!("{file_name}: {error}"));
    if is_controller(text) {
        let law = ControlLaw::from_toml(text, file_name).map_err(ModelError::from_display)?;
        let model = ControllerModel::new(law, text).map_err(table_error)?;
        return Ok(Box::new(model));
    }
    if is_small_plant(text) {
        let body = Body::from_toml(text, file_name).map_err(ModelError::from_display)?;
        return Ok(Box::new(BodyModel::new(body, text).map_err(table_error)?));
    }
    let rig = Rig::from_toml(text, file_name).map_err(ModelError::from_display)?;
    let model = RigModel::new(rig, text).map_err(table_error)?;
    Ok(Box::new(model))
}

/// The model that `text`, the content of `file_name`, describes, for an importer that brings the solver.
///
/// # Errors
/// As for [`open`]; and where the model is for co-simulation only.
pub fn open_for_exchange(
    text: &str,
    file_name: &str,
) -> Result<Box<dyn CoSimulationModel>, ModelError> {
    for (is_it, what) in [
        (is_controller(text), "controller"),
        (is_small_plant(text), "small plant"),
    ] {
        if is_it {
            return Err(ModelError(format!(
                "{file_name}: a {what} is for co-simulation only"
            )));
        }
    }
    let rig = Rig::from_toml(text, file_name).map_err(ModelError::from_display)?;
    let model = RigExchange::new(rig, text);
    Ok(Box::new(model.map_err(|error| {
        ModelError(format!("{file_name}: {error}"))
    })?))
}
