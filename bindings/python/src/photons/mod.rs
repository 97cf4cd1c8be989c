//! Optical photons in detectors: see `rayweave.photons`.

pub mod compare;
pub mod detector;
pub mod histories;
pub mod hits;
pub mod parts;
pub mod run;
pub mod source;
