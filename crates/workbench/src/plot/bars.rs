//! Horizontal bars with names and intervals.

use super::chart::draw_head;
use super::figure::{Area, Panel};
use super::scale::Axis;
use super::style::{GRID, Marker, Style, TEXT};
use super::svg::{Anchor, Svg, text_width};

/// One bar.
#[derive(Debug, Clone, PartialEq)]
pub struct Bar {
    /// Its name, at the left.
    pub name: String,
    /// Its length in the axis' unit.
    pub value: f64,
    /// Lower and upper bound in the axis' unit.
    pub interval: Option<(f64, f64)>,
    /// Whether it is the one to look at.
    pub stressed: bool,
}

/// A panel of horizontal bars from zero, first bar on top.
#[derive(Debug, Clone)]
pub struct Bars {
    title: String,
    axis: Axis,
    bars: Vec<Bar>,
    limits: Vec<(String, f64)>,
}

impl Bars {
    /// Bars along `axis`.
    #[must_use]
    pub fn new(axis: Axis, bars: Vec<Bar>) -> Self {
        Self {
            title: String::new(),
            axis,
            bars,
            limits: Vec::new(),
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

    /// Adds a dashed line across all bars, such as a limit to pass.
    #[must_use]
    pub fn limit(mut self, label: impl Into<String>, value: f64) -> Self {
        self.limits.push((label.into(), value));
        self
    }

    /// A height [px] that suits the number of bars.
    #[must_use]
    pub fn natural_height(&self) -> f64 {
        84.0 + 22.0 * self.bars.len() as f64
    }
}

impl Panel for Bars {
    fn draw(&self, svg: &mut Svg, area: Area) {
        let legend: Vec<(&str, Style, Option<Marker>)> = self
            .limits
            .iter()
            .map(|(label, _)| (label.as_str(), Style::reference(), None))
            .collect();
        let head = draw_head(svg, area, &self.title, &legend);
        let names = self
            .bars
            .iter()
            .map(|bar| text_width(&bar.name, TEXT))
            .fold(40.0, f64::max);
        let left = area.x + (names + 14.0).min(0.5 * area.width);
        let (top, bottom, right) = (
            area.y + head,
            area.y + area.height - 40.0,
            area.x + area.width - 14.0,
        );
        let values = self
            .bars
            .iter()
            .flat_map(|bar| {
                [
                    Some(bar.value),
                    bar.interval.map(|bounds| bounds.0),
                    bar.interval.map(|bounds| bounds.1),
                ]
            })
            .flatten()
            .chain(self.limits.iter().map(|limit| limit.1))
            .chain([0.0]);
        let x = self.axis.lay_out(values, (left, right));
        svg.ticks(|svg| {
            for (value, label) in x.ticks(((right - left) / 80.0) as usize) {
                let at = x.pixel(value);
                svg.line(
                    (at, top),
                    (at, bottom),
                    Style {
                        colour: GRID,
                        dashes: None,
                        width: 0.8,
                    },
                );
                svg.text((at, bottom + 15.0), Anchor::Middle, &label);
            }
        });
        let pitch = (bottom - top) / self.bars.len().max(1) as f64;
        let place = Area {
            x: left,
            y: top,
            width: right - left,
            height: bottom - top,
        };
        let bars = |svg: &mut Svg| {
            for (index, bar) in self.bars.iter().enumerate() {
                let middle = top + (index as f64 + 0.5) * pitch;
                let (from, to) = (x.pixel(0.0), x.pixel(bar.value));
                let colour = if bar.stressed {
                    Style::series(0).colour
                } else {
                    Style::series(2).colour
                };
                if from.is_finite() && to.is_finite() {
                    svg.rectangle(
                        from.min(to),
                        middle - 0.32 * pitch,
                        (to - from).abs(),
                        0.64 * pitch,
                        colour,
                    );
                }
                if let Some((lower, upper)) = bar.interval {
                    let (lower, upper) = (x.pixel(lower), x.pixel(upper));
                    // A white edge keeps the interval visible over a dark bar.
                    for (colour, width) in [("#ffffff", 3.6), ("#000000", 1.2)] {
                        let line = Style {
                            colour,
                            dashes: None,
                            width,
                        };
                        svg.line((lower, middle), (upper, middle), line);
                        svg.line((lower, middle - 4.0), (lower, middle + 4.0), line);
                        svg.line((upper, middle - 4.0), (upper, middle + 4.0), line);
                    }
                }
            }
            for (_, value) in &self.limits {
                svg.line(
                    (x.pixel(*value), top),
                    (x.pixel(*value), bottom),
                    Style::reference().wide(1.4),
                );
            }
        };
        match x.linear_ends() {
            Some(ends) => svg.zoomable(place, ends, None, bars),
            None => svg.clipped(place.x, place.y, place.width, place.height, bars),
        }
        for (index, bar) in self.bars.iter().enumerate() {
            let middle = top + (index as f64 + 0.5) * pitch;
            svg.text((left - 6.0, middle + 4.0), Anchor::End, &bar.name);
        }
        svg.frame(left, top, right - left, bottom - top);
        svg.text(
            ((left + right) / 2.0, bottom + 32.0),
            Anchor::Middle,
            self.axis.label(),
        );
    }
}
