//! Irradiance: power per area, binned on a grid.

/// Cells along each side of the grid that bins power.
const CELLS: i64 = 512;

/// The number of points from which the size of cells is chosen.
const FIRST: usize = 1024;

/// Bins the power of rays that arrive at a detector, in bounded memory.
///
/// Two grids grow on demand: when light arrives outside a grid, its cells are merged in blocks of 2 x 2.
/// One grid holds all light. The other one grows only if more than 2 % of the light falls outside
/// of it, so that faint distant ghosts do not hide a bright spot.
///
/// ```
/// use rayweave_optics::detector::IrradianceBins;
///
/// let mut bins = IrradianceBins::default();
/// for k in 0..10_000 {
///     bins.add([(k % 100) as f64 / 100.0, (k / 100) as f64 / 50.0], 1e-4);
/// }
/// let map = bins.finish(16);
/// // a power of 1 on an area of 1 by 2
/// assert!((map.power() - 1.0).abs() < 1e-12);
/// let [width, height] = [map.hi[0] - map.lo[0], map.hi[1] - map.lo[1]];
/// assert!((width - 1.0).abs() <= map.side && (height - 2.0).abs() <= map.side);
/// ```
#[derive(Clone, Debug, Default)]
pub struct IrradianceBins {
    /// The first points and their powers, until the size of cells is chosen.
    first: Vec<([f64; 2], f64)>,
    /// The grid of the bright part, and the grid of all light.
    grids: Option<[Grid; 2]>,
    /// The power left out of the first grid.
    outside: f64,
    total: f64,
}

/// The fraction of the power that the first grid may leave out.
const FAINT: f64 = 0.02;

#[derive(Clone, Debug)]
struct Grid {
    /// The side of a cell.
    cell: f64,
    /// The number of the first cell along both axes; cell k begins at k times its side.
    begin: [i64; 2],
    /// The power of each cell, row by row.
    power: Vec<f64>,
}

/// Power per area on a grid of square cells.
#[derive(Clone, Debug, PartialEq)]
pub struct IrradianceMap {
    /// The lower left corner, in the coordinates of the detector.
    pub lo: [f64; 2],
    /// The upper right corner.
    pub hi: [f64; 2],
    /// The side of a cell.
    pub side: f64,
    /// The number of columns.
    pub columns: usize,
    /// Power per area of each cell, row by row from the bottom.
    pub values: Vec<f64>,
}

impl IrradianceBins {
    /// Adds the power of a ray that arrives at a point. Points that are not finite and powers that
    /// are not positive are ignored.
    pub fn add(&mut self, point: [f64; 2], power: f64) {
        if !(power > 0.0 && point.iter().all(|x| x.is_finite())) {
            return;
        }
        self.total += power;
        match &self.grids {
            Some(_) => self.bin(point, power),
            None => self.first.push((point, power)),
        }
        if self.grids.is_none() && self.first.len() == FIRST {
            self.choose_cells();
        }
    }

    fn bin(&mut self, point: [f64; 2], power: f64) {
        let Some([bright, all]) = &mut self.grids else { return };
        while !all.add(point, power) {
            all.merge();
        }
        while !bright.add(point, power) {
            if self.outside + power <= FAINT * self.total {
                self.outside += power;
                return;
            }
            bright.merge();
        }
    }

    /// Chooses the size of cells.
    fn choose_cells(&mut self) {
        let first = std::mem::take(&mut self.first);
        self.grids = Some([Grid::around(&bright_points(&first)), Grid::around(&first)]);
        first.into_iter().for_each(|(point, power)| self.bin(point, power));
    }

    /// The map of the lit part, with at most `most` cells along each side, at most 512. It leaves out
    /// distant ghosts of at most 2 % of the power if this makes cells at least four times finer.
    /// Without light the map is one dark cell.
    pub fn finish(mut self, most: usize) -> IrradianceMap {
        if self.grids.is_none() && !self.first.is_empty() {
            self.choose_cells();
        }
        let most = most.clamp(1, CELLS as usize) as i64;
        match &self.grids {
            Some([bright, all]) => {
                let holds = bright.power.iter().sum::<f64>() >= (1.0 - 2.0 * FAINT) * self.total;
                // at a similar cell size, nothing is gained by leaving light out
                let is_finer = all.cell >= 4.0 * bright.cell;
                if holds && is_finer { bright.map(most) } else { all.map(most) }
            }
            None => IrradianceMap { lo: [0.0; 2], hi: [1.0; 2], side: 1.0, columns: 1, values: vec![0.0] },
        }
    }
}

/// The points around the centroid that hold all but [`FAINT`] of the power.
fn bright_points(points: &[([f64; 2], f64)]) -> Vec<([f64; 2], f64)> {
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
        for (point, _) in points {
            for k in 0..2 {
                lo[k] = lo[k].min(point[k]);
                hi[k] = hi[k].max(point[k]);
            }
        }
        let far = lo.iter().chain(&hi).filter(|x| x.is_finite()).fold(0.0, |far: f64, x| far.max(x.abs()));
        let size = (hi[0] - lo[0]).max(hi[1] - lo[1]);
        // cell numbers must be small enough to be exact, and areas must not underflow
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

    /// Adds power to a cell. Returns false and does nothing for a point outside of the grid.
    fn add(&mut self, point: [f64; 2], power: f64) -> bool {
        let at = [0, 1].map(|k| ((point[k] / self.cell).floor() as i64).saturating_sub(self.begin[k]));
        let is_in = at.iter().all(|k| (0..CELLS).contains(k));
        if is_in {
            self.power[(at[1] * CELLS + at[0]) as usize] += power;
        }
        is_in
    }

    /// Merges the cells in blocks of 2 x 2; the old grid becomes the middle of the new one.
    fn merge(&mut self) {
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

    /// The first and last lit column and row.
    fn lit(&self) -> Option<([i64; 2], [i64; 2])> {
        let mut found: Option<([i64; 2], [i64; 2])> = None;
        for (number, _) in (0..).zip(&self.power).filter(|(_, power)| **power != 0.0) {
            let at: [i64; 2] = [number % CELLS, number / CELLS];
            let (lo, hi) = found.unwrap_or((at, at));
            found = Some(([0, 1].map(|k| lo[k].min(at[k])), [0, 1].map(|k| hi[k].max(at[k]))));
        }
        found
    }

    fn map(&self, most: i64) -> IrradianceMap {
        let (from, to) = self.lit().unwrap_or(([CELLS / 2; 2], [CELLS / 2; 2]));
        // the number of grid cells along the side of a map cell
        let merged = (to[0] - from[0] + 1).max(to[1] - from[1] + 1).div_euclid(most).max(0) + 1;
        let count = [0, 1].map(|k| ((to[k] - from[k]) / merged + 1) as usize);
        let mut values = vec![0.0; count[0] * count[1]];
        for y in from[1]..=to[1] {
            for x in from[0]..=to[0] {
                let at = [(x - from[0]) / merged, (y - from[1]) / merged].map(|k| k as usize);
                values[at[1] * count[0] + at[0]] += self.power[(y * CELLS + x) as usize];
            }
        }
        let side = self.cell * merged as f64;
        values.iter_mut().for_each(|power| *power /= side * side);
        let lo = [0, 1].map(|k| (self.begin[k] + from[k]) as f64 * self.cell);
        let hi = [0, 1].map(|k| lo[k] + count[k] as f64 * side);
        IrradianceMap { lo, hi, side, columns: count[0], values }
    }
}

impl IrradianceMap {
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
}

#[cfg(test)]
mod tests {
    use super::*;

    /// No power is lost, and the map covers all points, for points in any order.
    #[test]
    fn grids_grow() {
        let mut map = IrradianceBins::default();
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

    /// Ghosts a thousand times as wide as the spot, with 1 % of the power.
    #[test]
    fn ghosts_do_not_hide_the_spot() {
        let mut map = IrradianceBins::default();
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
        let dark = IrradianceBins::default().finish(8);
        assert_eq!((dark.power(), dark.columns, dark.rows()), (0.0, 1, 1));
        let mut map = IrradianceBins::default();
        (0..2000).for_each(|_| map.add([3.0, -4.0], 0.5));
        map.add([f64::NAN, 0.0], 1.0);
        let map = map.finish(8);
        assert!((map.power() - 1000.0).abs() < 1e-9);
        assert!(map.lo[0] <= 3.0 && 3.0 <= map.hi[0] && map.lo[1] <= -4.0 && -4.0 <= map.hi[1]);
        // a perfect focus on the axis
        let mut map = IrradianceBins::default();
        (0..2000).for_each(|_| map.add([0.0; 2], 0.5));
        let map = map.finish(8);
        assert!((map.power() - 1000.0).abs() < 1e-9 && map.peak().is_finite(), "{map:?}");
    }
}
