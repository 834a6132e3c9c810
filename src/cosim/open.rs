//! From the text of `model.toml` to the model that it describes.

use super::body::BodyModel;
use super::controller::{ControllerExchange, ControllerModel};
use super::model::{CoSimulationModel, ModelError};
use super::rig::{RigExchange, RigModel};
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
    let refused = |error| ModelError(format!("{file_name}: {error}"));
    if is_controller(text) {
        let law = ControlLaw::from_toml(text, file_name).map_err(ModelError::from_display)?;
        return Ok(Box::new(
            ControllerExchange::new(law, text).map_err(refused)?,
        ));
    }
    if is_small_plant(text) {
        return Err(ModelError(format!(
            "{file_name}: a small plant is for co-simulation only"
        )));
    }
    let rig = Rig::from_toml(text, file_name).map_err(ModelError::from_display)?;
    Ok(Box::new(RigExchange::new(rig, text).map_err(refused)?))
}
