//! A model file in a folder of its own, as an importer unpacks it, and what its XML would say.

use std::ffi::CString;
use std::fs;

use anyhow::{Context, Result, anyhow};
use stickslip::cosim::{CoSimulationModel, VariableTable, open};
use tempfile::TempDir;

use crate::standard::Version;

/// Text of the reduced rig's model file.
pub const REDUCED_RIG: &str = include_str!("../../../modelDescription/reduced-rig.toml");
/// Text of the full rig's model file.
pub const FULL_RIG: &str = include_str!("../../../modelDescription/full-rig.toml");

/// An unpacked component.
pub struct Component {
    text: String,
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
    pub fn new(text: &str) -> Result<Self> {
        let folder = TempDir::with_prefix("under fire ").context("cannot make a folder")?;
        fs::write(folder.path().join("model.toml"), text).context("cannot write model.toml")?;
        let model = open(text, "model.toml")?;
        Ok(Self {
            text: text.to_owned(),
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
        Ok(open(&self.text, "model.toml")?)
    }

    /// The resource folder as the version wants it: a URI or a path.
    ///
    /// # Errors
    /// The path has a zero byte or is not UTF-8.
    pub fn resources(&self, version: Version) -> Result<CString> {
        let folder = self.folder.path();
        let path = folder.to_str();
        let path = path.ok_or_else(|| anyhow!("{} is not UTF-8", folder.display()))?;
        Ok(CString::new(match version {
            Version::Two => format!("file://{}", path.replace(' ', "%20")),
            Version::Three => path.to_owned(),
        })?)
    }

    /// Value references of variables by their names.
    ///
    /// # Errors
    /// There is no variable of one of the names.
    pub fn references<const N: usize>(&self, names: [&str; N]) -> Result<[u32; N]> {
        let mut references = [0; N];
        for (reference, name) in references.iter_mut().zip(names) {
            let variable = self.table.find(name);
            *reference = variable
                .ok_or_else(|| anyhow!("no variable {name}"))?
                .value_reference;
        }
        Ok(references)
    }
}
