//! Pictures as JPEG (ITU-T T.81), without subsampling of colours, which would blur coloured edges.

use jpeg_encoder::{ColorType, Encoder, SamplingFactor};
use rayweave::render::Image;
use resvg::tiny_skia::Pixmap;

/// The quality, from 1 to 100: differences are hardly visible.
const QUALITY: u8 = 92;

/// The JPEG file of a picture. Transparent pixels are shown on white, since JPEG has no transparency.
pub fn of_image(image: &Image) -> Result<Vec<u8>, String> {
    let over_white = |colour: u8, alpha: u8| {
        let (colour, alpha) = (u32::from(colour), u32::from(alpha));
        ((colour * alpha + 255 * (255 - alpha) + 127) / 255) as u8
    };
    let bytes = image.values().iter().flat_map(|&[r, g, b, a]| [r, g, b].map(|c| over_white(c, a))).collect();
    encode(bytes, [image.width(), image.height()])
}

/// The JPEG file of a drawing, whose paper is opaque.
pub fn of_pixels(pixels: &Pixmap) -> Result<Vec<u8>, String> {
    let bytes = pixels.pixels().iter().flat_map(|c| [c.red(), c.green(), c.blue()]).collect();
    encode(bytes, [pixels.width() as usize, pixels.height() as usize])
}

fn encode(rgb: Vec<u8>, [width, height]: [usize; 2]) -> Result<Vec<u8>, String> {
    let too_large =
        || format!("JPEG pictures have at most 65535 x 65535 pixels, this one has {width} x {height}");
    let side = |length: usize| u16::try_from(length).map_err(|_| too_large());
    let (width, height) = (side(width)?, side(height)?);
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, QUALITY);
    encoder.set_sampling_factor(SamplingFactor::F_1_1);
    encoder.encode(&rgb, width, height, ColorType::Rgb).map_err(|error| error.to_string())?;
    Ok(bytes)
}
