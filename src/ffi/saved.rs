//! Saved states of an instance, as importers hold them (`FMUState`).

use super::handles::Registry;
use crate::cosim::Token;

/// A copy of all that the future of an instance depends on.
#[derive(Debug)]
pub(super) struct SavedState {
    /// Component to which the content belongs.
    pub(super) token: Token,
    /// What [`Instance::save`](super::instance::Instance::save) wrote.
    pub(super) content: Vec<u8>,
}

/// All saved states of this process.
pub(super) static STATES: Registry<SavedState> = Registry::new(0b0110);
