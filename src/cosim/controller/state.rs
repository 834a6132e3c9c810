//! A controller's saved state.

use crate::controller::{INPUTS, Mode, Side, Start};
use crate::cosim::{StateError, StateReader, StateWriter};

/// All modes; a state stores the place in this list.
const MODES: [Mode; 7] = [
    Mode::Within,
    Mode::Holding(Side::Lower),
    Mode::Holding(Side::Upper),
    Mode::Riding(Side::Lower),
    Mode::Riding(Side::Upper),
    Mode::Unwinding(Side::Lower),
    Mode::Unwinding(Side::Upper),
];

/// Writes where the present stretch of a course began.
pub(super) fn write_start(start: &Start, state: &mut StateWriter) {
    state.real(start.time);
    state.real(start.integral);
    state.real(start.filtered_torque);
    start.inputs.iter().flatten().for_each(|c| state.real(*c));
    let place = MODES.iter().position(|mode| start.mode == Some(*mode));
    state.integer(place.map_or(u64::MAX, |place| place as u64));
}

/// The opposite of [`write_start`].
pub(super) fn read_start(state: &mut StateReader<'_>) -> Result<Start, StateError> {
    let (time, integral, filtered_torque) = (state.real()?, state.real()?, state.real()?);
    let mut inputs = [[0.0; 4]; INPUTS];
    for coefficient in inputs.iter_mut().flatten() {
        *coefficient = state.real()?;
    }
    let place = state.integer()?;
    let mode = usize::try_from(place).ok().and_then(|p| MODES.get(p));
    let mode = mode.ok_or_else(|| StateError::Content(format!("there is no mode {place}")))?;
    Ok(Start {
        time,
        integral,
        filtered_torque,
        inputs,
        mode: Some(*mode),
    })
}
