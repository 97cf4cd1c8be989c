//! Walls and gaps at edges and corners that point towards a face, or towards another edge or corner.
//!
//! A wall or gap is a shortest way through a region between two points of its boundary: within the half-balls around both ends that
//! face each other there is nothing but the region. An end is on a face perpendicular to the way, or on an edge or at a corner that
//! points into the region and has the way in the cone of its normals. An edge that points out of the region, such as that of a wedge,
//! is none: ways beside it become shorter towards it.
//!
//! Rays from the edges and corners into the region, and pairs of them, give places to start from; Newton's method leads to the
//! shortest way nearby, and rays and points around it verify it.

use super::edges::{Ends, FaceKey, Feature, Grid, Hits, Surfaces, features, regions_at};
use super::narrow::keep_smallest;
use super::probe::{Budget, IN_STARTS};
use super::stratum::{Closest, closest};
use crate::measure::MeasuredChord;
use crate::survey::{Across, FACING, Faces, span_around};
use rayweave_math::{Bounds, UNIT_ROUNDOFF, Vec3};
use rayweave_model::{Crossing, Evaluator, Program, Query, RayAnswer, RayBatch, RegionId, attributes};
use rayweave_shape::Ray;
use std::collections::BTreeMap;

/// The number of places to start from that are kept for each two faces, edges or corners.
const PER_PAIR: usize = 4;

/// The most pairs of faces, edges and corners whose shortest ways are searched.
const MAX_PAIRS: usize = 4096;

/// The most pairs of points on edges and corners that are compared in a survey.
const MAX_COMPARED: u64 = 20_000_000;

/// The number of comparisons whose work is that of a ray for each leaf that it reaches.
const COMPARED_PER_UNIT: u64 = 16;

/// The work of a search for the shortest way from one place, and of its verification for each leaf that a ray reaches: a ray, and points
/// around both ends.
const WORK_OF_START: u64 = 300;
const WORK_OF_VERIFICATION: u64 = 20;

/// The ends of a shortest way: the region between them, and the regions beyond them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Between {
    pub region: RegionId,
    pub beyond: [RegionId; 2],
}

/// A shortest way from an edge or corner.
#[derive(Clone, Debug)]
pub(super) struct Facing {
    pub between: Between,
    pub across: Across,
    /// The faces at each end: those that face the way, or else all that meet there.
    pub faces: [Vec<FaceKey>; 2],
    /// True if there is no way: the ends touch.
    pub is_contact: bool,
}

/// The step for central differences of gradients, relative to the diagonal of the model. Their error is of the order h^2 + u / h for a
/// step h, least at the cube root of u, 5e-6.
const STEP: f64 = 1e-5;

/// The rounding error of a distance, relative to the diagonal of the model, as for signed distances ([`crate::distance`]).
const SHORTEST: f64 = 256.0 * UNIT_ROUNDOFF;

/// The angle in radians above which faces are not parallel: a chord as short as [`SHORTEST`], 3e-14, between them is within 3e-11 of
/// their common edge, nearer than the points that are tested beside edges ([`BESIDE`]).
const LEAST_ANGLE: f64 = 1e-3;

/// The distance of points beside a contact or edge whose regions decide, relative to its distance from the origin: far above the
/// rounding errors of such points, 64 u times the lengths involved, or 1e-14.
const BESIDE: f64 = 1e-9;

/// A place to start from.
#[derive(Clone, Copy, Debug)]
struct Start {
    length: f64,
    ends: [Vec3; 2],
    between: Between,
}

/// A region, and two faces, edges or corners of its boundary.
type Pair = (RegionId, Ends, Ends);

/// Places to start from, of all surveys.
pub(super) struct Search<'p> {
    surfaces: Surfaces<'p>,
    starts: BTreeMap<Pair, Vec<Start>>,
    frame: Bounds,
    /// The diagonal of the box of the program.
    diagonal: f64,
    /// Ways longer than this do not matter, apart from the distance between neighbouring points of an edge.
    limit: f64,
    /// The number of leaves that a ray through the model reaches.
    leaves: u64,
    /// The number of points of edges and corners that point into a region.
    pub count: u64,
    /// The number of hits, faces, edges and pairs that were left out.
    pub left_out: u64,
}

impl<'p> Search<'p> {
    pub fn new(program: &'p Program, frame: Bounds, limit: f64, leaves: u64) -> Search<'p> {
        Search {
            surfaces: Surfaces::new(program),
            starts: BTreeMap::new(),
            frame,
            diagonal: program.bounds().size().length(),
            limit,
            leaves,
            count: 0,
            left_out: 0,
        }
    }

    /// Adds the edges and corners between the faces that the rays of a survey hit. `matters` selects the regions and their
    /// neighbours.
    pub fn add<E: Evaluator>(
        &mut self,
        evaluator: &E,
        hits: &Hits,
        grid: &Grid,
        matters: &impl Fn(&Between) -> bool,
        budget: &mut Budget,
        scratch: &mut E::Scratch,
    ) {
        let work = (self.leaves, &mut *budget);
        let (features, left_out) = features(evaluator, hits, grid, &mut self.surfaces, work, scratch);
        self.count += features.len() as u64;
        self.left_out += left_out;
        let reach = 2.0 * self.limit + 3.0 * grid.size;
        self.look(evaluator, &features, (grid, reach), matters, budget, scratch);
        self.pair(&features, (grid, reach), matters, budget);
    }

    /// Follows rays from edges and corners to the opposite face.
    fn look<E: Evaluator>(
        &mut self,
        evaluator: &E,
        features: &[Feature],
        (grid, reach): (&Grid, f64),
        matters: &impl Fn(&Between) -> bool,
        budget: &mut Budget,
        scratch: &mut E::Scratch,
    ) {
        let step = 1e-7 * self.frame.size().length();
        let (mut batch, mut of) = (RayBatch::default(), Vec::new());
        for (number, feature) in features.iter().enumerate() {
            let outward = feature.outward();
            if !budget.affords(outward.len() as u64, self.leaves) {
                self.left_out += 1;
                continue;
            }
            for outward in outward {
                batch.push(Ray::new(feature.point - step * outward, -outward));
                of.push(number);
            }
        }
        let rays = batch.rays();
        let mut found = Vec::new();
        let mut sink = |answer: RayAnswer<'_>| {
            let ray = rays.get(answer.ray);
            let feature = of[answer.ray];
            let Some(crossing) = answer.crossings.iter().find(|crossing| crossing.t > 0.0) else { return };
            if crossing.before == features[feature].region && crossing.t <= reach {
                found.push((
                    feature,
                    *crossing,
                    ray.at(crossing.t),
                    attributes::normal(evaluator.program(), &ray, crossing),
                ));
            }
        };
        evaluator.crossings(rays, &Query::default(), scratch, &mut sink);
        for (number, Crossing { face, after, .. }, point, normal) in found {
            let feature = &features[number];
            let between = Between { region: feature.region, beyond: [feature.beyond, after] };
            if !matters(&between) {
                continue;
            }
            let Some(surface) = self.surfaces.number(face, point, normal, grid) else { continue };
            let start =
                Start { length: (point - feature.point).length(), ends: [feature.point, point], between };
            // the surface of the edge itself leads back to the edge
            let is_own = matches!(&feature.ends, Ends::Common(own) if own.contains(&surface));
            if !is_own {
                self.insert(feature.ends.clone(), Ends::Common(vec![surface]), start, grid.size);
            }
        }
    }

    /// Compares edges and corners with each other.
    fn pair(
        &mut self,
        features: &[Feature],
        (grid, reach): (&Grid, f64),
        matters: &impl Fn(&Between) -> bool,
        budget: &mut Budget,
    ) {
        let mut order: Vec<usize> = (0..features.len()).collect();
        order.sort_by(|&a, &b| features[a].point.x.total_cmp(&features[b].point.x).then(a.cmp(&b)));
        let mut compared = 0;
        for (k, &a) in order.iter().enumerate() {
            for &b in &order[k + 1..] {
                let [a, b] = [a.min(b), a.max(b)].map(|number| &features[number]);
                if (b.point.x - a.point.x).abs() > reach {
                    break;
                }
                compared += 1;
                if compared > MAX_COMPARED || (compared % COMPARED_PER_UNIT == 0 && !budget.takes(1)) {
                    self.left_out += 1;
                    return;
                }
                let way = b.point - a.point;
                let is_near = a.region == b.region && way.length() <= reach && a.ends != b.ends;
                if !is_near || !points_along(a, -way) || !points_along(b, way) {
                    continue;
                }
                let between = Between { region: a.region, beyond: [a.beyond, b.beyond] };
                if matters(&between) {
                    let start = Start { length: way.length(), ends: [a.point, b.point], between };
                    self.insert(a.ends.clone(), b.ends.clone(), start, grid.size);
                }
            }
        }
    }

    /// Adds a place to start from, unless there are enough shorter ones.
    fn insert(&mut self, first: Ends, second: Ends, start: Start, apart: f64) {
        let Start { between, mut ends, .. } = start;
        let key = match first <= second {
            true => (between.region, first, second),
            false => {
                ends.swap(0, 1);
                (between.region, second, first)
            }
        };
        let beyond = if ends == start.ends { between.beyond } else { [between.beyond[1], between.beyond[0]] };
        let start = Start { ends, between: Between { beyond, ..between }, ..start };
        let kept = self.starts.entry(key).or_default();
        let is_beside = |a: &Start, b: &Start| (a.ends[0] - b.ends[0]).length() < apart;
        keep_smallest(kept, start, PER_PAIR, |start| start.length, is_beside);
    }

    /// The shortest ways below a limit that depends on the regions, the shortest first.
    pub fn found<E: Evaluator>(
        &mut self,
        evaluator: &E,
        limit: &impl Fn(&Between) -> f64,
        scratch: &mut E::Scratch,
    ) -> Vec<Facing> {
        let mut pairs: Vec<(&Pair, &Vec<Start>)> = self.starts.iter().collect();
        pairs.sort_by(|a, b| a.1[0].length.total_cmp(&b.1[0].length).then(a.0.cmp(b.0)));
        self.left_out += pairs.len().saturating_sub(MAX_PAIRS) as u64;
        let mut found: Vec<Facing> = Vec::new();
        let scale = self.frame.size().length();
        let mut budget = Budget::of(IN_STARTS);
        for ((_, first, second), starts) in pairs.into_iter().take(MAX_PAIRS) {
            let strata = [self.surfaces.stratum(first), self.surfaces.stratum(second)];
            for start in starts {
                if !budget.takes(WORK_OF_START) {
                    self.left_out += 1;
                    continue;
                }
                let Some(place) = closest(&strata, start.ends, STEP * scale) else { continue };
                if place.distance >= limit(&start.between) {
                    continue;
                }
                let faces = [self.surfaces.faces(first), self.surfaces.faces(second)];
                let Some(units) = units(&strata, place.ends) else { continue };
                if !budget.takes(WORK_OF_VERIFICATION * self.leaves) {
                    self.left_out += 1;
                    continue;
                }
                let units = [units[0].as_slice(), units[1].as_slice()];
                found.extend(verified(evaluator, &place, start.between, units, faces, scale, scratch));
            }
        }
        found.sort_by(|a, b| {
            let number = |facing: &Facing| facing.faces[0].len() + facing.faces[1].len();
            let [x, y] = [a, b].map(|facing| facing.across.chord.length());
            x.total_cmp(&y).then(number(a).cmp(&number(b)))
        });
        found
    }
}

impl Search<'_> {
    /// The shortest way between the two faces of a chord, near the chord; `None` if it is not there, for example beyond the end of a
    /// face.
    pub fn between_faces<E: Evaluator>(
        &mut self,
        evaluator: &E,
        chord: MeasuredChord,
        scratch: &mut E::Scratch,
    ) -> Option<(Closest, RegionId)> {
        let (faces, region) = self.faces_of(evaluator, chord, scratch)?;
        let ends = faces.map(|number| Ends::Common(vec![number]));
        let strata = [self.surfaces.stratum(&ends[0]), self.surfaces.stratum(&ends[1])];
        let scale = self.frame.size().length();
        let place = closest(&strata, [chord.from, chord.to], STEP * scale)?;
        let is_there = place.distance <= place.tolerance
            || joined(evaluator, region, place.chord(), place.tolerance, scratch).is_some();
        is_there.then_some((place, region))
    }

    /// True if a narrow place of a region is at one of its edges, and no wall: its faces meet at an angle beside it, or are as near to
    /// each other as rounding allows.
    pub fn is_edge<E: Evaluator>(
        &mut self,
        evaluator: &E,
        across: &Across,
        scratch: &mut E::Scratch,
    ) -> bool {
        let chord = across.chord;
        if self.is_rounding(across) {
            return true;
        }
        self.between_faces(evaluator, chord, scratch).is_some_and(|(place, _)| {
            let is_beside = (place.ends[0] - across.middle()).length() <= 16.0 * chord.length();
            is_beside && place.distance <= place.tolerance && !place.is_tangent
        })
    }

    /// True for a chord as short as rounding or, between faces that are not parallel, a width of this size, which depends on the
    /// distance from the origin as well: near the edge of a wedge, no other faces are as near to each other.
    fn is_rounding(&self, across: &Across) -> bool {
        let far = across.middle().length() + self.diagonal;
        let is_parallel = (across.normals[0] + across.normals[1]).length() <= LEAST_ANGLE;
        across.chord.length() <= SHORTEST * self.frame.size().length()
            || !is_parallel && across.width(Faces::Wall) <= SHORTEST * far
    }

    /// The numbers of the surfaces at the ends of a chord, and its region.
    fn faces_of<E: Evaluator>(
        &mut self,
        evaluator: &E,
        chord: MeasuredChord,
        scratch: &mut E::Scratch,
    ) -> Option<([usize; 2], RegionId)> {
        let middle = 0.5 * (chord.from + chord.to);
        let region = regions_at(evaluator, std::iter::once(middle), scratch)[0];
        let ray = Ray::new(middle, (chord.to - chord.from).try_normalize()?);
        let crossings = joined(evaluator, region, chord, f64::INFINITY, scratch)?;
        let grid = Grid::new(&self.frame, &self.frame);
        let mut number = |crossing: &Crossing| {
            let normal = attributes::normal(evaluator.program(), &ray, crossing);
            self.surfaces.number(crossing.face, ray.at(crossing.t), normal, &grid)
        };
        Some(([number(&crossings[0])?, number(&crossings[1])?], region))
    }
}

fn units(strata: &[super::stratum::Stratum<'_>; 2], ends: [Vec3; 2]) -> Option<[Vec<Vec3>; 2]> {
    Some([strata[0].project(ends[0])?.1, strata[1].project(ends[1])?.1])
}

/// True if an edge or corner may be the end of a way out of the region along a direction: apart from the direction along the edge, it
/// is within the cone of the normals, or a little outside.
fn points_along(feature: &Feature, way: Vec3) -> bool {
    /// The sine of 30 degrees: the place to start from is beside the shortest way.
    const SLACK: f64 = 0.5;
    let across = match *feature.normals.as_slice() {
        [a, b] => match a.cross(b).try_normalize() {
            Some(edge) => way - way.dot(edge) * edge,
            None => way,
        },
        _ => way,
    };
    let Some(unit) = across.try_normalize() else { return false };
    feature.outward().iter().any(|outward| outward.dot(unit) > 1.0 - 0.5 * SLACK * SLACK)
}

/// Directions around an axis: rings at these heights, and the axis itself.
fn around(axis: Vec3, heights: &[f64]) -> Vec<Vec3> {
    /// The number of directions of a ring.
    const NUMBER: u32 = 16;
    let side = axis.any_orthonormal_vector();
    let other = axis.cross(side);
    let mut all = vec![axis];
    for &height in heights {
        let radius = (1.0 - height * height).sqrt();
        all.extend((0..NUMBER).map(|k| {
            let (sine, cosine) =
                libm::sincos(std::f64::consts::TAU * (f64::from(k) + 0.5) / f64::from(NUMBER));
            height * axis + radius * (cosine * side + sine * other)
        }));
    }
    all
}

/// The way as a wall or gap, if rays show that it is in the region and points show that the region fills the half-balls around its ends.
fn verified<E: Evaluator>(
    evaluator: &E,
    place: &Closest,
    between: Between,
    units: [&[Vec3]; 2],
    faces: [Vec<FaceKey>; 2],
    scale: f64,
    scratch: &mut E::Scratch,
) -> Option<Facing> {
    let [p, q] = place.ends;
    let chord = MeasuredChord { from: p, to: q };
    if place.distance <= place.tolerance {
        let across = Across::new(chord, [Vec3::ZERO; 2]);
        let is_contact = touches(evaluator, 0.5 * (p + q), between, place.tolerance, scratch);
        return is_contact.then_some(Facing { between, across, faces, is_contact: true });
    }
    let unit = (q - p) / place.distance;
    let crossings = joined(evaluator, between.region, chord, place.tolerance, scratch)?;
    // beside a smooth face the half-ball is filled up to its curvature
    let step =
        (1e-3 * place.distance).min(1e-6 * scale).max(64.0 * place.tolerance).min(0.25 * place.distance);
    let inward = around(unit, &[0.05, 0.2, 0.5, 0.85]);
    let points = inward.iter().map(|way| p + step * *way).chain(inward.iter().map(|way| q - step * *way));
    if regions_at(evaluator, points, scratch).iter().any(|region| *region != between.region) {
        return None;
    }
    let facing = |k: usize, faces: Vec<FaceKey>| -> Vec<FaceKey> {
        let is_facing =
            |number: &usize| units[k].get(*number).is_some_and(|own| own.dot(unit).abs() > FACING);
        let some: Vec<FaceKey> = (0..faces.len()).filter(is_facing).map(|number| faces[number]).collect();
        if some.is_empty() { faces } else { some }
    };
    let [first, second] = faces;
    let faces = [facing(0, first), facing(1, second)];
    let between = Between { beyond: [crossings[0].before, crossings[1].after], ..between };
    let across = Across::new(chord, [-unit, unit]);
    Some(Facing { between, across, faces, is_contact: false })
}

/// The crossings at the ends of a way, if a ray from its middle leaves the region there and nowhere before.
pub(super) fn joined<E: Evaluator>(
    evaluator: &E,
    region: RegionId,
    chord: MeasuredChord,
    tolerance: f64,
    scratch: &mut E::Scratch,
) -> Option<[Crossing; 2]> {
    let length = chord.length();
    let middle = 0.5 * (chord.from + chord.to);
    let mut batch = RayBatch::default();
    batch.push(Ray::new(middle, (chord.to - chord.from) / length));
    let mut found = None;
    let mut sink = |answer: RayAnswer<'_>| {
        found = span_around(&answer, |other| other == region).map(|[entry, exit]| [*entry, *exit]);
    };
    evaluator.crossings(batch.rays(), &Query::default(), scratch, &mut sink);
    let [entry, exit] = found?;
    let error = (entry.t + 0.5 * length).abs().max((exit.t - 0.5 * length).abs());
    // the ends of a way are at right angles to faces up to 1e-6, which changes its length by half the square, 5e-13
    (error <= 1e-9 * length + 16.0 * tolerance).then_some([entry, exit])
}

/// True if both regions beyond a way come as close to a point as can be resolved.
pub(super) fn touches<E: Evaluator>(
    evaluator: &E,
    point: Vec3,
    between: Between,
    tolerance: f64,
    scratch: &mut E::Scratch,
) -> bool {
    let step = (64.0 * tolerance).max(BESIDE * point.length());
    let all = around(Vec3::Z, &[-1.0, -0.9, -0.6, -0.3, 0.0, 0.3, 0.6, 0.9]);
    let regions = regions_at(evaluator, all.iter().map(|way| point + step * *way), scratch);
    between.beyond.iter().all(|beyond| regions.contains(beyond))
}

/// True if a region fills a single sector around a point of the edge in which the faces at the ends of a chord meet: the bottom of a
/// V-shaped notch. Where an edge of one part rests on a face of another, there are two sectors.
pub(super) fn is_crease<E: Evaluator>(
    evaluator: &E,
    point: Vec3,
    (across, region): (&Across, RegionId),
    tolerance: f64,
    scratch: &mut E::Scratch,
) -> bool {
    /// A sector as wide as 2.5 degrees has a point.
    const POINTS: u32 = 144;
    let Some(edge) = across.normals[0].cross(across.normals[1]).try_normalize() else { return false };
    // far from the rounding of the point, and near to it in relation to the chord
    let step = (64.0 * tolerance).max(BESIDE * point.length()).max(1e-3 * across.chord.length());
    let (side, other) = edge.any_orthonormal_pair();
    let points = (0..POINTS).map(|k| {
        let (sine, cosine) = libm::sincos(std::f64::consts::TAU * (f64::from(k) + 0.5) / f64::from(POINTS));
        point + step * (cosine * side + sine * other)
    });
    let is_inside: Vec<bool> =
        regions_at(evaluator, points, scratch).into_iter().map(|found| found == region).collect();
    let next = is_inside.iter().cycle().skip(1);
    is_inside.iter().zip(next).filter(|(here, next)| here != next).count() <= 2
}
