//! What is read off a record: spectra, limit cycles and measures of agreement.

pub mod limit_cycle;
pub mod measures;
pub mod motion;
pub mod quantile;
pub mod spectrum;
