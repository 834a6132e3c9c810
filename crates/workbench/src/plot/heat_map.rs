//! A quantity over two parameters as colours, with a colour bar and the boundary of a region.

use super::chart::{draw_axes, draw_head, inner};
use super::contour::Piece;
use super::figure::{Area, Panel};
use super::scale::{Axis, Layout, linear_ticks};
use super::style::{Style, gradient};
use super::svg::{Anchor, Svg};

/// A panel that shows `values[row][column]` over (`x[column]`, `y[row]`) as colours. NaN stays white.
#[derive(Debug, Clone)]
pub struct HeatMap {
    title: String,
    x_axis: Axis,
    y_axis: Axis,
    x: Vec<f64>,
    y: Vec<f64>,
    values: Vec<Vec<f64>>,
    bar: Bar,
    boundary: Option<(String, Vec<Piece>)>,
}

#[derive(Debug, Clone)]
enum Bar {
    Continuous {
        label: String,
        range: Option<(f64, f64)>,
    },
    Classes(Vec<String>),
}

impl HeatMap {
    /// A quantity that varies continuously; `label` names it with its unit beside the colour bar.
    #[must_use]
    pub fn continuous(
        x: (Axis, Vec<f64>),
        y: (Axis, Vec<f64>),
        values: Vec<Vec<f64>>,
        label: impl Into<String>,
    ) -> Self {
        let bar = Bar::Continuous {
            label: label.into(),
            range: None,
        };
        Self {
            title: String::new(),
            x_axis: x.0,
            y_axis: y.0,
            x: x.1,
            y: y.1,
            values,
            bar,
            boundary: None,
        }
    }

    /// A map of classes: the values are indices into `classes`.
    #[must_use]
    pub fn classes(
        x: (Axis, Vec<f64>),
        y: (Axis, Vec<f64>),
        values: Vec<Vec<f64>>,
        classes: &[impl AsRef<str>],
    ) -> Self {
        let bar = Bar::Classes(
            classes
                .iter()
                .map(|class| class.as_ref().to_owned())
                .collect(),
        );
        Self {
            title: String::new(),
            x_axis: x.0,
            y_axis: y.0,
            x: x.1,
            y: y.1,
            values,
            bar,
            boundary: None,
        }
    }

    /// The same panel with a title.
    #[must_use]
    pub fn title(self, title: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            ..self
        }
    }

    /// The same panel with the colour bar over a fixed range; it does nothing to a map of classes.
    #[must_use]
    pub fn range(mut self, from: f64, to: f64) -> Self {
        if let Bar::Continuous { range, .. } = &mut self.bar {
            *range = Some((from, to));
        }
        self
    }

    /// Adds a boundary, as [`super::boundary`] gives it.
    #[must_use]
    pub fn boundary(self, label: impl Into<String>, pieces: Vec<Piece>) -> Self {
        Self {
            boundary: Some((label.into(), pieces)),
            ..self
        }
    }

    fn shades(&self) -> (f64, f64) {
        match &self.bar {
            Bar::Classes(classes) => (0.0, classes.len().max(2) as f64 - 1.0),
            Bar::Continuous {
                range: Some(range), ..
            } => *range,
            Bar::Continuous { range: None, .. } => {
                let finite = self
                    .values
                    .iter()
                    .flatten()
                    .copied()
                    .filter(|value| value.is_finite());
                let (low, high) = finite
                    .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
                        (low.min(value), high.max(value))
                    });
                if high > low { (low, high) } else { (0.0, 1.0) }
            }
        }
    }

    fn draw_cells(&self, svg: &mut Svg, x: &Layout, y: &Layout, (low, high): (f64, f64)) {
        let (x_edges, y_edges) = (edges(&self.x), edges(&self.y));
        for (row, values) in self.values.iter().enumerate().take(self.y.len()) {
            for (column, value) in values.iter().enumerate().take(self.x.len()) {
                if !value.is_finite() {
                    continue;
                }
                let (left, right) = (x.pixel(x_edges[column]), x.pixel(x_edges[column + 1]));
                let (bottom, top) = (y.pixel(y_edges[row]), y.pixel(y_edges[row + 1]));
                let colour = gradient((value - low) / (high - low));
                svg.cell(left, top, right - left, bottom - top, &colour);
            }
        }
    }

    fn draw_bar(&self, svg: &mut Svg, plot: Area, (low, high): (f64, f64)) {
        let (x, width) = (plot.x + plot.width + 16.0, 16.0);
        match &self.bar {
            Bar::Classes(classes) => {
                for (index, class) in classes.iter().enumerate() {
                    let y = plot.y + 22.0 * index as f64;
                    svg.rectangle(x, y, width, 14.0, &gradient(index as f64 / (high - low)));
                    svg.frame(x, y, width, 14.0);
                    svg.text((x + width + 6.0, y + 12.0), Anchor::Start, class);
                }
            }
            Bar::Continuous { label, .. } => {
                let slices = 64;
                let height = plot.height / f64::from(slices);
                for slice in 0..slices {
                    let colour = gradient((f64::from(slice) + 0.5) / f64::from(slices));
                    let top = plot.y + plot.height - f64::from(slice + 1) * height;
                    svg.cell(x, top, width, height, &colour);
                }
                svg.frame(x, plot.y, width, plot.height);
                let mut longest = 0;
                for (value, text) in linear_ticks(low, high, (plot.height / 45.0) as usize) {
                    longest = longest.max(text.chars().count());
                    let y = plot.y + plot.height * (1.0 - (value - low) / (high - low));
                    svg.text((x + width + 5.0, y + 4.0), Anchor::Start, &text);
                }
                // Near enough to the bar not to pass for the axis of the panel beside it.
                let room = (24.0 + 7.5 * longest as f64).min(62.0);
                svg.text_upward((x + width + room, plot.y + plot.height / 2.0), label);
            }
        }
    }
}

impl Panel for HeatMap {
    fn draw(&self, svg: &mut Svg, area: Area) {
        let edge = Style {
            colour: "#ffffff",
            dashes: None,
            width: 3.2,
        };
        let line = Style {
            colour: "#000000",
            dashes: None,
            width: 1.4,
        };
        let legend: Vec<_> = self
            .boundary
            .iter()
            .map(|(label, _)| (label.as_str(), line, None))
            .collect();
        let head = draw_head(svg, area, &self.title, &legend);
        let room = if matches!(self.bar, Bar::Classes(_)) {
            124.0
        } else {
            88.0
        };
        let plot = inner(
            Area {
                width: area.width - room,
                ..area
            },
            head,
        );
        let x = self
            .x_axis
            .lay_out_exactly(&edges(&self.x), (plot.x, plot.x + plot.width));
        let y = self
            .y_axis
            .lay_out_exactly(&edges(&self.y), (plot.y + plot.height, plot.y));
        draw_axes(svg, plot, (&self.x_axis, &x), (&self.y_axis, &y));
        let shades = self.shades();
        svg.clipped(plot.x, plot.y, plot.width, plot.height, |svg| {
            self.draw_cells(svg, &x, &y, shades);
            let place = |point: (f64, f64)| (x.pixel(point.0), y.pixel(point.1));
            for style in [edge, line] {
                for piece in self.boundary.iter().flat_map(|(_, pieces)| pieces) {
                    svg.line(place(piece[0]), place(piece[1]), style);
                }
            }
        });
        svg.frame(plot.x, plot.y, plot.width, plot.height);
        self.draw_bar(svg, plot, shades);
    }
}

/// Edges of the cells around the given centres.
fn edges(centres: &[f64]) -> Vec<f64> {
    match centres {
        [] => vec![0.0, 1.0],
        [only] => vec![only - 0.5, only + 0.5],
        _ => {
            let last = centres.len() - 1;
            let between = centres.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]));
            std::iter::once(1.5 * centres[0] - 0.5 * centres[1])
                .chain(between)
                .chain([1.5 * centres[last] - 0.5 * centres[last - 1]])
                .collect()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_reach_half_way_to_their_neighbours() {
        assert_eq!(edges(&[0.0, 1.0, 3.0]), [-0.5, 0.5, 2.0, 4.0]);
        assert_eq!(edges(&[5.0]), [4.5, 5.5]);
    }

    #[test]
    fn missing_values_leave_no_cell() {
        let drawn = |value: f64| {
            let axis = || (Axis::new("x"), vec![0.0, 1.0]);
            let map = HeatMap::continuous(
                axis(),
                axis(),
                vec![vec![0.0, 1.0], vec![2.0, value]],
                "value",
            );
            let mut svg = Svg::new(400.0, 300.0);
            map.draw(
                &mut svg,
                Area {
                    x: 0.0,
                    y: 0.0,
                    width: 400.0,
                    height: 300.0,
                },
            );
            svg.finish().matches("crispEdges").count()
        };
        assert_eq!(drawn(3.0), drawn(f64::NAN) + 1);
    }
}
