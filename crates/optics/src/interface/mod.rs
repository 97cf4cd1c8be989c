//! What happens to light where two media meet.

mod direct;
mod films;
mod polarisation;

pub use direct::{diffract, reflect, refract};
pub use films::{Film, Response, response};
pub use polarisation::Stokes;
