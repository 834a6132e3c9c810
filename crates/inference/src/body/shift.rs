//! A series of a record read at other moments, between its samples.

use std::f64::consts::TAU;

use rustfft::FftPlanner;
use rustfft::num_complex::Complex;

/// Samples through which a polynomial goes. It follows sines up to a sixth of the sampling rate within 0.1 %, and a jump shows in few
/// samples.
const POINTS: usize = 8;
/// Samples by which a series is continued on both sides, so that neither end shows at the other.
const MARGIN: usize = 64;

/// A series that a low-pass has passed or will pass, at so many moments, `stride` samples apart: on polynomials through the samples
/// beside each. The first moment is at sample `first`, which may lie between samples; beyond its ends the series stays as it is there.
#[must_use]
pub fn between(series: &[f64], first: f64, stride: usize, moments: usize) -> Vec<f64> {
    // Farther out nothing changes any more, and places stay whole numbers.
    let farthest = (moments * stride + series.len()) as f64;
    let first = first.clamp(-farthest, farthest);
    let low = first.floor();
    let weights = lagrange(first - low);
    let begin = low as i64 - (POINTS / 2 - 1) as i64;
    let last = series.len() as i64 - 1;
    (0..moments as i64)
        .map(|moment| {
            let place = begin + moment * stride as i64;
            let inside = place.clamp(0, last.max(0)) as usize;
            if let Some(samples) = series.get(inside..inside + POINTS)
                && inside as i64 == place
            {
                return weights.iter().zip(samples).map(|(w, y)| w * y).sum();
            }
            let pairs = weights.iter().zip(place..);
            pairs
                .map(|(w, place)| w * series[place.clamp(0, last) as usize])
                .sum()
        })
        .collect()
}

/// Weights of samples at −3, −2, …, 4 in the value at `part`, by Lagrange's formula.
fn lagrange(part: f64) -> [f64; POINTS] {
    let node = |at: usize| at as f64 - (POINTS / 2 - 1) as f64;
    std::array::from_fn(|own| {
        let others = (0..POINTS).filter(|other| *other != own);
        others
            .map(|other| (part - node(other)) / (node(own) - node(other)))
            .product()
    })
}

/// A series that no low-pass passes, as it was so many samples earlier: each of its sines is turned by its own angle.
///
/// So noise stays as large as it is. A polynomial would smooth the fastest, and a delay of half a sample would seem to explain a part of it.
#[must_use]
pub fn turned(series: &[f64], earlier: f64) -> Vec<f64> {
    let last = series.len().saturating_sub(1) as i64;
    let at = |place: i64| series[place.clamp(0, last) as usize];
    // Point reflection at both ends keeps value and slope.
    let continued = |place: i64| match place {
        ..0 => 2.0 * at(0) - at(-place),
        place if place > last => 2.0 * at(last) - at(2 * last - place),
        place => at(place),
    };
    let count = series.len() + 2 * MARGIN;
    let all: Vec<f64> = (0..count)
        .map(|place| continued(place as i64 - MARGIN as i64))
        .collect();
    // Less a straight line from end to end, the series goes on where it begins.
    let (first, end) = (all[0], all[count - 1]);
    let line = |place: f64| first + (end - first) / count as f64 * place;
    let less = all.iter().enumerate();
    let mut sines: Vec<Complex<f64>> = less
        .map(|(place, own)| Complex::from(own - line(place as f64)))
        .collect();
    let mut planner = FftPlanner::new();
    planner.plan_fft_forward(count).process(&mut sines);
    for (place, sine) in sines.iter_mut().enumerate() {
        let frequency = if 2 * place > count {
            place as f64 - count as f64
        } else {
            place as f64
        };
        let angle = -TAU * frequency * earlier / count as f64;
        *sine *= match 2 * place == count {
            true => Complex::from(angle.cos()),
            false => Complex::from_polar(1.0, angle),
        };
    }
    planner.plan_fft_inverse(count).process(&mut sines);
    let own = sines.iter().enumerate().skip(MARGIN).take(series.len());
    own.map(|(place, own)| own.re / count as f64 + line(place as f64 - earlier))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::{between, turned};
    use crate::random::Random;

    fn furthest(one: &[f64], other: &[f64]) -> f64 {
        assert_eq!(one.len(), other.len());
        let apart = one.iter().zip(other).map(|(a, b)| (a - b).abs());
        apart.fold(0.0, f64::max)
    }

    #[test]
    fn a_sine_is_read_between_its_samples() {
        let sine = |place: f64| 2.0 + 0.01 * place + place.sin();
        let series: Vec<f64> = (0..700).map(|at| sine(f64::from(at))).collect();
        let wanted = |first: f64, stride: f64, count: i32| -> Vec<f64> {
            (0..count)
                .map(|at| sine(first + stride * f64::from(at)))
                .collect()
        };
        let read = between(&series, 50.5, 10, 60);
        assert!(furthest(&read, &wanted(50.5, 10.0, 60)) < 2e-3);
        let earlier = turned(&series, 0.3);
        assert!(furthest(&earlier[100..600], &wanted(99.7, 1.0, 500)) < 1e-3);
    }

    #[test]
    fn at_whole_samples_nothing_changes_and_ends_go_on() {
        let series = [3.0, 1.0, 4.0, 1.0, 5.0];
        assert_eq!(
            between(&series, -2.0, 1, 9),
            [3.0, 3.0, 3.0, 1.0, 4.0, 1.0, 5.0, 5.0, 5.0]
        );
        assert_eq!(between(&series, -1e300, 2, 3), [3.0; 3]);
        assert_eq!(between(&series, 1e300, 2, 3), [5.0; 3]);
    }

    #[test]
    fn noise_stays_as_large_as_it_is() {
        let mut random = Random::new(7);
        let series: Vec<f64> = (0..4000).map(|_| random.normal()).collect();
        let square = |series: &[f64]| series.iter().map(|own| own * own).sum::<f64>();
        let moved = turned(&series, 0.5);
        assert!((square(&moved) / square(&series) - 1.0).abs() < 0.01);
    }
}
