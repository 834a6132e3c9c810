//! Curves and surfaces in three dimensions, seen along parallel rays (an axonometric view).

use super::chart::draw_head;
use super::figure::{Area, Panel};
use super::scale::{Axis, Layout};
use super::style::{GRID, Marker, Style, gradient};
use super::svg::{Anchor, Svg};

/// From where the box is seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// Angle about the vertical axis [degree]; 0 looks along +y.
    pub azimuth: f64,
    /// Angle above the horizontal plane [degree], 0 … 90.
    pub elevation: f64,
    /// Lengths of the box along x, y and z, relative to each other.
    pub proportions: [f64; 3],
}

impl Default for View {
    fn default() -> Self {
        Self {
            azimuth: 32.0,
            elevation: 24.0,
            proportions: [1.0, 1.0, 0.7],
        }
    }
}

/// A panel with three axes, z upward.
#[derive(Debug, Clone)]
pub struct Space {
    title: String,
    axes: [Axis; 3],
    view: View,
    curves: Vec<(String, Vec<[f64; 3]>, Style)>,
    points: Vec<(String, Vec<[f64; 3]>, Marker, Style)>,
    /// Facets of four corners, coloured by their height.
    facets: Vec<[[f64; 3]; 4]>,
}

impl Space {
    /// An empty box.
    #[must_use]
    pub fn new(x_axis: Axis, y_axis: Axis, z_axis: Axis) -> Self {
        Self {
            title: String::new(),
            axes: [x_axis, y_axis, z_axis],
            view: View::default(),
            curves: Vec::new(),
            points: Vec::new(),
            facets: Vec::new(),
        }
    }

    /// The same box with a title.
    #[must_use]
    pub fn title(self, title: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            ..self
        }
    }

    /// The same box seen from elsewhere.
    #[must_use]
    pub fn view(self, view: View) -> Self {
        Self { view, ..self }
    }

    /// Adds a curve, such as one phase portrait of a stack. An empty label keeps it out of the legend.
    #[must_use]
    pub fn curve(mut self, label: impl Into<String>, points: Vec<[f64; 3]>, style: Style) -> Self {
        self.curves.push((label.into(), points, style));
        self
    }

    /// Adds single points.
    #[must_use]
    pub fn points(
        mut self,
        label: impl Into<String>,
        points: Vec<[f64; 3]>,
        marker: Marker,
        style: Style,
    ) -> Self {
        self.points.push((label.into(), points, marker, style));
        self
    }

    /// Adds the surface z(`x[column]`, `y[row]`) = `z[row][column]`, coloured by height; facets with a NaN are left out.
    #[must_use]
    pub fn surface(mut self, x: &[f64], y: &[f64], z: &[Vec<f64>]) -> Self {
        for (row, pair) in z.windows(2).enumerate().take(y.len().saturating_sub(1)) {
            for column in 1..x.len().min(pair[0].len()).min(pair[1].len()) {
                let corner = |column: usize, up: usize| [x[column], y[row + up], pair[up][column]];
                let facet = [
                    corner(column - 1, 0),
                    corner(column, 0),
                    corner(column, 1),
                    corner(column - 1, 1),
                ];
                if facet.iter().flatten().all(|value| value.is_finite()) {
                    self.facets.push(facet);
                }
            }
        }
        self
    }

    fn all_points(&self) -> impl Iterator<Item = &[f64; 3]> {
        self.curves
            .iter()
            .flat_map(|curve| &curve.1)
            .chain(self.points.iter().flat_map(|points| &points.1))
            .chain(self.facets.iter().flatten())
    }
}

/// The projection of a box onto a panel.
struct Projection {
    layouts: [Layout; 3],
    view: View,
    centre: (f64, f64),
    scale: f64,
}

impl Projection {
    fn new(space: &Space, plot: Area) -> Self {
        let layouts = [0, 1, 2].map(|axis| {
            let values: Vec<f64> = space.all_points().map(|point| point[axis]).collect();
            space.axes[axis].lay_out(values.into_iter(), (-0.5, 0.5))
        });
        let mut projection = Self {
            layouts,
            view: space.view,
            centre: (0.0, 0.0),
            scale: 1.0,
        };
        let corners: Vec<(f64, f64)> = (0..8)
            .map(|bits| [0, 1, 2].map(|axis| if bits >> axis & 1 == 1 { 0.5 } else { -0.5 }))
            .map(|corner| projection.flatten(corner))
            .collect();
        let reach = |pick: fn(&(f64, f64)) -> f64| {
            let values = corners.iter().map(pick);
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
                (low.min(value), high.max(value))
            })
        };
        let (left, right) = reach(|corner| corner.0);
        let (top, bottom) = reach(|corner| corner.1);
        projection.scale = (plot.width / (right - left)).min(plot.height / (bottom - top));
        projection.centre = (
            plot.x + 0.5 * plot.width - 0.5 * projection.scale * (left + right),
            plot.y + 0.5 * plot.height - 0.5 * projection.scale * (top + bottom),
        );
        projection
    }

    /// Pixel of a point of the unit box, −0.5 … 0.5 along each axis.
    fn flatten(&self, place: [f64; 3]) -> (f64, f64) {
        let (sine, cosine) = self.view.azimuth.to_radians().sin_cos();
        let (lift, flat) = self.view.elevation.to_radians().sin_cos();
        let [x, y, z] = self.stretched(place);
        let across = x * cosine + y * sine;
        let up = z * flat + self.depth_of(x, y, sine, cosine) * lift;
        (
            self.centre.0 + self.scale * across,
            self.centre.1 - self.scale * up,
        )
    }

    fn stretched(&self, place: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|axis| place[axis] * self.view.proportions[axis])
    }

    fn depth_of(&self, x: f64, y: f64, sine: f64, cosine: f64) -> f64 {
        y * cosine - x * sine
    }

    /// Distance from the viewer along the view.
    fn depth(&self, place: [f64; 3]) -> f64 {
        let (sine, cosine) = self.view.azimuth.to_radians().sin_cos();
        let (lift, flat) = self.view.elevation.to_radians().sin_cos();
        let [x, y, z] = self.stretched(place);
        self.depth_of(x, y, sine, cosine) * flat - z * lift
    }

    fn in_box(&self, point: &[f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|axis| self.layouts[axis].pixel(point[axis]))
    }

    fn pixel(&self, point: &[f64; 3]) -> (f64, f64) {
        self.flatten(self.in_box(point))
    }
}

impl Panel for Space {
    fn draw(&self, svg: &mut Svg, area: Area) {
        let curves = self
            .curves
            .iter()
            .map(|(label, _, style)| (label.as_str(), *style, None));
        let points = self
            .points
            .iter()
            .map(|(label, _, marker, style)| (label.as_str(), *style, Some(*marker)));
        let legend: Vec<_> = curves
            .chain(points)
            .filter(|(label, _, _)| !label.is_empty())
            .collect();
        let head = draw_head(svg, area, &self.title, &legend);
        let plot = Area {
            x: area.x + 70.0,
            y: area.y + head + 8.0,
            width: (area.width - 110.0).max(10.0),
            height: (area.height - head - 64.0).max(10.0),
        };
        let projection = Projection::new(self, plot);
        self.draw_box(svg, &projection);
        self.draw_facets(svg, &projection);
        // The farther curves first, so that nearer ones lie over them.
        let mut order: Vec<&(String, Vec<[f64; 3]>, Style)> = self.curves.iter().collect();
        let depth = |points: &[[f64; 3]]| {
            let sum: f64 = points
                .iter()
                .map(|point| projection.depth(projection.in_box(point)))
                .sum();
            sum / points.len().max(1) as f64
        };
        order.sort_by(|left, right| depth(&right.1).total_cmp(&depth(&left.1)));
        for (_, points, style) in order {
            svg.curve(
                &points
                    .iter()
                    .map(|point| projection.pixel(point))
                    .collect::<Vec<_>>(),
                *style,
            );
        }
        for (_, points, marker, style) in &self.points {
            for point in points {
                svg.marker(
                    projection.pixel(point),
                    *marker,
                    style.colour,
                    2.0 + style.width,
                );
            }
        }
    }
}

impl Space {
    fn draw_facets(&self, svg: &mut Svg, projection: &Projection) {
        let mut facets: Vec<(f64, &[[f64; 3]; 4])> = self
            .facets
            .iter()
            .map(|facet| {
                (
                    facet
                        .iter()
                        .map(|corner| projection.depth(projection.in_box(corner)))
                        .sum(),
                    facet,
                )
            })
            .collect();
        facets.sort_by(|left, right| right.0.total_cmp(&left.0));
        for (_, facet) in facets {
            let height = facet
                .iter()
                .map(|corner| projection.in_box(corner)[2])
                .sum::<f64>()
                / 4.0;
            let outline = facet.map(|corner| projection.pixel(&corner));
            svg.facet(&outline, &gradient(height + 0.5), "#33333366");
        }
    }

    /// Floor with grid, the two far walls and the three labelled axes.
    fn draw_box(&self, svg: &mut Svg, projection: &Projection) {
        let grid = Style {
            colour: GRID,
            dashes: None,
            width: 0.8,
        };
        let edge = Style {
            colour: "#555555",
            dashes: None,
            width: 0.9,
        };
        let far = |axis: usize| {
            let mut place = [0.0, 0.0, -0.5];
            place[axis] = 0.5;
            let there = projection.depth(place);
            place[axis] = -0.5;
            if there >= projection.depth(place) {
                0.5
            } else {
                -0.5
            }
        };
        let (far_x, far_y) = (far(0), far(1));
        let line = |svg: &mut Svg, from: [f64; 3], to: [f64; 3], style: Style| {
            svg.line(projection.flatten(from), projection.flatten(to), style);
        };
        for (value, label) in projection.layouts[0].ticks(6) {
            let at = projection.layouts[0].pixel(value);
            line(svg, [at, -0.5, -0.5], [at, 0.5, -0.5], grid);
            line(svg, [at, far_y, -0.5], [at, far_y, 0.5], grid);
            self.tick(
                svg,
                projection,
                [at, -far_y, -0.5],
                [0.0, -far_y, 0.0],
                &label,
            );
        }
        for (value, label) in projection.layouts[1].ticks(6) {
            let at = projection.layouts[1].pixel(value);
            line(svg, [-0.5, at, -0.5], [0.5, at, -0.5], grid);
            line(svg, [far_x, at, -0.5], [far_x, at, 0.5], grid);
            self.tick(
                svg,
                projection,
                [-far_x, at, -0.5],
                [-far_x, 0.0, 0.0],
                &label,
            );
        }
        // The upright labels stand at whichever free corner is at the left.
        let corners = [[far_x, -far_y], [-far_x, far_y]];
        let across = |corner: [f64; 2]| projection.flatten([corner[0], corner[1], 0.0]).0;
        let upright = if across(corners[0]) < across(corners[1]) {
            corners[0]
        } else {
            corners[1]
        };
        for (value, label) in projection.layouts[2].ticks(5) {
            let at = projection.layouts[2].pixel(value);
            line(svg, [far_x, -0.5, at], [far_x, 0.5, at], grid);
            line(svg, [-0.5, far_y, at], [0.5, far_y, at], grid);
            let (x, y) = projection.flatten([upright[0], upright[1], at]);
            svg.text((x - 6.0, y + 4.0), Anchor::End, &label);
        }
        line(svg, [-0.5, -far_y, -0.5], [0.5, -far_y, -0.5], edge);
        line(svg, [-far_x, -0.5, -0.5], [-far_x, 0.5, -0.5], edge);
        line(
            svg,
            [upright[0], upright[1], -0.5],
            [upright[0], upright[1], 0.5],
            edge,
        );
        let (x, y) = projection.flatten([upright[0], upright[1], 0.0]);
        svg.text_upward((x - 50.0, y), self.axes[2].label());
        self.axis_label(
            svg,
            projection,
            [0.0, -far_y, -0.5],
            [0.0, -far_y, 0.0],
            self.axes[0].label(),
        );
        self.axis_label(
            svg,
            projection,
            [-far_x, 0.0, -0.5],
            [-far_x, 0.0, 0.0],
            self.axes[1].label(),
        );
    }

    fn tick(
        &self,
        svg: &mut Svg,
        projection: &Projection,
        at: [f64; 3],
        outward: [f64; 3],
        label: &str,
    ) {
        let (x, y, _) = outside(projection, at, outward, 12.0);
        svg.text((x, y + 6.0), Anchor::Middle, label);
    }

    fn axis_label(
        &self,
        svg: &mut Svg,
        projection: &Projection,
        at: [f64; 3],
        outward: [f64; 3],
        label: &str,
    ) {
        let (x, y, rightward) = outside(projection, at, outward, 30.0);
        svg.text(
            (x, y + 14.0),
            if rightward {
                Anchor::Start
            } else {
                Anchor::End
            },
            label,
        );
    }
}

/// The pixel `distance` pixels outside of a point of the box, and whether that is to the right.
fn outside(
    projection: &Projection,
    at: [f64; 3],
    outward: [f64; 3],
    distance: f64,
) -> (f64, f64, bool) {
    let from = projection.flatten(at);
    let to = projection.flatten([0, 1, 2].map(|axis| at[axis] + 0.1 * outward[axis]));
    let (across, down) = (to.0 - from.0, to.1 - from.1);
    let length = across.hypot(down).max(1e-9);
    (
        from.0 + distance * across / length,
        from.1 + distance * down / length,
        across >= 0.0,
    )
}
