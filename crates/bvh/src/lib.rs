//! Bounding volume hierarchies (BVH): the search structure for all queries about many boxes.
//!
//! A *bounding volume hierarchy* is a tree of boxes (Rubin and Whitted 1980). Each box encloses the boxes of its
//! children; the leaves hold the boxes of the *items*: surfaces, solids, triangles. A query that misses a box
//! skips everything inside, so that a ray among n items takes about log n box tests.
//!
//! - **Build.** There is one builder. Top down, it divides the items of a node into two groups such that the sum of
//!   surface area times number of items is least. This is the *surface area heuristic* (Goldsmith and Salmon
//!   1987): the probability that a ray which enters a box also enters a convex box within it is the ratio of their
//!   surface areas. Only the borders between 16 bins are tried (Wald 2007). A node has eight children instead of
//!   two: the node splits its largest part until it has eight (Wald, Benthin and Boulos 2008; Dammertz, Hanika and
//!   Keller 2008). Equal input gives equal trees, for any number of threads.
//! - **Slab test.** A box is the intersection of three slabs, each between two planes perpendicular to an axis. A
//!   ray passes the box if the latest of its three entry times is no later than the earliest of its three exit
//!   times (Kay and Kajiya 1986). Eight boxes are tested at once, in SIMD lanes.
//! - **Guarantee.** Queries are conservative: they visit every item whose exact box satisfies the condition, and
//!   some others nearby. Boxes are rounded outwards and grown by more than the rounding errors of the test; the
//!   caller adds the error of its own coordinates as a margin. The additional visits depend on the tree;
//!   an answer should depend neither on them nor on the order of the visits.
//!
//! | type | boxes | queries | users |
//! | --- | --- | --- | --- |
//! | [`Bvh`] | `f32`, rounded outwards | rays in any order, [front to back](FrontToBack) or [approximately so](ForwardSearch), boxes, nearest items | `trace`, `mesh` |
//! | [`ExactBvh`] | `f64`, as given | a condition on boxes, in list order; [bundles of eight rays](BundleTraversal), [eight rays, each on its own](RayTraversals) | `trace`, `optics` |
//! | [`WideBvh`] | `f32`, rounded outwards, sixteen in a node | [many rays](RayStreams) from a bounded part of space | `trace` |
//!
//! All are a flat array of nodes; [`ExactBvh`] has the topology that the builder made for [`Bvh`].
//!
//! ```
//! use rayweave_bvh::Bvh;
//! use rayweave_math::{Bounds, Vec3};
//!
//! let boxes: Vec<Bounds> =
//!     (0..100).map(|k| Bounds::centred(Vec3::new(k as f64, 0.0, 0.0), Vec3::splat(0.25))).collect();
//! let tree = Bvh::of_items(&boxes, 1);
//! let ray = tree.probe(Vec3::new(7.0, -5.0, 0.0), Vec3::Y, 1e-12, [0.0, f64::INFINITY]);
//! let mut found = Vec::new();
//! tree.intersected_items(&ray, &mut found);
//! assert_eq!(found, [7]);
//! ```
//!
//! # Sources
//!
//! - S. Rubin, T. Whitted, "A 3-dimensional representation for fast rendering of complex scenes", SIGGRAPH 1980.
//! - T. L. Kay, J. T. Kajiya, "Ray tracing complex scenes", SIGGRAPH 1986.
//! - J. Goldsmith, J. Salmon, "Automatic creation of object hierarchies for ray tracing", IEEE Computer Graphics
//!   and Applications 7 (1987).
//! - N. Roussopoulos, S. Kelley, F. Vincent, "Nearest neighbor queries", SIGMOD 1995.
//! - S. Boulos, I. Wald, P. Shirley, "Geometric and arithmetic culling methods for entire ray packets", University
//!   of Utah, UUCS-06-010, 2006.
//! - I. Wald, "On fast construction of SAH-based bounding volume hierarchies", Interactive Ray Tracing 2007.
//! - I. Wald, C. Benthin, S. Boulos, "Getting rid of packets: efficient SIMD single-ray traversal using
//!   multi-branching BVHs", Interactive Ray Tracing 2008.
//! - H. Dammertz, J. Hanika, A. Keller, "Shallow bounding volume hierarchies for fast SIMD ray tracing of
//!   incoherent rays", Computer Graphics Forum 27 (2008).
//! - C. Gribble, K. Ramani, "Coherent ray tracing via stream filtering", Interactive Ray Tracing 2008.

mod breadth;
mod build;
mod bundle;
mod exact;
mod forward;
mod frame;
mod front;
mod node;
mod rays;
mod slabs;
mod streams;
mod tree;
mod wide;

pub use bundle::{Bundle, BundleSlabs, BundleTraversal, BundleWindow};
pub use exact::{ExactBvh, FlatChild, FlatNode};
pub use forward::ForwardSearch;
pub use frame::Probe;
pub use front::FrontToBack;
pub use node::WIDTH;
pub use rays::{RayTraversals, SlabRay, SlabRays};
pub use streams::{RayStreams, StreamPlace};
pub use tree::Bvh;
pub use wide::{StreamRay, StreamRays, WideBvh};
