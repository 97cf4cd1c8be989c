//! Boxes around leaves, grown by the error of computed roots, and the part of each box where its leaf can
//! matter.

use crate::leaf::LeafTable;
use crate::program::{MARGIN, SurfaceEntry};
use crate::{Ball, PrototypeId};
use rayweave_math::{Bounds, Vec3};

/// Bounds and error factors of a compiled group, for the groups that place it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extent {
    /// A box that holds the solid (of the model: all regions).
    pub bounds: Bounds,
    /// A conservative box for every time of a ray, unbounded unless finite on all sides: see [`sure`].
    pub sure: Bounds,
    /// The largest margin of its leaves.
    pub margin: f64,
    /// Upper bound of the factor by which a rounding error in the group's frame grows on the way in and back.
    pub condition: f64,
    /// The number of placements of one occurrence, itself included.
    pub placements: u32,
}

impl Default for Extent {
    fn default() -> Extent {
        let bounds = Bounds::EMPTY;
        Extent { bounds, sure: bounds, margin: 0.0, condition: 1.0, placements: 1 }
    }
}

/// `bounds` if finite or empty, else all of space. An unbounded box is unreliable: a ray nearly parallel to a
/// face leaves it at t ~ 1e16, at a point that rounding decides.
fn sure(bounds: Bounds) -> Bounds {
    if bounds.is_finite() || bounds.is_empty() { bounds } else { Bounds::ALL }
}

/// The boxes of the leaves of one group.
pub(crate) struct Boxes<'a, F> {
    pub leaves: &'a LeafTable,
    pub surfaces: &'a [SurfaceEntry],
    /// Returns the extent of a solid placed in the group.
    pub inner: F,
}

impl<F: Fn(PrototypeId) -> Extent> Boxes<'_, F> {
    /// A box, in the frame of the group, that holds the conjunction of the facets of a leaf.
    pub fn bounds(&self, leaf: usize) -> Bounds {
        match self.leaves.leaf(leaf).instance() {
            Some((run, k)) => (self.inner)(run.prototype).bounds.transformed(&run.world_from_local(k)),
            None => self.leaves.leaf(leaf).shape_bounds(),
        }
    }

    /// Upper bound of the factor by which a rounding error grows on the way into the frame of a leaf and
    /// back; >= 1.
    pub fn condition(&self, leaf: usize) -> f64 {
        self.leaves.leaf(leaf).instance().map_or(1.0, |(run, k)| {
            let (up, down) = (run.world_from_local(k), run.place(k).local_from_world);
            // the Frobenius norm is an upper bound of the spectral norm, at most sqrt(3) times as large
            up.linear_norm() * down.linear_norm() * (self.inner)(run.prototype).condition
        })
    }

    /// A box that holds the leaf at all times of a ray that starts near the origin, and the margin by which
    /// it was grown for that. A distant origin needs a further margin, which the caller adds.
    ///
    /// The margin is [`MARGIN`] times the lengths involved, four times the distance of a computed root from
    /// its surface. These lengths include the leaf's own size and path, those of the faces that share its
    /// surfaces, and the group's ball, because whether a ray lies in a face is decided along a chord of it.
    pub fn grown(&self, leaf: usize, ball: &Ball) -> (Bounds, f64) {
        let far = |v: Vec3| if v.is_finite() { v.length() } else { 0.0 };
        let chord = ball.centre.length() + 2.0 * ball.radius;
        let view = self.leaves.leaf(leaf);
        let (bounds, held, own, way) = match view.instance() {
            Some((run, k)) => {
                let (map, path, inner) =
                    (run.world_from_local(k), run.place(k).path, (self.inner)(run.prototype));
                let own = map.linear_norm() * inner.margin + MARGIN * self.condition(leaf) * path;
                (inner.bounds.transformed(&map), inner.sure.transformed(&map), own, path)
            }
            None => {
                let magnitude =
                    view.facets().iter().map(|facet| self.surfaces[facet.surface().index()].magnitude);
                let bounds = view.shape_bounds();
                (bounds, bounds, 0.0, magnitude.fold(0.0, f64::max))
            }
        };
        let margin = own + MARGIN * (far(bounds.lo) + far(bounds.hi) + way + chord);
        (sure(held).grown(margin), margin)
    }
}
