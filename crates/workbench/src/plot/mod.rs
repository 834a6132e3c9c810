//! Pictures made for looking at, as SVG and PNG from one description, in one style throughout.
//!
//! A [`Figure`] is a title over rows of panels. Panels are [`Chart`] (lines, points, bands, histograms, published values),
//! [`Bars`], [`HeatMap`] and [`Space`] (curves and surfaces in three dimensions). Every colour differs from its
//! neighbours in lightness too, and every series in its dashes, so that the pictures survive a grey printer.

mod bars;
mod chart;
mod contour;
mod figure;
mod heat_map;
mod raster;
mod scale;
mod space;
mod style;
mod svg;

pub use bars::{Bar, Bars};
pub use chart::Chart;
pub use contour::{Piece, boundary};
pub use figure::{Area, Figure, Panel, PlotError};
pub use heat_map::HeatMap;
pub use raster::png_from_svg;
pub use scale::{Axis, Scale};
pub use space::{Space, View};
pub use style::{Marker, Style, gradient};
pub use svg::{Anchor, Svg};
