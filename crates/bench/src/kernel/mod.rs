//! Hand-written kernels, each for one solid: an upper bound of the achievable speed.

pub mod die;
pub mod lanes;
mod network;
