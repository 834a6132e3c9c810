//! Effects by equation against the coded effects with the same equation, and against their own kinks.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail")]

#[path = "../common/mod.rs"]
mod common;
mod refused;

use common::options;
use common::{law, rig, start};
use stickslip::plant::{Rig, RigInputs, RigState, STATES, Supposition, sensitivities};

/// A section `[[effect]]` with parameters (key, value, unit).
fn effect(port: &str, equation: &str, parameters: &[(&str, f64, &str)]) -> String {
    let mut text = format!(
        "[[effect]]\nname = \"mine\"\ntitle = \"mine\"\nport = \"{port}\"\nequation = \"{equation}\"\n"
    );
    for (key, value, unit) in parameters {
        let range = if *key == "width" { "positive" } else { "any" };
        text += &format!(
            "[effect.parameters.{key}]\nvalue = {value:?}\nunit = \"{unit}\"\nrange = \"{range}\"\ndescription = \"{key}\"\n"
        );
    }
    text
}

/// A coded effect and the same by equation, the parameters in the same order.
fn twins() -> Vec<(&'static str, String)> {
    vec![
        (
            "[unbalance]\ntorque = 0.1\nphase = 0.7\n",
            effect(
                "disc.torque",
                "-torque * cos(angle - phase)",
                &[("torque", 0.1, "N.m"), ("phase", 0.7, "rad")],
            ),
        ),
        (
            "[viscous_drag]\ncoefficient = 0.01\n",
            effect("disc.torque", "-c*velocity", &[("c", 0.01, "N.m.s/rad")]),
        ),
        (
            "[quadratic_drag]\ncoefficient = 0.002\n",
            effect(
                "disc.torque",
                "-q*velocity*abs(velocity)",
                &[("q", 0.002, "N.m.s2/rad2")],
            ),
        ),
        (
            "[shaft_hardening]\ncubic_stiffness = 0.02\n",
            effect("shaft.torque", "k*twist^3", &[("k", 0.02, "N.m/rad3")]),
        ),
        (
            "[gear_ripple]\ntorque = 0.02\norder = 2.0\nphase = 0.4\n",
            effect(
                "motor.torque",
                "torque*sin(order*angle + phase)",
                &[
                    ("torque", 0.02, "N.m"),
                    ("order", 2.0, "1"),
                    ("phase", 0.4, "rad"),
                ],
            ),
        ),
        (
            "[motor_viscous]\ncoefficient = 2e-4\n",
            effect("motor.torque", "-c*velocity", &[("c", 2e-4, "N.m.s/rad")]),
        ),
        (
            "[supply_sag]\nfactor = 0.95\n",
            effect(
                "motor.voltage",
                "(factor - 1)*voltage",
                &[("factor", 0.95, "1")],
            ),
        ),
        (
            "[resistance_drift]\nrate_per_minute = 0.5\n",
            effect(
                "motor.resistance",
                "drift*time",
                &[("drift", 0.33 * 0.5 / 60.0, "Ohm/s")],
            ),
        ),
        (
            "[position_friction]\namplitude = 0.15\nphase = 0.4\n",
            effect(
                "disc.friction",
                "1 + amplitude*cos(2*angle - phase)",
                &[("amplitude", 0.15, "1"), ("phase", 0.4, "rad")],
            ),
        ),
        (
            "[normal_force_wobble]\namplitude = 0.2\nphase = 0.7\n",
            effect(
                "disc.friction",
                "1 + amplitude*cos(angle - phase)",
                &[("amplitude", 0.2, "1"), ("phase", 0.7, "rad")],
            ),
        ),
        (
            "[friction_wear]\nrate_per_minute = 0.8\n",
            effect(
                "disc.friction",
                "1 + rate*time",
                &[("rate", 0.8 / 60.0, "1/s")],
            ),
        ),
    ]
}

fn moving() -> RigState<f64> {
    let mut state = [0.0; STATES];
    state[..5].copy_from_slice(&[0.4, 3.0, 1.4, 5.0, 0.7]);
    state
}

fn inputs(rig: &Rig<f64>) -> RigInputs<f64> {
    RigInputs::held(rig.voltage_for_speed(3.0), 60.0, 15.0)
}

fn written(extra: &str) -> Rig<f64> {
    rig(false, law("stribeck"), extra)
}

fn end(rig: &Rig<f64>, tolerance: f64) -> RigState<f64> {
    let mut run = start(rig, tolerance, moving(), inputs(rig)).unwrap();
    run.advance_to(6.0).unwrap();
    assert!(run.statistics().switches >= 4, "{:?}", run.statistics());
    run.state_at(6.0)
}

fn assert_near(a: &RigState<f64>, b: &RigState<f64>, bar: f64, what: &str) {
    for (place, (a, b)) in a.iter().zip(b).enumerate() {
        assert!(
            (a - b).abs() < bar * (1.0 + a.abs()),
            "{what}, {place}: {a} {b}"
        );
    }
}

#[test]
fn an_equation_runs_as_the_coded_effect_through_stick_slip() {
    for (coded, equation) in twins() {
        let (a, b) = (end(&written(coded), 1e-11), end(&written(&equation), 1e-11));
        assert_near(&a, &b, 2e-9, coded);
    }
}

/// Derivatives of the state at 2.6 s by the effect's own parameters.
fn slopes(rig: &Rig<f64>) -> Vec<RigState<f64>> {
    let parameters = rig.parameters();
    let coded: Vec<&str> = rig.effects.active().iter().map(|(name, _)| *name).collect();
    let mut names: Vec<&str> = parameters
        .iter()
        .filter(|parameter| parameter.section == "mine" || coded.contains(&parameter.section))
        .map(|parameter| parameter.name.as_str())
        .collect();
    // Files list the parameters of an equation in alphabetical order.
    names.sort_unstable();
    let found = sensitivities(rig, &names, options(1e-12), &moving(), &inputs(rig), &[2.6]);
    found.unwrap().remove(0).derivatives
}

#[test]
fn derivatives_through_stick_slip_are_those_of_the_coded_effect() {
    for (coded, equation) in twins() {
        // Rates are per minute there and per second here, and the resistance's is a share there.
        let unit = match coded {
            drift if drift.contains("resistance") => 0.33 / 60.0,
            wear if wear.contains("wear") => 1.0 / 60.0,
            _ => 1.0,
        };
        let (a, b) = (slopes(&written(coded)), slopes(&written(&equation)));
        assert_eq!(a.len(), b.len());
        for (a, b) in a.iter().zip(&b) {
            assert_near(a, &b.map(|slope| slope * unit), 1e-7, coded);
        }
    }
}

/// Equations with kinks of every kind, through which the motion passes many times.
const KINKS: [(&str, &str); 7] = [
    ("disc.torque", "-a * sign(cos(angle))"),
    ("disc.torque", "-a * max(cos(angle), 0.3)"),
    (
        "disc.torque",
        "-a * min(abs(velocity)/width, 1) * cos(angle)",
    ),
    ("shaft.torque", "a * max(twist - 0.4, 0)"),
    ("disc.friction", "1 + a*sign(sin(2*angle))"),
    // Below zero a factor counts as zero.
    ("disc.friction", "1 + 20*a*cos(angle)"),
    ("motor.torque", "a * abs(sin(angle/8)) / 8"),
];

fn kinked(port: &str, equation: &str, a: f64) -> Rig<f64> {
    let unit = if port == "disc.friction" { "1" } else { "N.m" };
    let mut parameters = vec![("a", a, unit)];
    if equation.contains("width") {
        parameters.push(("width", 4.0, "rad/s"));
    }
    written(&effect(port, equation, &parameters))
}

#[test]
fn the_tolerance_says_how_exact_a_run_over_kinks_is() {
    for (port, equation) in KINKS {
        let rig = kinked(port, equation, 0.06);
        let exact = end(&rig, 1e-13);
        for tolerance in [1e-7, 1e-9, 1e-11] {
            assert_near(&end(&rig, tolerance), &exact, 300.0 * tolerance, equation);
        }
    }
}

#[test]
fn derivatives_over_kinks_are_those_of_finite_differences() {
    for (port, equation) in KINKS {
        let (size, step) = (0.06, 1e-5);
        let until = |a: f64| {
            let rig = kinked(port, equation, a);
            let mut run = start(&rig, 1e-13, moving(), inputs(&rig)).unwrap();
            run.advance_to(2.6).unwrap();
            run.state_at(2.6)
        };
        let (up, down) = (until(size + step), until(size - step));
        let slope = &slopes(&kinked(port, equation, size))[0];
        let difference: RigState<f64> = std::array::from_fn(|j| (up[j] - down[j]) / (2.0 * step));
        assert_near(slope, &difference, 1e-5, equation);
    }
}

#[test]
fn a_table_of_two_lines_is_the_absolute_value() {
    let by_points = effect(
        "disc.torque",
        "-a * ramp(angle - b)",
        &[("a", 0.02, "N.m"), ("b", 9.0, "rad")],
    ) + "[effect.tables.ramp]\nx = [-1000, 0, 1000]\ny = [1000, 0, 1000]\nx_unit = \"rad\"\ny_unit = \"1\"\ninterpolation = \"linear\"\n";
    let by_name = effect(
        "disc.torque",
        "-a * abs(angle - b)",
        &[("a", 0.02, "N.m"), ("b", 9.0, "rad")],
    );
    let (a, b) = (
        end(&written(&by_points), 1e-11),
        end(&written(&by_name), 1e-11),
    );
    assert_near(&a, &b, 2e-9, "ramp");
}

#[test]
fn a_periodic_table_of_a_sine_is_nearly_that_sine() {
    let turn = 2.0 * std::f64::consts::PI;
    let x: Vec<f64> = (0..36).map(|j| f64::from(j) * turn / 36.0).collect();
    let y: Vec<f64> = x.iter().map(|x| x.cos()).collect();
    let by_points = effect("disc.torque", "-a * wave(angle)", &[("a", 0.1, "N.m")])
        + &format!(
            "[effect.tables.wave]\nx = {x:?}\ny = {y:?}\nperiod = {turn:?}\nx_unit = \"rad\"\ny_unit = \"1\"\ninterpolation = \"spline\"\n"
        );
    let by_name = effect("disc.torque", "-a * cos(angle)", &[("a", 0.1, "N.m")]);
    let (a, b) = (
        end(&written(&by_points), 1e-11),
        end(&written(&by_name), 1e-11),
    );
    assert_near(&a, &b, 3e-4, "wave");
}

#[test]
fn a_model_file_with_an_effect_reads_back_as_written() {
    for (_, equation) in twins() {
        let once = written(&equation);
        let again = Rig::from_toml(&once.to_toml(), "again").unwrap();
        assert_eq!(once, again);
        assert_eq!(
            once.parameter("disc.inertia"),
            again.parameter("disc.inertia")
        );
    }
}

#[test]
fn effects_on_disc_d1_act_there() {
    let drag = |port: &str| effect(port, "-c*velocity", &[("c", 0.01, "N.m.s/rad")]);
    let coded = rig(
        true,
        law("stribeck"),
        "[viscous_drag1]\ncoefficient = 0.01\n",
    );
    let by_equation = rig(true, law("stribeck"), &drag("disc1.torque"));
    assert_near(
        &end(&coded, 1e-11),
        &end(&by_equation, 1e-11),
        2e-9,
        "disc1.torque",
    );
    let coded = rig(
        true,
        law("stribeck"),
        "[shaft_hardening1]\ncubic_stiffness = 0.5\n",
    );
    let cubic = effect("shaft1.torque", "k*twist^3", &[("k", 0.5, "N.m/rad3")]);
    let by_equation = rig(true, law("stribeck"), &cubic);
    assert_near(
        &end(&coded, 1e-11),
        &end(&by_equation, 1e-11),
        2e-9,
        "shaft1.torque",
    );
    let coded = rig(
        true,
        law("stribeck"),
        "[normal_force_wobble1]\namplitude = 0.2\nphase = 0.7\n",
    );
    let wobble = effect(
        "disc1.friction",
        "1 + a*cos(angle - phase)",
        &[("a", 0.2, "1"), ("phase", 0.7, "rad")],
    );
    let by_equation = rig(true, law("stribeck"), &wobble);
    assert_near(
        &end(&coded, 1e-11),
        &end(&by_equation, 1e-11),
        2e-9,
        "disc1.friction",
    );
}

#[test]
fn the_examples_of_the_page_on_equations_are_models() {
    let page = include_str!("../../docs/equations.md");
    let examples: Vec<&str> = page
        .split("```toml\n")
        .skip(1)
        .filter_map(|block| block.split("```").next())
        .collect();
    // The last one is for small plants, whose tests read it.
    let [formula, points, suspect, _] = examples[..] else {
        panic!("{} examples", examples.len());
    };
    let rig = written(&[formula, points].concat());
    assert_eq!(rig.equations.active().count(), 2);
    // The third is the first without values.
    let suspects = Supposition::read_all(suspect, "rumble.toml").unwrap();
    let known = rig.equations.active().next().unwrap().definition;
    assert_eq!(suspects[0].definition.equation(), known.equation());
    assert_eq!(suspects[0].guesses, [None; 6]);
}

#[test]
fn what_is_kept_away_from_zero_may_divide() {
    for equation in [
        "-a / (width/2) * velocity",
        "-a / exp(angle)",
        "-a / (1 + (velocity/width)^2)",
        "-a * velocity / (3*width^2)*width",
    ] {
        let mut parameters = vec![("a", 0.01, "N.m")];
        if equation.contains("width") {
            parameters.push(("width", 2.0, "rad/s"));
        }
        written(&effect("disc.torque", equation, &parameters));
    }
}

#[test]
fn new_inputs_may_lie_many_pieces_of_a_table_away() {
    // A normal force that jumps by 350 pieces, up and down again.
    let x: Vec<f64> = (0..=350).map(f64::from).collect();
    let y: Vec<f64> = x.iter().map(|x| 1e-4 * x).collect();
    let by_points = effect("disc.torque", "-a * pull(load)", &[("a", 1.0, "1")])
        + &format!(
            "[effect.tables.pull]\nx = {x:?}\ny = {y:?}\nx_unit = \"N\"\ny_unit = \"N.m\"\ninterpolation = \"linear\"\n"
        );
    let by_name = effect("disc.torque", "-a * load", &[("a", 1e-4, "m")]);
    let run = |text: &str| {
        let rig = written(text);
        let held = |force| RigInputs::held(rig.voltage_for_speed(3.0), force, 0.0);
        let mut run = start(&rig, 1e-11, moving(), held(0.5)).unwrap();
        for (time, force) in [(0.5, 349.5), (0.6, 0.5), (1.5, 349.5)] {
            run.set_inputs(time, held(force)).unwrap();
        }
        run.advance_to(2.0).unwrap();
        run.state_at(2.0)
    };
    assert_near(&run(&by_points), &run(&by_name), 2e-9, "pull");
}

#[test]
fn a_solver_from_outside_sees_every_kink() {
    for (port, equation) in KINKS {
        let rig = kinked(port, equation, 0.06);
        let exact = common::state_after(&rig, [0.0; STATES], inputs(&rig), 3.0);
        let mut model = stickslip::cosim::open_for_exchange(&rig.to_toml(), "kinked").unwrap();
        let table = model.table().clone();
        let place = |name: &str| table.find(name).unwrap().value_reference;
        let held = [("u", inputs(&rig).voltage[0]), ("N2", 60.0)];
        for (name, value) in held {
            model.set_real(place(name), value).unwrap();
        }
        model.set_up(0.0, None);
        model.initialise().unwrap();
        let inputs: Vec<common::solver::Input> = held
            .map(|(name, value)| {
                (
                    place(name),
                    Box::new(move |_| value) as Box<dyn Fn(f64) -> f64>,
                )
            })
            .into();
        let mut solver = common::solver::Solver::new(model.as_mut(), inputs, 1e-11);
        solver.advance_to(3.0);
        for (place, exact) in exact[..5].iter().enumerate() {
            let found = solver.states[place];
            assert!(
                (found - exact).abs() < 1e-6 * (1.0 + exact.abs()),
                "{equation}: {found} {exact}"
            );
        }
    }
}
