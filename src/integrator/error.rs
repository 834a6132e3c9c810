//! What can end an integration.

use thiserror::Error;

/// Why a run could not go on.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum IntegrationError {
    /// The mode changed again and again within no time.
    #[error(
        "chattering at t = {time} s in mode {mode}: {switches} switches within {span} s; \
         a law with stiction or a larger velocity tolerance would separate them"
    )]
    Chattering {
        /// Time [s].
        time: f64,
        /// The mode.
        mode: String,
        /// Number of switches.
        switches: u32,
        /// Time they took [s].
        span: f64,
    },
    /// The step fell below what the time can resolve.
    #[error(
        "the step fell to {step} s at t = {time} s in mode {mode}; \
         a time constant is too short for the time reached or a parameter is extreme: check inertias, inductance and stiffness"
    )]
    StepTooSmall {
        /// Time [s].
        time: f64,
        /// Step [s].
        step: f64,
        /// The mode.
        mode: String,
    },
    /// The budget of segments for one call is used up.
    #[error(
        "{segments} segments did not reach t = {target} s (now at {time} s, mode {mode}); \
         the system is too stiff for the budget: raise it, loosen the tolerance or check the parameters"
    )]
    BudgetExhausted {
        /// Segments spent.
        segments: u64,
        /// Time asked for [s].
        target: f64,
        /// Time reached [s].
        time: f64,
        /// The mode.
        mode: String,
    },
    /// The motion grew beyond every number.
    #[error(
        "the state is no longer finite at t = {time} s in mode {mode}; \
         a starting value, input or parameter is not a number or lets the motion grow without bound: check them"
    )]
    NotFinite {
        /// Time [s].
        time: f64,
        /// The mode.
        mode: String,
    },
    /// The order asked for cannot be carried.
    #[error("order {order} of the Taylor polynomials is outside {lowest} to {highest}")]
    OrderOutOfRange {
        /// Order asked for.
        order: usize,
        /// Lowest order possible.
        lowest: usize,
        /// Highest order possible.
        highest: usize,
    },
    /// A time before the current segment was asked for.
    #[error("t = {time} s lies before the present segment, which starts at {start} s")]
    BackInTime {
        /// Time asked for [s].
        time: f64,
        /// Start of the segment [s].
        start: f64,
    },
}
