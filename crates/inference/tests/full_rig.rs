//! A diagnosis of the full rig: what is missing is named with the disc on which it acts.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail")]

use inference::diagnosis::{Verdict, diagnose};
use inference::effects::EFFECTS;
use inference::problem::{Catalogue, Problem};
use inference::record::{Instruments, RawRecord, channel};
use stickslip::integrator::{Options, Simulation};
use stickslip::plant::{Rig, RigInputs, STATES, index};

const BELIEVED: &str = include_str!("../../../modelDescription/full-rig.toml");
/// Time between samples [s].
const INTERVAL: f64 = 0.02;
/// Length of a record [s].
const LENGTH: f64 = 12.0;

/// Irregular numbers of mean 0 and deviation 1: sums of twelve uniform ones.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        let mut uniform = || {
            self.0 = self
                .0
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1_u64 << 53) as f64
        };
        (0..12).map(|_| uniform()).sum::<f64>() - 6.0
    }
}

fn instruments() -> Instruments {
    Instruments {
        noise: [0.002, 0.05, 0.001, 0.02, 0.0, 0.002, 0.05],
        ..Instruments::default()
    }
}

/// Speeds and normal forces in steps: both discs slide, and both stick for a while.
fn held(rig: &Rig<f64>, time: f64) -> (f64, f64, f64) {
    let part = (time / LENGTH * 4.0) as usize;
    let speed = [3.0, 6.0, 4.0, 8.0][part.min(3)];
    let (force, force_1) = [(0.0, 0.0), (20.0, 30.0), (40.0, 10.0), (10.0, 40.0)][part.min(3)];
    (rig.voltage_for_speed(speed), force, force_1)
}

/// A record of `truth` from rest.
fn record(truth: &Rig<f64>, seed: u64) -> RawRecord {
    let mut noise = Noise(seed);
    let mut record = RawRecord {
        name: format!("run-{seed}"),
        ..RawRecord::default()
    };
    let inputs = |time: f64| {
        let (voltage, force, force_1) = held(truth, time);
        RigInputs::held(voltage, force, force_1)
    };
    let mut run =
        Simulation::new(*truth, Options::default(), 0.0, [0.0; STATES], inputs(0.0)).unwrap();
    let channels = [
        (channel::THETA, index::THETA),
        (channel::OMEGA, index::OMEGA),
        (channel::THETA3, index::THETA3),
        (channel::OMEGA3, index::OMEGA3),
        (channel::THETA1, index::THETA1),
        (channel::OMEGA1, index::OMEGA1),
    ];
    for sample in 0..(LENGTH / INTERVAL) as usize {
        let time = sample as f64 * INTERVAL;
        run.advance_to(time).unwrap();
        run.set_inputs(time, inputs(time)).unwrap();
        let state = run.state_at(time);
        let (voltage, force, force_1) = held(truth, time);
        record.time.push(time);
        record.voltage.push(voltage);
        record.normal_force.push(force);
        record.normal_force_1.push(force_1);
        for (channel, component) in channels {
            let error = instruments().noise[channel] * noise.next();
            record.readings[channel].push(state[component] + error);
        }
    }
    record
}

/// What is known of the rig, as relative standard deviations.
const UNCERTAINTIES: [(&str, f64); 6] = [
    ("disc1.inertia", 0.006),
    ("shaft1.stiffness", 0.02),
    ("contact1.mu_c", 0.02),
    ("disc.inertia", 0.006),
    ("shaft.stiffness", 0.02),
    ("motor.coulomb_torque", 0.04),
];

/// The effects that are named in records of the believed rig with `effect`, where the catalogue has these alone.
fn named(effect: &str, catalogue: &[&str]) -> (Verdict, Vec<&'static str>) {
    let believed = Rig::from_toml(BELIEVED, "believed").unwrap();
    let truth = Rig::from_toml(&format!("{BELIEVED}\n{effect}"), "truth").unwrap();
    let without = EFFECTS
        .iter()
        .map(|effect| effect.name)
        .filter(|name| !catalogue.contains(name));
    let problem = Problem::new(
        &believed,
        UNCERTAINTIES
            .map(|(name, deviation)| (name.to_owned(), deviation))
            .to_vec(),
        &[record(&truth, 1)],
        &instruments(),
        &Catalogue {
            without: without.map(str::to_owned).collect(),
            supposed: Vec::new(),
        },
    )
    .unwrap();
    let found = diagnose(&problem, &mut |_| {});
    (found.verdict, found.effects)
}

/// Effects on either disc.
const ON_DISCS: [&str; 8] = [
    "bearing_friction",
    "unbalance",
    "viscous_drag",
    "quadratic_drag",
    "bearing_friction1",
    "unbalance1",
    "viscous_drag1",
    "quadratic_drag1",
];

/// Models with many derivatives need more than the usual stack of a thread.
fn prepare_threads() {
    let _ = rayon::ThreadPoolBuilder::new()
        .stack_size(64 << 20)
        .build_global();
}

#[test]
fn an_effect_is_named_with_the_disc_on_which_it_acts() {
    prepare_threads();
    for (section, name) in [
        ("[unbalance1]\ntorque = 0.03\nphase = 0.7\n", "unbalance1"),
        ("[viscous_drag]\ncoefficient = 0.008\n", "viscous_drag"),
    ] {
        assert_eq!(named(section, &ON_DISCS), (Verdict::Named, vec![name]));
    }
}

#[test]
fn a_model_that_lacks_nothing_is_left_in_peace() {
    prepare_threads();
    assert_eq!(named("", &ON_DISCS), (Verdict::NothingMissing, Vec::new()));
}

#[test]
fn what_the_catalogue_does_not_have_of_disc_d1_gets_no_name() {
    prepare_threads();
    let unbalance = "[unbalance1]\ntorque = 0.03\nphase = 0.7\n";
    let (verdict, _) = named(unbalance, &["viscous_drag1", "bearing_friction"]);
    assert_eq!(verdict, Verdict::NotInCatalogue);
}
