//! PNG encoding and decoding in memory; the caller writes files.

use crate::{IdKind, Image, PALETTE, PixelGrid, Rgba, Size};
use png::{BitDepth, ColorType, Compression, Encoder, SrgbRenderingIntent};

/// Error of decoding a picture.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PngError {
    /// The file is damaged or not a PNG file.
    #[error("this is not a readable PNG file: {0}.")]
    Decoding(#[from] png::DecodingError),
    /// The picture has a pixel format other than 8-bit RGBA.
    #[error("the picture has {0}: only 8-bit RGBA pictures are read. Convert it.")]
    Kind(String),
    /// The picture is too large.
    #[error(transparent)]
    Size(#[from] crate::RenderError),
}

/// Encodes a picture as 8-bit RGBA, marked as sRGB.
pub fn encode(image: &Image) -> Vec<u8> {
    let bytes = image.values().as_flattened();
    file(image.size(), ColorType::Rgba, BitDepth::Eight, bytes, &[])
}

/// Encodes depth as 16-bit grey: the least finite depth is 65535 (white), the greatest is 1, linear in
/// between, and a miss is 0. If all finite depths are equal they are white. The two depths are stored as text
/// chunks `near` and `far`, in the shortest form that gives the same f64, so that `t = near + (far - near)
/// (65535 - grey) / 65534`.
pub fn encode_depth(depth: &PixelGrid<f64>) -> Vec<u8> {
    let finite = || depth.values().iter().copied().filter(|t| t.is_finite());
    let near = finite().fold(f64::INFINITY, f64::min);
    let far = finite().fold(f64::NEG_INFINITY, f64::max);
    let grey = |&t: &f64| match () {
        () if !t.is_finite() => 0,
        () if near == far => u16::MAX,
        // scaled before the subtraction, which therefore cannot overflow
        () => (65_535.5 - (t / 2.0 - near / 2.0) / (far / 2.0 - near / 2.0) * 65_534.0) as u16,
    };
    let bytes: Vec<u8> = depth.values().iter().map(grey).flat_map(u16::to_be_bytes).collect();
    let texts = [("near", near.to_string()), ("far", far.to_string())];
    let texts = if near <= far { &texts[..] } else { &[] };
    file(depth.size(), ColorType::Grayscale, BitDepth::Sixteen, &bytes, texts)
}

/// Encodes numbers as 16-bit grey: 0 or less is black, `white` or more is 65535, linear in between. `white`
/// is stored as a text chunk.
pub fn encode_grey(plane: &PixelGrid<f64>, white: f64) -> Vec<u8> {
    // NaN is black
    let grey = |&value: &f64| (value / white * 65_535.0 + 0.5) as u16;
    let bytes: Vec<u8> = plane.values().iter().map(grey).flat_map(u16::to_be_bytes).collect();
    let texts = [("white", white.to_string())];
    file(plane.size(), ColorType::Grayscale, BitDepth::Sixteen, &bytes, &texts)
}

/// Encodes normals as 16-bit RGB: each component n becomes (n + 1) / 2 of 65535; a miss is black.
pub fn encode_normals(normals: &PixelGrid<[f64; 3]>) -> Vec<u8> {
    let level = |n: f64| if n.is_nan() { 0 } else { ((n + 1.0) * 32_767.5 + 0.5) as u16 };
    let values = normals.values().as_flattened();
    let bytes: Vec<u8> = values.iter().map(|&n| level(n)).flat_map(u16::to_be_bytes).collect();
    file(normals.size(), ColorType::Rgb, BitDepth::Sixteen, &bytes, &[])
}

/// Encodes ids as colours, each by [`id_colour`].
pub fn encode_ids(ids: &PixelGrid<i32>, kind: IdKind) -> Vec<u8> {
    let colour = |&id: &i32| {
        let Rgba { red, green, blue, alpha } = id_colour(id, kind);
        [red, green, blue, alpha]
    };
    let bytes: Vec<u8> = ids.values().iter().flat_map(colour).collect();
    file(ids.size(), ColorType::Rgba, BitDepth::Eight, &bytes, &[])
}

/// The colour of an id: those of [`PALETTE`] in turn, darker after each round, repeating after four rounds. A
/// miss is transparent.
pub fn id_colour(id: i32, kind: IdKind) -> Rgba {
    let first = i32::from(kind == IdKind::Region);
    let Ok(number) = usize::try_from(id.saturating_sub(first)) else {
        return Rgba::from([0; 4]);
    };
    let (colour, round) = (PALETTE[number % PALETTE.len()], number / PALETTE.len() % 4);
    let darker = |level: u8| (u32::from(level) * (5 - round as u32) / 5) as u8;
    Rgba::opaque(darker(colour.red), darker(colour.green), darker(colour.blue))
}

/// Joins pictures written by [`encode`] one below the other; they must have the same width.
///
/// # Errors
/// [`PngError`] for no picture at all, for anything other than 8-bit RGBA PNG files, and for pictures of different widths.
pub fn stack(pictures: &[Vec<u8>]) -> Result<Vec<u8>, PngError> {
    let pictures: Vec<Image> = pictures.iter().map(|bytes| decode(bytes)).collect::<Result<_, _>>()?;
    let width = pictures.first().map_or(0, |first| first.size().width());
    if pictures.iter().any(|picture| picture.size().width() != width) {
        return Err(PngError::Kind("another width than the one above it".to_owned()));
    }
    let height: usize = pictures.iter().map(|picture| picture.size().height()).sum();
    let size = Size::new(width as u32, u32::try_from(height).unwrap_or(u32::MAX))?;
    let values = pictures.iter().flat_map(|picture| picture.values()).copied().collect();
    Ok(encode(&PixelGrid::from_values(size, values).unwrap_or_else(|| PixelGrid::filled(size, [0; 4]))))
}

/// Decodes a picture written by [`encode`].
///
/// # Errors
/// [`PngError`] for anything other than an 8-bit RGBA PNG file.
pub fn decode(bytes: &[u8]) -> Result<Image, PngError> {
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info()?;
    let info = reader.info();
    let size = Size::new(info.width, info.height)?;
    if (info.color_type, info.bit_depth) != (ColorType::Rgba, BitDepth::Eight) {
        let colour = match info.color_type {
            ColorType::Grayscale => "greyscale",
            ColorType::GrayscaleAlpha => "greyscale and alpha",
            ColorType::Indexed => "indexed",
            ColorType::Rgb => "RGB",
            ColorType::Rgba => "RGBA",
        };
        let kind = format!("{}-bit {colour} pixels", info.bit_depth as u8);
        return Err(PngError::Kind(kind));
    }
    let mut image = PixelGrid::filled(size, [0; 4]);
    reader.next_frame(image.values_mut().as_flattened_mut())?;
    Ok(image)
}

/// Encodes a file; writing to memory cannot fail, and a [`Size`] is checked when it is made.
fn file(size: Size, colour: ColorType, depth: BitDepth, bytes: &[u8], texts: &[(&str, String)]) -> Vec<u8> {
    let mut out = Vec::new();
    let written = (|| {
        let mut encoder = Encoder::new(&mut out, size.width() as u32, size.height() as u32);
        encoder.set_color(colour);
        encoder.set_depth(depth);
        encoder.set_compression(Compression::Balanced);
        if depth == BitDepth::Eight {
            encoder.set_source_srgb(SrgbRenderingIntent::Perceptual);
        }
        for (name, text) in texts {
            encoder.add_text_chunk((*name).to_owned(), text.clone())?;
        }
        let mut writer = encoder.write_header()?;
        writer.write_image_data(bytes)?;
        writer.finish()
    })();
    match written {
        Ok(()) => out,
        Err(error) => unreachable!("a picture of {size:?} in memory: {error}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn size(width: u32, height: u32) -> Size {
        Size::new(width, height).unwrap()
    }

    fn grey(bytes: &[u8]) -> (Vec<u16>, Vec<(String, String)>) {
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        let mut buffer = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut buffer).unwrap();
        let texts = &reader.info().uncompressed_latin1_text;
        let texts = texts.iter().map(|t| (t.keyword.clone(), t.text.clone())).collect();
        let (pairs, _) = buffer.as_chunks::<2>();
        (pairs.iter().map(|&pair| u16::from_be_bytes(pair)).collect(), texts)
    }

    #[test]
    fn pictures_survive_the_round_trip() {
        let values = (0..35).map(|k| [k, 255 - k, 7 * k, 40 * (k % 7)]).collect();
        let image = PixelGrid::from_values(size(7, 5), values).unwrap();
        assert_eq!(decode(&encode(&image)).unwrap(), image);
    }

    #[test]
    fn other_files_are_refused() {
        let normals = PixelGrid::filled(size(2, 2), [0.0; 3]);
        let error = decode(&encode_normals(&normals)).unwrap_err();
        assert!(error.to_string().contains("16-bit RGB pixels"), "{error}");
        assert!(matches!(decode(b"GIF89a"), Err(PngError::Decoding(_))));
        let whole = encode(&PixelGrid::filled(size(9, 9), [1; 4]));
        assert!(matches!(decode(&whole[..whole.len() / 2]), Err(PngError::Decoding(_))));
    }

    #[test]
    fn depth_is_linear_and_stores_its_range() {
        let inf = f64::INFINITY;
        let depth = PixelGrid::from_values(size(4, 1), vec![0.1, 0.35, 0.6, inf]).unwrap();
        let (levels, texts) = grey(&encode_depth(&depth));
        assert_eq!(levels, [65535, 32768, 1, 0]);
        let text = |name: &str, value: &str| (name.to_owned(), value.to_owned());
        assert_eq!(texts, [text("near", "0.1"), text("far", "0.6")]);
        let (levels, texts) = grey(&encode_depth(&PixelGrid::filled(size(2, 1), inf)));
        assert_eq!((levels, texts.len()), (vec![0, 0], 0));
        let (levels, _) = grey(&encode_depth(&PixelGrid::filled(size(1, 2), 3.0)));
        assert_eq!(levels, [65535, 65535]);
        let huge = PixelGrid::from_values(size(2, 1), vec![1e308, 1.7e308]).unwrap();
        assert_eq!(grey(&encode_depth(&huge)).0, [65535, 1]);
    }

    #[test]
    fn normals_fill_the_range() {
        let normals = vec![[1.0, -1.0, 0.0], [f64::NAN; 3]];
        let normals = PixelGrid::from_values(size(2, 1), normals).unwrap();
        assert_eq!(grey(&encode_normals(&normals)).0, [65535, 0, 32768, 0, 0, 0]);
    }

    #[test]
    fn ids_have_colours() {
        assert_eq!(id_colour(0, IdKind::Region).alpha, 0);
        assert_eq!(id_colour(-1, IdKind::Face).alpha, 0);
        assert_eq!(id_colour(i32::MIN, IdKind::Region).alpha, 0);
        assert_eq!(id_colour(1, IdKind::Region), PALETTE[0]);
        assert_eq!(id_colour(0, IdKind::Face), PALETTE[0]);
        let some: std::collections::HashSet<_> = (0..28).map(|k| id_colour(k, IdKind::Leaf)).collect();
        assert_eq!(some.len(), 28);
        assert_eq!(id_colour(i32::MAX, IdKind::Face).alpha, 255);
    }
}
