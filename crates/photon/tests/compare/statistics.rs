//! Tail probabilities, multinomial samples, planted differences.

use super::{code, sample, uniforms};
use rayweave_photon::{
    CompareOptions, Comparison, End, PhotonSample, Process, SampleTrack, chi_squared_tail, compare,
    normal_tail,
};

const EMISSION: u8 = 0;
const ABSORBED: Process = Process::End(End::Absorbed);
const ESCAPED: Process = Process::End(End::Escaped);

fn compared(a: &PhotonSample, b: &PhotonSample) -> Comparison {
    compare(a, b, &CompareOptions::default()).unwrap()
}

/// The tail for one, two and four degrees of freedom, from the bulk to the far tail, by closed forms.
#[test]
fn tails_of_chi_squared() {
    for x in [1e-6f64, 0.1, 1.0, 3.0, 10.0, 50.0, 300.0] {
        let forms = [
            (1, 2.0 * normal_tail(x.sqrt())),
            (2, (-x / 2.0).exp()),
            (4, (1.0 + x / 2.0) * (-x / 2.0).exp()),
        ];
        for (ndf, expected) in forms {
            let found = chi_squared_tail(x, ndf);
            assert!((found / expected - 1.0).abs() < 1e-11, "{ndf} {x}: {found}, {expected}");
        }
    }
    // median of many degrees of freedom: ndf (1 - 2 / (9 ndf))^3, to the order of 1 / ndf
    let ndf = 1000.0f64;
    let median = ndf * (1.0 - 2.0 / (9.0 * ndf)).powi(3);
    assert!((chi_squared_tail(median, 1000) - 0.5).abs() < 1e-4);
    assert_eq!(chi_squared_tail(3.0, 0), 1.0);
    assert_eq!(chi_squared_tail(f64::NAN, 3), 1.0);
}

/// Histories with probabilities 1/2, 1/4, 1/8, ...: rare ones are pooled.
fn geometric(seed: u64, count: usize) -> PhotonSample {
    let track = |(photon, u): (i64, f64)| {
        let rows = (-u.max(1e-12).log2()) as usize;
        SampleTrack {
            photon,
            history: [vec![EMISSION], vec![code(Process::FresnelRefraction); rows], vec![code(ABSORBED)]]
                .concat()
                .into(),
            volume: u32::from(u > 0.3),
            time: -u.ln(),
            wavelength_nm: 400.0,
        }
    };
    sample("sample", (0..).zip(uniforms(seed, count)).map(track).collect())
}

/// Two samples of one distribution, of unequal sizes, 300 times: chi squared has the mean ndf and the variance 2 ndf, and p is
/// uniform, each within 4 standard deviations.
#[test]
fn samples_of_one_distribution() {
    const TRIALS: u64 = 300;
    for name in ["history", "volume", "time"] {
        let (mut pull, mut small, mut excess, mut freedom) = (0.0, 0.0, 0.0, 0.0);
        for trial in 0..TRIALS {
            let (a, b) = (geometric(2 * trial, 2000), geometric(2 * trial + 1, 3000));
            let comparison = compared(&a, &b);
            let own = comparison.quantity(name).unwrap();
            assert_eq!(own.totals, [2000, 3000]);
            assert_eq!(own.bins.iter().map(|bin| bin.counts[1]).sum::<u64>(), 3000, "{name}");
            assert!(own.ndf > 0, "{name}");
            let ndf = own.ndf as f64;
            freedom += ndf;
            excess += own.chi2 - ndf;
            pull += own.z;
            small += f64::from(u8::from(own.p < 0.2));
        }
        let trials = TRIALS as f64;
        assert!((excess / (2.0 * freedom).sqrt()).abs() < 4.0, "{name}: {excess} of {freedom}");
        assert!((pull / trials.sqrt()).abs() < 4.0, "{name}: {}", pull / trials);
        assert!((small - 0.2 * trials).abs() < 4.0 * (0.16 * trials).sqrt(), "{name}: {small}");
    }
}

/// Photons that end in a volume with the given fraction.
fn split(count: u64, inside: u64) -> PhotonSample {
    let track = |photon: u64| SampleTrack {
        photon: photon as i64,
        history: [EMISSION, code(if photon < inside { ABSORBED } else { ESCAPED })].into(),
        volume: u32::from(photon < inside),
        time: 1.0,
        wavelength_nm: 400.0,
    };
    sample("split", (0..count).map(track).collect())
}

/// A planted difference of fractions: z = (p - q) / sqrt(r (1 - r) (1 / n + 1 / m)) with the pooled fraction r, and chi squared of two
/// bins is its square.
#[test]
fn a_planted_shift() {
    let (n, m, a, b) = (10_000u64, 20_000u64, 5_200u64, 10_000u64);
    let comparison = compared(&split(n, a), &split(m, b));
    let pooled = (a + b) as f64 / (n + m) as f64;
    let expected = (a as f64 / n as f64 - b as f64 / m as f64)
        / (pooled * (1.0 - pooled) * (1.0 / n as f64 + 1.0 / m as f64)).sqrt();
    assert!(expected > 3.0);
    for name in ["history", "end", "volume"] {
        let own = comparison.quantity(name).unwrap();
        assert_eq!(own.ndf, 1);
        assert!((own.chi2 - expected * expected).abs() < 1e-9, "{name}: {}", own.chi2);
        assert!((own.p - 2.0 * normal_tail(expected)).abs() < 1e-12, "{name}");
        assert!((normal_tail(own.z) - own.p).abs() < 1e-12, "{name}");
        assert!(own.bins.iter().all(|bin| (bin.z.abs() - expected).abs() < 1e-9), "{name}");
    }
    assert!((comparison.end_z("absorbed").unwrap() - expected).abs() < 1e-9);
    // single values have a single bin: nothing to compare
    let time = comparison.quantity("time").unwrap();
    assert_eq!((time.ndf, time.p, time.z, time.bins.len()), (0, 1.0, 0.0, 1));
}

/// Times that differ by rounding are equal; times that are 20 % longer are found.
#[test]
fn shifts_of_times() {
    let scaled = |factor: f64| {
        let mut own = geometric(7, 4000);
        own.tracks.iter_mut().for_each(|track| track.time = (20.0 * track.time).round().max(1.0) * factor);
        own
    };
    let same = compared(&scaled(1.0), &scaled(1.0 + 1e-12));
    assert_eq!(same.quantity("time").unwrap().chi2, 0.0);
    assert!(same.quantity("time").unwrap().ndf > 10);
    let longer = compared(&geometric(7, 4000), &{
        let mut own = geometric(8, 4000);
        own.tracks.iter_mut().for_each(|track| track.time *= 1.2);
        own
    });
    // the noncentrality is about n m / (n + m) ln(1.2)^2 = 66, beside the standard deviation 10 of 50 bins
    assert!(longer.quantity("time").unwrap().p < 1e-3, "{:?}", longer.quantity("time").unwrap().p);
}

/// Pooled histories have their common beginning as label, and every bin has the expected number of photons.
#[test]
fn rare_histories_are_pooled() {
    let (a, b) = (geometric(1, 2000), geometric(2, 2000));
    let comparison = compared(&a, &b);
    let own = comparison.quantity("history").unwrap();
    assert!(own.bins.iter().all(|bin| bin.counts[0] + bin.counts[1] >= 10), "{:?}", own.bins);
    assert!(own.bins.iter().any(|bin| bin.label.ends_with("...") || bin.label.ends_with("others")));
    assert_eq!(own.bins[0].label, "emission absorbed");
    let options = CompareOptions { least: 300.0, ..CompareOptions::default() };
    let coarse = compare(&a, &b, &options).unwrap();
    let coarse = coarse.quantity("history").unwrap();
    assert!(coarse.ndf < own.ndf && coarse.bins.iter().all(|bin| bin.counts[0] + bin.counts[1] >= 600));
}

/// Runs of the same photons: the first photon and row that differ are found; independent runs have no first difference.
#[test]
fn the_first_difference() {
    let a = geometric(3, 500);
    let mut b = a.clone();
    let insert = |track: &mut SampleTrack, at: usize, process: Process| {
        let mut codes = track.history.to_vec();
        codes.insert(at, code(process));
        track.history = codes.into();
    };
    insert(&mut b.tracks[123], 1, Process::FresnelReflection);
    let end = b.tracks[200].history.len();
    insert(&mut b.tracks[200], end, ABSORBED);
    let pairs = compared(&a, &b).pairs.unwrap();
    assert_eq!((pairs.photons, pairs.equal), (500, 498));
    let first = pairs.first_difference.unwrap();
    assert_eq!((first.photon, first.row), (123, 1));
    assert!(first.histories[1].starts_with("emission fresnel_reflection"), "{first:?}");
    let pairs = compared(&a, &geometric(4, 500)).pairs.unwrap();
    // the expected number of equal histories is the sum of products of fractions, here 1 / 3
    assert!((pairs.expected - 500.0 / 3.0).abs() < 40.0, "{}", pairs.expected);
    assert!(!pairs.is_same_run() && pairs.first_difference.is_none());
}

/// The tracks of a photon are one history, in any order of the further ones.
#[test]
fn tracks_of_a_photon_are_one_history() {
    let track =
        |photon, history: &[u8]| SampleTrack { photon, history: history.into(), ..SampleTrack::default() };
    let reemission = code(Process::Reemission);
    let tracks = |swap: bool| {
        let mut list = Vec::new();
        for photon in 0..100 {
            let further = [ABSORBED, ESCAPED].map(|end| track(photon, &[reemission, code(end)]));
            list.push(track(photon, &[EMISSION, reemission, code(ABSORBED)]));
            list.extend(if swap { [further[1].clone(), further[0].clone()] } else { further });
        }
        sample("tracks", list)
    };
    let comparison = compared(&tracks(false), &tracks(true));
    let own = comparison.quantity("history").unwrap();
    assert_eq!((own.bins.len(), own.totals), (1, [100, 100]));
    assert_eq!(own.bins[0].label, "emission reemission absorbed | reemission absorbed | reemission escaped");
    assert_eq!(comparison.quantity("end").unwrap().totals, [300, 300]);
}

/// The z of two fractions: 400 of 10,000 and 90 of 2,000, with the pooled fraction 490 / 12,000.
#[test]
fn hits_are_compared_as_fractions_of_the_photons() {
    let hits = |name: &str, count: usize| {
        let tracks = (0..count).map(|k| SampleTrack { photon: k as i64, ..SampleTrack::default() });
        let own = sample(name, tracks.collect());
        PhotonSample { alphabet: None, volumes: None, is_hits: true, has_times: true, ..own }
    };
    let (a, b) = (hits("a", 400), hits("b", 90));
    let z = |photons: Option<[u64; 2]>| {
        let options = CompareOptions { photons, ..CompareOptions::default() };
        compare(&a, &b, &options).map(|found| found.hits_z).map_err(|error| error.to_string())
    };
    let pooled = 490.0 / 12_000.0;
    let expected = (0.04 - 0.045) / f64::sqrt(pooled * (1.0 - pooled) * (1.0 / 10_000.0 + 1.0 / 2_000.0));
    assert!((z(Some([10_000, 2_000])).unwrap() - expected).abs() < 1e-12);
    assert!((z(None).unwrap() - 310.0 / f64::sqrt(490.0)).abs() < 1e-12);
    assert_eq!(z(Some([10_000, 80])).unwrap_err(), "b has hits of 90 photons: 80 photons are stated.");
    let all = geometric(1, 100);
    let options = CompareOptions { photons: Some([100, 100]), ..CompareOptions::default() };
    assert!(compare(&all, &all, &options).unwrap_err().to_string().contains("have no effect"));
}

/// Invalid options and empty samples are errors.
#[test]
fn errors() {
    let a = geometric(1, 100);
    for least in [0.5, f64::NAN, f64::INFINITY] {
        let options = CompareOptions { least, ..CompareOptions::default() };
        assert!(compare(&a, &a, &options).unwrap_err().to_string().contains("at least 1"));
    }
    let empty = sample("none.csv", Vec::new());
    let text = compare(&a, &empty, &CompareOptions::default()).unwrap_err().to_string();
    assert_eq!(text, "none.csv cannot be compared: the file has no photons.");
    let dark = split(50, 50);
    let options = CompareOptions { hits: true, ..CompareOptions::default() };
    let text = compare(&dark, &dark, &options).unwrap_err().to_string();
    assert_eq!(text, "split cannot be compared: no photon is detected.");
}
