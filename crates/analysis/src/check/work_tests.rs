//! The work of searches for walls and gaps, counted in leaves times rays.

use super::edges::{Grid, Hits};
use super::facing::Search;
use super::narrow::Narrow;
use super::probe::Budget;
use crate::counted::Counted;
use crate::survey::{Piece, Survey, survey};
use rayweave_math::Vec3;
use rayweave_model::drive::Cancel;
use rayweave_model::{Evaluator, Program, Region, Solid};
use rayweave_shape::primitive::{Primitive, Sphere};
use std::sync::Arc;

/// The number of balls in one place, each a region.
const BALLS: usize = 100;

/// The work of the search for edges of the balls within a budget, leaves times rays and an eighth of it for points, and the numbers of points of edges and of candidates left out.
fn search_of_edges(budget: u64) -> (u64, u64, u64) {
    let ball = |k: usize| Region {
        name: k.to_string(),
        solid: Solid::from(Primitive::from(Sphere::new(10.0).unwrap())).translate(Vec3::new(
            (k * 7 % 10) as f64,
            (k * 3 % 10) as f64,
            (k % 13) as f64,
        )),
        medium: k as u32 + 1,
    };
    let regions: Vec<Region> = (0..BALLS).map(ball).collect();
    let program = Arc::new(Program::compile_regions(&regions).unwrap());
    let evaluator = Counted::new(program);
    let frame = evaluator.program().bounds();
    let grid = Grid::new(&frame, &frame);
    let settings =
        Survey { bounds: frame, across: 32, seed: 0, stream: 0, threads: None, cancel: Cancel::new() };
    let mut hits = Hits::default();
    let visit = |hits: &mut Hits, piece: &Piece<'_>| hits.add(piece, &grid, evaluator.program());
    survey(&evaluator, &settings, visit, |some: Hits| hits.append(some)).unwrap();
    evaluator.take();
    let mut search = Search::new(evaluator.program(), frame, 1e-3, BALLS as u64);
    let mut scratch = evaluator.scratch();
    search.add(&evaluator, &hits, &grid, &|_| true, &mut Budget::of(budget), &mut scratch);
    let [rays, points] = evaluator.take();
    ((rays + points / 8) * BALLS as u64, search.count, search.left_out)
}

#[test]
fn searches_of_edges_stay_within_their_work() {
    let (all, most, _) = search_of_edges(u64::MAX);
    assert!(all > 2_000_000 && most > 0, "{all} {most}");
    for budget in [0, 100_000, 1_000_000] {
        let (work, count, left_out) = search_of_edges(budget);
        assert!(work <= budget && count <= most && left_out > 0, "{budget}: {work} {count} {left_out}");
    }
}

/// Each part of a budget gets the same share of what the parts before have left.
#[test]
fn budgets_are_shared() {
    let mut whole = Budget::of(100);
    let mut first = whole.part(4);
    assert!(first.takes(5) && !first.takes(21));
    whole.add(first);
    assert!(!whole.part(3).takes(33) && whole.takes(63));
}

/// Chords beside an edge take one ray each, not the hundreds that lead to the edge.
#[test]
fn chords_at_edges_are_not_followed() {
    let ball = Solid::from(Primitive::from(Sphere::new(10.0).unwrap()));
    let crescent = ball.translate(Vec3::X) - ball.clone();
    let evaluator = Counted::new(Arc::new(Program::compile(&crescent).unwrap()));
    let bounds = evaluator.program().bounds();
    let settings = Survey { bounds, across: 32, seed: 0, stream: 0, threads: None, cancel: Cancel::new() };
    let mut narrow = Narrow::default();
    let visit = |found: &mut Narrow, piece: &Piece<'_>| {
        if piece.wall().is_some() && piece.thickness() < 0.05 {
            found.add(piece);
        }
    };
    survey(&evaluator, &settings, visit, |some: Narrow| narrow.append(some)).unwrap();
    let (sides, mut scratch) = (narrow.widths().count() as u64, evaluator.scratch());
    let mut rays = |are_edges: bool| {
        evaluator.take();
        let found = narrow.measured_by_side(&evaluator, &mut |_, _| are_edges, &mut scratch);
        (evaluator.take()[0], found.len())
    };
    let ((few, none), (many, all)) = (rays(true), rays(false));
    assert!(sides > 3 && few <= 4 * sides && none == 0, "{sides} {few} {none}");
    assert!(many > 100 * few && all > 0, "{many} {few} {all}");
}
