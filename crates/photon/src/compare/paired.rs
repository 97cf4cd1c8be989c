//! Photon by photon: runs of the same photons have equal histories.

use super::bins::text;
use super::sample::{Alphabet, PhotonSample, SampleTrack};
use std::collections::BTreeMap;

/// The first photon with different histories.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FirstDifference {
    /// The number of the photon.
    pub photon: i64,
    /// The first row of its history that differs; 0 is the emission.
    pub row: usize,
    /// The two histories.
    pub histories: [String; 2],
}

/// The photons that both samples have.
#[derive(Clone, Debug, PartialEq)]
pub struct Pairs {
    /// Their number.
    pub photons: u64,
    /// The number of photons with equal histories.
    pub equal: u64,
    /// The number of equal histories to expect of independent samples: the sum over histories of the product of their fractions.
    pub expected: f64,
    /// The first photon with different histories, if the samples are runs of the same photons ([`Pairs::is_same_run`]).
    pub first_difference: Option<FirstDifference>,
}

impl Pairs {
    /// True if equal histories are so frequent that the two samples are not independent: more than half, and 5 standard deviations more
    /// than expected.
    #[must_use]
    pub fn is_same_run(&self) -> bool {
        let (equal, photons) = (self.equal as f64, self.photons as f64);
        let variance = self.expected * (1.0 - self.expected / photons.max(1.0));
        2.0 * equal > photons && equal - self.expected > 5.0 * libm::sqrt(variance.max(0.0))
    }
}

/// Pairs the photons of two samples with the same kind of histories; `None` without photons in common.
pub(super) fn pairs([a, b]: [&PhotonSample; 2], alphabet: Alphabet) -> Option<Pairs> {
    if !(a.has_numbers && b.has_numbers) {
        return None;
    }
    let (mut left, mut right) = (by_photon(a).peekable(), by_photon(b).peekable());
    let mut counts: BTreeMap<Vec<u8>, [u64; 2]> = BTreeMap::new();
    let (mut photons, mut equal, mut first) = (0, 0, None);
    while let (Some((photon, one)), Some((other, two))) = (left.peek(), right.peek()) {
        match photon.cmp(other) {
            std::cmp::Ordering::Less => drop(left.next()),
            std::cmp::Ordering::Greater => drop(right.next()),
            std::cmp::Ordering::Equal => {
                photons += 1;
                equal += u64::from(one == two);
                if one != two && first.is_none() {
                    first = Some(difference(*photon, [one, two], alphabet));
                }
                for (side, history) in [one, two].into_iter().enumerate() {
                    counts.entry(history.clone()).or_default()[side] += 1;
                }
                left.next();
                right.next();
            }
        }
    }
    let product = |[a, b]: &[u64; 2]| *a as f64 * *b as f64 / photons as f64;
    let expected = counts.values().map(product).sum();
    let pairs = Pairs { photons, equal, expected, first_difference: first };
    let first_difference = pairs.first_difference.clone().filter(|_| pairs.is_same_run());
    (photons > 0).then_some(Pairs { first_difference, ..pairs })
}

/// The history of each photon.
fn by_photon(sample: &PhotonSample) -> impl Iterator<Item = (i64, Vec<u8>)> {
    sample
        .tracks
        .chunk_by(|a, b| a.photon == b.photon)
        .map(|tracks| (tracks[0].photon, photon_history(tracks)))
}

/// The history of a photon: those of its tracks, the first one first and the others sorted.
pub(super) fn photon_history(tracks: &[SampleTrack]) -> Vec<u8> {
    let Some((first, further)) = tracks.split_first() else { return Vec::new() };
    let mut codes = first.history.to_vec();
    let mut further: Vec<&[u8]> = further.iter().map(|track| &track.history[..]).collect();
    further.sort_unstable();
    for history in further {
        codes.push(super::bins::NEXT_TRACK);
        codes.extend(history);
    }
    codes
}

fn difference(photon: i64, [a, b]: [&[u8]; 2], alphabet: Alphabet) -> FirstDifference {
    let row = a.iter().zip(b).take_while(|(a, b)| a == b).count();
    FirstDifference { photon, row, histories: [a, b].map(|codes| text(codes, false, alphabet)) }
}
