//! Crossings of two scan lines that lie on one curve of the section.

use super::Cut;
use super::scan_line::{ScanCrossing, ScanLine};
use rayweave_math::UNIT_ROUNDOFF;
use rayweave_model::{Face, Program};

/// Finds crossings on the same curve.
///
/// A plane through the edge between a cylinder and its chamfer cuts both in the same circle, and rounding decides at each crossing
/// which of them is reported. Two crossings through different surfaces are therefore also on the same curve if each lies in the surface
/// of the other; beside a corner of the section they do not.
pub struct SameCurve<'a> {
    pub program: &'a Program,
    pub cut: &'a Cut,
}

impl SameCurve<'_> {
    /// True for scan lines whose crossings are on the same curves, in the same order.
    pub fn joins(&self, one: &ScanLine, two: &ScanLine) -> bool {
        let alike = |(a, b): (&ScanCrossing, &ScanCrossing)| {
            a.is_like(b)
                || a.is_between_regions_of(b)
                    && a.face.is_some_and(|face| self.contains(face, [two.u, b.v]))
                    && b.face.is_some_and(|face| self.contains(face, [one.u, a.v]))
        };
        one.passes.len() == two.passes.len() && one.passes.iter().zip(&two.passes).all(alike)
    }

    /// True if a point of the plane lies in the surface of a face up to rounding: within 256 u times the lengths in the equation of the
    /// surface and in the maps to its frame, as for signed distances ([`crate::distance`]).
    fn contains(&self, face: Face, place: [f64; 2]) -> bool {
        let surface = &self.program.surface(face.surface).surface;
        let world_from_local = self.program.placement(face.placement).0;
        let Ok(local_from_world) = world_from_local.inverse() else { return false };
        let world = self.cut.point(place);
        let local = local_from_world.point(world);
        let (value, gradient) = surface.value_and_gradient(local);
        let of_map = local_from_world.linear_norm() * world.length();
        let rounding = 256.0 * UNIT_ROUNDOFF * (surface.magnitude() + local.length() + of_map);
        value.abs() <= rounding * gradient.length()
    }
}
