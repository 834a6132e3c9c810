//! Axes: ranges, ticks and their labels.

/// How values are laid out along an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Evenly.
    Linear,
    /// By powers of ten; only positive values show.
    Logarithmic,
}

/// An axis: its label with unit, its scale and, where wanted, its range.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    label: String,
    scale: Scale,
    range: Option<(f64, f64)>,
}

impl Axis {
    /// A linear axis over whatever the data cover. The label carries the unit: `time [s]`.
    #[must_use]
    pub fn new(label: impl Into<String>) -> Self {
        Self {
            label: label.into(),
            scale: Scale::Linear,
            range: None,
        }
    }

    /// The same axis over a fixed range; it may run downward.
    #[must_use]
    pub fn range(self, from: f64, to: f64) -> Self {
        Self {
            range: Some((from, to)),
            ..self
        }
    }

    /// The same axis, logarithmic.
    #[must_use]
    pub fn logarithmic(self) -> Self {
        Self {
            scale: Scale::Logarithmic,
            ..self
        }
    }

    pub(super) fn label(&self) -> &str {
        &self.label
    }

    /// Lays the axis out over pixels `from` … `to` for the values it must show.
    pub(super) fn lay_out(&self, values: impl Iterator<Item = f64>, pixels: (f64, f64)) -> Layout {
        let shown =
            |value: &f64| value.is_finite() && (self.scale == Scale::Linear || *value > 0.0);
        let (low, high) = match self.range {
            Some(range) => range,
            None => pad(self.scale, values.filter(shown)),
        };
        Layout {
            scale: self.scale,
            low,
            high,
            pixels,
        }
    }

    /// Lays the axis out over pixels `from` … `to`, from the first to the last of `values` unless a range is fixed.
    pub(super) fn lay_out_exactly(&self, values: &[f64], pixels: (f64, f64)) -> Layout {
        let ends = values
            .first()
            .copied()
            .zip(values.last().copied())
            .unwrap_or((0.0, 1.0));
        let (low, high) = self.range.unwrap_or(ends);
        Layout {
            scale: self.scale,
            low,
            high,
            pixels,
        }
    }
}

/// Ends of the axis: the data's with a little air, or something to look at where there are none.
fn pad(scale: Scale, values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    if low > high {
        return (if scale == Scale::Linear { 0.0 } else { 0.1 }, 1.0);
    }
    match scale {
        Scale::Linear if high > low => (low - 0.04 * (high - low), high + 0.04 * (high - low)),
        Scale::Linear => (
            low - 0.5 * low.abs().max(1.0),
            high + 0.5 * high.abs().max(1.0),
        ),
        Scale::Logarithmic => (low / 1.3, high * 1.3),
    }
}

/// An axis laid over pixels.
#[derive(Debug, Clone, Copy)]
pub(super) struct Layout {
    scale: Scale,
    pub(super) low: f64,
    pub(super) high: f64,
    pixels: (f64, f64),
}

impl Layout {
    /// Pixel of a value; NaN where the scale cannot show it.
    pub(super) fn pixel(&self, value: f64) -> f64 {
        self.pixels.0 + self.share(value) * (self.pixels.1 - self.pixels.0)
    }

    /// Values at the two ends of a linear axis.
    pub(super) fn linear_ends(&self) -> Option<(f64, f64)> {
        (self.scale == Scale::Linear).then_some((self.low, self.high))
    }

    fn share(&self, value: f64) -> f64 {
        match self.scale {
            Scale::Linear => (value - self.low) / (self.high - self.low),
            Scale::Logarithmic if value > 0.0 => {
                (value / self.low).ln() / (self.high / self.low).ln()
            }
            Scale::Logarithmic => f64::NAN,
        }
    }

    /// About `count` ticks at round values, with their labels.
    pub(super) fn ticks(&self, count: usize) -> Vec<(f64, String)> {
        let (low, high) = (self.low.min(self.high), self.low.max(self.high));
        match self.scale {
            Scale::Linear => linear_ticks(low, high, count),
            Scale::Logarithmic => logarithmic_ticks(low, high, count),
        }
    }
}

/// About `count` ticks, but at least two, at multiples of 1, 2 or 5 times a power of ten.
pub(super) fn linear_ticks(low: f64, high: f64, count: usize) -> Vec<(f64, String)> {
    // One tick gives no scale; five steps over the range leave room for two multiples of the step whatever its ends.
    (count..=5.max(count))
        .map(|count| ticks_at_multiples(low, high, count))
        .find(|ticks| ticks.len() > 1)
        .unwrap_or_default()
}

fn ticks_at_multiples(low: f64, high: f64, count: usize) -> Vec<(f64, String)> {
    if high.partial_cmp(&low) != Some(std::cmp::Ordering::Greater) || !(high - low).is_finite() {
        return Vec::new();
    }
    let rough = (high - low) / count.max(1) as f64;
    let power = 10_f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .map(|factor| factor * power)
        .find(|step| *step >= 0.999 * rough);
    let step = step.unwrap_or(10.0 * power);
    let slack = 1e-9 * (high - low);
    let first = ((low - slack) / step).ceil() as i64;
    let last = ((high + slack) / step).floor() as i64;
    (first..=last)
        .map(|index| index as f64 * step)
        .map(|value| (value, tick_label(value, step, low.abs().max(high.abs()))))
        .collect()
}

fn logarithmic_ticks(low: f64, high: f64, count: usize) -> Vec<(f64, String)> {
    let first = low.log10().ceil() as i32;
    let last = high.log10().floor() as i32;
    let stride = (((last - first) as usize / count.max(1)) + 1) as i32;
    (first..=last)
        .step_by(stride.max(1) as usize)
        .map(|exponent| (10_f64.powi(exponent), format!("10{}", raised(exponent))))
        .collect()
}

/// A tick's label with the decimals that its step needs and a true minus sign; `largest` is the largest size on the axis,
/// so that all labels share one power of ten.
fn tick_label(value: f64, step: f64, largest: f64) -> String {
    if value == 0.0 && !(1e-4..1e6).contains(&largest) {
        return "0".to_owned();
    }
    let text = if !(1e-4..1e6).contains(&largest) {
        let exponent = largest.log10().floor() as i32;
        let digits = (exponent - (step.log10() + 1e-9).floor() as i32).max(0) as usize;
        format!(
            "{:.digits$}·10{}",
            value / 10_f64.powi(exponent),
            raised(exponent)
        )
    } else {
        let decimals = (-(step.log10() + 1e-9).floor()).max(0.0) as usize;
        format!("{value:.decimals$}")
    };
    match text.strip_prefix('-') {
        Some(rest) if rest.chars().all(|letter| letter == '0' || letter == '.') => rest.to_owned(),
        Some(rest) => format!("−{rest}"),
        None => text,
    }
}

fn raised(exponent: i32) -> String {
    exponent
        .to_string()
        .chars()
        .map(|letter| match letter {
            '-' => '⁻',
            '1' => '¹',
            '2' => '²',
            '3' => '³',
            '0' => '⁰',
            digit => char::from_u32(0x2070 + digit.to_digit(10).unwrap_or(0)).unwrap_or(digit),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(low: f64, high: f64) -> Vec<String> {
        linear_ticks(low, high, 5)
            .into_iter()
            .map(|(_, label)| label)
            .collect()
    }

    #[test]
    fn ticks_are_round_and_cover_the_range() {
        assert_eq!(labels(0.0, 60.0), ["0", "20", "40", "60"]);
        assert_eq!(labels(-0.25, 0.22), ["−0.2", "−0.1", "0.0", "0.1", "0.2"]);
        assert_eq!(
            labels(0.0, 2.0e-6),
            ["0", "0.5·10⁻⁶", "1.0·10⁻⁶", "1.5·10⁻⁶", "2.0·10⁻⁶"]
        );
        let few: Vec<String> = linear_ticks(3.02, 3.17, 1)
            .into_iter()
            .map(|(_, label)| label)
            .collect();
        assert_eq!(few, ["3.05", "3.10", "3.15"]);
        assert!(labels(1.0, 1.0).is_empty());
        assert!(labels(f64::NAN, 1.0).is_empty());
    }

    #[test]
    fn decades_are_ticked() {
        let layout = Axis::new("error")
            .logarithmic()
            .range(1e-10, 1e-2)
            .lay_out(std::iter::empty(), (0.0, 80.0));
        let ticks = layout.ticks(10);
        assert_eq!(ticks.len(), 9);
        assert_eq!(ticks[0].1, "10⁻¹⁰");
        assert!((layout.pixel(1e-6) - 40.0).abs() < 1e-9);
        assert!(layout.pixel(-1.0).is_nan());
    }

    #[test]
    fn the_range_follows_the_data_unless_fixed() {
        let free = Axis::new("x").lay_out([0.0, f64::NAN, 10.0].into_iter(), (0.0, 1.0));
        assert!(free.low < 0.0 && free.high > 10.0);
        let fixed = Axis::new("x")
            .range(2.0, 3.0)
            .lay_out([0.0, 10.0].into_iter(), (0.0, 1.0));
        assert_eq!((fixed.low, fixed.high), (2.0, 3.0));
        let constant = Axis::new("x").lay_out([5.76; 3].into_iter(), (0.0, 1.0));
        assert!(constant.high > constant.low);
    }
}
