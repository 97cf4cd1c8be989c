//! Boolean operations on hit arrays, compared with NumPy.

use super::{Bench, Exemplar, text};
use crate::answer::{Agreement, columns};
use crate::batch::random;
use crate::ceiling::Need;
use crate::interleaved::{Candidate, Role, measure_in_turn};
use crate::report::Section;
use rand::RngExt;
use rayweave::rootray::hit_array::{CsgOptions, Float, HitArray, Operation, array_csg_into};
use std::num::NonZeroUsize;

/// The number of columns of the arrays.
const COLUMNS: usize = 1 << 20;

/// The number of columns whose results are compared.
const COMPARED: usize = 1000;

/// The union of two arrays of `rows` entries each.
struct ArrayCsg {
    name: String,
    rows: usize,
    is_double: bool,
}

/// H = 2, 4, 8, 16; f64, f32.
pub fn all() -> Vec<Box<dyn Exemplar>> {
    let one = |(rows, is_double)| {
        let kind = if is_double { "f64" } else { "f32" };
        let name = format!("array_csg/{rows}/{kind}");
        Box::new(ArrayCsg { name, rows, is_double }) as Box<dyn Exemplar>
    };
    [true, false].into_iter().flat_map(|double| [2, 4, 8, 16].map(|rows| (rows, double))).map(one).collect()
}

impl Exemplar for ArrayCsg {
    fn name(&self) -> &str {
        &self.name
    }

    fn about(&self) -> &str {
        "The union of two hit arrays with H entries for each of 2^20 rays, written to an existing array, checks included; \
         the minimum traffic is 2 H entries read and 2 H written per ray."
    }

    fn measure(&self, bench: &Bench) -> Result<Vec<Section>, String> {
        match self.is_double {
            true => self.measure_as::<f64>(bench, |t| t),
            false => self.measure_as::<f32>(bench, |t| t as f32),
        }
    }
}

impl ArrayCsg {
    fn measure_as<T: Float + npyz::Serialize + npyz::AutoSerialize>(
        &self,
        bench: &Bench,
        number: impl Fn(f64) -> T,
    ) -> Result<Vec<Section>, String> {
        let count = bench.effort.size(COLUMNS);
        let arrays = [1, 2].map(|seed| array(self.rows, count, seed, &number));
        let file = self.name.replace('/', "-");
        let both = arrays.iter().flatten().copied();
        bench.peers.give(&file, &[2, self.rows, count], both).map_err(text)?;
        let mut out = vec![T::INFINITY; 2 * self.rows * count];
        unite(&arrays, self.rows, count, 1, &mut out)?;
        let expected: Vec<f64> = out.iter().map(|t| t.to_f64()).collect();

        let arrays = &arrays;
        let mut candidates = bench.on_threads(|threads| {
            let mut out = out.clone();
            let run = move || {
                // the same call has succeeded before
                let _ = unite(arrays, self.rows, count, threads, &mut out);
            };
            Candidate::here("array_csg", Role::Ours, count, run).threads(threads)
        });
        let whole = |candidate: Candidate<'static>| candidate.whole();
        candidates.extend(bench.peers.candidates("array_csg", &file, count).into_iter().map(whole));
        if bench.threads > 1 {
            let all = bench.peers.candidates("array_csg/all", &file, count).into_iter();
            candidates.extend(all.map(|candidate| candidate.whole().threads(bench.threads)));
        }
        let outcomes = measure_in_turn(candidates, &bench.effort);

        let mut section = Section::new(&*self.name, "ray", self.about());
        let needs = [Need::Bytes((4 * self.rows * size_of::<T>()) as f64)];
        section.take(outcomes, |outcome| bench.floor(&needs, outcome.threads));
        let rows: Vec<&[f64]> = expected.chunks(count).collect();
        let ours = columns(&rows, COMPARED.min(count));
        for (name, answer) in bench.peers.answers("array_csg", &file, COMPARED.min(count)) {
            section.agree(&name, answer.map(|theirs| Agreement::of(&ours, &theirs)));
        }
        Ok(vec![section])
    }
}

fn unite<T: Float>(
    arrays: &[Vec<T>; 2],
    rows: usize,
    columns: usize,
    threads: usize,
    out: &mut [T],
) -> Result<(), String> {
    let threads = NonZeroUsize::new(threads).unwrap_or(NonZeroUsize::MIN);
    let options = CsgOptions { threads, ..CsgOptions::default() };
    let view = |data| HitArray::new(data, rows, columns).map_err(text);
    let [a, b] = arrays;
    array_csg_into(view(a)?, view(b)?, Operation::Union, options, out).map_err(text)
}

/// Columns of increasing times with random differences.
fn array<T: Float>(rows: usize, columns: usize, seed: u64, number: impl Fn(f64) -> T) -> Vec<T> {
    let mut random = random(seed);
    let mut times = vec![0.0; columns];
    let mut data = Vec::with_capacity(rows * columns);
    for _ in 0..rows {
        for t in &mut times {
            *t += random.random_range(0.1..1.0);
            data.push(number(*t));
        }
    }
    data
}
