//! Steps and noise of the instruments, estimated from the records themselves.
//!
//! A step shows in the differences between readings: all are multiples of it. Noise shows in differences of high order, in
//! which smooth motion vanishes. Nothing here knows a unit: a channel times any factor has its step and noise times that factor.

use crate::record::{CHANNELS, Instruments, RawRecord};
use std::fmt;

/// Orders of the differences that noise is taken from. At 30 samples per period or more, motion shrinks by at least
/// 2 π/30 ≈ 0.2 with each order, while a kink (sticking, breakaway, a jump of the voltage) spreads over one difference more.
/// What is left of the motion mostly adds, so the order with the smallest result is nearest the truth. Order 1 would add
/// nothing: it keeps every slope.
const ORDERS: std::ops::RangeInclusive<usize> = 2..=8;

/// Readings nearer than this share of the channel's largest reading are equal: numerical tolerance, far above the rounding
/// of 64-bit numbers (1e-16) and far below any instrument's resolution.
const SAME: f64 = 1e-11;

/// Factor between stated and estimated deviation from which they contradict one another. The estimate errs by some per cent,
/// and data sheets round and state bounds; half as much again is neither.
const CONTRADICTION: f64 = 1.5;

/// Steps and noise of the instruments as the records themselves tell them, SI units; 0 where a channel was not measured or
/// never moved.
#[must_use]
pub fn estimate(records: &[RawRecord]) -> Instruments {
    let mut instruments = Instruments {
        step: [0.0; CHANNELS],
        noise: [0.0; CHANNELS],
    };
    for channel in 0..CHANNELS {
        let series: Vec<Series> = records
            .iter()
            .map(|record| (record.time.as_slice(), record.readings[channel].as_slice()))
            .collect();
        (instruments.step[channel], instruments.noise[channel]) = step_and_noise(&series);
    }
    instruments
}

/// Times and readings of a channel in a record; no readings where it was not measured.
pub type Series<'a> = (&'a [f64], &'a [f64]);

/// Standard deviation of the load cell's noise [N], its rounding included, from raw readings; 0 when they are constant.
#[must_use]
pub fn load_noise(records: &[Series]) -> f64 {
    let (step, noise) = step_and_noise(records);
    deviation(step, noise)
}

/// An instrument whose records contradict what was stated about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contradiction {
    /// Position of the channel.
    pub channel: usize,
    /// Standard deviation as stated, in the channel's unit.
    pub stated: f64,
    /// Standard deviation as the records tell it, in the channel's unit.
    pub estimated: f64,
}

impl fmt::Display for Contradiction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const NAMES: [(&str, &str); CHANNELS] = [
            ("angle of the disc", "rad"),
            ("angular velocity of the disc", "rad/s"),
            ("angle of the gearbox output", "rad"),
            ("angular velocity of the gearbox output", "rad/s"),
            ("armature current", "A"),
            ("angle of disc D1", "rad"),
            ("angular velocity of disc D1", "rad/s"),
        ];
        let (name, unit) = NAMES.get(self.channel).unwrap_or(&("channel", ""));
        write!(
            f,
            "the {name} was stated to err by {:.3e} {unit} (one standard deviation), but its records show {:.3e} {unit}",
            self.stated, self.estimated
        )?;
        if self.stated > 0.0 {
            write!(f, ", {:.2} times as much", self.estimated / self.stated)?;
        }
        Ok(())
    }
}

/// Where the estimate contradicts what was stated (both in SI units). A channel of which the records tell nothing contradicts
/// nothing.
#[must_use]
pub fn contradictions(stated: &Instruments, estimated: &Instruments) -> Vec<Contradiction> {
    let (said, seen) = (stated.deviations(), estimated.deviations());
    (0..CHANNELS)
        .filter(|&c| {
            seen[c] > 0.0
                && (seen[c] > CONTRADICTION * said[c] || said[c] > CONTRADICTION * seen[c])
        })
        .map(|channel| Contradiction {
            channel,
            stated: said[channel],
            estimated: seen[channel],
        })
        .collect()
}

/// Standard deviation of readings with a step and noise.
fn deviation(step: f64, noise: f64) -> f64 {
    (step / 12f64.sqrt()).hypot(noise)
}

/// Step and noise of one channel from all its records, in the channel's unit.
fn step_and_noise(records: &[Series]) -> (f64, f64) {
    let readings: Vec<&[f64]> = records.iter().map(|(_, readings)| *readings).collect();
    let Some(print) = resolution(&readings) else {
        return (0.0, 0.0);
    };
    let total = noise(records);
    // Where no coarser step than that of the printed decimals occurs, those are the step.
    let step = coarse_step(&readings, print).unwrap_or(print);
    // Fluctuation beyond that of the step. Differences of a stepped signal are uniform only where the motion crosses many
    // steps, and the motion's own remainder adds to them: a standard deviation half as large again is still the step alone.
    let alone = deviation(step, 0.0);
    let excess = if total > 1.5 * alone {
        (total * total - alone * alone).sqrt()
    } else {
        0.0
    };
    if step > excess {
        (step, excess)
    } else {
        // Steps below the noise are dithered by it and act as a part of it.
        (0.0, total)
    }
}

/// The smallest distance between different readings, or between different changes from one reading to the next (motion that is
/// always fast meets no two neighbouring levels): the printed decimals, or the instrument's step where they are exact.
fn resolution(records: &[&[f64]]) -> Option<f64> {
    let mut levels: Vec<f64> = records.concat();
    levels.retain(|x| x.is_finite());
    let largest = levels.iter().fold(0f64, |most, x| most.max(x.abs()));
    let gap = |mut values: Vec<f64>| {
        values.sort_unstable_by(f64::total_cmp);
        values
            .windows(2)
            .map(|pair| pair[1] - pair[0])
            .filter(|gap| *gap > SAME * largest)
            .min_by(f64::total_cmp)
    };
    let rounding = rounding(&levels, largest);
    let of_changes = gap(changes(records));
    let of_levels = gap(levels);
    // A change is that of two rounded readings: where it differs by less from another, rounding is all that it tells.
    match (of_levels, of_changes) {
        (Some(levels), Some(changes)) => Some(levels.min(changes.max(rounding))),
        (levels, changes) => levels.or(changes),
    }
}

/// Unit to which the largest readings are rounded: that of their last decimal, or of numbers of 32 bits. Where so many significant
/// digits are written, or so many bits, small readings have finer ones.
fn rounding(levels: &[f64], largest: f64) -> f64 {
    let short = |x: f64| x as f32;
    let is_short = |x: &f64| short(*x).to_string().parse() == Ok(*x) || f64::from(short(*x)) == *x;
    let of_bits = match levels.iter().all(is_short) {
        true => largest * f64::from(f32::EPSILON),
        false => 0.0,
    };
    let decimals = |x: &f64| {
        let text = x.to_string();
        text.split_once('.').map_or(0, |(_, own)| own.len())
    };
    let as_large = 10f64.powf(largest.log10().floor());
    let large = levels.iter().filter(|x| x.abs() >= as_large);
    let of_decimals = 10f64.powi(-(large.map(decimals).max().unwrap_or(0) as i32));
    of_bits.max(of_decimals)
}

/// Sizes of all changes from one reading to the next.
fn changes(records: &[&[f64]]) -> Vec<f64> {
    records
        .iter()
        .flat_map(|readings| readings.windows(2).map(|pair| (pair[1] - pair[0]).abs()))
        .filter(|change| change.is_finite())
        .collect()
}

/// A step clearly coarser than the printed decimals `print` of which nearly all differences between successive readings are
/// multiples.
fn coarse_step(records: &[&[f64]], print: f64) -> Option<f64> {
    let mut differences = changes(records);
    let stands = differences
        .iter()
        .any(|difference| *difference <= 0.5 * print);
    differences.push(0.0);
    differences.sort_unstable_by(f64::total_cmp);
    // Each of two readings is off by up to half a printed unit, so that one multiple of the step is printed as two neighbouring
    // numbers at most: these are one cluster.
    let mut clusters: Vec<f64> = Vec::new();
    let (mut first, mut last) = (0.0, 0.0);
    for &difference in &differences {
        if difference - last > 1.5 * print {
            clusters.push(0.5 * (first + last));
            first = difference;
        }
        last = difference;
    }
    clusters.push(0.5 * (first + last));
    let mut gaps: Vec<f64> = clusters.windows(2).map(|pair| pair[1] - pair[0]).collect();
    gaps.sort_unstable_by(f64::total_cmp);
    // Fast motion may leave only large multiples, whose gaps are multiples too: a gap divided by a small number.
    let starts = [0.0, 0.05, 0.25, 0.5]
        .into_iter()
        .filter_map(|share: f64| gaps.get((share * gaps.len() as f64) as usize));
    let mut best: Option<f64> = None;
    for &start in starts {
        for divisor in 1..=6 {
            let refined = common_step(
                &clusters[1..],
                &gaps,
                stands,
                start / f64::from(divisor),
                1.5 * print,
            );
            best = match (best, refined) {
                (Some(a), Some(b)) => Some(a.max(b)),
                (a, b) => a.or(b),
            };
        }
    }
    best
}

/// `start` refined by least squares over its multiples among `gaps` and `differences` (both rising), if nearly all differences
/// lie within `tolerance` of one. `stands`: whether a difference of zero occurs too.
fn common_step(
    differences: &[f64],
    gaps: &[f64],
    stands: bool,
    start: f64,
    tolerance: f64,
) -> Option<f64> {
    // Multiples prove a step only where chance seldom gives them. The tolerance is an eighth of the step at most, and that all
    // differences but the one that sets the step are multiples of it has a chance below 0.4 % (0.25⁴).
    let others = differences.len().saturating_sub(1) + usize::from(stands);
    let chance = (2.0 * tolerance / start).powf(others as f64);
    if tolerance > start / 8.0 || chance > 0.004 {
        return None;
    }
    // The start may be off by twice the printed unit. From small multiples to large ones the step becomes ever more certain; a
    // multiple so large that its number is in doubt is passed over.
    let (mut step, mut doubt) = (start, 2.0 * tolerance);
    let (mut products, mut squares) = (0f64, 0f64);
    for &difference in gaps.iter().chain(differences) {
        let multiple = (difference / step).round();
        let allowed = tolerance + multiple * doubt;
        if multiple >= 1.0
            && allowed < 0.25 * step
            && (difference - multiple * step).abs() <= allowed
        {
            products += difference * multiple;
            squares += multiple * multiple;
            step = products / squares;
            doubt = tolerance / squares.sqrt();
        }
    }
    let met = differences
        .iter()
        .filter(|difference| {
            let multiple = (*difference / step).round();
            multiple >= 1.0 && (*difference - multiple * step).abs() <= tolerance
        })
        .count();
    (met as f64 >= 0.97 * differences.len() as f64).then_some(step)
}

/// Standard deviation of what fluctuates from sample to sample, over all records of a channel.
fn noise(records: &[Series]) -> f64 {
    let mut best: Option<(f64, f64)> = None;
    for order in ORDERS {
        let mut sizes: Vec<f64> = records
            .iter()
            .flat_map(|series| difference_sizes(series, order))
            .collect();
        if sizes.len() < 20 {
            continue;
        }
        let scale = centre_scale(&mut sizes);
        let scatter = scale * (2.0 / sizes.len() as f64).sqrt();
        // A higher order has to be lower by more than the scatter: differences of higher order depend on one another more.
        if scale > 0.0 && best.is_none_or(|(smallest, margin)| scale < smallest - margin) {
            best = Some((scale, scatter));
        }
    }
    best.map_or(0.0, |(scale, _)| scale)
}

/// Absolute divided differences of an order, divided by what makes those of white noise as large as the noise. A channel that does not
/// change at all tells nothing of its noise: such stretches are left out.
fn difference_sizes(&(times, readings): &Series, order: usize) -> Vec<f64> {
    times
        .windows(order + 1)
        .zip(readings.windows(order + 1))
        .filter(|(_, window)| window.iter().any(|x| *x != window[0]))
        .map(|(times, window)| {
            let unit = (times[order] - times[0]) / order as f64;
            let (mut difference, mut squares) = (0.0, 0.0);
            for (at, reading) in window.iter().enumerate() {
                let others = times.iter().enumerate().filter(|(other, _)| *other != at);
                let weight: f64 = others.map(|(_, time)| unit / (times[at] - time)).product();
                difference += weight * reading;
                squares += weight * weight;
            }
            difference.abs() / squares.sqrt()
        })
        .filter(|size| size.is_finite())
        .collect()
}

/// Standard deviation of the normal distribution that fits the centre of the distribution of `sizes` (absolute values).
///
/// Where there are 30 samples per period, kinks of the motion reach a third of all differences and more, and the median would
/// be too large. So only sizes below `REACH` standard deviations are used, and their mean square is set against that of a
/// normal distribution cut off there; the fixed point is approached from below.
fn centre_scale(sizes: &mut [f64]) -> f64 {
    const REACH: f64 = 2.0;
    /// Variance of a standard normal distribution cut off at ±2: 1 − 2 · 2 φ(2)/(2 Φ(2) − 1).
    const CUT_VARIANCE: f64 = 0.773_741_3;
    sizes.sort_unstable_by(f64::total_cmp);
    let mut sums = Vec::with_capacity(sizes.len());
    let mut sum = 0.0;
    for size in sizes.iter() {
        sum += size * size;
        sums.push(sum);
    }
    // A quarter of a normal distribution lies within 0.3186 standard deviations.
    let mut scale = sizes[sizes.len() / 4] / 0.3186;
    for _ in 0..200 {
        let inside = sizes.partition_point(|size| *size <= REACH * scale);
        if inside == 0 {
            return scale;
        }
        let next = (sums[inside - 1] / inside as f64 / CUT_VARIANCE).sqrt();
        if (next - scale).abs() <= 1e-6 * scale {
            return next;
        }
        scale = next;
    }
    scale
}

#[cfg(test)]
mod tests;
