//! PNG from SVG, with the font that comes with the program: machines without fonts give the same pictures.

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree};

const FONT: &[u8] = include_bytes!("../../assets/DejaVuSans-subset.ttf");

/// Turns an SVG document into a PNG of `scale` pixels for each of its own.
///
/// # Errors
/// The renderer's reason, where the document is no SVG or the picture is empty or too large.
pub fn png_from_svg(svg: &str, scale: f32) -> Result<Vec<u8>, String> {
    let mut options = Options {
        font_family: "DejaVu Sans".to_owned(),
        ..Options::default()
    };
    options.fontdb_mut().load_font_data(FONT.to_vec());
    let tree = Tree::from_str(svg, &options).map_err(|error| error.to_string())?;
    let (width, height) = (tree.size().width() * scale, tree.size().height() * scale);
    let Some(mut pixels) = Pixmap::new(width.ceil() as u32, height.ceil() as u32) else {
        return Err(format!("{width} x {height} pixels is empty or too large"));
    };
    resvg::render(
        &tree,
        Transform::from_scale(scale, scale),
        &mut pixels.as_mut(),
    );
    pixels.encode_png().map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::{Anchor, Svg};

    fn dark_pixels(content: &str) -> usize {
        let mut svg = Svg::new(200.0, 40.0);
        svg.text((5.0, 25.0), Anchor::Start, content);
        let png = png_from_svg(&svg.finish(), 1.0).unwrap();
        let pixels = Pixmap::decode_png(&png).unwrap();
        pixels
            .pixels()
            .iter()
            .filter(|pixel| pixel.red() < 128)
            .count()
    }

    #[test]
    fn text_shows_without_any_font_installed() {
        assert_eq!(dark_pixels(""), 0);
        assert!(dark_pixels("θ̇₂ [rad/s], μ, −10⁻⁶") > 100);
    }

    #[test]
    fn nonsense_is_refused() {
        assert!(png_from_svg("<svg", 1.0).is_err());
    }
}
