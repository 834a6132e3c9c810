//! Bristles of sticking pins: closed forms, the rigid limit, what they store and lose, mirror symmetry, pins that
//! lift, and bristles that give way.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail")]

mod common;

use common::energy::{EnergyBalance, GAUSS, torques};
use common::{Uniform, state_after};
use stickslip::friction::ContactMode;
use stickslip::integrator::Simulation;
use stickslip::plant::{Contact, Rig, RigGuard, RigInputs, RigState, STATES, index::*};
use stickslip::series::evaluate_derivative;

/// Laws without a band of velocities that counts as zero.
const LAWS: [&str; 6] = [
    "coulomb",
    "coulomb_stiction",
    "stribeck",
    "wojewoda",
    "two_gaussian_torque",
    "two_gaussian_mu",
];

fn section(stiffness: f64, damping: f64) -> String {
    format!("[presliding]\nstiffness = {stiffness:?}\ndamping = {damping:?}\n")
}

fn with_bristles(full: bool, law: &str, stiffness: f64, damping: f64) -> Rig<f64> {
    common::rig(full, common::law(law), &section(stiffness, damping))
}

fn bristle_energy(rig: &Rig<f64>, x: &RigState<f64>) -> f64 {
    let stiffness = rig.effects.presliding.map_or(0.0, |p| p.stiffness);
    0.5 * stiffness * (x[BRISTLE].powi(2) + x[BRISTLE1].powi(2))
}

#[test]
fn a_small_oscillation_in_stick_is_that_of_two_springs() {
    let (stiffness, damping, start) = (15.0, 0.04, 0.01);
    let rig = with_bristles(false, "stribeck", stiffness, damping);
    let mut state = [0.0; STATES];
    (state[THETA], state[BRISTLE]) = (start, start);
    // The motor's own friction holds the gearbox.
    let inputs = RigInputs::held(0.0, 50.0, 0.0);
    let inertia = rig.disc.inertia;
    let decay = 0.5 * (rig.shaft.damping + damping) / inertia;
    let square = (rig.shaft.stiffness + stiffness) / inertia;
    let frequency = (square - decay * decay).sqrt();
    let mut run = common::start(&rig, 1e-13, state, inputs).unwrap();
    for n in 1..=100 {
        let time = 0.02 * f64::from(n);
        run.advance_to(time).unwrap();
        let x = run.state_at(time);
        let (sin, cos) = (frequency * time).sin_cos();
        let expected = start * (-decay * time).exp() * (cos + decay / frequency * sin);
        assert!(
            (x[THETA] - expected).abs() < 1e-13,
            "{} at {time}",
            x[THETA]
        );
        assert!((x[BRISTLE] - expected).abs() < 1e-13, "{}", x[BRISTLE]);
        assert!(run.mode().disc.is_stuck() && run.mode().motor.is_stuck());
    }
    assert_eq!(run.statistics().switches, 0);
}

#[test]
fn breakaway_comes_when_spring_and_momentum_have_stretched_the_bristles() {
    let stiffness = 15.0;
    let mut rig = with_bristles(false, "coulomb", stiffness, 0.0);
    rig.set_parameter("shaft.damping", 0.0).unwrap();
    // A twist that pulls by less than the breakaway torque: only with its momentum does the disc break away.
    let (twist, force) = (1.0, 40.0);
    let limit = force * rig.contact.radius * 0.15;
    let mut state = [0.0; STATES];
    state[THETA3] = twist;
    let pull = rig.shaft.stiffness * twist;
    assert!(pull < limit && 2.0 * pull > limit);
    let mut run = common::start(&rig, 1e-13, state, RigInputs::held(0.0, force, 0.0)).unwrap();
    let total = rig.shaft.stiffness + stiffness;
    let frequency = (total / rig.disc.inertia).sqrt();
    let expected = (1.0 - limit / stiffness * total / pull).acos() / frequency;
    while run.pending_switch().is_none() {
        run.next_segment().unwrap();
    }
    let event = run.pending_switch().unwrap();
    let forward = stickslip::friction::Direction::Forward;
    assert_eq!(
        event.guard,
        Some(RigGuard::Breakaway(Contact::Disc, forward))
    );
    assert!((event.time - expected).abs() < 1e-13, "{}", event.time);
    let speed = pull / total * frequency * (frequency * expected).sin();
    assert!((run.state_at(event.time)[OMEGA] - speed).abs() < 1e-12);
    run.next_segment().unwrap();
    assert!(matches!(run.mode().disc, ContactMode::Slipping(d, _) if d == forward));
}

#[test]
fn stiff_bristles_come_to_the_rigid_contact_in_proportion() {
    for full in [false, true] {
        let rigid = common::rig(full, common::law("stribeck"), "");
        let inputs = RigInputs::held(rigid.voltage_for_speed(5.76), 40.0, 15.0);
        let expected = state_after(&rigid, [0.0; STATES], inputs, 4.0);
        let distance = |stiffness: f64| {
            let damping = (stiffness * rigid.disc.inertia).sqrt();
            let rig = with_bristles(full, "stribeck", stiffness, damping);
            let end = state_after(&rig, [0.0; STATES], inputs, 4.0);
            (end[THETA] - expected[THETA]).abs()
        };
        let distances = [1e3, 1e4, 1e5, 1e6].map(distance);
        println!("full rig {full}: {distances:?}");
        for pair in distances.windows(2) {
            let ratio = pair[0] / pair[1];
            assert!(ratio > 5.0 && ratio < 20.0, "{distances:?}");
        }
        assert!(distances[3] < 1e-4, "{distances:?}");
    }
}

/// A name, a rig on bristles, its start and its inputs.
type Case = (String, Rig<f64>, RigState<f64>, RigInputs<f64>);

/// Random bristles, states and inputs on both rigs under every law that takes bristles.
fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for (number, law) in LAWS.into_iter().enumerate() {
        for full in [false, true] {
            for seed in 0..20 {
                let key = 1 + seed + 100 * number as u64 + 1000 * u64::from(full);
                let mut random = Uniform(key.wrapping_mul(0x9E37_79B9_7F4A_7C15));
                let stiffness = random.decades(5.0, 2e3);
                let damping = random.between(0.0, 1.0) * (stiffness * 0.0149_f64).sqrt();
                let damping = if seed % 3 == 0 { 0.0 } else { damping };
                let rig = with_bristles(full, law, stiffness, damping);
                let mut state = [0.0; STATES];
                for place in [THETA, OMEGA, THETA3, OMEGA3] {
                    state[place] = random.between(-2.0, 2.0);
                }
                if full {
                    state[THETA1] = state[THETA] + random.between(-0.1, 0.1);
                    state[OMEGA1] = random.between(-2.0, 2.0);
                }
                let inputs = RigInputs::held(
                    random.between(-4.0, 4.0),
                    random.between(0.0, 70.0),
                    random.between(0.0, 30.0),
                );
                let name = format!("{law}, full rig {full}, seed {seed}");
                cases.push((name, rig, state, inputs));
            }
        }
    }
    cases
}

#[test]
fn energy_is_accounted_for() {
    let mut worst = 0.0_f64;
    for (name, rig, state, inputs) in cases() {
        let mut run = common::start(&rig, 1e-13, state, inputs).unwrap();
        let mut balance = EnergyBalance::new(&run);
        balance.advance(&mut run, 2.0);
        let error = balance.error(&run);
        worst = worst.max(error);
        assert!(error < 1e-11, "{name}: {error:e} is missing");
    }
    println!("largest energy error {worst:.1e}");
}

/// Runs to 2 s; what friction has taken from the discs less what the bristles hold [J], its smallest value.
fn smallest_loss(name: &str, run: &mut Simulation<f64, Rig<f64>>) -> f64 {
    let rig = *run.system();
    let presliding = rig.effects.presliding.unwrap();
    // Bristles of a contact that slides at the start are loaded up to its breakaway torque at most.
    let levels = [Some(rig.law), rig.disc1.map(|disc1| disc1.law)];
    let forces = [run.inputs().normal_force[0], run.inputs().normal_force_1[0]];
    let mut taken = bristle_energy(&rig, &run.state_at(0.0));
    for ((law, force), (mode, radius)) in levels
        .into_iter()
        .zip(forces)
        .zip([(run.mode().disc, 0.075), (run.mode().disc1, 0.089)])
    {
        if let (Some(law), ContactMode::Slipping(..)) = (law, mode) {
            let load = if law.is_torque() { 1.0 } else { force * radius };
            taken += (load * law.breakaway()).powi(2) / (2.0 * presliding.stiffness);
        }
    }
    let mut smallest = f64::INFINITY;
    while run.segment_start() < 2.0 {
        let (from, to) = (run.segment_start(), run.segment_end().min(2.0));
        let modes = [run.mode().disc, run.mode().disc1];
        for (node, weight) in GAUSS {
            let tau = 0.5 * (to - from) * (1.0 + node);
            let (x, t) = (run.state_at(from + tau), torques(run, tau));
            let pins = [
                (t[0], x[OMEGA], x[BRISTLE], modes[0]),
                (t[1], x[OMEGA1], x[BRISTLE1], modes[1]),
            ];
            for (torque, omega, z, mode) in pins {
                taken += 0.5 * (to - from) * weight * torque * omega;
                let law = presliding.stiffness * z + presliding.damping * omega;
                match mode {
                    ContactMode::Slipping(..) => assert_eq!(z, 0.0, "{name}"),
                    ContactMode::Stuck | ContactMode::Breaking(_) => {
                        assert!((torque - law).abs() < 1e-11, "{name}: {torque}, not {law}");
                    }
                }
            }
        }
        smallest = smallest.min(taken - bristle_energy(&rig, &run.state_at(to)));
        run.next_segment().unwrap();
    }
    smallest
}

#[test]
fn bristles_carry_what_their_law_says_and_give_back_no_more_than_they_took() {
    for (name, rig, state, inputs) in cases() {
        let mut run = common::start(&rig, 1e-12, state, inputs).unwrap();
        let smallest = smallest_loss(&name, &mut run);
        assert!(smallest > -1e-9, "{name}: {smallest} J");
    }
}

#[test]
fn mirrored_runs_are_mirrored() {
    for (name, rig, state, inputs) in cases() {
        let plain = state_after(&rig, state, inputs, 2.0);
        let mut other = inputs;
        other.voltage = inputs.voltage.map(|u| -u);
        let mirrored = state_after(&rig, state.map(|x| -x), other, 2.0);
        for (a, b) in plain.iter().zip(mirrored) {
            assert_eq!(*a, -b, "{name}");
        }
    }
}

#[test]
fn without_normal_force_bristles_are_not_there() {
    let bare = common::rig(true, common::law("coulomb"), "");
    for law in LAWS {
        if law == "two_gaussian_torque" {
            continue; // Its torque does not depend on the normal force.
        }
        for damping in [0.0, 0.3] {
            let rig = with_bristles(true, law, 20.0, damping);
            for start in [0.0, 2.0] {
                let mut state = [0.0; STATES];
                (state[OMEGA], state[OMEGA1]) = (start, -start);
                let inputs = RigInputs::held(3.0, 0.0, 0.0);
                let expected = state_after(&bare, state, inputs, 4.0);
                let end = state_after(&rig, state, inputs, 4.0);
                for (a, b) in end.iter().zip(expected) {
                    assert!(
                        (a - b).abs() < 1e-10,
                        "{law}, {damping}, {start}: {a} against {b}"
                    );
                }
            }
        }
    }
}

#[test]
fn bristles_give_way_when_the_force_drops_and_hold_the_rest() {
    for damping in [0.0, 0.05] {
        let rig = with_bristles(false, "stribeck", 20.0, damping);
        let mut state = [0.0; STATES];
        (state[THETA], state[BRISTLE]) = (0.01, 0.01);
        let mut run = common::start(&rig, 1e-12, state, RigInputs::held(0.0, 50.0, 0.0)).unwrap();
        let mut balance = EnergyBalance::new(&run);
        // On its way back, with half of its deflection left.
        let time = 0.025;
        balance.advance(&mut run, time);
        let before = run.state_at(time);
        assert!(before[OMEGA] < 0.0 && before[BRISTLE] > 0.0);
        let force = 0.3 * 20.0 * before[BRISTLE] / (0.2 * 0.075);
        run.set_inputs(time, RigInputs::held(0.0, force, 0.0))
            .unwrap();
        while run.segment_end() <= time || matches!(run.mode().disc, ContactMode::Breaking(_)) {
            run.next_segment().unwrap();
            let limit = force * 0.075 * 0.2;
            assert!(torques(&run, 0.0)[0].abs() <= limit * (1.0 + 1e-12));
        }
        assert!(run.mode().disc.is_stuck(), "{:?}", run.mode());
        let after = run.state_at(run.segment_start());
        let carried = 20.0 * after[BRISTLE] + damping * after[OMEGA];
        assert!((carried - force * 0.075 * 0.2).abs() < 1e-12, "{carried}");
        // A force that grows again finds bristles that hold as much as before.
        run.set_inputs(run.segment_start(), RigInputs::held(0.0, 50.0, 0.0))
            .unwrap();
        let held = run.state_at(run.segment_start());
        assert_eq!(held[BRISTLE], after[BRISTLE]);
    }
}

#[test]
fn a_force_that_grows_while_bristles_give_way_makes_them_hold_at_once() {
    let rig = with_bristles(false, "stribeck", 12.0, 0.01);
    let mut state = [0.0; STATES];
    (state[THETA], state[BRISTLE]) = (0.02, 0.02);
    let mut inputs = RigInputs::held(0.0, 25.0, 0.0);
    inputs.normal_force = [25.0, -60.0, 48.0, 0.0];
    let mut run = common::start(&rig, 1e-12, state, inputs).unwrap();
    while !(matches!(run.mode().disc, ContactMode::Breaking(_))
        && run.segment_end() > run.segment_start() + 1e-4)
    {
        run.next_segment().unwrap();
    }
    let time = 0.5 * (run.segment_start() + run.segment_end());
    let before = run.state_at(time);
    let torque = 12.0 * before[BRISTLE] + 0.01 * before[OMEGA];
    run.set_inputs(time, RigInputs::held(0.0, 40.0, 0.0))
        .unwrap();
    run.advance_to(time + 1e-6).unwrap();
    assert!(run.mode().disc.is_stuck());
    assert_eq!(run.state_at(time)[BRISTLE], before[BRISTLE]);
    assert!((torques(&run, time - run.segment_start())[0] - torque).abs() < 1e-12);
    // The deflection follows the disc again.
    let series = stickslip::integrator::HybridSystem::states(&rig, run.jet())[BRISTLE];
    assert!((evaluate_derivative(&series[..22], 0.0) - before[OMEGA]).abs() < 1e-12);
}

#[test]
fn a_moving_disc_slides_unless_its_bristles_are_deflected() {
    let rig = with_bristles(false, "stribeck", 20.0, 0.0);
    let mut state = [0.0; STATES];
    state[OMEGA] = 0.1;
    let inputs = RigInputs::held(0.0, 50.0, 0.0);
    let run = common::start(&rig, 1e-12, state, inputs).unwrap();
    assert!(!run.mode().disc.is_stuck());
    state[BRISTLE] = -0.001;
    let run = common::start(&rig, 1e-12, state, inputs).unwrap();
    assert!(run.mode().disc.is_stuck());
    // More than they can carry: they keep what the breakaway torque allows.
    (state[OMEGA], state[BRISTLE]) = (0.0, -1.0);
    let mut run = common::start(&rig, 1e-12, state, inputs).unwrap();
    run.advance_to(1e-6).unwrap();
    let held = run.state_at(run.segment_start())[BRISTLE];
    assert!((held + 50.0 * 0.075 * 0.2 / 20.0).abs() < 1e-12, "{held}");
}

#[test]
fn bearings_and_pin_share_their_bristles() {
    let extra = format!("[bearing_friction]\ntorque = 0.05\n{}", section(20.0, 0.0));
    let rig = common::rig(false, common::law("stribeck"), &extra);
    for force in [0.0, 10.0] {
        // The gearbox pulls slowly ever further.
        let limit = force * 0.075 * 0.2 + 0.05;
        let mut run =
            common::start(&rig, 1e-12, [0.0; STATES], RigInputs::held(1.0, force, 0.0)).unwrap();
        loop {
            if let Some(event) = run.pending_switch()
                && let Some(RigGuard::Breakaway(Contact::Disc, _)) = event.guard
            {
                let carried = 20.0 * run.state_at(event.time)[BRISTLE];
                assert!(
                    (carried - limit).abs() < 1e-12,
                    "{carried} N m at {force} N"
                );
                break;
            }
            run.next_segment().unwrap();
        }
    }
}

#[test]
fn laws_with_a_band_are_refused() {
    for law in ["karnopp", "switch"] {
        for full in [false, true] {
            let text = common::rig_text(full, common::law(law), &section(20.0, 0.1));
            let error = Rig::from_toml(&text, "model.toml").unwrap_err().to_string();
            let expected = format!(
                "model.toml: presliding: bristles cannot go with law = \"{law}\" in [contact], which counts velocities up to \
                 omega_tolerance as zero; take law = \"stribeck\" or leave [presliding] out"
            );
            assert_eq!(error, expected);
        }
    }
}
