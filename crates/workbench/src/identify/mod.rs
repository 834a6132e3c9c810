//! Reading physical parameters off measurements: static tests, free decays, spectra, phase planes, friction torques.

pub mod command;
pub mod decay;
pub mod ellipse;
pub mod inverse_dynamics;
pub mod line;
pub mod local_polynomial;
pub mod static_test;
pub mod two_gaussian_fit;
