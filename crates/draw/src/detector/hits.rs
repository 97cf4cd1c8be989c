//! Maps of the hits of single photons, sensor by sensor, as SVG.

use super::chart::{BELOW, Chart, LEFT, MARGIN, TOP};
use super::irradiance::{STYLE, draw_cells, draw_colour_bar};
use crate::DrawError;
use crate::svg::{Anchor, Svg};
use rayweave_error::Message;
use std::str::FromStr;

/// Hits with their sensors.
#[derive(Clone, Copy, Debug)]
pub struct HitPositions<'a> {
    /// The names of the sensors.
    pub names: &'a [String],
    /// The sensor of each hit: an index into `names`.
    pub sensors: &'a [u32],
    /// The coordinates x, y, z of each hit.
    pub positions: [&'a [f64]; 3],
    /// The number of cells along the longer side of each map; by default the more, the more hits there are, at most 64.
    pub cells: Option<usize>,
    /// The plane of all maps; by default that of each sensor.
    pub plane: Option<MapPlane>,
}

/// The length of an axis where several maps are drawn, their columns, and the height of the title above.
const PANEL: f64 = 250.0;
const MAX_COLUMNS: usize = 3;
const HEADING: f64 = 52.0;

/// The maximum number of sensors with a separate map.
const MAX_SENSORS: usize = 16;

/// The maximum number of cells along a side of a map, and the mean number of hits in a cell of a square map with fewer cells.
const CELLS: usize = 64;
const HITS_PER_CELL: usize = 16;

/// The smallest ratio of the sides of a chart.
const STRIP: f64 = 0.05;

/// The coordinates of a hit map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MapPlane {
    /// The projection along x, with y to the right and z up.
    Yz,
    /// The projection along y, with x to the right and z up.
    Xz,
    /// The projection along z, with x to the right and y up.
    Xy,
    /// The directions of the hits from the origin: the azimuth to the right and the cosine of the polar angle from z up, which
    /// keeps solid angles.
    Sphere,
}

impl MapPlane {
    /// The numbers of the two coordinates of a projection.
    fn axes(self) -> Option<[usize; 2]> {
        match self {
            MapPlane::Yz => Some([1, 2]),
            MapPlane::Xz => Some([0, 2]),
            MapPlane::Xy => Some([0, 1]),
            MapPlane::Sphere => None,
        }
    }

    /// The labels of the axes.
    fn labels(self, unit: &str) -> [String; 2] {
        match self.axes() {
            Some(axes) => axes.map(|k| format!("{} / {unit}", ["x", "y", "z"][k])),
            None => ["phi / degree".to_owned(), "cos theta".to_owned()],
        }
    }

    /// The direction of the projection, in words.
    fn projection(self) -> &'static str {
        match self {
            MapPlane::Yz => "projected along x",
            MapPlane::Xz => "projected along y",
            MapPlane::Xy => "projected along z",
            MapPlane::Sphere => "seen from the origin",
        }
    }

    /// The projection along the coordinate with the smallest extent; of equal extents, along the last of these.
    fn along_least(extents: [f64; 3]) -> MapPlane {
        match [2, 1, 0].into_iter().min_by(|&a, &b| extents[a].total_cmp(&extents[b])) {
            Some(0) => MapPlane::Yz,
            Some(1) => MapPlane::Xz,
            _ => MapPlane::Xy,
        }
    }
}

/// Parses `yz`, `xz`, `xy` or `sphere`.
impl FromStr for MapPlane {
    type Err = DrawError;

    fn from_str(text: &str) -> Result<MapPlane, DrawError> {
        match text {
            "yz" => Ok(MapPlane::Yz),
            "xz" => Ok(MapPlane::Xz),
            "xy" => Ok(MapPlane::Xy),
            "sphere" => Ok(MapPlane::Sphere),
            _ => {
                let reason = "it must be yz, xz, xy or sphere";
                Err(DrawError::Option(Message::new(format!("`{text}` is not a plane of hit maps"), reason)))
            }
        }
    }
}

/// A map of hits.
struct Panel<'a> {
    name: &'a str,
    hits: usize,
    plane: MapPlane,
    map: HitMap,
    /// True for the hits of several sensors, which may overlap.
    is_of_all: bool,
}

/// Draws the number of hits per area of each sensor as colours. Without a plane, the map of each sensor is the projection along the
/// coordinate in which its hits extend least. For several sensors, the first map is a projection of all hits, in which sensors may
/// overlap: with a colour scale of its own, along the coordinate in which the sensors extend least on average. The sixteen sensors
/// with the most hits have separate maps with a common colour scale, in the order of `names`. The plane [`MapPlane::Sphere`] gives
/// one map of all hits. The cells of a projection divide the extent of its hits in both coordinates. `unit` is the unit of length.
///
/// ```
/// use rayweave_draw::detector::{HitPositions, hit_maps_svg};
///
/// let x: Vec<f64> = (0..100).map(|k| f64::from(k % 10)).collect();
/// let y: Vec<f64> = (0..100).map(|k| f64::from(k / 10)).collect();
/// let (names, positions) = (["cathode".to_owned()], [&x[..], &y, &[50.0; 100]]);
/// let hits = HitPositions { names: &names, sensors: &[0; 100], positions, cells: None, plane: None };
/// assert!(hit_maps_svg(hits, "detector.gdml", "mm").contains("cathode"));
/// ```
pub fn hit_maps_svg(hits: HitPositions<'_>, title: &str, unit: &str) -> String {
    let panels = panels(hits);
    let peak =
        |panels: &[Panel<'_>]| panels.iter().flat_map(|panel| &panel.map.values).copied().fold(0.0, f64::max);
    // the hits of all sensors may overlap in the plane, so the first of several maps has its own scale
    let (first, others) = panels.split_at(1.min(panels.len()));
    let peaks = [peak(first), peak(others)];
    let mut svg = Svg::default();
    let (title, subtitle) = (format!("Hits: {title}"), subtitle(hits, &panels));
    svg.text("title", [MARGIN, 30.0], Anchor::Start, &title, &title);
    svg.text("tick", [MARGIN, 48.0], Anchor::Start, &subtitle, &subtitle);
    let columns = panels.len().clamp(1, MAX_COLUMNS);
    let [width, height] = [LEFT + PANEL + 110.0, TOP + PANEL + BELOW];
    let is_sphere = hits.plane == Some(MapPlane::Sphere);
    let width = if is_sphere { width + PANEL } else { width };
    for (k, panel) in panels.iter().enumerate() {
        let corner = [width * (k % columns) as f64, HEADING + height * (k / columns) as f64];
        let chart = panel.chart(corner);
        let peak = peaks[usize::from(k > 0)];
        let cells = chart.part(panel.map.lo, panel.map.hi);
        draw_cells((panel.map.cells[0], &panel.map.values), peak, &cells, &mut svg);
        chart.draw_axes(
            &mut svg,
            [panel.name, &panel.subtitle(hits.sensors.len())],
            panel.plane.labels(unit),
        );
        let label = if is_sphere { "hits / sr".to_owned() } else { format!("hits / {unit}\u{b2}") };
        draw_colour_bar(peak, chart.frame(), &label, &mut svg);
    }
    let size = match panels.len() {
        0 => [400.0, 80.0],
        n => [width * columns as f64, HEADING + height * n.div_ceil(columns) as f64],
    };
    svg.finish(size, &title, &subtitle, STYLE)
}

fn subtitle(hits: HitPositions<'_>, panels: &[Panel<'_>]) -> String {
    let sensors = counts(hits).len();
    let maps = panels.iter().filter(|panel| !panel.is_of_all).count();
    match (hits.sensors.len(), sensors) {
        (0, _) => "no hits".to_owned(),
        (n, 1) => format!("{n} hits of one sensor"),
        (n, sensors) if (1..sensors).contains(&maps) => {
            format!("{n} hits of {sensors} sensors; the {maps} sensors with the most hits")
        }
        (n, sensors) => format!("{n} hits of {sensors} sensors"),
    }
}

/// The sensors with hits and their numbers of hits, the largest first.
fn counts(hits: HitPositions<'_>) -> Vec<(u32, usize)> {
    let mut counts = vec![0; hits.names.len()];
    hits.sensors.iter().for_each(|&sensor| counts[sensor as usize] += 1);
    let mut counts: Vec<(u32, usize)> = (0..).zip(counts).filter(|(_, count)| *count > 0).collect();
    counts.sort_by_key(|&(sensor, count)| (std::cmp::Reverse(count), sensor));
    counts
}

fn panels(hits: HitPositions<'_>) -> Vec<Panel<'_>> {
    let mut counts = counts(hits);
    let extents = extents(hits);
    let sum = |k: usize| extents.iter().map(|own| own[k]).sum::<f64>();
    let plane_of_all = hits.plane.unwrap_or_else(|| MapPlane::along_least([0, 1, 2].map(sum)));
    let is_sphere = plane_of_all == MapPlane::Sphere;
    let own = |&(sensor, _): &(u32, usize)| {
        let plane = hits.plane.unwrap_or_else(|| MapPlane::along_least(extents[sensor as usize]));
        Panel::new(hits, &hits.names[sensor as usize], Some(sensor), plane)
    };
    let has_all = counts.len() > 1 || is_sphere && !counts.is_empty();
    let all = has_all.then(|| Panel::new(hits, "all sensors", None, plane_of_all));
    counts.truncate(if is_sphere { 0 } else { MAX_SENSORS });
    counts.sort_by_key(|&(sensor, _)| sensor);
    all.into_iter().chain(counts.iter().map(own)).collect()
}

/// The extents of the hits of each sensor along x, y and z; 0 without hits.
fn extents(hits: HitPositions<'_>) -> Vec<[f64; 3]> {
    let mut ranges = vec![[(f64::INFINITY, f64::NEG_INFINITY); 3]; hits.names.len()];
    for (row, &sensor) in hits.sensors.iter().enumerate() {
        for (range, column) in ranges[sensor as usize].iter_mut().zip(hits.positions) {
            *range = (range.0.min(column[row]), range.1.max(column[row]));
        }
    }
    ranges.into_iter().map(|own| own.map(|(lo, hi)| (hi - lo).max(0.0))).collect()
}

impl<'a> Panel<'a> {
    /// The map of one sensor, or of all of them.
    fn new(hits: HitPositions<'_>, name: &'a str, sensor: Option<u32>, plane: MapPlane) -> Panel<'a> {
        let own = (0..hits.sensors.len()).filter(|&row| sensor.is_none_or(|own| hits.sensors[row] == own));
        let rows: Vec<usize> = own.collect();
        let cells = hits.cells.unwrap_or((rows.len() / HITS_PER_CELL).isqrt().clamp(4, CELLS)).max(1);
        let map = match plane.axes() {
            Some(axes) => {
                let points: Vec<[f64; 2]> =
                    rows.iter().map(|&row| axes.map(|k| hits.positions[k][row])).collect();
                HitMap::new(&points, cells)
            }
            None => {
                let direction = |&row: &usize| direction(hits.positions.map(|column| column[row]));
                let points: Vec<[f64; 2]> = rows.iter().map(direction).collect();
                HitMap::of_directions(&points, cells)
            }
        };
        Panel { name, hits: rows.len(), plane, map, is_of_all: sensor.is_none() }
    }

    /// The chart: with one scale for both axes of a projection, and at least a strip where the hits have hardly any extent.
    fn chart(&self, corner: [f64; 2]) -> Chart {
        let HitMap { mut lo, mut hi, .. } = self.map;
        if self.plane == MapPlane::Sphere {
            return Chart::with_axes(corner, [2.0 * PANEL, PANEL], lo, hi);
        }
        let least = STRIP * (hi[0] - lo[0]).max(hi[1] - lo[1]);
        for k in 0..2 {
            let missing = (least - (hi[k] - lo[k])).max(0.0);
            (lo[k], hi[k]) = (lo[k] - 0.5 * missing, hi[k] + 0.5 * missing);
        }
        Chart::at(corner, PANEL, lo, hi)
    }

    fn subtitle(&self, count: usize) -> String {
        let part = 100.0 * self.hits as f64 / count.max(1) as f64;
        let text = format!("{} hits, {part:.1} %", self.hits);
        if self.is_of_all { format!("{text}, {}", self.plane.projection()) } else { text }
    }
}

/// The azimuth in degrees and the cosine of the polar angle of a point, seen from the origin. The origin itself counts as lying on x.
fn direction([x, y, z]: [f64; 3]) -> [f64; 2] {
    let distance = (x * x + y * y + z * z).sqrt();
    let cosine = if distance > 0.0 { (z / distance).clamp(-1.0, 1.0) } else { 0.0 };
    [libm::atan2(y, x).to_degrees(), cosine]
}

/// Hits per area in equal cells.
struct HitMap {
    lo: [f64; 2],
    hi: [f64; 2],
    /// The numbers of columns and of rows.
    cells: [usize; 2],
    /// Hits per area, row by row from the bottom; per steradian for directions.
    values: Vec<f64>,
}

impl HitMap {
    /// A map whose cells divide the extent of the hits, with a number of cells along the longer side.
    fn new(points: &[[f64; 2]], most: usize) -> HitMap {
        let (mut lo, mut hi) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for point in points {
            lo = [0, 1].map(|k| lo[k].min(point[k]));
            hi = [0, 1].map(|k| hi[k].max(point[k]));
        }
        let far = lo.iter().chain(&hi).fold(0.0, |far: f64, x| far.max(x.abs()));
        let longer = (hi[0] - lo[0]).max(hi[1] - lo[1]);
        // a single point has no extent: a square that is small, but wider than rounding errors
        let longer = if longer > 0.0 { longer } else { (1e-6 * far).max(1e-6) };
        let side = longer / most as f64;
        for k in 0..2 {
            // hits on a line, up to the rounding errors of coordinates, get a row of square cells
            if hi[k] - lo[k] <= 1e-9 * far.max(longer) {
                let missing = (side - (hi[k] - lo[k])).max(0.0);
                (lo[k], hi[k]) = (lo[k] - 0.5 * missing, hi[k] + 0.5 * missing);
            }
        }
        let cells = [0, 1].map(|k| ((hi[k] - lo[k]) / side).round().max(1.0) as usize);
        let area = [0, 1].map(|k| (hi[k] - lo[k]) / cells[k] as f64).into_iter().product();
        HitMap::of_cells(points, [lo, hi], cells, area)
    }

    /// A map of directions: azimuths in degrees and cosines of polar angles, in cells of equal solid angle, twice as many along the
    /// azimuth.
    fn of_directions(points: &[[f64; 2]], rows: usize) -> HitMap {
        let cells = [2 * rows, rows];
        let solid_angle = 4.0 * std::f64::consts::PI / (cells[0] * cells[1]) as f64;
        HitMap::of_cells(points, [[-180.0, -1.0], [180.0, 1.0]], cells, solid_angle)
    }

    fn of_cells(points: &[[f64; 2]], [lo, hi]: [[f64; 2]; 2], cells: [usize; 2], area: f64) -> HitMap {
        let size = [0, 1].map(|k| (hi[k] - lo[k]) / cells[k] as f64);
        let mut values = vec![0.0; cells[0] * cells[1]];
        for point in points {
            // the last cell includes its upper edge
            let [x, y] = [0, 1].map(|k| (((point[k] - lo[k]) / size[k]) as usize).min(cells[k] - 1));
            values[y * cells[0] + x] += 1.0 / area;
        }
        HitMap { lo, hi, cells, values }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Hits on a square lattice with its edges: every cell has the density of the lattice within the error of the two edges.
    #[test]
    fn the_cells_divide_the_extent_of_the_hits() {
        let points: Vec<[f64; 2]> =
            (0..10_000).map(|k| [f64::from(k % 100), 0.5 * f64::from(k / 100)]).collect();
        let map = HitMap::new(&points, 11);
        assert_eq!((map.lo, map.hi, map.cells), ([0.0; 2], [99.0, 49.5], [11, 6]));
        let hits: f64 = map.values.iter().sum::<f64>() * (99.0 / 11.0) * (49.5 / 6.0);
        assert!((hits - 10_000.0).abs() < 1e-6, "{hits}");
        // 9 or 10 columns and 16 to 17 rows of points in cells of 9 by 8.25
        assert!(map.values.iter().all(|value| (1.9..2.4).contains(value)), "{:?}", map.values);
    }

    #[test]
    fn hits_on_a_line_and_at_a_point_have_cells() {
        let line: Vec<[f64; 2]> = (0..=40).map(|k| [3.0, f64::from(k)]).collect();
        let map = HitMap::new(&line, 8);
        assert_eq!((map.cells, map.lo, map.hi), ([1, 8], [0.5, 0.0], [5.5, 40.0]));
        let point = HitMap::new(&[[5.0, 0.0]; 3], 4);
        assert_eq!(point.cells, [1, 1]);
        assert!((point.values[0] * (point.hi[0] - point.lo[0]).powi(2) - 3.0).abs() < 1e-6);
    }

    /// A sensor of 10 mm by 100 mm is divided into cells of its own sides, not into one row that is wider than the sensor.
    #[test]
    fn the_cells_of_thin_sensors_fit_them() {
        let points: Vec<[f64; 2]> =
            (0..1010).map(|k| [f64::from(k % 10) * 10.0 / 9.0, f64::from(k / 10)]).collect();
        let map = HitMap::new(&points, 4);
        assert_eq!((map.lo, map.hi, map.cells), ([0.0; 2], [10.0, 100.0], [1, 4]));
        let area = 10.0 * 100.0 / 4.0;
        // 25 or, in the last cell with both edges, 26 rows of ten
        assert_eq!(
            map.values.iter().map(|value| (value * area).round()).collect::<Vec<_>>(),
            [250.0, 250.0, 250.0, 260.0]
        );
    }

    /// Directions along the axes, and the density of evenly distributed directions: their number over 4 pi.
    #[test]
    fn directions_are_seen_from_the_origin() {
        assert_eq!(direction([0.0, 3.0, 0.0]), [90.0, 0.0]);
        assert_eq!(direction([-2.0, 0.0, 0.0]), [180.0, 0.0]);
        assert_eq!(direction([0.0, 0.0, -5.0]), [0.0, -1.0]);
        assert_eq!(direction([0.0; 3]), [0.0, 0.0]);
        // 40 azimuths at each of 20 heights, in the middle of as many strips of a sphere
        let even: Vec<[f64; 2]> =
            (0..800).map(|k| [9.0 * f64::from(k % 40) - 175.5, 0.1 * f64::from(k / 40) - 0.95]).collect();
        let map = HitMap::of_directions(&even, 10);
        assert_eq!(map.cells, [20, 10]);
        let expected = 800.0 / (4.0 * std::f64::consts::PI);
        assert!(map.values.iter().all(|value| (value / expected - 1.0).abs() < 1e-12), "{:?}", map.values);
    }
}
