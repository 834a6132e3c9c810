//! Many instances and long runs.

use std::fs;
use std::path::Path;
use std::thread;

use anyhow::{Context, Result, ensure};

use crate::component::{Component, FULL_RIG, REDUCED_RIG};
use crate::library::Library;
use crate::rig::Rig;
use crate::standard::Version;

/// What is compared of a run.
const OUTPUTS: [&str; 5] = ["theta", "theta_dot", "T_f", "theta3", "i"];
/// Communication step [s] of runs that are compared: a power of two, so that sums of steps are exact.
const SHORT: f64 = 1.0 / 128.0;
/// Step of the run to compare with: the solution does not depend on it.
const LONG: f64 = 16.0 * SHORT;
/// Number of long steps of such a run.
const LONG_STEPS: usize = 24;

/// Largest growth of a process [KiB] that counts as flat: a few pages of the allocator.
const FLAT: u64 = 512;

/// Resident memory of this process [KiB].
fn memory() -> Result<u64> {
    let status =
        fs::read_to_string("/proc/self/status").context("memory is measured on Linux only")?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
    let number = line.and_then(|line| line.trim().strip_suffix(" kB"));
    Ok(number.context("no VmRSS")?.trim().parse()?)
}

/// One of many runs: which version, at which voltage [V] and normal force [N].
fn case(number: usize, component: &Component) -> Result<(Version, [(u32, f64); 2])> {
    let [u, n2] = component.references(["u", "N2"])?;
    let version = if number.is_multiple_of(2) {
        Version::Two
    } else {
        Version::Three
    };
    let voltage = 1.0 + 4.0 * (number % 37) as f64 / 37.0;
    let force = 60.0 * (number % 53) as f64 / 53.0;
    Ok((version, [(u, voltage), (n2, force)]))
}

fn outputs(rig: &Rig<'_>, component: &Component) -> Result<[u64; 5]> {
    Ok(rig.get(&component.references(OUTPUTS)?)?.map(f64::to_bits))
}

/// The end of a run that is alone in its process.
fn alone(library: &Library, component: &Component, number: usize) -> Result<[u64; 5]> {
    let (version, values) = case(number, component)?;
    let rig = Rig::start(library, component, version, &values)?;
    for step in 0..LONG_STEPS {
        rig.step(step as f64 * LONG, LONG)?;
    }
    outputs(&rig, component)
}

/// Steps `instances` instances from `threads` threads at once, each thread its share in turn, and compares the ends
/// with single runs.
///
/// # Errors
/// A call fails, or a run ends elsewhere than alone.
pub fn threads(library: &Library, instances: usize, threads: usize) -> Result<String> {
    let component = Component::new(REDUCED_RIG)?;
    let together = |share: usize| -> Result<Vec<(usize, [u64; 5])>> {
        let numbers: Vec<usize> = (share..instances).step_by(threads).collect();
        let mut rigs = Vec::new();
        for number in &numbers {
            let (version, values) = case(*number, &component)?;
            rigs.push(Rig::start(library, &component, version, &values)?);
        }
        for step in 0..16 * LONG_STEPS {
            for rig in &rigs {
                rig.step(step as f64 * SHORT, SHORT)?;
            }
        }
        let mut ends = Vec::new();
        for (number, rig) in numbers.into_iter().zip(&rigs) {
            ends.push((number, outputs(rig, &component)?));
        }
        Ok(ends)
    };
    let ends = thread::scope(|scope| {
        let together = &together;
        let running: Vec<_> = (0..threads)
            .map(|share| scope.spawn(move || together(share)))
            .collect();
        running
            .into_iter()
            .map(|thread| {
                thread
                    .join()
                    .map_err(|_| anyhow::anyhow!("a thread panicked"))?
            })
            .collect::<Result<Vec<_>>>()
    })?;
    let mut compared = 0;
    for (number, end) in ends.into_iter().flatten() {
        ensure!(
            alone(library, &component, number)? == end,
            "run {number} ends elsewhere than alone"
        );
        compared += 1;
    }
    ensure!(
        compared == instances,
        "{compared} of {instances} runs compared"
    );
    Ok(format!(
        "{instances} instances of both versions stepped from {threads} threads: all end where single runs end, bit for bit"
    ))
}

/// Instantiates, runs and frees instances in turn, a saved state left unfreed in each.
///
/// # Errors
/// A call fails, or memory grows.
pub fn instances(library: &Library, count: usize) -> Result<String> {
    let component = Component::new(REDUCED_RIG)?;
    let warm = count / 10;
    let mut before = 0;
    for number in 0..count {
        if number == warm {
            before = memory()?;
        }
        let (version, values) = case(number, &component)?;
        let rig = Rig::start(library, &component, version, &values)?;
        rig.step(0.0, 0.02)?;
        rig.save(false)?;
        rig.save(true)?;
    }
    let after = memory()?;
    ensure!(
        after <= before + FLAT,
        "memory grew from {before} to {after} KiB"
    );
    Ok(format!(
        "{count} instances made, run and freed: {before} KiB after {warm} of them, {after} KiB at the end"
    ))
}

/// Statistics of the limit cycle over one stretch of a long run.
#[derive(Debug, Clone, Copy)]
struct Stretch {
    /// Cycles per second, from the first to the last rise through half the mean speed.
    frequency: f64,
    lowest: f64,
    highest: f64,
    mean: f64,
}

/// Takes `steps` communication steps of 1 ms at 55 rpm and 50 N.
///
/// # Errors
/// A call fails, memory grows, the time base drifts, or the limit cycle changes.
pub fn marathon(library: &Library, steps: u64, mut progress: impl FnMut(&str)) -> Result<String> {
    const STEP: f64 = 1e-3;
    const STRETCHES: u64 = 20;
    /// Communication steps between samples.
    const SAMPLE: u64 = 10;
    /// A stretch begins and ends anywhere in a cycle, which turns the disc by less than this [rad].
    const PART_OF_A_CYCLE: f64 = 10.0;
    let component = Component::new(REDUCED_RIG)?;
    let [u, n2] = component.references(["u", "N2"])?;
    let [theta, omega, time] = component.references(["theta", "theta_dot", "time"])?;
    let rig = Rig::start(
        library,
        &component,
        Version::Three,
        &[(u, 3.108_784_426_666_666_4), (n2, 50.0)],
    )?;
    let length = steps / STRETCHES;
    let (mut stretches, mut memories) = (Vec::new(), Vec::new());
    let mut drift = 0.0_f64;
    for stretch in 0..STRETCHES {
        let [begin] = rig.get(&[theta])?;
        let (mut first, mut last, mut cycles) = (None, 0.0, 0_u64);
        let (mut lowest, mut highest, mut before) =
            (f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY);
        for step in stretch * length..(stretch + 1) * length {
            let point = step as f64 * STEP;
            rig.step(point, STEP)?;
            if step % SAMPLE != SAMPLE - 1 {
                continue;
            }
            let [now] = rig.get(&[omega])?;
            (lowest, highest) = (lowest.min(now), highest.max(now));
            const LEVEL: f64 = 3.0;
            if before < LEVEL && now >= LEVEL {
                let share = (now - LEVEL) / (now - before);
                last = point + STEP - share * SAMPLE as f64 * STEP;
                cycles += 1;
                first.get_or_insert(last);
            }
            before = now;
        }
        let [end, reached] = rig.get(&[theta, time])?;
        drift = drift.max((reached - ((stretch + 1) * length) as f64 * STEP).abs());
        let duration = length as f64 * STEP;
        let frequency = (cycles.saturating_sub(1)) as f64 / (last - first.unwrap_or(0.0));
        let mean = (end - begin) / duration;
        stretches.push(Stretch {
            frequency,
            lowest,
            highest,
            mean,
        });
        memories.push(memory()?);
        progress(&format!(
            "{reached:.0} s: {frequency:.9} Hz, {lowest:.6} … {highest:.6} rad/s, mean {mean:.9} rad/s, {} KiB",
            memories.last().copied().unwrap_or(0)
        ));
    }
    ensure!(drift < 1e-9, "the time base drifted by {drift} s");
    // The first stretch holds the transient, and the memory settles in it.
    let settled = stretches[1];
    for later in &stretches[2..] {
        let apart = |now: f64, then: f64| (now - then).abs();
        let same = apart(later.frequency, settled.frequency) < 1e-6 * settled.frequency
            && apart(later.lowest, settled.lowest) < 1e-6
            && apart(later.highest, settled.highest) < 1e-3
            && apart(later.mean, settled.mean) < PART_OF_A_CYCLE / (length as f64 * STEP);
        ensure!(
            same,
            "the limit cycle changed from {settled:?} to {later:?}"
        );
    }
    let (early, late) = (memories[1], memories[memories.len() - 1]);
    ensure!(
        late <= early + FLAT,
        "memory grew from {early} to {late} KiB"
    );
    let end = stretches[stretches.len() - 1];
    Ok(format!(
        "{steps} steps of 1 ms: time base within {drift:.1e} s, {:.9} Hz in the second and {:.9} Hz in the last of \
         {STRETCHES} stretches, {early} KiB then and {late} KiB at the end",
        settled.frequency, end.frequency
    ))
}

/// Runs two components, each through both versions and each in a copy of the library of its own, in turn in one process,
/// and compares with single runs.
///
/// # Errors
/// A call fails, or a run ends elsewhere than alone.
pub fn side_by_side(path: &Path) -> Result<String> {
    let folder = tempfile::tempdir()?;
    let mut libraries = Vec::new();
    for name in ["ReducedRig", "FullRig"] {
        let copy = folder.path().join(name);
        fs::copy(path, &copy)?;
        libraries.push(Library::load(&copy)?);
    }
    let components = [Component::new(REDUCED_RIG)?, Component::new(FULL_RIG)?];
    let mut rigs = Vec::new();
    for (library, component) in libraries.iter().zip(&components) {
        for number in [4, 5] {
            let (version, values) = case(number, component)?;
            let rig = Rig::start(library, component, version, &values)?;
            rigs.push((rig, component, alone(library, component, number)?));
        }
    }
    for step in 0..16 * LONG_STEPS {
        for (rig, ..) in &rigs {
            rig.step(step as f64 * SHORT, SHORT)?;
        }
    }
    for (rig, component, alone) in &rigs {
        ensure!(
            outputs(rig, component)? == *alone,
            "a run beside others ends elsewhere than alone"
        );
    }
    Ok("two components, each in its own copy of the library and through both versions, in one process: as alone".into())
}
