//! Maps of the hits of single photons, sensor by sensor, as SVG.

use super::chart::{BELOW, Chart, LEFT, MARGIN, TOP};
use super::irradiance::{STYLE, draw_cells, draw_colour_bar, value_paint};
use super::scale::{ColourScale, MapScale};
use crate::DrawError;
use crate::svg::{Anchor, Svg};
use rayweave_error::Message;
use rayweave_math::{Bounds, Vec3};
use std::str::FromStr;
use std::sync::Arc;

/// The lower and the upper corner of a rectangle.
type Rectangle = [[f64; 2]; 2];

/// Hits with their sensors.
#[derive(Clone, Copy, Debug)]
pub struct HitPositions<'a> {
    /// The names of the sensors.
    pub names: &'a [Arc<str>],
    /// The sensor of each hit: an index into `names`.
    pub sensors: &'a [u32],
    /// The coordinates x, y, z of each hit.
    pub positions: [&'a [f64]; 3],
    /// The boxes of the solids of the sensors, in the order of `names`; those of a sensor without one, and of the last ones if there
    /// are fewer, are estimated from its hits.
    pub extents: &'a [Option<Bounds>],
    /// The number of cells along the longer side of each map; by default for about 10 hits in a cell, from 4 to 64.
    pub cells: Option<usize>,
    /// The plane of all maps; by default that of each sensor.
    pub plane: Option<MapPlane>,
    /// The scale of the colours.
    pub scale: MapScale,
    /// The sensors to draw, each of them with a map: indices into `names`. By default the hits of all sensors, with maps of the
    /// sixteen with the most hits.
    pub chosen: Option<&'a [u32]>,
}

/// The length of an axis where several maps are drawn, their columns, and the height of the title above.
const PANEL: f64 = 250.0;
const MAX_COLUMNS: usize = 3;
const HEADING: f64 = 52.0;

/// The maximum number of sensors with a separate map.
const MAX_SENSORS: usize = 16;

/// The range of the number of cells along the longer side of a map, and the mean number of hits in a cell between its ends, whose
/// statistical error is 32 %: neighbouring cells show a structure together, and large cells hide one that is smaller than they are.
const MIN_CELLS: usize = 4;
const MAX_CELLS: usize = 64;
const HITS_PER_CELL: f64 = 10.0;

/// The maximum number of columns of maps that are arranged as the sensors lie.
const MAX_GRID: usize = 4;

/// A sensor is small, seen from the origin, if half its diagonal is less than this part of its distance: it has a marker.
const SMALL: f64 = 0.15;

/// The range of the radius of a marker in pixels, and the part of the map that all of them may cover.
const MARKER: [f64; 2] = [2.0, 9.0];
const COVERED: f64 = 0.3;

/// The number of cells across a sensor in the map of all sensors, where these overlap.
const CELLS_PER_SENSOR: f64 = 2.0;

/// The maximum number of sensors with an outline in the map of all sensors.
const MAX_OUTLINES: usize = 256;

/// A box is flat if its smallest extent is less than this part of the next one. Light is detected on its faces: the map shows these.
const FLAT: f64 = 0.5;

/// The extents of boxes are equal up to this part.
const EQUAL: f64 = 1e-6;

/// The smallest extent of hits on a sensor of unknown size: parts of the extent of all hits, and of their distance from the origin if
/// all are in one place.
const LEAST_OF_ALL: f64 = 0.02;
const LEAST_OF_DISTANCE: f64 = 0.1;

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
    /// The corners of the window.
    window: Rectangle,
    /// One map of the window, or the maps of the sensors in it.
    maps: Vec<HitMap>,
    /// The places of small sensors on the sphere, with their numbers of hits.
    markers: Vec<([f64; 2], f64)>,
    /// The outlines of the sensors, for the hits of several sensors, which may overlap.
    outlines: Option<Vec<Rectangle>>,
}

/// Draws the number of hits per area of each sensor as colours. Without a plane, the map of each sensor is the projection along the
/// coordinate in which a flat sensor, or the hits of a different one, extend least. For several sensors, the first map is a projection of all hits, in which sensors may
/// overlap: with a colour scale of its own, along the coordinate in which the sensors extend least on average. The sixteen sensors
/// with the most hits have separate maps with a common colour scale, in the order of `names`, or as they lie if they are equal and
/// form a grid of up to four columns. With chosen sensors, their hits alone are drawn, and each of them has a map. The plane [`MapPlane::Sphere`] gives one map of all hits, with a marker for each sensor if all are small as seen
/// from the origin and no number of cells is given. The cells of a projection divide the extent of the sensor in both coordinates;
/// sensors of equal size have equal cells, also in the map of all sensors unless they overlap there. `unit` is the unit of length.
///
/// ```
/// use rayweave_draw::detector::{HitPositions, MapScale, hit_maps_svg};
///
/// let x: Vec<f64> = (0..100).map(|k| f64::from(k % 10)).collect();
/// let y: Vec<f64> = (0..100).map(|k| f64::from(k / 10)).collect();
/// let (names, positions) = (["cathode".into()], [&x[..], &y, &[50.0; 100]]);
/// let (sensors, extents, scale) = (&[0; 100], &[], MapScale::Linear);
/// let hits = HitPositions {
///     names: &names, sensors, positions, extents, cells: None, plane: None, scale, chosen: None,
/// };
/// assert!(hit_maps_svg(hits, "detector.gdml", "mm").contains("cathode"));
/// ```
pub fn hit_maps_svg(hits: HitPositions<'_>, title: &str, unit: &str) -> String {
    let Some(chosen) = hits.chosen else { return draw(hits, title, unit) };
    let mut is_chosen = vec![false; hits.names.len()];
    chosen.iter().for_each(|&sensor| is_chosen[sensor as usize] = true);
    let rows: Vec<usize> =
        (0..hits.sensors.len()).filter(|&row| is_chosen[hits.sensors[row] as usize]).collect();
    let sensors: Vec<u32> = rows.iter().map(|&row| hits.sensors[row]).collect();
    let positions = hits.positions.map(|column| rows.iter().map(|&row| column[row]).collect::<Vec<f64>>());
    let [x, y, z] = &positions;
    let extents = hits.extents.iter().zip(&is_chosen);
    let extents: Vec<Option<Bounds>> = extents.map(|(own, is_chosen)| own.filter(|_| *is_chosen)).collect();
    draw(HitPositions { sensors: &sensors, positions: [x, y, z], extents: &extents, ..hits }, title, unit)
}

fn draw(hits: HitPositions<'_>, title: &str, unit: &str) -> String {
    let panels = panels(hits);
    // the hits of all sensors may overlap in the plane, so the first of several maps has its own scale
    let (first, others) = panels.split_at(1.min(panels.len()));
    let scales =
        [first, others].map(|own| ColourScale::of(hits.scale, own.iter().flat_map(|panel| panel.values())));
    let mut svg = Svg::default();
    let (title, subtitle) = (format!("Hits: {title}"), subtitle(hits, &panels));
    svg.text("title", [MARGIN, 30.0], Anchor::Start, &title, &title);
    svg.text("tick", [MARGIN, 48.0], Anchor::Start, &subtitle, &subtitle);
    let [width, height] = [LEFT + PANEL + 110.0, TOP + PANEL + BELOW];
    let is_sphere = hits.plane == Some(MapPlane::Sphere);
    let width = if is_sphere { width + PANEL } else { width };
    let places = places(&panels);
    for (k, (panel, place)) in panels.iter().zip(&places).enumerate() {
        let corner = [width * place[0] as f64, HEADING + height * place[1] as f64];
        let chart = panel.chart(corner);
        let scale = &scales[usize::from(k > 0)];
        for map in &panel.maps {
            draw_cells((map.cells[0], &map.values), scale, &chart.part(map.lo, map.hi), &mut svg);
        }
        for &[lo, hi] in panel.outlines.iter().flatten() {
            let [[left, bottom], [right, top]] = [lo, hi].map(|point| chart.position(point));
            svg.rectangle("outline", [left, top, right - left, bottom - top], "");
        }
        let radius = (COVERED * 2.0 * PANEL * PANEL / panel.markers.len().max(1) as f64).sqrt() / 2.0;
        for &(point, value) in &panel.markers {
            let fill = format!(r#" fill="{}""#, value_paint(value, scale));
            svg.circle("marker", chart.position(point), radius.clamp(MARKER[0], MARKER[1]), &fill);
        }
        chart.draw_axes(
            &mut svg,
            [panel.name, &panel.subtitle(hits.sensors.len())],
            panel.plane.labels(unit),
        );
        let label = match is_sphere {
            true if !panel.markers.is_empty() => "hits of a sensor".to_owned(),
            true => "hits / sr".to_owned(),
            false => format!("hits / {unit}\u{b2}"),
        };
        draw_colour_bar(scale, chart.frame(), &label, &mut svg);
    }
    let end = |k: usize| places.iter().map(|place| place[k] + 1).max();
    let size = match (end(0), end(1)) {
        (Some(columns), Some(rows)) => [width * columns as f64, HEADING + height * rows as f64],
        _ => [400.0, 80.0],
    };
    svg.finish(size, &title, &subtitle, &format!("{STYLE}{OUTLINE_STYLE}"))
}

/// The columns and rows of the maps: those of sensors that form a grid as they lie, below the map of all.
fn places(panels: &[Panel<'_>]) -> Vec<[usize; 2]> {
    let all = usize::from(panels.first().is_some_and(|panel| panel.outlines.is_some()));
    let own = &panels[all..];
    let grid = own.first().and_then(|first| {
        let is_equal = |panel: &Panel<'_>| {
            panel.plane == first.plane && are_equal(size(panel.window), size(first.window))
        };
        let near = size(first.window).map(|side| 0.1 * side);
        // the steps of a coordinate of the corners
        let steps = |k: usize| {
            let mut steps: Vec<f64> = own.iter().map(|panel| panel.window[0][k]).collect();
            steps.sort_by(f64::total_cmp);
            steps.dedup_by(|next, step| *next - *step < near[k]);
            steps
        };
        let [columns, rows] = [steps(0), steps(1)];
        let place = |panel: &Panel<'_>| {
            let step = |steps: &[f64], k: usize| {
                steps.partition_point(|step| *step <= panel.window[0][k] + near[k] / 2.0).saturating_sub(1)
            };
            [step(&columns, 0), all + rows.len() - 1 - step(&rows, 1)]
        };
        let places: Vec<[usize; 2]> = own.iter().map(place).collect();
        let are_distinct = (1..places.len()).all(|k| !places[..k].contains(&places[k]));
        let fits = columns.len() <= MAX_GRID && columns.len() * rows.len() <= 2 * own.len();
        (all > 0 && own.iter().all(is_equal) && fits && are_distinct).then_some(places)
    });
    match grid {
        Some(grid) => std::iter::once([0, 0]).chain(grid).collect(),
        None => (0..panels.len()).map(|k| [k % MAX_COLUMNS, k / MAX_COLUMNS]).collect(),
    }
}

const OUTLINE_STYLE: &str = ".outline { fill: none; stroke: #ffffff; stroke-width: 0.7; stroke-opacity: 0.6 }
.marker { stroke: #7f7f7f; stroke-width: 0.7 }
";

/// A number of hits in words.
fn hits_of(count: usize) -> String {
    if count == 1 { "1 hit".to_owned() } else { format!("{count} hits") }
}

fn subtitle(hits: HitPositions<'_>, panels: &[Panel<'_>]) -> String {
    let (sensors, all) = (counts(hits).len(), hits.names.len());
    let maps = panels.iter().filter(|panel| panel.outlines.is_none()).count();
    let of_sensors = match (sensors, all) {
        (1, 1) => "one sensor".to_owned(),
        (n, all) if n == all => format!("{n} sensors"),
        (n, all) => format!("{n} of {all} sensors"),
    };
    match hits.sensors.len() {
        0 => "no hits".to_owned(),
        n if (1..sensors).contains(&maps) => {
            format!("{} of {of_sensors}; the {maps} sensors with the most hits", hits_of(n))
        }
        n => format!("{} of {of_sensors}", hits_of(n)),
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
    let frames = Frames::new(hits);
    let sum = |k: usize| counts.iter().map(|&(sensor, _)| frames.shape(sensor)[k]).sum::<f64>();
    let plane_of_all = hits.plane.unwrap_or_else(|| MapPlane::along_least([0, 1, 2].map(sum)));
    let is_sphere = plane_of_all == MapPlane::Sphere;
    let has_all = counts.len() > 1 || is_sphere && !counts.is_empty();
    let all = has_all.then(|| Panel::of_all(hits, &frames, plane_of_all));
    counts.truncate(match hits.chosen {
        _ if is_sphere => 0,
        Some(chosen) => chosen.len(),
        None => MAX_SENSORS,
    });
    counts.sort_by_key(|&(sensor, _)| sensor);
    let plane = |sensor| hits.plane.unwrap_or_else(|| MapPlane::along_least(frames.shape(sensor)));
    let windows = counts.iter().filter_map(|&(sensor, count)| {
        let plane = plane(sensor);
        Some((sensor, count, plane, frames.window(sensor, plane)?))
    });
    let windows: Vec<(u32, usize, MapPlane, Rectangle)> = windows.collect();
    let cells = cells_of_sensors(hits, windows.iter().map(|&(_, count, _, window)| (count, window)));
    let own = windows.iter().zip(cells);
    let own =
        own.map(|(&(sensor, _, plane, window), cells)| Panel::new(hits, sensor, plane, (window, cells)));
    all.into_iter().chain(own).collect()
}

/// The number of cells along the longer side of each sensor, by its hits and its window: sensors of equal size have equal cells, for
/// the one with the most hits.
fn cells_of_sensors(hits: HitPositions<'_>, sensors: impl Iterator<Item = (usize, Rectangle)>) -> Vec<usize> {
    let sensors: Vec<(usize, [f64; 2])> = sensors.map(|(count, window)| (count, size(window))).collect();
    let own = |&(_, own): &(usize, [f64; 2])| {
        let equal = sensors.iter().filter(|(_, other)| are_equal(own, *other));
        let most = equal.map(|(count, _)| *count).max().unwrap_or(0);
        hits.cells.unwrap_or_else(|| cells_for(most, own, 1.0)).max(1)
    };
    sensors.iter().map(own).collect()
}

/// True if two of some windows have a common area.
fn any_overlap(windows: &[Rectangle]) -> bool {
    let overlap = |[lo, hi]: &Rectangle, [other_lo, other_hi]: &Rectangle| {
        let common = [0, 1].map(|k| hi[k].min(other_hi[k]) - lo[k].max(other_lo[k]));
        (0..2).all(|k| common[k] > EQUAL * (hi[k] - lo[k]).max(other_hi[k] - other_lo[k]))
    };
    windows.iter().enumerate().any(|(k, own)| windows[..k].iter().any(|other| overlap(own, other)))
}

/// The different windows of some sensors, with the numbers of the sensors of each: those on opposite sides of a detector have one
/// footprint.
fn footprints(numbers: &[usize], windows: &[Rectangle]) -> (Vec<Vec<usize>>, Vec<Rectangle>) {
    let (mut groups, mut footprints) = (Vec::<Vec<usize>>::new(), Vec::<Rectangle>::new());
    for (&number, &window) in numbers.iter().zip(windows) {
        let longer = size(window)[0].max(size(window)[1]);
        let coincides = |other: &Rectangle| {
            let near = |a: [f64; 2], b: [f64; 2]| (0..2).all(|k| (a[k] - b[k]).abs() <= EQUAL * longer);
            near(window[0], other[0]) && near(window[1], other[1])
        };
        match footprints.iter().position(coincides) {
            Some(group) => groups[group].push(number),
            None => {
                groups.push(vec![number]);
                footprints.push(window);
            }
        }
    }
    (groups, footprints)
}

fn size([lo, hi]: Rectangle) -> [f64; 2] {
    [hi[0] - lo[0], hi[1] - lo[1]]
}

fn are_equal(one: [f64; 2], other: [f64; 2]) -> bool {
    let longer = one[0].max(one[1]);
    (0..2).all(|k| (one[k] - other[k]).abs() <= EQUAL * longer)
}

/// The number of cells along the longer side of a window with some hits on a covered part of its area.
fn cells_for(hits: usize, size: [f64; 2], covered: f64) -> usize {
    let wanted = hits as f64 / (HITS_PER_CELL * covered.max(f64::MIN_POSITIVE));
    let (longer, shorter) = (size[0].max(size[1]), size[0].min(size[1]));
    // a strip has one row of cells
    let along = (wanted * longer / shorter.max(f64::MIN_POSITIVE)).sqrt().min(wanted);
    // no more cells than hits
    (along as usize).clamp(hits.isqrt().clamp(1, MIN_CELLS), MAX_CELLS)
}

/// The boxes of the sensors and of their hits.
struct Frames {
    /// The ranges of the hits of each sensor; empty without hits.
    hits: Vec<Bounds>,
    /// The boxes of the solids, with those hits that lie outside; `None` if not known.
    solids: Vec<Option<Bounds>>,
    /// The numbers of hits.
    counts: Vec<usize>,
}

impl Frames {
    fn new(hits: HitPositions<'_>) -> Frames {
        let (mut ranges, mut counts) = (vec![Bounds::EMPTY; hits.names.len()], vec![0; hits.names.len()]);
        for (row, &sensor) in hits.sensors.iter().enumerate() {
            let point = Vec3::from_array(hits.positions.map(|column| column[row]));
            let range = &mut ranges[sensor as usize];
            *range = range.union(&Bounds::new(point, point));
            counts[sensor as usize] += 1;
        }
        let solid = |(sensor, range): (usize, &Bounds)| {
            let solid = hits.extents.get(sensor).copied().flatten()?;
            if !solid.is_finite() || solid.is_empty() {
                return None;
            }
            let near = solid.grown(EQUAL * solid.size().length());
            let holds = range.is_empty() || near.contains(range.lo) && near.contains(range.hi);
            Some(if holds { solid } else { solid.union(range) })
        };
        let solids = ranges.iter().enumerate().map(solid).collect();
        Frames { hits: ranges, solids, counts }
    }

    /// The extents that the plane of a sensor depends on: those of a flat solid, else those of its hits if these have an extent.
    fn shape(&self, sensor: u32) -> [f64; 3] {
        let sensor = sensor as usize;
        let own = self.hits[sensor].size().to_array();
        let Some(solid) = self.solids[sensor].map(|solid| solid.size().to_array()) else { return own };
        let mut sorted = solid;
        sorted.sort_by(f64::total_cmp);
        let is_flat = sorted[0] < FLAT * sorted[1];
        let has_extent = own.iter().filter(|extent| **extent > EQUAL * sorted[2]).count() >= 2;
        if is_flat || !has_extent { solid } else { own }
    }

    /// The lower and the upper corner of a sensor in a projection: of its solid, or else of its hits.
    fn window(&self, sensor: u32, plane: MapPlane) -> Option<Rectangle> {
        let axes = plane.axes()?;
        let corners = |bounds: &Bounds| [bounds.lo, bounds.hi].map(|corner| axes.map(|k| corner[k]));
        if let Some(solid) = &self.solids[sensor as usize] {
            return Some(corners(solid));
        }
        Some(estimated(corners(&self.hits[sensor as usize]), self.counts[sensor as usize], self.least(axes)))
    }

    /// The places on the sphere of sensors that are all small as seen from the origin, with their numbers of hits.
    fn markers(&self) -> Option<Vec<([f64; 2], f64)>> {
        let mut markers = Vec::new();
        for (solid, &count) in self.solids.iter().zip(&self.counts) {
            let Some(solid) = solid else {
                // a sensor without a solid of its own has no place
                if count > 0 {
                    return None;
                }
                continue;
            };
            let (centre, half) = (solid.centre(), 0.5 * solid.size().length());
            if half >= SMALL * centre.length() {
                return None;
            }
            markers.push((direction(centre.to_array()), count as f64));
        }
        (markers.len() > 1).then_some(markers)
    }

    /// The smallest extent of a sensor of unknown size.
    fn least(&self, axes: [usize; 2]) -> f64 {
        let all = self.hits.iter().fold(Bounds::EMPTY, |all, own| all.union(own));
        let extent = axes.map(|k| all.hi[k] - all.lo[k]).into_iter().fold(0.0, f64::max);
        let far = axes.map(|k| all.lo[k].abs().max(all.hi[k].abs())).into_iter().fold(0.0, f64::max);
        match extent > 1e-9 * far {
            true => LEAST_OF_ALL * extent,
            false if far > 0.0 => LEAST_OF_DISTANCE * far,
            false => 1.0,
        }
    }

    /// The corners of all sensors in a projection, and the numbers and outlines of those with a known solid or hits.
    fn of_all(&self, plane: MapPlane) -> (Rectangle, Vec<usize>, Vec<Rectangle>) {
        let (mut lo, mut hi) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        let (mut numbers, mut outlines) = (Vec::new(), Vec::new());
        for sensor in 0..self.counts.len() {
            let is_known = self.solids[sensor].is_some();
            if let Some(own) =
                self.window(sensor as u32, plane).filter(|_| is_known || self.counts[sensor] > 0)
            {
                lo = [0, 1].map(|k| lo[k].min(own[0][k]));
                hi = [0, 1].map(|k| hi[k].max(own[1][k]));
                numbers.push(sensor);
                outlines.push(own);
            }
        }
        ([lo, hi], numbers, outlines)
    }
}

/// The window of some hits on a sensor of unknown size: evenly distributed hits extend over the part (n - 1) / (n + 1) of it on average.
fn estimated([mut lo, mut hi]: Rectangle, hits: usize, least: f64) -> Rectangle {
    let margin = |extent: f64| extent / (hits.max(2) - 1) as f64;
    let margins = [0, 1].map(|k| margin(hi[k] - lo[k]));
    let longer = [0, 1].map(|k| hi[k] - lo[k] + 2.0 * margins[k]).into_iter().fold(0.0, f64::max);
    for k in 0..2 {
        // few hits have hardly any extent; hits on a line stay on it
        let missing = if longer < least { 0.5 * (least - (hi[k] - lo[k])) } else { 0.0 };
        let margin = margins[k].max(missing);
        (lo[k], hi[k]) = (lo[k] - margin, hi[k] + margin);
    }
    [lo, hi]
}

impl<'a> Panel<'a> {
    /// The map of one sensor: its window, and the number of cells along the longer side.
    fn new(
        hits: HitPositions<'a>,
        sensor: u32,
        plane: MapPlane,
        (window, cells): (Rectangle, usize),
    ) -> Panel<'a> {
        let rows = (0..hits.sensors.len()).filter(|&row| hits.sensors[row] == sensor);
        let points = projected(hits, rows, plane);
        let map = HitMap::new(&points, window, cells.max(1));
        let (name, hits, window) = (&hits.names[sensor as usize], points.len(), [map.lo, map.hi]);
        Panel { name, hits, plane, window, maps: vec![map], markers: Vec::new(), outlines: None }
    }

    /// The map of all sensors.
    fn of_all(hits: HitPositions<'a>, frames: &Frames, plane: MapPlane) -> Panel<'a> {
        let (maps, markers, outlines) = match plane {
            MapPlane::Sphere => match frames.markers().filter(|_| hits.cells.is_none()) {
                Some(markers) => (Vec::new(), markers, Vec::new()),
                None => {
                    let points = projected(hits, 0..hits.sensors.len(), plane);
                    let cells = hits.cells.unwrap_or_else(|| cells_for(points.len(), [1.0; 2], 2.0)).max(1);
                    (vec![HitMap::of_directions(&points, cells)], Vec::new(), Vec::new())
                }
            },
            _ => {
                let (window, numbers, sensors) = frames.of_all(plane);
                let are_few = sensors.len() <= MAX_OUTLINES;
                let (groups, footprints) =
                    if are_few { footprints(&numbers, &sensors) } else { Default::default() };
                let maps = match are_few && !any_overlap(&footprints) {
                    true => HitMap::of_footprints(hits, plane, &groups, &footprints),
                    false => vec![HitMap::of_overlapping(hits, plane, window, &sensors)],
                };
                (maps, Vec::new(), footprints)
            }
        };
        let corner = |k: usize, end: fn(&HitMap) -> [f64; 2], choose: fn(f64, f64) -> f64| {
            maps.iter().map(|map| end(map)[k]).reduce(choose)
        };
        let lo = [0, 1].map(|k| corner(k, |map| map.lo, f64::min).unwrap_or(WHOLE_SPHERE[0][k]));
        let hi = [0, 1].map(|k| corner(k, |map| map.hi, f64::max).unwrap_or(WHOLE_SPHERE[1][k]));
        let (hits, outlines) = (hits.sensors.len(), Some(outlines));
        Panel { name: "all sensors", hits, plane, window: [lo, hi], maps, markers, outlines }
    }

    /// The values of all cells and markers.
    fn values(&self) -> impl Iterator<Item = f64> + Clone {
        let cells = self.maps.iter().flat_map(|map| map.values.iter().copied());
        cells.chain(self.markers.iter().map(|(_, value)| *value))
    }

    /// The chart: with one scale for both axes of a projection, and at least a strip where the hits have hardly any extent.
    fn chart(&self, corner: [f64; 2]) -> Chart {
        let [mut lo, mut hi] = self.window;
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
        let text = format!("{}, {part:.1} %", hits_of(self.hits));
        if self.outlines.is_some() { format!("{text}, {}", self.plane.projection()) } else { text }
    }
}

/// Some hits in a plane.
fn projected(hits: HitPositions<'_>, rows: impl Iterator<Item = usize>, plane: MapPlane) -> Vec<[f64; 2]> {
    let point = |row: usize| match plane.axes() {
        Some(axes) => axes.map(|k| hits.positions[k][row]),
        None => direction(hits.positions.map(|column| column[row])),
    };
    rows.map(point).collect()
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

/// The corners of the map of all directions: azimuths in degrees and cosines of polar angles.
const WHOLE_SPHERE: Rectangle = [[-180.0, -1.0], [180.0, 1.0]];

impl HitMap {
    /// The maps of footprints that do not overlap, given the numbers of their sensors.
    fn of_footprints(
        hits: HitPositions<'_>,
        plane: MapPlane,
        sensors: &[Vec<usize>],
        footprints: &[Rectangle],
    ) -> Vec<HitMap> {
        let mut group_of = vec![None; hits.names.len()];
        for (group, own) in sensors.iter().enumerate() {
            own.iter().for_each(|&sensor| group_of[sensor] = Some(group));
        }
        let mut points = vec![Vec::new(); footprints.len()];
        for (&sensor, point) in hits.sensors.iter().zip(projected(hits, 0..hits.sensors.len(), plane)) {
            if let Some(group) = group_of[sensor as usize] {
                points[group].push(point);
            }
        }
        let cells = cells_of_sensors(hits, points.iter().map(Vec::len).zip(footprints.iter().copied()));
        let own = points.iter().zip(footprints).zip(cells);
        own.map(|((points, &window), cells)| HitMap::new(points, window, cells)).collect()
    }

    /// One map of sensors that overlap in a projection.
    fn of_overlapping(
        hits: HitPositions<'_>,
        plane: MapPlane,
        window: Rectangle,
        sensors: &[Rectangle],
    ) -> HitMap {
        let points = projected(hits, 0..hits.sensors.len(), plane);
        let area = |[width, height]: [f64; 2]| width * height;
        let whole = size(window);
        let covered = sensors.iter().map(|&own| area(size(own))).sum::<f64>() / area(whole);
        let covered = if covered > 0.0 { covered.min(1.0) } else { 1.0 };
        let longer = |[width, height]: [f64; 2]| width.max(height);
        let smallest = sensors.iter().map(|&own| longer(size(own))).fold(f64::INFINITY, f64::min);
        let resolving = (CELLS_PER_SENSOR * longer(whole) / smallest).ceil() as usize;
        let automatic = || cells_for(points.len(), whole, covered).max(resolving.min(MAX_CELLS));
        HitMap::new(&points, window, hits.cells.unwrap_or_else(automatic).max(1))
    }

    /// A map whose cells divide a window, with a number of cells along the longer side.
    fn new(points: &[[f64; 2]], [mut lo, mut hi]: Rectangle, most: usize) -> HitMap {
        let far = lo.iter().chain(&hi).fold(0.0, |far: f64, x| far.max(x.abs()));
        let longer = (hi[0] - lo[0]).max(hi[1] - lo[1]);
        let longer = if longer > 0.0 { longer } else { (1e-6 * far).max(1e-6) };
        let side = longer / most as f64;
        for k in 0..2 {
            // a line, up to the rounding errors of coordinates, gets a row of square cells
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
        HitMap::of_cells(points, WHOLE_SPHERE, cells, solid_angle)
    }

    fn of_cells(points: &[[f64; 2]], [lo, hi]: Rectangle, cells: [usize; 2], area: f64) -> HitMap {
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
    fn the_cells_divide_the_window() {
        let points: Vec<[f64; 2]> =
            (0..10_000).map(|k| [f64::from(k % 100), 0.5 * f64::from(k / 100)]).collect();
        let map = HitMap::new(&points, [[0.0; 2], [99.0, 49.5]], 11);
        assert_eq!((map.lo, map.hi, map.cells), ([0.0; 2], [99.0, 49.5], [11, 6]));
        let hits: f64 = map.values.iter().sum::<f64>() * (99.0 / 11.0) * (49.5 / 6.0);
        assert!((hits - 10_000.0).abs() < 1e-6, "{hits}");
        // 9 or 10 columns and 16 to 17 rows of points in cells of 9 by 8.25
        assert!(map.values.iter().all(|value| (1.9..2.4).contains(value)), "{:?}", map.values);
    }

    #[test]
    fn hits_on_a_line_and_at_a_point_have_cells() {
        let line: Vec<[f64; 2]> = (0..=40).map(|k| [3.0, f64::from(k)]).collect();
        let map = HitMap::new(&line, [[3.0, 0.0], [3.0, 40.0]], 8);
        assert_eq!((map.cells, map.lo, map.hi), ([1, 8], [0.5, 0.0], [5.5, 40.0]));
        let point = HitMap::new(&[[5.0, 0.0]; 3], [[5.0, 0.0]; 2], 4);
        assert_eq!(point.cells, [1, 1]);
        assert!((point.values[0] * (point.hi[0] - point.lo[0]).powi(2) - 3.0).abs() < 1e-6);
    }

    /// A sensor of 10 mm by 100 mm is divided into cells of its own sides, not into one row that is wider than the sensor.
    #[test]
    fn the_cells_of_thin_sensors_fit_them() {
        let points: Vec<[f64; 2]> =
            (0..1010).map(|k| [f64::from(k % 10) * 10.0 / 9.0, f64::from(k / 10)]).collect();
        let map = HitMap::new(&points, [[0.0; 2], [10.0, 100.0]], 4);
        assert_eq!((map.lo, map.hi, map.cells), ([0.0; 2], [10.0, 100.0], [1, 4]));
        let area = 10.0 * 100.0 / 4.0;
        // 25 or, in the last cell with both edges, 26 rows of ten
        assert_eq!(
            map.values.iter().map(|value| (value * area).round()).collect::<Vec<_>>(),
            [250.0, 250.0, 250.0, 260.0]
        );
    }

    #[test]
    fn cells_hold_about_ten_hits() {
        // 10 hits in each of 10 by 10 cells; in each of 40 by 10, and in a strip
        assert_eq!(cells_for(1_000, [6.0, 6.0], 1.0), 10);
        assert_eq!(cells_for(4_000, [12.0, 3.0], 1.0), 40);
        assert_eq!(cells_for(100, [1e4, 1.0], 1.0), 10);
        // the sensors cover a hundredth of the window
        assert_eq!(cells_for(40, [6.0, 6.0], 0.01), 20);
        assert_eq!([0, 1, 5, 30, 1_000_000].map(|hits| cells_for(hits, [2.0, 2.0], 1.0)), [1, 1, 2, 4, 64]);
        // a cell is smaller than a fibre of 1 mm on a sensor of 6 mm
        assert_eq!(cells_for(1887, [6.0, 6.0], 1.0), 13);
    }

    /// The mean extent of evenly distributed hits: 2, 4 and 9 hits of a sensor of 3, 5 and 10 on a lattice.
    #[test]
    fn windows_of_hits_are_those_of_their_sensor() {
        for (hits, side) in [(2, 3.0), (4, 5.0), (9, 10.0)] {
            let window = [[1.0, 1.0], [side - 1.0, side - 1.0]];
            assert_eq!(estimated(window, hits, 0.5), [[0.0; 2], [side; 2]]);
        }
        assert_eq!(estimated([[5.0, 7.0]; 2], 1, 2.0), [[4.0, 6.0], [6.0, 8.0]]);
        // a line stays one
        assert_eq!(estimated([[3.0, 0.0], [3.0, 30.0]], 4, 2.0), [[3.0, -10.0], [3.0, 40.0]]);
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
