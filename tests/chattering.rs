//! A system that its modes push against each other: the integrator must not switch for ever.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use stickslip::integrator::{Guard, HybridSystem, IntegrationError, Options, Simulation};
use stickslip::series::{Series, TERMS, evaluate};

/// dx/dt = −1 above zero and +1 below, with no mode for staying at zero.
#[derive(Clone, Copy, Debug)]
struct Opposed;

#[derive(Clone, Copy, Debug, PartialEq)]
enum Side {
    Above,
    Below,
}

impl Side {
    fn sign(self) -> f64 {
        match self {
            Self::Above => 1.0,
            Self::Below => -1.0,
        }
    }
}

#[derive(Clone, Debug)]
struct Jet {
    states: [Series<f64>; 1],
    guards: [Guard<()>; 1],
}

impl HybridSystem<f64> for Opposed {
    type Mode = Side;
    type GuardKind = ();
    type State = [f64; 1];
    type Inputs = ();
    type Jet = Jet;

    fn new_jet(&self) -> Jet {
        let series = [0.0; TERMS];
        Jet {
            states: [series],
            guards: [Guard { kind: (), series }],
        }
    }

    fn expand(&self, mode: &Side, _: f64, state: &[f64; 1], (): &(), _: usize, jet: &mut Jet) {
        (jet.states[0][0], jet.states[0][1]) = (state[0], -mode.sign());
        jet.guards[0].series = jet.states[0].map(|c| mode.sign() * c);
    }

    fn states<'a>(&self, jet: &'a Jet) -> &'a [Series<f64>] {
        &jet.states
    }

    fn guards<'a>(&self, jet: &'a Jet) -> &'a [Guard<()>] {
        &jet.guards
    }

    fn guard_at(
        &self,
        _: &Side,
        (): (),
        jet: &Jet,
        tau: f64,
        _: f64,
        _: &[f64; 1],
        (): &(),
        _: &mut Jet,
    ) -> f64 {
        evaluate(&jet.guards[0].series, tau)
    }

    fn is_coordinate(&self, _: usize) -> bool {
        true
    }

    fn carry(&self, mode: &Side, _: &Jet, _: f64) -> Side {
        *mode
    }

    fn initial_mode(&self, _: f64, state: &mut [f64; 1], (): &(), _: &mut Jet) -> Side {
        if state[0] < 0.0 {
            Side::Below
        } else {
            Side::Above
        }
    }

    fn switch(&self, mode: &Side, (): (), _: f64, _: &mut [f64; 1], (): &(), _: &mut Jet) -> Side {
        match mode {
            Side::Above => Side::Below,
            Side::Below => Side::Above,
        }
    }

    fn describe(&self, mode: &Side) -> String {
        format!("{mode:?}").to_lowercase()
    }
}

#[test]
fn chattering_ends_with_time_mode_and_remedy() {
    let options = Options::default();
    let mut run = Simulation::new(Opposed, options, 0.0, [0.5], ()).unwrap();
    let error = run.advance_to(2.0).unwrap_err();
    let IntegrationError::Chattering { time, switches, .. } = &error else {
        unreachable!("{error:?}");
    };
    assert!((time - 0.5).abs() < 1e-12 && *switches > 100);
    let text = error.to_string();
    println!("{text}");
    assert!(
        text.contains(&format!("t = {time} s"))
            && (text.contains("above") || text.contains("below")),
        "{text}"
    );
}
