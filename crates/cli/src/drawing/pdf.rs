//! Drawings as PDF (ISO 32000): vector graphics on one page. Texts are written as outlines, so that a page looks the same without
//! the fonts.

use flate2::Compression;
use flate2::write::ZlibEncoder;
use pdf_writer::types::{LineCapStyle, LineJoinStyle};
use pdf_writer::{Content, Filter, Finish, Name, Pdf, Rect, Ref, TextStr};
use resvg::tiny_skia::Pixmap;
use resvg::usvg::tiny_skia_path::{PathSegment, Transform};
use resvg::usvg::{
    BlendMode, Color, Fill, FillRule, Group, Image, ImageKind, LineCap, LineJoin, Node, Paint, PaintOrder,
    Path, Stroke, Tree,
};
use std::io::Write;

/// Points (1/72 inch) per pixel of the drawing (1/96 inch, as in CSS).
const POINTS: f32 = 0.75;

/// The catalogue, the pages, the page, the resources and the information; other objects follow.
const CATALOGUE: Ref = Ref::new(1);
const PAGES: Ref = Ref::new(2);
const PAGE: Ref = Ref::new(3);
const RESOURCES: Ref = Ref::new(4);
const INFORMATION: Ref = Ref::new(5);
const FIRST_OBJECT: i32 = 6;

/// The PDF file of a drawing.
///
/// # Errors
///
/// The drawing contains something that is not supported: gradients, patterns, clipping, masks, filters.
pub fn encode(tree: &Tree, title: &str) -> Result<Vec<u8>, String> {
    let (width, height) = (tree.size().width(), tree.size().height());
    let mut writer = Writer {
        pdf: Pdf::new(),
        next: FIRST_OBJECT,
        opacities: Vec::new(),
        objects: Vec::new(),
        bounds: Rect::new(0.0, 0.0, width, height),
    };
    let mut content = Content::new();
    content.transform([POINTS, 0.0, 0.0, -POINTS, 0.0, height * POINTS]);
    writer.children(tree.root(), &mut content)?;
    Ok(writer.finish(&content.finish(), [width * POINTS, height * POINTS], title))
}

struct Writer {
    pdf: Pdf,
    /// The number of the next object.
    next: i32,
    /// The opacities of fills and lines in use, with the object of each.
    opacities: Vec<([f32; 2], Ref)>,
    /// Images and groups.
    objects: Vec<Ref>,
    /// The page in pixels.
    bounds: Rect,
}

impl Writer {
    fn object(&mut self) -> Ref {
        self.next += 1;
        Ref::new(self.next - 1)
    }

    /// Draws the contents of a group.
    fn children(&mut self, group: &Group, content: &mut Content) -> Result<(), String> {
        for node in group.children() {
            match node {
                Node::Group(group) => self.group(group, content)?,
                Node::Path(path) => self.path(path, content)?,
                Node::Image(image) => self.image(image, content)?,
                Node::Text(text) => self.children(text.flattened(), content)?,
            }
        }
        Ok(())
    }

    /// Draws a group; one that is not opaque is composed by itself first.
    fn group(&mut self, group: &Group, content: &mut Content) -> Result<(), String> {
        let is_plain = group.clip_path().is_none() && group.mask().is_none() && group.filters().is_empty();
        if !is_plain || group.blend_mode() != BlendMode::Normal {
            return Err("clipping, masks, filters and blending are not supported in PDF".to_owned());
        }
        let opacity = group.opacity().get();
        if opacity == 1.0 {
            return self.children(group, content);
        }
        let mut own = Content::new();
        self.children(group, &mut own)?;
        let (id, bounds) = (self.object(), self.bounds);
        let bytes = compressed(&own.finish());
        let mut form = self.pdf.form_xobject(id, &bytes);
        form.filter(Filter::FlateDecode);
        form.bbox(bounds).pair(Name(b"Resources"), RESOURCES);
        form.group().transparency().isolated(true);
        form.finish();
        content.save_state();
        self.set_opacity([opacity; 2], content);
        self.draw(id, content);
        content.restore_state();
        Ok(())
    }

    /// Draws an image or a group.
    fn draw(&mut self, id: Ref, content: &mut Content) {
        content.x_object(Name(format!("X{}", self.objects.len()).as_bytes()));
        self.objects.push(id);
    }

    fn set_opacity(&mut self, opacity: [f32; 2], content: &mut Content) {
        let known = self.opacities.iter().position(|(own, _)| *own == opacity);
        let index = known.unwrap_or_else(|| {
            let id = self.object();
            self.opacities.push((opacity, id));
            self.opacities.len() - 1
        });
        content.set_parameters(Name(format!("G{index}").as_bytes()));
    }

    fn path(&mut self, path: &Path, content: &mut Content) -> Result<(), String> {
        if !path.is_visible() {
            return Ok(());
        }
        content.save_state().transform(matrix(path.abs_transform()));
        let opacity = |fill: Option<f32>| fill.unwrap_or(1.0);
        let fill = opacity(path.fill().map(|fill| fill.opacity().get()));
        let line = opacity(path.stroke().map(|stroke| stroke.opacity().get()));
        if fill < 1.0 || line < 1.0 {
            self.set_opacity([fill, line], content);
        }
        let is_filled_first = path.paint_order() == PaintOrder::FillAndStroke;
        for fills in [is_filled_first, !is_filled_first] {
            match (fills, path.fill(), path.stroke()) {
                (true, Some(fill), _) => {
                    set_fill(fill, content)?;
                    outline(path, content);
                    match fill.rule() {
                        FillRule::NonZero => content.fill_nonzero(),
                        FillRule::EvenOdd => content.fill_even_odd(),
                    };
                }
                (false, _, Some(stroke)) => {
                    set_stroke(stroke, content)?;
                    outline(path, content);
                    content.stroke();
                }
                _ => {}
            }
        }
        content.restore_state();
        Ok(())
    }

    fn image(&mut self, image: &Image, content: &mut Content) -> Result<(), String> {
        let ImageKind::PNG(bytes) = image.kind() else {
            return Err("images other than PNG are not supported in PDF".to_owned());
        };
        if !image.is_visible() {
            return Ok(());
        }
        let pixels = Pixmap::decode_png(bytes).map_err(|error| format!("an image is damaged: {error}"))?;
        let colours: Vec<_> = pixels.pixels().iter().map(|pixel| pixel.demultiply()).collect();
        let rgb: Vec<u8> = colours.iter().flat_map(|c| [c.red(), c.green(), c.blue()]).collect();
        let alpha: Vec<u8> = colours.iter().map(|c| c.alpha()).collect();
        let is_opaque = alpha.iter().all(|a| *a == u8::MAX);
        let mask = (!is_opaque).then(|| self.raster(&pixels, &alpha, None));
        let id = self.raster(&pixels, &rgb, Some(mask));
        content.save_state().transform(matrix(image.abs_transform()));
        // the unit square of an image has its origin in the lower left corner
        let (width, height) = (image.size().width(), image.size().height());
        content.transform([width, 0.0, 0.0, -height, 0.0, height]);
        self.draw(id, content);
        content.restore_state();
        Ok(())
    }

    /// Writes pixels with 8 bits per value: grey ones, or colours with the mask of their opacity.
    fn raster(&mut self, pixels: &Pixmap, values: &[u8], colour: Option<Option<Ref>>) -> Ref {
        let id = self.object();
        let bytes = compressed(values);
        let mut image = self.pdf.image_xobject(id, &bytes);
        image.filter(Filter::FlateDecode);
        image.bits_per_component(8).width(pixels.width() as i32).height(pixels.height() as i32);
        match colour {
            None => image.color_space().device_gray(),
            Some(mask) => {
                image.color_space().device_rgb();
                if let Some(mask) = mask {
                    image.s_mask(mask);
                }
            }
        }
        image.finish();
        id
    }

    fn finish(mut self, content: &[u8], [width, height]: [f32; 2], title: &str) -> Vec<u8> {
        let stream = self.object();
        self.pdf.stream(stream, &compressed(content)).filter(Filter::FlateDecode);
        self.pdf.catalog(CATALOGUE).pages(PAGES);
        self.pdf.pages(PAGES).kids([PAGE]).count(1);
        let mut page = self.pdf.page(PAGE);
        page.parent(PAGES).media_box(Rect::new(0.0, 0.0, width, height)).contents(stream);
        page.pair(Name(b"Resources"), RESOURCES);
        page.finish();
        for ([fill, line], id) in &self.opacities {
            self.pdf.ext_graphics(*id).non_stroking_alpha(*fill).stroking_alpha(*line);
        }
        let mut resources = self.pdf.indirect(RESOURCES).start::<pdf_writer::writers::Resources>();
        let mut states = resources.ext_g_states();
        for (index, (_, id)) in self.opacities.iter().enumerate() {
            states.pair(Name(format!("G{index}").as_bytes()), id);
        }
        states.finish();
        let mut objects = resources.x_objects();
        for (index, id) in self.objects.iter().enumerate() {
            objects.pair(Name(format!("X{index}").as_bytes()), id);
        }
        objects.finish();
        resources.finish();
        self.pdf.document_info(INFORMATION).title(TextStr(title)).producer(TextStr("Rayweave"));
        self.pdf.finish()
    }
}

/// Adds the segments of a path.
fn outline(path: &Path, content: &mut Content) {
    let mut last = (0.0, 0.0);
    for segment in path.data().segments() {
        match segment {
            PathSegment::MoveTo(p) => {
                content.move_to(p.x, p.y);
                last = (p.x, p.y);
            }
            PathSegment::LineTo(p) => {
                content.line_to(p.x, p.y);
                last = (p.x, p.y);
            }
            // PDF has cubic curves only: the same curve, with its degree raised
            PathSegment::QuadTo(c, p) => {
                let third = |from: f32, to: f32| from + 2.0 / 3.0 * (to - from);
                let (a, b) = ((third(last.0, c.x), third(last.1, c.y)), (third(p.x, c.x), third(p.y, c.y)));
                content.cubic_to(a.0, a.1, b.0, b.1, p.x, p.y);
                last = (p.x, p.y);
            }
            PathSegment::CubicTo(a, b, p) => {
                content.cubic_to(a.x, a.y, b.x, b.y, p.x, p.y);
                last = (p.x, p.y);
            }
            PathSegment::Close => {
                content.close_path();
            }
        }
    }
}

fn matrix(t: Transform) -> [f32; 6] {
    [t.sx, t.ky, t.kx, t.sy, t.tx, t.ty]
}

fn set_fill(fill: &Fill, content: &mut Content) -> Result<(), String> {
    let [red, green, blue] = colour(fill.paint())?;
    content.set_fill_rgb(red, green, blue);
    Ok(())
}

fn set_stroke(stroke: &Stroke, content: &mut Content) -> Result<(), String> {
    let [red, green, blue] = colour(stroke.paint())?;
    content.set_stroke_rgb(red, green, blue);
    content.set_line_width(stroke.width().get()).set_miter_limit(stroke.miterlimit().get());
    content.set_line_cap(match stroke.linecap() {
        LineCap::Butt => LineCapStyle::ButtCap,
        LineCap::Round => LineCapStyle::RoundCap,
        LineCap::Square => LineCapStyle::ProjectingSquareCap,
    });
    content.set_line_join(match stroke.linejoin() {
        LineJoin::Miter | LineJoin::MiterClip => LineJoinStyle::MiterJoin,
        LineJoin::Round => LineJoinStyle::RoundJoin,
        LineJoin::Bevel => LineJoinStyle::BevelJoin,
    });
    if let Some(dashes) = stroke.dasharray() {
        content.set_dash_pattern(dashes.iter().copied(), stroke.dashoffset());
    }
    Ok(())
}

fn colour(paint: &Paint) -> Result<[f32; 3], String> {
    match paint {
        Paint::Color(Color { red, green, blue }) => Ok([*red, *green, *blue].map(|c| f32::from(c) / 255.0)),
        _ => Err("gradients and patterns are not supported in PDF".to_owned()),
    }
}

fn compressed(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    // writing to memory cannot fail
    let _ = encoder.write_all(bytes);
    encoder.finish().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use resvg::usvg::Options;

    fn pdf(body: &str) -> Result<Vec<u8>, String> {
        let svg = format!(r#"<svg xmlns="http://www.w3.org/2000/svg" width="40" height="20">{body}</svg>"#);
        encode(&Tree::from_str(&svg, &Options::default()).unwrap(), "a (b)")
    }

    fn has(file: &[u8], text: &str) -> bool {
        file.windows(text.len()).any(|part| part == text.as_bytes())
    }

    #[test]
    fn a_page_has_the_size_of_the_drawing() {
        let file = pdf(r##"<rect width="9" height="9" fill="#f00" fill-opacity="0.5"/>"##).unwrap();
        assert!(file.starts_with(b"%PDF-") && has(&file, "/MediaBox [0 0 30 15]"));
        assert!(has(&file, "/ca 0.5") && has(&file, "(a (b))"));
        let group =
            pdf(r##"<g opacity="0.25"><rect width="9" height="9"/><rect width="5" height="5"/></g>"##);
        let group = group.unwrap();
        assert!(has(&group, "/Transparency") && has(&group, "/ca 0.25") && has(&group, "/BBox [0 0 40 20]"));
    }

    #[test]
    fn what_cannot_be_written_is_an_error() {
        let gradient = r##"<linearGradient id="g"><stop stop-color="#f00"/><stop offset="1"/></linearGradient>
            <rect width="9" height="9" fill="url(#g)"/>"##;
        assert!(pdf(gradient).unwrap_err().contains("gradients"));
        let clip = r##"<clipPath id="c"><circle r="4"/></clipPath><rect width="9" height="9" clip-path="url(#c)"/>"##;
        assert!(pdf(clip).unwrap_err().contains("clipping"));
    }
}
