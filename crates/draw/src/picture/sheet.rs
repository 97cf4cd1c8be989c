//! Sheets: pictures of a model from one or several sides, with a scale and a legend of its media.

use super::{CutAway, PictureOptions, arrange};
use crate::DrawError;
use crate::axis::{format_number, round_step};
use crate::legend::{self, Entry, Swatch};
use crate::svg::{Anchor, INK, Svg, paint};
use rayweave_error::Message;
use rayweave_model::{Evaluator, memory};
use rayweave_render::{Camera, Image, Projection, RenderOptions, Rgba, Run, Size, View, render};
use rayweave_scene::{Compiled, Scene};
use std::collections::BTreeMap;

/// A sheet of pictures.
///
/// ```
/// use rayweave_draw::picture::{PictureOptions, PictureSheet, SheetKind};
/// use rayweave_render::{Run, Size};
/// use rayweave_scene::Compiled;
/// use rayweave_trace::AnyEvaluator;
///
/// let (_, scene) = rayweave_scene::parse("rayweave = 1\n[solid.lens]\nsphere = { radius = 2 }")?;
/// let compiled = Compiled::new(&scene)?;
/// let evaluator = AnyEvaluator::new(None, compiled.program.clone())?;
/// let options = PictureOptions { size: Some(Size::new(320, 240)?), ..PictureOptions::default() };
/// let run = &mut Run::default();
/// let sheet = PictureSheet::draw(SheetKind::Views, &scene, &compiled, &evaluator, &options, run)?;
/// assert_eq!(sheet.pictures().len(), 4);
/// assert!(sheet.to_svg("a ball").contains(">lens</text>"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct PictureSheet {
    size: Size,
    pictures: Vec<PlacedPicture>,
    /// Everything but the pictures.
    drawing: Svg,
}

/// The pictures of a sheet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SheetKind {
    /// One picture.
    One,
    /// The views from the front, from above and from the right, aligned and at the same scale, and one from the upper right. Each
    /// view lies on the side from which it is taken (third-angle projection, ISO 5456-2).
    Views,
}

/// The model before a part of it was removed, for a sheet of several views.
#[derive(Clone, Copy, Debug)]
pub struct WholeModel<'a, E> {
    /// The removed part.
    pub cut: &'a CutAway,
    /// The evaluator of the whole model, whose regions are those of the cut model.
    pub evaluator: &'a E,
}

/// A picture on a sheet.
#[derive(Clone, Debug)]
pub struct PlacedPicture {
    /// The column of its left edge.
    pub x: usize,
    /// The row of its upper edge.
    pub y: usize,
    /// The picture.
    pub image: Image,
}

/// The default width and height of a sheet of several views, in pixels.
const PAPER: (u32, u32) = (1280, 960);
const MARGIN: usize = 16;
/// The heights of the strip above a view, with its name, and of the one below, with the scale.
const HEAD: usize = 26;
const FOOT: usize = 30;
/// The height of the first row of a legend.
const LEGEND: usize = 30;
/// The maximum number of entries of a legend.
const MAX_ENTRIES: usize = 40;

/// The views of a sheet, with the column and row of each.
const VIEWS: [(View, usize, usize); 4] =
    [(View::Top, 0, 0), (View::Iso, 1, 0), (View::Front, 0, 1), (View::Right, 1, 1)];

impl PictureSheet {
    /// Draws the pictures of a scene. `options.size` is the size of the whole sheet.
    ///
    /// # Errors
    ///
    /// [`DrawError`]: settings out of range, a sheet that is too small, or the run was cancelled.
    pub fn draw<E: Evaluator>(
        kind: SheetKind,
        scene: &Scene,
        compiled: &Compiled,
        evaluator: &E,
        options: &PictureOptions,
        run: &mut Run<'_>,
    ) -> Result<PictureSheet, DrawError> {
        PictureSheet::draw_whole(kind, scene, compiled, evaluator, None, options, run)
    }

    /// Like [`PictureSheet::draw`] for a scene from which a [`CutAway`] has removed a part: the views that do not look onto a cut
    /// face show the whole model.
    ///
    /// # Errors
    ///
    /// Those of [`PictureSheet::draw`].
    pub fn draw_cut<E: Evaluator>(
        kind: SheetKind,
        scene: &Scene,
        compiled: &Compiled,
        evaluator: &E,
        whole: WholeModel<'_, E>,
        options: &PictureOptions,
        run: &mut Run<'_>,
    ) -> Result<PictureSheet, DrawError> {
        PictureSheet::draw_whole(kind, scene, compiled, evaluator, Some(whole), options, run)
    }

    fn draw_whole<'a, E: Evaluator>(
        kind: SheetKind,
        scene: &Scene,
        compiled: &Compiled,
        evaluator: &'a E,
        whole: Option<WholeModel<'a, E>>,
        options: &PictureOptions,
        run: &mut Run<'_>,
    ) -> Result<PictureSheet, DrawError> {
        let default = Size::new(PAPER.0, PAPER.1)?;
        let size = options.size.or((kind == SheetKind::Views).then_some(default));
        let (camera, settings) = arrange(scene, compiled, &PictureOptions { size, ..*options })?;
        super::check_memory(settings.size, super::PictureKind::Colour, memory::available())?;
        let entries = entries(compiled, &settings);
        let mut sheet = PictureSheet { size: settings.size, pictures: Vec::new(), drawing: Svg::default() };
        let bottom = sheet.legend(&entries);
        let mut painter = Painter { evaluator, settings, run, done: 0, of: 1 };
        match kind {
            SheetKind::One => sheet.one(camera, bottom, &mut painter)?,
            SheetKind::Views => sheet.views(scene, whole.as_ref(), bottom, &mut painter)?,
        }
        Ok(sheet)
    }

    /// Width and height in pixels.
    pub fn size(&self) -> Size {
        self.size
    }

    /// The pictures with their positions.
    pub fn pictures(&self) -> &[PlacedPicture] {
        &self.pictures
    }

    /// The sheet with embedded pictures.
    pub fn to_svg(&self, title: &str) -> String {
        let mut drawing = self.drawing.clone();
        for PlacedPicture { x, y, image } in &self.pictures {
            let [x, y, w, h] = [*x, *y, image.width(), image.height()].map(|pixels| pixels as f64);
            drawing.image([x, y, w, h], &rayweave_render::png::encode(image));
        }
        self.finish(drawing, title)
    }

    /// The sheet without the pictures, for programs that copy their pixels.
    pub fn without_pictures(&self, title: &str) -> String {
        self.finish(self.drawing.clone(), title)
    }

    fn finish(&self, drawing: Svg, title: &str) -> String {
        let size = [self.size.width() as f64, self.size.height() as f64];
        drawing.finish(size, title, "", "")
    }

    /// Draws the legend at the lower edge. Returns the height above it.
    fn legend(&mut self, entries: &[Entry]) -> usize {
        let width = self.size.width() as f64;
        let tall = legend::draw(&mut Svg::default(), entries, 0.0, width);
        let bottom = self.size.height().saturating_sub(tall as usize);
        if !entries.is_empty() {
            legend::draw(&mut self.drawing, entries, bottom as f64, width);
        }
        bottom.saturating_sub(if entries.is_empty() { 0 } else { LEGEND - HEAD / 2 })
    }

    fn one<E: Evaluator>(
        &mut self,
        camera: Camera,
        bottom: usize,
        painter: &mut Painter<'_, '_, E>,
    ) -> Result<(), DrawError> {
        let size = self.remaining_size(self.size.width(), bottom)?;
        self.pictures.push(PlacedPicture { x: 0, y: 0, image: painter.paint(&camera, size)? });
        Ok(())
    }

    fn views<'a, E: Evaluator>(
        &mut self,
        scene: &Scene,
        whole: Option<&WholeModel<'a, E>>,
        bottom: usize,
        painter: &mut Painter<'a, '_, E>,
    ) -> Result<(), DrawError> {
        let left = self.size.width().saturating_sub(3 * MARGIN) / 2;
        let tall = bottom.saturating_sub(2 * HEAD + FOOT) / 2;
        let cell = self.remaining_size(left, tall)?;
        painter.of = VIEWS.len();
        let cut = painter.evaluator;
        // one box for all views keeps them in line
        let program = whole.map_or(cut, |whole| whole.evaluator).program();
        // the scene is the cut one, and some of the views may show the whole model
        let camera = |view: View| match whole {
            Some(_) => view.fit(program, cell),
            None => super::fitted(view, scene, program, cell),
        };
        let cameras = to_one_scale(VIEWS.map(|(view, ..)| camera(view)));
        // a cut that no view looks onto is still shown, from behind
        let is_seen = |whole: &&WholeModel<'_, E>| {
            cameras.iter().any(|camera| whole.cut.is_seen_along(camera.forward()))
        };
        let whole = whole.filter(is_seen);
        for ((view, column, row), camera) in VIEWS.into_iter().zip(cameras) {
            let (x, y) = (MARGIN + column * (left + MARGIN), HEAD + row * (tall + HEAD));
            let (evaluator, name) = match whole {
                Some(whole) if whole.cut.is_seen_along(camera.forward()) => (cut, format!("{view}, cut")),
                Some(whole) => (whole.evaluator, view.to_string()),
                None => (cut, view.to_string()),
            };
            painter.evaluator = evaluator;
            self.pictures.push(PlacedPicture { x, y, image: painter.paint(&camera, cell)? });
            self.drawing.text("name", [x as f64, y as f64 - 8.0], Anchor::Start, &name, &name);
            if view == View::Front {
                self.scale(&camera, [x as f64, (y + tall + FOOT / 2) as f64], cell, scene.unit.symbol());
            }
        }
        Ok(())
    }

    /// Draws a scale bar of a round length.
    fn scale(&mut self, camera: &Camera, [x, y]: [f64; 2], cell: Size, unit: &str) {
        let Projection::Orthographic { height } = camera.projection() else { return };
        let length_per_pixel = height / cell.height() as f64;
        let length = round_step(0.1 * length_per_pixel * cell.width() as f64);
        let end = x + length / length_per_pixel;
        let bar = format!("M{x:.2} {:.2}V{y:.2}H{end:.2}V{:.2}", y - 4.0, y - 4.0);
        self.drawing.path("bar", bar, &format!(r#" fill="none" stroke="{INK}""#));
        let text = format!("{} {unit}", format_number(length, 0.1 * length));
        self.drawing.text("tick", [end + 8.0, y + 1.0], Anchor::Start, &text, &text);
    }

    /// The size of a picture in an area.
    fn remaining_size(&self, width: usize, height: usize) -> Result<Size, DrawError> {
        let side = |pixels: usize| u32::try_from(pixels).unwrap_or(u32::MAX);
        if width > 0 && height > 0 {
            return Ok(Size::new(side(width), side(height))?);
        }
        let (w, h) = (self.size.width(), self.size.height());
        let problem = format!("a sheet of {w} x {h} pixels is too small");
        Err(DrawError::Option(Message::new(problem, "the names and the legend leave no room for a picture")))
    }
}

/// Draws the pictures of a sheet and tracks the progress.
struct Painter<'a, 'r, E> {
    evaluator: &'a E,
    settings: RenderOptions,
    run: &'a mut Run<'r>,
    done: usize,
    of: usize,
}

impl<E: Evaluator> Painter<'_, '_, E> {
    fn paint(&mut self, camera: &Camera, size: Size) -> Result<Image, DrawError> {
        let settings = RenderOptions { size, ..self.settings.clone() };
        let (done, of) = (self.done as f64, self.of as f64);
        let mut outer = self.run.progress.as_mut();
        let mut progress = |part: f64| {
            if let Some(outer) = &mut outer {
                outer((done + part) / of);
            }
        };
        let mut run =
            Run { threads: self.run.threads, cancel: self.run.cancel.clone(), progress: Some(&mut progress) };
        let image = render(self.evaluator, camera, &settings, &mut run)?;
        self.done += 1;
        Ok(image)
    }
}

/// Cameras along axes get the scale of the one with the largest field; other cameras are unchanged.
fn to_one_scale(cameras: [Camera; 4]) -> [Camera; 4] {
    let along_axis = |camera: &Camera| camera.forward().abs().max_element() == 1.0;
    let height = |camera: &Camera| match camera.projection() {
        Projection::Orthographic { height } => height,
        Projection::Perspective { .. } => 0.0,
    };
    let most = cameras.iter().filter(|camera| along_axis(camera)).map(height).fold(0.0, f64::max);
    cameras.map(|camera| {
        let target = camera.position() + camera.forward();
        match along_axis(&camera) {
            true => Camera::orthographic(camera.position(), target, camera.up(), most).unwrap_or(camera),
            false => camera,
        }
    })
}

/// An entry for each medium or, if regions with the same medium differ in colour, for each colour.
fn entries(compiled: &Compiled, settings: &RenderOptions) -> Vec<Entry> {
    let mut of_media: BTreeMap<u32, Vec<(Rgba, &str)>> = BTreeMap::new();
    for (region, &colour) in compiled.program.regions().iter().zip(&settings.colours) {
        let colours = of_media.entry(region.medium).or_default();
        if !colours.iter().any(|(known, _)| *known == colour) {
            colours.push((colour, &region.name));
        }
    }
    let mut entries = Vec::new();
    for (medium, colours) in of_media {
        let medium = compiled.media.get(medium as usize).map_or("", String::as_str);
        let name =
            |region: &str| if colours.len() > 1 { format!("{medium}: {region}") } else { medium.to_owned() };
        entries.extend(colours.iter().map(|(colour, region)| entry(name(region), *colour)));
    }
    let more = entries.len().saturating_sub(MAX_ENTRIES);
    if more > 0 {
        entries.truncate(MAX_ENTRIES);
        entries.push(entry(format!("and {more} more"), Rgba::WHITE));
    }
    entries
}

/// An entry in a colour over white paper.
fn entry(name: String, colour: Rgba) -> Entry {
    let opacity = colour.opacity();
    let level = |channel: u8| (255.0 + opacity * (f32::from(channel) - 255.0)) as u8;
    let Rgba { red, green, blue, .. } = colour;
    Entry { name, colour: paint(Rgba::from([red, green, blue].map(level))), swatch: Swatch::Area }
}
