//! The snapshot of a body's run as bytes.

use crate::body::{Inputs, Mode, Motion};
use crate::cosim::input_signals::InputSignals;
use crate::cosim::{StateError, StateReader, StateWriter};
use crate::expression::SITES;
use crate::friction::Direction;
use crate::integrator::{Snapshot, Statistics};

pub(super) type BodySnapshot = Snapshot<f64, Mode, [f64; 2], Inputs>;

/// All that a body can do; a state stores the place in this list.
const MOTIONS: [Motion; 3] = [
    Motion::Sticks,
    Motion::Slides(Direction::Forward),
    Motion::Slides(Direction::Backward),
];

/// Writes the snapshot of a run.
pub(super) fn write_snapshot(snapshot: &BodySnapshot, state: &mut StateWriter) {
    state.real(snapshot.start);
    snapshot.state.iter().for_each(|value| state.real(*value));
    let Mode { motion, branches } = &snapshot.mode;
    let place = MOTIONS.iter().position(|known| known == motion);
    state.integer(place.map_or(u64::MAX, |place| place as u64));
    for branch in branches.iter().flatten() {
        // Two's complement keeps the sign.
        state.integer(u64::from(branch.cast_unsigned()));
    }
    InputSignals::new(snapshot.inputs.time, snapshot.inputs.polynomials).save(state);
    state.flag(snapshot.departing);
}

/// The snapshot that was written.
pub(super) fn read_snapshot(state: &mut StateReader<'_>) -> Result<BodySnapshot, StateError> {
    let (start, values) = (state.real()?, [state.real()?, state.real()?]);
    let place = state.integer()?;
    let motion = usize::try_from(place)
        .ok()
        .and_then(|place| MOTIONS.get(place));
    let motion =
        *motion.ok_or_else(|| StateError::Content(format!("there is no motion {place}")))?;
    let mut branches = [[0; SITES]; 2];
    for branch in branches.iter_mut().flatten() {
        let bits = u32::try_from(state.integer()?);
        let bits = bits.map_err(|_| StateError::Content("a branch is out of range".to_owned()))?;
        *branch = bits.cast_signed();
    }
    let signals = InputSignals::restore(state)?;
    Ok(Snapshot {
        start,
        state: values,
        mode: Mode { motion, branches },
        inputs: Inputs {
            time: signals.centre,
            polynomials: signals.polynomials,
        },
        departing: state.flag()?,
        statistics: Statistics::default(),
    })
}
