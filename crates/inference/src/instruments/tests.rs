//! Steps and noise are found in readings as instruments and programs make them.

use super::*;
use crate::record::channel::{OMEGA, THETA};
use std::f64::consts::{PI, TAU};

const ENCODER_STEP: f64 = TAU / 1000.0;
const TACHOMETER_NOISE: f64 = 0.05;

/// Normal numbers, always the same.
struct Stream(u64);

impl Stream {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}

fn printed(value: f64, decimals: i32) -> f64 {
    let unit = 10f64.powi(-decimals);
    (value / unit).round() / 10f64.powi(decimals)
}

/// Angle [rad] and velocity [rad/s] of a disc that sticks for two fifths of each period of 1 s and slips in between, with
/// acceleration jumping at breakaway and at sticking.
fn stick_slip(time: f64) -> (f64, f64) {
    const TOP_SPEED: f64 = 10.0;
    const SLIP: f64 = 0.6;
    let turn = TOP_SPEED * 2.0 * SLIP / PI;
    let share = ((time.fract() - (1.0 - SLIP)) / SLIP).max(0.0);
    let angle = turn * (time.floor() + 0.5 * (1.0 - (PI * share).cos()));
    (angle, TOP_SPEED * (PI * share).sin())
}

/// Readings of `periods` periods of stick-slip: a rounding encoder (with noise before it rounds) and a noisy tachometer,
/// printed with 5 decimals.
fn record(samples_per_period: f64, periods: f64, encoder_noise: f64, seed: u64) -> RawRecord {
    let mut stream = Stream(seed);
    let mut record = RawRecord::default();
    for k in 0..(periods * samples_per_period) as usize {
        let time = k as f64 / samples_per_period;
        let (angle, velocity) = stick_slip(time);
        let angle = angle + encoder_noise * stream.normal();
        record.time.push(time);
        record.readings[THETA].push(printed((angle / ENCODER_STEP).floor() * ENCODER_STEP, 5));
        record.readings[OMEGA].push(printed(velocity + TACHOMETER_NOISE * stream.normal(), 5));
    }
    record
}

fn assert_near(value: f64, truth: f64, share: f64) {
    assert!(
        (value / truth - 1.0).abs() <= share,
        "{value} instead of {truth}"
    );
}

#[test]
fn step_and_noise_are_found_at_few_and_at_many_samples_per_period() {
    for (samples, periods, share) in [(30.7, 60.0, 0.1), (300.7, 20.0, 0.05)] {
        for seed in 0..5 {
            let found = estimate(&[
                record(samples, 0.6 * periods, 0.0, seed),
                record(samples, 0.4 * periods, 0.0, seed + 100),
            ]);
            assert_near(found.step[THETA], ENCODER_STEP, 1e-3);
            assert!(found.noise[THETA] <= 0.0, "{found:?}");
            assert!(found.step[OMEGA] <= 0.0, "{found:?}");
            assert_near(found.noise[OMEGA], TACHOMETER_NOISE, share);
            assert!(found.deviations()[2..].iter().all(|x| *x <= 0.0));
        }
    }
}

#[test]
fn noise_before_an_encoder_rounds_is_told_from_its_step() {
    let found = estimate(&[record(300.7, 20.0, 0.8 * ENCODER_STEP, 7)]);
    assert_near(found.step[THETA], ENCODER_STEP, 1e-3);
    assert_near(found.noise[THETA], 0.8 * ENCODER_STEP, 0.1);
    // A step far below the noise is a part of it.
    let found = estimate(&[record(300.7, 20.0, 4.0 * ENCODER_STEP, 7)]);
    assert!(found.step[THETA] <= 0.0);
    assert_near(found.noise[THETA], 4.0 * ENCODER_STEP, 0.05);
}

#[test]
fn round_numbers_do_not_hide_a_step() {
    let times: Vec<f64> = (0..400).map(f64::from).collect();
    for step in [0.25, 10.0] {
        let readings: Vec<f64> = times
            .iter()
            .map(|t| step * (40.0 * (0.1 * t).sin()).floor())
            .collect();
        assert_near(step_and_noise(&[(&times, &readings)]).0, step, 1e-9);
    }
}

#[test]
fn steps_are_found_where_motion_is_always_fast() {
    // Fourteen to seventeen steps from sample to sample.
    let angle = |k: usize| 0.1 * k as f64 + 0.02 * (0.37 * k as f64).sin();
    let readings: Vec<f64> = (0..400)
        .map(|k| printed((angle(k) / ENCODER_STEP).floor() * ENCODER_STEP, 6))
        .collect();
    let times: Vec<f64> = (0..400).map(f64::from).collect();
    let (step, noise) = step_and_noise(&[(&times, &readings)]);
    assert_near(step, ENCODER_STEP, 1e-4);
    assert!(noise <= 0.0);
}

#[test]
fn times_that_jitter_do_not_pass_for_noise() {
    let mut stream = Stream(9);
    let mut jittering = RawRecord::default();
    for k in 0..6000 {
        let time = (f64::from(k) + 0.6 * (stream.uniform() - 0.5)) / 300.7;
        let (_, velocity) = stick_slip(time);
        jittering.time.push(time);
        jittering.readings[OMEGA].push(velocity + 0.2 * TACHOMETER_NOISE * stream.normal());
    }
    let found = estimate(&[jittering]);
    assert_near(found.noise[OMEGA], 0.2 * TACHOMETER_NOISE, 0.1);
}

#[test]
fn a_step_is_found_among_readings_of_so_many_digits_or_bits() {
    let plain = record(300.7, 20.0, 0.0, 4);
    let written: [fn(f64) -> f64; 4] = [
        |x| format!("{x:.5e}").parse().unwrap(),
        |x| format!("{x:.8e}").parse().unwrap(),
        |x| f64::from(x as f32),
        |x| (x as f32).to_string().parse().unwrap(),
    ];
    for write in written {
        let mut stream = Stream(4);
        let mut rounded = plain.clone();
        for reading in &mut rounded.readings[THETA] {
            *reading = write((*reading / ENCODER_STEP).round() * ENCODER_STEP);
        }
        for reading in &mut rounded.readings[OMEGA] {
            *reading = write(*reading + 1e-3 * stream.normal());
        }
        let found = estimate(&[rounded]);
        assert_near(found.step[THETA], ENCODER_STEP, 1e-3);
        assert_near(found.noise[OMEGA], TACHOMETER_NOISE, 0.1);
    }
}

#[test]
fn multiplying_a_channel_multiplies_its_step_and_noise() {
    let plain = record(100.3, 20.0, 0.0, 3);
    let found = estimate(std::slice::from_ref(&plain));
    for factor in [1e-6, 0.3, 57.3, 1e9] {
        let mut scaled = plain.clone();
        for x in scaled.readings.iter_mut().flatten() {
            *x *= factor;
        }
        let seen = estimate(&[scaled]);
        assert_near(seen.step[THETA], factor * found.step[THETA], 1e-9);
        assert_near(seen.noise[OMEGA], factor * found.noise[OMEGA], 1e-9);
        assert!(seen.noise[THETA] <= 0.0 && seen.step[OMEGA] <= 0.0);
    }
}

#[test]
fn noise_of_the_load_cell_is_zero_where_it_is_constant_or_missing() {
    let mut stream = Stream(11);
    let noisy: Vec<f64> = (0..2000)
        .map(|_| printed(50.0 + 0.2 * stream.normal(), 3))
        .collect();
    let off = vec![0.0; 2000];
    let times: Vec<f64> = (0..2000).map(f64::from).collect();
    assert_near(load_noise(&[(&times, &noisy), (&times, &off)]), 0.2, 0.05);
    assert!(load_noise(&[(&times, &off)]) <= 0.0);
    let few = [
        (&times[..0], &[][..]),
        (&[0.0], &[1.0]),
        (&times[..3], &[f64::NAN; 3]),
    ];
    assert!(load_noise(&few) <= 0.0);
    assert!(load_noise(&[]) <= 0.0);
}

#[test]
fn contradictions_say_both_numbers() {
    let found = estimate(&[record(300.7, 20.0, 0.0, 5)]);
    let mut stated = found;
    stated.noise[3] = 0.1; // nothing was measured there
    assert!(contradictions(&stated, &found).is_empty());
    stated.noise[OMEGA] = 0.2 * TACHOMETER_NOISE;
    let told = contradictions(&stated, &found);
    assert_eq!(told.len(), 1);
    assert_eq!(told[0].channel, OMEGA);
    let text = told[0].to_string();
    assert!(
        text.contains("1.000e-2 rad/s") && text.contains("angular velocity of the disc"),
        "{text}"
    );
    stated.noise[OMEGA] = 5.0 * TACHOMETER_NOISE;
    stated.step[THETA] = 2.0 * ENCODER_STEP;
    assert_eq!(contradictions(&stated, &found).len(), 2);
}
