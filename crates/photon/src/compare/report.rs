//! The comparison of two samples.

use super::bins::{self, Pooling};
use super::paired::{Pairs, pairs, photon_history};
use super::sample::{Alphabet, PhotonSample, SampleTrack};
use super::statistics::{ComparedQuantity, fraction_z};
use crate::error::PhotonError;
use rayweave_error::Message;
use std::borrow::Cow;
use std::collections::BTreeMap;

/// A value of a track.
type TrackValue = fn(&SampleTrack) -> f64;

/// Values of doubles that differ by less are equal up to rounding: times are sums of many steps.
const TOLERANCE: f64 = 1e-9;

/// The same for values in single precision.
const SINGLE_TOLERANCE: f64 = 1e-6;

/// The options of a comparison.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CompareOptions {
    /// The expected number of photons of each sample that a bin needs; at least 1.
    pub least: f64,
    /// Compares flags of Opticks rather than processes.
    pub flags: bool,
    /// Compares detected photons alone.
    pub hits: bool,
    /// The numbers of photons of the two runs, for a comparison of hits: tables of hits do not have them. `None` for equal numbers.
    pub photons: Option<[u64; 2]>,
}

impl Default for CompareOptions {
    /// 5 expected photons, the rule of Cochran (Biometrics 10, 1954, 417).
    fn default() -> CompareOptions {
        CompareOptions { least: 5.0, flags: false, hits: false, photons: None }
    }
}

/// The comparison of two samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// The names of the samples.
    pub names: [String; 2],
    /// The numbers of photons.
    pub photons: [u64; 2],
    /// Whether only detected photons are compared.
    pub is_hits: bool,
    /// Whether the samples have the same photons in the same order: all that both of them have is equal.
    pub is_equal: bool,
    /// The difference of the numbers of hits in standard deviations, in a comparison of hits, else 0: (A - B) / sqrt(A + B) for runs of
    /// equal numbers of photons, or the difference of the fractions of the [numbers of photons](CompareOptions::photons), of a binomial
    /// distribution.
    pub hits_z: f64,
    /// The quantities that both samples have.
    pub quantities: Vec<ComparedQuantity>,
    /// The quantities that are not compared, and the reasons.
    pub missing: Vec<String>,
    /// The photons that both samples have, if they have histories and numbers.
    pub pairs: Option<Pairs>,
}

/// Compares two samples: their histories, ends, volumes, times and wavelengths, as far as both have them.
///
/// Bins are chosen from both samples together. A bin needs `least` expected photons of each sample; others are pooled.
///
/// # Errors
///
/// [`PhotonError::Sample`] if a sample is empty or nothing can be compared, [`PhotonError::Setting`] for an invalid option.
pub fn compare(
    a: &PhotonSample,
    b: &PhotonSample,
    options: &CompareOptions,
) -> Result<Comparison, PhotonError> {
    if !(options.least >= 1.0 && options.least.is_finite()) {
        let problem = format!("the least number of photons of a bin is {}", options.least);
        return Err(PhotonError::setting(problem, "it must be at least 1"));
    }
    let is_hits = options.hits || a.is_hits || b.is_hits;
    let flags = options.flags || a.alphabet != b.alphabet;
    let reduced = [a, b].map(|sample| reduced(sample, is_hits, flags));
    let [a, b]: [&PhotonSample; 2] = [&reduced[0], &reduced[1]];
    if let Some(sample) = [a, b].into_iter().find(|sample| sample.tracks.is_empty()) {
        let what = if is_hits { "no photon is detected" } else { "the file has no photons" };
        return Err(PhotonError::Sample(Message::new(format!("{} cannot be compared", sample.name), what)));
    }
    let mut comparison = Comparison {
        names: [a.name.clone(), b.name.clone()],
        photons: [a.photons(), b.photons()],
        is_hits,
        is_equal: are_equal([a, b]) && options.photons.is_none_or(|[n, m]| n == m),
        hits_z: hits_z([a, b], is_hits, options.photons)?,
        quantities: Vec::new(),
        missing: Vec::new(),
        pairs: None,
    };
    comparison.histories([a, b], options);
    comparison.volumes([a, b], options);
    comparison.values([a, b], options);
    if comparison.quantities.is_empty() {
        let problem = format!("{} and {} cannot be compared", a.name, b.name);
        let message = Message::new(problem, comparison.missing.join("; "));
        let suggestion = "Compare tables of the same kind, such as two tables of histories";
        return Err(PhotonError::Sample(message.suggest(suggestion)));
    }
    Ok(comparison)
}

/// The compared part of a sample: its detected photons, or flags for its processes, or all of it.
fn reduced(sample: &PhotonSample, is_hits: bool, flags: bool) -> Cow<'_, PhotonSample> {
    let is_known = sample.is_hits || sample.alphabet.is_some();
    match is_hits && is_known {
        true => Cow::Owned(sample.detected()),
        false if flags => Cow::Owned(sample.as_flags()),
        false => Cow::Borrowed(sample),
    }
}

/// True if two samples have the same tracks: equal numbers, histories, volumes, times and wavelengths, as far as both have them.
fn are_equal(samples: [&PhotonSample; 2]) -> bool {
    let [a, b] = samples;
    let both = |has: fn(&PhotonSample) -> bool| samples.into_iter().all(has);
    let has_numbers = both(|sample| sample.has_numbers);
    let has_histories = both(|sample| sample.alphabet.is_some());
    let has_volumes = both(|sample| sample.volumes.is_some());
    let has_times = both(|sample| sample.has_times);
    // samples number volumes in an order of their own
    fn volume<'s>(sample: &'s PhotonSample, track: &SampleTrack) -> Option<&'s String> {
        sample.volumes.as_ref()?.get(track.volume as usize)
    }
    let is_equal = |(one, two): (&SampleTrack, &SampleTrack)| {
        (!has_numbers || one.photon == two.photon)
            && (!has_histories || one.history == two.history)
            && (!has_volumes || volume(a, one) == volume(b, two))
            && (!has_times || (one.time == two.time && one.wavelength_nm == two.wavelength_nm))
    };
    a.tracks.len() == b.tracks.len() && a.tracks.iter().zip(&b.tracks).all(is_equal)
}

/// The difference of the numbers of hits of two Poisson samples, or of the fractions of photons with hits.
fn hits_z(samples: [&PhotonSample; 2], is_hits: bool, photons: Option<[u64; 2]>) -> Result<f64, PhotonError> {
    let Some(photons) = photons else {
        let [a, b] = samples.map(|sample| sample.tracks.len() as f64);
        return Ok(if is_hits { (a - b) / libm::sqrt(a + b) } else { 0.0 });
    };
    if !is_hits {
        let reason = "it belongs to a comparison of hits";
        let message = Message::new("the numbers of photons have no effect", reason);
        return Err(PhotonError::Setting(message.suggest("Compare the hits alone, or leave them out.")));
    }
    let detected = samples.map(PhotonSample::photons);
    for ((sample, &photons), detected) in samples.into_iter().zip(&photons).zip(detected) {
        if photons < detected {
            let problem = format!("{} has hits of {detected} photons", sample.name);
            return Err(PhotonError::setting(problem, format!("{photons} photons are stated")));
        }
    }
    Ok(fraction_z(detected, photons))
}

impl Comparison {
    /// The quantity of a name.
    #[must_use]
    pub fn quantity(&self, name: &str) -> Option<&ComparedQuantity> {
        self.quantities.iter().find(|quantity| quantity.name == name)
    }

    /// The result for equal samples in a sentence; `None` for others.
    #[must_use]
    pub fn equality(&self) -> Option<String> {
        let names: Vec<&str> = self.quantities.iter().map(|quantity| quantity.name).collect();
        let what = if self.is_hits { "hit" } else { "photon" };
        let s = if self.photons[0] == 1 { "" } else { "s" };
        self.is_equal.then(|| {
            format!("A and B are equal: {} {what}{s}, one by one, in {}.", self.photons[0], names.join(", "))
        })
    }

    fn histories(&mut self, samples: [&PhotonSample; 2], options: &CompareOptions) {
        let [a, b] = samples;
        let (Some(alphabet), Some(_)) = (a.alphabet, b.alphabet) else {
            if !self.is_hits {
                self.missing.push(format!("histories: {}", lacking(samples, |s| s.alphabet.is_some())));
            }
            return;
        };
        let mut counts: BTreeMap<Vec<u8>, [u64; 2]> = BTreeMap::new();
        let mut ends: BTreeMap<String, [u64; 2]> = BTreeMap::new();
        for (side, sample) in samples.into_iter().enumerate() {
            for tracks in sample.tracks.chunk_by(|a, b| sample.has_numbers && a.photon == b.photon) {
                counts.entry(photon_history(tracks)).or_default()[side] += 1;
            }
            for track in &sample.tracks {
                let end = track.history.last().map_or("", |&code| alphabet.name(code));
                ends.entry(end.to_owned()).or_default()[side] += 1;
            }
        }
        let pooling = Pooling::new(options.least, self.photons);
        let bins = bins::histories(&counts, alphabet, pooling);
        self.quantities.push(ComparedQuantity::new("history", self.photons, bins));
        let totals = samples.map(|sample| sample.tracks.len() as u64);
        let bins = bins::categories(ends, Pooling::new(options.least, totals));
        self.quantities.push(ComparedQuantity::new("end", totals, bins));
        self.pairs = pairs(samples, alphabet);
    }

    fn volumes(&mut self, samples: [&PhotonSample; 2], options: &CompareOptions) {
        let names = samples.map(|sample| sample.volumes.as_ref());
        if names.contains(&None) {
            self.missing.push(format!("volumes: {}", lacking(samples, |s| s.volumes.is_some())));
            return;
        }
        // programs number the copies of volumes in different ways, or not at all
        let is_numbered =
            names.map(|names| names.is_some_and(|names| names.iter().any(|name| name.contains('['))));
        let names = match is_numbered {
            [true, true] | [false, false] => names.map(|names| names.cloned().unwrap_or_default()),
            _ => names.map(|names| names.into_iter().flatten().map(|name| without_copies(name)).collect()),
        };
        let mut counts: BTreeMap<String, [u64; 2]> = BTreeMap::new();
        for (side, (sample, names)) in samples.into_iter().zip(names).enumerate() {
            for track in &sample.tracks {
                let name = names.get(track.volume as usize);
                counts.entry(name.cloned().unwrap_or_default()).or_default()[side] += 1;
            }
        }
        let totals = samples.map(|sample| sample.tracks.len() as u64);
        let bins = bins::categories(counts, Pooling::new(options.least, totals));
        self.quantities.push(ComparedQuantity::new("volume", totals, bins));
    }

    fn values(&mut self, samples: [&PhotonSample; 2], options: &CompareOptions) {
        if !samples.iter().all(|sample| sample.has_times) {
            let reason = lacking(samples, |sample| sample.has_times);
            self.missing.push(format!("times and wavelengths: {reason}"));
            return;
        }
        let totals = samples.map(|sample| sample.tracks.len() as u64);
        let pooling = Pooling::new(options.least, totals);
        let is_single = samples.iter().any(|sample| sample.is_single);
        let tolerance = if is_single { SINGLE_TOLERANCE } else { TOLERANCE };
        let kinds: [(&'static str, &str, TrackValue); 2] =
            [("time", "ns", |track| track.time), ("wavelength", "nm", |track| track.wavelength_nm)];
        for (name, unit, value) in kinds {
            let [a, b] = samples.map(|sample| sample.tracks.iter().map(value).collect::<Vec<f64>>());
            let bins = bins::intervals([&a, &b], pooling, tolerance, unit);
            self.quantities.push(ComparedQuantity::new(name, totals, bins));
        }
    }

    /// The difference of the fractions of photons that end in a way, in standard deviations; `None` without histories.
    #[must_use]
    pub fn end_z(&self, end: &str) -> Option<f64> {
        let ends = self.quantity("end")?;
        let bin = ends.bins.iter().find(|bin| bin.label == end)?;
        Some(fraction_z(bin.counts, ends.totals))
    }
}

/// A path without copy numbers: `tower[3]/brick` is `tower/brick`.
fn without_copies(path: &str) -> String {
    let mut parts = path.split('[');
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |text, part| text + part.split_once(']').map_or(part, |(_, rest)| rest))
}

/// The files that lack a quantity.
fn lacking(samples: [&PhotonSample; 2], has: impl Fn(&PhotonSample) -> bool) -> String {
    let names: Vec<&str> = samples.iter().filter(|s| !has(s)).map(|s| s.name.as_str()).collect();
    match names.len() {
        1 => format!("{} has none", names[0]),
        _ => format!("{} have none", names.join(" and ")),
    }
}

impl Alphabet {
    /// The meaning of histories in words.
    #[must_use]
    pub fn describe(self) -> &'static str {
        match self {
            Alphabet::Processes => "processes",
            Alphabet::Flags => "flags of Opticks",
        }
    }
}
