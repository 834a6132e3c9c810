//! Curves, points, bands and histograms over two axes.

use super::figure::{Area, Panel};
use super::scale::{Axis, Layout};
use super::style::{GRID, INK, Marker, PANEL_TITLE, Style, TEXT};
use super::svg::{Anchor, Svg, text_width};

/// A panel with two axes.
#[derive(Debug, Clone)]
pub struct Chart {
    title: String,
    x_axis: Axis,
    y_axis: Axis,
    marks: Vec<Mark>,
}

#[derive(Debug, Clone)]
struct Mark {
    label: String,
    style: Style,
    shape: Shape,
}

#[derive(Debug, Clone)]
enum Shape {
    Line(Vec<(f64, f64)>),
    Points(Vec<(f64, f64)>, Marker),
    /// (x, lower, upper)
    Band(Vec<(f64, f64, f64)>),
    /// (x, value, lower, upper)
    Intervals(Vec<(f64, f64, f64, f64)>),
    /// (left, right, height)
    Columns(Vec<(f64, f64, f64)>),
    Vertical(f64),
    Horizontal(f64),
}

impl Chart {
    /// An empty chart.
    #[must_use]
    pub fn new(x_axis: Axis, y_axis: Axis) -> Self {
        Self {
            title: String::new(),
            x_axis,
            y_axis,
            marks: Vec::new(),
        }
    }

    /// The same chart with a title.
    #[must_use]
    pub fn title(self, title: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            ..self
        }
    }

    /// Adds a curve; it breaks at NaN. An empty label keeps it out of the legend.
    #[must_use]
    pub fn line(self, label: impl Into<String>, x: &[f64], y: &[f64], style: Style) -> Self {
        self.mark(label, style, Shape::Line(pairs(x, y)))
    }

    /// Adds single points.
    #[must_use]
    pub fn points(
        self,
        label: impl Into<String>,
        x: &[f64],
        y: &[f64],
        marker: Marker,
        style: Style,
    ) -> Self {
        self.mark(label, style, Shape::Points(pairs(x, y), marker))
    }

    /// Adds published values: white diamonds with a black edge.
    #[must_use]
    pub fn published(self, label: impl Into<String>, x: &[f64], y: &[f64]) -> Self {
        self.points(label, x, y, Marker::Diamond, Style::reference())
    }

    /// Adds a shaded band between `lower` and `upper`.
    #[must_use]
    pub fn band(
        self,
        label: impl Into<String>,
        x: &[f64],
        lower: &[f64],
        upper: &[f64],
        style: Style,
    ) -> Self {
        let points = x
            .iter()
            .zip(lower)
            .zip(upper)
            .map(|((&x, &lower), &upper)| (x, lower, upper))
            .collect();
        self.mark(label, style, Shape::Band(points))
    }

    /// Adds points with intervals; each entry is (x, value, lower, upper).
    #[must_use]
    pub fn intervals(
        self,
        label: impl Into<String>,
        points: &[(f64, f64, f64, f64)],
        style: Style,
    ) -> Self {
        self.mark(label, style, Shape::Intervals(points.to_vec()))
    }

    /// Adds a histogram of the finite ones of `values` over `bins` equal bins; its heights are numbers of values.
    #[must_use]
    pub fn histogram(
        self,
        label: impl Into<String>,
        values: &[f64],
        bins: usize,
        style: Style,
    ) -> Self {
        self.mark(label, style, Shape::Columns(count_into_bins(values, bins)))
    }

    /// Adds a vertical line over the whole height.
    #[must_use]
    pub fn vertical(self, label: impl Into<String>, x: f64, style: Style) -> Self {
        self.mark(label, style, Shape::Vertical(x))
    }

    /// Adds a horizontal line over the whole width.
    #[must_use]
    pub fn horizontal(self, label: impl Into<String>, y: f64, style: Style) -> Self {
        self.mark(label, style, Shape::Horizontal(y))
    }

    fn mark(mut self, label: impl Into<String>, style: Style, shape: Shape) -> Self {
        self.marks.push(Mark {
            label: label.into(),
            style,
            shape,
        });
        self
    }
}

impl Panel for Chart {
    fn draw(&self, svg: &mut Svg, area: Area) {
        let legend: Vec<(&str, Style, Option<Marker>)> = self
            .marks
            .iter()
            .filter(|mark| !mark.label.is_empty())
            .map(|mark| (mark.label.as_str(), mark.style, mark.shape.marker()))
            .collect();
        let head = draw_head(svg, area, &self.title, &legend);
        let plot = inner(area, head);
        let (x_values, y_values) = (self.values(Shape::x_values), self.values(Shape::y_values));
        let x = self
            .x_axis
            .lay_out(x_values.into_iter(), (plot.x, plot.x + plot.width));
        let y = self
            .y_axis
            .lay_out(y_values.into_iter(), (plot.y + plot.height, plot.y));
        draw_axes(svg, plot, (&self.x_axis, &x), (&self.y_axis, &y));
        let marks = |svg: &mut Svg| {
            for mark in &self.marks {
                mark.draw(svg, &x, &y, plot);
            }
        };
        match (x.linear_ends(), y.linear_ends()) {
            (Some(x), Some(y)) => svg.zoomable(plot, x, Some(y), marks),
            _ => svg.clipped(plot.x, plot.y, plot.width, plot.height, marks),
        }
        svg.frame(plot.x, plot.y, plot.width, plot.height);
    }
}

impl Chart {
    fn values(&self, of: impl Fn(&Shape) -> Vec<f64>) -> Vec<f64> {
        self.marks.iter().flat_map(|mark| of(&mark.shape)).collect()
    }
}

impl Shape {
    fn marker(&self) -> Option<Marker> {
        match self {
            Self::Points(_, marker) => Some(*marker),
            Self::Intervals(_) => Some(Marker::Dot),
            Self::Band(_) | Self::Columns(_) => Some(Marker::Square),
            Self::Line(_) | Self::Vertical(_) | Self::Horizontal(_) => None,
        }
    }

    fn x_values(&self) -> Vec<f64> {
        match self {
            Self::Line(points) | Self::Points(points, _) => {
                points.iter().map(|point| point.0).collect()
            }
            Self::Band(points) => points.iter().map(|point| point.0).collect(),
            Self::Intervals(points) => points.iter().map(|point| point.0).collect(),
            Self::Columns(columns) => columns
                .iter()
                .flat_map(|column| [column.0, column.1])
                .collect(),
            Self::Vertical(x) => vec![*x],
            Self::Horizontal(_) => Vec::new(),
        }
    }

    fn y_values(&self) -> Vec<f64> {
        match self {
            Self::Line(points) | Self::Points(points, _) => {
                points.iter().map(|point| point.1).collect()
            }
            Self::Band(points) => points.iter().flat_map(|point| [point.1, point.2]).collect(),
            Self::Intervals(points) => points
                .iter()
                .flat_map(|point| [point.1, point.2, point.3])
                .collect(),
            Self::Columns(columns) => columns.iter().map(|column| column.2).chain([0.0]).collect(),
            Self::Vertical(_) => Vec::new(),
            Self::Horizontal(y) => vec![*y],
        }
    }
}

impl Mark {
    fn draw(&self, svg: &mut Svg, x: &Layout, y: &Layout, plot: Area) {
        let style = self.style;
        let place = |point: &(f64, f64)| (x.pixel(point.0), y.pixel(point.1));
        match &self.shape {
            Shape::Line(points) => svg.curve(&points.iter().map(place).collect::<Vec<_>>(), style),
            Shape::Points(points, marker) => {
                let size = 2.0 + style.width;
                points
                    .iter()
                    .for_each(|point| svg.marker(place(point), *marker, style.colour, size));
            }
            Shape::Band(points) => {
                let forth = points.iter().map(|&(at, _, upper)| place(&(at, upper)));
                let back = points
                    .iter()
                    .rev()
                    .map(|&(at, lower, _)| place(&(at, lower)));
                let outline: Vec<(f64, f64)> = forth
                    .chain(back)
                    .filter(|(x, y)| x.is_finite() && y.is_finite())
                    .collect();
                svg.polygon(&outline, style.colour, 0.22);
            }
            Shape::Intervals(points) => {
                for &(at, value, lower, upper) in points {
                    svg.line(place(&(at, lower)), place(&(at, upper)), style.solid());
                    svg.marker(
                        place(&(at, value)),
                        Marker::Dot,
                        style.colour,
                        2.0 + style.width,
                    );
                }
            }
            Shape::Columns(columns) => {
                for &(left, right, height) in columns {
                    let outline = [(left, 0.0), (left, height), (right, height), (right, 0.0)]
                        .map(|point| place(&point));
                    svg.polygon(&outline, style.colour, 0.55);
                    svg.curve(&outline, style.solid().wide(0.8));
                }
            }
            Shape::Vertical(at) => {
                svg.line(
                    (x.pixel(*at), plot.y),
                    (x.pixel(*at), plot.y + plot.height),
                    style,
                );
            }
            Shape::Horizontal(at) => svg.line(
                (plot.x, y.pixel(*at)),
                (plot.x + plot.width, y.pixel(*at)),
                style,
            ),
        }
    }
}

/// Draws title and legend; returns the height they take [px].
pub(super) fn draw_head(
    svg: &mut Svg,
    area: Area,
    title: &str,
    legend: &[(&str, Style, Option<Marker>)],
) -> f64 {
    let mut y = area.y + 6.0;
    if !title.is_empty() {
        y += PANEL_TITLE + 2.0;
        svg.text_with(
            (area.x + area.width / 2.0 + 22.0, y),
            Anchor::Middle,
            PANEL_TITLE,
            INK,
            title,
        );
        y += 4.0;
    }
    let (left, right) = (area.x + 64.0, area.x + area.width - 14.0);
    let mut x = left;
    for (index, (label, style, marker)) in legend.iter().enumerate() {
        let width = 34.0 + text_width(label, TEXT);
        if index == 0 {
            y += TEXT + 2.0;
        } else if x + width > right {
            x = left;
            y += TEXT + 4.0;
        }
        let middle = y - 0.35 * TEXT;
        match marker {
            Some(marker) => svg.marker((x + 12.0, middle), *marker, style.colour, 4.0),
            None => svg.line((x, middle), (x + 24.0, middle), *style),
        }
        svg.text((x + 29.0, y), Anchor::Start, label);
        x += width + 10.0;
    }
    y - area.y + if legend.is_empty() { 2.0 } else { 6.0 }
}

/// The rectangle of the data inside a panel.
pub(super) fn inner(area: Area, head: f64) -> Area {
    let (left, right, foot) = (64.0, 14.0, 40.0);
    Area {
        x: area.x + left,
        y: area.y + head,
        width: (area.width - left - right).max(10.0),
        height: (area.height - head - foot).max(10.0),
    }
}

/// Draws grid, ticks and labels.
pub(super) fn draw_axes(svg: &mut Svg, plot: Area, x: (&Axis, &Layout), y: (&Axis, &Layout)) {
    let grid = Style {
        colour: GRID,
        dashes: None,
        width: 0.8,
    };
    let (right, bottom) = (plot.x + plot.width, plot.y + plot.height);
    svg.ticks(|svg| {
        for (value, label) in x.1.ticks((plot.width / 80.0) as usize) {
            let at = x.1.pixel(value);
            svg.line((at, plot.y), (at, bottom), grid);
            svg.text((at, bottom + 15.0), Anchor::Middle, &label);
        }
        for (value, label) in y.1.ticks((plot.height / 36.0) as usize) {
            let at = y.1.pixel(value);
            svg.line((plot.x, at), (right, at), grid);
            svg.text((plot.x - 6.0, at + 4.0), Anchor::End, &label);
        }
    });
    svg.text(
        (plot.x + plot.width / 2.0, bottom + 32.0),
        Anchor::Middle,
        x.0.label(),
    );
    svg.text_upward((plot.x - 48.0, plot.y + plot.height / 2.0), y.0.label());
}

fn pairs(x: &[f64], y: &[f64]) -> Vec<(f64, f64)> {
    x.iter().copied().zip(y.iter().copied()).collect()
}

fn count_into_bins(values: &[f64], bins: usize) -> Vec<(f64, f64, f64)> {
    let finite: Vec<f64> = values
        .iter()
        .copied()
        .filter(|value| value.is_finite())
        .collect();
    let low = finite.iter().copied().fold(f64::INFINITY, f64::min);
    let high = finite.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if finite.is_empty() || bins == 0 {
        return Vec::new();
    }
    let width = if high > low {
        (high - low) / bins as f64
    } else {
        low.abs().max(1.0) / bins as f64
    };
    let mut counts = vec![0_u32; bins];
    for value in finite {
        counts[(((value - low) / width) as usize).min(bins - 1)] += 1;
    }
    counts
        .into_iter()
        .enumerate()
        .map(|(bin, count)| {
            (
                low + bin as f64 * width,
                low + (bin + 1) as f64 * width,
                f64::from(count),
            )
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_finite_value_is_in_a_bin() {
        let bins = count_into_bins(&[0.0, 0.1, 0.5, 1.0, f64::NAN], 2);
        assert_eq!(bins, [(0.0, 0.5, 2.0), (0.5, 1.0, 2.0)]);
        assert_eq!(count_into_bins(&[3.0, 3.0], 4)[0].2, 2.0);
        assert!(count_into_bins(&[f64::NAN], 4).is_empty());
    }

    #[test]
    fn an_empty_chart_draws() {
        let mut svg = Svg::new(300.0, 200.0);
        let area = Area {
            x: 0.0,
            y: 0.0,
            width: 300.0,
            height: 200.0,
        };
        Chart::new(Axis::new("time [s]"), Axis::new("θ̇₂ [rad/s]")).draw(&mut svg, area);
        assert!(svg.finish().contains("time [s]"));
    }
}
