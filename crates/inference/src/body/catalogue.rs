//! The effects that a small plant's model can lack. Those that an equation describes stand in the library's
//! `src/body/effects.toml`; those that none can, here.

use std::sync::LazyLock;

use stickslip::body::{Dimension, Kind, Path, parameter};
use stickslip::parameter::Range;

use super::effect_file;
use super::term::{Entry, Formula, Place, Role, Sample};

use Dimension::{Acceleration, Angle, Delay, Force, Inertia, Ratio, Speed};
use Kind::{Balance, Contact, Drive, Fmu, Pendulum};

/// Every effect.
pub static CATALOGUE: LazyLock<Vec<Entry>> = LazyLock::new(|| {
    let described = effect_file::built_in();
    let mut all = described.unwrap_or_else(|error| unreachable!("a test reads it: {error}"));
    all.extend_from_slice(CODED);
    all
});

/// Effects with a law or a reading of their own, or a power of what can be zero.
const CODED: &[Entry] = &[
    Entry {
        name: "acceleration_hysteresis",
        description: "friction over the angle α of the plane of velocity and acceleration, two Gaussians (Eqs 6-1, 6-2), instead of a law in the speed alone; with what then matters of the instruments, inertia and lag",
        signature: "friction that differs between speeding up and slowing down at the same speed",
        confusable: &["sensor_delay", "acceleration_torque"],
        kinds: &[Contact],
        path: None,
        needs_load: false,
        role: Role::Law,
        parameters: &[
            parameter("a1", Force, Range::Positive, "height of the first Gaussian"),
            parameter("b1", Angle, Range::Between(-4.2, 4.2), "its place"),
            parameter("c1", Angle, Range::Between(0.05, 9.0), "its width"),
            parameter(
                "a2",
                Force,
                Range::Positive,
                "height of the second Gaussian",
            ),
            parameter("b2", Angle, Range::Between(-4.2, 4.2), "its place"),
            parameter("c2", Angle, Range::Between(0.05, 9.0), "its width"),
            parameter(
                "centre",
                Speed,
                Range::Positive,
                "centre of the ellipse and its semi-axis in velocity",
            ),
            parameter(
                "semi_axis",
                Acceleration,
                Range::Positive,
                "semi-axis of the ellipse in acceleration",
            ),
            parameter(
                "inertia",
                Inertia,
                Range::Finite,
                "force over acceleration beside the law: inertia between sensor and contact",
            ),
            parameter(
                "lag",
                Delay,
                Range::Finite,
                "lag of the motion's readings behind the force; where negative, of the force",
            ),
        ],
        formula: Formula::Code {
            force: two_gaussians,
            starts: &[
                &[1.0, -2.5, 1.5, 1.0, 2.5, 2.2, 1.0, 1.0, 0.0, 0.0],
                &[1.0, -2.5, 1.5, 1.0, 2.5, 2.2, 1.3, 3.0, 0.0, -3.0],
                &[1.0, -2.5, 1.5, 1.0, 2.5, 2.2, 1.0, 1.5, -0.05, -3.0],
                &[1.0, -1.2, 1.5, 1.0, 2.0, 2.2, 0.7, 1.0, 0.0, 0.0],
                &[1.0, -3.0, 2.0, 0.5, 0.5, 2.0, 1.0, 2.0, 0.0, 3.0],
            ],
            linear: &[0, 3, 8],
        },
        own: false,
        place: Place::Everywhere,
    },
    Entry {
        name: "load_exponent",
        description: "friction with a power of the measured load: law·(load/mean load)^exponent; 0 is a law without load, 1 Amontons'",
        signature: "a residual that follows the measured load",
        confusable: &["friction_wear"],
        kinds: &[Contact],
        path: None,
        needs_load: true,
        role: Role::Added,
        parameters: &[parameter(
            "exponent",
            Ratio,
            Range::Finite,
            "power of the load",
        )],
        formula: Formula::Code {
            force: |p, s, law| law * (s.load.max(0.0).powf(p[0]) - 1.0),
            starts: &[&[0.2], &[1.0]],
            linear: &[],
        },
        own: false,
        place: Place::Everywhere,
    },
    Entry {
        name: "sensor_delay",
        description: "motion that is read later than the force acts; where negative, the force is",
        signature: "a residual in proportion to the change of the force, largest at reversals and pulses",
        confusable: &[
            "acceleration_hysteresis",
            "acceleration_torque",
            "load_friction",
        ],
        kinds: &[Drive, Contact, Balance, Fmu],
        path: None,
        needs_load: false,
        role: Role::Shift,
        parameters: &[parameter(
            "delay",
            Delay,
            Range::Finite,
            "lag of the motion's readings",
        )],
        formula: Formula::Code {
            force: |_, _, _| 0.0,
            starts: &[&[0.1], &[-0.1]],
            linear: &[],
        },
        own: false,
        place: Place::Everywhere,
    },
    Entry {
        name: "encoder_eccentricity",
        description: "encoder off the axis: position = reading + cosine·cos(reading) + sine·sin(reading)",
        signature: "a residual over the position, whatever the direction, largest where the motion is fast",
        confusable: &["hardening"],
        kinds: &[Pendulum],
        path: Some(Path::Turn),
        needs_load: false,
        role: Role::Reading,
        parameters: &[
            parameter(
                "cosine",
                Angle,
                Range::Finite,
                "part that goes with the cosine of the reading",
            ),
            parameter(
                "sine",
                Angle,
                Range::Finite,
                "part that goes with the sine of the reading",
            ),
        ],
        formula: Formula::Code {
            force: |_, _, _| 0.0,
            starts: &[&[0.001, 0.001]],
            linear: &[],
        },
        own: false,
        place: Place::Everywhere,
    },
];

/// The effect of this name.
#[must_use]
pub fn entry(name: &str) -> Option<&'static Entry> {
    CATALOGUE.iter().find(|entry| entry.name == name)
}

fn two_gaussians(p: &[f64], s: &Sample, _: f64) -> f64 {
    let direction = s.direction;
    let angle = stickslip::friction::acceleration_angle(
        direction * s.velocity,
        direction * s.acceleration,
        p[6],
        p[7],
    );
    let bell = |height: f64, place: f64, width: f64| {
        let z = (angle - place) / width;
        height * (-z * z).exp()
    };
    direction * (bell(p[0], p[1], p[2]) + bell(p[3], p[4], p[5])) + p[8] * s.acceleration
}
