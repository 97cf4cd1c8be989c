//! Optics: glasses, components, systems and traces.

pub mod component;
pub mod glass;
pub mod source;
pub mod system;
