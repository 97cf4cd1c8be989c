//! Wrong answers per million rays, against exact arithmetic, of the algorithms that Rayweave began with and
//! of its evaluators.
//!
//! `cargo run --release -p rayweave-trace --example seeds -- MODELS`: number of models of each family
//! (default 40), fifty rays each. All algorithms get the same leaves, with crossings from our kernels. An
//! answer is the whole list along the ray; it is right if the side at -inf, the number of crossings and all
//! times are right.
//!
//! - *hit arrays*: `array_csg` of PyRayT over the whole tree, as in its numpy code; and the same with equal
//!   times dropped in pairs, which removes only pieces of length zero;
//! - *tables*: single hit by the nine-entry tables and slices of Opticks, from crossing to crossing: the
//!   original tables within the original limits, the original tables without limits, and the corrected tables
//!   without limits;
//! - our evaluators.

use rayweave_conformance::exact::{Answer, Binary, Family, Operator, Trial, trial};
use rayweave_conformance::{Maker, maker};
use rayweave_model::{Evaluator, Program, Query, RayBatch, RegionId, Solid};
use rayweave_rootray::hit_array::{CsgOptions, HitArray, Operation, array_csg};
use rayweave_shape::Ray;
use rayweave_trace::single_hit::seed_view::{self, CompleteTree, Limits, Tables, next, silent};
use rayweave_trace::single_hit::{LeafAnswers, Next};
use rayweave_trace::{Packets, Reference, SingleHit, Spans, Weave};
use std::sync::Arc;

/// Rays per model.
const RAYS: usize = 50;

/// More crossings than any ray has here: a longer sequence is a fault.
const MAX_STEPS: usize = 64;

/// The side at -inf and the crossings of a leaf or a tree along a ray.
#[derive(Clone, Debug)]
struct List {
    starts_inside: bool,
    times: Vec<f64>,
}

/// Computes the lists of the tree for all rays of a trial, from the lists of each leaf.
type Algorithm = Box<dyn Fn(&Trial, &[Vec<List>]) -> Vec<List>>;

fn program(solid: &Solid) -> Arc<Program> {
    Arc::new(Program::compile(solid).expect("a legal solid"))
}

fn lists(make: &Maker, solid: &Solid, rays: &[Ray]) -> Vec<List> {
    let batch: RayBatch = rays.iter().copied().collect();
    let found = make(program(solid)).trace(batch.rays(), &Query::default());
    let list = |i: usize| List {
        starts_inside: found.starts[i] != RegionId(0),
        times: found.of(i).iter().map(|c| c.t).collect(),
    };
    (0..rays.len()).map(list).collect()
}

/// One of our evaluators.
fn ours<E: Evaluator + 'static>(make: fn(Arc<Program>) -> E) -> Algorithm {
    let maker = maker(make);
    Box::new(move |trial, _| lists(&maker, &trial.solid, &trial.rays))
}

fn single_hit(program: Arc<Program>) -> SingleHit {
    SingleHit::new(program).expect("a small model")
}

/// Hit arrays without postprocessing.
fn hit_arrays(trial: &Trial, leaves: &[Vec<List>]) -> Vec<List> {
    let count = trial.rays.len();
    let array = combined(&trial.tree, leaves, count);
    let list = |i: usize| {
        let column: Vec<f64> = array.iter().skip(i).step_by(count).copied().collect();
        let before = column.iter().filter(|t| **t == f64::NEG_INFINITY).count();
        let times = column.into_iter().filter(|t| t.is_finite()).collect();
        List { starts_inside: before % 2 == 1, times }
    };
    (0..count).map(list).collect()
}

/// The hit array of a tree, row by row.
fn combined(tree: &Binary, leaves: &[Vec<List>], count: usize) -> Vec<f64> {
    match tree {
        Binary::Leaf(k) => padded(&leaves[*k], count),
        Binary::Join(operator, both) => {
            let [a, b] = [combined(&both[0], leaves, count), combined(&both[1], leaves, count)];
            let operation = match operator {
                Operator::Union => Operation::Union,
                Operator::Intersection => Operation::Intersect,
                Operator::Difference => Operation::Difference,
            };
            let array = |data| HitArray::new(data, data.len() / count, count).expect("a sorted array");
            array_csg(array(&a), array(&b), operation, CsgOptions::default())
                .expect("two arrays of one width")
        }
    }
}

/// The lists of a leaf as an array: bounded leaves begin and end outside, except where a ray lies in a face.
fn padded(lists: &[List], count: usize) -> Vec<f64> {
    let column = |list: &List| {
        let before = if list.starts_inside { vec![f64::NEG_INFINITY] } else { vec![] };
        [before, list.times.clone()].concat()
    };
    let columns: Vec<Vec<f64>> = lists.iter().map(column).collect();
    let rows = columns.iter().map(Vec::len).max().unwrap_or(0).next_multiple_of(2);
    let entry = |row: usize, i: usize| columns[i].get(row).copied().unwrap_or(f64::INFINITY);
    (0..rows).flat_map(|row| (0..count).map(move |i| (row, i))).map(|(row, i)| entry(row, i)).collect()
}

/// [`hit_arrays`] without entries that are equal in pairs.
fn without_pairs(trial: &Trial, leaves: &[Vec<List>]) -> Vec<List> {
    let mut lists = hit_arrays(trial, leaves);
    for list in &mut lists {
        let mut kept: Vec<f64> = Vec::new();
        for &t in &list.times {
            if kept.last() == Some(&t) {
                kept.pop();
            } else {
                kept.push(t);
            }
        }
        list.times = kept;
    }
    lists
}

/// The leaves of a tree along one ray.
struct Leaves<'a>(Vec<&'a List>);

impl LeafAnswers for Leaves<'_> {
    fn next(&self, leaf: u32, t_min: f64) -> Next {
        let list = self.0[leaf as usize];
        let passed = list.times.partition_point(|&t| t <= t_min);
        Next::new(list.starts_inside ^ (passed % 2 == 1), list.times.get(passed).copied())
    }
}

/// Decision tables, queried from crossing to crossing.
fn tables(tables: Tables, limits: Option<Limits>) -> Algorithm {
    Box::new(move |trial, leaves| {
        let tree = complete(&trial.tree);
        let limits = limits.unwrap_or(Limits::for_height(tree.height()));
        let list = |i: usize| {
            let leaves = Leaves(leaves.iter().map(|lists| &lists[i]).collect());
            let next_change = |t_min: f64| silent(next(&tree, &tables, limits, &leaves, t_min));
            let first = next_change(f64::NEG_INFINITY);
            let times = std::iter::successors(Some(first), |answer| Some(next_change(answer.time())));
            let times = times.map(|answer| answer.time()).take_while(|t| t.is_finite()).take(MAX_STEPS);
            List { starts_inside: first.is_inside(), times: times.collect() }
        };
        (0..trial.rays.len()).map(list).collect()
    })
}

fn complete(tree: &Binary) -> CompleteTree {
    match tree {
        Binary::Leaf(k) => CompleteTree::leaf(*k as u32, false),
        Binary::Join(operator, both) => {
            let operator = match operator {
                Operator::Union => seed_view::Operator::Union,
                Operator::Intersection => seed_view::Operator::Intersection,
                Operator::Difference => seed_view::Operator::Difference,
            };
            CompleteTree::join(operator, &complete(&both[0]), &complete(&both[1]))
        }
    }
}

fn algorithms() -> Vec<(&'static str, Algorithm)> {
    vec![
        ("hit arrays (numpy), as they come", Box::new(hit_arrays)),
        ("hit arrays (numpy), equal pairs dropped", Box::new(without_pairs)),
        ("tables, original, original limits", tables(Tables::original(), Some(Limits::SEED))),
        ("tables, original, no limits", tables(Tables::original(), None)),
        ("tables, mended, no limits", tables(Tables::from_rule(), None)),
        ("`reference`", ours(Reference::new)),
        ("`packets`", ours(Packets::new)),
        ("`weave`", ours(Weave::new)),
        ("`single_hit`", ours(single_hit)),
        ("`spans`", ours(Spans::new)),
    ]
}

/// Counts of a family of models.
struct Count {
    rays: u64,
    /// Rays that cross several surfaces at the same time or lie in one.
    coincident: u64,
    /// Wrong answers per algorithm.
    wrong: Vec<u64>,
}

fn count(family: Family, models: u64, algorithms: &[(&str, Algorithm)]) -> Count {
    let (mut rays, mut coincident, mut wrong) = (0, 0, vec![0; algorithms.len()]);
    let weave = maker(Weave::new);
    for trial in (0..models).filter_map(|seed| trial(family, seed, RAYS)) {
        rays += trial.rays.len() as u64;
        coincident += trial.answers.iter().filter(|a| a.traits.ties || a.traits.lies).count() as u64;
        let leaves: Vec<Vec<List>> =
            trial.leaves.iter().map(|leaf| lists(&weave, leaf, &trial.rays)).collect();
        for (wrong, (_, algorithm)) in wrong.iter_mut().zip(algorithms) {
            let agrees =
                |(answer, list): &(&Answer, List)| answer.agrees_with(list.starts_inside, &list.times);
            let answers = trial.answers.iter().zip(algorithm(&trial, &leaves));
            *wrong += answers.filter(|pair| !agrees(pair)).count() as u64;
        }
    }
    Count { rays, coincident, wrong }
}

fn main() {
    let models = std::env::args().nth(1).and_then(|a| a.parse().ok()).unwrap_or(40);
    let algorithms = algorithms();
    let counts = Family::ALL.map(|family| count(family, models, &algorithms));
    let row = |name: &str, entry: &dyn Fn(&Count) -> String| {
        println!("| {name} | {} |", counts.iter().map(entry).collect::<Vec<_>>().join(" | "));
    };
    println!("| wrong answers per million rays | {} |", Family::ALL.map(Family::name).join(" | "));
    println!("|---|---:|---:|---:|");
    row("rays", &|count| count.rays.to_string());
    row("of these with a coincidence", &|count| count.coincident.to_string());
    for (k, (name, _)) in algorithms.iter().enumerate() {
        row(name, &|count| format!("{:.0}", 1e6 * count.wrong[k] as f64 / count.rays as f64));
    }
}
