//! Reference results inside an FMU, so that whoever imports it can check the import without tools of ours: an experiment with its
//! stimuli and results, as the layered standard FMI-LS-REF has it.
//!
//! [`write`](mod@write) makes them with the native model, [`read`] finds them in FMUs of any origin, [`repeat`] runs the
//! experiment and compares.

mod address;
pub mod read;
pub mod repeat;
pub mod table;
pub mod trial;
pub mod write;

/// Name of the layered standard.
pub const NAME: &str = "org.fmi-standard.fmi-ls-ref";
/// The version that is written; others are read.
pub const VERSION: &str = "1.0.0-beta.1";
/// Folder of its files inside an FMU.
pub const FOLDER: &str = "extra/org.fmi-standard.fmi-ls-ref";
/// File in the folder of any layered standard that says which one it is.
pub const MANIFEST: &str = "fmi-ls-manifest.xml";
/// Namespace of the attributes of a manifest.
pub const NAMESPACE: &str = "http://fmi-standard.org/fmi-ls-manifest";
/// What a manifest must say of the standard.
pub const DESCRIPTION: &str =
    "Layered Standard providing information on related files included in an FMU.";
/// Type of files in the Experiments Format of the Modelica Association (ma-hs-experiments).
pub const EXPERIMENTS: &str = "application/x-ma-hs-experiments";
/// Type of tables as text.
pub const CSV: &str = "text/csv";
/// Type of parameter sets (SSV).
pub const PARAMETERS: &str = "application/x-ssp-parameter-set";

/// Name of the manifest of FMI-LS-REF inside an FMU.
#[must_use]
pub fn manifest_file() -> String {
    format!("{FOLDER}/{MANIFEST}")
}
