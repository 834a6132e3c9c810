//! What the communication step does to the closed loop.

use std::fmt::Write as _;

use indicatif::ProgressBar;
use rayon::prelude::*;

use super::arguments::ClosedLoopArguments;
use super::run::{Case, Conditions, Samples, run};
use super::{INTERRUPTED, picture};
use crate::analysis::motion::{Motion, Range};
use crate::files::atomic;
use crate::outcome::Outcome;

/// One run of a table over steps.
pub(super) struct Row {
    pub(super) case: Case,
    /// Communication step [s].
    pub(super) step: f64,
    pub(super) samples: Samples,
    pub(super) motion: Motion,
    /// Velocities of disc D2 in the last third [rad/s].
    pub(super) disc: Range,
    /// Velocities of the gearbox output in the last third [rad/s].
    pub(super) gearbox: Range,
    /// Root mean square difference of disc D2's velocity over the whole run from that of the shortest step [rad/s].
    pub(super) difference: f64,
}

/// Writes `steps.csv`, `steps.svg` and `steps.png`.
pub(super) fn command(arguments: &ClosedLoopArguments) -> anyhow::Result<Outcome> {
    let mut steps = arguments.communication_step.clone();
    steps.sort_by(f64::total_cmp);
    let cases: Vec<Case> = arguments.cases();
    let work: Vec<(Case, f64)> = cases
        .iter()
        .flat_map(|case| steps.iter().map(|step| (case.clone(), *step)))
        .collect();
    let bar = ProgressBar::new(work.len() as u64);
    let one = |(case, step): &(Case, f64)| -> anyhow::Result<Row> {
        let conditions = Conditions {
            speed_rpm: arguments.speed_rpm.values()[0],
            normal_force: arguments.normal_force.values()[0],
            normal_force_1: arguments.normal_force_1,
            step: *step,
            duration: arguments.duration,
        };
        let samples = run(&arguments.rig, case, &conditions, &INTERRUPTED)?;
        bar.inc(1);
        Ok(row(case.clone(), *step, samples))
    };
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(arguments.threads.map_or(0, std::num::NonZeroUsize::get))
        .build()?;
    let rows: Vec<anyhow::Result<Row>> = pool.install(|| work.par_iter().map(one).collect());
    bar.finish_and_clear();
    if INTERRUPTED.load(std::sync::atomic::Ordering::Relaxed) {
        eprintln!("interrupted; nothing is written");
        return Ok(Outcome::Interrupted);
    }
    let mut rows = rows.into_iter().collect::<anyhow::Result<Vec<Row>>>()?;
    for group in rows.chunks_mut(steps.len()) {
        let (finest, others) = group.split_at_mut(1);
        for row in others {
            row.difference = difference(&row.samples, &finest[0].samples, finest[0].step);
        }
    }
    let table = table(&rows);
    print!("{table}");
    atomic::write_file(&arguments.out.join("steps.csv"), table.as_bytes())?;
    picture::steps(&cases, &rows).write(&arguments.out.join("steps"))?;
    Ok(Outcome::Done)
}

fn row(case: Case, step: f64, samples: Samples) -> Row {
    let evidence = samples.evidence();
    let late = samples.time.len() - samples.time.len() / 3;
    let mut gearbox = Range::default();
    samples.gearbox[late..]
        .iter()
        .for_each(|value| gearbox.see(*value));
    Row {
        case,
        step,
        motion: evidence.judge(),
        disc: evidence.late,
        gearbox,
        difference: 0.0,
        samples,
    }
}

/// Root mean square over the times of `coarse` of its difference from `fine`, whose step is `step` [s].
fn difference(coarse: &Samples, fine: &Samples, step: f64) -> f64 {
    let squares: f64 = coarse
        .time
        .iter()
        .zip(&coarse.disc)
        .map(|(time, velocity)| {
            let place = ((time / step).round() as usize).clamp(1, fine.disc.len());
            (velocity - fine.disc[place - 1]).powi(2)
        })
        .sum();
    (squares / coarse.time.len().max(1) as f64).sqrt()
}

fn table(rows: &[Row]) -> String {
    let mut text = String::from(
        "drive,communication_step,motion,disc_minimum,disc_maximum,gearbox_minimum,gearbox_maximum,rms_difference\n",
    );
    for row in rows {
        let _ = writeln!(
            text,
            "{},{:?},{},{:.6},{:.6},{:.6},{:.6},{:.3e}",
            row.case.name(),
            row.step,
            row.motion.name(),
            row.disc.minimum,
            row.disc.maximum,
            row.gearbox.minimum,
            row.gearbox.maximum,
            row.difference
        );
    }
    text
}
