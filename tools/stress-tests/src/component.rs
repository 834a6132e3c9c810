//! A model file in a folder of its own, as an importer unpacks it, and what its XML would say.

use std::ffi::CString;
use std::fs;
use std::path::Path;

use anyhow::{Context, Result, anyhow};
use stickslip::cosim::{CoSimulationModel, VariableTable, open};
use tempfile::TempDir;

/// Text of the reduced rig's model file.
pub const REDUCED_RIG: &str = include_str!("../../../modelDescription/reduced-rig.toml");
/// Text of the full rig's model file.
pub const FULL_RIG: &str = include_str!("../../../modelDescription/full-rig.toml");

/// An unpacked component.
pub struct Component {
    text: &'static str,
    folder: TempDir,
    /// Its GUID or instantiation token.
    pub token: CString,
    /// Its variables.
    pub table: VariableTable,
}

impl Component {
    /// Puts the model file into a new folder.
    ///
    /// # Errors
    /// The text describes no model, or the folder cannot be made.
    pub fn new(text: &'static str) -> Result<Self> {
        let folder = TempDir::with_prefix("under fire ").context("cannot make a folder")?;
        fs::write(folder.path().join("model.toml"), text).context("cannot write model.toml")?;
        let model = open(text, "model.toml")?;
        Ok(Self {
            text,
            token: CString::new(model.token().to_string())?,
            table: (**model.table()).clone(),
            folder,
        })
    }

    /// A native model of it, to compare with.
    ///
    /// # Errors
    /// None, after [`new`](Self::new) has read the same text.
    pub fn native(&self) -> Result<Box<dyn CoSimulationModel>> {
        Ok(open(self.text, "model.toml")?)
    }

    /// The resource folder as a path.
    #[must_use]
    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    /// The resource folder as FMI 2 wants it.
    ///
    /// # Errors
    /// The path has a zero byte or is not UTF-8.
    pub fn uri(&self) -> Result<CString> {
        Ok(CString::new(format!(
            "file://{}",
            self.path()?.replace(' ', "%20")
        ))?)
    }

    /// The resource folder as FMI 3 wants it.
    ///
    /// # Errors
    /// The path has a zero byte or is not UTF-8.
    pub fn native_path(&self) -> Result<CString> {
        Ok(CString::new(self.path()?)?)
    }

    fn path(&self) -> Result<&str> {
        self.folder
            .path()
            .to_str()
            .ok_or_else(|| anyhow!("{} is not UTF-8", self.folder.path().display()))
    }

    /// Value reference of the variable `name`.
    ///
    /// # Errors
    /// There is none.
    pub fn reference(&self, name: &str) -> Result<u32> {
        let variable = self.table.find(name);
        Ok(variable
            .ok_or_else(|| anyhow!("no variable {name}"))?
            .value_reference)
    }
}
