//! `rayweave photons compare`: two runs of photons, bin by bin.

use crate::failure::Failure;
use crate::terminal;
use clap::Args;
use rayweave::photon::{CompareOptions, ComparedQuantity, Comparison, compare, read_sample};
use serde_json::{Value, json};
use std::path::PathBuf;

/// Compare two runs of photons: their histories, ends, volumes, times and wavelengths
///
/// A and B are tables of histories (--histories), steps (--steps) or hits (-o) of `rayweave photons` or of the script for Geant4,
/// .csv or .npy, or arrays of Opticks: photons (n, 4, 4) and sequences (n, 2, 2). What both have is compared, as chi squared with
/// its number of degrees of freedom (ndf), and z, the standard deviations of a normal distribution with the same probability p.
///
/// Bins need an expected number of photons in each sample; histories with fewer are pooled by their common beginnings, and other
/// values with each other. Times and wavelengths have bins with equal numbers of photons of A and B together. If A and B are runs of
/// the same photons, the first photon with different histories is reported; of equal runs, only that they are equal.
#[derive(Args)]
#[command(after_help = "\
Examples:
  rayweave photons detector.gdml --at 0,0,0 --wavelength 420 -n 100000 --histories ours.csv
  rayweave photons compare ours.csv geant4.csv
  rayweave photons compare hits.csv geant4hits.csv --photons 100000 20000
  rayweave photons compare ours.csv seq.npy --json")]
pub struct PhotonCompare {
    /// The first run
    a: PathBuf,

    /// The second run
    b: PathBuf,

    /// Number of expected photons of each run that a bin needs
    #[arg(long, value_name = "N", default_value_t = 5.0)]
    least: f64,

    /// Compare Opticks' flags of processes rather than processes
    #[arg(long)]
    flags: bool,

    /// Compare detected photons alone
    #[arg(long)]
    hits: bool,

    /// Numbers of simulated photons of A and B, for a comparison of hits: tables of hits do not have them [default: equal numbers]
    #[arg(long, value_name = "N", num_args = 2, value_names = ["N", "M"], value_parser = crate::arguments::any_count::<u64>)]
    photons: Option<Vec<u64>>,

    /// Number of bins to print for each quantity: those with the largest differences
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = crate::arguments::any_count::<usize>)]
    bins: usize,

    /// Print JSON, with all bins
    #[arg(long)]
    json: bool,
}

impl PhotonCompare {
    pub fn run(&self) -> Result<(), Failure> {
        let (a, b) = (read_sample(&self.a)?, read_sample(&self.b)?);
        let photons = self.photons.as_deref().and_then(|own| <[u64; 2]>::try_from(own).ok());
        let options = CompareOptions { least: self.least, flags: self.flags, hits: self.hits, photons };
        let comparison = compare(&a, &b, &options)?;
        terminal::print(&match self.json {
            true => format!("{:#}\n", as_json(&comparison)),
            false => self.as_text(&comparison),
        })
    }

    fn as_text(&self, comparison: &Comparison) -> String {
        let Comparison { names: [a, b], photons: [n, m], .. } = comparison;
        let what = if comparison.is_hits { "hits" } else { "photons" };
        let mut text = format!("A {a}: {n} {what}\nB {b}: {m} {what}\n");
        if let Some(equality) = comparison.equality() {
            return format!("{text}{equality}\n") + &not_compared(comparison);
        }
        if comparison.is_hits {
            let z = terminal::short3(comparison.hits_z);
            let of_photons = match self.photons.as_deref() {
                Some(&[n, m]) => format!("as fractions of {n} and {m} photons"),
                _ => "if A and B have equal numbers of photons; --photons N M states others".to_owned(),
            };
            text += &format!("number of hits: z {z}, {of_photons}\n");
        }
        let header = ["quantity", "A", "B", "chi2", "ndf", "chi2/ndf", "p", "z"];
        let rows: Vec<Vec<String>> = comparison.quantities.iter().map(row).collect();
        let is_number = [false, true, true, true, true, true, true, true];
        text += &format!("\n{}", terminal::table(&header, &rows, &is_number));
        for quantity in &comparison.quantities {
            text += &self.largest(quantity);
        }
        text + &not_compared(comparison) + &pairs(comparison)
    }

    /// The bins of a quantity with the largest differences.
    fn largest(&self, quantity: &ComparedQuantity) -> String {
        let mut bins: Vec<_> = quantity.bins.iter().collect();
        bins.sort_by(|a, b| b.z.abs().total_cmp(&a.z.abs()));
        bins.truncate(self.bins);
        if bins.is_empty() {
            return String::new();
        }
        let row = |bin: &&rayweave::photon::ComparedBin| {
            let z = format!("{:.2}", bin.z);
            vec![bin.counts[0].to_string(), bin.counts[1].to_string(), z, bin.label.clone()]
        };
        let rows: Vec<Vec<String>> = bins.iter().map(row).collect();
        format!("\n{}", terminal::table(&["A", "B", "z", quantity.name], &rows, &[true, true, true, false]))
    }
}

/// The lines about quantities that are not compared.
fn not_compared(comparison: &Comparison) -> String {
    comparison.missing.iter().map(|reason| format!("\nnot compared: {reason}\n")).collect()
}

fn row(quantity: &ComparedQuantity) -> Vec<String> {
    let ComparedQuantity { name, totals: [a, b], chi2, ndf, p, z, .. } = quantity;
    let ratio = if *ndf > 0 { format!("{:.3}", chi2 / *ndf as f64) } else { "-".to_owned() };
    let numbers = [format!("{chi2:.2}"), ndf.to_string(), ratio, probability(*p), format!("{z:.2}")];
    [vec![(*name).to_owned(), a.to_string(), b.to_string()], numbers.into()].concat()
}

/// A probability with three digits; below the range of f64, a limit instead of 0.
fn probability(p: f64) -> String {
    if p < 1e-300 { "< 1e-300".to_owned() } else { terminal::short3(p) }
}

/// The photons that both samples have.
fn pairs(comparison: &Comparison) -> String {
    let Some(pairs) = comparison.pairs.as_ref().filter(|pairs| pairs.is_same_run()) else {
        return String::new();
    };
    let mut text = format!("\n{} of {} photons have equal histories\n", pairs.equal, pairs.photons);
    if let Some(first) = &pairs.first_difference {
        let [a, b] = &first.histories;
        let place = format!("photon {}, row {}", first.photon, first.row);
        text += &format!("first difference: {place}\nA {a}\nB {b}\n");
    }
    text
}

fn as_json(comparison: &Comparison) -> Value {
    let quantity = |own: &ComparedQuantity| {
        let bins = own.bins.iter().map(|bin| json!({ "label": bin.label, "counts": bin.counts, "z": bin.z }));
        json!({
            "name": own.name,
            "totals": own.totals,
            "chi2": own.chi2,
            "ndf": own.ndf,
            "p": own.p,
            "z": own.z,
            "bins": bins.collect::<Vec<_>>(),
        })
    };
    let pairs = comparison.pairs.as_ref().map(|pairs| {
        let first = pairs
            .first_difference
            .as_ref()
            .map(|first| json!({ "photon": first.photon, "row": first.row, "histories": first.histories }));
        json!({
            "photons": pairs.photons,
            "equal": pairs.equal,
            "expected": pairs.expected,
            "is_same_run": pairs.is_same_run(),
            "first_difference": first,
        })
    });
    json!({
        "a": comparison.names[0],
        "b": comparison.names[1],
        "photons": comparison.photons,
        "is_hits": comparison.is_hits,
        "is_equal": comparison.is_equal,
        "hits_z": comparison.hits_z,
        "quantities": comparison.quantities.iter().map(quantity).collect::<Vec<_>>(),
        "missing": comparison.missing,
        "pairs": pairs,
    })
}
