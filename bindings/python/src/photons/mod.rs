//! Optical photons in detectors: see `rayweave.photons`.

pub mod compare;
pub mod curves;
pub mod detector;
pub mod histories;
pub mod hits;
pub mod light;
pub mod parts;
pub mod run;
pub mod source;
pub mod tables;
