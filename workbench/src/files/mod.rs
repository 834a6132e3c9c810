//! Files: records (CSV) and writing whole or not at all.

pub mod atomic;
pub mod record;
