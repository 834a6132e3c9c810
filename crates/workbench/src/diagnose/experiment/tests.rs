//! What is proposed tells rivals apart.

use super::*;

use inference::problem::Catalogue;
use inference::record::channel;
use inference::search::fit_effects;
use stickslip::plant::ModelFile;

/// Irregular numbers of mean 0 and deviation 1: sums of twelve uniform ones.
fn noise(state: &mut u64) -> f64 {
    let mut uniform = || {
        *state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (*state >> 11) as f64 / (1_u64 << 53) as f64
    };
    (0..12).map(|_| uniform()).sum::<f64>() - 6.0
}

fn noisy(record: &RawRecord, instruments: &Instruments, seed: u64) -> RawRecord {
    let mut record = record.clone();
    let mut state = seed;
    for (readings, deviation) in record.readings.iter_mut().zip(instruments.deviations()) {
        for reading in readings {
            *reading += deviation * noise(&mut state);
        }
    }
    record
}

#[test]
fn the_proposed_experiment_decides_as_often_as_it_says() {
    crate::diagnose::case::prepare_threads();
    let believed = include_str!("../../../tests/data/unbalance/model.toml");
    let truth = format!("{believed}\n[viscous_drag]\ncoefficient = 0.001\n");
    let model = ModelFile::parse(believed, "believed").unwrap();
    // Sensors so bad that the experiment does not decide with certainty.
    let instruments = Instruments {
        step: [0.0; inference::record::CHANNELS],
        noise: [0.04, 1.1, 0.005, 0.14, 0.0, 0.0, 0.0],
    };
    // Learned from one speed without brake: drag and dry friction of the bearings are the same there.
    let count = 2000;
    let mut learned = RawRecord {
        name: "steady".to_owned(),
        time: (0..=count).map(|j| 0.01 * f64::from(j)).collect(),
        voltage: vec![2.2; count as usize + 1],
        normal_force: vec![0.0; count as usize + 1],
        ..RawRecord::default()
    };
    let mut native = Native::from_text(&truth, "truth").unwrap();
    let rest = [0.0; stickslip::plant::STATES];
    let (readings, _) = course(&mut native, &learned, 0, count as usize, &rest).unwrap();
    learned.readings = readings;
    learned.readings[channel::CURRENT].clear();
    let uncertain = ["disc.inertia", "motor.resistance", "motor.coulomb_torque"]
        .map(|name| (name.to_owned(), 0.02));
    let problem = Problem::new(
        &model.rig,
        uncertain.to_vec(),
        &[noisy(&learned, &instruments, 6)],
        &instruments,
        &Catalogue::default(),
    )
    .unwrap();
    let [drag, bearing] = ["viscous_drag", "bearing_friction"]
        .map(|name| fit_effects(&problem, &[name], &mut |_| {}).unwrap().fit);
    let apart = (drag.loss - bearing.loss).abs();
    assert!(apart < DECISIVE, "told apart already: {apart}");
    let proposal = propose(&problem, &drag, std::slice::from_ref(&bearing))
        .unwrap()
        .unwrap();
    assert!(
        (0.25..0.98).contains(&proposal.power),
        "a power of {} would test nothing",
        proposal.power
    );
    let reach = Reach::of(&problem);
    let candidate = CANDIDATES
        .iter()
        .find(|candidate| {
            let units = &problem.units;
            let description =
                (candidate.description)(reach.voltage * units.voltage(), reach.force * units.force);
            description == proposal.description
        })
        .unwrap();
    let advantage = |record: &RawRecord| {
        let data = cut(&problem, record);
        let left = |fit: &Fit| remaining(&data, &fit.hypothesis, &Disturbance::NONE);
        0.5 * (left(&bearing) - left(&drag))
    };
    let repeats = 12;
    let mut decided = 0;
    for (fit, sign) in [(&drag, 1.0), (&bearing, -1.0)] {
        let rig = fit.hypothesis.rig_at().unwrap();
        let clean = predicted(&problem, &rig, candidate).unwrap();
        decided += (0..repeats)
            .filter(|seed| sign * advantage(&noisy(&clean, &instruments, 100 + seed)) > DECISIVE)
            .count();
    }
    let share = decided as f64 / (2 * repeats) as f64;
    // Three standard deviations of a share of so few.
    let scatter = (proposal.power * (1.0 - proposal.power) / (2 * repeats) as f64).sqrt();
    assert!(
        (share - proposal.power).abs() < 3.0 * scatter,
        "decided {share}, said {}",
        proposal.power
    );
}

#[test]
fn power_grows_from_nothing_to_certainty() {
    assert_eq!(power(0.0), 0.0);
    assert!((power(8.0) - 0.5).abs() < 1e-6);
    assert!(power(100.0) > 0.9999);
    assert!(power(2.0) < 0.05);
}

#[test]
fn error_function_at_known_points() {
    for (x, value) in [
        (0.0, 1.0),
        (1.0, 0.157_299_207),
        (-1.0, 1.842_700_793),
        (2.0, 0.004_677_735),
    ] {
        assert!((complementary_error(x) - value).abs() < 2e-7, "{x}");
    }
}

#[test]
fn stairs_end_on_the_last_step() {
    assert_eq!(stairs(&[1.0, 2.0], 0.0), 1.0);
    assert_eq!(stairs(&[1.0, 2.0], 0.5), 2.0);
    assert_eq!(stairs(&[1.0, 2.0], 1.0), 2.0);
}
