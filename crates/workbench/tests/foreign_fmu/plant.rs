//! The foreign FMU, and records of the axis that another solver made.
//!
//! The maker of blind cases packs the same source. No crate depends on the maker, so that nothing of it can leak into the diagnosis: what
//! both do stands here again.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::Path;
use std::sync::OnceLock;

use inference::random::Random;

use crate::common::{compiled, pack};

/// Name, causality, unit and start value of the axis' variables, in the order of their references.
const VARIABLES: [(&str, &str, &str, f64); 12] = [
    ("voltage", "input", "V", 0.0),
    ("torque", "input", "N.m", 0.0),
    ("phi", "output", "rad", 0.0),
    ("w", "output", "rad/s", 0.0),
    ("J", "parameter", "kg.m2", 0.02),
    ("R", "parameter", "Ohm", 2.0),
    ("k", "parameter", "N.m/A", 0.5),
    ("d", "parameter", "N.m.s/rad", 0.01),
    ("m", "parameter", "N.m", 0.6),
    ("friction", "parameter", "N.m", 0.0),
    ("crash_at", "parameter", "s", 1e9),
    ("nan_at", "parameter", "s", 1e9),
];

/// How the axis meets its records.
pub const PORTS: &str = r#"[plant]
kind = "fmu"
path = "turn"

[port]
input = "torque"
position = "phi"
velocity = "w"

[inputs]
voltage = { column = "u", unit = "V", between = "linear" }

[start]
phi = "position"
w = "velocity"

[columns]
time = { column = "t", unit = "s" }
position = { column = "angle", unit = "deg" }

[measurement]
motion_low_pass = 20.0
compare_low_pass = 10.0
compare_rate = 40.0
edge = 0.5
standstill_speed = 0.05

[parameters]
J = { value = 0.02, unit = "kg.m2", relative_uncertainty = 0.05 }
R = { value = 2.0, unit = "Ohm", relative_uncertainty = 0.05 }
m = { value = 0.6, unit = "N.m", relative_uncertainty = 0.05 }
"#;

/// The axis' library, compiled once.
fn library() -> &'static [u8] {
    static LIBRARY: OnceLock<Vec<u8>> = OnceLock::new();
    LIBRARY.get_or_init(|| compiled("tools/benchmark-data/fmu/axis.rs"))
}

/// Writes the FMU, with other start values of some parameters.
pub fn write_fmu(path: &Path, starts: &[(&str, f64)]) {
    write(path, starts, "input");
}

/// Writes the FMU with a parameter in place of the input for a torque, of this variability.
pub fn write_fmu_without_torque_input(path: &Path, variability: &str) {
    write(path, &[], variability);
}

fn write(path: &Path, starts: &[(&str, f64)], torque: &str) {
    let mut variables = String::new();
    for (reference, (name, causality, unit, start)) in VARIABLES.iter().enumerate() {
        let own = starts.iter().find(|(own, _)| own == name);
        let start = own.map_or(*start, |(_, value)| *value);
        let further = match *causality {
            "output" => " initial=\"exact\"",
            "parameter" => " variability=\"fixed\"",
            _ => "",
        };
        let (causality, further) = match *name {
            "torque" if torque != "input" => ("parameter", format!(" variability=\"{torque}\"")),
            _ => (*causality, further.to_owned()),
        };
        let _ = writeln!(
            variables,
            "<ScalarVariable name=\"{name}\" valueReference=\"{reference}\" causality=\"{causality}\"{further}>\
             <Real unit=\"{unit}\" start=\"{start}\"/></ScalarVariable>"
        );
    }
    let units: BTreeSet<&str> = VARIABLES.iter().map(|(_, _, unit, _)| *unit).collect();
    let units: String = units
        .iter()
        .map(|unit| format!("<Unit name=\"{unit}\"/>"))
        .collect();
    let description = format!(
        "<?xml version=\"1.0\"?>\n<fmiModelDescription fmiVersion=\"2.0\" modelName=\"Axis\" guid=\"{{1}}\">\
         <CoSimulation modelIdentifier=\"Axis\" canHandleVariableCommunicationStepSize=\"true\"/>\
         <UnitDefinitions>{units}</UnitDefinitions><ModelVariables>\n{variables}</ModelVariables>\
         <ModelStructure><Outputs><Unknown index=\"3\"/><Unknown index=\"4\"/></Outputs></ModelStructure>\
         </fmiModelDescription>\n"
    );
    let system = match std::env::consts::OS {
        "macos" => "darwin",
        "windows" => "win",
        _ => "linux",
    };
    let binary = format!(
        "binaries/{system}{}/Axis.{}",
        usize::BITS,
        std::env::consts::DLL_EXTENSION
    );
    pack(
        path,
        &[
            ("modelDescription.xml", description.as_bytes()),
            (&binary, library()),
        ],
    );
}

/// Torque that the real axis has beside the FMU's, from angle and angular velocity; dry friction apart.
pub type Hidden = fn(f64, f64) -> f64;

/// A record of 20 s at 5 ms: voltage and the angle in degrees, read by an encoder of 0.01° with 0.01° of noise, `late` samples late.
/// The real axis has J, R and m 3, −2.5 and −1.7 % off, and dry friction `dry` on top.
pub fn record(dry: f64, hidden: Hidden, late: usize, seed: u64) -> String {
    const STEP: f64 = 5e-3;
    const INNER: usize = 200;
    let mut random = Random::new(seed);
    let waves: Vec<[f64; 3]> = (0..3)
        .map(|_| {
            let [frequency, size, phase] = [(); 3].map(|()| random.index(1000) as f64 / 1000.0);
            [
                0.3 + 0.9 * frequency,
                1.8 + 1.2 * size,
                std::f64::consts::TAU * phase,
            ]
        })
        .collect();
    let voltage = |t: f64| -> f64 {
        let wave = |[f, a, p]: &[f64; 3]| a * (std::f64::consts::TAU * f * t + p).sin();
        waves.iter().map(wave).sum()
    };
    let (inertia, resistance, m) = (0.0206, 1.95, 0.59);
    let (mut angle, mut speed) = (0.0, 0.0);
    let mut course = Vec::new();
    for sample in 0..4001 {
        course.push(angle);
        for inner in 0..INNER {
            let h = STEP / INNER as f64;
            let u = voltage(sample as f64 * STEP + inner as f64 * h);
            let drive = 0.5 * (u - 0.5 * speed) / resistance - 0.01 * speed - m * f64::sin(angle);
            let free = speed + h * (drive - hidden(angle, speed)) / inertia;
            let braked: f64 = h * dry / inertia;
            speed = if f64::abs(free) <= braked {
                0.0
            } else {
                free - braked.copysign(free)
            };
            angle += h * speed;
        }
    }
    let mut text = String::from("t,u,angle\n");
    for sample in 0..course.len() {
        let read = course[sample.saturating_sub(late)].to_degrees() + 0.01 * random.normal();
        let time = sample as f64 * STEP;
        let _ = writeln!(text, "{time:.3},{:.6},{:.2}", voltage(time), read);
    }
    text
}
