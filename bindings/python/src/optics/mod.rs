//! Optics: glasses, components, systems and traces, prescriptions and their analysis.

pub mod arrivals;
pub mod component;
pub mod design;
pub mod element;
pub mod file;
pub mod glass;
mod light;
pub mod medium;
mod outline;
pub mod parts;
pub mod prescription;
pub mod segments;
pub mod source;
mod spec;
pub mod stream;
pub mod system;
mod watch;
pub mod zernike;
