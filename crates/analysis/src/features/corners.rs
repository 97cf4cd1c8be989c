//! Fillets and chamfers: narrow faces on tori and cones, and on planes at an angle to two axes.

use super::spans::{Spans, spans_along};
use crate::distance::world_surfaces;
use rayweave_math::{Bounds, Vec3};
use rayweave_model::{Evaluator, Query, RayAnswer, RayBatch, attributes};
use rayweave_shape::Ray;
use rayweave_shape::surface::{Cone, Plane, Quadric, Surface, Torus};
use std::f64::consts::{PI, TAU};

/// A fillet or a chamfer with its size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CornerFace {
    /// The size.
    pub size: CornerSize,
    /// The position.
    pub place: CornerPlace,
}

/// The size of a fillet or a chamfer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CornerSize {
    /// A fillet or a rounding around an axis. Those along straight edges are
    /// [cylindrical faces](super::CylindricalFace).
    Fillet {
        /// The radius.
        radius: f64,
        /// The direction from the centre of the arc to its middle, away from the axis and along it.
        middle: [f64; 2],
        /// Half the angle of the arc, in radians.
        half_angle: f64,
    },
    /// A chamfer.
    Chamfer {
        /// The length along the axis of a cone, or along an axis of the model.
        length: f64,
        /// The angle to that axis, in degrees.
        angle: f64,
    },
}

/// The position of a fillet or a chamfer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CornerPlace {
    /// Around an axis: the circle through the middles of a chamfer, or through the centres of the arcs of a fillet.
    Ring {
        /// The centre of the circle.
        centre: Vec3,
        /// The unit vector along the axis.
        axis: Vec3,
        /// The radius of the circle.
        radius: f64,
    },
    /// Along a straight edge.
    Edge {
        /// The middle of the face.
        middle: Vec3,
        /// The unit vector along the edge: that of x, y or z.
        along: Vec3,
    },
}

/// The greatest number of surfaces of each kind that are examined.
const MAX_SURFACES: usize = 500;

/// The lines around an axis or along an edge, and the directions around the tube of a torus.
const LINES: usize = 24;
const AROUND: usize = 48;

/// The distance of lines from a surface, the least length of a face, and the distance of equal points, relative to the size of the model.
const OFFSET: f64 = 1e-9;
const LEAST: f64 = 1e-5;
const EQUAL: f64 = 1e-7;

/// Wider faces, relative to the size of the model, are no chamfers; neither are those at less than this angle to the axis, in degrees.
const WIDEST: f64 = 0.15;
const LEAST_ANGLE: f64 = 10.0;

/// Finds the fillets and chamfers of a bounded model: fillets around an axis, and chamfers around an axis or along an axis of the model.
///
/// ```
/// use rayweave_analysis::features::{CornerSize, corner_faces};
/// use rayweave_trace::AnyEvaluator;
///
/// let (_, scene) = rayweave_scene::parse(
///     "rayweave = 1\n[solid.pin.revolve]\noutline = [[0, 0], [5, 0], { at = [5, 20], chamfer = 0.5 }, [0, 20]]",
/// )?;
/// let evaluator = AnyEvaluator::new(None, rayweave_scene::Compiled::new(&scene)?.program)?;
/// let found = corner_faces(&evaluator);
/// let CornerSize::Chamfer { length, angle } = found[0].size else { panic!("a chamfer") };
/// assert!((length - 0.5).abs() < 1e-6 && (angle - 45.0).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn corner_faces<E: Evaluator>(evaluator: &E) -> Vec<CornerFace> {
    let bounds = evaluator.program().bounds();
    if bounds.is_empty() || !bounds.is_finite() {
        return Vec::new();
    }
    let size = bounds.size().max_element();
    let mut search = Search { evaluator, bounds: &bounds, size, scratch: evaluator.scratch() };
    let (mut found, mut counts): (Vec<CornerFace>, [usize; 3]) = (Vec::new(), [0; 3]);
    for surface in world_surfaces(evaluator.program()).unwrap_or_default() {
        let cone = match &surface {
            Surface::Cone(cone) => Some(*cone),
            Surface::Quadric(quadric) => cone_of(quadric),
            _ => None,
        };
        let kind = match (&surface, cone) {
            (_, Some(_)) => 0,
            (Surface::Torus(_), _) => 1,
            (Surface::Plane(_), _) => 2,
            _ => continue,
        };
        counts[kind] += 1;
        if counts[kind] > MAX_SURFACES {
            continue;
        }
        let own = match (&surface, cone) {
            (_, Some(cone)) => search.on_cone(&cone),
            (Surface::Torus(torus), _) => search.on_torus(torus).into_iter().collect(),
            (Surface::Plane(plane), _) => search.on_plane(plane),
            _ => Vec::new(),
        };
        for face in own {
            if !found.iter().any(|known| known.is_like(&face, EQUAL * size)) {
                found.push(face);
            }
        }
    }
    found
}

/// The cone of revolution that a quadric is.
fn cone_of(quadric: &Quadric) -> Option<Cone> {
    const ROUNDING: f64 = 1e-12;
    let weights = quadric.weights;
    let is_centred = quadric.linear == Vec3::ZERO && quadric.constant == 0.0;
    (0..3).filter(|_| is_centred).find_map(|axis| {
        let [one, two] = [1, 2].map(|k| weights[(axis + k) % 3]);
        let squared = -weights[axis] / one;
        ((one - two).abs() <= ROUNDING * one.abs() && squared > 0.0).then(|| Cone {
            apex: quadric.centre,
            axis: quadric.axes[axis],
            slope: libm::sqrt(squared),
        })
    })
}

impl CornerFace {
    /// True if another face is the same to rounding.
    fn is_like(&self, other: &CornerFace, tolerance: f64) -> bool {
        let is_near = |a: f64, b: f64| (a - b).abs() < tolerance;
        let is_same_size = match (self.size, other.size) {
            (CornerSize::Fillet { radius: a, .. }, CornerSize::Fillet { radius: b, .. }) => is_near(a, b),
            (CornerSize::Chamfer { length: a, .. }, CornerSize::Chamfer { length: b, .. }) => is_near(a, b),
            _ => false,
        };
        is_same_size
            && match (self.place, other.place) {
                (
                    CornerPlace::Ring { centre: a, radius: r, .. },
                    CornerPlace::Ring { centre: b, radius: s, .. },
                ) => (a - b).length() < tolerance && is_near(r, s),
                (CornerPlace::Edge { middle: a, .. }, CornerPlace::Edge { middle: b, .. }) => {
                    (a - b).length() < tolerance
                }
                _ => false,
            }
    }
}

/// A piece of a line along which a surface separates material from space.
#[derive(Clone, Copy)]
struct Stretch {
    line: usize,
    ends: [f64; 2],
}

struct Search<'a, E: Evaluator> {
    evaluator: &'a E,
    bounds: &'a Bounds,
    size: f64,
    scratch: E::Scratch,
}

impl<E: Evaluator> Search<'_, E> {
    fn spans(&mut self, rays: impl Iterator<Item = Ray>) -> Vec<Spans> {
        spans_along(self.evaluator, &rays.collect(), &mut self.scratch)
    }

    /// The pieces of lines in a surface, given by points, directions and normals, that have material on one side only. Pieces at equal
    /// places on at least `least` lines are one; short ones are left out.
    fn stretches(&mut self, lines: &[(Vec3, Vec3, Vec3)], least: usize) -> Vec<Stretch> {
        let by = OFFSET * self.size;
        let rays = lines.iter().flat_map(|&(p, d, n)| [Ray::new(p - by * n, d), Ray::new(p + by * n, d)]);
        let spans = self.spans(rays);
        let mut found: Vec<Stretch> = Vec::new();
        for (line, pair) in spans.chunks_exact(2).enumerate() {
            let mut ends: Vec<f64> = pair[0].ends().chain(pair[1].ends()).collect();
            ends.sort_by(f64::total_cmp);
            let is_piece = |ends: &&[f64]| {
                let middle = 0.5 * (ends[0] + ends[1]);
                ends[1] - ends[0] > LEAST * self.size && pair[0].is_in(middle) != pair[1].is_in(middle)
            };
            let pieces = ends.windows(2).filter(is_piece);
            found.extend(pieces.map(|ends| Stretch { line, ends: [ends[0], ends[1]] }));
        }
        let is_like = |a: &Stretch, b: &Stretch| {
            (0..2).all(|k| (a.ends[k] - b.ends[k]).abs() < 100.0 * EQUAL * self.size)
        };
        let is_first = |(k, own): &(usize, &Stretch)| !found[..*k].iter().any(|other| is_like(own, other));
        let is_often = |own: &&Stretch| found.iter().filter(|other| is_like(own, other)).count() >= least;
        found.iter().enumerate().filter(is_first).map(|(_, own)| own).filter(is_often).copied().collect()
    }

    fn on_cone(&mut self, cone: &Cone) -> Vec<CornerFace> {
        let angle = libm::atan(cone.slope);
        let (sin, cos) = (libm::sin(angle), libm::cos(angle));
        if !(LEAST_ANGLE..=90.0 - LEAST_ANGLE).contains(&angle.to_degrees()) {
            return Vec::new();
        }
        let out = directions(cone.axis, LINES);
        let lines: Vec<(Vec3, Vec3, Vec3)> = out
            .iter()
            .map(|&out| (cone.apex, sin * out + cos * cone.axis, cos * out - sin * cone.axis))
            .collect();
        let (size, least) = (self.size, LEAST * self.size);
        let found = self.stretches(&lines, LINES / 4);
        // the tip of a drilled hole is no chamfer
        let is_chamfer = |own: &&Stretch| {
            let [from, to] = own.ends;
            to - from < WIDEST * size && from.abs().min(to.abs()) > least && from * to > 0.0
        };
        let face = |own: &Stretch| {
            let [from, to] = own.ends;
            let middle = 0.5 * (from + to);
            let (centre, radius) = (cone.apex + middle * cos * cone.axis, middle.abs() * sin);
            CornerFace {
                size: CornerSize::Chamfer { length: cos * (to - from), angle: angle.to_degrees() },
                place: CornerPlace::Ring { centre, axis: cone.axis, radius },
            }
        };
        found.iter().filter(is_chamfer).map(face).collect()
    }

    fn on_torus(&mut self, torus: &Torus) -> Option<CornerFace> {
        const CIRCLES: usize = 8;
        let out = directions(torus.axis, CIRCLES);
        let angle = |k: usize| TAU * (k as f64 + 0.37) / AROUND as f64;
        let rays = (0..AROUND).flat_map(|k| {
            let (sin, cos) = (libm::sin(angle(k)), libm::cos(angle(k)));
            out.iter()
                .map(move |&out| Ray::new(torus.centre + torus.major * out, cos * out + sin * torus.axis))
        });
        let rays: Vec<Ray> = rays.collect();
        let spans = self.spans(rays.into_iter());
        let tolerance = EQUAL * self.size;
        let is_there = |spans: &&Spans| spans.ends().any(|t| (t - torus.minor).abs() < tolerance);
        let is_face = |circles: &&[Spans]| 2 * circles.iter().filter(is_there).count() >= CIRCLES;
        let there: Vec<f64> = spans
            .chunks_exact(CIRCLES)
            .enumerate()
            .filter(|(_, circles)| is_face(circles))
            .map(|(k, _)| angle(k))
            .collect();
        let share = there.len() as f64 / AROUND as f64;
        // half of a turn is the end of a groove, more a ring
        if !(2.0 / AROUND as f64..=0.55).contains(&share) {
            return None;
        }
        let sum = |of: fn(f64) -> f64| there.iter().map(|&angle| of(angle)).sum::<f64>();
        let middle = [sum(libm::cos), sum(libm::sin)];
        let length = libm::hypot(middle[0], middle[1]);
        let middle = middle.map(|part| part / length.max(f64::MIN_POSITIVE));
        Some(CornerFace {
            size: CornerSize::Fillet { radius: torus.minor, middle, half_angle: PI * share },
            place: CornerPlace::Ring { centre: torus.centre, axis: torus.axis, radius: torus.major },
        })
    }

    /// Chamfers along an axis of the model, between faces along the other two.
    fn on_plane(&mut self, plane: &Plane) -> Vec<CornerFace> {
        let normal = plane.normal;
        let Some(axis) = (0..3).find(|&k| normal[k].abs() < 1e-12) else { return Vec::new() };
        let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
        let least = libm::sin(LEAST_ANGLE.to_radians());
        if normal[u].abs().min(normal[v].abs()) < least {
            return Vec::new();
        }
        let along = Vec3::AXES[axis];
        let direction = along.cross(normal);
        let (lo, length) = (self.bounds.lo[axis], self.bounds.size()[axis]);
        let point =
            |k: usize| plane.offset * normal + (lo + length * (k as f64 + 0.37) / LINES as f64) * along;
        let lines: Vec<(Vec3, Vec3, Vec3)> = (0..LINES).map(|k| (point(k), direction, normal)).collect();
        let mut faces = Vec::new();
        for Stretch { line, ends: [from, to] } in self.stretches(&lines, 2) {
            let start = lines[line].0;
            let width = to - from;
            let beyond = 0.01 * width;
            let beside = [from - beyond, to + beyond].map(|t| start + t * direction);
            let neighbours = beside.map(|point| self.axis_of_face(point, normal, width));
            let is_chamfer = matches!(neighbours, [Some(a), Some(b)] if a != b && a != axis && b != axis);
            if width < WIDEST * self.size && is_chamfer {
                // along the axis on which both legs are longer, at less than 45 degrees to it
                let [long, short] = match direction[u].abs() >= direction[v].abs() {
                    true => [direction[u].abs(), direction[v].abs()],
                    false => [direction[v].abs(), direction[u].abs()],
                };
                let angle = libm::atan2(short, long).to_degrees();
                faces.push(CornerFace {
                    size: CornerSize::Chamfer { length: long * width, angle },
                    place: CornerPlace::Edge { middle: start + 0.5 * (from + to) * direction, along },
                });
            }
        }
        faces
    }

    /// The axis of the normal of the face nearest to a point along a direction.
    fn axis_of_face(&mut self, point: Vec3, direction: Vec3, reach: f64) -> Option<usize> {
        let ray = Ray::new(point, direction);
        let mut batch = RayBatch::default();
        batch.push(ray);
        let (program, mut found) = (self.evaluator.program(), None);
        let mut sink = |answer: RayAnswer<'_>| {
            let nearest = answer.crossings.iter().min_by(|a, b| a.t.abs().total_cmp(&b.t.abs()));
            found = nearest
                .filter(|crossing| crossing.t.abs() < reach)
                .map(|crossing| attributes::normal(program, &ray, crossing));
        };
        self.evaluator.crossings(batch.rays(), &Query::default(), &mut self.scratch, &mut sink);
        let normal = found?;
        (0..3).find(|&k| normal[k].abs() > 1.0 - 1e-9)
    }
}

/// Unit vectors at equal angles around an axis, beside the axes of the model, where seams are likely.
fn directions(axis: Vec3, count: usize) -> Vec<Vec3> {
    let flat = [0, 1, 2].into_iter().min_by(|&a, &b| axis[a].abs().total_cmp(&axis[b].abs())).unwrap_or(0);
    let first = (Vec3::AXES[flat] - axis * axis[flat]).normalize_or_zero();
    let second = axis.cross(first);
    (0..count)
        .map(|k| {
            let angle = TAU * (k as f64 + 0.37) / count as f64;
            libm::cos(angle) * first + libm::sin(angle) * second
        })
        .collect()
}
