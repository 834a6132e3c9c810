//! A figure: a title over rows of panels.

use std::path::Path;

use thiserror::Error;

use crate::files::atomic::{self, WriteError};

use super::raster;
use super::style::{FIGURE_TITLE, INK};
use super::svg::{Anchor, Svg};

/// Why a picture was not written.
#[derive(Debug, Error)]
pub enum PlotError {
    /// A file could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The SVG could not be turned into pixels.
    #[error("cannot make pixels of the picture `{title}`: {reason}")]
    Raster {
        /// Title of the figure.
        title: String,
        /// What the renderer says.
        reason: String,
    },
}

/// A rectangle of a picture [px].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Area {
    /// Left edge.
    pub x: f64,
    /// Upper edge.
    pub y: f64,
    /// Width.
    pub width: f64,
    /// Height.
    pub height: f64,
}

/// What can stand in a figure.
pub trait Panel {
    /// Draws itself, axes and labels included, inside `area`.
    fn draw(&self, svg: &mut Svg, area: Area);
}

/// A title over rows of panels of equal width.
pub struct Figure {
    title: String,
    width: f64,
    rows: Vec<(f64, Vec<Box<dyn Panel>>)>,
}

impl Figure {
    /// An empty figure, 960 pixels wide.
    #[must_use]
    pub fn new(title: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            width: 960.0,
            rows: Vec::new(),
        }
    }

    /// The same figure with another width [px].
    #[must_use]
    pub fn wide(self, width: f64) -> Self {
        Self { width, ..self }
    }

    /// Adds a row of the given height [px] with several panels side by side.
    #[must_use]
    pub fn row(mut self, height: f64, panels: Vec<Box<dyn Panel>>) -> Self {
        self.rows.push((height, panels));
        self
    }

    /// Adds a row of the given height [px] with one panel.
    #[must_use]
    pub fn panel(self, height: f64, panel: impl Panel + 'static) -> Self {
        self.row(height, vec![Box::new(panel)])
    }

    /// The picture as an SVG document; it can stand in an HTML page as it is.
    #[must_use]
    pub fn to_svg(&self) -> String {
        let head = if self.title.is_empty() { 8.0 } else { 36.0 };
        let height = head + self.rows.iter().map(|(height, _)| height).sum::<f64>() + 8.0;
        let mut svg = Svg::new(self.width, height);
        if !self.title.is_empty() {
            svg.text_with(
                (self.width / 2.0, 24.0),
                Anchor::Middle,
                FIGURE_TITLE,
                INK,
                &self.title,
            );
        }
        let mut y = head;
        for (height, panels) in &self.rows {
            let width = self.width / panels.len().max(1) as f64;
            for (index, panel) in panels.iter().enumerate() {
                panel.draw(
                    &mut svg,
                    Area {
                        x: index as f64 * width,
                        y,
                        width,
                        height: *height,
                    },
                );
            }
            y += height;
        }
        svg.finish()
    }

    /// The picture as a PNG, `scale` pixels for each pixel of the SVG.
    ///
    /// # Errors
    /// [`PlotError::Raster`] where the renderer refuses.
    pub fn to_png(&self, scale: f32) -> Result<Vec<u8>, PlotError> {
        raster::png_from_svg(&self.to_svg(), scale).map_err(|reason| PlotError::Raster {
            title: self.title.clone(),
            reason,
        })
    }

    /// Writes `stem`.svg and `stem`.png (at double resolution), each whole or not at all.
    ///
    /// # Errors
    /// [`PlotError`] where a file cannot be written or the picture cannot be turned into pixels.
    pub fn write(&self, stem: &Path) -> Result<(), PlotError> {
        let named = |suffix: &str| {
            let mut name = stem.as_os_str().to_owned();
            name.push(suffix);
            name
        };
        atomic::write_file(Path::new(&named(".svg")), self.to_svg().as_bytes())?;
        atomic::write_file(Path::new(&named(".png")), &self.to_png(2.0)?)?;
        Ok(())
    }
}
