//! Distances of a ray from edges and tangencies, where rounding may change the answer.

use super::along::{Along, Span, delta, distance};
use super::answer::Work;
use super::{Dyadic, Exact, Line, Root, Uncertain};

/// The sensitivity of an answer to rounding errors.
#[derive(Clone, Copy, Debug)]
pub struct Scrutiny {
    /// The distance of the ray from the nearest edge (two surfaces at one time) or tangency.
    pub clearance: f64,
    /// True if two surfaces are crossed at nearly one time and at such different angles that a computation
    /// within the tolerance may find a piece between them that is not close to both.
    pub torn: bool,
}

/// Computes how close a ray comes to a change of the answer.
pub fn scrutiny(exact: &Exact, line: &Line, span: &Span) -> Result<Scrutiny, Uncertain> {
    Ok(Work::new(exact, line, span)?.scrutiny())
}

impl Work<'_> {
    fn scrutiny(&self) -> Scrutiny {
        let surfaces = &self.exact.surfaces;
        let extremum = |(k, along): (usize, &Along)| along.extremum(&surfaces[k], self.line);
        let tangency = self.along.iter().enumerate().map(extremum).fold(f64::INFINITY, f64::min);
        Scrutiny { clearance: tangency.min(self.edge_distance()), torn: self.torn() }
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
            self.distance_at(b.0, a.1.near()).min(self.distance_at(a.0, b.1.near()))
        };
        self.pairs().map(both).fold(f64::INFINITY, f64::min)
    }

    /// All crossings, and all contacts that rounding may turn into two crossings, as (surface, time, error
    /// bound of the time in the kernels, which stay well within the tolerance).
    fn played(&self) -> Vec<(usize, f64, f64)> {
        let bound = |s: usize, t: f64| delta(&self.exact.surfaces[s], self.line, t) / 16.0;
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
            if along.changes.roots.is_empty() && along.extremum(surface, self.line) <= bound(s, 0.0) {
                let middle = (-b).over(&a.scaled(1));
                let t = middle.to_f64();
                let error = bound(s, t) * surface.slope(&self.line.at(&middle.rounded()));
                all.push((s, t, 2.5 * (error / a.to_f64().abs()).sqrt()));
            }
        }
        all
    }

    fn torn(&self) -> bool {
        let events = self.played();
        let surfaces = &self.exact.surfaces;
        let torn = |&(a, ta, pa): &(usize, f64, f64), &(b, tb, pb): &(usize, f64, f64)| {
            let ends = [ta - pa, tb - pb, ta + pa, tb + pb].map(Dyadic::from);
            let far = |s: usize| {
                ends.iter().any(|t| self.distance_at(s, t) > delta(&surfaces[s], self.line, t.to_f64()))
            };
            (ta - tb).abs() <= pa + pb && !surfaces[a].is_same(&surfaces[b]) && (far(a) || far(b))
        };
        events.iter().enumerate().any(|(k, a)| events[..k].iter().any(|b| torn(a, b)))
    }
}
