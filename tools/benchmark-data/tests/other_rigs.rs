//! Cases on rigs of any size: the simulation converges, the draws cover their ranges.

#![allow(clippy::unwrap_used, reason = "tests")]

use benchmark_data::excitation::Excitation;
use benchmark_data::other_rigs::case::{DrawnCase, OtherCase, RigChoice};
use benchmark_data::other_rigs::drawing::Draws;
use benchmark_data::other_rigs::plan::{OtherWish, Sort, kinds};
use benchmark_data::other_rigs::runs::MOST_SAMPLES;
use benchmark_data::random::{Purpose, Stream};
use benchmark_data::recipe::Kind;
use benchmark_data::simulator::{Sample, Simulator, State};
use core::f64::consts::TAU;

fn kind(name: &str) -> Kind {
    kinds(Sort::Single, false)
        .into_iter()
        .find(|kind| kind.name == name)
        .unwrap()
}

/// The first case from `seed` on whose rig is as wanted.
fn case_with(seed: u64, kind_name: &str, wanted: fn(&DrawnCase) -> bool) -> DrawnCase {
    (seed..seed + 1000)
        .map(|seed| OtherCase {
            kind: kind(kind_name),
            seed,
            ..OtherCase::default()
        })
        .filter(|case| {
            // Only those worth the trouble of a trial.
            let draws = Draws::draw(&mut Stream::new(case.seed, Purpose::Rig));
            (draws.inertia > 100.0 && draws.frequency < 0.4)
                || (draws.inertia < 1e-3 && draws.frequency > 4.0)
        })
        .map(|case| case.draw().unwrap())
        .find(wanted)
        .unwrap()
}

fn heavy_and_slow(case: &DrawnCase) -> bool {
    case.rig.believed.disc_inertia > 100.0 && case.rig.period > 2.5
}

fn light_and_fast(case: &DrawnCase) -> bool {
    case.rig.believed.disc_inertia < 1e-3 && case.rig.period < 0.25
}

/// Root mean square differences of the four channels over what the instruments show of them.
fn differences(case: &DrawnCase, one: &[Sample], other: &[Sample]) -> [f64; 4] {
    let tools = &case.instruments;
    let seen = |pick: fn(&Sample) -> f64, noise: f64| {
        let square = |(a, b): (&Sample, &Sample)| {
            let difference = (pick(a) - pick(b)) / noise;
            difference * difference
        };
        libm::sqrt(one.iter().zip(other).map(square).sum::<f64>() / one.len() as f64)
    };
    let rounding = 1.0 / libm::sqrt(12.0);
    [
        seen(|s| s.state.disc_angle, tools.disc_encoder_step * rounding),
        seen(|s| s.state.disc_speed, tools.disc_speed),
        seen(
            |s| s.state.gearbox_angle,
            tools.gear_encoder_step * rounding,
        ),
        seen(|s| s.state.gearbox_speed, tools.gearbox_speed),
    ]
}

fn assert_converged(case: &DrawnCase) {
    let (right, finer) = (case.numerics(1.0), case.numerics(0.5));
    assert!(finer.step < 0.51 * right.step);
    for index in 0..case.runs.len() {
        let one = case.simulate(index, &right).unwrap();
        let other = case.simulate(index, &finer).unwrap();
        let found = differences(case, &one, &other);
        assert!(
            found.iter().all(|d| *d < 0.3),
            "{}: {found:?}",
            case.runs[index].file
        );
    }
}

#[test]
fn half_the_step_changes_nothing_that_instruments_show_on_a_heavy_slow_rig() {
    assert_converged(&case_with(610_000, "unbalance", heavy_and_slow));
}

#[test]
fn half_the_step_changes_nothing_that_instruments_show_on_a_light_fast_rig() {
    assert_converged(&case_with(611_000, "viscous_drag", light_and_fast));
}

#[test]
fn cases_stick_at_some_points_slide_at_others_and_stay_short() {
    for kind in kinds(Sort::Single, false) {
        let case = OtherCase {
            kind,
            seed: 612_000,
            ..OtherCase::default()
        };
        let drawn = case.draw().unwrap();
        assert!(drawn.motion.sliding >= 1.5, "{}", case.kind.name);
        let stiction = drawn.truth.law.breakaway() > 1.05 * drawn.laws.levels.sliding;
        assert!(!stiction || drawn.motion.phases >= 2, "{}", case.kind.name);
        let samples: usize = drawn.runs.iter().map(|r| r.excitation.voltage.len()).sum();
        assert!(samples as f64 <= MOST_SAMPLES, "{samples}");
    }
}

#[test]
fn draws_cover_their_ranges_and_stay_inside() {
    type Pick = fn(&Draws) -> f64;
    let ranges: [(Pick, f64, f64); 9] = [
        (|d| d.inertia, 1e-4, 1e3),
        (|d| d.frequency, 0.1, 10.0),
        (|d| d.damping_ratio, 0.002, 0.05),
        (|d| d.gear_ratio, 1.0, 20.0),
        (|d| d.motor_inertia, 0.05, 0.5),
        (|d| d.droop, 0.02, 0.2),
        (|d| d.motor_coulomb, 0.02, 0.2),
        (|d| d.top_speed, 0.5, 4.0),
        (|d| d.drop, 0.15, 0.8),
    ];
    let draws: Vec<Draws> = (0..500)
        .map(|seed| Draws::draw(&mut Stream::new(seed, Purpose::Rig)))
        .collect();
    for (index, (pick, low, high)) in ranges.into_iter().enumerate() {
        let least = draws.iter().map(pick).fold(f64::INFINITY, f64::min);
        let most = draws.iter().map(pick).fold(0.0, f64::max);
        let margin = libm::pow(high / low, 0.02);
        assert!((low..low * margin).contains(&least), "{index}: {least}");
        assert!((high / margin..=high).contains(&most), "{index}: {most}");
    }
}

#[test]
fn drawn_rigs_are_motors_that_can_drive_them() {
    for seed in 0..60 {
        let case = OtherCase {
            seed,
            ..OtherCase::default()
        };
        let drawn = case.draw().unwrap();
        let rig = &drawn.rig.believed;
        let constants = rig.torque_constant / rig.back_emf_constant;
        assert!((0.955..1.045).contains(&constants), "{constants}");
        let electrical = rig.inductance / rig.resistance / drawn.rig.period;
        assert!((0.0019..0.0501).contains(&electrical), "{electrical}");
        let samples = drawn.rig.period / drawn.layout.interval;
        assert!((30.0..301.0).contains(&samples), "{samples}");
        let load = 1.7 * drawn.rig.middle_load;
        let (loaded, free) = (
            drawn.rig.voltage(drawn.rig.top_speed, load),
            drawn.rig.believed.back_emf_constant * rig.gear_ratio * drawn.rig.top_speed,
        );
        let droop = loaded / free - 1.0;
        assert!((0.019..0.201).contains(&droop), "{droop}");
    }
}

#[test]
fn two_discs_swing_at_the_frequencies_of_the_pair() {
    let case = OtherCase {
        rig: RigChoice::Full,
        seed: 613_000,
        ..OtherCase::default()
    };
    let mut drawn = case.draw().unwrap();
    let disc1 = drawn.truth.disc1.as_mut().unwrap();
    disc1.shaft_damping = 0.0;
    let (inertia1, stiffness1) = (disc1.inertia, disc1.shaft_stiffness);
    drawn.truth.parameters.shaft_damping = 0.0;
    let parameters = drawn.truth.parameters;
    let (inertia2, stiffness2) = (parameters.disc_inertia, parameters.shaft_stiffness);
    // J1 J2 ω⁴ − (J1 (k1 + k2) + J2 k1) ω² + k1 k2 = 0, the slower mode.
    let (a, c) = (inertia1 * inertia2, stiffness1 * stiffness2);
    let b = inertia1 * (stiffness1 + stiffness2) + inertia2 * stiffness1;
    let square = (b - libm::sqrt(b * b - 4.0 * a * c)) / (2.0 * a);
    let expected = TAU / libm::sqrt(square);
    // In its shape, and so gently that the motor holds.
    let twist = 0.2 * parameters.gear_ratio * parameters.motor_coulomb_torque / stiffness2;
    let start = State {
        disc_angle: twist,
        disc1_angle: twist * stiffness1 / (stiffness1 - inertia1 * square),
        ..State::default()
    };
    let numerics = drawn.numerics(1.0);
    let count = (8.0 * expected / drawn.layout.interval) as usize;
    let inputs = Excitation {
        voltage: vec![0.0; count],
        normal_force: vec![0.0; count],
        disc1_force: vec![0.0; count],
    };
    let noise = Stream::new(1, Purpose::Contact(0));
    let samples = Simulator::with_numerics(&drawn.truth, &numerics, start, noise)
        .run(&inputs)
        .unwrap();
    let angles: Vec<f64> = samples.iter().map(|s| s.state.disc_angle).collect();
    let crossings: Vec<f64> = angles
        .windows(2)
        .enumerate()
        .filter(|(_, pair)| pair[0] > 0.0 && pair[1] <= 0.0)
        .map(|(index, pair)| index as f64 + pair[0] / (pair[0] - pair[1]))
        .collect();
    let swings = (crossings.len() - 1) as f64;
    let period = (crossings[crossings.len() - 1] - crossings[0]) / swings * drawn.layout.interval;
    assert!(
        (period / expected - 1.0).abs() < 2e-4,
        "{period} {expected}"
    );
}

#[test]
fn sets_of_effects_can_be_parted() {
    let pairs = kinds(Sort::Pair, false);
    assert_eq!(pairs.len(), 149);
    let triples = kinds(Sort::Triple, false);
    assert!(triples.len() > 600, "{}", triples.len());
    for kind in &triples {
        let laws = kind
            .effects
            .iter()
            .filter(|(effect, _)| effect.replaced_law().is_some());
        assert!(laws.count() <= 1, "{}", kind.name);
    }
    assert_eq!(kinds(Sort::Single, true).len(), 12);
}

#[test]
fn seeds_of_the_suites_are_refused() {
    let wish = OtherWish {
        seed: 20_000,
        cases: 1,
        sort: Sort::Clean,
        kind: None,
        common: OtherCase::default(),
    };
    assert!(wish.plan().is_err());
}
