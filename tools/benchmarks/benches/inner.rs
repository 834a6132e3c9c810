//! Inner parts of the integrator, each alone: expansion of one segment per friction law, location of
//! an event, reading the dense output.

#![allow(
    clippy::expect_used,
    reason = "a benchmark that cannot start has nothing to report"
)]

#[path = "../src/laws.rs"]
mod laws;
#[path = "../src/systems.rs"]
#[allow(dead_code, reason = "the first system is enough here")]
mod systems;

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use laws::LAWS;
use stickslip::integrator::{HybridSystem, Options, Simulation};
use stickslip::plant::{Rig, RigInputs, STATES, sensitivities};
use stickslip::series::first_loss_of_sign;

/// Law of the parts that are timed under one law.
const LAW: &str = "stribeck";

type Run = Simulation<f64, Rig<f64>>;

/// A state in which disc and motor turn forward: angles [rad], speeds [rad/s], current [A].
const SLIPPING: [f64; STATES] = [0.0, 5.0, 1.3, 5.76, 1.4, 0.0, 0.0, 0.0, 0.0, 0.0];

fn start(law: &str, state: [f64; STATES]) -> Run {
    let [system, ..] = systems::all();
    let rig = Rig::from_toml(&system.model_with_law(law), law).expect("the model is valid");
    let inputs = RigInputs::held(system.voltage(), system.normal_force, 0.0);
    Simulation::new(rig, Options::default(), 0.0, state, inputs).expect("the run starts")
}

/// A run from rest, up to 10 s and then to the next segment that `wanted` accepts.
fn run_to(wanted: impl Fn(&Run) -> bool) -> Run {
    let mut run = start(LAW, [0.0; STATES]);
    run.advance_to(10.0).expect("the run goes on");
    while !wanted(&run) {
        run.next_segment().expect("the run goes on");
    }
    run
}

/// Whether the disc slips well away from zero throughout the segment.
fn slips(run: &Run) -> bool {
    run.component_at(stickslip::plant::index::OMEGA, run.segment_start()) > 1.0
        && run.pending_switch().is_none()
}

fn expansion(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("expand one segment");
    let order = Options::default().order;
    for (law, _) in LAWS {
        let run = start(law, SLIPPING);
        let (rig, mode, time) = (*run.system(), *run.mode(), run.segment_start());
        let (state, inputs) = (run.state_at(time), *run.inputs());
        let mut jet = rig.new_jet();
        group.bench_function(law, |bencher| {
            bencher.iter(|| {
                rig.expand(
                    black_box(&mode),
                    time,
                    black_box(&state),
                    &inputs,
                    order,
                    &mut jet,
                );
                black_box(&jet);
            });
        });
    }
    group.finish();
}

fn events(criterion: &mut Criterion) {
    let order = Options::default().order;
    let mut group = criterion.benchmark_group("first loss of sign");
    for (name, run) in [
        (
            "switch in the segment",
            run_to(|run| run.pending_switch().is_some()),
        ),
        ("no switch in the segment", run_to(slips)),
    ] {
        let width = Options::default()
            .longest_step
            .min(1.01 * (run.segment_end() - run.segment_start()));
        let guards: Vec<Vec<f64>> = run
            .system()
            .guards(run.jet())
            .iter()
            .map(|guard| guard.series[..=order].to_vec())
            .collect();
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                for series in &guards {
                    black_box(first_loss_of_sign(black_box(series), width));
                }
            });
        });
    }
    group.finish();
}

fn dense_output(criterion: &mut Criterion) {
    let run = run_to(slips);
    let middle = 0.5 * (run.segment_start() + run.segment_end());
    let mut group = criterion.benchmark_group("dense output");
    group.bench_function("whole state", |bencher| {
        bencher.iter(|| run.state_at(black_box(middle)))
    });
    group.bench_function("one component", |bencher| {
        bencher.iter(|| run.component_at(0, black_box(middle)))
    });
    group.finish();
}

/// One second of the reference run from the same state, alone and with eight derivatives.
fn derivatives(criterion: &mut Criterion) {
    let start = start(LAW, SLIPPING);
    let (rig, inputs) = (*start.system(), *start.inputs());
    let names = [
        "disc.inertia",
        "shaft.stiffness",
        "shaft.damping",
        "motor.resistance",
        "motor.torque_constant",
        "contact.mu_c",
        "contact.mu_s",
        "contact.omega_s",
    ];
    let mut group = criterion.benchmark_group("one second");
    group.bench_function("plain", |bencher| {
        bencher.iter(|| {
            let options = Options::default();
            let mut run = Simulation::new(rig, options, 0.0, black_box(SLIPPING), inputs)
                .expect("the run starts");
            run.advance_to(1.0).expect("the run goes on");
            run.state_at(1.0)
        });
    });
    group.bench_function("with eight derivatives", |bencher| {
        bencher.iter(|| {
            let state = black_box(SLIPPING);
            sensitivities(&rig, &names, Options::default(), &state, &inputs, &[1.0])
        });
    });
    group.finish();
}

criterion_group!(inner, derivatives, expansion, events, dense_output);
criterion_main!(inner);
