//! Comparison of two runs of photons, from files.

use std::path::PathBuf;

use pyo3::prelude::*;
use rayweave::photon::{CompareOptions, ComparedQuantity, Comparison, Pairs, compare, read_sample};

use crate::error::{bad_value, require_file};
use crate::interrupt::abandonable;

/// Name, numbers of photons, chi squared, degrees of freedom, p, z; bins: label, numbers of photons, z.
type Quantity = (&'static str, (u64, u64), f64, u64, f64, f64, Vec<(String, (u64, u64), f64)>);

/// Photons in both samples, equal and expected equal ones, whether they are one run; the first difference: photon, row, histories.
type Pair = (u64, u64, f64, bool, Option<(i64, usize, (String, String))>);

/// Names, numbers of photons, whether only hits are compared, the sentence about equal runs, z of their number; quantities; what is missing;
/// pairs.
type Row =
    ((String, String), (u64, u64), bool, Option<String>, f64, Vec<Quantity>, Vec<String>, Option<Pair>);

/// Compares two files of photons: see `rayweave.photons.compare`.
#[pyfunction]
#[pyo3(signature = (a, b, least, flags, hits, photons) -> "CompareRow")]
pub fn compare_photons(
    py: Python<'_>,
    a: PathBuf,
    b: PathBuf,
    least: f64,
    flags: bool,
    hits: bool,
    photons: Option<[u64; 2]>,
) -> PyResult<Row> {
    require_file(&a)?;
    require_file(&b)?;
    abandonable(py, move || {
        let options = CompareOptions { least, flags, hits, photons };
        let (a, b) = (read_sample(&a).map_err(bad_value)?, read_sample(&b).map_err(bad_value)?);
        compare(&a, &b, &options).map(row).map_err(bad_value)
    })?
}

fn pair<T>([a, b]: [T; 2]) -> (T, T) {
    (a, b)
}

fn row(found: Comparison) -> Row {
    let equality = found.equality();
    let quantities = found.quantities.into_iter().map(quantity).collect();
    let names = pair(found.names);
    (
        names,
        pair(found.photons),
        found.is_hits,
        equality,
        found.hits_z,
        quantities,
        found.missing,
        found.pairs.map(pairs),
    )
}

fn quantity(own: ComparedQuantity) -> Quantity {
    let bins = own.bins.into_iter().map(|bin| (bin.label, pair(bin.counts), bin.z)).collect();
    (own.name, pair(own.totals), own.chi2, own.ndf, own.p, own.z, bins)
}

fn pairs(own: Pairs) -> Pair {
    let is_same_run = own.is_same_run();
    let first = own.first_difference.map(|first| (first.photon, first.row, pair(first.histories)));
    (own.photons, own.equal, own.expected, is_same_run, first)
}
