//! Comparison of samples of photons against closed forms, and its files.

mod files;
mod opnovice2;
mod statistics;

use rayweave_photon::philox::{Purpose, Stream};
use rayweave_photon::{Alphabet, PhotonSample, Process, SampleTrack};

/// The code of a process in histories.
fn code(process: Process) -> u8 {
    u8::try_from(Process::ALL.iter().position(|&own| own == process).unwrap()).unwrap()
}

/// A sample of histories, with times and wavelengths.
fn sample(name: &str, tracks: Vec<SampleTrack>) -> PhotonSample {
    PhotonSample {
        name: name.to_owned(),
        alphabet: Some(Alphabet::Processes),
        tracks,
        volumes: Some(vec!["World".to_owned(), "World/Tank".to_owned()]),
        has_times: true,
        has_numbers: true,
        is_single: false,
        is_hits: false,
    }
}

/// Uniform random numbers of a seed.
fn uniforms(seed: u64, count: usize) -> Vec<f64> {
    let mut stream = Stream::new(seed, 1, 0, Purpose::FreePath);
    (0..count).map(|_| stream.uniform()).collect()
}
