//! Hit arrays: the crossings of many rays with a solid, one column per ray, and boolean operations on them.
//!
//! A hit array has H rows and N columns, stored row by row. A column is one ray: its times in non-decreasing order, padded at
//! the end with +inf; H is even. Entries at even rows (0, 2, ...) enter the solid, those at odd rows leave it. An odd
//! number of -inf entries means that the ray comes from infinity inside the solid, an odd number of entries below +inf that it
//! goes to infinity inside it.
//!
//! [`array_csg`] computes the same numbers as the function of R. Frazier's *PyRayT* ("Efficient CSG", 2021),
//! and is also deterministic: entries are merged stably, those of `array1` before those of `array2` at equal
//! times. The numpy code also counts the padding. As H is even, both counts return to their initial values at
//! the last row, so its wrap-around from row 0 to the last row compares with "inside neither", and an entry
//! is kept exactly if the state changes at it. Kept +inf entries cannot be distinguished from dropped ones.
//! An entry of -inf is an ordinary entry, the first of its column, and stays -inf if it is kept.
//!
//! Entries of both arrays with the same time toggle one after the other, so that pieces of length zero may
//! occur, and union and intersection do not commute. [`Regularize`] removes them: equal times toggle together,
//! as in [`RootRay`](crate::RootRay)'s algebra, and pieces shorter than a given length may be welded.
//!
//! [`array_csg_into`] combines one ray per SIMD lane, with SSE2, AVX2 or AVX-512 (NEON and WebAssembly are compiled but not
//! tested), on a chosen number of threads. Single rays, regularized or unsorted results, and columns of more than some thousand
//! entries are combined one by one; see [`Instructions`]. `examples/array_csg_speed.rs` measures the speed.
//!
//! [`combine`] evaluates whole expressions: any number of operands, complemented or not, into a reusable [`HitArrayBuf`] that
//! has only as many rows as its fullest column. It is always exact.
//!
//! ```
//! use rayweave_rootray::hit_array::{CsgOptions, Operation, Regularize, array_csg_1d};
//!
//! let (a, b) = ([1.0, 4.0, 5.0, 10.0], [0.0, 2.0, 3.0, 5.0, 6.0, 7.0]);
//! let inf = f64::INFINITY;
//! let hits = array_csg_1d(&a, &b, Operation::Intersect, CsgOptions::default())?;
//! assert_eq!(hits, [1.0, 2.0, 3.0, 4.0, 5.0, 5.0, 6.0, 7.0, inf, inf]);
//!
//! let exact = CsgOptions { regularize: Regularize::Exact, ..CsgOptions::default() };
//! let hits = array_csg_1d(&a, &b, Operation::Intersect, exact)?;
//! assert_eq!(hits, [1.0, 2.0, 3.0, 4.0, 6.0, 7.0, inf, inf, inf, inf]);
//! # Ok::<(), rayweave_rootray::hit_array::HitArrayError>(())
//! ```

mod array;
mod buffer;
mod column;
mod combine;
mod count;
mod csg;
mod error;
mod float;
mod instructions;
mod kernel;
mod merged;
mod part;
mod scalar;
mod wide;

pub use array::HitArray;
pub use buffer::HitArrayBuf;
pub use column::{column_len, from_column, to_column, write_column};
pub use combine::combine;
pub use count::{CountArray, count_array};
pub use csg::{CsgOptions, Operation, Regularize, array_csg, array_csg_1d, array_csg_into};
pub use error::HitArrayError;
pub use float::Float;
pub use instructions::Instructions;
pub use merged::{MergedHit, MergedHits};
pub use part::most_threads;
