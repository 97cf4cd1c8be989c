//! Charts of the light at a detector: spot diagrams, maps of irradiance and of hits, histograms.

mod chart;
mod histogram;
mod hits;
mod irradiance;
mod spot;

pub use histogram::{Histogram, histograms_svg};
pub use hits::{HitPositions, hit_maps_svg};
pub use irradiance::irradiance_svg;
pub use spot::{spot_svg, spots_svg};
