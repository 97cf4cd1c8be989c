//! Primitive solids: `cube`, `sphere`, `cylinder`.

use super::arguments::{Arguments, Refusal};
use super::facets::{Fineness, ring_planes, sphere_rings};
use super::mesh::{between_rings, convex};
use super::part::{Part, solid};
use rayweave_math::Vec3;
use rayweave_model::Solid;
use rayweave_shape::primitive::{BoxFromCorners, Cone, Cylinder, Sphere};

/// `cube(size, center)`: empty if a size is not positive.
pub(super) fn cube(arguments: &Arguments) -> Result<Part, Refusal> {
    let size = Vec3::from_array(arguments.point("size", 1.0)?);
    if size.min_element() <= 0.0 {
        return Ok(Part::Empty);
    }
    let lo = if arguments.boolean("center", false)? { -0.5 * size } else { Vec3::ZERO };
    Ok(solid(arguments, BoxFromCorners::new(lo, lo + size))?.into())
}

/// `sphere(r)`: empty if the radius is not positive.
pub(super) fn sphere(arguments: &Arguments, facets: bool) -> Result<Part, Refusal> {
    let radius = arguments.number("r", 1.0)?;
    if radius <= 0.0 {
        return Ok(Part::Empty);
    }
    if !facets {
        return Ok(solid(arguments, Sphere::new(radius))?.into());
    }
    let fragments = Fineness::of(arguments)?.fragments(radius);
    Ok(faceted(arguments, &sphere_rings(radius, fragments), fragments)?.into())
}

/// Convex solid between rings.
fn faceted(arguments: &Arguments, rings: &[[f64; 2]], fragments: usize) -> Result<Solid, Refusal> {
    arguments.hold(rings.len().saturating_mul(2 * fragments))?;
    convex(arguments, ring_planes(rings, fragments), || between_rings(rings, fragments))
}

/// Dimensions of `cylinder(h, r1, r2, center)`.
#[derive(Clone, Copy, Debug)]
pub(super) struct CylinderSizes {
    pub bottom: f64,
    pub radius1: f64,
    pub radius2: f64,
    pub height: f64,
}

impl CylinderSizes {
    /// The dimensions of an item; `None` if its volume is zero.
    pub fn of(arguments: &Arguments) -> Result<Option<CylinderSizes>, Refusal> {
        let height = arguments.number("h", 1.0)?;
        let radius1 = arguments.number("r1", 1.0)?;
        let radius2 = arguments.number("r2", 1.0)?;
        let bottom = if arguments.boolean("center", false)? { -0.5 * height } else { 0.0 };
        let has_volume = height > 0.0 && radius1 >= 0.0 && radius2 >= 0.0 && radius1.max(radius2) > 0.0;
        Ok(has_volume.then_some(CylinderSizes { bottom, radius1, radius2, height }))
    }

    /// The rings (radius, z), from the top down.
    pub fn rings(&self) -> [[f64; 2]; 2] {
        [[self.radius2, self.bottom + self.height], [self.radius1, self.bottom]]
    }

    pub fn largest(&self) -> f64 {
        self.radius1.max(self.radius2)
    }
}

/// `cylinder(h, r1, r2, center)`: empty if its volume is zero.
pub(super) fn cylinder(arguments: &Arguments, facets: bool) -> Result<Part, Refusal> {
    let Some(sizes) = CylinderSizes::of(arguments)? else {
        return Ok(Part::Empty);
    };
    if facets {
        let fragments = Fineness::of(arguments)?.fragments(sizes.largest());
        return Ok(faceted(arguments, &sizes.rings(), fragments)?.into());
    }
    let CylinderSizes { bottom, radius1, radius2, height } = sizes;
    let centred = match radius1 == radius2 {
        true => solid(arguments, Cylinder::new(radius1, height))?,
        false => solid(arguments, Cone::new(radius1, radius2, height))?,
    };
    let middle = bottom + 0.5 * height;
    Ok(if middle == 0.0 { centred } else { centred.translate([0.0, 0.0, middle]) }.into())
}
