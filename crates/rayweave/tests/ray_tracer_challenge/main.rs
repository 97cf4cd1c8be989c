//! The scenarios of Jamis Buck, "The Ray Tracer Challenge" (Pragmatic Bookshelf, 2019), and of its bonus
//! chapter on bounding boxes (raytracerchallenge.com), with the same numbers, for every evaluator. The
//! wording is ours; each case names its chapter.
//!
//! # Differences in conventions
//!
//! - **Axes.** Cylinders and cones of the book lie along y and are truncated at heights; ours lie along z and
//!   are centred, so they are rotated and moved here ([`ask::upright`]).
//! - **Solids.** A plane of the book is a surface; ours is the half-space below it. Cylinders and cones of
//!   the book may be open tubes; ours are closed, and the tube is the crossings through the face `side`.
//! - **Double roots.** A ray that touches a sphere or a cylinder, or goes through the apex of a cone, has two
//!   equal intersections in the book. It crosses nothing: we report none.
//! - **A ray in a face.** At the height of a cylinder's cap the book counts no intersection. We answer by
//!   symbolic perturbation along a fixed vector, here upwards: outside at the upper cap, inside at the lower
//!   one.
//! - **Normals** are oriented by the crossing: outward of the solid, on entry and on exit. The book turns
//!   them towards the eye, and reports `inside` where the ray leaves.
//! - **Groups** of the book list all intersections of their children; a union lists only those with its boundary.
//!   The children in the scenarios do not overlap.
//! - **Equal media.** Inside two transparent spheres, leaving the sphere that does not determine the
//!   medium is an intersection in the book, but no crossing here.
//! - **Bounds** of a difference contain both operands in the book, but only the first one here.
//!
//! # An incorrect number of the book
//!
//! A ray parallel to one half of a cone (chapter 13): the book gives t = 0.35355, by t = -c / 2b. With its b,
//! which already has the factor 2, the equation b t + c = 0 has the root 0.70711: there x^2 + z^2 = y^2, and
//! at 0.35355 it is not.
//!
//! # Omitted scenarios
//!
//! - Tuples, colours, canvas, matrices, materials, lights, patterns, world, camera, reflection and refraction
//!   (chapters 1 to 4, 6 to 8, 10 and 11, except the media along a ray): unrelated to intersections with
//!   solids.
//! - Defaults and parents of shapes, and empty groups: nothing to compare.
//! - The book's `hit`, the first non-negative intersection of a given list: our lists come from solids;
//!   `shapes.rs` has the corresponding test for spheres.
//! - Normals at corners of a cube and at the apex of a cone: that of each adjacent face would be correct.
//! - Triangles, meshes and OBJ files (chapter 15): meshes are closed solids here, without smooth normals.
//! - Splitting of boxes and dividing of groups (bonus chapter): our BVH is built differently.

#![expect(clippy::approx_constant, reason = "the digits are the book's")]

mod ask;
mod bounds;
mod csg;
mod cylinders_and_cones;
mod groups;
mod shapes;
