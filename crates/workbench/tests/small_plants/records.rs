//! Small plants and their records, integrated step by step with what is hidden in them.

use std::f64::consts::TAU;
use std::fmt::Write as _;

use inference::random::Random;

pub const DRIVE: &str = r#"
[plant]
kind = "drive"
path = "line"
[columns]
time = { column = "t", unit = "ms" }
position = { column = "x", unit = "mm" }
force = { column = "volt", unit = "V", factor = 4.0 }
[measurement]
motion_low_pass = 20.0
compare_low_pass = 10.0
compare_rate = 40.0
edge = 0.2
[drive]
inertia = { value = 9.0, unit = "kg" }
viscous = 25.0
offset = 0.0
"#;

/// A drive's record: inertia 10 kg, viscous friction 20 N s/m, dry friction as given.
pub fn drive(dry: f64, seed: u64) -> String {
    driven(dry, |force| force, seed)
}

/// The same where the recorded force is a function of the one that acts.
pub fn driven(dry: f64, recorded: impl Fn(f64) -> f64, seed: u64) -> String {
    sampled(dry, recorded, 0.0, seed)
}

/// A record of the same drive with dry friction of 5 N, whose position is read so much later than its force [s].
pub fn read_late(delay: f64, seed: u64) -> String {
    sampled(5.0, |force| force, delay, seed)
}

fn sampled(dry: f64, recorded: impl Fn(f64) -> f64, delay: f64, seed: u64) -> String {
    let mut random = Random::new(seed);
    let phase = TAU * random.uniform();
    let mut text = String::from("t,x,volt\n");
    let parts = [(0.1, 0.31), (0.04, 0.83), (0.015, 1.7)];
    for at in 0..6000 {
        let time = f64::from(at) * 0.004;
        let (mut x, mut v, mut a) = (0.0, 0.0, 0.0);
        for (size, hertz) in parts {
            let (rate, angle) = (TAU * hertz, TAU * hertz * time + phase * hertz);
            x += size * (angle - rate * delay).sin();
            v += size * rate * angle.cos();
            a -= size * rate * rate * angle.sin();
        }
        let force = recorded(10.0 * a + 20.0 * v + dry * f64::signum(v)) + 0.4 * random.normal();
        let reading = x + 1e-6 * random.normal();
        line(&mut text, time, reading, force);
    }
    text
}

/// A record of the same drive under a force that a controller holds from each sample to the next: about a sample it is half the one before
/// and half its own, so that the motion is half a sample behind the column.
pub fn held(dry: f64, seed: u64) -> String {
    let mut random = Random::new(seed);
    let phase = TAU * random.uniform();
    let mut text = String::from("t,x,volt\n");
    for at in 0..6000 {
        let (mut x, mut force, mut v) = (0.0, 0.0, 0.0);
        for (size, hertz) in [(0.1, 0.31), (0.04, 0.83), (0.015, 1.7)] {
            let rate = TAU * hertz;
            let angle = |part: f64| rate * 0.004 * (f64::from(at) + part) + phase * hertz;
            x += size * angle(0.0).sin();
            let (sine, cosine) = angle(0.5).sin_cos();
            v += size * rate * cosine;
            force += size * rate * (20.0 * cosine - 10.0 * rate * sine);
        }
        force += dry * f64::signum(v) + 0.02 * random.normal();
        line(
            &mut text,
            0.004 * f64::from(at),
            x + 1e-6 * random.normal(),
            force,
        );
    }
    text
}

/// A record of the same drive that stops and goes; while it rests, its dry friction of 12 N takes a force that changes.
pub fn stopping(seed: u64) -> String {
    let mut random = Random::new(seed);
    let phase = TAU * random.uniform();
    let mut text = String::from("t,x,volt\n");
    let rate = TAU * 0.4;
    let mut x = 0.0;
    for at in 0..6000 {
        let time = f64::from(at) * 0.004;
        let (sine, cosine) = (rate * time + phase).sin_cos();
        let beyond = (sine.abs() - 0.4).max(0.0);
        let v = 0.3 * beyond * beyond * sine.signum();
        let a = 0.6 * beyond * rate * cosine;
        x += 0.004 * v;
        let friction = if v == 0.0 {
            9.0 * (7.0 * time).sin()
        } else {
            12.0 * v.signum()
        };
        let force = 10.0 * a + 20.0 * v + friction + 0.1 * random.normal();
        line(&mut text, time, x - 0.002 * v, force);
    }
    text
}

fn line(text: &mut String, time: f64, position: f64, force: f64) {
    let _ = writeln!(
        text,
        "{:.1},{:.6},{:.6}",
        1e3 * time,
        1e3 * position,
        force / 4.0
    );
}

pub const CONTACT: &str = r#"
[plant]
kind = "contact"
path = "turn"
[columns]
time = { column = "t", unit = "s" }
velocity = { column = "speed", unit = "rpm" }
force = { column = "torque", unit = "N m" }
[measurement]
motion_low_pass = 10.0
compare_rate = 100.0
standstill_speed = 0.3
[contact]
sliding = 1.2
breakaway = 2.2
speed = 4.0
"#;

/// A contact's record: a law in the speed, or two Gaussians over the angle α about 8 rad/s and 60 rad/s².
pub fn contact(hysteretic: bool, seed: u64) -> String {
    let mut random = Random::new(seed);
    let phase = TAU * random.uniform();
    let mut text = String::from("t,speed,torque\n");
    for at in 0..2400 {
        let time = f64::from(at) * 0.01;
        let rate = TAU * 1.1;
        let size = 6.0 + 1.5 * (TAU * 0.13 * time + phase).sin();
        let omega = 8.0 + size * (rate * time).sin();
        let alpha = size * rate * (rate * time).cos();
        let angle = f64::atan2(alpha / 60.0, (omega - 8.0) / 8.0);
        let bell = |height: f64, place: f64, width: f64| {
            height * (-((angle - place) / width).powi(2)).exp()
        };
        let torque = if hysteretic {
            bell(2.0, -2.4, 1.6) + bell(2.2, 2.4, 2.0)
        } else {
            1.0 + 1.4 * (-omega / 5.0).exp()
        };
        let _ = writeln!(
            text,
            "{time:.3},{:.5},{:.6}",
            60.0 / TAU * (omega + 0.01 * random.normal()),
            torque + 0.05 * random.normal()
        );
    }
    text
}

pub const PENDULUM: &str = r#"
[plant]
kind = "pendulum"
path = "turn"
[columns]
time = { column = "t", unit = "s" }
position = { column = "angle", unit = "deg" }
[measurement]
motion_low_pass = 20.0
compare_low_pass = 10.0
compare_rate = 100.0
edge = 0.2
[pendulum]
stiffness = 40.5
rest = 0.01
viscous = 0.05
"#;

/// A pendulum's swing from 1.4 rad: stiffness 40 1/s², viscous drag as given, dry friction and drag with the square of speed.
pub fn pendulum(viscous: f64, dry: f64, square: f64, seed: u64) -> String {
    pendulum_read(viscous, dry, square, seed, 0.0)
}

/// The same swing, read by an encoder off the axis: `off`·cos of the angle too little [rad].
pub fn pendulum_read(viscous: f64, dry: f64, square: f64, seed: u64, off: f64) -> String {
    let mut random = Random::new(seed);
    let mut text = String::from("t,angle\n");
    let (mut x, mut v): (f64, f64) = (1.4, 0.0);
    let step = 1e-5;
    for at in 0..2_000_000 {
        if at % 1000 == 0 {
            let reading = x - off * x.cos() + 2e-4 * random.normal();
            let _ = writeln!(
                text,
                "{:.2},{:.6}",
                f64::from(at) * step,
                reading * 360.0 / TAU
            );
        }
        v -= step * (40.0 * x.sin() + viscous * v + dry * v.signum() + square * v * v.abs());
        x += step * v;
    }
    text
}

pub const ARM: &str = include_str!("../../../../docs/examples/arm.toml");

/// An arm that a motor turns, at uneven steps of some 5 ms: stiffness 75 1/s², viscous drag 1.2 1/s, gain 16 rad/(s² V), back EMF 6 1/s,
/// terminals open for the last fifth. `friction` is the friction from the motor's torque and the weight's moment.
pub fn arm(friction: impl Fn(f64, f64) -> f64, seed: u64) -> String {
    let mut random = Random::new(seed);
    let waves: Vec<[f64; 3]> = [0.9, 2.3, 5.1]
        .iter()
        .map(|rate| {
            [
                rate * (1.0 + 0.1 * random.normal()),
                TAU * random.uniform(),
                0.2,
            ]
        })
        .collect();
    let mut text = String::from("time,position,pwm,input_volts,torque_enable\n");
    let (mut x, mut v, mut next): (f64, f64, f64) = (0.0, 0.0, 0.0);
    let step = 1e-4;
    for at in 0..240_000 {
        let time = f64::from(at) * step;
        let connected = if time < 19.2 { 1.0 } else { 0.0 };
        let share: f64 = waves
            .iter()
            .map(|[rate, phase, size]| size * (rate * time + phase).sin())
            .sum();
        let duty = (885.0 * share.clamp(-1.0, 1.0)).round() * connected;
        if time >= next {
            next += 0.005 * (1.0 + 0.2 * (random.uniform() - 0.5));
            let reading = ((x + 1e-4 * random.normal()) * 4096.0 / TAU).round() * TAU / 4096.0;
            let _ = writeln!(text, "{time:.5},{reading:.6},{duty},7.4,{connected}");
        }
        let motor = connected * (16.0 * duty / 885.0 * 7.4 - 6.0 * v);
        let weight = 75.0 * x.sin();
        let free = v + step * (motor - weight - 1.2 * v);
        let braked = step * friction(motor, weight);
        v = if free.abs() <= braked {
            0.0
        } else {
            free - braked.copysign(free)
        };
        x += step * v;
    }
    text
}

pub const BALANCE: &str = include_str!("../../../../docs/examples/joint.toml");

/// A joint's torque beside what its model predicts; `hidden` acts beside that, from angle, rate, acceleration, predicted torque
/// and time.
pub fn balance(hidden: impl Fn(f64, f64, f64, f64, f64) -> f64, seed: u64) -> String {
    let mut random = Random::new(seed);
    let phase = TAU * random.uniform();
    let mut text = String::from("t,q,torque,model\n");
    for at in 0..5000 {
        let time = f64::from(at) * 0.005;
        let [q, rate, acceleration] = joint(time, phase);
        let model = 0.3 * acceleration + 6.0 * q.sin() + 0.5 * rate;
        let torque =
            1.01 * model + hidden(q, rate, acceleration, model, time) + 0.1 * random.normal();
        let _ = writeln!(
            text,
            "{time:.3},{:.6},{torque:.5},{model:.5}",
            q + 1e-5 * random.normal()
        );
    }
    text
}

/// Angle, rate and acceleration of a joint.
fn joint(time: f64, phase: f64) -> [f64; 3] {
    let mut motion = [0.0; 3];
    for (size, hertz) in [(0.7, 0.9), (0.4, 1.6)] {
        let (turn, angle) = (TAU * hertz, TAU * hertz * time + phase * hertz);
        motion[0] += size * angle.sin();
        motion[1] += size * turn * angle.cos();
        motion[2] -= size * turn * turn * angle.sin();
    }
    motion
}

/// A joint with a torque sensor at its output, whose model knows the torque there; `hidden` acts beside, from angle, rate and that torque.
pub fn loaded(hidden: impl Fn(f64, f64, f64) -> f64, seed: u64) -> String {
    let mut random = Random::new(seed);
    let phase = TAU * random.uniform();
    let mut text = String::from("t,q,torque,model,output\n");
    for at in 0..5000 {
        let time = f64::from(at) * 0.005;
        let [q, rate, acceleration] = joint(time, phase);
        let output = 2.0 + 5.0 * (TAU * 0.23 * time + phase).sin();
        let model = 0.3 * acceleration + output;
        let torque = 1.01 * model + hidden(q, rate, output) + 0.1 * random.normal();
        let read = output + 0.01 * random.normal();
        let _ = writeln!(text, "{time:.3},{q:.6},{torque:.5},{model:.5},{read:.4}");
    }
    text
}

/// A record with its columns multiplied: another unit, or another size of the same plant.
pub fn multiplied(record: &str, factors: &[f64]) -> String {
    let mut lines = record.lines();
    let mut text = format!("{}\n", lines.next().unwrap_or_default());
    for line in lines {
        let values: Vec<String> = line
            .split(',')
            .zip(factors)
            .map(|(value, factor)| format!("{:e}", value.parse::<f64>().unwrap() * factor))
            .collect();
        let _ = writeln!(text, "{}", values.join(","));
    }
    text
}

/// A model with numbers multiplied, each given by what stands before it in its line.
pub fn resized(model: &str, factors: &[(&str, f64)]) -> String {
    let line = |line: &str| -> String {
        let Some((start, factor)) = factors.iter().find(|(start, _)| line.starts_with(start))
        else {
            return line.to_owned();
        };
        let rest = &line[start.len()..];
        let end = rest
            .find(|c: char| !(c.is_ascii_digit() || c == '.' || c == '-'))
            .unwrap_or(rest.len());
        let number: f64 = rest[..end].parse().unwrap();
        format!("{start}{:e}{}", number * factor, &rest[end..])
    };
    model.lines().map(|text| line(text) + "\n").collect()
}
