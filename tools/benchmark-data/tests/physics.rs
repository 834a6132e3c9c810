//! The simulator against closed forms.

#![allow(clippy::unwrap_used, reason = "tests")]

use benchmark_data::effects::Effects;
use benchmark_data::excitation::{Excitation, SAMPLE_INTERVAL};
use benchmark_data::law::ContactLaw;
use benchmark_data::random::{Purpose, Stream};
use benchmark_data::rig::NOMINAL;
use benchmark_data::simulator::{Sample, Simulator, State, TrueRig};
use core::f64::consts::TAU;

fn rig(effects: Effects) -> TrueRig {
    TrueRig {
        parameters: NOMINAL,
        law: ContactLaw::Stribeck {
            mu_c: 0.12,
            mu_s: 0.2,
            omega_s: 1.2,
        },
        effects,
        disc1: None,
    }
}

fn constant(seconds: f64, voltage: f64, normal_force: f64) -> Excitation {
    let count = (seconds / SAMPLE_INTERVAL) as usize + 1;
    Excitation {
        voltage: vec![voltage; count],
        normal_force: vec![normal_force; count],
        ..Excitation::default()
    }
}

fn run(rig: &TrueRig, start: State, inputs: &Excitation) -> Vec<Sample> {
    let noise = Stream::new(5, Purpose::Contact(0));
    Simulator::new(rig, start, noise).run(inputs).unwrap()
}

/// K_T i = T_fm + (C_m η ω + load/η), i = (u − K_E η ω)/R.
fn steady_speed(voltage: f64, load: impl Fn(f64) -> f64) -> f64 {
    let surplus = |speed: f64| {
        let motor_speed = NOMINAL.gear_ratio * speed;
        let current = (voltage - NOMINAL.back_emf_constant * motor_speed) / NOMINAL.resistance;
        NOMINAL.torque_constant * current
            - NOMINAL.motor_coulomb_torque
            - NOMINAL.motor_viscous_damping * motor_speed
            - load(speed) / NOMINAL.gear_ratio
    };
    let (mut low, mut high) = (0.0, 20.0);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if surplus(middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

#[test]
fn without_brake_the_rig_settles_at_the_speed_of_the_torque_balance() {
    // Ten times the shaft damping: the swing of the disc has died after a minute.
    let mut damped = rig(Effects::default());
    damped.parameters.shaft_damping *= 10.0;
    let samples = run(&damped, State::default(), &constant(60.0, 2.5, 0.0));
    let speed = samples.last().unwrap().state.disc_speed;
    let expected = steady_speed(2.5, |_| 0.0);
    assert!((speed - expected).abs() < 1e-6, "{speed} {expected}");
}

#[test]
fn drags_and_steady_friction_shift_the_settled_speed_as_they_should() {
    let hidden = Effects {
        visc: 0.008,
        quad: 0.0012,
        bearing_T: 0.05,
        ..Effects::default()
    };
    let load = |speed: f64| 0.05 + 0.008 * speed + 0.0012 * speed * speed;
    let samples = run(&rig(hidden), State::default(), &constant(60.0, 2.5, 0.0));
    let speed = samples.last().unwrap().state.disc_speed;
    assert!((speed - steady_speed(2.5, load)).abs() < 1e-5, "{speed}");
}

#[test]
fn the_motor_starts_as_its_differential_equations_say() {
    // Without dry friction in the motor and with the disc held they are linear; Runge and Kutta's fourth order.
    let ratio = NOMINAL.gear_ratio;
    let inertia = ratio * ratio * NOMINAL.motor_inertia;
    let voltage = 2.0;
    let rate = |[angle, speed, current]: [f64; 3]| {
        let motor =
            NOMINAL.torque_constant * current - NOMINAL.motor_viscous_damping * ratio * speed;
        let shaft = NOMINAL.shaft_stiffness * angle + NOMINAL.shaft_damping * speed;
        let drop = NOMINAL.resistance * current + NOMINAL.back_emf_constant * ratio * speed;
        [
            speed,
            (ratio * motor - shaft) / inertia,
            (voltage - drop) / NOMINAL.inductance,
        ]
    };
    let moved = |x: [f64; 3], k: [f64; 3], h: f64| [0, 1, 2].map(|j| x[j] + h * k[j]);
    let steps = 10_000;
    let h = SAMPLE_INTERVAL / f64::from(steps);
    let mut x = [0.0; 3];
    for _ in 0..steps {
        let k1 = rate(x);
        let k2 = rate(moved(x, k1, 0.5 * h));
        let k3 = rate(moved(x, k2, 0.5 * h));
        let k4 = rate(moved(x, k3, h));
        x = [0, 1, 2].map(|j| x[j] + h / 6.0 * (k1[j] + 2.0 * k2[j] + 2.0 * k3[j] + k4[j]));
    }
    let mut free = rig(Effects::default());
    free.parameters.motor_coulomb_torque = 0.0;
    let inputs = constant(2.0 * SAMPLE_INTERVAL, voltage, 50.0);
    let reached = run(&free, State::default(), &inputs)[1].state;
    let reached = [
        reached.gearbox_angle,
        reached.gearbox_speed,
        reached.current,
    ];
    for (reached, expected) in reached.iter().zip(x) {
        assert!(
            (reached / expected - 1.0).abs() < 1e-4,
            "{reached} {expected}"
        );
    }
}

#[test]
fn the_disc_swings_at_its_natural_frequency_when_the_motor_holds() {
    let start = State {
        disc_angle: 1.0,
        ..State::default()
    };
    let samples = run(&rig(Effects::default()), start, &constant(12.0, 0.0, 0.0));
    let crossings: Vec<f64> = samples
        .windows(2)
        .enumerate()
        .filter(|(_, pair)| pair[0].state.disc_angle > 0.0 && pair[1].state.disc_angle <= 0.0)
        .map(|(index, pair)| {
            let (before, after) = (pair[0].state.disc_angle, pair[1].state.disc_angle);
            (index as f64 + before / (before - after)) * SAMPLE_INTERVAL
        })
        .collect();
    let cycles = (crossings.len() - 1) as f64;
    let period = (crossings[crossings.len() - 1] - crossings[0]) / cycles;
    let decay = 0.5 * NOMINAL.shaft_damping / NOMINAL.disc_inertia;
    let undamped = NOMINAL.shaft_stiffness / NOMINAL.disc_inertia;
    let expected = TAU / libm::sqrt(undamped - decay * decay);
    assert!((period - expected).abs() < 1e-4, "{period} {expected}");
}

#[test]
fn coulomb_friction_takes_four_t_over_k_from_each_swing() {
    let hidden = Effects {
        bearing_T: 0.02,
        ..Effects::default()
    };
    let mut undamped = rig(hidden);
    undamped.parameters.shaft_damping = 0.0;
    let start = State {
        disc_angle: 1.5,
        ..State::default()
    };
    let samples = run(&undamped, start, &constant(6.0, 0.0, 0.0));
    let peaks: Vec<f64> = samples
        .windows(3)
        .map(|three| three.iter().map(|s| s.state.disc_angle).collect::<Vec<_>>())
        .filter(|angles| angles[1] > angles[0] && angles[1] > angles[2] && angles[1] > 0.3)
        .map(|angles| angles[1])
        .collect();
    let loss = 4.0 * 0.02 / NOMINAL.shaft_stiffness;
    for (index, peak) in peaks.iter().enumerate() {
        let expected = 1.5 - loss * (index + 1) as f64;
        assert!((peak - expected).abs() < 2e-3, "{peaks:?}");
    }
    assert!(peaks.len() >= 3);
}

#[test]
fn a_stuck_disc_stays_far_below_one_encoder_step_until_breakaway() {
    let rig = rig(Effects::default());
    let samples = run(&rig, State::default(), &constant(2.0, 1.6, 30.0));
    let breakaway_twist = 0.2 * 30.0 * NOMINAL.contact_radius / NOMINAL.shaft_stiffness;
    let mut stuck = 0;
    for sample in &samples {
        let state = sample.state;
        if state.gearbox_angle - state.disc_angle > 0.97 * breakaway_twist {
            break;
        }
        assert!(state.disc_angle.abs() < 1e-5, "{state:?}");
        stuck += 1;
    }
    assert!(stuck > 30, "only {stuck} samples stuck");
    assert!(samples.last().unwrap().state.disc_angle > 1.0);
}

#[test]
fn random_friction_shakes_the_disc_in_proportion_to_its_strength() {
    let inputs = constant(10.0, 3.1, 10.0);
    let disc_speeds = |stoch_std: f64| -> Vec<f64> {
        let hidden = Effects {
            stoch_std,
            ..Effects::default()
        };
        let samples = run(&rig(hidden), State::default(), &inputs);
        samples.iter().map(|s| s.state.disc_speed).collect()
    };
    let smooth = disc_speeds(0.0);
    let shaking = |stoch_std: f64| {
        let rough = disc_speeds(stoch_std);
        let square = |(a, b): (&f64, &f64)| (a - b) * (a - b);
        libm::sqrt(rough.iter().zip(&smooth).map(square).sum::<f64>() / smooth.len() as f64)
    };
    let (weak, strong) = (shaking(0.01), shaking(0.02));
    assert!(weak > 1e-3, "{weak}");
    assert!((strong / weak - 2.0).abs() < 0.1, "{weak} {strong}");
}
