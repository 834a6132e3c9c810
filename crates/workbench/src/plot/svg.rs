//! A small writer of SVG.

use std::fmt::Write as _;

use super::figure::Area;
use super::style::{INK, Marker, Style, TEXT};

/// Where the given point lies in a text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    /// The text begins there.
    Start,
    /// The text is centred there.
    Middle,
    /// The text ends there.
    End,
}

/// An SVG picture being written. Coordinates in pixels, y downward.
///
/// Nothing in it refers to an id, so several pictures can stand in one HTML page.
#[derive(Debug, Clone)]
pub struct Svg {
    width: f64,
    height: f64,
    body: String,
}

impl Svg {
    /// An empty white picture [px].
    #[must_use]
    pub fn new(width: f64, height: f64) -> Self {
        let mut svg = Self {
            width,
            height,
            body: String::new(),
        };
        svg.rectangle(0.0, 0.0, width, height, "#ffffff");
        svg
    }

    /// The finished document.
    #[must_use]
    pub fn finish(self) -> String {
        let (width, height) = (short(self.width), short(self.height));
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {width} {height}\" font-family=\"DejaVu Sans, Verdana, sans-serif\">\n{}</svg>\n",
            self.body
        )
    }

    /// A curve through `points`; it breaks where a coordinate is not finite.
    pub fn curve(&mut self, points: &[(f64, f64)], style: Style) {
        let path = path_through(points);
        if path.is_empty() {
            return;
        }
        let dashes = style
            .dashes
            .map(|dashes| format!(" stroke-dasharray=\"{dashes}\""))
            .unwrap_or_default();
        self.put(format_args!(
            "<path d=\"{path}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" stroke-linejoin=\"round\"{dashes}/>",
            style.colour,
            short(style.width)
        ));
    }

    /// A filled polygon.
    pub fn polygon(&mut self, points: &[(f64, f64)], fill: &str, opacity: f64) {
        let path = path_through(points);
        if !path.is_empty() {
            self.put(format_args!(
                "<path d=\"{path}Z\" fill=\"{fill}\" fill-opacity=\"{}\"/>",
                short(opacity)
            ));
        }
    }

    /// A filled polygon with a thin edge, as a facet of a surface.
    pub fn facet(&mut self, points: &[(f64, f64)], fill: &str, edge: &str) {
        let path = path_through(points);
        if !path.is_empty() {
            self.put(format_args!(
                "<path d=\"{path}Z\" fill=\"{fill}\" stroke=\"{edge}\" stroke-width=\"0.4\" stroke-linejoin=\"round\"/>"
            ));
        }
    }

    /// A filled rectangle without edge.
    pub fn rectangle(&mut self, x: f64, y: f64, width: f64, height: f64, fill: &str) {
        self.put(format_args!(
            "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"{fill}\"/>",
            short(x),
            short(y),
            short(width),
            short(height)
        ));
    }

    /// A cell of a map: a filled rectangle whose edges keep to whole pixels, so that neighbours show no seam.
    pub fn cell(&mut self, x: f64, y: f64, width: f64, height: f64, fill: &str) {
        self.put(format_args!(
            "<path d=\"M{} {}h{}v{}h{}z\" fill=\"{fill}\" shape-rendering=\"crispEdges\"/>",
            short(x),
            short(y),
            short(width),
            short(height),
            short(-width)
        ));
    }

    /// An empty rectangle with a thin edge.
    pub fn frame(&mut self, x: f64, y: f64, width: f64, height: f64) {
        self.put(format_args!(
            "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"{INK}\" stroke-width=\"0.9\"/>",
            short(x),
            short(y),
            short(width),
            short(height)
        ));
    }

    /// A straight line.
    pub fn line(&mut self, from: (f64, f64), to: (f64, f64), style: Style) {
        self.curve(&[from, to], style);
    }

    /// A marker at a point.
    pub fn marker(&mut self, at: (f64, f64), marker: Marker, colour: &str, size: f64) {
        if !(at.0.is_finite() && at.1.is_finite()) {
            return;
        }
        let (x, y) = at;
        match marker {
            Marker::Dot => self.put(format_args!(
                "<circle cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"{colour}\"/>",
                short(x),
                short(y),
                short(size)
            )),
            Marker::Ring => self.put(format_args!(
                "<circle cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.2\"/>",
                short(x),
                short(y),
                short(size)
            )),
            Marker::Square => self.rectangle(x - size, y - size, 2.0 * size, 2.0 * size, colour),
            Marker::Cross => self.put(format_args!(
                "<path d=\"M{} {}L{} {}M{} {}L{} {}\" stroke=\"{colour}\" stroke-width=\"1.4\"/>",
                short(x - size),
                short(y - size),
                short(x + size),
                short(y + size),
                short(x - size),
                short(y + size),
                short(x + size),
                short(y - size)
            )),
            Marker::Diamond => {
                let reach = 1.35 * size;
                self.put(format_args!(
                    "<path d=\"M{} {}L{} {}L{} {}L{} {}Z\" fill=\"#ffffff\" stroke=\"#000000\" stroke-width=\"1.4\"/>",
                    short(x - reach),
                    short(y),
                    short(x),
                    short(y - reach),
                    short(x + reach),
                    short(y),
                    short(x),
                    short(y + reach)
                ));
            }
        }
    }

    /// A text of ordinary size.
    pub fn text(&mut self, at: (f64, f64), anchor: Anchor, content: &str) {
        self.text_with(at, anchor, TEXT, INK, content);
    }

    /// A text of the given size [px] and colour.
    pub fn text_with(
        &mut self,
        at: (f64, f64),
        anchor: Anchor,
        size: f64,
        colour: &str,
        content: &str,
    ) {
        self.put(format_args!(
            "<text x=\"{}\" y=\"{}\" text-anchor=\"{}\" font-size=\"{}\" fill=\"{colour}\">{}</text>",
            short(at.0),
            short(at.1),
            anchor_name(anchor),
            short(size),
            escape(content)
        ));
    }

    /// A text of ordinary size that reads upward, centred at the point.
    pub fn text_upward(&mut self, at: (f64, f64), content: &str) {
        let (x, y) = (short(at.0), short(at.1));
        self.put(format_args!(
            "<text x=\"{x}\" y=\"{y}\" text-anchor=\"middle\" font-size=\"{TEXT}\" fill=\"{INK}\" \
             transform=\"rotate(-90 {x} {y})\">{}</text>",
            escape(content)
        ));
    }

    /// Draws with `draw` what must not show outside the rectangle.
    pub fn clipped(
        &mut self,
        x: f64,
        y: f64,
        width: f64,
        height: f64,
        draw: impl FnOnce(&mut Self),
    ) {
        // A nested picture clips without needing an id.
        let (x, y, width, height) = (short(x), short(y), short(width), short(height));
        self.put(format_args!(
            "<svg x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" viewBox=\"{x} {y} {width} {height}\" overflow=\"hidden\">"
        ));
        draw(self);
        self.put(format_args!("</svg>"));
    }

    /// Draws grid, ticks and their labels with `draw`, as one group that a page can draw anew.
    pub fn ticks(&mut self, draw: impl FnOnce(&mut Self)) {
        self.put(format_args!("<g class=\"ticks\">"));
        draw(self);
        self.put(format_args!("</g>"));
    }

    /// As [`Svg::clipped`], for data over linear axes: the values at the left and right edge, and at the lower and upper one
    /// where the vertical axis has values, tell a page how to zoom.
    pub fn zoomable(
        &mut self,
        area: Area,
        x: (f64, f64),
        y: Option<(f64, f64)>,
        draw: impl FnOnce(&mut Self),
    ) {
        let [left, top, width, height] = [area.x, area.y, area.width, area.height].map(short);
        let vertical = y.map_or(String::new(), |(low, high)| {
            format!(" data-y=\"{low} {high}\"")
        });
        self.put(format_args!(
            "<svg class=\"data\" data-x=\"{} {}\"{vertical} x=\"{left}\" y=\"{top}\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"{left} {top} {width} {height}\" preserveAspectRatio=\"none\" overflow=\"hidden\">",
            x.0, x.1
        ));
        draw(self);
        self.put(format_args!("</svg>"));
    }

    fn put(&mut self, element: std::fmt::Arguments<'_>) {
        // Writing to a string cannot fail.
        let _ = self.body.write_fmt(element);
        self.body.push('\n');
    }
}

/// Width of a text of the given size [px], estimated: enough to place a legend.
pub(super) fn text_width(content: &str, size: f64) -> f64 {
    0.6 * size * content.chars().count() as f64
}

fn anchor_name(anchor: Anchor) -> &'static str {
    match anchor {
        Anchor::Start => "start",
        Anchor::Middle => "middle",
        Anchor::End => "end",
    }
}

/// A pixel coordinate with at most two decimals.
fn short(value: f64) -> String {
    let mut text = format!("{value:.2}");
    while text.ends_with('0') {
        text.pop();
    }
    if text.ends_with('.') {
        text.pop();
    }
    if text == "-0" { "0".to_owned() } else { text }
}

/// The path through the points. Points nearer than a quarter of a pixel to the last one kept are left out: long records
/// would make pictures of many megabytes.
fn path_through(points: &[(f64, f64)]) -> String {
    let mut path = String::new();
    let mut last: Option<(f64, f64)> = None;
    let mut skipped: Option<(f64, f64)> = None;
    for &(x, y) in points {
        if !(x.is_finite() && y.is_finite()) {
            push_point(&mut path, 'L', skipped.take());
            last = None;
            continue;
        }
        match last {
            Some((last_x, last_y)) if (x - last_x).hypot(y - last_y) < 0.25 => {
                skipped = Some((x, y))
            }
            _ => {
                push_point(
                    &mut path,
                    if last.is_some() { 'L' } else { 'M' },
                    Some((x, y)),
                );
                last = Some((x, y));
                skipped = None;
            }
        }
    }
    push_point(&mut path, 'L', skipped);
    path
}

fn push_point(path: &mut String, command: char, point: Option<(f64, f64)>) {
    if let Some((x, y)) = point {
        let _ = write!(path, "{command}{} {}", short(x), short(y));
    }
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_break_at_missing_values_and_drop_invisible_points() {
        let points = [
            (0.0, 0.0),
            (0.1, 0.0),
            (0.2, 0.0),
            (5.0, 1.0),
            (f64::NAN, 0.0),
            (7.0, 1.0),
            (8.0, 2.0),
        ];
        assert_eq!(path_through(&points), "M0 0L5 1M7 1L8 2");
        assert_eq!(path_through(&[(0.0, 0.0), (0.1, 0.1)]), "M0 0L0.1 0.1");
        assert_eq!(path_through(&[]), "");
    }

    #[test]
    fn text_is_escaped() {
        let mut svg = Svg::new(10.0, 10.0);
        svg.text((0.0, 0.0), Anchor::Start, "a < b & c");
        assert!(svg.finish().contains(">a &lt; b &amp; c</text>"));
    }
}
