//! Joints whose torque is measured beside the one that a model of somebody's predicts, with something hidden in between.
//!
//! Frequency, inertia, amplitude, gravity, sampling and the size of what is hidden are drawn; motions are sums of three sines.

use std::f64::consts::TAU;
use std::fmt::Write as _;

use crate::answers::{Answer, named};
use crate::case_files::MadeCase;
use crate::kinds::{Set, SetCase};
use crate::random::{Purpose, Stream};

/// The joints; kinds are names of effects on small plants.
pub const JOINTS: Set = Set {
    kinds: &[
        "none",
        "coulomb_friction",
        "viscous_drag",
        "stribeck",
        "quadratic_drag",
        "transmitted_friction",
        "unbalance",
        "offset",
        "elastic_force",
        "acceleration_torque",
        "coulomb_friction_and_friction_wear",
        "sensor_delay",
        "position_friction",
        "friction_asymmetry",
        "outside_ripple",
        "outside_jump",
        "external_load_friction",
        "external_load_friction_square",
        "external_load_wobble",
        "external_load_share",
    ],
    make,
};

/// A joint and its motion, in SI units.
struct Joint {
    frequency: f64,
    amplitude: f64,
    inertia: f64,
    weight: f64,
    rest: f64,
    dry: f64,
    viscous: f64,
    samples_per_period: usize,
    /// Usual torque.
    torque: f64,
    /// What is hidden, at its usual motion.
    hidden: f64,
    phase: f64,
    scale: f64,
    /// Torque from outside at most, where a sensor reads it; zero where there is none.
    load: f64,
}

/// One moment of the motion.
#[derive(Clone, Copy)]
struct Moment {
    angle: f64,
    rate: f64,
    acceleration: f64,
    load: f64,
}

impl Joint {
    fn draw(kind: &str, seed: u64, stream: &mut Stream) -> Self {
        let frequency = stream.log_uniform(0.05, 5.0);
        let turn = TAU * frequency;
        let inertia = stream.log_uniform(1e-3, 1e3);
        let amplitude = stream.uniform(0.5, 1.5);
        let torque = inertia * turn * turn * amplitude;
        // A dry friction that the model has already would be what is to be found.
        let may_rub = !kind.starts_with("coulomb") && !kind.starts_with("viscous");
        let rubs = may_rub && stream.chance(0.5);
        Self {
            frequency,
            amplitude,
            inertia,
            weight: inertia * turn * turn * stream.uniform(0.5, 2.0),
            rest: stream.uniform(-3.0, 3.0),
            dry: if rubs { 0.15 * torque } else { 0.0 },
            viscous: if rubs {
                0.1 * torque / (turn * amplitude)
            } else {
                0.0
            },
            samples_per_period: 60 + stream.index(190),
            torque,
            hidden: torque * stream.uniform(0.04, 0.15),
            phase: stream.uniform(0.0, TAU),
            scale: 1.0 + 0.02 * stream.normal(),
            load: {
                let mut stream = Stream::new(seed, Purpose::Instruments);
                let is_loaded = stream.chance(0.5) || kind.starts_with("external_load");
                torque
                    * if is_loaded {
                        stream.log_uniform(0.3, 3.0)
                    } else {
                        0.0
                    }
            },
        }
    }

    fn period(&self) -> f64 {
        1.0 / self.frequency
    }

    fn predicted(&self, at: Moment) -> f64 {
        self.inertia * at.acceleration
            + self.weight * (at.angle + self.rest).sin()
            + self.viscous * at.rate
            + self.dry * at.rate.signum()
            + at.load
    }

    /// What acts beside the prediction at a share of the record's length.
    fn hidden(&self, kind: &str, at: Moment, share: f64) -> f64 {
        let Self {
            hidden, amplitude, ..
        } = *self;
        let direction = at.rate.signum();
        let speed = at.rate / (TAU * self.frequency * amplitude);
        let place = at.angle / amplitude;
        let load = if self.load > 0.0 {
            at.load / self.load
        } else {
            0.0
        };
        match kind {
            "coulomb_friction" => hidden * direction,
            "viscous_drag" => hidden * speed,
            "stribeck" => 1.5 * hidden * (-speed.abs() / 0.15).exp() * direction,
            "quadratic_drag" => hidden * speed * speed.abs(),
            "transmitted_friction" => 0.12 * self.predicted(at).abs() * direction,
            "unbalance" => hidden * (at.angle - self.phase).cos(),
            "offset" => hidden,
            "elastic_force" => hidden * place,
            "acceleration_torque" => 0.12 * self.inertia * at.acceleration,
            "coulomb_friction_and_friction_wear" => 2.0 * hidden * (1.0 + 0.5 * share) * direction,
            "position_friction" => hidden * place * direction,
            "friction_asymmetry" => hidden * speed.abs(),
            "external_load_friction" => 2.0 * hidden * load.abs() * direction,
            "external_load_friction_square" => 3.0 * hidden * load * load * direction,
            "external_load_wobble" => {
                3.0 * hidden * load.abs() * (at.angle - self.phase).cos() * direction
            }
            "external_load_share" => 2.0 * hidden * load,
            "outside_ripple" => hidden * (9.0 * at.angle).cos(),
            "outside_jump" if share > 0.4 => hidden * direction,
            _ => 0.0,
        }
    }

    /// A record over so many periods.
    fn record(&self, kind: &str, periods: f64, stream: &mut Stream, inputs: &mut Stream) -> String {
        // The load goes its own way, as that of a tool or of a person who leans on the joint.
        let loads = [0.37, 0.83].map(|order: f64| {
            let turn = TAU * self.frequency * order * inputs.uniform(0.8, 1.2);
            (turn, inputs.uniform(0.0, TAU))
        });
        let offset = inputs.uniform(-0.5, 0.5);
        let parts: Vec<[f64; 3]> = [1.0, 1.7, 2.6]
            .into_iter()
            .map(|order: f64| {
                let turn = TAU * self.frequency * order * stream.uniform(0.8, 1.2);
                let size = self.amplitude * stream.uniform(0.3, 1.0) / order;
                [size, turn, stream.uniform(0.0, TAU)]
            })
            .collect();
        let motion = |time: f64| {
            let mut at = Moment {
                angle: 0.0,
                rate: 0.0,
                acceleration: 0.0,
                load: self.load * offset,
            };
            for (turn, phase) in loads {
                at.load += 0.25 * self.load * (turn * time + phase).sin();
            }
            for [size, turn, phase] in &parts {
                let (sine, cosine) = (turn * time + phase).sin_cos();
                at.angle += size * sine;
                at.rate += size * turn * cosine;
                at.acceleration -= size * turn * turn * sine;
            }
            at
        };
        let interval = self.period() / self.samples_per_period as f64;
        let samples = (periods * self.samples_per_period as f64) as usize;
        let delay = if kind == "sensor_delay" {
            0.02 * self.period()
        } else {
            0.0
        };
        let usual_rate = TAU * self.frequency * self.amplitude;
        let kept = (-TAU * 5.0 / self.samples_per_period as f64).exp();
        let mut slow = 0.0;
        let is_loaded = self.load > 0.0;
        let mut text = String::from("t,q,dq,torque,model");
        text.push_str(if is_loaded { ",load\n" } else { "\n" });
        for sample in 0..samples {
            let time = sample as f64 * interval;
            let (acts, read) = (motion(time), motion(time - delay));
            slow = kept * slow + (1.0 - kept * kept).sqrt() * stream.normal();
            let noise = self.torque * (0.01 * stream.normal() + 0.006 * slow);
            let hidden = self.hidden(kind, acts, sample as f64 / samples as f64);
            let torque = self.scale * self.predicted(acts) + hidden + noise;
            let angle = read.angle + 2e-5 * stream.normal();
            let rate = read.rate + 1e-3 * usual_rate * stream.normal();
            let predicted = self.predicted(read);
            let _ = write!(
                text,
                "{time:.9e},{angle:.9e},{rate:.9e},{torque:.9e},{predicted:.9e}"
            );
            if is_loaded {
                let load = acts.load + 2e-3 * self.load * inputs.normal();
                let _ = write!(text, ",{load:.9e}");
            }
            text.push('\n');
        }
        text
    }

    fn model(&self) -> String {
        let rate = self.samples_per_period as f64 * self.frequency;
        format!(
            r#"[plant]
kind = "balance"
path = "turn"

[columns]
time = {{ column = "t", unit = "s" }}
position = {{ column = "q", unit = "rad" }}
velocity = {{ column = "dq", unit = "rad/s" }}
force = {{ column = "torque", unit = "N m" }}
predicted = {{ column = "model", unit = "N m" }}
{}
[measurement]
motion_low_pass = {:e}
compare_low_pass = {:e}
compare_rate = {:e}
edge = {:e}

[balance]
scale = {{ value = 1.0, unit = "1", relative_uncertainty = 0.05 }}
"#,
            match self.load > 0.0 {
                true => "load = { column = \"load\", unit = \"N m\" }\n",
                false => "",
            },
            (15.0 * self.frequency).min(0.4 * rate),
            10.0 * self.frequency,
            (30.0 * self.frequency).min(rate),
            0.3 * self.period(),
        )
    }
}

fn make(case: &SetCase) -> MadeCase {
    let mut stream = Stream::new(case.seed, Purpose::Recipe);
    let joint = Joint::draw(case.kind, case.seed, &mut stream);
    let mut files = vec![("model.toml".to_owned(), joint.model())];
    let runs = [("run-a.csv", 20.0, 35.0), ("held-out.csv", 10.0, 20.0)];
    for (run, (file, low, high)) in (0..).zip(runs) {
        let mut stream = Stream::new(case.seed, Purpose::Sensors(run));
        let mut inputs = Stream::new(case.seed, Purpose::Inputs(run));
        let periods = stream.uniform(low, high);
        let record = joint.record(case.kind, periods, &mut stream, &mut inputs);
        files.push((file.to_owned(), record));
    }
    MadeCase {
        files,
        true_sensors: None,
        answer: Answer {
            kind: case.kind.to_owned(),
            seed: case.seed,
            scale: 1.0,
            spread: 0.02,
            base: "balance".to_owned(),
            truth: "balance".to_owned(),
            parameter_ratio: named([("balance.scale", joint.scale)]),
            facts: named([
                ("frequency", joint.frequency),
                ("inertia", joint.inertia),
                ("hidden_torque_share", joint.hidden / joint.torque),
            ]),
            ..Answer::default()
        },
    }
}
