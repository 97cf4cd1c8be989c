//! Boundaries of solids as facets, where the maker of a solid knows more than its tree of operators shows.

use rayweave_math::Vec3;
use std::panic::{RefUnwindSafe, UnwindSafe};

/// A description of the boundary of a solid, from which facets are computed.
///
/// The facets that booleans of separately tessellated shapes have in common differ by rounding errors, and touch where faces are
/// tangent to each other. Facets from the description have common vertices.
///
/// A solid with a description is one shape: its operators are those of its maker, not of the user, and checks do not examine them.
pub trait Boundary: Send + Sync + UnwindSafe + RefUnwindSafe {
    /// A closed surface without self-intersections within `tolerance` of the boundary, with its vertices on it; `None` if there is
    /// none with a reasonable number of vertices, or if the facets follow from the tree of operators.
    fn facets(&self, tolerance: f64) -> Option<Facets>;

    /// The solid as a region of the plane that is moved along z or revolved about it, within `tolerance`; `None` for other solids, and
    /// if there is none with a reasonable number of vertices.
    fn swept(&self, _tolerance: f64) -> Option<Swept> {
        None
    }
}

/// A region within polygons, and its movement.
#[derive(Clone, Debug, PartialEq)]
pub struct Swept {
    /// The region is inside an odd number of these polygons, which neither cross nor touch: outer ones are counter-clockwise, holes
    /// clockwise. For a revolution, x is the distance from the axis.
    pub polygons: Vec<Vec<[f64; 2]>>,
    /// True if chords replace arcs.
    pub has_chords: bool,
    /// The movement.
    pub motion: Motion,
}

/// The movement of a region of the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Motion {
    /// Along z, between two heights.
    Along {
        /// The lower end.
        lo: f64,
        /// The upper end.
        hi: f64,
    },
    /// About the z axis, with y along z.
    About {
        /// The angle of the first half-plane from the x axis, in degrees.
        start: f64,
        /// The angle of revolution in degrees, greater than 0; 360 is a full turn.
        sweep: f64,
    },
}

/// The largest number of vertices of the facets of one shape or boundary; more would exhaust memory.
pub const MAX_POINTS: usize = 1 << 22;

/// A closed surface: triangles and flat faces with common vertices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Facets {
    /// The vertices.
    pub points: Vec<Vec3>,
    /// The corners of triangles, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Flat faces, which may have holes.
    pub flat: Vec<FlatFace>,
}

/// A flat face within contours that neither cross nor touch.
#[derive(Clone, Debug, PartialEq)]
pub struct FlatFace {
    /// The vertices of each contour, and their positions in the plane of the face: outer contours counter-clockwise, holes
    /// clockwise.
    pub contours: Vec<Vec<(u32, [f64; 2])>>,
    /// True if the face is seen from outside as in its plane; otherwise as its mirror image.
    pub is_upright: bool,
}
