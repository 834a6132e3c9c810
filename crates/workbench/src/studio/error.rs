//! What the studio answers where it cannot do what it is asked for.

use std::path::PathBuf;

use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use thiserror::Error;

use super::guard::Refusal;

/// Why something is not done.
#[derive(Debug, Error)]
pub enum StudioError {
    /// Not this page, or not in this way.
    #[error(transparent)]
    Refused(#[from] Refusal),
    /// There is no such thing.
    #[error("{0}: there is no such thing here")]
    Unknown(String),
    /// Something else must end first.
    #[error("{0}")]
    Busy(&'static str),
    /// The studio's folder is not there any more.
    #[error(
        "{path}: the studio's folder is gone. What was chosen is still on this page: put the folder back, or press \
         \u{201c}Make it anew\u{201d}"
    )]
    Gone {
        /// The folder.
        path: PathBuf,
    },
    /// The input is wrong.
    #[error("{0}")]
    Input(String),
}

impl From<anyhow::Error> for StudioError {
    fn from(error: anyhow::Error) -> Self {
        Self::Input(build_fmu::explain::explain(error.as_ref()))
    }
}

impl StudioError {
    /// Of an error with its causes.
    pub fn of(error: impl std::error::Error + Send + Sync + 'static) -> Self {
        anyhow::Error::new(error).into()
    }

    fn status(&self) -> StatusCode {
        match self {
            Self::Refused(refusal) => refusal.status(),
            Self::Unknown(_) => StatusCode::NOT_FOUND,
            Self::Busy(_) => StatusCode::CONFLICT,
            Self::Gone { .. } => StatusCode::GONE,
            Self::Input(_) => StatusCode::UNPROCESSABLE_ENTITY,
        }
    }
}

impl IntoResponse for StudioError {
    fn into_response(self) -> Response {
        (self.status(), self.to_string()).into_response()
    }
}
