//! Evaluators on the CPU: what a ray meets in a compiled model.
//!
//! - [`Reference`]: root-ray algebra in the order of the expression; obvious, slow, the truth.
//! - [`Weave`]: gathers the flips of the leaves that the ray can touch, sorts them once and sweeps the boolean
//!   network, stopping early where one crossing is enough.
//!
//! Both give the same answers, bit for bit.

mod accel;
mod reference;
mod weave;

pub use reference::Reference;
pub use weave::Weave;
