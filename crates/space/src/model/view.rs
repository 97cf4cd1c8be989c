//! Curve in the local frame of a group of a model.

use crate::curve::{CurveError, Mapped};
use crate::isolate::{coincides_along, isolate_with};
use crate::{Curve, Field, Point};
use rayweave_math::{Affine, Interval, Vec3};
use rayweave_model::{Place, PlacementId, SurfaceEntry};
use rayweave_rootray::{Root, RootRay, Side};
use rayweave_shape::surface::{Perturbation, Surface};

/// A curve in the frame of a group.
#[derive(Clone, Copy)]
pub struct View<'a> {
    world: &'a dyn Curve<3>,
    /// Maps from the world into the frame of the group.
    pub map: Affine,
    /// The magnitude that the placement adds to that of every surface.
    pub magnitude: f64,
    perturbation: Perturbation,
    /// The placement of the group.
    pub placement: PlacementId,
}

impl<'a> View<'a> {
    /// The curve in the world frame.
    pub fn world(curve: &'a dyn Curve<3>) -> View<'a> {
        View {
            world: curve,
            map: Affine::IDENTITY,
            magnitude: 0.0,
            perturbation: Perturbation::WORLD,
            placement: PlacementId(0),
        }
    }

    /// The curve in the frame of a solid placed in the group; `placement` is relative to that of the group. The magnitude grows as for
    /// a ray ([`rayweave_model::carried`]), whose position is part of the curve's size.
    pub fn placed(&self, place: &Place, placement: u32) -> View<'a> {
        let down = &place.local_from_world;
        let magnitude = down.linear_norm() * (place.path + self.magnitude);
        View {
            world: self.world,
            map: self.map.then(down),
            magnitude,
            perturbation: self.perturbation.transformed(down, magnitude),
            placement: PlacementId(self.placement.0 + placement),
        }
    }

    /// The sign changes of a surface along the curve.
    pub fn isolate(&self, entry: &SurfaceEntry, (t0, t1): (f64, f64)) -> Result<RootRay, CurveError> {
        let side = |gradient: &Point<3>| self.perturbation.leads_inside(Vec3::from_array(*gradient));
        self.with_curve(|curve| isolate_with(&self.field(entry), curve, t0, t1, side))
    }

    /// The sign changes of a surface along a curve with a known side just after the beginning of the window, if it begins within delta of
    /// the surface: see [`trace_curve_from`](crate::trace_curve_from).
    pub fn departing(
        &self,
        entry: &SurfaceEntry,
        (t0, t1): (f64, f64),
        found: RootRay,
        inside: bool,
    ) -> Result<RootRay, CurveError> {
        if !self.coincides_along(entry, t0, t0)? {
            return Ok(found);
        }
        let side = Side::from_inside(inside);
        if found.roots().is_empty() && self.coincides_along(entry, t0, t1)? {
            return Ok(RootRay::from_events(side, Vec::new()).unwrap_or_default());
        }
        let (start, mut roots) = found.into_parts();
        let mut near = 0;
        while near < roots.len() && self.coincides_along(entry, t0, roots[near].t)? {
            near += 1;
        }
        let last = near.checked_sub(1).map_or(t0.next_up(), |k| roots[k].t);
        roots.drain(..near);
        if start.after(near) != side {
            roots.insert(0, Root::new(last, ()));
        }
        // never fails: the times stay finite and in order
        Ok(RootRay::from_events(side, roots).unwrap_or_default())
    }

    /// True if the curve stays within delta of a surface between two times.
    pub fn coincides_along(&self, entry: &SurfaceEntry, a: f64, b: f64) -> Result<bool, CurveError> {
        self.with_curve(|curve| coincides_along(&self.field(entry), curve, a, b))
    }

    /// Calls a function with the curve in this frame; the world frame needs no transformation.
    fn with_curve<T>(&self, f: impl FnOnce(&dyn Curve<3>) -> T) -> T {
        if self.map == Affine::IDENTITY { f(self.world) } else { f(&Mapped::new(self.world, self.map)) }
    }

    fn field<'s>(&self, entry: &'s SurfaceEntry) -> PlacedSurface<'s> {
        PlacedSurface { surface: &entry.surface, magnitude: entry.magnitude + self.magnitude }
    }
}

/// A surface with the magnitude of its placement.
struct PlacedSurface<'a> {
    surface: &'a Surface,
    magnitude: f64,
}

impl Field<3> for PlacedSurface<'_> {
    fn value_and_gradient(&self, point: &Point<3>) -> (f64, Point<3>) {
        let (value, gradient) = self.surface.value_and_gradient(Vec3::from_array(*point));
        (value, gradient.to_array())
    }

    fn ranges(&self, cell: &[Interval; 3]) -> (Interval, [Interval; 3]) {
        self.surface.ranges(cell)
    }

    fn magnitude(&self) -> f64 {
        self.magnitude
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

    fn magnitude(&self) -> f64 {
        Surface::magnitude(self)
    }
}
