//! Distances of a ray from edges and tangencies, where rounding may change the answer.

use super::along::{Span, SurfacePolynomial, TANGENT_SHIFT, delta, distance};
use super::answer::RayComputation;
use super::{Dyadic, Exact, Line, Root, Uncertain};

/// Assumed errors of the kernels, as a fraction of `delta`: 4 u times the lengths in the equation, where `delta` is
/// 64 u times these lengths. The value is a choice of this test; no bound of the kernels is proved here.
const KERNEL_SHARE: f64 = 1.0 / 16.0;

/// The sensitivity of an answer to rounding errors.
#[derive(Clone, Copy, Debug)]
pub struct Sensitivity {
    /// The distance of the ray from the nearest edge (two surfaces at one time) or tangency.
    pub clearance: f64,
    /// True if two crossings may change order within their time errors, and one of the surfaces is farther than
    /// `delta` from the ray at an end of that interval. A correct computation may then report an extra piece
    /// that is not welded: the ray is *torn*. A ray that lies in a surface whose side changes is as far from that change as
    /// `w . grad f` is from 0, since that decides whether the piece is welded.
    pub order_uncertain: bool,
}

/// Computes the distance of a ray from the nearest edge or tangency, and whether the order of its crossings is
/// uncertain.
pub fn sensitivity(exact: &Exact, line: &Line, span: &Span) -> Result<Sensitivity, Uncertain> {
    Ok(RayComputation::new(exact, line, span)?.sensitivity())
}

impl RayComputation<'_> {
    fn sensitivity(&self) -> Sensitivity {
        let surfaces = &self.exact.surfaces;
        let extremum = |(k, along): (usize, &SurfacePolynomial)| along.extremum(&surfaces[k], self.line);
        let tangency = self.along.iter().enumerate().map(extremum).fold(f64::INFINITY, f64::min);
        Sensitivity { clearance: tangency.min(self.edge_distance()), order_uncertain: self.order_uncertain() }
    }

    /// All pairs of crossings of different surfaces.
    fn pairs(&self) -> impl Iterator<Item = ((usize, &Root), (usize, &Root))> {
        let events: Vec<(usize, &Root)> =
            self.moments.iter().flat_map(|m| m.surfaces.iter().map(move |&s| (s, &m.root))).collect();
        let pair = move |i: usize, j: usize| (events[i], events[j]);
        let count = self.moments.iter().map(|m| m.surfaces.len()).sum::<usize>();
        let surfaces = &self.exact.surfaces;
        (0..count)
            .flat_map(move |j| (0..j).map(move |i| (i, j)))
            .map(move |(i, j)| pair(i, j))
            .filter(|(a, b)| !surfaces[a.0].is_same(&surfaces[b.0]))
    }

    fn distance_at(&self, surface: usize, t: &Dyadic) -> f64 {
        distance(&self.exact.surfaces[surface], &self.along[surface].coefficients, self.line, t)
    }

    fn edge_distance(&self) -> f64 {
        let both = |(a, b): ((usize, &Root), (usize, &Root))| {
            self.distance_at(b.0, a.1.approximation()).min(self.distance_at(a.0, b.1.approximation()))
        };
        self.pairs().map(both).fold(f64::INFINITY, f64::min)
    }

    /// All crossings, and all contacts that rounding may turn into two crossings, as (surface, time, bound of the
    /// time error of the kernels).
    fn events_with_error(&self) -> Vec<(usize, f64, f64)> {
        let bound = |s: usize, t: f64| KERNEL_SHARE * delta(&self.exact.surfaces[s], self.line, t);
        let mut all: Vec<(usize, f64, f64)> = Vec::new();
        for moment in &self.moments {
            let t = moment.root.t();
            let time_error = |s: usize| {
                self.along[s].time_error(&self.exact.surfaces[s], self.line, &moment.root, bound(s, t))
            };
            all.extend(moment.surfaces.iter().map(|&s| (s, t, time_error(s))));
        }
        for (s, along) in self.along.iter().enumerate() {
            let surface = &self.exact.surfaces[s];
            let [a, b, _] = &along.coefficients;
            let is_tangent = || !a.is_zero() && along.extremum(surface, self.line) <= bound(s, 0.0);
            if along.changes.roots.is_empty() && is_tangent() {
                let middle = (-b).over(&a.scaled(1));
                let t = middle.to_f64();
                let error = bound(s, t) * surface.slope(&self.line.at(&middle.rounded()));
                all.push((s, t, TANGENT_SHIFT * (error / a.to_f64().abs()).sqrt()));
            }
        }
        all
    }

    fn order_uncertain(&self) -> bool {
        let events = self.events_with_error();
        let surfaces = &self.exact.surfaces;
        let may_swap = |&(a, ta, pa): &(usize, f64, f64), &(b, tb, pb): &(usize, f64, f64)| {
            let ends = [ta - pa, tb - pb, ta + pa, tb + pb].map(Dyadic::from);
            let far = |s: usize| ends.iter().any(|t| self.along[s].depth(&surfaces[s], self.line, t) > 1.0);
            (ta - tb).abs() <= pa + pb && !surfaces[a].is_same(&surfaces[b]) && (far(a) || far(b))
        };
        events.iter().enumerate().any(|(k, a)| events[..k].iter().any(|b| may_swap(a, b)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::{Map, Part, Shape, Tree};
    use rayweave_math::{Affine, Vec3};
    use rayweave_model::Ball;
    use rayweave_shape::Ray;

    /// A ray that grazes an edge of a prism where the plane z = 0 crosses it: rounding decides which of the two it crosses first.
    /// That plane may also be one of a pair, y z = 0, of which the ray lies in the other one.
    #[test]
    fn an_edge_met_while_grazing_is_torn_in_a_pair_of_planes_too() {
        let ray = Ray::new(Vec3::new(-0.999755859375, 0.0, 1.0), Vec3::new(-0.000244140625, 0.0, -1.0));
        let rows = [[0.0, 0.5, 0.0, 0.0], [0.5, 0.0, 0.0, 0.0], [0.0; 4], [0.0; 4]];
        let planes = Tree::Leaf(Shape::Quadric(rows, 0.0)).moved(Map::Turn(1, 1)).complement();
        let below = Tree::Leaf(Shape::HalfSpace([0.0, 0.0, 1.0], 0.0));
        let is_torn = |solid: Tree, ray: Ray| {
            let prism = Tree::Leaf(Shape::Prism(1.0, 1.0));
            let exact = Exact::new(&[Part { tree: Tree::Any(vec![prism, solid]), medium: 1 }]);
            let ball = Ball { centre: Vec3::ZERO, radius: 2.0, magnitude: 2.0 };
            let span = Span::new(&ray, &[(Affine::IDENTITY, ball)]);
            sensitivity(&exact, &Line::new(ray), &span).unwrap().order_uncertain
        };
        for solid in [planes, below] {
            assert!(is_torn(solid.clone(), ray), "{solid:?}");
            // a ray that enters at a slant, within the plane y = 0 as before, and one that passes inside the edge
            assert!(!is_torn(solid.clone(), Ray::new(Vec3::new(-2.0, 0.0, 1.0), Vec3::new(1.0, 0.0, -1.0))));
            assert!(!is_torn(solid, Ray::new(ray.origin + 0.5 * Vec3::X, ray.direction)));
        }
    }
}
