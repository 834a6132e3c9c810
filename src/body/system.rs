//! A body as a hybrid system: it slides forward or backward, or sticks.

use super::Body;
use super::kinks::trusted;
use super::motion::{BodyJet, GuardKind, Inputs, Mode, Motion, side};
use crate::friction::Direction;
use crate::integrator::{Guard, HybridSystem};
use crate::series::Series;

/// Place of the velocity among the states.
const VELOCITY: usize = 1;

impl HybridSystem<f64> for Body<f64> {
    type Mode = Mode;
    type GuardKind = GuardKind;
    type State = [f64; 2];
    type Inputs = Inputs;
    type Jet = BodyJet<f64>;

    fn new_jet(&self) -> BodyJet<f64> {
        BodyJet::new(self)
    }

    fn expand(
        &self,
        mode: &Mode,
        time: f64,
        state: &[f64; 2],
        inputs: &Inputs,
        order: usize,
        jet: &mut BodyJet<f64>,
    ) {
        jet.begin(*state);
        jet.take(inputs, time);
        jet.guards.clear();
        jet.reach = f64::INFINITY;
        match mode.motion {
            Motion::Slides(direction) => {
                let branches = &mode.branches[side(direction)];
                self.slide(direction, time, branches, order, jet);
                let series = jet.states[VELOCITY].map(|c| direction.sign() * c);
                let kind = GuardKind::Turn;
                jet.guards.push(Guard { kind, series });
                self.watch(direction, branches, order, jet);
            }
            Motion::Sticks => {
                self.stick(time, &mode.branches, order, jet);
                for direction in [Direction::Forward, Direction::Backward] {
                    let (kind, series) = (
                        GuardKind::Breakaway(direction),
                        jet.margins[side(direction)],
                    );
                    // The states do not vary, whatever the force does.
                    jet.reach = jet.reach.min(trusted(&series));
                    jet.guards.push(Guard { kind, series });
                    self.watch(direction, &mode.branches[side(direction)], order, jet);
                }
            }
        }
    }

    fn states<'a>(&self, jet: &'a BodyJet<f64>) -> &'a [Series<f64>] {
        &jet.states
    }

    fn reach(&self, jet: &BodyJet<f64>) -> f64 {
        jet.reach
    }

    fn guards<'a>(&self, jet: &'a BodyJet<f64>) -> &'a [Guard<GuardKind>] {
        &jet.guards
    }

    fn guard_at(
        &self,
        _mode: &Mode,
        _guard: GuardKind,
        _jet: &BodyJet<f64>,
        _tau: f64,
        _time: f64,
        _state: &[f64; 2],
        _inputs: &Inputs,
        _spare: &mut BodyJet<f64>,
    ) -> f64 {
        // Only numbers with derivatives are asked.
        0.0
    }

    fn is_coordinate(&self, index: usize) -> bool {
        index != VELOCITY
    }

    fn carry(&self, mode: &Mode, _jet: &BodyJet<f64>, _tau: f64) -> Mode {
        *mode
    }

    fn initial_mode(
        &self,
        time: f64,
        state: &mut [f64; 2],
        inputs: &Inputs,
        jet: &mut BodyJet<f64>,
    ) -> Mode {
        jet.begin(*state);
        jet.take(inputs, time);
        if state[VELOCITY] == 0.0 {
            self.rest(time, jet)
        } else {
            self.sliding(Direction::of(state[VELOCITY]), time, jet)
        }
    }

    fn switch(
        &self,
        mode: &Mode,
        guard: GuardKind,
        time: f64,
        state: &mut [f64; 2],
        inputs: &Inputs,
        jet: &mut BodyJet<f64>,
    ) -> Mode {
        match guard {
            GuardKind::Turn => {
                state[VELOCITY] = 0.0;
                jet.begin(*state);
                jet.take(inputs, time);
                self.rest(time, jet)
            }
            GuardKind::Breakaway(direction) => {
                jet.begin(*state);
                jet.take(inputs, time);
                self.sliding(direction, time, jet)
            }
            GuardKind::Kink(direction, place, upwards) => {
                let mut mode = *mode;
                let branch = &mut mode.branches[side(direction)][place];
                *branch = self.next_branch(place, upwards, *branch);
                mode
            }
        }
    }

    fn describe(&self, mode: &Mode) -> String {
        match mode.motion {
            Motion::Slides(Direction::Forward) => "sliding forward",
            Motion::Slides(Direction::Backward) => "sliding backward",
            Motion::Sticks => "sticking",
        }
        .to_owned()
    }
}
