//! Colours, dashes and sizes shared by all pictures.

/// Size of ordinary text [px].
pub(super) const TEXT: f64 = 12.0;
/// Size of panel titles [px].
pub(super) const PANEL_TITLE: f64 = 13.0;
/// Size of the figure's title [px].
pub(super) const FIGURE_TITLE: f64 = 16.0;
/// Colour of text and frames.
pub(super) const INK: &str = "#222222";
/// Colour of grid lines.
pub(super) const GRID: &str = "#e3e3e3";

/// How a curve looks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Style {
    /// Colour as `#rrggbb`.
    pub colour: &'static str,
    /// Dash pattern as in SVG, or none for a solid line.
    pub dashes: Option<&'static str>,
    /// Line width [px].
    pub width: f64,
}

impl Style {
    /// The look of the series with this index; after six they repeat.
    #[must_use]
    pub fn series(index: usize) -> Self {
        // Lightness rises from 27 % to 72 %, hues alternate between blue and orange: told apart by colour-blind readers too.
        const LOOKS: [(&str, Option<&str>); 6] = [
            ("#12376b", None),
            ("#c8501e", Some("7 3")),
            ("#5aa3d6", Some("2 2.5")),
            ("#8a2d5c", Some("9 3 2 3")),
            ("#e3a53a", None),
            ("#8a8a8a", Some("4 2")),
        ];
        let (colour, dashes) = LOOKS[index % LOOKS.len()];
        Self {
            colour,
            dashes,
            width: 1.4,
        }
    }

    /// A model's result.
    #[must_use]
    pub fn model() -> Self {
        Self::series(0)
    }

    /// A measurement: lighter, wide, to lie under the model.
    #[must_use]
    pub fn measured() -> Self {
        Self {
            colour: "#a9b4bf",
            dashes: None,
            width: 2.4,
        }
    }

    /// A reference line that is no data.
    #[must_use]
    pub fn reference() -> Self {
        Self {
            colour: "#666666",
            dashes: Some("3 3"),
            width: 1.0,
        }
    }

    /// The same look with another width [px].
    #[must_use]
    pub fn wide(self, width: f64) -> Self {
        Self { width, ..self }
    }

    /// The same look with a solid line.
    #[must_use]
    pub fn solid(self) -> Self {
        Self {
            dashes: None,
            ..self
        }
    }
}

/// Shapes that mark single points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Marker {
    /// Filled circle.
    Dot,
    /// Open circle.
    Ring,
    /// Filled square.
    Square,
    /// Diagonal cross.
    Cross,
    /// White diamond with a black edge: a published value.
    Diamond,
}

/// The colour at `share` (0 … 1) of a gradient from dark violet to light yellow whose lightness rises evenly.
#[must_use]
pub fn gradient(share: f64) -> String {
    const STOPS: [[f64; 3]; 9] = [
        [68.0, 1.0, 84.0],
        [71.0, 44.0, 122.0],
        [59.0, 81.0, 139.0],
        [44.0, 113.0, 142.0],
        [33.0, 144.0, 141.0],
        [39.0, 173.0, 129.0],
        [92.0, 200.0, 99.0],
        [170.0, 220.0, 50.0],
        [253.0, 231.0, 37.0],
    ];
    let place = share.clamp(0.0, 1.0) * (STOPS.len() - 1) as f64;
    let below = (place as usize).min(STOPS.len() - 2);
    let part = place - below as f64;
    let channel = |index: usize| {
        (STOPS[below][index] + part * (STOPS[below + 1][index] - STOPS[below][index])).round() as u8
    };
    format!("#{:02x}{:02x}{:02x}", channel(0), channel(1), channel(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lightness(colour: &str) -> f64 {
        let channel = |at: usize| f64::from(u8::from_str_radix(&colour[at..at + 2], 16).unwrap());
        0.2126 * channel(1) + 0.7152 * channel(3) + 0.0722 * channel(5)
    }

    #[test]
    fn the_gradient_is_legible_in_grey() {
        let steps: Vec<f64> = (0..=50)
            .map(|index| lightness(&gradient(f64::from(index) / 50.0)))
            .collect();
        assert!(steps.windows(2).all(|pair| pair[1] > pair[0]), "{steps:?}");
    }

    #[test]
    fn neighbouring_series_differ_in_grey_or_dashes() {
        for first in 0..6 {
            for second in first + 1..6 {
                let (left, right) = (Style::series(first), Style::series(second));
                let apart = (lightness(left.colour) - lightness(right.colour)).abs();
                assert!(
                    apart > 35.0 || left.dashes != right.dashes,
                    "{first} and {second}"
                );
            }
        }
    }
}
