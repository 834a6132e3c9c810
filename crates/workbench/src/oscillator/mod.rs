//! Dimensionless oscillators with one rubbing contact (Chapter 3): chains of up to three bodies of unit inertia, an anchor
//! that may move, a surface that may move, a force that may vary.

mod drive;
mod motion;
mod switching;
mod system;

pub use drive::Drive;
pub use motion::{Motion, Span};
pub use system::{BODIES, Oscillator, OscillatorError, OscillatorGuard, OscillatorState};
