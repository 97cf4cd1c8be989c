//! What arrives at a detector, as drawings: spots and maps of irradiance, gathered ray by ray in bounded memory.

mod chart;
mod map;
mod spot;

pub use map::{IrradianceMap, Map};
pub use spot::SpotDiagram;
