//! Counters of a run.

/// What a run has cost so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Statistics {
    /// Polynomial segments computed.
    pub segments: u64,
    /// Segments thrown away before their end because an input, a parameter or the state changed.
    pub discarded: u64,
    /// Mode changes.
    pub switches: u64,
    /// Jumps from one branch of a many-valued algebraic loop to another.
    pub branch_jumps: u64,
    /// Switches that the motion only grazed, where derivatives do not exist.
    pub grazing: u64,
}
