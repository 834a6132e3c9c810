//! The snapshot of a rig's run as bytes.

use super::input_signals::InputSignals;
use crate::cosim::{StateError, StateReader, StateWriter};
use crate::expression::SITES;
use crate::friction::{ContactMode, Direction, Regime};
use crate::integrator::{Snapshot, Statistics};
use crate::plant::{Coupling, RigInputs, RigMode, RigState, STATES};

type RigSnapshot = Snapshot<f64, RigMode, RigState<f64>, RigInputs<f64>>;

/// All modes of a contact; a state stores the place in this list.
const CONTACT_MODES: [ContactMode; 11] = {
    use ContactMode::{Breaking, Slipping, Stuck};
    use Direction::{Backward, Forward};
    use Regime::{Free, Holding, SlowingDown, SpeedingUp};
    [
        Stuck,
        Breaking(Forward),
        Breaking(Backward),
        Slipping(Forward, Free),
        Slipping(Forward, SpeedingUp),
        Slipping(Forward, SlowingDown),
        Slipping(Forward, Holding),
        Slipping(Backward, Free),
        Slipping(Backward, SpeedingUp),
        Slipping(Backward, SlowingDown),
        Slipping(Backward, Holding),
    ]
};

/// All modes of the coupling; a state stores the place in this list.
const COUPLINGS: [Coupling; 3] = [Coupling::Ahead, Coupling::Free, Coupling::Behind];

/// Writes the snapshot of a run.
pub(super) fn write_snapshot(snapshot: &RigSnapshot, state: &mut StateWriter) {
    state.real(snapshot.start);
    snapshot.state.iter().for_each(|value| state.real(*value));
    write_mode(&snapshot.mode, state);
    InputSignals::of(&snapshot.inputs).save(state);
    state.flag(snapshot.departing);
    let statistics = &snapshot.statistics;
    for count in [
        statistics.segments,
        statistics.discarded,
        statistics.switches,
        statistics.branch_jumps,
        statistics.grazing,
    ] {
        state.integer(count);
    }
}

/// Writes the modes of contacts and coupling.
pub(super) fn write_mode(mode: &RigMode, state: &mut StateWriter) {
    for contact in [mode.disc, mode.disc1, mode.motor] {
        state.integer(place_of(&CONTACT_MODES, contact));
    }
    state.integer(place_of(&COUPLINGS, mode.coupling));
    mode.near.iter().for_each(|value| state.real(*value));
    mode.folded.iter().for_each(|folded| state.flag(*folded));
    for branch in mode.branches {
        // Two's complement keeps the sign.
        state.integer(u64::from(branch.cast_unsigned()));
    }
}

/// The modes that were written.
pub(super) fn read_mode(state: &mut StateReader<'_>) -> Result<RigMode, StateError> {
    let mut contact = || element(&CONTACT_MODES, state.integer()?, "contact mode");
    let (disc, disc1, motor) = (contact()?, contact()?, contact()?);
    let coupling = element(&COUPLINGS, state.integer()?, "coupling mode")?;
    let near = [state.real()?, state.real()?];
    let folded = [state.flag()?, state.flag()?];
    let mut branches = [0; SITES];
    for branch in &mut branches {
        let bits = u32::try_from(state.integer()?);
        let bits = bits.map_err(|_| StateError::Content("a branch is out of range".to_owned()))?;
        *branch = bits.cast_signed();
    }
    Ok(RigMode {
        disc,
        disc1,
        motor,
        coupling,
        near,
        folded,
        branches,
    })
}

/// The snapshot that was written.
pub(super) fn read_snapshot(state: &mut StateReader<'_>) -> Result<RigSnapshot, StateError> {
    let start = state.real()?;
    let mut values = [0.0; STATES];
    for value in &mut values {
        *value = state.real()?;
    }
    let mode = read_mode(state)?;
    let signals = InputSignals::restore(state)?;
    Ok(Snapshot {
        start,
        state: values,
        mode,
        inputs: signals.uncentred(),
        departing: state.flag()?,
        statistics: Statistics {
            segments: state.integer()?,
            discarded: state.integer()?,
            switches: state.integer()?,
            branch_jumps: state.integer()?,
            grazing: state.integer()?,
        },
    })
}

fn place_of<T: PartialEq>(list: &[T], element: T) -> u64 {
    list.iter()
        .position(|other| *other == element)
        .map_or(u64::MAX, |place| place as u64)
}

fn element<T: Copy>(list: &[T], place: u64, what: &str) -> Result<T, StateError> {
    usize::try_from(place)
        .ok()
        .and_then(|place| list.get(place).copied())
        .ok_or_else(|| StateError::Content(format!("there is no {what} {place}")))
}
