//! Evaluators on the CPU: what a ray meets in a compiled model.
//!
//! - [`Packets`]: eight rays at a time through small models, the weave for all else; the one for daily use.
//! - [`Reference`]: root-ray algebra in the order of the expression; obvious, slow, the truth.
//! - [`Weave`]: gathers the flips of the leaves that the ray can touch, sorts them once and sweeps the boolean
//!   network, stopping early where one crossing is enough.
//! - [`SingleHit`]: asks what is next after t, from crossing to crossing; the evaluator that can explain itself.
//! - `Spans`: combines whole hit arrays of many rays, gate by gate, from the leaves up (feature `spans`).
//!
//! All give the same answers, bit for bit. [`AnyEvaluator`] is one of them, chosen by name.

mod accel;
mod any;
mod packets;
mod reference;
mod weave;

pub mod single_hit;
#[cfg(feature = "spans")]
pub mod spans;

pub use any::{AnyEvaluator, AnyScratch, EvaluatorError};
pub use packets::{Packets, PacketsScratch};
pub use reference::Reference;
pub use single_hit::SingleHit;
#[cfg(feature = "spans")]
pub use spans::Spans;
pub use weave::Weave;
