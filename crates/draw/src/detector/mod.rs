//! Charts of the light at a detector: spot diagrams and maps of irradiance.

mod chart;
mod irradiance;
mod spot;

pub use irradiance::irradiance_svg;
pub use spot::{spot_svg, spots_svg};
