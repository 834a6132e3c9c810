//! Driven axes with gravity whose model is an FMU, with something hidden in their records.
//!
//! Size, speed, gravity, dry friction of the FMU, parameters within their uncertainty and the size of what is hidden are drawn.
//! J·w' = k·(voltage − k·w)/R − d·w − m·sin(phi) − friction·sign(w) − what is hidden, in steps far below those of the FMU.

use std::f64::consts::TAU;
use std::fmt::Write as _;

use crate::answers::{Answer, named};
use crate::axis_fmu::FILE;
use crate::case_files::MadeCase;
use crate::kinds::{Set, SetCase};
use crate::random::{Purpose, Stream};

/// The axes; kinds are names of effects on FMUs.
pub const AXES: Set = Set {
    kinds: &[
        "none",
        "coulomb_friction",
        "stribeck",
        "viscous_drag",
        "quadratic_drag",
        "unbalance",
        "offset",
        "elastic_force",
        "sensor_delay",
        "outside_ripple",
        "outside_jump",
    ],
    make,
};

/// Names, units and relative standard deviations of the FMU's parameters.
const PARAMETERS: [(&str, &str, f64); 6] = [
    ("J", "kg.m2", 0.04),
    ("R", "Ohm", 0.04),
    ("k", "N.m/A", 0.02),
    ("d", "N.m.s/rad", 0.1),
    ("m", "N.m", 0.04),
    ("friction", "N.m", 0.05),
];
const SAMPLES: usize = 4001;
const STEPS_PER_SAMPLE: usize = 200;

/// An axis, in SI units.
struct Axis {
    /// Time over that of an axis that moves about once a second [s].
    time: f64,
    /// Usual torque [N m].
    torque: f64,
    /// Usual speed [rad/s].
    speed: f64,
    /// What the analyst believes, in the order of [`PARAMETERS`].
    believed: [f64; 6],
    /// What holds.
    real: [f64; 6],
    /// Size of what is hidden at the usual motion, over the usual torque.
    share: f64,
    /// Noise of the encoder [rad].
    noise: f64,
    /// Lag of the encoder in samples.
    lag: f64,
}

impl Axis {
    fn draw(kind: &str, stream: &mut Stream) -> Self {
        let time = stream.log_uniform(0.2, 5.0);
        let torque = stream.log_uniform(5e-3, 500.0);
        let speed = 5.0 / time;
        let damping = 0.25 * torque / speed * stream.uniform(3.0, 6.0);
        let resistance = stream.log_uniform(0.2, 20.0);
        let rubs = stream.chance(0.5);
        let believed = [
            0.2 * torque * time / speed * stream.uniform(0.7, 1.4),
            resistance,
            (damping * resistance).sqrt(),
            0.1 * torque / speed,
            torque * stream.uniform(0.4, 1.8),
            if rubs {
                torque * stream.uniform(0.04, 0.16)
            } else {
                0.0
            },
        ];
        let mut real = believed;
        for (value, (_, _, deviation)) in real.iter_mut().zip(PARAMETERS) {
            *value *= 1.0 + 0.7 * deviation * stream.normal();
        }
        let is_late = kind == "sensor_delay";
        Self {
            time,
            torque,
            speed,
            believed,
            real,
            share: stream.uniform(0.1, 0.3),
            noise: stream.log_uniform(1e-4, 5e-4),
            lag: if is_late {
                stream.uniform(1.0, 3.0)
            } else {
                0.0
            },
        }
    }

    fn interval(&self) -> f64 {
        5e-3 * self.time
    }

    /// What acts against the motion beside the FMU's torques, dry friction apart.
    fn hidden(&self, kind: &str, angle: f64, rate: f64) -> f64 {
        let size = self.share * self.torque;
        let speed = rate / self.speed;
        match kind {
            "viscous_drag" => size * speed,
            "quadratic_drag" => size * speed * speed.abs(),
            "unbalance" => size * angle.cos(),
            "offset" => 0.7 * size,
            "elastic_force" => 0.25 * size * angle,
            "outside_ripple" => size * (9.0 * angle).sin(),
            _ => 0.0,
        }
    }

    /// Dry friction beside the FMU's at a share of the record's length.
    fn rubs(&self, kind: &str, rate: f64, share: f64) -> f64 {
        let size = self.share * self.torque;
        match kind {
            "coulomb_friction" => size,
            "stribeck" => 1.5 * size * (-rate.abs() / (0.2 * self.speed)).exp(),
            "outside_jump" if share > 0.5 => size,
            _ => 0.0,
        }
    }

    fn record(&self, kind: &str, stream: &mut Stream) -> String {
        let [inertia, resistance, constant, drag, weight, friction] = self.real;
        let volts = self.torque * resistance / constant;
        let waves: Vec<[f64; 3]> = (0..3)
            .map(|_| {
                let turn = TAU * stream.uniform(0.25, 1.2) / self.time;
                [
                    volts * stream.uniform(0.9, 1.8),
                    turn,
                    stream.uniform(0.0, TAU),
                ]
            })
            .collect();
        let interval = self.interval();
        let voltage = |time: f64| -> f64 {
            let wave = |[size, turn, phase]: &[f64; 3]| size * (turn * time + phase).sin();
            waves.iter().map(wave).sum()
        };
        let step = interval / STEPS_PER_SAMPLE as f64;
        let (mut angle, mut rate) = (0.0_f64, 0.0_f64);
        let mut course = Vec::with_capacity(SAMPLES);
        for sample in 0..SAMPLES {
            course.push((angle, rate));
            let share = sample as f64 / SAMPLES as f64;
            for inner in 0..STEPS_PER_SAMPLE {
                let time = sample as f64 * interval + (inner as f64 + 0.5) * step;
                let drive = |angle: f64, rate: f64| {
                    constant * (voltage(time) - constant * rate) / resistance
                        - drag * rate
                        - weight * angle.sin()
                        - self.hidden(kind, angle, rate)
                };
                let halfway = rate + 0.5 * step * drive(angle, rate) / inertia;
                let free = rate + step * drive(angle + 0.5 * step * rate, halfway) / inertia;
                let braked = step * (friction + self.rubs(kind, rate, share)) / inertia;
                let next = if free.abs() <= braked {
                    0.0
                } else {
                    free - braked.copysign(free)
                };
                angle += 0.5 * step * (rate + next);
                rate = next;
            }
        }
        let mut text = String::from("t,u,angle\n");
        for sample in 0..SAMPLES {
            let time = sample as f64 * interval;
            let read = self.read(&course, sample) + self.noise * stream.normal();
            let _ = writeln!(text, "{time:.9e},{:.9e},{read:.9e}", voltage(time));
        }
        text
    }

    /// The angle that the encoder shows at a sample: that of a little earlier, on the cubic between two samples.
    fn read(&self, course: &[(f64, f64)], sample: usize) -> f64 {
        let place = (sample as f64 - self.lag).max(0.0);
        let low = (place as usize).min(course.len() - 2);
        let part = place - low as f64;
        let [(from, leaving), (to, arriving)] = [course[low], course[low + 1]];
        let [leaving, arriving] = [leaving, arriving].map(|rate| rate * self.interval());
        let bend = 3.0 * (to - from) - 2.0 * leaving - arriving;
        let twist = leaving + arriving - 2.0 * (to - from);
        from + part * (leaving + part * (bend + part * twist))
    }

    fn model(&self) -> String {
        let mut text = format!(
            r#"[plant]
kind = "fmu"
path = "turn"
fmu = "../{FILE}"

[port]
input = "torque"
position = "phi"
velocity = "w"

[inputs]
voltage = {{ column = "u", unit = "V", between = "linear" }}

[start]
phi = "position"
w = "velocity"

[columns]
time = {{ column = "t", unit = "s" }}
position = {{ column = "angle", unit = "rad" }}

[measurement]
motion_low_pass = {:e}
compare_low_pass = {:e}
compare_rate = {:e}
edge = {:e}
standstill_speed = {:e}

[parameters]
"#,
            20.0 / self.time,
            10.0 / self.time,
            40.0 / self.time,
            0.5 * self.time,
            0.02 * self.speed,
        );
        for ((name, unit, deviation), value) in PARAMETERS.iter().zip(self.believed) {
            if value > 0.0 {
                let _ = writeln!(
                    text,
                    "{name} = {{ value = {value:e}, unit = \"{unit}\", relative_uncertainty = {deviation} }}"
                );
            }
        }
        text
    }
}

fn make(case: &SetCase) -> MadeCase {
    let mut stream = Stream::new(case.seed, Purpose::Recipe);
    let axis = Axis::draw(case.kind, &mut stream);
    let mut files = vec![("model.toml".to_owned(), axis.model())];
    for (run, file) in (0..).zip(["run-a.csv", "run-b.csv", "held-out.csv"]) {
        let mut stream = Stream::new(case.seed, Purpose::Sensors(run));
        files.push((file.to_owned(), axis.record(case.kind, &mut stream)));
    }
    let ratios = PARAMETERS.iter().zip(axis.real.iter().zip(axis.believed));
    let ratios = ratios.filter(|(_, (_, believed))| *believed > 0.0);
    MadeCase {
        files,
        true_sensors: None,
        answer: Answer {
            kind: case.kind.to_owned(),
            seed: case.seed,
            scale: 1.0,
            spread: 0.04,
            base: "fmu".to_owned(),
            truth: "fmu".to_owned(),
            parameter_ratio: ratios
                .map(|((name, ..), (real, believed))| {
                    (format!("parameters.{name}"), real / believed)
                })
                .collect(),
            facts: named([
                ("time", axis.time),
                ("torque", axis.torque),
                ("hidden_torque_share", axis.share),
            ]),
            ..Answer::default()
        },
    }
}
