//! Occurrence paths: their texts, their uniqueness, and equal paths from all evaluators.

use rayweave_conformance::rays::{batch, rays};
use rayweave_conformance::{Model, Random, Style};
use rayweave_math::{Affine, Vec3};
use rayweave_model::{Copies, Occurrence, PlacementId, Program, Query, Region, Solid};
use rayweave_model::{Evaluator, RayBatch};
use rayweave_shape::Ray;
use rayweave_shape::primitive::{Value, build};
use rayweave_trace::{Packets, Reference, SingleHit, Spans, Weave};
use std::collections::HashSet;
use std::sync::Arc;

fn shape(name: &str, arguments: &[(&str, f64)]) -> Solid {
    let arguments: Vec<_> = arguments.iter().map(|&(n, v)| (n, Value::Number(v))).collect();
    Solid::from(build(name, &arguments).unwrap())
}

fn ball() -> Solid {
    shape("sphere", &[("radius", 1.0)])
}

/// A torus, whose kind differs from that of a ball.
fn ring() -> Solid {
    shape("torus", &[("major", 0.5), ("minor", 0.25)])
}

/// Maps along x.
fn along(count: usize, step: f64) -> Vec<Affine> {
    (0..count).map(|k| Affine::translate(Vec3::new(k as f64 * step, 0.0, 0.0))).collect()
}

fn paths(program: &Program) -> Vec<String> {
    program.occurrences().map(|occurrence| program.occurrence_path(occurrence).to_string()).collect()
}

#[track_caller]
fn check(solid: &Solid, expected: &[&str]) {
    assert_eq!(paths(&Program::compile(solid).unwrap()), expected);
}

#[test]
fn names_and_kinds_are_the_steps() {
    check(&ball(), &["sphere"]);
    check(&ball().named("a"), &["a"]);
    check(&ball().named("b").translate(Vec3::X).named("a"), &["a/b"]);
    let die = ((ball() - ring().named("hole")) | ball().translate(Vec3::X)).named("die");
    check(&die, &["die/sphere", "die/hole", "die/sphere#2"]);
}

#[test]
fn equal_names_are_numbered() {
    let pin = ball().named("pin");
    let pins = &pin | pin.translate(Vec3::X * 4.0) | pin.translate(Vec3::X * 8.0);
    check(&pins, &["pin", "pin#2", "pin#3"]);
    let bolt = (ball() | ring()).named("bolt");
    let bolts = (&bolt | bolt.translate(Vec3::X * 8.0)).named("plate");
    let both = ["plate/bolt/sphere", "plate/bolt/torus", "plate/bolt#2/sphere", "plate/bolt#2/torus"];
    check(&bolts, &both);
}

#[test]
fn copies_have_the_name_of_what_is_placed() {
    check(&ball().named("pin").place(along(2, 4.0)), &["pin[0]", "pin[1]"]);
    let brick = (ball() - ring()).named("brick");
    let bricks = ["brick[0]/sphere", "brick[0]/torus", "brick[1]/sphere", "brick[1]/torus"];
    check(&brick.place(along(2, 4.0)), &bricks);
    // maps between the name and the placement make no difference
    check(&(brick.translate(Vec3::Y)).place(along(2, 4.0)), &bricks);
    check(&ball().named("a").named("b").place(along(2, 4.0)), &["b[0]/a", "b[1]/a"]);
    // a solid without a name has that of its copies
    check(&ball().place(along(2, 4.0)).named("row"), &["row[0]/sphere", "row[1]/sphere"]);
    check(&ball().place(along(2, 4.0)), &["place[0]/sphere", "place[1]/sphere"]);
    check(&ball().place(along(1, 4.0)).named("row"), &["row"]);
}

#[test]
fn placements_nest() {
    let brick = (ball() - ring().named("hole")).named("brick");
    let tower = brick.place(along(2, 4.0)).named("tower");
    let city = (tower.place(along(2, 40.0)) | ball().translate(Vec3::Y * 9.0)).named("world");
    let program = Program::compile(&city).unwrap();
    let all = paths(&program);
    assert_eq!(all.len(), 9);
    assert_eq!(all[0], "world/sphere");
    assert_eq!(all[1..3], ["world/tower[0]/brick[0]/sphere", "world/tower[0]/brick[0]/hole"]);
    assert_eq!(all[8], "world/tower[1]/brick[1]/hole");
    let last = program.occurrences().last().unwrap();
    assert_eq!(program.occurrence_path(last).placed().to_string(), "world/tower[1]/brick[1]");
    let first = program.occurrences().next().unwrap();
    assert_eq!(program.occurrence_path(first).placed().to_string(), "");
    // without names in between
    let grid = ball().place(along(2, 4.0)).place(along(2, 40.0)).named("grid");
    let expected = [[0, 0], [0, 1], [1, 0], [1, 1]].map(|[i, j]| format!("grid[{i}]/place[{j}]/sphere"));
    assert_eq!(paths(&Program::compile(&grid).unwrap()), expected);
}

#[test]
fn copies_with_equal_names_are_counted_on() {
    let pin = ball().named("pin");
    let two = pin.place(along(2, 4.0)) | ring().named("pin").place(along(2, 4.0)).translate(Vec3::Y * 9.0);
    check(&two, &["pin[0]", "pin[1]", "pin[2]", "pin[3]"]);
}

#[test]
fn labels_replace_names_and_numbers() {
    let labelled = |numbers: &[i64]| Copies::labelled(along(numbers.len(), 4.0), "pmt", Some(numbers.into()));
    let bulb = ball().named("bulb");
    check(&bulb.place_copies(labelled(&[7, -1])), &["pmt[7]/bulb", "pmt[-1]/bulb"]);
    check(&bulb.place_copies(labelled(&[0, 0, 1])), &["pmt[0]/bulb", "pmt[0]#2/bulb", "pmt[1]/bulb"]);
    check(&bulb.place_copies(labelled(&[5])), &["pmt[5]/bulb"]);
    check(&bulb.place_copies(Copies::labelled(along(1, 4.0), "pmt", None)), &["pmt/bulb"]);
    check(
        &bulb.place_copies(Copies::labelled(along(2, 4.0), "a/b", None)),
        &["'a/b'[0]/bulb", "'a/b'[1]/bulb"],
    );
    // the same prototype under its own name
    let both = bulb.place_copies(labelled(&[7, 8])) | bulb.place(along(2, 4.0)).translate(Vec3::Y * 9.0);
    check(&both, &["pmt[7]/bulb", "pmt[8]/bulb", "bulb[0]", "bulb[1]"]);
    let single = Program::compile(&bulb.place_copies(labelled(&[5]))).unwrap();
    let path = single.occurrence_path(single.occurrences().next().unwrap());
    assert_eq!(path.placed().to_string(), "pmt[5]");
}

#[test]
fn numbers_of_occurrences_are_checked() {
    let brick = (ball() - ring()).named("brick");
    let program = Program::compile(&(brick.place(along(3, 4.0)) | ball())).unwrap();
    for occurrence in program.occurrences() {
        assert_eq!(program.occurrence(occurrence.number()), Some(occurrence));
    }
    let [first, last] = [program.occurrences().next(), program.occurrences().last()].map(Option::unwrap);
    let foreign = Occurrence { placement: last.placement, leaf: first.leaf };
    let beyond = Occurrence { placement: PlacementId(4), ..last };
    for unknown in [foreign.number(), beyond.number(), u64::MAX, 1 << 40] {
        assert_eq!(program.occurrence(unknown), None);
    }
}

#[test]
fn paths_of_random_models_differ() {
    for seed in 0..200 {
        let mut rng = Random::new(seed);
        let style = [Style::Generic, Style::Grid, Style::Planes][seed as usize % 3];
        let model = Model::random(&mut rng, style);
        let program = model.compile().unwrap();
        let all = paths(&program);
        let distinct: HashSet<&String> = all.iter().collect();
        assert_eq!(distinct.len(), all.len(), "model {seed}: {all:?}");
        let rays = batch(&rays(&mut rng, style, &model.frame, 100));
        let expected = reported(&Weave::new(program.clone()), &rays);
        assert_eq!(reported(&Reference::new(program.clone()), &rays), expected, "model {seed}");
        assert_eq!(reported(&SingleHit::new(program.clone()).unwrap(), &rays), expected, "model {seed}");
        assert_eq!(reported(&Spans::new(program.clone()), &rays), expected, "model {seed}");
        assert_eq!(reported(&Packets::new(program), &rays), expected, "model {seed}");
    }
}

/// The paths of all crossings.
fn reported<E: Evaluator>(evaluator: &E, rays: &RayBatch) -> Vec<String> {
    let found = evaluator.collect(rays.rays(), &Query::default()).unwrap();
    let path = |occurrence| evaluator.program().occurrence_path(occurrence).to_string();
    found.crossings.iter().map(|crossing| path(crossing.face.occurrence())).collect()
}

/// Names are stored once for all copies: the tables grow by the translations of the copies alone.
#[test]
fn copies_need_no_names() {
    let tube = (ball() - ring().named("hole")).named("tube");
    let compile = |count: usize| {
        let region = Region { name: "tubes".to_owned(), solid: tube.place(along(count, 4.0)), medium: 1 };
        Arc::new(Program::compile_regions(&[region]).unwrap())
    };
    let paths = |program: &Program| program.bytes().iter().find(|(part, _)| *part == "paths").unwrap().1;
    let (few, many) = (compile(10), compile(100_000));
    assert_eq!(paths(&few), paths(&many));
    let ray = Ray { origin: Vec3::new(4.0 * 54_321.0, 0.0, -5.0), direction: Vec3::Z };
    let found = Weave::new(many.clone()).one(ray, &Query::nearest()).unwrap();
    let path = many.occurrence_path(found.crossings[0].face.occurrence());
    assert_eq!(path.to_string(), "tube[54321]/sphere");
}

#[test]
fn long_chains_of_names_need_no_stack() {
    let mut solid = ball();
    for k in 0..100_000 {
        solid = solid.named(if k % 2 == 0 { "a" } else { "b" });
    }
    let program = Program::compile(&solid).unwrap();
    let path = program.occurrence_path(program.occurrences().next().unwrap());
    assert_eq!((path.steps().len(), path.to_string().len()), (100_000, 199_999));
}
