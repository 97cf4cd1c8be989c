//! The renderer: first pass with one ray per pixel, contrast, adaptive supersampling, lines and averaging.

use crate::camera_rays::CameraRays;
use crate::colour::{Premultiplied, over, pixel, premultiply};
use crate::contrast::Contrast;
use crate::extent::{Extent, Tile, TileSize, centre};
use crate::first_pass::FirstPass;
use crate::image::Image;
use crate::pen::Pen;
use crate::sample::{PicturePoints, Sample};
use crate::shade::Shader;
use crate::supersampling::{Ink, Supersampler};
use crate::{Background, Camera, PixelGrid, RenderError, RenderOptions, Rgba, Run, Size};
use rayweave_model::Evaluator;
use std::ops::Range;

/// Renders a picture.
///
/// The first pass traces one ray through the centre of each pixel. Pixels that differ from a neighbour (a
/// different region, a step in depth, a different face at an angle, a different shadow: see
/// [`crate::Lines`]), and those within the reach of a line there, are supersampled on a regular grid; the
/// pixel is the mean in linear light. Details smaller than a pixel that no centre ray hits are therefore
/// missed. Memory: about 50 bytes per pixel, and 60 n^2 for each supersampled pixel with n x n samples; four
/// times as much with translucent regions.
///
/// With [`RenderOptions::rows`] the picture has only these rows. Rows within the reach of lines above and below them are traced too.
///
/// # Errors
/// [`RenderError`] for settings out of range and cancelled runs.
pub fn render<E: Evaluator>(
    evaluator: &E,
    camera: &Camera,
    settings: &RenderOptions,
    run: &mut Run<'_>,
) -> Result<Image, RenderError> {
    settings.check()?;
    camera.check(evaluator.program())?;
    let drawing = Drawing {
        evaluator,
        camera,
        settings,
        size: settings.size,
        tiles: TileSize::new(evaluator.preferred_batch(), settings.size),
        shader: Shader::new(evaluator.program(), camera, settings),
        contrast: Contrast::new(camera, settings.size, settings.lines.as_ref()),
        pen: settings.lines.map(|lines| Pen::new(&lines, settings.samples)),
        rows: settings
            .rows
            .as_ref()
            .map_or(0..settings.size.height(), |rows| rows.start as usize..rows.end as usize),
    };
    let mut image = PixelGrid::filled(settings.size, [0; 4]);
    let first_pass = drawing.first_pass(&mut image, run)?;
    if drawing.is_refined() {
        let places = drawing.places_to_refine(&first_pass, run)?;
        let supersampler = drawing.supersample(&first_pass, &places, run)?;
        drawing.resolve(&supersampler, &mut image, run)?;
    }
    Ok(match &settings.rows {
        None => image,
        Some(rows) => cropped(image, rows.clone())?,
    })
}

/// Some rows of a picture.
fn cropped(image: Image, rows: Range<u32>) -> Result<Image, RenderError> {
    let width = image.size().width();
    let size = Size::new(width as u32, rows.end - rows.start)?;
    let values = image.values()[rows.start as usize * width..rows.end as usize * width].to_vec();
    Ok(PixelGrid::from_values(size, values).unwrap_or_else(|| PixelGrid::filled(size, [0; 4])))
}

/// A picture being rendered.
struct Drawing<'a, E> {
    evaluator: &'a E,
    camera: &'a Camera,
    settings: &'a RenderOptions,
    size: Size,
    tiles: TileSize,
    shader: Shader,
    contrast: Contrast,
    pen: Option<Pen>,
    /// The rows of pixels that are drawn.
    rows: Range<usize>,
}

/// The buffers for one tile: points, colours and samples.
#[derive(Default)]
struct Glimpse {
    points: PicturePoints,
    colours: Vec<Premultiplied>,
    samples: Vec<Sample>,
}

/// Pixels per piece of supersampling work, unless the evaluator prefers larger batches.
const PIECE: usize = 64;

/// The estimated fraction of the work done after each stage.
const DONE: [f64; 4] = [0.5, 0.55, 0.9, 1.0];

impl<E: Evaluator> Drawing<'_, E> {
    fn is_refined(&self) -> bool {
        self.settings.samples > 1 || self.pen.is_some()
    }

    /// The rows of pixels within a distance of those that are drawn.
    fn rows_within(&self, distance: usize) -> Range<usize> {
        self.rows.start.saturating_sub(distance)..(self.rows.end + distance).min(self.size.height())
    }

    /// The reach of lines, in pixels.
    fn reach(&self) -> usize {
        self.pen.as_ref().map_or(1, |pen| pen.reach)
    }

    /// First pass: one ray per pixel.
    fn first_pass(&self, image: &mut Image, run: &mut Run<'_>) -> Result<FirstPass, RenderError> {
        let bounds = self.evaluator.program().bounds();
        let levels = self.shader.levels();
        let mut first_pass = FirstPass::new(self.size, Extent::new(self.camera, self.size, &bounds), levels);
        let (extent, rows) = (&first_pass.extent, &mut first_pass.rows);
        let height = self.tiles.height;
        let bands = image.values_mut().chunks_mut(height * self.size.width());
        let pieces = bands.zip(rows.chunks_mut(height)).enumerate();
        let end = if self.is_refined() { DONE[0] } else { 1.0 };
        let scratch = || (self.camera_rays(), Glimpse::default());
        // a line at a drawn pixel depends on supersampled pixels within its reach, and these on edges within the reach again, each
        // between two rows
        let needed = self.rows_within(2 * self.reach() + 2);
        run.each(0.0..end, pieces, scratch, |(camera_rays, glimpse), (band, (pixels, samples))| {
            let first = band * height;
            for (r, row) in pixels.chunks_mut(self.size.width()).enumerate() {
                row.fill(pixel(self.behind(first + r)));
                if self.is_refined() {
                    samples[r].resize(extent.columns(first + r).len() * levels, Sample::MISS);
                }
            }
            if first >= needed.end || first + samples.len() <= needed.start {
                return;
            }
            for tile in extent.tiles(self.tiles, first..first + samples.len()) {
                self.trace_tile(&tile, camera_rays, glimpse, pixels, samples);
            }
        })?;
        Ok(first_pass)
    }

    fn camera_rays(&self) -> CameraRays<'_, E> {
        CameraRays::new(self.evaluator, &self.shader, self.camera, self.size)
    }

    /// Traces the pixels of a tile; `pixels` and `samples` are those of its rows.
    fn trace_tile(
        &self,
        tile: &Tile,
        camera_rays: &mut CameraRays<'_, E>,
        glimpse: &mut Glimpse,
        pixels: &mut [[u8; 4]],
        samples: &mut [Vec<Sample>],
    ) {
        let levels = self.shader.levels();
        tile.centres(self.size.width(), &mut glimpse.points);
        let count = glimpse.points.places.len();
        glimpse.colours.resize(count, [0.0; 4]);
        glimpse.samples.resize(if self.is_refined() { count * levels } else { 0 }, Sample::MISS);
        camera_rays.trace(&glimpse.points, &mut glimpse.samples, &mut glimpse.colours);
        let mut at = 0;
        for part in &tile.parts {
            let row = part.row % self.tiles.height;
            let length = part.columns.len();
            let first = row * self.size.width() + part.columns.start;
            for (out, &colour) in pixels[first..first + length].iter_mut().zip(&glimpse.colours[at..]) {
                if colour[3] > 0.0 {
                    *out = pixel(if colour[3] < 1.0 { over(colour, self.behind(part.row)) } else { colour });
                }
            }
            if self.is_refined() {
                let (from, to) = (at * levels, part.offset * levels);
                let seen = &glimpse.samples[from..from + length * levels];
                samples[row][to..to + seen.len()].copy_from_slice(seen);
            }
            at += length;
        }
    }

    /// The background colour in a row of pixels.
    fn behind(&self, row: usize) -> Premultiplied {
        let full = |colour: Rgba| premultiply(colour.linear(), colour.opacity());
        match self.settings.background {
            Background::Transparent => [0.0; 4],
            Background::Colour(colour) => full(colour),
            Background::Gradient { top, bottom } => {
                let part = (row as f32 + 0.5) / self.size.height() as f32;
                let (top, bottom) = (full(top), full(bottom));
                std::array::from_fn(|k| (1.0 - part) * top[k] + part * bottom[k])
            }
        }
    }

    /// The pixels within reach of an edge between neighbours, in order.
    fn places_to_refine(&self, first_pass: &FirstPass, run: &mut Run<'_>) -> Result<Vec<usize>, RenderError> {
        let width = self.size.width();
        let mut differs = vec![false; self.size.count()];
        let pieces = differs.chunks_mut(width).enumerate();
        let compared = self.rows_within(2 * self.reach() + 1);
        run.each(
            DONE[0]..DONE[1],
            pieces,
            || (),
            |(), (y, row)| {
                if !compared.contains(&y) {
                    return;
                }
                for x in first_pass.busy_columns(y) {
                    row[x] = self.differs(first_pass, [x, y], [x + 1, y])
                        || self.differs(first_pass, [x, y], [x, y + 1]);
                }
            },
        )?;
        let mut places = within_reach(self.size, &differs, self.reach());
        let refined = self.rows_within(self.reach());
        places.retain(|place| refined.contains(&(place / width)));
        Ok(places)
    }

    /// True if an edge between two pixels requires supersampling; false outside the picture.
    fn differs(&self, first_pass: &FirstPass, a: [usize; 2], b: [usize; 2]) -> bool {
        if b[0] >= self.size.width() || b[1] >= self.size.height() {
            return false;
        }
        let (a_at, b_at) = (centre(a[0], a[1]), centre(b[0], b[1]));
        let differ = |level| {
            let (a, b) = (first_pass.at(a[0], a[1], level), first_pass.at(b[0], b[1], level));
            self.contrast.differs(a, a_at, b, b_at)
        };
        (0..first_pass.levels).any(differ)
    }

    /// Supersamples pixels with a grid of rays each.
    fn supersample<'s>(
        &self,
        first_pass: &'s FirstPass,
        places: &'s [usize],
        run: &mut Run<'_>,
    ) -> Result<Supersampler<'s>, RenderError> {
        let mut supersampler = Supersampler::new(first_pass, places, self.settings.samples as usize);
        let rays = (self.settings.samples * self.settings.samples) as usize;
        let piece = self.evaluator.preferred_batch().map_or(PIECE, |batch| (batch.get() / rays).max(PIECE));
        let (grid, pieces) = supersampler.pieces(piece);
        let scratch = || (self.camera_rays(), PicturePoints::default());
        run.each(DONE[1]..DONE[2], pieces, scratch, |(camera_rays, points), (places, samples, colours)| {
            grid.points(places, points);
            camera_rays.trace(points, samples, colours);
        })?;
        Ok(supersampler)
    }

    /// Draws lines over the samples and writes their means into the picture.
    fn resolve(
        &self,
        supersampler: &Supersampler<'_>,
        image: &mut Image,
        run: &mut Run<'_>,
    ) -> Result<(), RenderError> {
        let mut pixels = vec![[0; 4]; supersampler.places.len()];
        let pieces = supersampler.places.chunks(PIECE).zip(pixels.chunks_mut(PIECE));
        let (contrast, shader) = (&self.contrast, &self.shader);
        let ink = self.pen.as_ref().map(|pen| Ink { pen, contrast, shader });
        run.each(
            DONE[2]..DONE[3],
            pieces,
            || (),
            |(), (places, pixels)| {
                for (&place, out) in places.iter().zip(pixels) {
                    let behind = self.behind(place / self.size.width());
                    *out = pixel(supersampler.mean(place, behind, ink.as_ref()));
                }
            },
        )?;
        for (&place, &pixel) in supersampler.places.iter().zip(&pixels) {
            image.values_mut()[place] = pixel;
        }
        Ok(())
    }
}

/// The pixels within `reach` columns and rows of a marked pixel or of its right or lower neighbour.
fn within_reach(size: Size, marked: &[bool], reach: usize) -> Vec<usize> {
    let (width, height) = (size.width(), size.height());
    let mut near = vec![false; marked.len()];
    for (y, row) in marked.chunks(width).enumerate() {
        for (x, _) in row.iter().enumerate().filter(|(_, marked)| **marked) {
            let columns = x.saturating_sub(reach)..(x + reach + 2).min(width);
            for row in y.saturating_sub(reach)..(y + reach + 2).min(height) {
                near[row * width + columns.start..row * width + columns.end].fill(true);
            }
        }
    }
    let places = near.iter().enumerate().filter(|(_, near)| **near);
    places.map(|(place, _)| place).collect()
}
