//! Maps of the hits of single photons, sensor by sensor, as SVG.

use super::chart::{BELOW, Chart, LEFT, MARGIN, TOP};
use super::irradiance::{STYLE, draw_cells, draw_colour_bar};
use crate::svg::{Anchor, Svg};

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

/// A map of hits in the plane of two coordinates.
struct Panel<'a> {
    name: &'a str,
    hits: usize,
    axes: [&'static str; 2],
    map: HitMap,
}

/// Draws the number of hits per area of each sensor as colours, in the plane of the two coordinates along which the hits on single
/// sensors are spread most. For several sensors, the first map has all hits; the sixteen sensors with the most hits have separate
/// maps with a common colour scale, in the order of `names`. The cells of a map divide the extent of its hits. `unit` is the unit of
/// length.
///
/// ```
/// use rayweave_draw::detector::{HitPositions, hit_maps_svg};
///
/// let x: Vec<f64> = (0..100).map(|k| f64::from(k % 10)).collect();
/// let y: Vec<f64> = (0..100).map(|k| f64::from(k / 10)).collect();
/// let names = ["cathode".to_owned()];
/// let hits = HitPositions { names: &names, sensors: &[0; 100], positions: [&x, &y, &[50.0; 100]], cells: None };
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
    let count = hits.sensors.len();
    let (title, subtitle) = (format!("Hits: {title}"), subtitle(hits, others.len()));
    svg.text("title", [MARGIN, 30.0], Anchor::Start, &title, &title);
    svg.text("tick", [MARGIN, 48.0], Anchor::Start, &subtitle, &subtitle);
    let columns = panels.len().clamp(1, MAX_COLUMNS);
    let [width, height] = [LEFT + PANEL + 110.0, TOP + PANEL + BELOW];
    for (k, panel) in panels.iter().enumerate() {
        let corner = [width * (k % columns) as f64, HEADING + height * (k / columns) as f64];
        let chart = Chart::at(corner, PANEL, panel.map.lo, panel.map.hi);
        let peak = peaks[usize::from(k > 0)];
        draw_cells((panel.map.cells[0], &panel.map.values), peak, &chart, &mut svg);
        let part = format!("{} hits, {:.1} %", panel.hits, 100.0 * panel.hits as f64 / count.max(1) as f64);
        chart.draw_axes(&mut svg, [panel.name, &part], panel.axes, unit);
        draw_colour_bar(peak, chart.frame(), &format!("hits / {unit}\u{b2}"), &mut svg);
    }
    let size = match panels.len() {
        0 => [400.0, 80.0],
        n => [width * columns as f64, HEADING + height * n.div_ceil(columns) as f64],
    };
    svg.finish(size, &title, &subtitle, STYLE)
}

fn subtitle(hits: HitPositions<'_>, maps: usize) -> String {
    let sensors = counts(hits).len();
    match (hits.sensors.len(), sensors) {
        (0, _) => "no hits".to_owned(),
        (n, 1) => format!("{n} hits of one sensor"),
        (n, sensors) if maps < sensors => {
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
    let plane = Plane::new(hits);
    let own =
        |&(sensor, _): &(u32, usize)| Panel::new(hits, &hits.names[sensor as usize], Some(sensor), plane);
    let all = (counts.len() > 1).then(|| Panel::new(hits, "all sensors", None, plane));
    counts.truncate(MAX_SENSORS);
    counts.sort_by_key(|&(sensor, _)| sensor);
    all.into_iter().chain(counts.iter().map(own)).collect()
}

/// The plane of two coordinates: their numbers and names.
#[derive(Clone, Copy, Debug)]
struct Plane {
    axes: [usize; 2],
    names: [&'static str; 2],
}

impl Plane {
    /// The plane without the coordinate along which the hits on single sensors are spread least.
    fn new(hits: HitPositions<'_>) -> Plane {
        let extent = |k: usize| {
            let mut ranges = vec![(f64::INFINITY, f64::NEG_INFINITY); hits.names.len()];
            for (&sensor, &x) in hits.sensors.iter().zip(hits.positions[k]) {
                let (lo, hi) = &mut ranges[sensor as usize];
                (*lo, *hi) = (lo.min(x), hi.max(x));
            }
            ranges.into_iter().filter(|(lo, hi)| lo <= hi).map(|(lo, hi)| hi - lo).sum::<f64>()
        };
        // of equal extents, the last one
        match [2, 1, 0].into_iter().min_by(|&a, &b| extent(a).total_cmp(&extent(b))) {
            Some(0) => Plane { axes: [1, 2], names: ["y", "z"] },
            Some(1) => Plane { axes: [0, 2], names: ["x", "z"] },
            _ => Plane { axes: [0, 1], names: ["x", "y"] },
        }
    }
}

impl<'a> Panel<'a> {
    /// The map of one sensor, or of all of them.
    fn new(hits: HitPositions<'_>, name: &'a str, sensor: Option<u32>, plane: Plane) -> Panel<'a> {
        let own = (0..hits.sensors.len()).filter(|&row| sensor.is_none_or(|own| hits.sensors[row] == own));
        let rows: Vec<usize> = own.collect();
        let points: Vec<[f64; 2]> =
            rows.iter().map(|&row| plane.axes.map(|k| hits.positions[k][row])).collect();
        let cells = hits.cells.unwrap_or((rows.len() / HITS_PER_CELL).isqrt().clamp(4, CELLS));
        Panel { name, hits: rows.len(), axes: plane.names, map: HitMap::new(&points, cells.max(1)) }
    }
}

/// Hits per area in the cells that divide the extent of the hits.
struct HitMap {
    lo: [f64; 2],
    hi: [f64; 2],
    /// The numbers of columns and of rows.
    cells: [usize; 2],
    /// Hits per area, row by row from the bottom.
    values: Vec<f64>,
}

impl HitMap {
    /// A map with a number of cells along the longer side.
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
        let least = longer / most as f64;
        for k in 0..2 {
            // hits on a line get a row of square cells
            let missing = (least - (hi[k] - lo[k])).max(0.0);
            (lo[k], hi[k]) = (lo[k] - 0.5 * missing, hi[k] + 0.5 * missing);
        }
        let cells = [0, 1].map(|k| ((hi[k] - lo[k]) / least).round().max(1.0) as usize);
        let size = [0, 1].map(|k| (hi[k] - lo[k]) / cells[k] as f64);
        let mut values = vec![0.0; cells[0] * cells[1]];
        for point in points {
            // the last cell includes its upper edge
            let [x, y] = [0, 1].map(|k| (((point[k] - lo[k]) / size[k]) as usize).min(cells[k] - 1));
            values[y * cells[0] + x] += 1.0 / (size[0] * size[1]);
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
}
