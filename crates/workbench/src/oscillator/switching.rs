//! How an oscillator's contact changes its mode.

use stickslip::friction::{ContactMode, Direction, Law, Regime};
use stickslip::integrator::{Guard, HybridSystem};
use stickslip::series::{Series, evaluate};

use super::system::{BODIES, Oscillator, OscillatorGuard, OscillatorJet, OscillatorState};

impl Oscillator {
    fn first_regime(&self) -> Regime {
        if matches!(self.law(), Law::Wojewoda(_)) {
            Regime::SpeedingUp
        } else {
            Regime::Free
        }
    }

    fn break_away(&self, direction: Direction) -> ContactMode {
        if self.law().band().0 > 0.0 {
            ContactMode::Breaking(direction)
        } else {
            ContactMode::Slipping(direction, self.first_regime())
        }
    }

    fn mode_at_rest(
        &self,
        time: f64,
        state: &OscillatorState,
        jet: &mut OscillatorJet,
    ) -> ContactMode {
        self.expand_motion(ContactMode::Stuck, time, state, 0, jet);
        let friction = jet.friction[0];
        if friction.abs() <= self.law().breakaway() {
            ContactMode::Stuck
        } else {
            self.break_away(Direction::of(friction))
        }
    }

    /// Mode after the slip acceleration has reached zero: the branch on which the forces can drive it on, or constant
    /// speed if neither can.
    fn turn(
        &self,
        mode: ContactMode,
        time: f64,
        state: &OscillatorState,
        jet: &mut OscillatorJet,
    ) -> ContactMode {
        let ContactMode::Slipping(direction, regime) = mode else {
            return mode;
        };
        let holding = ContactMode::Slipping(direction, Regime::Holding);
        self.expand_motion(holding, time, state, 0, jet);
        let reaction = jet.slip.torque[0];
        let (speeds_up, slows_down) = (
            reaction > jet.slip.level[0],
            reaction < jet.slip.lower_level[0],
        );
        match (regime == Regime::SpeedingUp, speeds_up, slows_down) {
            (true, _, true) => ContactMode::Slipping(direction, Regime::SlowingDown),
            (false, true, _) => ContactMode::Slipping(direction, Regime::SpeedingUp),
            _ => holding,
        }
    }
}

impl HybridSystem<f64> for Oscillator {
    type Mode = ContactMode;
    type GuardKind = OscillatorGuard;
    type State = OscillatorState;
    type Inputs = ();
    type Jet = OscillatorJet;

    fn new_jet(&self) -> OscillatorJet {
        self.empty_jet()
    }

    fn expand(
        &self,
        mode: &ContactMode,
        time: f64,
        state: &OscillatorState,
        _inputs: &(),
        order: usize,
        jet: &mut OscillatorJet,
    ) {
        self.expand_motion(*mode, time, state, order, jet);
    }

    fn states<'a>(&self, jet: &'a OscillatorJet) -> &'a [Series<f64>] {
        &jet.states
    }

    fn guards<'a>(&self, jet: &'a OscillatorJet) -> &'a [Guard<OscillatorGuard>] {
        &jet.guards
    }

    fn guard_at(
        &self,
        _mode: &ContactMode,
        guard: OscillatorGuard,
        jet: &OscillatorJet,
        tau: f64,
        _time: f64,
        _state: &OscillatorState,
        _inputs: &(),
        _spare: &mut OscillatorJet,
    ) -> f64 {
        let watched = jet.guards.iter().find(|watched| watched.kind == guard);
        watched.map_or(0.0, |watched| evaluate(&watched.series, tau))
    }

    fn is_coordinate(&self, index: usize) -> bool {
        !(BODIES..2 * BODIES).contains(&index)
    }

    fn carry(&self, mode: &ContactMode, _jet: &OscillatorJet, _tau: f64) -> ContactMode {
        *mode
    }

    fn initial_mode(
        &self,
        time: f64,
        state: &mut OscillatorState,
        _inputs: &(),
        jet: &mut OscillatorJet,
    ) -> ContactMode {
        let slip_velocity = state[BODIES] - self.surface.coefficient(0, time);
        if slip_velocity.abs() <= self.law().band().0 {
            return self.mode_at_rest(time, state, jet);
        }
        let mode = ContactMode::Slipping(Direction::of(slip_velocity), self.first_regime());
        if self.law().has_branches() {
            self.turn(mode, time, state, jet)
        } else {
            mode
        }
    }

    fn switch(
        &self,
        mode: &ContactMode,
        guard: OscillatorGuard,
        time: f64,
        state: &mut OscillatorState,
        _inputs: &(),
        jet: &mut OscillatorJet,
    ) -> ContactMode {
        match guard {
            OscillatorGuard::Rest => {
                if let ContactMode::Slipping(direction, _) = mode {
                    let band = self.law().band().0 * direction.sign();
                    state[BODIES] = self.surface.coefficient(0, time) + band;
                }
                self.mode_at_rest(time, state, jet)
            }
            OscillatorGuard::Breakaway(direction) => self.break_away(direction),
            OscillatorGuard::LeaveBand(direction) => {
                ContactMode::Slipping(direction, self.first_regime())
            }
            OscillatorGuard::Calm => ContactMode::Stuck,
            OscillatorGuard::Turn => self.turn(*mode, time, state, jet),
            OscillatorGuard::Release(sense) => match mode {
                ContactMode::Slipping(direction, _) => {
                    let regime = match sense {
                        Direction::Forward => Regime::SpeedingUp,
                        Direction::Backward => Regime::SlowingDown,
                    };
                    ContactMode::Slipping(*direction, regime)
                }
                _ => *mode,
            },
        }
    }

    fn describe(&self, mode: &ContactMode) -> String {
        match mode {
            ContactMode::Stuck => "stuck",
            ContactMode::Breaking(_) => "breaking away",
            ContactMode::Slipping(Direction::Forward, _) => "slipping forward",
            ContactMode::Slipping(Direction::Backward, _) => "slipping backward",
        }
        .to_owned()
    }
}
