//! Closed forms: the linear rigs against matrix exponentials, the disc held in stick, and a disc that
//! swings under Coulomb friction on a held motor; limits of extreme parameters; order of convergence.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail")]

mod common;

use nalgebra::{DMatrix, DVector};
use std::f64::consts::PI;
use stickslip::integrator::{Options, Simulation};
use stickslip::plant::{Contact, Rig, RigGuard, RigInputs, STATES, index::*};

/// The frictionless rig as dx/dt = A x + b u over the state variables listed, others held at zero.
fn linear(rig: &Rig<f64>, places: &[usize], voltage: f64) -> (DMatrix<f64>, DVector<f64>) {
    let (mut a, mut b) = (DMatrix::zeros(STATES, STATES), DVector::zeros(STATES));
    let eta = rig.gearbox.ratio;
    let (j2, j3) = (rig.disc.inertia, eta * eta * rig.motor.inertia);
    let (k2, c2) = (rig.shaft.stiffness, rig.shaft.damping);
    a[(THETA, OMEGA)] = 1.0;
    a[(THETA3, OMEGA3)] = 1.0;
    a[(THETA1, OMEGA1)] = 1.0;
    a[(OMEGA, THETA)] = -k2 / j2;
    a[(OMEGA, THETA3)] = k2 / j2;
    a[(OMEGA, OMEGA)] = -c2 / j2;
    a[(OMEGA, OMEGA3)] = c2 / j2;
    a[(OMEGA3, THETA)] = k2 / j3;
    a[(OMEGA3, THETA3)] = -k2 / j3;
    a[(OMEGA3, OMEGA)] = c2 / j3;
    a[(OMEGA3, OMEGA3)] = -(c2 + eta * eta * rig.motor.viscous_damping) / j3;
    a[(OMEGA3, CURRENT)] = eta * rig.motor.torque_constant / j3;
    a[(CURRENT, CURRENT)] = -rig.motor.resistance / rig.motor.inductance;
    a[(CURRENT, OMEGA3)] = -rig.motor.back_emf_constant * eta / rig.motor.inductance;
    b[CURRENT] = voltage / rig.motor.inductance;
    if let Some(disc1) = &rig.disc1 {
        let (k1, c1, j1) = (
            disc1.shaft.stiffness,
            disc1.shaft.damping,
            disc1.disc.inertia,
        );
        for (row, inertia, sign) in [(OMEGA1, j1, -1.0), (OMEGA, j2, 1.0)] {
            a[(row, THETA1)] += sign * k1 / inertia;
            a[(row, THETA)] -= sign * k1 / inertia;
            a[(row, OMEGA1)] += sign * c1 / inertia;
            a[(row, OMEGA)] -= sign * c1 / inertia;
        }
    }
    for place in 0..STATES {
        if !places.contains(&place) {
            a.row_mut(place).fill(0.0);
            b[place] = 0.0;
        }
    }
    (a, b)
}

/// x(t) of dx/dt = A x + b by one matrix exponential of the augmented system.
fn propagate(a: &DMatrix<f64>, b: &DVector<f64>, x: &[f64], time: f64) -> DVector<f64> {
    let n = x.len();
    let mut augmented = DMatrix::zeros(n + 1, n + 1);
    augmented.view_mut((0, 0), (n, n)).copy_from(a);
    augmented.view_mut((0, n), (n, 1)).copy_from(b);
    let mut start = DVector::from_element(n + 1, 1.0);
    start.rows_mut(0, n).copy_from_slice(x);
    let end = (augmented * time).exp() * start;
    end.rows(0, n).into_owned()
}

const EVERYTHING: [usize; 7] = [THETA, OMEGA, THETA3, OMEGA3, CURRENT, THETA1, OMEGA1];

fn without_friction(full: bool) -> Rig<f64> {
    let mut rig = common::rig(full, common::law("coulomb"), "");
    rig.motor.coulomb_torque = 0.0;
    rig
}

fn moving() -> [f64; STATES] {
    let mut state = [0.0; STATES];
    state[..7].copy_from_slice(&[0.3, 2.0, -0.4, 1.0, 0.5, 0.1, -1.0]);
    state
}

#[test]
fn frictionless_rigs_follow_the_matrix_exponential() {
    for full in [false, true] {
        let rig = without_friction(full);
        let mut state = moving();
        if !full {
            (state[THETA1], state[OMEGA1]) = (0.0, 0.0);
        }
        let (a, b) = linear(&rig, if full { &EVERYTHING } else { &EVERYTHING[..5] }, 3.0);
        for time in [0.1, 1.0, 5.0] {
            let exact = propagate(&a, &b, &state, time);
            let ours = common::state_after(&rig, state, RigInputs::held(3.0, 0.0, 0.0), time);
            for (x, y) in ours.iter().zip(exact.iter()) {
                assert!(
                    (x - y).abs() < 1e-10,
                    "full {full}, t = {time}: {x} against {y}"
                );
            }
        }
    }
}

#[test]
fn held_disc_and_its_breakaway_follow_the_closed_form() {
    let mut rig = common::rig(false, common::law("stribeck"), "");
    rig.motor.coulomb_torque = 0.0;
    let voltage = 3.0;
    let (a, b) = linear(&rig, &[THETA3, OMEGA3, CURRENT], voltage);
    let start = [0.0; STATES];
    let excess = |time: f64| {
        let x = propagate(&a, &b, &start, time);
        rig.shaft.stiffness * x[THETA3] + rig.shaft.damping * x[OMEGA3] - 50.0 * 0.075 * 0.2
    };
    let (mut low, mut high) = (0.0, 1.0);
    assert!(excess(high) > 0.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if excess(middle) < 0.0 {
            low = middle
        } else {
            high = middle
        }
    }
    let mut run = common::start(&rig, 1e-13, start, RigInputs::held(voltage, 50.0, 0.0)).unwrap();
    let breakaway = loop {
        if let Some(event) = run.pending_switch()
            && matches!(event.guard, Some(RigGuard::Breakaway(Contact::Disc, _)))
        {
            break event.time;
        }
        let middle = 0.5 * (run.segment_start() + run.segment_end());
        let exact = propagate(&a, &b, &start, middle);
        for (x, y) in run.state_at(middle).iter().zip(exact.iter()) {
            assert!((x - y).abs() < 1e-11, "t = {middle}: {x} against {y}");
        }
        run.next_segment().unwrap();
    };
    println!("breakaway at {breakaway} s, closed form {low} s");
    assert!((breakaway - low).abs() < 1e-12, "{breakaway} against {low}");
}

#[test]
fn reversals_and_sticking_of_a_swinging_disc_follow_the_closed_form() {
    // The motor is held by its own friction; the disc swings under Coulomb friction, half a period
    // at a time about a shifted centre, until it stops within the band where friction can hold it.
    let mut rig = common::rig(false, ("coulomb", "mu_c = 0.1"), "");
    rig.motor.coulomb_torque = 10.0;
    let (j, k, c) = (rig.disc.inertia, rig.shaft.stiffness, rig.shaft.damping);
    let friction = 0.1 * 2.0 * 0.075;
    let damped = (k / j - (c / (2.0 * j)).powi(2)).sqrt();
    let shrink = (-c / (2.0 * j) * PI / damped).exp();
    let mut state = [0.0; STATES];
    state[THETA] = 1.0;
    let mut run = common::start(&rig, 1e-13, state, RigInputs::held(0.0, 2.0, 0.0)).unwrap();
    let (mut angle, mut half_periods) = (1.0_f64, 0);
    loop {
        run.next_segment().unwrap();
        let Some(event) = run.pending_switch() else {
            continue;
        };
        assert_eq!(event.guard, Some(RigGuard::Rest(Contact::Disc)));
        half_periods += 1;
        let centre = friction / k * angle.signum();
        angle = centre - (angle - centre) * shrink;
        let exact = f64::from(half_periods) * PI / damped;
        assert!(
            (event.time - exact).abs() < 1e-12,
            "{} against {exact}",
            event.time
        );
        let theta = run.state_at(event.time)[THETA];
        assert!((theta - angle).abs() < 1e-11, "{theta} against {angle}");
        if k * angle.abs() <= friction {
            break;
        }
    }
    assert!(half_periods > 5);
    run.advance_to(60.0).unwrap();
    assert!(run.mode().disc.is_stuck());
    assert!((run.state_at(60.0)[THETA] - angle).abs() < 1e-11);
}

#[test]
fn limits_of_extreme_parameters() {
    // N2 → 0: a contact of a nanonewton is no contact.
    let rig = common::rig(false, common::law("stribeck"), "");
    let none = common::state_after(&rig, [0.0; STATES], RigInputs::held(3.0, 0.0, 0.0), 3.0);
    let hardly = common::state_after(&rig, [0.0; STATES], RigInputs::held(3.0, 1e-8, 0.0), 3.0);
    for (a, b) in none.iter().zip(hardly) {
        assert!((a - b).abs() < 1e-7, "{a} against {b}");
    }
    // Stiffness → large: motor and disc turn as one body.
    let mut stiff = without_friction(false);
    (stiff.shaft.stiffness, stiff.shaft.damping) = (1e7, 1e3);
    let eta = stiff.gearbox.ratio;
    let mut rigid = stiff;
    rigid.motor.inertia += rigid.disc.inertia / (eta * eta);
    let (mut a, b) = linear(&rigid, &[THETA3, OMEGA3, CURRENT], 3.0);
    (a[(OMEGA3, THETA3)], a[(OMEGA3, OMEGA)], a[(OMEGA3, THETA)]) = (0.0, 0.0, 0.0);
    a[(OMEGA3, OMEGA3)] += rigid.shaft.damping / (eta * eta * rigid.motor.inertia);
    let exact = propagate(&a, &b, &[0.0; STATES], 0.5);
    let ours = common::state_after(&stiff, [0.0; STATES], RigInputs::held(3.0, 0.0, 0.0), 0.5);
    for (place, body) in [(THETA, THETA3), (OMEGA, OMEGA3), (CURRENT, CURRENT)] {
        let error = (ours[place] - exact[body]).abs();
        assert!(error < 1e-5, "{} against {}", ours[place], exact[body]);
    }
    // J_m → 0: the motion tends to a limit in proportion to J_m.
    let with_inertia = |inertia: f64| {
        let mut rig = rig;
        rig.motor.inertia = inertia;
        common::state_after(&rig, [0.0; STATES], RigInputs::held(3.0, 30.0, 0.0), 2.0)[THETA]
    };
    let (coarse, fine, finest) = (with_inertia(1e-7), with_inertia(1e-8), with_inertia(1e-9));
    let ratio = (coarse - fine) / (fine - finest);
    assert!(
        (ratio - 10.0).abs() < 0.5,
        "{coarse} {fine} {finest}: ratio {ratio}"
    );
}

#[test]
fn the_error_falls_with_the_order_of_the_method() {
    let rig = without_friction(false);
    let (a, b) = linear(&rig, &EVERYTHING[..5], 3.0);
    let mut state = moving();
    (state[THETA1], state[OMEGA1]) = (0.0, 0.0);
    let exact = propagate(&a, &b, &state, 0.01);
    let error = |order: usize, step: f64| {
        let options = Options {
            // Loose enough that every segment has the longest step.
            tolerance: 1e9,
            order,
            longest_step: step,
            ..Options::default()
        };
        let mut run =
            Simulation::new(rig, options, 0.0, state, RigInputs::held(3.0, 0.0, 0.0)).unwrap();
        run.advance_to(0.01).unwrap();
        let errors = run.state_at(0.01).into_iter().zip(exact.iter());
        errors.map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
    };
    for order in [4, 5, 6] {
        let (coarse, fine) = (error(order, 5e-4), error(order, 2.5e-4));
        let observed = (coarse / fine).log2();
        println!("order {order}: errors {coarse:e}, {fine:e}, observed order {observed:.2}");
        assert!(
            (observed - order as f64).abs() < 0.7,
            "order {order}: {coarse:e} and {fine:e} show {observed}"
        );
    }
}

#[test]
fn the_error_falls_with_the_tolerance() {
    let rig = Rig::from_toml(common::REDUCED_RIG, "reduced-rig.toml").unwrap();
    let inputs = RigInputs::held(rig.voltage_for_speed(5.76), 50.0, 0.0);
    let at = |tolerance: f64| {
        let mut run = common::start(&rig, tolerance, [0.0; STATES], inputs).unwrap();
        run.advance_to(20.0).unwrap();
        run.state_at(20.0)[THETA]
    };
    let exact = at(1e-14);
    for tolerance in [1e-4, 1e-6, 1e-8, 1e-10, 1e-12] {
        let error = (at(tolerance) - exact).abs();
        println!("tolerance {tolerance:e}: error {error:e}");
        assert!(
            error < 10.0 * tolerance,
            "tolerance {tolerance:e}: {error:e}"
        );
    }
}
