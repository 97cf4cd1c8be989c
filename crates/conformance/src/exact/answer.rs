//! Exact crossings of a ray, by the rules of coincidence: events at equal times happen together, a ray in a
//! surface is perturbed symbolically along the fixed direction w, and pieces within the tolerance are welded
//! once.

use super::along::{GREY, Span, SurfacePolynomial, Uncertain, delta, side_at};
use super::{Dyadic, Exact, Line, Root, Surface};
use rayweave_math::Vec3;

/// An exact crossing.
#[derive(Clone, Debug)]
pub struct Expected {
    /// The region before, counted from 1; 0 is the world.
    pub before: usize,
    /// The region after.
    pub after: usize,
    /// The time, rounded: that of the last of the crossings welded into one.
    pub t: f64,
    /// The range of times that a backward stable computation may give.
    pub times: (f64, f64),
    /// The leaves that it may belong to.
    pub leaves: Vec<usize>,
}

/// The coincidences on a ray.
#[derive(Clone, Copy, Debug, Default)]
pub struct Traits {
    /// It lies in a surface.
    pub lies: bool,
    /// It crosses several surfaces, or one that several leaves share, at one time.
    pub ties: bool,
    /// It touches a surface without crossing it.
    pub touches: bool,
}

/// The exact answer for a ray.
#[derive(Clone, Debug)]
pub struct Answer {
    /// The region at -inf.
    pub start: usize,
    /// The crossings.
    pub crossings: Vec<Expected>,
    /// The coincidences on the ray.
    pub traits: Traits,
}

impl Answer {
    /// The answer restricted to times from `-far` to `far`.
    pub fn within(mut self, far: f64) -> Answer {
        let passed = self.crossings.partition_point(|c| c.t < -far);
        if let Some(last) = self.crossings.drain(..passed).next_back() {
            self.start = last.after;
        }
        self.crossings.retain(|c| c.t < far);
        self
    }
}

/// All events at one time.
pub(super) struct Moment {
    pub(super) root: Root,
    pub(super) surfaces: Vec<usize>,
    leaves: Vec<usize>,
    /// The region before and after.
    regions: (usize, usize),
}

/// The computation for one ray.
pub(super) struct RayComputation<'a> {
    pub(super) exact: &'a Exact,
    pub(super) line: &'a Line,
    pub(super) along: Vec<SurfacePolynomial>,
    pub(super) moments: Vec<Moment>,
    start: (Vec<bool>, usize),
}

/// The answer for a ray through a model, or the reason why it is uncertain.
pub fn answer(exact: &Exact, line: &Line, span: &Span) -> Result<Answer, Uncertain> {
    let work = RayComputation::new(exact, line, span)?;
    let crossings = work.welded()?;
    Ok(Answer { start: work.start.1, crossings, traits: work.traits() })
}

impl<'a> RayComputation<'a> {
    pub(super) fn new(
        exact: &'a Exact,
        line: &'a Line,
        span: &Span,
    ) -> Result<RayComputation<'a>, Uncertain> {
        let along = exact
            .surfaces
            .iter()
            .map(|s| SurfacePolynomial::new(s, line, span))
            .collect::<Result<Vec<_>, _>>()?;
        let mut work = RayComputation { exact, line, along, moments: Vec::new(), start: (Vec::new(), 0) };
        work.sweep();
        Ok(work)
    }

    fn leaf_holds(&self, leaf: usize, negative: &[bool]) -> bool {
        let leaf = &self.exact.leaves[leaf];
        leaf.facets.iter().all(|&(surface, inside)| negative[surface] == inside) != leaf.complement
    }

    fn region(&self, leaves: &[bool]) -> usize {
        let last = self.exact.parts.iter().rposition(|(node, _)| node.holds(leaves));
        last.map_or(0, |k| k + 1)
    }

    fn medium(&self, region: usize) -> u32 {
        if region == 0 { 0 } else { self.exact.parts[region - 1].1 }
    }

    /// Computes all moments at which a leaf or region changes.
    fn sweep(&mut self) {
        let mut negative: Vec<bool> = self.along.iter().map(|a| a.changes.starts_negative).collect();
        let count = self.exact.leaves.len();
        let mut leaves: Vec<bool> = (0..count).map(|k| self.leaf_holds(k, &negative)).collect();
        let mut region = self.region(&leaves);
        self.start = (leaves.clone(), region);
        for (root, surfaces) in self.times() {
            surfaces.iter().for_each(|&s| negative[s] = !negative[s]);
            let now: Vec<bool> = (0..count).map(|k| self.leaf_holds(k, &negative)).collect();
            let changed: Vec<usize> = (0..count).filter(|&k| now[k] != leaves[k]).collect();
            leaves = now;
            let before = std::mem::replace(&mut region, self.region(&leaves));
            self.moments.push(Moment { root, surfaces, leaves: changed, regions: (before, region) });
        }
    }

    /// The distinct times with the surfaces crossed at each.
    fn times(&self) -> Vec<(Root, Vec<usize>)> {
        let roots = |(k, along): (usize, &SurfacePolynomial)| {
            along.changes.roots.iter().map(move |root| (root.clone(), k)).collect::<Vec<_>>()
        };
        let mut all: Vec<(Root, usize)> = self.along.iter().enumerate().flat_map(roots).collect();
        all.sort_by(|a, b| a.0.compare(&b.0));
        let mut times: Vec<(Root, Vec<usize>)> = Vec::new();
        for (root, surface) in all {
            match times.last_mut() {
                Some((last, surfaces)) if last.compare(&root).is_eq() => surfaces.push(surface),
                _ => times.push((root, vec![surface])),
            }
        }
        times
    }

    /// The surfaces in which leaves change at a moment.
    fn crossed(&self, moment: &Moment) -> Vec<usize> {
        let owns = |s: &usize| {
            moment.leaves.iter().any(|&leaf| self.exact.leaves[leaf].facets.iter().any(|f| f.0 == *s))
        };
        moment.surfaces.iter().copied().filter(owns).collect()
    }

    /// True if the medium changes at a moment.
    fn is_change(&self, k: usize) -> bool {
        let (before, after) = self.moments[k].regions;
        self.medium(before) != self.medium(after)
    }

    /// The crossings after the weld.
    fn welded(&self) -> Result<Vec<Expected>, Uncertain> {
        let mut crossings = Vec::new();
        let mut run: Vec<usize> = Vec::new();
        for change in (0..self.moments.len()).filter(|&k| self.is_change(k)) {
            if let Some(&last) = run.last()
                && !self.coincide(last, change)?
            {
                crossings.extend(self.crossing(&run)?);
                run.clear();
            }
            run.push(change);
        }
        crossings.extend(self.crossing(&run)?);
        Ok(crossings)
    }

    /// The last of the moments next to `k`, in the given order, that change the region but not the medium,
    /// such that each piece on the way is within the tolerance of the surfaces at its ends.
    fn adjacent(&self, k: usize, order: impl Iterator<Item = usize>) -> Result<usize, Uncertain> {
        let mut last = k;
        for next in order.filter(|&k| self.moments[k].regions.0 != self.moments[k].regions.1) {
            if self.is_change(next) || !self.coincide(last.min(next), last.max(next))? {
                break;
            }
            last = next;
        }
        Ok(last)
    }

    /// True if different surfaces are crossed at a moment without a change of medium: with rounding errors
    /// they may be crossed one after the other, with a change and its inverse.
    fn is_balanced(&self, k: usize) -> bool {
        let (moment, all) = (&self.moments[k], &self.exact.surfaces);
        let first = moment.surfaces[0];
        !self.is_change(k)
            && moment.leaves.len() > 1
            && moment.surfaces.iter().any(|&s| !all[s].is_same(&all[first]))
    }

    /// The balanced moments next to `k`, in the given order, that lie in the same surfaces as `k`: if
    /// rounding separates their crossings, these are welded to it.
    fn balanced_adjacent(
        &self,
        k: usize,
        order: impl Iterator<Item = usize>,
    ) -> Result<Vec<usize>, Uncertain> {
        let mut found = Vec::new();
        for next in order.take_while(|&next| !self.is_change(next)).filter(|&next| self.is_balanced(next)) {
            if !self.coincide(k.min(next), k.max(next))? {
                break;
            }
            found.push(next);
        }
        Ok(found)
    }

    /// True if the piece between two moments lies within the tolerance of the surfaces at both its ends.
    fn coincide(&self, i: usize, j: usize) -> Result<bool, Uncertain> {
        let (a, b) = (&self.moments[i], &self.moments[j]);
        let times = self.samples(&a.root, &b.root);
        let deepest = |s: &usize| {
            let one = |t| self.along[*s].depth(&self.exact.surfaces[*s], self.line, t);
            times.iter().map(one).fold(0.0, f64::max)
        };
        let (mut far, mut near) = (false, true);
        for moment in [a, b] {
            let depths: Vec<f64> = self.crossed(moment).iter().map(deepest).collect();
            far |= depths.iter().all(|&d| d > GREY);
            near &= depths.iter().all(|&d| d * GREY < 1.0);
        }
        // a piece close to a face of a mesh from which it leaves through another one is close to the mesh
        if far && [a, b].into_iter().any(|moment| self.mesh_faces(moment).any(|s| deepest(&s) <= GREY)) {
            return Err(Uncertain::Depth);
        }
        if far == near { Err(Uncertain::Depth) } else { Ok(near) }
    }

    /// The faces of the meshes whose sides change at a moment, except those in which the ray lies.
    fn mesh_faces(&self, moment: &Moment) -> impl Iterator<Item = usize> {
        let meshes = moment.leaves.iter().map(|&leaf| &self.exact.leaves[leaf]).filter(|leaf| leaf.is_mesh);
        let faces = meshes.flat_map(|leaf| leaf.facets.iter().map(|facet| facet.0));
        faces.filter(|&s| !self.along[s].lies)
    }

    /// Sample times of a piece: its ends, quarters, and around the point nearest to the start of the ray.
    fn samples(&self, a: &Root, b: &Root) -> Vec<Dyadic> {
        let (a, b) = (a.approximation().rounded(), b.approximation().rounded());
        let part = |k: f64| &a + &(&Dyadic::from(k) * &(&b - &a));
        let mut times = vec![a.clone(), part(0.25), part(0.5), part(0.75), b.clone()];
        let (first, last) = (a.to_f64(), b.to_f64());
        let nearest = if first > 0.0 { first } else { last.min(0.0) };
        let length = self.line.ray.origin.length().max(1.0) / self.line.ray.direction.length();
        let here = [nearest, nearest - length, nearest + length].map(|t| t.max(first).min(last));
        times.extend(here.into_iter().filter(|_| last - first > length).map(Dyadic::from));
        times
    }

    fn crossing(&self, run: &[usize]) -> Result<Option<Expected>, Uncertain> {
        let Some((&first, &last)) = run.first().zip(run.last()) else {
            return Ok(None);
        };
        let (before, after) = (self.moments[first].regions.0, self.moments[last].regions.1);
        if self.medium(before) == self.medium(after) {
            return Ok(None);
        }
        let before = self.moments[self.adjacent(first, (0..first).rev())?].regions.0;
        let after = self.moments[self.adjacent(last, last + 1..self.moments.len())?].regions.1;
        let mut times = (f64::INFINITY, f64::NEG_INFINITY);
        let earlier = self.balanced_adjacent(first, (0..first).rev())?;
        let later = self.balanced_adjacent(last, last + 1..self.moments.len())?;
        for &k in earlier.iter().chain(run).chain(&later) {
            let root = &self.moments[k].root;
            for s in self.crossed(&self.moments[k]) {
                let surface = &self.exact.surfaces[s];
                let time_error =
                    self.along[s].time_error(surface, self.line, root, delta(surface, self.line, root.t()));
                times = (times.0.min(root.t() - time_error), times.1.max(root.t() + time_error));
            }
        }
        let (t, leaves) = (self.moments[last].root.t(), self.owners(run, times));
        Ok(Some(Expected { before, after, t, times, leaves }))
    }

    /// The leaves that a crossing may belong to. Where several surfaces coincide at a time, rounding may make any leaf
    /// with one of them change and change back. Where there is a single surface, it is the lowest leaf whose event
    /// alone changes the medium before, or whose event undone changes the medium after, or if there is none the first
    /// that changes it when they change one after the other.
    fn owners(&self, run: &[usize], times: (f64, f64)) -> Vec<usize> {
        let about = self.moments.iter().filter(|m| times.0 <= m.root.t() && m.root.t() <= times.1);
        let mut surfaces: Vec<usize> = about.flat_map(|m| m.surfaces.clone()).collect();
        surfaces.extend(self.touched(times));
        let all = &self.exact.surfaces;
        if surfaces.iter().all(|&s| all[s].is_same(&all[surfaces[0]])) && run.len() == 1 {
            return vec![self.lowest(run[0])];
        }
        let meets = |leaf: &usize| self.exact.leaves[*leaf].facets.iter().any(|f| surfaces.contains(&f.0));
        (0..self.exact.leaves.len()).filter(meets).collect()
    }

    /// The surfaces that, in a range of times, come so close to the ray that rounding may cross them twice.
    fn touched(&self, (from, to): (f64, f64)) -> Vec<usize> {
        let touched = |&s: &usize| {
            let (surface, along) = (&self.exact.surfaces[s], &self.along[s]);
            along
                .touch(surface, self.line)
                .is_some_and(|(t, time_error)| t - time_error <= to && from <= t + time_error)
        };
        (0..self.along.len()).filter(touched).collect()
    }

    fn lowest(&self, k: usize) -> usize {
        let moment = &self.moments[k];
        let mut leaves = self.start.0.clone();
        let changes = self.moments[..k].iter().flat_map(|m| &m.leaves);
        changes.for_each(|&leaf| leaves[leaf] = !leaves[leaf]);
        let before = leaves.clone();
        moment.leaves.iter().for_each(|&leaf| leaves[leaf] = !leaves[leaf]);
        let changes = |leaf: usize, state: &[bool]| {
            let mut toggled = state.to_vec();
            toggled[leaf] = !toggled[leaf];
            self.medium(self.region(&toggled)) != self.medium(self.region(state))
        };
        let candidate = |leaf: &&usize| changes(**leaf, &before) || changes(**leaf, &leaves);
        if let Some(&leaf) = moment.leaves.iter().find(candidate) {
            return leaf;
        }
        let mut now = before;
        let in_turn = moment.leaves.iter().find(|&&leaf| {
            let matters = changes(leaf, &now);
            now[leaf] = !now[leaf];
            matters
        });
        *in_turn.unwrap_or(&moment.leaves[0])
    }

    fn traits(&self) -> Traits {
        let surfaces = &self.exact.surfaces;
        let touch =
            |a: &SurfacePolynomial| !a.lies && !a.coefficients[0].is_zero() && a.changes.roots.is_empty();
        let touching =
            |(k, a): (usize, &SurfacePolynomial)| touch(a) && a.extremum(&surfaces[k], self.line) == 0.0;
        Traits {
            lies: self.along.iter().any(|a| a.lies),
            ties: self.moments.iter().any(|m| m.leaves.len() > 1 || m.surfaces.len() > 1),
            touches: self.along.iter().enumerate().any(touching),
        }
    }
}

/// The region that contains a point; on a surface, that on the side along w. `None` if the point is so close
/// to a surface that rounding may put it on either side, or if w does not determine the side.
pub fn region_at(exact: &Exact, point: Vec3) -> Option<usize> {
    let line = Line::new(rayweave_shape::Ray::new(point, Vec3::X));
    let side = |surface: &Surface| {
        let value = surface.value(&line.at(&Dyadic::ZERO));
        if value.is_zero() {
            // the engine's surface is rounded and may not contain the point
            if surface.is_rounded() {
                return None;
            }
            return side_at(surface, &line, &Dyadic::ZERO, 0.0).ok();
        }
        let clear =
            value.to_f64().abs() > surface.slope(&line.at(&Dyadic::ZERO)) * delta(surface, &line, 0.0);
        clear.then(|| value.sign() < 0)
    };
    let negative = exact.surfaces.iter().map(side).collect::<Option<Vec<bool>>>()?;
    let work =
        RayComputation { exact, line: &line, along: Vec::new(), moments: Vec::new(), start: (Vec::new(), 0) };
    let leaves: Vec<bool> = (0..exact.leaves.len()).map(|k| work.leaf_holds(k, &negative)).collect();
    Some(work.region(&leaves))
}
