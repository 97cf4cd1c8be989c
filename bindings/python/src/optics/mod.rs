//! Optics: glasses, components, systems and traces, prescriptions and what they do.

pub mod arrivals;
pub mod component;
pub mod design;
pub mod file;
pub mod glass;
pub mod gradient;
pub mod parts;
pub mod prescription;
pub mod source;
pub mod stream;
pub mod system;
pub mod zernike;
