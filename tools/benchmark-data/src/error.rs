//! What can go wrong while making records.

use std::path::PathBuf;

/// Errors of the maker. Every message says what would be right.
#[derive(Debug, thiserror::Error)]
pub enum MakerError {
    /// A file or directory could not be read, written or renamed.
    #[error("{path}: {source}")]
    File {
        /// The file or directory.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The output directory already holds something.
    #[error("{0} is not empty; give a new directory so that no sealed case is mixed with another")]
    OutputNotEmpty(PathBuf),
    /// The seeds asked for belong to a suite.
    #[error(
        "seeds {first} to {last} touch the seeds 10000 to 29999 that are kept for the suites \
         `calibration` and `final`; choose seeds below or above"
    )]
    ReservedSeeds {
        /// First seed asked for.
        first: u64,
        /// Last seed asked for.
        last: u64,
    },
    /// The FMU could not be made.
    #[error("the FMU of the axes cannot be made: {0}")]
    Fmu(String),
    /// A number is outside what the maker can do.
    #[error("{name} = {value}: must be {expected}")]
    OutOfRange {
        /// What the number is.
        name: &'static str,
        /// The number given.
        value: f64,
        /// The allowed range in words.
        expected: &'static str,
    },
    /// The practice records or their answers cannot be understood.
    #[error("{path}: {problem}")]
    Practice {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        problem: String,
    },
    /// No kind has the name asked for.
    #[error("no kind `{0}` here; names are those of `kind` in ANSWERS.json")]
    NoKind(String),
    /// No drawn rig stuck at some points and slid at others.
    #[error("case {case}: no rig of this seed sticks and slips; take another seed")]
    NoStickSlip {
        /// Name of the case.
        case: String,
    },
    /// The simulated state stopped being finite.
    #[error("case {case}: the simulation left the finite numbers at t = {time} s")]
    Diverged {
        /// Name of the case.
        case: String,
        /// Time of the first non-finite sample [s].
        time: f64,
    },
    /// An answer cannot be written as JSON.
    #[error("cannot write the answers: {0}")]
    Json(#[from] serde_json::Error),
}

impl MakerError {
    /// The same with the name of the case where it was missing.
    pub(crate) fn in_case(self, name: &str) -> Self {
        match self {
            Self::Diverged { time, .. } => Self::Diverged {
                case: name.to_owned(),
                time,
            },
            other => other,
        }
    }
}

/// Attaches a path to an I/O error.
pub fn at(path: impl Into<PathBuf>) -> impl FnOnce(std::io::Error) -> MakerError {
    let path = path.into();
    move |source| MakerError::File { path, source }
}
