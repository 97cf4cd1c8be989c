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
use rayweave_model::{Crossing, Evaluator, Program, Query, RayAnswer, RayBatch, RegionId, attributes};
use rayweave_shape::Ray;
use std::convert::Infallible;
use std::num::NonZeroUsize;
use std::ops::Range;

/// Cells per task.
const CELLS_PER_TASK: u64 = 512;

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

impl Piece<'_> {
    /// The region; 0 is the world.
    pub fn region(&self) -> RegionId {
        self.entry.after
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

    /// An estimate of the distance between two faces whose normals are opposite to within 25 degrees. `None` at the edges of a body,
    /// where two faces intersect and any length occurs, and at its rim.
    pub fn wall(&self) -> Option<f64> {
        let [first, second] = self.normals();
        (first.dot(second) < -0.9).then(|| self.thickness())
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

/// The shortest chord through a point along given directions, within the regions selected by `is_in`;
/// adjacent selected regions count as one. `None` if the point is in none of them, or all chords are
/// infinite.
pub fn shortest_at<E: Evaluator>(
    evaluator: &E,
    point: Vec3,
    directions: &[Vec3],
    is_in: impl Fn(RegionId) -> bool,
    scratch: &mut E::Scratch,
) -> Option<MeasuredChord> {
    shortest_across(evaluator, &[point], directions, &is_in, Faces::Any, scratch).map(|across| across.chord)
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
}

impl Across {
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
    let units = directions.iter().map(|direction| direction.normalize_or_zero());
    for unit in units.filter(|unit| *unit != Vec3::ZERO) {
        points.iter().for_each(|point| batch.push(Ray::new(*point, unit)));
    }
    let mut least: Option<Across> = None;
    let (rays, program) = (batch.rays(), evaluator.program());
    let mut sink = |answer: RayAnswer<'_>| {
        let Some([entry, exit]) = span_around(&answer, is_in) else { return };
        let ray = rays.get(answer.ray);
        let piece = Piece { program, ray, entry, exit, area: 0.0 };
        let across = Across { chord: piece.chord(), normals: piece.normals() };
        let is_less = least.is_none_or(|least| across.width(faces) < least.width(faces));
        if is_less && (faces == Faces::Any || piece.wall().is_some()) {
            least = Some(across);
        }
    };
    evaluator.crossings(rays, &Query::default(), scratch, &mut sink);
    least
}

/// The crossings at the ends of the selected span around t = 0; `None` if it is infinite or t = 0 is not in it.
fn span_around<'a>(answer: &RayAnswer<'a>, is_in: impl Fn(RegionId) -> bool) -> Option<[&'a Crossing; 2]> {
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
    Across { chord, normals }: Across,
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

/// A chord of a wall of which no chord beside it has a smaller width: its ends are moved to the feet of perpendiculars, in turn,
/// as long as the width becomes smaller. Of chords of equal width, such as those of a ball, it is one along a normal.
pub(crate) fn narrowest<E: Evaluator>(
    evaluator: &E,
    mut best: Across,
    is_in: &impl Fn(RegionId) -> bool,
    scratch: &mut E::Scratch,
) -> Across {
    /// The largest number of steps: each reduces the angles between chord and normals by a quarter or more.
    const STEPS: usize = 128;
    /// The distance from an end to the point beside it where rays start, relative to the length of the chord.
    const INSIDE: f64 = 1e-6;
    /// Parts of the way from the direction of the chord to the normals: a whole step may lead beyond the closest place.
    const PARTS: [f64; 4] = [1.0, 0.5, 0.25, 0.125];
    for _ in 0..STEPS {
        let MeasuredChord { from, to } = best.chord;
        let points = [from + INSIDE * (to - from), 0.5 * (from + to), to + INSIDE * (from - to)];
        let along = (to - from).normalize_or_zero();
        let directions = best.normals.map(|normal| {
            let forward = if normal.dot(along) < 0.0 { -normal } else { normal };
            PARTS.map(|part| along + part * (forward - along))
        });
        match shortest_across(evaluator, &points, directions.as_flattened(), is_in, Faces::Wall, scratch) {
            Some(next) if next.width(Faces::Wall) < SMALLER * best.width(Faces::Wall) => best = next,
            _ => break,
        }
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
            let chord = shortest_at(&nested, Vec3::new(x, 0.0, 0.0), &directions, is_in, &mut scratch);
            chord.map(|chord| chord.length())
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
