//! Pieces of a run and what ends them.

use super::Statistics;

/// Why a segment ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum End<K> {
    /// The polynomial is used up.
    Step,
    /// A guard is lost.
    Switch(K),
    /// A branch of the right-hand side ends.
    Fold,
}

/// One polynomial piece of the motion.
#[derive(Clone, Debug)]
pub struct Segment<S, J> {
    /// Start [s]; carries derivatives if the switch before it does.
    pub start: S,
    /// Length [s].
    pub length: S,
    /// Its series.
    pub jet: J,
}

/// A switch that happened or is about to happen at the end of the present segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SwitchEvent<K> {
    /// When [s].
    pub time: f64,
    /// Which guard is lost; `None` for a jump between branches.
    pub guard: Option<K>,
}

/// Everything that a run needs to go on, as values.
#[derive(Clone, Debug)]
pub struct Snapshot<S, M, X, U> {
    /// Start of the present segment [s].
    pub start: S,
    /// State at the start of the segment.
    pub state: X,
    /// Mode in the segment.
    pub mode: M,
    /// Inputs in force.
    pub inputs: U,
    /// Whether the segment begins right behind a switch.
    pub departing: bool,
    /// Counters.
    pub statistics: Statistics,
}
