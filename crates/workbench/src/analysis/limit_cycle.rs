//! The limit cycle in a sampled velocity: period, range and how long it sticks.

/// A limit cycle as seen in a record.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LimitCycle {
    /// Median period [s].
    pub period: f64,
    /// Number of whole periods seen.
    pub periods: usize,
    /// Largest distance of a period from the median [s].
    pub period_spread: f64,
    /// Lowest velocity over the whole periods [rad/s].
    pub minimum: f64,
    /// Highest velocity over the whole periods [rad/s].
    pub maximum: f64,
    /// Share of the time of the whole periods with |velocity| at or below the sticking velocity, 0 … 1.
    pub stick_fraction: f64,
}

impl LimitCycle {
    /// Frequency [Hz].
    #[must_use]
    pub fn frequency(&self) -> f64 {
        1.0 / self.period
    }

    /// Half of the velocity's range [rad/s].
    #[must_use]
    pub fn half_amplitude(&self) -> f64 {
        0.5 * (self.maximum - self.minimum)
    }
}

/// Finds the limit cycle in `velocity` [rad/s] over `time` [s] (of the same length, from the time on where it has settled).
///
/// Periods are counted between upward crossings of the middle of the range; a crossing counts once the velocity has been
/// below the middle by a tenth of the range, so that noise does not cross many times. `sticking_velocity` [rad/s], at least
/// 0, is what still passes for standing still: a few standard deviations of the tachometer's noise, or 0 for a model's own
/// output. `None` where fewer than two periods are seen or the range is not above `smallest_range` [rad/s].
#[must_use]
pub fn find(
    time: &[f64],
    velocity: &[f64],
    sticking_velocity: f64,
    smallest_range: f64,
) -> Option<LimitCycle> {
    let (lowest, highest) = range(velocity)?;
    let span = highest - lowest;
    if time.len() != velocity.len() || span.is_nan() || span <= smallest_range {
        return None;
    }
    let crossings = upward_crossings(time, velocity, 0.5 * (lowest + highest), 0.1 * span);
    if crossings.len() < 3 {
        return None;
    }
    let mut lengths: Vec<f64> = crossings
        .windows(2)
        .map(|pair| pair[1].0 - pair[0].0)
        .collect();
    lengths.sort_by(f64::total_cmp);
    let period = median(&lengths);
    let (first, last) = (crossings.first()?.1, crossings.last()?.1);
    let (minimum, maximum) = range(&velocity[first..last])?;
    Some(LimitCycle {
        period,
        periods: lengths.len(),
        period_spread: (lengths.last()? - period).max(period - lengths[0]),
        minimum,
        maximum,
        stick_fraction: share_at_rest(
            &time[first..=last],
            &velocity[first..=last],
            sticking_velocity,
        ),
    })
}

fn range(values: &[f64]) -> Option<(f64, f64)> {
    let first = *values.first()?;
    Some(values.iter().fold((first, first), |(low, high), &value| {
        (low.min(value), high.max(value))
    }))
}

fn median(sorted: &[f64]) -> f64 {
    let middle = sorted.len() / 2;
    if sorted.len() % 2 == 1 {
        sorted[middle]
    } else {
        0.5 * (sorted[middle - 1] + sorted[middle])
    }
}

/// Times of the upward crossings of `level`, with the index of the sample after each.
fn upward_crossings(
    time: &[f64],
    values: &[f64],
    level: f64,
    hysteresis: f64,
) -> Vec<(f64, usize)> {
    let mut crossings = Vec::new();
    let mut armed = false;
    for index in 1..values.len() {
        let (before, after) = (values[index - 1], values[index]);
        armed |= before < level - hysteresis;
        if armed && before < level && after >= level {
            let share = (level - before) / (after - before);
            crossings.push((
                time[index - 1] + share * (time[index] - time[index - 1]),
                index,
            ));
            armed = false;
        }
    }
    crossings
}

fn share_at_rest(time: &[f64], velocity: &[f64], sticking_velocity: f64) -> f64 {
    let at_rest = |index: usize| velocity[index].abs() <= sticking_velocity;
    let resting: f64 = (1..time.len())
        .map(|index| {
            0.5 * (f64::from(at_rest(index - 1)) + f64::from(at_rest(index)))
                * (time[index] - time[index - 1])
        })
        .sum();
    resting / (time[time.len() - 1] - time[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sticks for 0.4 s of every 1.3 s, then one arch of 12 rad/s; with a small deterministic noise.
    fn stick_slip(noise: f64) -> (Vec<f64>, Vec<f64>) {
        let time: Vec<f64> = (0..4000).map(|index| index as f64 * 0.005).collect();
        let velocity = time
            .iter()
            .enumerate()
            .map(|(index, t)| {
                let phase = t % 1.3;
                let clean = if phase < 0.4 {
                    0.0
                } else {
                    12.0 * (std::f64::consts::PI * (phase - 0.4) / 0.9).sin()
                };
                clean + noise * (index as f64 * 12.9898).sin()
            })
            .collect();
        (time, velocity)
    }

    #[test]
    fn stick_slip_is_measured() {
        for noise in [0.0, 0.1] {
            let (time, velocity) = stick_slip(noise);
            let cycle = find(&time, &velocity, 1e-9 + 1.01 * noise, 0.5).unwrap();
            assert!((cycle.period - 1.3).abs() < 0.005, "{cycle:?}");
            assert!((cycle.stick_fraction - 0.4 / 1.3).abs() < 0.01, "{cycle:?}");
            assert!(
                (cycle.maximum - 12.0).abs() < 1.5 * noise + 1e-3,
                "{cycle:?}"
            );
            assert_eq!(cycle.periods, 14);
        }
    }

    #[test]
    fn no_cycle_where_there_is_none() {
        let time: Vec<f64> = (0..1000).map(|index| index as f64 * 0.01).collect();
        assert_eq!(find(&time, &vec![5.76; 1000], 0.0, 0.1), None);
        let ramp: Vec<f64> = time.clone();
        assert_eq!(find(&time, &ramp, 0.0, 0.1), None);
        assert_eq!(find(&[], &[], 0.0, 0.1), None);
    }
}
