//! `stickslip identify static | decay | spectrum FILE.csv`.

use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow, bail};
use clap::{Args, Subcommand};

use super::{decay, static_test};
use crate::analysis::spectrum::Spectrum;
use crate::files::record::{Dialect, Record, Table};
use crate::outcome::Outcome;

/// Arguments of `identify`.
#[derive(Debug, Args)]
pub struct IdentifyArguments {
    #[command(subcommand)]
    test: Test,
}

#[derive(Debug, Subcommand)]
enum Test {
    /// Stiffness from known torques and measured twists (columns `torque` [N m] and `twist` [rad]).
    Static {
        /// The CSV file.
        file: PathBuf,
    },
    /// Frequency, damping and stiffness from a free decay (columns `time` [s] and the one named).
    Decay {
        /// The CSV file.
        file: PathBuf,
        /// The column with the displacement [rad].
        #[arg(long)]
        column: String,
        /// Swings smaller than this are left out [rad].
        #[arg(long, allow_negative_numbers = true)]
        smallest: f64,
        /// Inertia of the body that swings [kg m²]; with it stiffness and damping are given.
        #[arg(long, allow_negative_numbers = true)]
        inertia: Option<f64>,
    },
    /// The strongest peaks of the amplitude spectrum (columns `time` [s] and the one named).
    Spectrum {
        /// The CSV file.
        file: PathBuf,
        /// The column.
        #[arg(long)]
        column: String,
        /// Number of peaks.
        #[arg(long, default_value_t = 3)]
        peaks: usize,
        /// Lowest frequency of a peak [Hz].
        #[arg(long, default_value_t = 0.05, allow_negative_numbers = true)]
        lowest: f64,
    },
}

/// Runs the subcommand.
///
/// # Errors
/// A file that cannot be read or says too little.
pub fn run(arguments: &IdentifyArguments) -> anyhow::Result<Outcome> {
    match &arguments.test {
        Test::Static { file } => print_static(file)?,
        Test::Decay {
            file,
            column,
            smallest,
            inertia,
        } => print_decay(file, column, *smallest, *inertia)?,
        Test::Spectrum {
            file,
            column,
            peaks,
            lowest,
        } => print_spectrum(file, column, *peaks, *lowest)?,
    }
    Ok(Outcome::Done)
}

fn print_static(file: &Path) -> anyhow::Result<()> {
    let (torque, twist) = read_static(file)?;
    let test = static_test::evaluate(&torque, &twist).with_context(|| {
        format!("{}: a static test needs at least three points with different twists, none of them zero", file.display())
    })?;
    println!("stiffness [N m/rad], value ± standard error");
    println!(
        "  mean of torque/twist     {:.5} ± {:.5} (standard deviation {:.5})",
        test.mean_ratio.value, test.mean_ratio.error, test.deviation
    );
    println!(
        "  line through the origin  {:.5} ± {:.5}",
        test.proportional.value, test.proportional.error
    );
    println!(
        "  line with an offset      {:.5} ± {:.5}",
        test.affine.value, test.affine.error
    );
    println!(
        "  its torque at no twist   {:.5} ± {:.5} N m",
        test.offset.value, test.offset.error
    );
    Ok(())
}

fn read_static(file: &Path) -> anyhow::Result<(Vec<f64>, Vec<f64>)> {
    let name = file.display().to_string();
    let table = Table::open(file, &name, Dialect::Own)?;
    let [torque, twist] = table.series(["torque", "twist"]).map_err(|error| {
        anyhow!(
            "{error}; a static test has the columns torque [N m] and twist [rad], separated by commas"
        )
    })?;
    Ok((torque, twist))
}

fn print_decay(
    file: &Path,
    column: &str,
    smallest: f64,
    inertia: Option<f64>,
) -> anyhow::Result<()> {
    if !smallest.is_finite() || smallest <= 0.0 {
        bail!("--smallest is {smallest}; it must be positive, for example ten encoder steps");
    }
    if let Some(inertia) = inertia.filter(|inertia| !inertia.is_finite() || *inertia <= 0.0) {
        bail!("--inertia is {inertia}; it must be a finite number above 0, in kg m²");
    }
    let record = read_even(file)?;
    let found =
        decay::evaluate(record.time(), record.require(column)?, smallest).with_context(|| {
            format!(
                "{}: column {column} shows fewer than four swings above {smallest}",
                file.display()
            )
        })?;
    println!(
        "damped frequency       {:.5} ± {:.5} rad/s",
        found.damped_frequency.value, found.damped_frequency.error
    );
    println!(
        "natural frequency      {:.5} rad/s = {:.5} Hz",
        found.natural_frequency,
        found.natural_frequency / std::f64::consts::TAU
    );
    println!(
        "logarithmic decrement  {:.5} ± {:.5}",
        found.decrement.value, found.decrement.error
    );
    println!("damping ratio          {:.5}", found.damping_ratio);
    println!("extremes used          {}", found.extremes.len());
    if let Some(inertia) = inertia {
        println!(
            "stiffness              {:.5} N m/rad",
            found.stiffness(inertia)
        );
        println!(
            "damping                {:.6} N m s/rad",
            found.damping(inertia)
        );
    }
    Ok(())
}

fn print_spectrum(file: &Path, column: &str, peaks: usize, lowest: f64) -> anyhow::Result<()> {
    if peaks == 0 {
        bail!("--peaks is 0; it must be at least 1");
    }
    if !lowest.is_finite() || lowest < 0.0 {
        bail!("--lowest is {lowest}; it must be a finite number of at least 0, in Hz");
    }
    let record = read_even(file)?;
    let step = record.median_step();
    let spectrum = Spectrum::new(record.require(column)?, step)
        .with_context(|| format!("{}: fewer than eight samples", file.display()))?;
    let found = spectrum.peaks(peaks, lowest);
    if found.is_empty() {
        bail!(
            "{}: column {column} has no peak between {lowest} Hz and {:.4} Hz, half the sampling rate",
            file.display(),
            0.5 / step
        );
    }
    println!(
        "frequency [Hz]  amplitude (resolution {:.5} Hz)",
        spectrum.frequency[1]
    );
    for peak in found {
        println!("{:>14.5}  {:.5}", peak.frequency, peak.amplitude);
    }
    Ok(())
}

/// A record whose steps differ by less than half of their median.
fn read_even(file: &Path) -> anyhow::Result<Record> {
    let record = Record::read(file)?;
    let step = record.median_step();
    let uneven = record
        .time()
        .windows(2)
        .find(|pair| ((pair[1] - pair[0]) / step - 1.0).abs() > 0.5);
    if let Some(pair) = uneven {
        bail!(
            "{}: the step from {} s to {} s is not the usual {step:.6} s; even samples are needed, so cut the record there or sample it again",
            file.display(),
            pair[0],
            pair[1]
        );
    }
    Ok(record)
}
