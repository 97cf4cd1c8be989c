//! Output of drawings to files: SVG directly, PDF by conversion of the drawing, PNG and JPEG by rasterisation.

mod jpeg;
mod pdf;

use crate::failure::Failure;
use crate::terminal;
use rayweave::picture::{Picture, PictureSheet, PlacedPicture};
use rayweave::render::Image;
use resvg::tiny_skia::{ColorU8, IntSize, Pixmap, PixmapPaint, Transform};
use resvg::usvg::{Options, Tree};
use std::path::Path;
use std::sync::{Arc, Once};

/// True if a file name has the extension of a drawing.
pub fn is_drawing(path: &Path) -> bool {
    kind(path).is_some()
}

/// The scale of PNG and JPEG files: pixels per unit of the drawing.
const ZOOM: f32 = 2.0;

/// The kind of an output file.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Svg,
    Pdf,
    Png,
    Jpeg,
}

fn kind(path: &Path) -> Option<Kind> {
    let is = |extension: &str| path.extension().is_some_and(|own| own.eq_ignore_ascii_case(extension));
    match () {
        // output that is not wanted may go to the null device
        () if is("svg") || path == Path::new("-") || path == Path::new("/dev/null") => Some(Kind::Svg),
        () if is("pdf") => Some(Kind::Pdf),
        () if is("png") => Some(Kind::Png),
        () if is("jpg") || is("jpeg") => Some(Kind::Jpeg),
        () => None,
    }
}

/// Checks the extension of an output file before any work is done.
pub fn check(path: &Path) -> Result<(), Failure> {
    let problem = || {
        let path = path.display();
        Failure::Usage(format!(
            "{path}: unknown drawing format: drawings are written as .svg, .pdf, .png or .jpg."
        ))
    };
    kind(path).map(|_| ()).ok_or_else(problem)
}

/// Checks the extension of a drawing that is written as SVG only.
pub fn check_svg(path: &Path) -> Result<(), Failure> {
    let problem = || Failure::Usage(format!("{}: this drawing is written as .svg only.", path.display()));
    kind(path).filter(|kind| *kind == Kind::Svg).map(|_| ()).ok_or_else(problem)
}

/// Writes a drawing as SVG or PDF, or as PNG or JPEG with two pixels per unit of the drawing; `-` is SVG to standard output.
pub fn save(path: &Path, svg: &str, title: &str) -> Result<(), Failure> {
    let bytes = match kind(path) {
        Some(Kind::Pdf) => tree(svg).and_then(|tree| pdf::encode(&tree, title)),
        Some(kind @ (Kind::Png | Kind::Jpeg)) => pixels(svg, ZOOM).and_then(|pixels| encoded(kind, &pixels)),
        Some(Kind::Svg) | None => return terminal::save(path, svg.as_bytes()),
    };
    terminal::save(path, &bytes.map_err(|error| Failure::Run(failed(&error)))?)
}

/// Writes a sheet as SVG or PDF, or as PNG or JPEG with one pixel per unit; `-` is SVG to standard output.
pub fn save_sheet(path: &Path, sheet: &PictureSheet, title: &str) -> Result<(), Failure> {
    let Some(kind @ (Kind::Png | Kind::Jpeg)) = kind(path) else {
        return save(path, &sheet.to_svg(title), title);
    };
    let bytes = pixels(&sheet.without_pictures(title), 1.0).and_then(|mut pixels| {
        for PlacedPicture { x, y, image } in sheet.pictures() {
            put(&mut pixels, [*x, *y], image);
        }
        encoded(kind, &pixels)
    });
    terminal::save(path, &bytes.map_err(|error| Failure::Run(failed(&error)))?)
}

/// Writes a picture as PNG or JPEG; `-` is PNG to standard output.
pub fn save_picture(path: &Path, picture: &Picture) -> Result<(), Failure> {
    match (kind(path), picture) {
        (Some(Kind::Jpeg), Picture::Colour(image)) => {
            let bytes = jpeg::of_image(image).map_err(|error| Failure::Run(failed(&error)))?;
            terminal::save(path, &bytes)
        }
        _ => terminal::save(path, &picture.to_png()),
    }
}

/// True if a file name has the extension of a JPEG image.
pub fn is_jpeg(path: &Path) -> bool {
    kind(path) == Some(Kind::Jpeg)
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

fn encoded(kind: Kind, pixels: &Pixmap) -> Result<Vec<u8>, String> {
    match kind {
        Kind::Jpeg => jpeg::of_pixels(pixels),
        _ => pixels.encode_png().map_err(|error| error.to_string()),
    }
}

fn failed(error: &str) -> String {
    format!("cannot draw the picture: {error}.")
}

/// Reads a drawing and lays out its texts.
fn tree(svg: &str) -> Result<Tree, String> {
    let mut options = Options { font_family: "sans-serif".to_owned(), ..Options::default() };
    let fonts = Arc::make_mut(&mut options.fontdb);
    fonts.load_system_fonts();
    if fonts.is_empty() {
        // once, for all pictures of a command
        static NOTED: Once = Once::new();
        NOTED.call_once(|| {
            terminal::note(
                "note: the picture has no text: no fonts are installed on this machine. Write it as .svg.",
            );
        });
    }
    Tree::from_str(svg, &options).map_err(|error| error.to_string())
}

fn pixels(svg: &str, zoom: f32) -> Result<Pixmap, String> {
    let tree = tree(svg)?;
    let size = tree.size().to_int_size().scale_by(zoom).ok_or("it has no size")?;
    let mut pixels = Pixmap::new(size.width(), size.height()).ok_or("it is too large")?;
    resvg::render(&tree, Transform::from_scale(zoom, zoom), &mut pixels.as_mut());
    Ok(pixels)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drawings_have_names() {
        for name in ["a.svg", "b.PNG", "c.jpg", "d.JPEG", "e.pdf", "-"] {
            assert!(check(Path::new(name)).is_ok(), "{name}");
        }
        assert!(
            matches!(check(Path::new("a.gif")), Err(Failure::Usage(text)) if text.contains(".svg, .pdf"))
        );
        assert!(check(Path::new("a")).is_err());
    }

    /// A red square on the right half of white paper.
    #[test]
    fn pixels_are_those_of_the_drawing() {
        let svg = r##"<svg xmlns="http://www.w3.org/2000/svg" width="20" height="10" viewBox="0 0 20 10">
            <rect width="20" height="10" fill="#fff"/><rect x="10" width="10" height="10" fill="#f00"/></svg>"##;
        let picture = Pixmap::decode_png(&encoded(Kind::Png, &pixels(svg, ZOOM).unwrap()).unwrap()).unwrap();
        assert_eq!((picture.width(), picture.height()), (40, 20));
        let channels = |x: u32| {
            let pixel = picture.pixel(x, 10).unwrap();
            [pixel.red(), pixel.green(), pixel.blue(), pixel.alpha()]
        };
        assert_eq!([channels(19), channels(20)], [[255; 4], [255, 0, 0, 255]]);
        assert!(pixels("<svg", ZOOM).is_err());
    }
}
