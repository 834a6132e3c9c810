//! The icon of the FMUs, drawn by code: disc, shaft, motor and a stick-slip velocity trace.

use thiserror::Error;

/// Width and height of the icon in pixels.
pub const ICON_SIZE: u32 = 128;

/// Subpixels per pixel and direction, for smooth edges.
const SAMPLES: u32 = 4;

/// The icon could not be encoded.
#[derive(Debug, Error)]
#[error("the icon could not be encoded as PNG: {0}")]
pub struct IconError(#[from] png::EncodingError);

type Colour = [f64; 4];

const CLEAR: Colour = [0.0, 0.0, 0.0, 0.0];
const STEEL: Colour = [0.36, 0.42, 0.49, 1.0];
const DISC: Colour = [0.16, 0.40, 0.65, 1.0];
const PIN: Colour = [0.80, 0.28, 0.16, 1.0];
const TRACE: Colour = [0.93, 0.55, 0.13, 1.0];

/// PNG file of the icon, [`ICON_SIZE`] pixels square with a transparent background. The same bytes every time.
///
/// # Errors
/// [`IconError`] if the encoder refuses, which it has no reason to.
pub fn png() -> Result<Vec<u8>, IconError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, ICON_SIZE, ICON_SIZE);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&pixels())?;
    writer.finish()?;
    Ok(bytes)
}

fn pixels() -> Vec<u8> {
    let mut data = Vec::with_capacity((ICON_SIZE * ICON_SIZE * 4) as usize);
    for row in 0..ICON_SIZE {
        for column in 0..ICON_SIZE {
            data.extend(pixel(column, row));
        }
    }
    data
}

/// Average of the subpixels, colours weighted with their opacity.
fn pixel(column: u32, row: u32) -> [u8; 4] {
    let mut sum = [0.0; 4];
    for subpixel in 0..SAMPLES * SAMPLES {
        let offset = |index: u32| (f64::from(index) + 0.5) / f64::from(SAMPLES);
        let x = (f64::from(column) + offset(subpixel % SAMPLES)) / f64::from(ICON_SIZE);
        let y = (f64::from(row) + offset(subpixel / SAMPLES)) / f64::from(ICON_SIZE);
        let [red, green, blue, alpha] = colour_at(x, y);
        sum = [
            sum[0] + red * alpha,
            sum[1] + green * alpha,
            sum[2] + blue * alpha,
            sum[3] + alpha,
        ];
    }
    let opacity = sum[3];
    let byte = |value: f64| (value * 255.0).round() as u8;
    if opacity == 0.0 {
        return [0; 4];
    }
    [
        byte(sum[0] / opacity),
        byte(sum[1] / opacity),
        byte(sum[2] / opacity),
        byte(opacity / f64::from(SAMPLES * SAMPLES)),
    ]
}

/// Colour at a point of the unit square, origin at the top left.
fn colour_at(x: f64, y: f64) -> Colour {
    let inside = |left: f64, right: f64, top: f64, bottom: f64| {
        x >= left && x <= right && y >= top && y <= bottom
    };
    if inside(0.78, 0.86, 0.05, 0.17) {
        return PIN;
    }
    if inside(0.70, 0.94, 0.17, 0.55) {
        return DISC;
    }
    if inside(0.06, 0.34, 0.20, 0.52) || inside(0.34, 0.70, 0.335, 0.385) {
        return STEEL;
    }
    if (y - trace_height(x)).abs() < 0.028 && inside(0.05, 0.95, 0.6, 1.0) {
        return TRACE;
    }
    CLEAR
}

/// Two periods of stick (flat) and slip (half sine), as the disc's velocity looks.
fn trace_height(x: f64) -> f64 {
    let phase = ((x - 0.05) / 0.45).fract();
    let slip = (phase - 0.35) / 0.65;
    if slip <= 0.0 {
        0.92
    } else {
        0.92 - 0.24 * (slip * std::f64::consts::PI).sin()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decodes_to_the_drawn_pixels_and_is_reproducible() {
        let bytes = png().unwrap();
        assert_eq!(bytes, png().unwrap());
        let mut reader = ::png::Decoder::new(std::io::Cursor::new(&bytes))
            .read_info()
            .unwrap();
        let mut buffer = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut buffer).unwrap();
        assert_eq!((info.width, info.height), (ICON_SIZE, ICON_SIZE));
        assert_eq!(buffer, pixels());
        assert_eq!(&buffer[..4], &[0; 4], "the corner is transparent");
    }
}
