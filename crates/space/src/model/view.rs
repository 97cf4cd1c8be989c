//! A curve as one group of a model sees it.

use crate::curve::{CurveError, Mapped};
use crate::isolate::{hugs, isolate_aside};
use crate::{Curve, Field, Point};
use rayweave_math::{Affine, Interval, Vec3};
use rayweave_model::{Place, PlacementId, SurfaceEntry};
use rayweave_rootray::{Root, RootRay, Side};
use rayweave_shape::surface::{Aside, Surface};

/// A curve in the frame of a group.
#[derive(Clone, Copy)]
pub struct View<'a> {
    world: &'a dyn Curve<3>,
    /// From the world into the frame of the group.
    pub map: Affine,
    /// What the way into the frame adds to the reach of every surface.
    pub reach: f64,
    aside: Aside,
    /// The placement of the group.
    pub placement: PlacementId,
}

impl<'a> View<'a> {
    /// As the model itself sees it.
    pub fn world(curve: &'a dyn Curve<3>) -> View<'a> {
        View {
            world: curve,
            map: Affine::IDENTITY,
            reach: 0.0,
            aside: Aside::WORLD,
            placement: PlacementId(0),
        }
    }

    /// As a solid placed in the group sees it; `placement` is counted from that of the group. The reach grows as
    /// that of a ray ([`rayweave_model::carried`]), whose position is counted with the curve's own size.
    pub fn placed(&self, place: &Place, placement: u32) -> View<'a> {
        let down = &place.local_from_world;
        View {
            world: self.world,
            map: self.map.then(down),
            reach: down.stretch() * (place.path + self.reach),
            aside: self.aside.transformed(down),
            placement: PlacementId(self.placement.0 + placement),
        }
    }

    /// The sign changes of a surface along the curve.
    pub fn isolate(&self, entry: &SurfaceEntry, (t0, t1): (f64, f64)) -> Result<RootRay, CurveError> {
        let side = |gradient: &Point<3>| self.aside.leads_inside(Vec3::from_array(*gradient));
        self.with_curve(|curve| isolate_aside(&self.field(entry), curve, t0, t1, side))
    }

    /// The sign changes of a surface along a curve that is on its side `inside` just after the window begins, if it begins
    /// within delta of the surface at all: see [`trace_curve_from`](crate::trace_curve_from).
    pub fn departing(
        &self,
        entry: &SurfaceEntry,
        (t0, t1): (f64, f64),
        found: RootRay,
        inside: bool,
    ) -> Result<RootRay, CurveError> {
        if !self.hugs(entry, t0, t0)? {
            return Ok(found);
        }
        let side = Side::from_inside(inside);
        if found.roots().is_empty() && self.hugs(entry, t0, t1)? {
            return Ok(RootRay::from_flips(side, Vec::new()).unwrap_or_default());
        }
        let (start, mut roots) = found.into_parts();
        let mut near = 0;
        while near < roots.len() && self.hugs(entry, t0, roots[near].t)? {
            near += 1;
        }
        let last = near.checked_sub(1).map_or(t0.next_up(), |k| roots[k].t);
        roots.drain(..near);
        if start.after(near) != side {
            roots.insert(0, Root::new(last, ()));
        }
        // in order and finite, as they were
        Ok(RootRay::from_flips(side, roots).unwrap_or_default())
    }

    /// True if the curve keeps within delta of a surface between two times.
    pub fn hugs(&self, entry: &SurfaceEntry, a: f64, b: f64) -> Result<bool, CurveError> {
        self.with_curve(|curve| hugs(&self.field(entry), curve, a, b))
    }

    /// The curve in this frame; in the world's itself it is not carried at all.
    fn with_curve<T>(&self, ask: impl FnOnce(&dyn Curve<3>) -> T) -> T {
        if self.map == Affine::IDENTITY { ask(self.world) } else { ask(&Mapped::new(self.world, self.map)) }
    }

    fn field<'s>(&self, entry: &'s SurfaceEntry) -> Reached<'s> {
        Reached { surface: &entry.surface, reach: entry.reach + self.reach }
    }
}

/// A surface with the reach that its way into the model has given it.
struct Reached<'a> {
    surface: &'a Surface,
    reach: f64,
}

impl Field<3> for Reached<'_> {
    fn value_and_gradient(&self, point: &Point<3>) -> (f64, Point<3>) {
        let (value, gradient) = self.surface.value_and_gradient(Vec3::from_array(*point));
        (value, gradient.to_array())
    }

    fn ranges(&self, cell: &[Interval; 3]) -> (Interval, [Interval; 3]) {
        self.surface.ranges(cell)
    }

    fn reach(&self) -> f64 {
        self.reach
    }
}

impl Field<3> for Surface {
    fn value_and_gradient(&self, point: &Point<3>) -> (f64, Point<3>) {
        let (value, gradient) = Surface::value_and_gradient(self, Vec3::from_array(*point));
        (value, gradient.to_array())
    }

    fn ranges(&self, cell: &[Interval; 3]) -> (Interval, [Interval; 3]) {
        Surface::ranges(self, cell)
    }

    fn reach(&self) -> f64 {
        Surface::reach(self)
    }
}
