//! What a solver's call costs through the C interface: states set, derivatives read, with and without the event indicators.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::panic,
    reason = "a benchmark may fail"
)]

#[path = "../importer/mod.rs"]
mod importer;

use importer::exchange::Vector;
use importer::{Component, FULL_RIG, Fmi2, Fmi3, REDUCED_RIG};
use std::hint::black_box;
use std::time::Instant;

/// Calls that are timed together.
const CALLS: u32 = 10_000;
/// Rounds, of which the fastest counts: the machine may have done other things in the rest.
const ROUNDS: usize = 20;

/// Name, model file and inputs.
type Case = (&'static str, &'static str, &'static [(&'static str, f64)]);

const CASES: [Case; 4] = [
    ("reduced rig", REDUCED_RIG, &[("u", 3.1), ("N2", 50.0)]),
    (
        "full rig",
        FULL_RIG,
        &[("u", 3.1), ("N1", 25.0), ("N2", 50.0)],
    ),
    (
        "speed controller",
        include_str!("../../modelDescription/speed-controller.toml"),
        &[("omega_ref", 6.0), ("theta3_dot", 5.5)],
    ),
    (
        "soft torque",
        include_str!("../../modelDescription/soft-torque.toml"),
        &[("omega_ref", 6.0), ("theta3_dot", 5.5), ("i", 1.0)],
    ),
];

fn main() {
    for (name, model, values) in CASES {
        let component = &Component::new(model);
        for (version, with_indicators) in [(Fmi2, false), (Fmi3, false), (Fmi3, true)] {
            let mut instance = component.instantiate_for_exchange(version);
            instance.initialize(0.0, values);
            instance.update_discrete_states();
            instance.enter_continuous_time();
            instance.integrate(1e-4, 0.7);
            let mut states = instance.vector(Vector::States);
            let mut derivatives = vec![0.0; states.len()];
            let mut indicators = vec![0.0; instance.indicator_count()];
            let mut fastest = f64::INFINITY;
            for _ in 0..ROUNDS {
                let begin = Instant::now();
                for call in 0..CALLS {
                    states[0] += 1e-9 * f64::from(call);
                    instance.set_states(&states);
                    instance.fill(Vector::Derivatives, &mut derivatives);
                    if with_indicators {
                        instance.fill(Vector::Indicators, &mut indicators);
                    }
                    black_box((&derivatives, &indicators));
                }
                fastest = fastest.min(begin.elapsed().as_secs_f64() / f64::from(CALLS));
            }
            let what = if with_indicators {
                " and indicators"
            } else {
                ""
            };
            println!(
                "{name}, {version:?}: {:.0} ns to set states and read derivatives{what}",
                1e9 * fastest
            );
        }
    }
}
