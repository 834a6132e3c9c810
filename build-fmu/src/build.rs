//! From a `model.toml` and a library to FMUs on disk.

use std::fmt;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use stickslip::cosim::{self, CoSimulationModel, MODEL_FILE, ModelError};
use thiserror::Error;

use crate::archive::{ArchiveError, write_atomically};
use crate::binary_check::{self, Expectation};
use crate::binary_error::BinaryError;
use crate::contents::{ContentsError, contents};
use crate::library::Library;
use crate::model_description::{
    DateError, Facts, SOURCE_DATE_EPOCH, XmlError, generation_date, model_description,
};
use crate::platform::{FmiVersion, Platform};
use crate::reference::write::{self, Files, WriteError};

/// Why an FMU could not be built.
#[derive(Debug, Error)]
pub enum BuildError {
    /// The model file could not be read.
    #[error("model file {} could not be read: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// The model file is no text: an FMU, say.
    #[error("{}: is not a text file; a model file (.toml) is needed", path.display())]
    NotText {
        /// The file.
        path: PathBuf,
    },
    /// The model file does not describe a model; the reason names file, key and value.
    #[error("{0}")]
    Model(#[from] ModelError),
    /// The model file is not TOML.
    #[error("{file_name}: {source}")]
    Toml {
        /// The file as the user named it.
        file_name: String,
        /// Place and reason.
        source: Box<toml::de::Error>,
    },
    /// The date that is asked for is none.
    #[error(transparent)]
    Date(#[from] DateError),
    /// The library must not be packed.
    #[error(transparent)]
    Binary(#[from] BinaryError),
    /// The reference run that was asked for cannot be made.
    #[error(transparent)]
    Reference(#[from] WriteError),
    /// The content could not be made.
    #[error(transparent)]
    Contents(#[from] ContentsError),
    /// The XML could not be written.
    #[error(transparent)]
    Xml(#[from] XmlError),
    /// The FMU could not be written.
    #[error(transparent)]
    Archive(#[from] ArchiveError),
}

/// A model that is ready to be packed.
pub struct Source {
    text: String,
    parsed: toml::Table,
    model: Box<dyn CoSimulationModel>,
    token: String,
    generated: Option<String>,
    reference: Reference,
}

/// What is packed for checking an import.
#[derive(Debug, Clone, PartialEq)]
pub enum Reference {
    /// A run with held inputs and its results; the values of some inputs, by name.
    Run(Vec<(String, f64)>),
    /// Nothing.
    LeftOut,
}

/// An FMU that was written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Built {
    /// The file.
    pub path: PathBuf,
    /// Its size [bytes].
    pub size: usize,
    /// The version of the standard that it follows.
    pub version: FmiVersion,
    /// The platforms that it has a library for.
    pub platforms: Vec<Platform>,
    /// Why there are no reference results in it, where none could be had.
    pub without_reference: Option<String>,
}

/// File, size and platforms, for people.
impl fmt::Display for Built {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let platforms: Vec<_> = self
            .platforms
            .iter()
            .map(|platform| platform.name())
            .collect();
        let (path, size) = (self.path.display(), self.size.div_ceil(1024));
        write!(f, "{path} ({size} KiB; {})", platforms.join(", "))
    }
}

impl Source {
    /// Reads a model file.
    ///
    /// # Errors
    /// [`BuildError::Read`], [`BuildError::NotText`], or as [`Source::from_text`].
    pub fn read(path: &Path) -> Result<Self, BuildError> {
        let text = fs::read_to_string(path).map_err(|source| {
            let path = path.to_owned();
            match source.kind() {
                ErrorKind::InvalidData => BuildError::NotText { path },
                _ => BuildError::Read { path, source },
            }
        })?;
        Self::from_text(text, &path.display().to_string())
    }

    /// The model that `text` describes; `file_name` is for messages.
    ///
    /// # Errors
    /// [`BuildError::Model`] or [`BuildError::Toml`] with the place in the file.
    pub fn from_text(text: String, file_name: &str) -> Result<Self, BuildError> {
        let model = cosim::open(&text, file_name)?;
        let parsed = text.parse().map_err(|source| BuildError::Toml {
            file_name: file_name.to_owned(),
            source: Box::new(source),
        })?;
        let token = model.token().to_string();
        let epoch = std::env::var_os(SOURCE_DATE_EPOCH);
        let epoch = epoch.map(|text| text.to_string_lossy().into_owned());
        let generated = generation_date(epoch.as_deref())?;
        Ok(Self {
            text,
            parsed,
            model,
            token,
            generated,
            reference: Reference::Run(Vec::new()),
        })
    }

    /// Chooses the reference run inside the FMUs; without a choice all inputs hold values by rule.
    pub fn set_reference(&mut self, reference: Reference) {
        self.reference = reference;
    }

    /// What the XML is written from.
    pub fn facts(&self) -> Facts<'_> {
        Facts {
            identity: self.model.identity(),
            token: &self.token,
            table: self.model.table(),
            generated: self.generated.as_deref(),
        }
    }

    /// `modelDescription.xml` for one version of the standard.
    ///
    /// # Errors
    /// [`BuildError::Xml`] if the XML writer fails.
    pub fn model_description(&self, version: FmiVersion) -> Result<String, BuildError> {
        Ok(model_description(&self.facts(), version)?)
    }

    /// File name of the FMU: `ReducedRig.fmi2.fmu`.
    pub fn fmu_file_name(&self, version: FmiVersion) -> String {
        format!(
            "{}.{}.fmu",
            self.model.identity().model_identifier,
            version.tag()
        )
    }

    /// File name of the kept copy of the model description: `ReducedRig.fmi2.xml`.
    pub fn xml_file_name(&self, version: FmiVersion) -> String {
        format!(
            "{}.{}.xml",
            self.model.identity().model_identifier,
            version.tag()
        )
    }

    /// The bytes of the FMU with a binary for each library; that for this machine is loaded and checked first, of the
    /// others the headers.
    ///
    /// # Errors
    /// [`BuildError::Binary`] if the library fails its check, [`BuildError::Contents`] or
    /// [`BuildError::Archive`] if the archive cannot be made.
    pub fn to_bytes(
        &self,
        libraries: &[Library],
        version: FmiVersion,
    ) -> Result<Vec<u8>, BuildError> {
        Ok(self.pack(libraries, version)?.0)
    }

    /// The bytes of the FMU, and why it has no reference results where none could be had.
    fn pack(
        &self,
        libraries: &[Library],
        version: FmiVersion,
    ) -> Result<(Vec<u8>, Option<String>), BuildError> {
        let facts = self.facts();
        let resources = [(MODEL_FILE.to_owned(), self.text.clone().into_bytes())];
        let expectation = Expectation {
            model_identifier: facts.identity.model_identifier,
            token: facts.token,
            resources: &resources,
        };
        for library in libraries {
            if Platform::current() == Some(library.platform) {
                binary_check::check(library, version, &expectation)?;
            } else {
                binary_check::check_headers(library, version)?;
            }
        }
        let (references, without) = self.references()?;
        let files = contents(
            &facts,
            version,
            libraries,
            &self.text,
            &self.parsed,
            &references,
        )?;
        Ok((files.to_bytes()?, without))
    }

    /// Files of the reference run, or why there is none. A model that fails under inputs that nobody chose may be sound.
    fn references(&self) -> Result<(Files, Option<String>), BuildError> {
        let Reference::Run(held) = &self.reference else {
            return Ok((Vec::new(), None));
        };
        match write::files(&self.facts(), &self.text, held) {
            Ok(files) => Ok((files, None)),
            Err(error) if held.is_empty() => Ok((Vec::new(), Some(error.to_string()))),
            Err(error) => Err(error.into()),
        }
    }

    /// Checks the libraries, packs the FMU and writes it into `folder`, whole or not at all.
    ///
    /// # Errors
    /// As [`Source::to_bytes`], and [`BuildError::Archive`] if the file cannot be written.
    pub fn build(
        &self,
        libraries: &[Library],
        version: FmiVersion,
        folder: &Path,
    ) -> Result<Built, BuildError> {
        let (bytes, without_reference) = self.pack(libraries, version)?;
        let path = folder.join(self.fmu_file_name(version));
        write_atomically(&path, &bytes)?;
        Ok(Built {
            path,
            size: bytes.len(),
            version,
            platforms: libraries.iter().map(|library| library.platform).collect(),
            without_reference,
        })
    }
}
