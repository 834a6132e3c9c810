//! The normal force behind a noisy load cell: levels between jumps, and slow drifts within them.

/// Samples on each side of a possible jump.
const SIDE: usize = 12;
/// Jump that is taken for one, in standard deviations of the difference of two side means.
const SIGNIFICANCE: f64 = 7.0;
/// Half width [samples] of the moving line through a section that is not level.
const HALF_LINE: usize = 40;

/// The normal force [N] freed from noise of standard deviation `noise` [N].
///
/// Sections between jumps that are level within the noise become exactly level; others are smoothed
/// by a moving line. Exact zeros (a lifted pin) stay exact.
pub fn denoise(reading: &[f64], noise: f64) -> Vec<f64> {
    let mut smooth = vec![0.0; reading.len()];
    let edges = edges(reading, noise);
    for pair in edges.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        let section = &reading[from..to];
        let n = section.len() as f64;
        let mean = section.iter().sum::<f64>() / n;
        if section.iter().all(|&x| x == section[0]) || is_level(section, mean, noise) {
            smooth[from..to].fill(mean);
            continue;
        }
        for j in from..to {
            let low = j.saturating_sub(HALF_LINE).max(from);
            let high = (j + HALF_LINE + 1).min(to);
            smooth[j] = line_at(&reading[low..high], j - low);
        }
    }
    smooth
}

/// Whether means over pieces of a section scatter no more than noise explains.
fn is_level(section: &[f64], mean: f64, noise: f64) -> bool {
    let piece = (section.len() / 12).max(8);
    let mut chi_square = 0.0;
    let mut count = 0.0_f64;
    for part in section.chunks(piece) {
        let n = part.len() as f64;
        let deviation = part.iter().sum::<f64>() / n - mean;
        chi_square += deviation * deviation * n / (noise * noise);
        count += 1.0;
    }
    chi_square < count + 4.0 * (2.0 * count).sqrt()
}

/// Value at `at` of the line through `values`.
fn line_at(values: &[f64], at: usize) -> f64 {
    let n = values.len() as f64;
    let centre = (n - 1.0) / 2.0;
    let mean = values.iter().sum::<f64>() / n;
    let (mut xy, mut xx) = (0.0, 0.0);
    for (j, v) in values.iter().enumerate() {
        let x = j as f64 - centre;
        xy += x * v;
        xx += x * x;
    }
    if xx == 0.0 {
        mean
    } else {
        mean + xy / xx * (at as f64 - centre)
    }
}

/// Starts of the sections between jumps, with 0 and the length at the ends.
fn edges(reading: &[f64], noise: f64) -> Vec<usize> {
    let n = reading.len();
    let mut edges = vec![0];
    let threshold = SIGNIFICANCE * noise * (2.0 / SIDE as f64).sqrt();
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let contrast = |j: usize| {
        let low = j.saturating_sub(SIDE);
        let high = (j + SIDE).min(n);
        (mean(&reading[j..high]) - mean(&reading[low..j])).abs()
    };
    let mut j = 2;
    while j + 2 < n {
        if contrast(j) > threshold {
            let end = (j + SIDE).min(n - 2);
            let mut best = j;
            for k in j..end {
                if contrast(k) > contrast(best) {
                    best = k;
                }
            }
            // A slope keeps its contrast over a long stretch; only a jump has a sharp edge.
            let step = (reading[best] - reading[best - 1]).abs();
            if step > 5.0 * noise {
                edges.push(best);
            }
            j = best + SIDE;
        } else {
            j += 1;
        }
    }
    edges.push(n);
    edges
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(j: usize) -> f64 {
        // A fixed irregular sequence between −√3 and √3: its standard deviation is 1.
        ((j as f64 * 12.9898).sin() * 43_758.545_3).fract() * 3f64.sqrt()
    }

    #[test]
    fn staircase_becomes_level_with_sharp_edges() {
        let reading: Vec<f64> = (0..3000)
            .map(|j| 10.0 + 20.0 * (j / 1000) as f64 + 0.2 * noise(j))
            .collect();
        let smooth = denoise(&reading, 0.2);
        for level in 0..3 {
            let part = &smooth[1000 * level..1000 * (level + 1)];
            assert!(
                part.iter().all(|v| *v == part[0]),
                "level {level} is not level"
            );
            assert!((part[0] - (10.0 + 20.0 * level as f64)).abs() < 0.05);
        }
    }

    #[test]
    fn lifted_pin_stays_exactly_lifted() {
        assert!(denoise(&vec![0.0; 500], 0.2).iter().all(|v| *v == 0.0));
    }

    #[test]
    fn ramp_is_followed() {
        let reading: Vec<f64> = (0..2000)
            .map(|j| 10.0 + 0.02 * j as f64 + 0.2 * noise(j))
            .collect();
        let smooth = denoise(&reading, 0.2);
        for j in 100..1900 {
            assert!(
                (smooth[j] - (10.0 + 0.02 * j as f64)).abs() < 0.25,
                "{j}: {}",
                smooth[j]
            );
        }
    }
}
