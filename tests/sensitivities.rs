//! Derivatives through stick-slip against central differences of runs at a tolerance of 1e-13.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail")]

mod common;

use common::grazing::{TOUCH, around_grazing, pressed, towards_rest};
use common::{LAWS, rig_text};
use stickslip::integrator::{Options, Simulation};
use stickslip::plant::{Rig, RigInputs, RigState, STATES, index::*, sensitivities};
use stickslip::series::{Dual, Scalar};

/// Largest difference between a derivative and its central difference, relative to the largest
/// derivative of that state variable's kind with respect to the same quantity.
const BAR: f64 = 1e-6;
/// Largest such difference of runs at a tolerance of 1e-6 from runs at 1e-12; a jump that is stepped over costs 2e-2 or more.
const COARSE_BAR: f64 = 1e-2;
const END: f64 = 2.6;

/// Sections of effects, a few at a time.
const EFFECTS: [&str; 9] = [
    "[bearing_friction]\ntorque = 0.05\n",
    "[normal_force_wobble]\namplitude = 0.2\nphase = 0.7\n[unbalance]\ntorque = 0.1\nphase = 0.3\n",
    "[position_friction]\namplitude = 0.15\nphase = 0.4\n[viscous_drag]\ncoefficient = 0.01\n",
    "[quadratic_drag]\ncoefficient = 0.002\n[shaft_hardening]\ncubic_stiffness = 0.02\n",
    "[shaft_hysteresis]\nstiffness = 0.1\nrelaxation_time = 0.15\n[motor_viscous]\ncoefficient = 2e-4\n",
    "[backlash]\ngap = 0.2\n[supply_sag]\nfactor = 0.95\n",
    "[gear_ripple]\ntorque = 0.02\norder = 2.0\nphase = 0.4\n[resistance_drift]\nrate_per_minute = 0.5\n",
    "[load_cell_bias]\nbias = 5.0\n[load_exponent]\nexponent = 0.8\n[friction_wear]\nrate_per_minute = 0.8\n",
    "[stochastic_friction]\nstandard_deviation = 0.04\ncorrelation_time = 0.1\nseed = 5.0\n",
];

/// A start from which neither loop of the two-Gaussian laws folds.
fn moving(full: bool, law: &str) -> RigState<f64> {
    let mut state = [0.0; STATES];
    state[..5].copy_from_slice(&[0.4, 3.0, 1.4, 5.0, 0.7]);
    if full {
        (state[THETA1], state[OMEGA1]) = match law {
            "two_gaussian_mu" => (0.4, 3.0),
            _ => (0.3, 2.0),
        };
    }
    state
}

fn inputs(rig: &Rig<f64>) -> RigInputs<f64> {
    // The friction-coefficient law folds on the full rig when pressed harder.
    let gentle = rig.law.name() == "two_gaussian_mu" && rig.disc1.is_some();
    let (force, force_1) = if gentle { (20.0, 5.0) } else { (40.0, 12.0) };
    RigInputs::held(rig.voltage_for_speed(5.76), force, force_1)
}

fn end(rig: &Rig<f64>, state: RigState<f64>) -> RigState<f64> {
    let mut run = common::start(rig, 1e-13, state, inputs(rig)).unwrap();
    run.advance_to(END).unwrap();
    run.state_at(END)
}

/// d end/d x at `x` by central differences, extrapolated to the fourth order.
fn difference(x: f64, step: f64, end: impl Fn(f64) -> RigState<f64>) -> RigState<f64> {
    let central = |step: f64| {
        let (up, down) = (end(x + step), end(x - step));
        let mut slope = [0.0; STATES];
        for j in 0..STATES {
            slope[j] = (up[j] - down[j]) / (2.0 * step);
        }
        slope
    };
    let (fine, coarse) = (central(step), central(2.0 * step));
    let mut slope = [0.0; STATES];
    for j in 0..STATES {
        slope[j] = (4.0 * fine[j] - coarse[j]) / 3.0;
    }
    slope
}

fn error(ours: &RigState<f64>, expected: &RigState<f64>) -> f64 {
    let size = expected.iter().fold(1e-3_f64, |size, x| size.max(x.abs()));
    let pairs = ours.iter().zip(expected);
    pairs.fold(0.0, |largest: f64, (a, b)| {
        largest.max((a - b).abs() / size)
    })
}

fn check_parameters(name: &str, rig: &Rig<f64>, state: RigState<f64>) {
    check_parameters_until(END, name, rig, state, inputs(rig));
}

fn check_parameters_until(
    end: f64,
    name: &str,
    rig: &Rig<f64>,
    state: RigState<f64>,
    inputs: RigInputs<f64>,
) {
    let names: Vec<String> = rig
        .parameters()
        .into_iter()
        .map(|parameter| parameter.name)
        .filter(|name| !name.ends_with("seed"))
        // Zero in most cases, and a standard deviation has no derivative there.
        .filter(|name| rig.parameter(name) != Some(0.0))
        .collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let options = common::options(1e-13);
    let all = sensitivities(rig, &names, options, &state, &inputs, &[end]).unwrap();
    assert!(!all[0].interrupted, "{name}");
    let mut worst = 0.0_f64;
    for (parameter, derivative) in names.iter().zip(&all[0].derivatives) {
        let value = rig.parameter(parameter).unwrap();
        let expected = difference(value, 2e-5 * value.abs().max(1e-2), |value| {
            let mut changed = *rig;
            changed.set_parameter(parameter, value).unwrap();
            let mut run = common::start(&changed, 1e-13, state, inputs).unwrap();
            run.advance_to(end).unwrap();
            run.state_at(end)
        });
        let error = error(derivative, &expected);
        worst = worst.max(error);
        assert!(
            error < BAR,
            "{name}, {parameter}: {error:e}: {derivative:?} instead of {expected:?}"
        );
    }
    println!("{name:32} {} parameters, worst {worst:.1e}", names.len());
}

#[test]
fn parameters_of_every_law_and_both_rigs() {
    for law in LAWS {
        for full in [false, true] {
            let rig = Rig::from_toml(&rig_text(full, law, ""), law.0).unwrap();
            let name = format!("{}, full rig {full}", law.0);
            check_parameters(&name, &rig, moving(full, law.0));
        }
    }
}

#[test]
fn parameters_of_the_effects() {
    for effect in EFFECTS {
        let rig = common::rig(false, common::law("stribeck"), effect);
        let name = effect.lines().next().unwrap();
        check_parameters(name, &rig, moving(false, ""));
    }
    let random = (
        "wojewoda",
        "mu_c = 0.15\nmu_s = 0.2\nomega_s = 1.2\nstochastic_amplitude = 0.05\ncorrelation_angle = 0.3\nseed = 5",
    );
    let rig = common::rig(false, random, "");
    check_parameters("wojewoda, random", &rig, moving(false, ""));
}

#[test]
fn parameters_and_initial_states_through_presliding() {
    let bristles = "[presliding]\nstiffness = 20.0\ndamping = 0.05\n";
    for law in LAWS {
        if ["karnopp", "switch"].contains(&law.0) {
            continue; // Refused.
        }
        for full in [false, true] {
            let rig = common::rig(full, law, bristles);
            let start = moving(full, law.0);
            check_parameters(
                &format!("{} on bristles, full rig {full}", law.0),
                &rig,
                start,
            );
        }
    }
    // Bristles that give way while their disc springs back.
    for damping in [0.0, 0.01] {
        let text = format!("[presliding]\nstiffness = 12.0\ndamping = {damping:?}\n");
        let rig = common::rig(false, common::law("stribeck"), &text);
        let mut start = [0.0; STATES];
        (start[THETA], start[BRISTLE]) = (0.02, 0.02);
        let mut inputs = RigInputs::held(0.0, 25.0, 0.0);
        inputs.normal_force = [25.0, -60.0, 48.0, 0.0];
        check_parameters_until(0.4, "bristles that give way", &rig, start, inputs);
        let end = |state: RigState<f64>| {
            let mut run = common::start(&rig, 1e-13, state, inputs).unwrap();
            run.advance_to(0.4).unwrap();
            run.state_at(0.4)
        };
        for place in [THETA, OMEGA, BRISTLE] {
            let mut lifted: RigState<Dual<1>> = start.map(Dual::constant);
            lifted[place] = Dual::variable(start[place], 0);
            let options = common::options(1e-13);
            let (lifted_rig, inputs) = (rig.to_scalar::<Dual<1>>(), inputs.to_scalar());
            let mut run = Simulation::new(lifted_rig, options, 0.0, lifted, inputs).unwrap();
            run.advance_to(0.4).unwrap();
            let ours = run.state_at(0.4).map(|x| x.derivative[0]);
            let expected = difference(start[place], 2e-6, |value| {
                let mut changed = start;
                changed[place] = value;
                end(changed)
            });
            let error = error(&ours, &expected);
            println!("state {place}: {error:.1e}");
            assert!(
                error < BAR,
                "state {place}: {error:e}: {ours:?} instead of {expected:?}"
            );
        }
    }
}

/// Eq. 6-2 as in `two-gaussian-folds` of `tests/golden`, whose loop folds.
const FOLDING: &str = "a1 = 0.6\nb1 = -2.6\nc1 = 1.2\na2 = 0.6\nb2 = 0.47960\nc2 = 2.62303\nomega_centre = 7.15956\nacceleration_semi_axis = 58.2873";

/// Derivative of the state at [`END`] by the parameter `name`, from a run of that order.
fn sensitivity(
    rig: &Rig<f64>,
    name: &str,
    tolerance: f64,
    order: usize,
    start: RigState<f64>,
    inputs: RigInputs<f64>,
) -> RigState<f64> {
    let options = Options {
        order,
        ..common::options(tolerance)
    };
    let all = sensitivities(rig, &[name], options, &start, &inputs, &[END]).unwrap();
    all[0].derivatives[0]
}

#[test]
fn parameters_through_folds() {
    for effect in ["", "[quadratic_drag]\ncoefficient = 0.002\n"] {
        let reduced = common::rig(false, ("two_gaussian_torque", FOLDING), effect);
        let full = common::rig(true, common::law("two_gaussian_torque"), effect);
        let mut both = moving(true, "");
        (both[THETA1], both[OMEGA1]) = (0.41, 3.1);
        let held = |force| RigInputs::held(reduced.voltage_for_speed(5.76), force, 0.0);
        let cases = [
            ("from rest", &reduced, [0.0; STATES], held(50.0)),
            ("moving", &reduced, moving(false, ""), held(20.0)),
            ("full rig", &full, both, inputs(&full)),
        ];
        for (name, rig, start, inputs) in cases {
            let mut run = common::start(rig, 1e-13, start, inputs).unwrap();
            run.advance_to(END).unwrap();
            assert!(run.statistics().branch_jumps > 0, "{name}");
            for parameter in [
                "disc.inertia",
                "shaft.stiffness",
                "contact.a1",
                "motor.resistance",
            ] {
                let coarse = sensitivity(rig, parameter, 1e-6, 14, start, inputs);
                let exact = sensitivity(rig, parameter, 1e-12, 21, start, inputs);
                let error = error(&coarse, &exact);
                println!("{name}, {parameter}: {error:.1e} in a coarse run");
                assert!(
                    error < COARSE_BAR,
                    "{name}, {parameter}: {error:e} in a coarse run"
                );
            }
            check_parameters_until(
                END,
                &format!("folds, {name}, {effect:?}"),
                rig,
                start,
                inputs,
            );
        }
    }
}

#[test]
fn initial_states_of_every_law_and_both_rigs() {
    for law in LAWS {
        for full in [false, true] {
            let rig = common::rig(full, law, "");
            let (start, used) = (moving(full, law.0), if full { 7 } else { 5 });
            let lifted = seeded::<7>(start, used);
            let options = common::options(1e-13);
            let inputs = inputs(&rig).to_scalar();
            let mut run =
                Simulation::new(rig.to_scalar::<Dual<7>>(), options, 0.0, lifted, inputs).unwrap();
            run.advance_to(END).unwrap();
            let result = run.state_at(END);
            let mut worst = 0.0_f64;
            for place in 0..used {
                let expected = difference(start[place], 2e-4, |value| {
                    let mut changed = start;
                    changed[place] = value;
                    end(&rig, changed)
                });
                worst = worst.max(error(&result.map(|x| x.derivative[place]), &expected));
            }
            println!("{:20} full rig {full:5}: worst {worst:.1e}", law.0);
            assert!(worst < BAR, "{}, full rig {full}: {worst:e}", law.0);
        }
    }
}

/// A run with derivatives by the initial state.
fn varied(rig: &Rig<f64>, start: RigState<f64>) -> Simulation<Dual<5>, Rig<Dual<5>>> {
    let inputs = inputs(rig).to_scalar();
    Simulation::new(
        rig.to_scalar(),
        common::options(1e-6),
        0.0,
        seeded(start, 5),
        inputs,
    )
    .unwrap()
}

/// `start` with the derivatives of its first `used` components by themselves.
fn seeded<const N: usize>(start: RigState<f64>, used: usize) -> RigState<Dual<N>> {
    let mut lifted: RigState<Dual<N>> = start.map(Dual::constant);
    for (place, x) in lifted.iter_mut().enumerate().take(used) {
        x.derivative[place] = 1.0;
    }
    lifted
}

#[test]
fn a_run_started_over_is_a_new_one_to_the_last_bit() {
    let laws = LAWS.map(|law| [false, true].map(|full| common::rig(full, law, "")));
    let effects = EFFECTS.map(|effect| common::rig(false, common::law("stribeck"), effect));
    let bristles = "[presliding]\nstiffness = 20.0\ndamping = 0.05\n";
    let on_bristles = common::rig(false, common::law("stribeck"), bristles);
    let rigs = laws
        .into_iter()
        .flatten()
        .chain(effects)
        .chain([on_bristles]);
    for rig in rigs {
        let start = moving(rig.disc1.is_some(), rig.law.name());
        let mut anew = varied(&rig, start);
        anew.advance_to(END).unwrap();
        // The run before was another one, at rest and with the brake released on the way.
        let mut again = varied(&rig, [0.0; STATES]);
        let released = RigInputs::held(5.0, 0.0, 0.0).to_scalar();
        again.set_inputs(0.7, released).unwrap();
        again.advance_to(1.9).unwrap();
        again
            .start_over(0.0, seeded(start, 5), inputs(&rig).to_scalar())
            .unwrap();
        again.advance_to(END).unwrap();
        assert_eq!(
            again.state_at(END),
            anew.state_at(END),
            "{}",
            rig.law.name()
        );
        assert_eq!(again.statistics(), anew.statistics());
    }
}

/// The state at 1 s of a run whose normal force drops at 0.3 s below what holds the disc.
fn after_drop<S: Scalar>(rig: &Rig<S>) -> RigState<S> {
    let held = |force| RigInputs::<f64>::held(3.1, force, 0.0).to_scalar();
    let start = [S::ZERO; STATES];
    let mut run = common::start(rig, 1e-13, start, held(50.0)).unwrap();
    run.set_inputs(0.3, held(5.0)).unwrap();
    assert_eq!(run.pending_switch().unwrap().time, 0.3);
    run.advance_to(1.0).unwrap();
    run.state_at(1.0)
}

#[test]
fn a_disc_that_new_inputs_set_free_goes_at_that_instant_whatever_the_parameters() {
    let rig = common::rig(false, common::law("stribeck"), "");
    for name in ["shaft.stiffness", "disc.inertia", "contact.mu_s"] {
        let value = rig.parameter(name).unwrap();
        let mut lifted = rig.to_scalar::<Dual<1>>();
        lifted
            .set_parameter(name, Dual::variable(value, 0))
            .unwrap();
        let ours = after_drop(&lifted).map(|x| x.derivative[0]);
        let expected = difference(value, 2e-5 * value, |value| {
            let mut changed = rig;
            changed.set_parameter(name, value).unwrap();
            after_drop(&changed)
        });
        let error = error(&ours, &expected);
        println!("{name}: {error:.1e}");
        assert!(error < BAR, "{name}: {ours:?} instead of {expected:?}");
    }
}

#[test]
fn unknown_parameters_are_named() {
    let rig = common::rig(false, common::law("stribeck"), "");
    let options = common::options(1e-12);
    let error = sensitivities(
        &rig,
        &["disc.mass"],
        options,
        &[0.0; STATES],
        &inputs(&rig),
        &[1.0],
    );
    assert_eq!(
        error.unwrap_err().to_string(),
        "there is no parameter \"disc.mass\" in this model"
    );
}

#[test]
fn a_grazing_switch_is_reported_under_every_law_on_both_rigs() {
    for law in LAWS {
        for full in [false, true] {
            let (free, rests) = around_grazing(full, law);
            let mut interrupted = Vec::new();
            for force in [free, rests, rests * (1.0 + 1e-3)] {
                let (rig, inputs) = pressed(full, law, force);
                let names = ["disc.inertia", "contact.radius"];
                let options = common::options(1e-12);
                let start = towards_rest(full);
                let all = sensitivities(&rig, &names, options, &start, &inputs, &[TOUCH]).unwrap();
                interrupted.push(all[0].interrupted);
            }
            let name = format!("{}, full rig {full}, {rests} N", law.0);
            assert_eq!(interrupted, [false, true, false], "{name}");
        }
    }
}

/// States of a run with derivatives with respect to its start, and the number of its segments.
fn from_settled(
    rig: &Rig<f64>,
    state: RigState<f64>,
    tolerance: f64,
    order: usize,
) -> (Vec<RigState<Dual<7>>>, u64) {
    let seeded: RigState<Dual<7>> = std::array::from_fn(|place| {
        if place < 7 {
            Dual::variable(state[place], place)
        } else {
            Dual::constant(state[place])
        }
    });
    let options = Options {
        order,
        ..common::options(tolerance)
    };
    let mut run = Simulation::new(
        rig.to_scalar(),
        options,
        0.0,
        seeded,
        inputs(rig).to_scalar(),
    )
    .unwrap();
    let states = [0.0005, 0.002, 0.01, 0.03, 0.05, 0.1].map(|time| {
        run.advance_to(time).unwrap();
        run.state_at(time)
    });
    (states.to_vec(), run.statistics().segments)
}

#[test]
fn derivatives_that_start_beside_the_slow_manifold_are_right_in_coarse_runs() {
    for full in [false, true] {
        for law in LAWS {
            let rig = common::rig(full, law, "[bearing_friction]\ntorque = 0.02\n");
            let mut run = common::start(&rig, 1e-13, moving(full, law.0), inputs(&rig)).unwrap();
            let mut settled = 0.2;
            run.advance_to(settled).unwrap();
            while run.mode().disc.is_stuck() {
                settled += 0.05;
                run.advance_to(settled).unwrap();
            }
            let state = run.state_at(settled);
            let (exact, _) = from_settled(&rig, state, 1e-13, 21);
            let (found, segments) = from_settled(&rig, state, 1e-6, 14);
            for slot in 0..7 {
                let column = |state: &RigState<Dual<7>>| state.map(|x| x.derivative[slot]);
                let size = column(&exact[0])
                    .into_iter()
                    .fold(0.0, |a: f64, x| a.max(x.abs()));
                for (found, exact) in found.iter().map(column).zip(exact.iter().map(column)) {
                    for (found, exact) in found.iter().zip(&exact) {
                        assert!(
                            (found - exact).abs() <= 1e-5 * size,
                            "{}, full rig {full}, slot {slot}: {found:e} instead of {exact:e}",
                            law.0
                        );
                    }
                }
            }
            // The motor's transients take some fifteen segments of a series that follows them.
            let follows_them = law.0 == "wojewoda";
            assert!(
                follows_them || segments <= 6,
                "{}: {segments} segments",
                law.0
            );
        }
    }
}
