//! Kernels by hand for one tree each: what a processor can do at most.

pub mod die;
pub mod lanes;
mod network;
