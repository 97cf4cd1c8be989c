//! Charts of the light at a detector: spot diagrams, maps of irradiance and of hits, histograms, curves.

mod chart;
mod curve;
mod histogram;
mod hits;
mod irradiance;
mod scale;
mod spot;

pub use curve::{PropertyCurve, property_curves_svg};
pub use histogram::{Histogram, histograms_svg};
pub use hits::{HitPositions, MapPlane, hit_maps_svg};
pub use irradiance::irradiance_svg;
pub use scale::MapScale;
pub use spot::{spot_svg, spots_svg};
