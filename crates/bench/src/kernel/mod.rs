//! Hand-written kernels, each for one solid: upper bounds of the achievable speed.

pub mod die;
pub mod lanes;
mod network;
