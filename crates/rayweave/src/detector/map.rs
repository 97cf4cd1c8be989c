//! Maps of irradiance.

use super::chart::{BELOW, Chart, MARGIN};
use rayweave_render::Rgba;
use rayweave_render::axis::Axis;
use rayweave_render::svg::{Anchor, Pixels, Svg};
use std::collections::BTreeMap;
use std::fmt::Write;

/// Cells on a side of the grid in which light is gathered.
const CELLS: i64 = 512;

/// The size of the cells is fitted to so many points.
const FIRST: usize = 1024;

/// Gathers the power that arrives at each place of a detector, on two grids that grow with what they have to hold: where
/// light arrives beside one, its cells are joined four by four. One holds all light. The other grows only if more than a
/// fiftieth of the light fell beside it, so that a bright spot is not lost among faint ghosts far from it.
///
/// ```
/// use rayweave::detector::IrradianceMap;
///
/// let mut map = IrradianceMap::default();
/// for k in 0..10_000 {
///     map.add([(k % 100) as f64 / 100.0, (k / 100) as f64 / 50.0], 1e-4);
/// }
/// let map = map.finish(16);
/// // a power of 1 on an area of 1 by 2
/// assert!((map.power() - 1.0).abs() < 1e-12);
/// let [width, height] = [map.hi[0] - map.lo[0], map.hi[1] - map.lo[1]];
/// assert!((width - 1.0).abs() <= map.side && (height - 2.0).abs() <= map.side);
/// ```
#[derive(Clone, Debug, Default)]
pub struct IrradianceMap {
    /// The first points, until the size of cells is known.
    first: Vec<([f64; 2], f64)>,
    /// That of the bright part, and that of all.
    grids: Option<[Grid; 2]>,
    /// What fell beside the first grid, and all.
    beside: f64,
    total: f64,
}

/// The first grid need not hold this part of the light.
const FAINT: f64 = 0.02;

#[derive(Clone, Debug)]
struct Grid {
    /// The side of a cell.
    cell: f64,
    /// The number of the first cell along both axes; cell k begins at k times its side.
    begin: [i64; 2],
    /// Row by row.
    power: Vec<f64>,
}

/// Power per area on a grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Map {
    /// The lower left corner, in the coordinates of the detector.
    pub lo: [f64; 2],
    /// The upper right corner.
    pub hi: [f64; 2],
    /// The side of a cell, all of which are squares.
    pub side: f64,
    /// The number of columns.
    pub columns: usize,
    /// Power per area, row by row from below.
    pub values: Vec<f64>,
}

impl IrradianceMap {
    /// Adds the power of a ray that arrives at a place.
    pub fn add(&mut self, place: [f64; 2], power: f64) {
        if !(power > 0.0 && place.iter().all(|x| x.is_finite())) {
            return;
        }
        self.total += power;
        match &self.grids {
            Some(_) => self.put(place, power),
            None => self.first.push((place, power)),
        }
        if self.grids.is_none() && self.first.len() == FIRST {
            self.settle();
        }
    }

    fn put(&mut self, place: [f64; 2], power: f64) {
        let Some([bright, all]) = &mut self.grids else { return };
        while !all.add(place, power) {
            all.join();
        }
        while !bright.add(place, power) {
            if self.beside + power <= FAINT * self.total {
                self.beside += power;
                return;
            }
            bright.join();
        }
    }

    /// Chooses the size of cells.
    fn settle(&mut self) {
        let first = std::mem::take(&mut self.first);
        self.grids = Some([Grid::around(&bright(&first)), Grid::around(&first)]);
        first.into_iter().for_each(|(place, power)| self.put(place, power));
    }

    /// The map of the part on which light fell, but for ghosts of less than a fiftieth of it, with at most so many cells
    /// along each side; one dark cell if there was no light.
    pub fn finish(mut self, most: usize) -> Map {
        if self.grids.is_none() && !self.first.is_empty() {
            self.settle();
        }
        let most = most.clamp(1, CELLS as usize) as i64;
        match &self.grids {
            Some([bright, all]) => {
                let holds = bright.power.iter().sum::<f64>() >= (1.0 - 2.0 * FAINT) * self.total;
                // where both are about as fine, nothing is gained by leaving light out
                let is_finer = all.cell >= 4.0 * bright.cell;
                if holds && is_finer { bright.map(most) } else { all.map(most) }
            }
            None => Map { lo: [0.0; 2], hi: [1.0; 2], side: 1.0, columns: 1, values: vec![0.0] },
        }
    }
}

/// The points around the middle that hold nearly all power.
fn bright(points: &[([f64; 2], f64)]) -> Vec<([f64; 2], f64)> {
    let total: f64 = points.iter().map(|point| point.1).sum();
    let mean = [0, 1].map(|k| points.iter().map(|(place, power)| place[k] * power / total).sum::<f64>());
    let distance = |place: [f64; 2]| (place[0] - mean[0]).abs().max((place[1] - mean[1]).abs());
    let mut points = points.to_vec();
    points.sort_by(|a, b| distance(a.0).total_cmp(&distance(b.0)));
    let mut sum = 0.0;
    points.retain(|(_, power)| {
        sum += power;
        sum <= (1.0 - FAINT) * total + power
    });
    points
}

impl Grid {
    fn around(points: &[([f64; 2], f64)]) -> Grid {
        let (mut lo, mut hi) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for (place, _) in points {
            for k in 0..2 {
                lo[k] = lo[k].min(place[k]);
                hi[k] = hi[k].max(place[k]);
            }
        }
        let far = lo.iter().chain(&hi).filter(|x| x.is_finite()).fold(0.0, |far: f64, x| far.max(x.abs()));
        let size = (hi[0] - lo[0]).max(hi[1] - lo[1]);
        // numbers of cells have to be small enough to be counted exactly, and areas numbers
        let cell = match (size > 0.0, far > 0.0) {
            (true, _) => (size / (0.5 * CELLS as f64)).max(1e-12 * far).max(1e-100),
            (false, true) => (1e-6 * far).max(1e-100),
            (false, false) => 1e-6,
        };
        let cell = if cell.is_finite() { cell } else { 1.0 };
        let middle = [0, 1].map(|k| if lo[k] <= hi[k] { 0.5 * (lo[k] + hi[k]) } else { 0.0 });
        let begin = middle.map(|x| (x / cell).floor() as i64 - CELLS / 2);
        Grid { cell, begin, power: vec![0.0; (CELLS * CELLS) as usize] }
    }

    /// False, with nothing done, for a place beside the grid.
    fn add(&mut self, place: [f64; 2], power: f64) -> bool {
        let at = [0, 1].map(|k| ((place[k] / self.cell).floor() as i64).saturating_sub(self.begin[k]));
        let is_in = at.iter().all(|k| (0..CELLS).contains(k));
        if is_in {
            self.power[(at[1] * CELLS + at[0]) as usize] += power;
        }
        is_in
    }

    /// Makes one cell of four, the old grid in the middle of the new one.
    fn join(&mut self) {
        let old = std::mem::replace(&mut self.power, vec![0.0; (CELLS * CELLS) as usize]);
        let begin = self.begin;
        self.cell *= 2.0;
        self.begin = begin.map(|first| first.div_euclid(2) - CELLS / 4);
        for (number, power) in (0..).zip(old).filter(|(_, power)| *power != 0.0) {
            let cell = [number % CELLS + begin[0], number / CELLS + begin[1]];
            let [x, y] = [0, 1].map(|k| cell[k].div_euclid(2) - self.begin[k]);
            self.power[(y * CELLS + x) as usize] += power;
        }
    }

    /// The first and the last column and row on which light fell.
    fn lit(&self) -> Option<([i64; 2], [i64; 2])> {
        let mut found: Option<([i64; 2], [i64; 2])> = None;
        for (number, _) in (0..).zip(&self.power).filter(|(_, power)| **power != 0.0) {
            let at: [i64; 2] = [number % CELLS, number / CELLS];
            let (lo, hi) = found.unwrap_or((at, at));
            found = Some(([0, 1].map(|k| lo[k].min(at[k])), [0, 1].map(|k| hi[k].max(at[k]))));
        }
        found
    }

    fn map(&self, most: i64) -> Map {
        let (from, to) = self.lit().unwrap_or(([CELLS / 2; 2], [CELLS / 2; 2]));
        // so many cells of the grid are a cell of the map, on a side
        let join = (to[0] - from[0] + 1).max(to[1] - from[1] + 1).div_euclid(most).max(0) + 1;
        let count = [0, 1].map(|k| ((to[k] - from[k]) / join + 1) as usize);
        let mut values = vec![0.0; count[0] * count[1]];
        for y in from[1]..=to[1] {
            for x in from[0]..=to[0] {
                let at = [(x - from[0]) / join, (y - from[1]) / join].map(|k| k as usize);
                values[at[1] * count[0] + at[0]] += self.power[(y * CELLS + x) as usize];
            }
        }
        let side = self.cell * join as f64;
        values.iter_mut().for_each(|power| *power /= side * side);
        let lo = [0, 1].map(|k| (self.begin[k] + from[k]) as f64 * self.cell);
        let hi = [0, 1].map(|k| lo[k] + count[k] as f64 * side);
        Map { lo, hi, side, columns: count[0], values }
    }
}

/// Steps of colour.
const LEVELS: usize = 128;

const STYLE: &str = ".cell { stroke: none; shape-rendering: crispEdges }\n";

impl Map {
    /// The number of rows.
    pub fn rows(&self) -> usize {
        self.values.len() / self.columns
    }

    /// The power of all cells.
    pub fn power(&self) -> f64 {
        self.values.iter().sum::<f64>() * self.side * self.side
    }

    /// The greatest irradiance.
    pub fn peak(&self) -> f64 {
        self.values.iter().copied().fold(0.0, f64::max)
    }

    /// The power of the cells that are shown, and how many there are.
    fn subject(&self) -> String {
        format!("power {} on {} \u{d7} {} cells", short(self.power()), self.columns, self.rows())
    }

    /// The drawing: a colour for each cell, from black for no light to white for the most, and a bar that says how much that
    /// is, in the unit of power of the sources per square of the unit of length.
    pub fn to_svg(&self, name: &str, unit: &str) -> String {
        let chart = Chart::new(self.lo, self.hi);
        let mut svg = Svg::default();
        self.cells(&chart, &mut svg);
        let subject = self.subject();
        chart.draw(&mut svg, [&format!("Irradiance: {name}"), &subject], unit);
        let right = self.bar(&chart, unit, &mut svg);
        let [_, top, _, height] = chart.frame();
        svg.finish(
            [right.max(400.0), top + height.max(120.0) + BELOW],
            &format!("Irradiance: {name}"),
            &subject,
            STYLE,
        )
    }

    /// Cells of one colour are one path.
    fn cells(&self, chart: &Chart, svg: &mut Svg) {
        let mut paths: BTreeMap<usize, String> = BTreeMap::new();
        let [_, top, width, height] = chart.frame();
        let (w, h) = (width / self.columns as f64, height / self.rows() as f64);
        let peak = self.peak();
        for (k, &value) in self.values.iter().enumerate() {
            let level = (value / peak * (LEVELS - 1) as f64).round() as usize;
            let (column, row) = (k % self.columns, self.rows() - 1 - k / self.columns);
            let [x, end] = [column, column + 1].map(|c| Pixels(chart.x.left + c as f64 * w));
            let [y, low] = [row, row + 1].map(|r| Pixels(top + r as f64 * h));
            let _ = write!(paths.entry(level).or_default(), "M{x} {y}H{end}V{low}H{x}Z");
        }
        for (level, path) in paths {
            svg.path("cell", path, &format!(r#" fill="{}""#, paint(level)));
        }
    }

    /// The colours with their values; the right end of the drawing.
    fn bar(&self, chart: &Chart, unit: &str, svg: &mut Svg) -> f64 {
        let [left, top, width, height] = chart.frame();
        let (x, height) = (left + width + 30.0, height.max(120.0));
        let step = height / LEVELS as f64;
        for level in 0..LEVELS {
            let y = top + height - (level + 1) as f64 * step;
            svg.rectangle("cell", [x, y, 16.0, step + 0.5], &format!(r#" fill="{}""#, paint(level)));
        }
        svg.rectangle("axis", [x, top, 16.0, height], "");
        let axis =
            Axis { t_min: 0.0, t_max: self.peak().max(f64::MIN_POSITIVE), left: top + height, right: top };
        let mut letters = 8;
        for (value, text) in axis.ticks((height / 45.0).max(1.0)) {
            letters = letters.max(text.chars().count());
            svg.text("tick", [x + 24.0, axis.place(value) + 4.0], Anchor::Start, &text, &text);
        }
        let label = format!("power / {unit}\u{b2}");
        svg.text("tick", [x, top - 8.0], Anchor::Start, &label, &label);
        x + 30.0 + 6.4 * letters as f64 + MARGIN
    }
}

fn short(value: f64) -> String {
    rayweave_render::axis::number(value, 1e-4 * value.max(f64::MIN_POSITIVE))
}

fn paint(level: usize) -> String {
    let Rgba { red, green, blue, .. } = cubehelix(level as f64 / (LEVELS - 1) as f64);
    format!("#{red:02x}{green:02x}{blue:02x}")
}

/// Colours from black to white whose lightness grows evenly, as eyes see it: D. A. Green, *A colour scheme for the display of
/// astronomical intensity images*, Bull. Astron. Soc. India 39, 289 (2011), with start 0.5, -1.5 rotations, hue 1, gamma 1.
fn cubehelix(part: f64) -> Rgba {
    let angle = std::f64::consts::TAU * (0.5 / 3.0 + 1.0 - 1.5 * part);
    let amplitude = 0.5 * part * (1.0 - part);
    let (cos, sin) = (libm::cos(angle), libm::sin(angle));
    let channel = |c: f64, s: f64| {
        let level = part + amplitude * (c * cos + s * sin);
        (255.0 * level.clamp(0.0, 1.0)).round() as u8
    };
    Rgba::opaque(channel(-0.148_61, 1.782_77), channel(-0.292_27, -0.906_49), channel(1.972_94, 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Wherever light falls in whatever order, none is lost and all is where it should be.
    #[test]
    fn grids_grow() {
        let mut map = IrradianceMap::default();
        let mut sum = 0.0;
        for k in 0..40_000_u32 {
            // outwards along a spiral
            let (r, angle) = (1e-3 * f64::from(k), 0.1 * f64::from(k));
            map.add([5.0 + r * angle.cos(), r * angle.sin()], 1.0 + f64::from(k % 3));
            sum += 1.0 + f64::from(k % 3);
        }
        let map = map.finish(64);
        assert!((map.power() / sum - 1.0).abs() < 1e-12, "{} {sum}", map.power());
        assert!(map.columns <= 64 && map.rows() <= 64 && map.columns > 20);
        for k in 0..2 {
            let middle = 0.5 * (map.lo[k] + map.hi[k]);
            assert!((middle - [5.0, 0.0][k]).abs() < 1.5, "{map:?}");
            assert!((map.hi[k] - map.lo[k] - 80.0).abs() < 3.0);
        }
    }

    /// A spot of a thousandth of the size of the ghosts around it, which hold a hundredth of the power.
    #[test]
    fn ghosts_do_not_hide_the_spot() {
        let mut map = IrradianceMap::default();
        for k in 0..20_000_u32 {
            let (x, y) = (f64::from(k % 141) / 141.0 - 0.5, f64::from(k / 141) / 141.0 - 0.5);
            map.add([1e-2 * x, 1e-2 * y], 1.0);
            map.add([10.0 * x, 10.0 * y], 0.01);
        }
        let map = map.finish(64);
        assert!(map.hi[0] - map.lo[0] < 0.1, "{:?} {:?}", map.lo, map.hi);
        assert!((map.power() / 20_000.0 - 1.0).abs() < 1e-3, "{}", map.power());
    }

    #[test]
    fn little_light() {
        let dark = IrradianceMap::default().finish(8);
        assert_eq!((dark.power(), dark.columns, dark.rows()), (0.0, 1, 1));
        assert!(dark.to_svg("a", "mm").contains("<svg "));
        let mut map = IrradianceMap::default();
        (0..2000).for_each(|_| map.add([3.0, -4.0], 0.5));
        map.add([f64::NAN, 0.0], 1.0);
        let map = map.finish(8);
        assert!((map.power() - 1000.0).abs() < 1e-9);
        assert!(map.lo[0] <= 3.0 && 3.0 <= map.hi[0] && map.lo[1] <= -4.0 && -4.0 <= map.hi[1]);
        // a perfect focus on the axis
        let mut map = IrradianceMap::default();
        (0..2000).for_each(|_| map.add([0.0; 2], 0.5));
        let map = map.finish(8);
        assert!((map.power() - 1000.0).abs() < 1e-9 && map.peak().is_finite(), "{map:?}");
    }

    /// The values of the paper's scheme at its ends and in the middle, where the hue is start + rotations / 2.
    #[test]
    fn the_colours_of_the_scheme() {
        assert_eq!(cubehelix(0.0), Rgba::opaque(0, 0, 0));
        assert_eq!(cubehelix(1.0), Rgba::opaque(255, 255, 255));
        let lightness = |part: f64| {
            let c = cubehelix(part);
            0.30 * f64::from(c.red) + 0.59 * f64::from(c.green) + 0.11 * f64::from(c.blue)
        };
        for k in 0..=20 {
            let part = f64::from(k) / 20.0;
            assert!((lightness(part) / 255.0 - part).abs() < 0.01, "{part} {}", lightness(part));
        }
    }
}
