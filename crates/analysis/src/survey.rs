//! Random survey of a model: chords of random rays, with their neighbouring regions and the local thickness.
//!
//! Random rays parallel to x, y and z pass through a box, two in each cell of its cross-section, as in
//! [`measure`](mod@crate::measure). A piece is the part of a ray in one region between two crossings. Its
//! length is a poor measure of the thickness of the region, because a ray that grazes a film has a long piece
//! in it. With `n` the normals of the faces at its ends and `d` its direction,
//!
//! ```text
//!   thickness = length * (|n1 . d| + |n2 . d|) / 2
//! ```
//!
//! is the distance between parallel faces; for two concentric spheres, it is their distance up to its square over the
//! radius. At the rim of a thin shell, where a ray may run within the shell from its outer side to its outer side, it
//! is at most four times the thickness of the shell. Between other faces it is only an estimate, which may be too large or too
//! small: thicknesses that are reported are lengths of chords, found by `thickness_at_middle` and `narrowest`.

pub use crate::error::Cancelled;
use crate::measure::MeasuredChord;
use crate::measure::cells::Cells;
use rayweave_math::{Bounds, Vec3};
use rayweave_model::drive::{Cancel, Stopped, drive, thread_count};
use rayweave_model::{
    Crossing, Evaluator, Face, LeafId, PlacementId, Program, Query, RayAnswer, RayBatch, RegionId, attributes,
};
use rayweave_shape::Ray;
use std::convert::Infallible;
use std::num::NonZeroUsize;
use std::ops::Range;

/// Cells per task.
const CELLS_PER_TASK: u64 = 512;

/// The cosine of the angle up to which faces count as opposite, and up to which a face counts as facing a way: 26 degrees. Planes at a
/// larger angle, of tangent 0.48 or more, meet within 1 / 0.48 = 2.1 thicknesses of the place: beside such an edge any thickness occurs.
pub(crate) const FACING: f64 = 0.9;

/// The number of tasks of a survey.
pub(crate) fn task_count(across: u32) -> u64 {
    let across = u64::from(across.max(1));
    3 * (across * across).div_ceil(CELLS_PER_TASK)
}

/// The rays of a survey.
#[derive(Clone, Debug)]
pub struct Survey {
    /// The sampled box, which must be finite.
    pub bounds: Bounds,
    /// The number of cells along an edge of its cross-sections, n: there are 6 n^2 rays.
    pub across: u32,
    /// The seed of the random numbers: equal seeds give equal rays.
    pub seed: u64,
    /// The number of the random stream, unique among surveys with one seed.
    pub stream: u64,
    /// The number of threads; by default that of [`thread_count`]. Results do not depend on it.
    pub threads: Option<NonZeroUsize>,
    /// Cancels the run.
    pub cancel: Cancel,
}

/// The part of a ray in one region between two crossings.
#[derive(Clone, Copy, Debug)]
pub struct Piece<'a> {
    program: &'a Program,
    ray: Ray,
    entry: &'a Crossing,
    exit: &'a Crossing,
    /// The area that the ray represents in the cross-section: half a cell, since two rays share it.
    pub area: f64,
}

/// The leaves of the faces at the ends of a chord, with their placements, in ascending order.
pub(crate) type Leaves = [(LeafId, PlacementId); 2];

impl Piece<'_> {
    /// The chord with its normals and the leaves of its faces.
    pub(crate) fn across(&self) -> Across {
        let face = |face: Face| ((face.leaf, face.placement), face.facet);
        let mut faces = [face(self.entry.face), face(self.exit.face)];
        faces.sort_unstable();
        let (leaves, facets) = (faces.map(|face| face.0), faces.map(|face| face.1));
        Across { chord: self.chord(), normals: self.normals(), leaves: Some(leaves), facets }
    }

    /// The region; 0 is the world.
    pub fn region(&self) -> RegionId {
        self.entry.after
    }

    /// The faces at its ends.
    pub(crate) fn faces(&self) -> [Face; 2] {
        [self.entry.face, self.exit.face]
    }

    /// The regions before and after it.
    pub fn neighbours(&self) -> [RegionId; 2] {
        [self.entry.before, self.exit.after]
    }

    /// The end points.
    pub fn chord(&self) -> MeasuredChord {
        MeasuredChord { from: self.ray.at(self.entry.t), to: self.ray.at(self.exit.t) }
    }

    /// The length.
    pub fn length(&self) -> f64 {
        self.exit.t - self.entry.t
    }

    /// The normals of the faces at both ends, outward of the region.
    pub fn normals(&self) -> [Vec3; 2] {
        let normal = |crossing: &Crossing, sign: f64| {
            let normal = attributes::normal(self.program, &self.ray, crossing);
            if normal.dot(self.ray.direction) * sign < 0.0 { -normal } else { normal }
        };
        [normal(self.entry, -1.0), normal(self.exit, 1.0)]
    }

    /// An estimate of the local thickness of the region: the length times the mean cosine of the faces.
    pub fn thickness(&self) -> f64 {
        let cosines = self.normals().map(|normal| normal.dot(self.ray.direction).abs());
        self.length() * 0.5 * (cosines[0] + cosines[1])
    }

    /// An estimate of the distance between two faces whose normals are opposite to within 26 degrees. `None` at the edges of a body,
    /// where two faces intersect and any length occurs, and at its rim.
    pub fn wall(&self) -> Option<f64> {
        let [first, second] = self.normals();
        (first.dot(second) < -FACING).then(|| self.thickness())
    }
}

/// Traces the rays of a survey. `visit` is called with every piece and accumulates into one value per task;
/// `merge` receives these values in order. Returns the number of rays.
///
/// # Errors
///
/// [`Cancelled`].
pub fn survey<E: Evaluator, T: Default + Send>(
    evaluator: &E,
    settings: &Survey,
    visit: impl Fn(&mut T, &Piece<'_>) + Sync,
    mut merge: impl FnMut(T),
) -> Result<u64, Cancelled> {
    let across = u64::from(settings.across.max(1));
    let tasks = (0..3).flat_map(|axis| {
        let count = across * across;
        let starts = (0..count).step_by(CELLS_PER_TASK as usize);
        starts.map(move |first| (axis, first..count.min(first + CELLS_PER_TASK)))
    });
    let work = |(scratch, batch): &mut (E::Scratch, RayBatch), (axis, range): (usize, Range<u64>)| {
        let stream = settings.stream * 3 + axis as u64;
        let cells =
            Cells { bounds: settings.bounds, axis, across, seed: settings.seed, stream, within: None };
        cells.rays(range, batch);
        let mut gathered = T::default();
        pieces(evaluator, batch, 0.5 * cells.area(), scratch, |piece| visit(&mut gathered, piece));
        gathered
    };
    let scratch = || (evaluator.scratch(), RayBatch::default());
    let merge = |gathered| {
        merge(gathered);
        Ok::<(), Infallible>(())
    };
    match drive(thread_count(settings.threads), &settings.cancel, tasks, scratch, work, merge) {
        Ok(()) => Ok(6 * across * across),
        Err(Stopped::Cancelled) => Err(Cancelled),
        Err(Stopped::Failed(never)) => match never {},
    }
}

fn pieces<E: Evaluator>(
    evaluator: &E,
    batch: &RayBatch,
    area: f64,
    scratch: &mut E::Scratch,
    mut visit: impl FnMut(&Piece<'_>),
) {
    let (program, rays) = (evaluator.program(), batch.rays());
    let mut sink = |answer: RayAnswer<'_>| {
        let ray = rays.get(answer.ray);
        for pair in answer.crossings.windows(2) {
            visit(&Piece { program, ray, entry: &pair[0], exit: &pair[1], area });
        }
    };
    evaluator.crossings(rays, &Query::default(), scratch, &mut sink);
}

/// The faces that a chord may join.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Faces {
    /// Any two faces.
    Any,
    /// The faces of a wall: see [`Piece::wall`].
    Wall,
}

/// A chord of a region, with the outward normals of the faces at its ends.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Across {
    pub chord: MeasuredChord,
    pub normals: [Vec3; 2],
    /// `None` if they do not matter.
    pub leaves: Option<Leaves>,
    /// The numbers of the faces within these leaves.
    pub facets: [u32; 2],
}

impl Across {
    /// A chord with the normals at its ends, of any faces.
    pub fn new(chord: MeasuredChord, normals: [Vec3; 2]) -> Across {
        Across { chord, normals, leaves: None, facets: [0; 2] }
    }

    /// The middle of the chord.
    pub fn middle(&self) -> Vec3 {
        0.5 * (self.chord.from + self.chord.to)
    }

    /// The length of the chord or, for a wall, an upper bound of its thickness: the diameter of the larger of the two balls that
    /// touch the face at one end from inside and go through the other end, `length / |n . d|`. No ball within the region that
    /// touches the face there is larger. For every chord of a ball, and for a chord perpendicular to both faces, it is the thickness.
    pub fn width(&self, faces: Faces) -> f64 {
        let (length, between) = (self.chord.length(), self.chord.to - self.chord.from);
        match faces {
            Faces::Any => length,
            Faces::Wall => {
                let shares = self.normals.map(|normal| normal.dot(between).abs());
                length * length / shares[0].min(shares[1])
            }
        }
    }
}

/// The chord of the smallest width through the points along the directions, each point with each direction.
fn shortest_across<E: Evaluator>(
    evaluator: &E,
    points: &[Vec3],
    directions: &[Vec3],
    is_in: &impl Fn(RegionId) -> bool,
    faces: Faces,
    scratch: &mut E::Scratch,
) -> Option<Across> {
    let mut batch = RayBatch::default();
    points.iter().for_each(|point| push(&mut batch, *point, directions));
    let mut least: Option<Across> = None;
    chords(evaluator, &batch, is_in, faces, scratch, |across| {
        if least.is_none_or(|least| across.width(faces) < least.width(faces)) {
            least = Some(across);
        }
    });
    least
}

/// Adds the rays from a point along directions; those of length 0 are left out.
fn push(batch: &mut RayBatch, point: Vec3, directions: &[Vec3]) {
    let units = directions.iter().map(|direction| direction.normalize_or_zero());
    units.filter(|unit| *unit != Vec3::ZERO).for_each(|unit| batch.push(Ray::new(point, unit)));
}

/// Calls `visit` with the chord around the start of each ray of a batch, if it joins faces of the given kind.
fn chords<E: Evaluator>(
    evaluator: &E,
    batch: &RayBatch,
    is_in: &impl Fn(RegionId) -> bool,
    faces: Faces,
    scratch: &mut E::Scratch,
    mut visit: impl FnMut(Across),
) {
    let (rays, program) = (batch.rays(), evaluator.program());
    let mut sink = |answer: RayAnswer<'_>| {
        let Some([entry, exit]) = span_around(&answer, is_in) else { return };
        let ray = rays.get(answer.ray);
        let piece = Piece { program, ray, entry, exit, area: 0.0 };
        if faces == Faces::Any || piece.wall().is_some() {
            visit(piece.across());
        }
    };
    evaluator.crossings(rays, &Query::default(), scratch, &mut sink);
}

/// The crossings at the ends of the selected span around t = 0; `None` if it is infinite or t = 0 is not in it.
pub(crate) fn span_around<'a>(
    answer: &RayAnswer<'a>,
    is_in: impl Fn(RegionId) -> bool,
) -> Option<[&'a Crossing; 2]> {
    let (mut inside, mut since) = (is_in(answer.start), None);
    for crossing in answer.crossings.iter().filter(|crossing| is_in(crossing.before) != is_in(crossing.after))
    {
        match inside {
            true if crossing.t >= 0.0 => return since.map(|since| [since, crossing]),
            false if crossing.t > 0.0 => return None,
            _ => (inside, since) = (!inside, Some(crossing)),
        }
    }
    None
}

/// The largest number of steps of the search for a shorter chord through a point.
const STEPS: usize = 16;

/// A width counts as smaller only by more than this factor.
const SMALLER: f64 = 1.0 - 1e-9;

/// The local thickness at the middle of a chord: the chord of the smallest width through it along the axes, the chord itself, the normals at
/// its ends and those at the ends of the chords found. `None` for a chord that exists only because of rounding.
pub(crate) fn thickness_at_middle<E: Evaluator>(
    evaluator: &E,
    Across { chord, normals, .. }: Across,
    is_in: &impl Fn(RegionId) -> bool,
    faces: Faces,
    scratch: &mut E::Scratch,
) -> Option<Across> {
    let middle = [0.5 * (chord.from + chord.to)];
    let directions = [Vec3::X, Vec3::Y, Vec3::Z, chord.to - chord.from, normals[0], normals[1]];
    let mut best = shortest_across(evaluator, &middle, &directions, is_in, faces, scratch)?;
    for _ in 0..STEPS {
        match shortest_across(evaluator, &middle, &best.normals, is_in, faces, scratch) {
            Some(next) if next.width(faces) < SMALLER * best.width(faces) => best = next,
            _ => break,
        }
    }
    Some(best)
}

/// The chord of a wall again, along a ray that starts at its middle. `None` for a chord that exists only because of rounding.
pub(crate) fn confirmed<E: Evaluator>(
    evaluator: &E,
    found: &Across,
    is_in: &impl Fn(RegionId) -> bool,
    scratch: &mut E::Scratch,
) -> Option<Across> {
    let along = found.chord.to - found.chord.from;
    shortest_across(evaluator, &[found.middle()], &[along], is_in, Faces::Wall, scratch)
}

/// A chord of a wall of which no chord beside it has a smaller width, or the best one after the given number of steps; its width is
/// never larger than that of `best`, except for rounding. Of chords of equal width, such as those of a ball, it is one along a normal.
///
/// Each step turns the chord towards the normals of its faces and moves it towards the narrower side, which is that of the sum of its
/// outward normals. A chord between the same two leaves is preferred to one of another wall, which may be even narrower now, but not
/// at its narrowest place.
pub(crate) fn narrowest<E: Evaluator>(
    evaluator: &E,
    mut best: Across,
    is_in: &impl Fn(RegionId) -> bool,
    steps: usize,
    scratch: &mut E::Scratch,
) -> Across {
    let mut before: Option<(Vec3, Vec3)> = None;
    for _ in 0..steps {
        let batch = beside(&best, before);
        let [mut least, mut own] = [best; 2];
        chords(evaluator, &batch, is_in, Faces::Wall, scratch, |across| {
            let width = across.width(Faces::Wall);
            if width < least.width(Faces::Wall) {
                least = across;
            }
            if width < own.width(Faces::Wall) && across.leaves == best.leaves {
                own = across;
            }
        });
        let limit = SMALLER * best.width(Faces::Wall);
        let next = [own, least].into_iter().find(|next| next.width(Faces::Wall) < limit);
        let Some(next) = next else { break };
        before = Some((best.middle(), opening(&best)));
        best = next;
    }
    let MeasuredChord { from, to } = best.chord;
    let (start, end) = (from + INSIDE * (to - from), to + INSIDE * (from - to));
    for (point, normal) in [(start, best.normals[0]), (end, best.normals[1])] {
        let along = shortest_across(evaluator, &[point], &[normal], is_in, Faces::Wall, scratch);
        if let Some(along) =
            along.filter(|along| along.width(Faces::Wall) * SMALLER <= best.width(Faces::Wall))
        {
            return along;
        }
    }
    best
}

/// The distance from an end of a chord to the point beside it where rays start, relative to the length of the chord.
const INSIDE: f64 = 1e-6;

/// The rays of a step of [`narrowest`]. `before` contains the middle and the opening of the chord before.
fn beside(best: &Across, before: Option<(Vec3, Vec3)>) -> RayBatch {
    /// Parts of the way from the direction of the chord to the normals: a whole step may lead beyond the closest place.
    const PARTS: [f64; 4] = [1.0, 0.5, 0.25, 0.125];
    /// Powers of 4 of the radii of curvature, relative to the length of the chord, for which a sideways step is tried.
    const RADII: std::ops::RangeInclusive<i32> = -2..=6;
    let MeasuredChord { from, to } = best.chord;
    let (along, length, middle) = ((to - from).normalize_or_zero(), best.chord.length(), best.middle());
    let directions = best.normals.map(|normal| {
        let forward = if normal.dot(along) < 0.0 { -normal } else { normal };
        PARTS.map(|part| along + part * (forward - along))
    });
    let mut batch = RayBatch::default();
    for point in [from + INSIDE * (to - from), middle, to + INSIDE * (from - to)] {
        push(&mut batch, point, directions.as_flattened());
    }
    // the thickness falls along the sum of the outward normals, which is proportional to the distance from the narrowest place:
    // their ratio, a radius of curvature, is unknown in the first step, and that of a secant afterwards
    let slope = opening(best);
    let secant = before.and_then(|(at, other)| {
        let moved = middle - at;
        let radius = moved.dot(moved) / moved.dot(slope - other).abs();
        radius.is_finite().then_some(radius)
    });
    let radii = RADII.map(|power| length * 4f64.powi(power)).chain(secant);
    for radius in radii.filter(|_| slope != Vec3::ZERO) {
        push(&mut batch, middle + radius * slope, &[along, best.normals[1] - best.normals[0]]);
    }
    batch
}

/// The part of the sum of the outward normals that is perpendicular to the chord: minus the gradient of the thickness.
fn opening(across: &Across) -> Vec3 {
    let along = (across.chord.to - across.chord.from).normalize_or_zero();
    let sum = across.normals[0] + across.normals[1];
    sum - sum.dot(along) * along
}

#[cfg(test)]
mod tests {
    use super::*;
    use rayweave_model::{Region, Solid};
    use rayweave_shape::primitive::{CentredBox, Primitive, Sphere};
    use rayweave_trace::Packets;
    use std::sync::Arc;

    fn ball(radius: f64) -> Solid {
        Solid::from(Primitive::from(Sphere::new(radius).unwrap()))
    }

    fn packets(solids: &[Solid]) -> Packets {
        let region =
            |(k, solid): (u32, &Solid)| Region { name: k.to_string(), solid: solid.clone(), medium: k };
        let regions: Vec<Region> = (1..).zip(solids).map(region).collect();
        Packets::new(Arc::new(Program::compile_regions(&regions).unwrap()))
    }

    fn settings(bounds: Bounds) -> Survey {
        Survey { bounds, across: 60, seed: 1, stream: 0, threads: None, cancel: Cancel::new() }
    }

    /// Rays along the rim of a thin shell have long pieces, but the measured thickness is that of the shell;
    /// its faces are walls.
    #[test]
    fn shells_are_as_thin_as_they_are() {
        let thin = 1e-3;
        let shell = packets(&[ball(1.0) - ball(1.0 - thin)]);
        let (mut longest, mut thickest, mut thinnest, mut count) = (0.0f64, 0.0f64, f64::INFINITY, 0);
        let bounds = shell.program().bounds();
        let merge = |found: Vec<(f64, f64, Option<f64>)>| {
            for (length, thickness, wall) in found {
                count += 1;
                (longest, thickest) = (longest.max(length), thickest.max(thickness));
                thinnest = thinnest.min(wall.unwrap_or(f64::INFINITY));
            }
        };
        let visit = |found: &mut Vec<_>, piece: &Piece<'_>| {
            if piece.region() == RegionId(1) {
                found.push((piece.length(), piece.thickness(), piece.wall()));
            }
        };
        let rays = survey(&shell, &settings(bounds), visit, merge).unwrap();
        assert_eq!(rays, 6 * 3600);
        assert!(count > 3000 && longest > 0.02 && thickest < 4.01 * thin, "{count} {longest} {thickest}");
        assert!((thinnest / thin - 1.0).abs() < 0.05, "{thinnest}");
    }

    /// At the edges of a rotated box, pieces of any length occur, but no walls.
    #[test]
    fn edges_are_no_walls() {
        let cube = Solid::from(Primitive::from(CentredBox::new(Vec3::splat(2.0)).unwrap()));
        let cube = packets(&[cube.rotate_x(20.0).rotate_y(35.0)]);
        let visit = |found: &mut Vec<_>, piece: &Piece<'_>| found.push((piece.length(), piece.wall()));
        let mut found = Vec::new();
        survey(&cube, &settings(cube.program().bounds()), visit, |some: Vec<_>| found.extend(some)).unwrap();
        let shortest = found.iter().map(|piece| piece.0).fold(f64::INFINITY, f64::min);
        let thinnest = found.iter().filter_map(|piece| piece.1).fold(f64::INFINITY, f64::min);
        assert!(shortest < 0.05 && (thinnest - 2.0).abs() < 1e-9, "{shortest} {thinnest}");
    }

    #[test]
    fn thickness_around_a_point() {
        let nested = packets(&[ball(2.0), ball(1.0)]);
        let mut scratch = nested.scratch();
        let mut at = |x: f64, is_in: &dyn Fn(RegionId) -> bool| {
            let directions = [Vec3::X * 3.0, Vec3::Y, Vec3::ZERO];
            let points = [Vec3::new(x, 0.0, 0.0)];
            let found = shortest_across(&nested, &points, &directions, &is_in, Faces::Any, &mut scratch);
            found.map(|found| found.chord.length())
        };
        assert_eq!(at(1.5, &|region| region == RegionId(1)), Some(1.0));
        assert_eq!(at(0.0, &|region| region == RegionId(2)), Some(2.0));
        // both regions together
        let together = at(1.5, &|region| region != RegionId(0)).unwrap();
        assert!((together - 2.0 * 1.75f64.sqrt()).abs() < 1e-12, "{together}");
        assert_eq!(at(3.0, &|region| region != RegionId(0)), None);
        assert_eq!(at(-1.5, &|region| region == RegionId(2)), None);
        assert_eq!(at(3.0, &|region| region == RegionId(0)), None);
    }
}
