//! A model as a boolean function of the signs of its surfaces.

use super::tree::Tree;
use rayweave_math::{Bounds, UNIT_ROUNDOFF, Vec3};
use rayweave_model::{Program, RegionId};
use rayweave_shape::surface::Surface;
use std::cell::RefCell;

/// The tree of a model with its surfaces.
#[derive(Clone, Debug)]
pub struct Field {
    pub tree: Tree,
    /// The surfaces, by their numbers in the tree.
    pub surfaces: Vec<Surface>,
    /// Upper bound of the lengths that describe the surfaces.
    magnitude: f64,
    /// A box around the solid.
    pub bounds: Bounds,
    /// The relative difference between the bounds of a distance below which it counts as exact.
    precision: f64,
}

thread_local! {
    /// Values of nodes, so that points do not allocate.
    static VALUES: RefCell<Vec<bool>> = const { RefCell::new(Vec::new()) };
}

impl Field {
    /// The field of the selected regions of a program; `None` if it has too many placements.
    pub fn new(program: &Program, is_selected: &dyn Fn(RegionId) -> bool, precision: f64) -> Option<Field> {
        let (tree, surfaces) = Tree::of_regions(program, is_selected)?;
        let magnitude = surfaces.iter().map(|(_, magnitude)| *magnitude).fold(0.0, f64::max);
        let surfaces = surfaces.into_iter().map(|(surface, _)| surface).collect();
        Some(Field { tree, surfaces, magnitude, bounds: program.bounds(), precision })
    }

    /// A surface by its number.
    pub fn surface(&self, number: u32) -> &Surface {
        &self.surfaces[number as usize]
    }

    /// Whether a point is inside; arbitrary within rounding of the boundary.
    pub fn is_inside(&self, point: Vec3) -> bool {
        let is_negative = |number: u32| self.surface(number).value_and_gradient(point).0 < 0.0;
        VALUES.with_borrow_mut(|values| self.tree.is_inside(is_negative, values))
    }

    /// The rounding error of signed distances at a point.
    pub fn rounding(&self, point: Vec3) -> f64 {
        256.0 * UNIT_ROUNDOFF * self.lengths(point)
    }

    /// The lengths that enter the equations at a point.
    pub fn lengths(&self, point: Vec3) -> f64 {
        point.length() + self.magnitude
    }

    /// The difference between the bounds of a distance below which it counts as exact.
    pub fn tolerance(&self, point: Vec3, upper: f64) -> f64 {
        let relative = if upper < f64::INFINITY { self.precision * upper } else { 0.0 };
        relative.max(16.0 * self.rounding(point))
    }
}
