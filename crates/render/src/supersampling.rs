//! Adaptive supersampling: a grid of samples in each pixel with contrast.

use crate::Size;
use crate::colour::{Premultiplied, over};
use crate::contrast::{Contrast, EdgeKind};
use crate::extent::centre;
use crate::first_pass::FirstPass;
use crate::pen::Pen;
use crate::sample::{PicturePoints, Sample};
use crate::shade::Shader;

/// Samples of the supersampled pixels, with those of the first pass for the others.
pub(crate) struct Supersampler<'a> {
    first_pass: &'a FirstPass,
    /// The numbers of the supersampled pixels, increasing.
    pub places: &'a [usize],
    /// For each pixel, its position in `places` counted from 1, or [`NOWHERE`].
    first_of: Vec<u32>,
    grid: Grid,
    samples: Vec<Sample>,
    colours: Vec<Premultiplied>,
}

const NOWHERE: u32 = 0;

/// Sample positions in pixel coordinates: n x n per pixel, row by row.
#[derive(Clone, Copy)]
pub(crate) struct Grid {
    size: Size,
    n: usize,
}

impl Grid {
    /// The positions of the samples of some pixels.
    pub fn points(self, pixels: &[usize], points: &mut PicturePoints) {
        points.per_side = self.n as u32;
        points.pixels.clear();
        points.pixels.extend(pixels.iter().map(|&pixel| pixel as u32));
        points.places.clear();
        let samples = |&pixel: &usize| (0..self.n * self.n).map(move |k| self.place(pixel, k));
        points.places.extend(pixels.iter().flat_map(samples));
    }

    fn place(self, pixel: usize, k: usize) -> [f64; 2] {
        let at = |whole: usize, part: usize| whole as f64 + (part as f64 + 0.5) / self.n as f64;
        let width = self.size.width();
        [at(pixel % width, k % self.n), at(pixel / width, k / self.n)]
    }
}

/// Everything needed to draw lines.
pub(crate) struct Ink<'a> {
    pub pen: &'a Pen,
    pub contrast: &'a Contrast,
    pub shader: &'a Shader,
}

/// Pixels, with the buffers for their samples and colours.
type Piece<'p> = (&'p [usize], &'p mut [Sample], &'p mut [Premultiplied]);

impl<'a> Supersampler<'a> {
    /// Allocates n x n samples for each pixel of `places`.
    pub fn new(first_pass: &'a FirstPass, places: &'a [usize], n: usize) -> Supersampler<'a> {
        let mut first_of = vec![NOWHERE; first_pass.size.count()];
        for (k, &place) in places.iter().enumerate() {
            // counted from 1: a zeroed array costs nothing until it is touched
            first_of[place] = k as u32 + 1;
        }
        let count = places.len() * n * n;
        Supersampler {
            first_pass,
            places,
            first_of,
            grid: Grid { size: first_pass.size, n },
            samples: vec![Sample::MISS; count * first_pass.levels],
            colours: vec![[0.0; 4]; count],
        }
    }

    /// The buffers in pieces of `pixels` pixels.
    pub fn pieces(&mut self, pixels: usize) -> (Grid, impl ExactSizeIterator<Item = Piece<'_>> + Send) {
        let length = pixels * self.grid.n * self.grid.n;
        let samples = self.samples.chunks_mut(length * self.first_pass.levels);
        let room = samples.zip(self.colours.chunks_mut(length));
        let pieces = self.places.chunks(pixels).zip(room);
        (self.grid, pieces.map(|(places, (samples, colours))| (places, samples, colours)))
    }

    /// The mean colour of a supersampled pixel, over a background and under lines.
    pub fn mean(&self, place: usize, behind: Premultiplied, ink: Option<&Ink<'_>>) -> Premultiplied {
        let per_place = self.grid.n * self.grid.n;
        let first = self.first(place).unwrap_or(0);
        let mut sum = [0.0; 4];
        for k in 0..per_place {
            let colour = over(self.colours[first + k], behind);
            let line = ink.map_or([0.0; 4], |ink| self.line(place, k, ink));
            let colour = over(line, colour);
            sum = std::array::from_fn(|c| sum[c] + colour[c]);
        }
        sum.map(|channel| channel / per_place as f32)
    }

    /// The colour of the line over a sample: the line of the first level that has one, attenuated by the
    /// levels in front.
    fn line(&self, place: usize, k: usize, ink: &Ink<'_>) -> Premultiplied {
        let first = (self.first(place).unwrap_or(0) + k) * self.first_pass.levels;
        let mut transparency = 1.0;
        for (level, sample) in self.samples[first..first + self.first_pass.levels].iter().enumerate() {
            if self.is_on_line(place, k, level, sample, ink) {
                return ink.pen.colour.map(|channel| channel * transparency);
            }
            if *sample == Sample::MISS {
                break;
            }
            transparency *= ink.shader.transparency(sample.region);
        }
        [0.0; 4]
    }

    fn is_on_line(&self, place: usize, k: usize, level: usize, sample: &Sample, ink: &Ink<'_>) -> bool {
        let (n, width) = (self.grid.n, self.first_pass.size.width());
        let at = [place % width * n + k % n, place / width * n + k / n];
        let here = self.grid.place(place, k);
        ink.pen.touches(|[x, y]| {
            let other = [at[0].wrapping_add_signed(x), at[1].wrapping_add_signed(y)];
            match self.sample(other, level) {
                Some((other, there)) => ink.contrast.edge(sample, here, other, there),
                None => EdgeKind::None,
            }
        })
    }

    /// The index of the first sample of a pixel, if it is supersampled.
    fn first(&self, pixel: usize) -> Option<usize> {
        let number = self.first_of[pixel].checked_sub(1)?;
        Some(number as usize * self.grid.n * self.grid.n)
    }

    /// A sample of the fine grid; in other pixels, that of the first pass. `None` outside the picture.
    fn sample(&self, [x, y]: [usize; 2], level: usize) -> Option<(&Sample, [f64; 2])> {
        let (n, size) = (self.grid.n, self.first_pass.size);
        // indices left of the picture or above it wrap around; 32-bit divisions are several times as fast
        let limit = size.width().max(size.height()) * n;
        if x >= limit || y >= limit {
            return None;
        }
        let (column, row) = ((x as u32 / n as u32) as usize, (y as u32 / n as u32) as usize);
        if column >= size.width() || row >= size.height() {
            return None;
        }
        let pixel = row * size.width() + column;
        Some(match self.first(pixel) {
            None => (self.first_pass.at(column, row, level), centre(column, row)),
            Some(first) => {
                let k = (y - row * n) * n + (x - column * n);
                (&self.samples[(first + k) * self.first_pass.levels + level], self.grid.place(pixel, k))
            }
        })
    }
}
