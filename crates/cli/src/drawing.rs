//! Output of drawings to files: SVG directly, PNG by rasterisation.

use crate::failure::Failure;
use crate::terminal;
use rayweave::picture::{PictureSheet, PlacedPicture};
use rayweave::render::Image;
use resvg::tiny_skia::{ColorU8, IntSize, Pixmap, PixmapPaint, Transform};
use resvg::usvg::{Options, Tree};
use std::path::Path;
use std::sync::Arc;

/// True if a file name has the extension of a drawing.
pub fn is_drawing(path: &Path) -> bool {
    kind(path).is_some()
}

/// The scale of PNG files: pixels per unit of the drawing.
const ZOOM: f32 = 2.0;

/// The kind of an output file.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Svg,
    Png,
}

fn kind(path: &Path) -> Option<Kind> {
    let is = |extension: &str| path.extension().is_some_and(|own| own.eq_ignore_ascii_case(extension));
    match () {
        () if is("svg") || path == Path::new("-") => Some(Kind::Svg),
        () if is("png") => Some(Kind::Png),
        () => None,
    }
}

/// Checks the extension of an output file before any work is done.
pub fn check(path: &Path) -> Result<(), Failure> {
    let problem = || {
        let path = path.display();
        Failure::Usage(format!("{path}: unknown drawing format: drawings are written as .svg or .png."))
    };
    kind(path).map(|_| ()).ok_or_else(problem)
}

/// Writes a drawing as SVG, or as PNG with two pixels per unit of the drawing; `-` is SVG to
/// standard output.
pub fn save(path: &Path, svg: &str) -> Result<(), Failure> {
    match kind(path) {
        Some(Kind::Png) => terminal::save(path, &png(svg).map_err(Failure::Run)?),
        _ => terminal::save(path, svg.as_bytes()),
    }
}

/// Writes a sheet as SVG, or as PNG with one pixel per unit; `-` is SVG to standard output.
pub fn save_sheet(path: &Path, sheet: &PictureSheet, title: &str) -> Result<(), Failure> {
    if kind(path) != Some(Kind::Png) {
        return terminal::save(path, sheet.to_svg(title).as_bytes());
    }
    let mut pixels = pixels(&sheet.without_pictures(title), 1.0).map_err(Failure::Run)?;
    for PlacedPicture { x, y, image } in sheet.pictures() {
        put(&mut pixels, [*x, *y], image);
    }
    terminal::save(path, &encoded(&pixels).map_err(Failure::Run)?)
}

/// Copies a picture onto a pixel map.
fn put(pixels: &mut Pixmap, [x, y]: [usize; 2], image: &Image) {
    let size = IntSize::from_wh(image.width() as u32, image.height() as u32);
    let premultiplied = |&[r, g, b, a]: &[u8; 4]| ColorU8::from_rgba(r, g, b, a).premultiply();
    let bytes = image.values().iter().map(premultiplied);
    let bytes = bytes.flat_map(|c| [c.red(), c.green(), c.blue(), c.alpha()]).collect();
    if let Some(picture) = size.and_then(|size| Pixmap::from_vec(bytes, size)) {
        let paint = PixmapPaint::default();
        pixels.draw_pixmap(x as i32, y as i32, picture.as_ref(), &paint, Transform::identity(), None);
    }
}

fn png(svg: &str) -> Result<Vec<u8>, String> {
    encoded(&pixels(svg, ZOOM)?)
}

fn encoded(pixels: &Pixmap) -> Result<Vec<u8>, String> {
    pixels.encode_png().map_err(|error| failed(&error))
}

fn failed(error: &dyn std::fmt::Display) -> String {
    format!("cannot draw the picture: {error}.")
}

fn pixels(svg: &str, zoom: f32) -> Result<Pixmap, String> {
    let mut options = Options { font_family: "sans-serif".to_owned(), ..Options::default() };
    let fonts = Arc::make_mut(&mut options.fontdb);
    fonts.load_system_fonts();
    if fonts.is_empty() {
        terminal::note(
            "note: the picture has no text: no fonts are installed on this machine. Write it as .svg.",
        );
    }
    let tree = Tree::from_str(svg, &options).map_err(|error| failed(&error))?;
    let size = tree.size().to_int_size().scale_by(zoom).ok_or_else(|| failed(&"it has no size"))?;
    let mut pixels = Pixmap::new(size.width(), size.height()).ok_or_else(|| failed(&"it is too large"))?;
    resvg::render(&tree, Transform::from_scale(zoom, zoom), &mut pixels.as_mut());
    Ok(pixels)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drawings_have_names() {
        for name in ["a.svg", "b.PNG", "-"] {
            assert!(check(Path::new(name)).is_ok(), "{name}");
        }
        assert!(
            matches!(check(Path::new("a.pdf")), Err(Failure::Usage(text)) if text.contains(".svg or .png"))
        );
        assert!(check(Path::new("a")).is_err());
    }

    /// A red square on the right half of white paper.
    #[test]
    fn pixels_are_those_of_the_drawing() {
        let svg = r##"<svg xmlns="http://www.w3.org/2000/svg" width="20" height="10" viewBox="0 0 20 10">
            <rect width="20" height="10" fill="#fff"/><rect x="10" width="10" height="10" fill="#f00"/></svg>"##;
        let picture = Pixmap::decode_png(&png(svg).unwrap()).unwrap();
        assert_eq!((picture.width(), picture.height()), (40, 20));
        let channels = |x: u32| {
            let pixel = picture.pixel(x, 10).unwrap();
            [pixel.red(), pixel.green(), pixel.blue(), pixel.alpha()]
        };
        assert_eq!([channels(19), channels(20)], [[255; 4], [255, 0, 0, 255]]);
        assert!(png("<svg").is_err());
    }
}
