//! Comparison of two samples of photons: histories, ways of ending, volumes, times and wavelengths.

mod bins;
mod paired;
mod read;
mod report;
mod sample;
mod statistics;

pub use paired::{FirstDifference, Pairs};
pub use read::read_sample;
pub use report::{CompareOptions, Comparison, compare};
pub use sample::{Alphabet, PhotonSample, SampleTrack};
pub use statistics::{ComparedBin, ComparedQuantity, chi_squared_tail, normal_tail};
