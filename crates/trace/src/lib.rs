//! CPU evaluators: algorithms that answer ray queries (crossings, nearest hit, region at a point) on a
//! compiled model.
//!
//! - [`Packets`]: eight rays at a time, one per SIMD lane, through small models; [`Weave`] for all others.
//!   The default.
//! - [`Reference`]: root-ray algebra in the order of the expression. Simple and slow: the ground truth for
//!   tests.
//! - [`Weave`]: collects the boundary events of the leaves that a BVH finds for the ray, sorts them once and
//!   sweeps the boolean network. It stops early if one crossing is enough.
//! - [`SingleHit`]: computes the next crossing after t, again and again. It can explain its decisions.
//! - `Spans`: combines whole hit arrays of many rays, gate by gate, from the leaves up (feature `spans`).
//! - [`Accelerated`]: passes batches to a [`RayDevice`], such as a graphics card, and everything else to [`Packets`].
//!
//! All return the same answers, bit for bit. [`AnyEvaluator`] is one of them, chosen by name.

mod accel;
mod accelerated;
mod any;
mod packets;
mod reference;
mod rings;
mod weave;

pub mod single_hit;
#[cfg(feature = "spans")]
pub mod spans;

pub use accelerated::{Accelerated, RayDevice};
pub use any::{AnyEvaluator, AnyScratch, EvaluatorError};
pub use packets::{Packets, PacketsScratch};
pub use reference::Reference;
pub use single_hit::SingleHit;
#[cfg(feature = "spans")]
pub use spans::Spans;
pub use weave::Weave;
