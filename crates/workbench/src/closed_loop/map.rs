//! Kinds of motion over speed and normal force, without and with controllers.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use anyhow::Context;
use build_fmu::explain::explain;

use super::arguments::ClosedLoopArguments;
use super::run::{Case, Conditions, run};
use super::{INTERRUPTED, picture};
use crate::analysis::motion::Motion;
use crate::files::atomic;
use crate::map::{Point, Study, judge, make};
use crate::outcome::Outcome;

/// Every case at every speed and normal force: a row for each case and normal force.
struct LoopMap<'a> {
    arguments: &'a ClosedLoopArguments,
    cases: Vec<Case>,
    speeds: Vec<f64>,
    forces: Vec<f64>,
    identity: String,
}

/// Writes `map.csv`, `map.svg` and `map.png`.
pub(super) fn command(arguments: &ClosedLoopArguments) -> anyhow::Result<Outcome> {
    let (cases, speeds) = (arguments.cases(), arguments.speed_rpm.values());
    let forces = arguments.normal_force.values();
    // A first run of each case shows what is wrong with the files before the many begin; the identity reads them whole.
    for case in &cases {
        let brief = Conditions {
            duration: arguments.communication_step[0],
            ..conditions(arguments, speeds[0], forces[0])
        };
        run(&arguments.rig, case, &brief, &INTERRUPTED)?;
    }
    let map = LoopMap {
        arguments,
        cases,
        speeds,
        forces,
        identity: identity(arguments)?,
    };
    let Some(made) = make(&map, &arguments.out, &INTERRUPTED, arguments.threads)? else {
        return Ok(Outcome::Interrupted);
    };
    for (case, rows) in map.cases.iter().zip(map.by_case(&made.rows)) {
        let counts: Vec<String> = Motion::ALL
            .into_iter()
            .map(|motion| {
                let points = rows.iter().flatten();
                let count = points.filter(|point| point.motion == Some(motion)).count();
                format!("{} {count}", motion.name())
            })
            .collect();
        println!("{:20} {}", case.name(), counts.join(", "));
    }
    println!(
        "written              {}",
        arguments.out.join("map.csv").display()
    );
    Ok(judge(&map, &made.rows))
}

fn conditions(arguments: &ClosedLoopArguments, speed_rpm: f64, normal_force: f64) -> Conditions {
    Conditions {
        speed_rpm,
        normal_force,
        normal_force_1: arguments.normal_force_1,
        step: arguments.communication_step[0],
        duration: arguments.duration,
    }
}

impl LoopMap<'_> {
    fn by_case<'a>(&self, rows: &'a [Vec<Point>]) -> Vec<&'a [Vec<Point>]> {
        rows.chunks(self.forces.len()).collect()
    }
}

impl Study for LoopMap<'_> {
    const JOURNAL: &'static str = "map.journal";
    const OTHER: &'static str = "a map with other settings";
    const ROWS: &'static str = "rows";
    const FAILED: &'static str = "in map.csv their motion is `failed`";

    fn identity(&self) -> String {
        self.identity.clone()
    }

    fn shape(&self) -> (usize, usize) {
        (self.cases.len() * self.forces.len(), self.speeds.len())
    }

    fn try_run(&self, row: usize, column: usize) -> Result<Point, String> {
        let case = &self.cases[row / self.forces.len()];
        let force = self.forces[row % self.forces.len()];
        let conditions = conditions(self.arguments, self.speeds[column], force);
        let samples = run(&self.arguments.rig, case, &conditions, &INTERRUPTED);
        samples
            .map(|samples| samples.point())
            .map_err(|error| explain(error.as_ref()))
    }

    fn write(&self, rows: &[Vec<Point>], out: &Path) -> anyhow::Result<()> {
        let maps = self.by_case(rows);
        let (cases, speeds, forces) = (&self.cases, &self.speeds, &self.forces);
        let table = table(cases, speeds, forces, &maps);
        atomic::write_file(&out.join("map.csv"), table.as_bytes())?;
        Ok(picture::maps(cases, speeds, forces, &maps).write(&out.join("map"))?)
    }
}

/// What makes two maps the same: all settings and the models.
fn identity(arguments: &ClosedLoopArguments) -> anyhow::Result<String> {
    let mut text = format!(
        "closed loop, version {}; {:?}; {:?}; {:?}; step {:?}; duration {:?}",
        env!("CARGO_PKG_VERSION"),
        arguments.speed_rpm,
        arguments.normal_force,
        arguments.normal_force_1,
        arguments.communication_step,
        arguments.duration
    );
    for path in std::iter::once(&arguments.rig).chain(&arguments.controller) {
        // An FMU's bytes are no text; its sum of bytes with its length tells it well enough apart.
        let bytes =
            fs::read(path).with_context(|| format!("{}: cannot be read", path.display()))?;
        let sum = bytes.iter().fold(0_u64, |sum, byte| {
            (sum ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3)
        });
        let _ = write!(text, "; {} {} {sum:x}", path.display(), bytes.len());
    }
    Ok(text)
}

fn table(cases: &[Case], speeds: &[f64], forces: &[f64], maps: &[&[Vec<Point>]]) -> String {
    let mut text = String::from(
        "drive,speed_rpm,normal_force,motion,velocity_minimum,velocity_maximum,half_amplitude,stick_fraction\n",
    );
    for (case, map) in cases.iter().zip(maps) {
        for (points, force) in map.iter().zip(forces) {
            for (point, speed) in points.iter().zip(speeds) {
                let _ = writeln!(
                    text,
                    "{},{speed:?},{force:?},{},{:?},{:?},{:?},{:?}",
                    case.name(),
                    point.motion.map_or("failed", Motion::name),
                    point.minimum,
                    point.maximum,
                    point.half_amplitude(),
                    point.stick_fraction
                );
            }
        }
    }
    text
}
