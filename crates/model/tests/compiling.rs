//! Compilation of small solids, compared as text.

use rayweave_math::{Affine, Bounds, Vec3};
use rayweave_model::{CompileProblem, LeafId, LeafKind, PlacementId, Program, PrototypeId, Region, Solid};
use rayweave_shape::primitive::{Value, build};

fn shape(name: &str, arguments: &[(&str, f64)]) -> Solid {
    let arguments: Vec<_> = arguments.iter().map(|&(n, v)| (n, Value::Number(v))).collect();
    Solid::from(build(name, &arguments).unwrap())
}

/// Unit spheres along x, two apart: neighbours are in contact.
fn balls<const N: usize>() -> [Solid; N] {
    row(2.0)
}

/// Unit spheres along x.
fn row<const N: usize>(step: f64) -> [Solid; N] {
    std::array::from_fn(|k| shape("sphere", &[("radius", 1.0)]).translate([step * k as f64, 0.0, 0.0]))
}

#[track_caller]
fn check(solid: &Solid, expected: &str) {
    let program = Program::compile(solid).unwrap();
    assert_eq!(program.expression_text(PrototypeId(0)), expected);
}

#[test]
fn chains_are_flat_and_complements_at_the_leaves() {
    let [a, b, c, d] = row(0.25);
    check(&(&a | &b | &c | &d), "any{0, 1, 2, 3}");
    check(&(&a | (&b | (&c | &d))), "any{0, 1, 2, 3}");
    check(&(&a - &b - &c), "all{0, ~1, ~2}");
    check(&(&a - (&b | &c)), "all{0, ~1, ~2}");
    check(&(&a - (&b - &c)), "all{0, any{~1, 2}}");
    check(&!(&a & !&b), "any{~0, 1}");
    check(&(&a ^ &b ^ !&c), "~odd{0, 1, 2}");
    check(&(!&a & !&b), "all{~0, ~1}");
}

#[test]
fn constants_vanish() {
    let [a, b] = balls();
    check(&(&a | Solid::empty()), "0");
    check(&(&a & Solid::empty()), "empty");
    check(&(&a | Solid::universe()), "universe");
    check(&(&a - &a), "empty");
    check(&(&a | !&a), "universe");
    check(&(&a ^ &a ^ &b), "1");
    check(&Solid::union([]), "empty");
    check(&Solid::intersection([]), "universe");
}

#[test]
fn leaves_that_bounds_show_not_to_matter_are_unused() {
    let [a, b, c, d] = balls();
    // neighbours are in contact, which does not count as disjoint
    check(&(&a - &b - &c - &d), "all{0, ~1}");
    check(&(&a & &b), "all{0, 1}");
    check(&(&a & &c), "empty");
    check(&((&a & &c) | &b), "2");
    check(&(!&a | (&c & &d)), "~0");
    check(&((&a | &b | &c) & &d), "all{2, 3}");
    let program = Program::compile(&(&a - &c)).unwrap();
    assert_eq!(program.leaves().len(), 2);
    assert!(!program.leaf(LeafId(1)).is_used() && program.leaf(LeafId(0)).is_used());
    assert!(program.matters(program.prototype(PrototypeId(0)))[1].is_empty());
    assert_eq!(program.surfaces().len(), 2);
}

#[test]
fn a_solid_used_twice_is_one_leaf() {
    let [a, b, c] = row(0.25);
    check(&((&a & &b) | (&a & &c)), "any{all{0, 1}, all{0, 2}}");
    // doubled forty times: linear in the number of steps
    let mut twice = a;
    for _ in 0..40 {
        twice = (&twice & &b) | (&twice - &c);
    }
    let program = Program::compile(&twice).unwrap();
    assert_eq!(program.leaves().len(), 3);
    assert!(program.prototype(PrototypeId(0)).network.gate_count() < 200);
}

#[test]
fn touching_faces_share_a_surface() {
    let unit = shape("box", &[("size", 1.0)]);
    let turned = |s: &Solid| s.rotate([1.0, 2.0, 3.0], 33.0).translate([0.1, 0.2, 0.3]);
    let pair = turned(&unit) | turned(&unit.translate([1.0, 0.0, 0.0]));
    let program = Program::compile(&pair).unwrap();
    // six faces each; x+ coincides with x-, and the four sides are coplanar
    assert_eq!(program.surfaces().len(), 7);
    assert_eq!(program.facets().len(), 12);
}

#[test]
fn names_lead_to_faces() {
    let [a, b] = balls();
    let lens = (a.named("front") & b.translate([1.0, 0.0, 0.0])).named("lens");
    let program = Program::compile(&lens).unwrap();
    let names: Vec<String> = program.face_names().collect();
    assert!(names[0].starts_with("front.") && names[1].starts_with("lens.sphere."), "{names:?}");
    assert_eq!(program.regions()[0].name, "lens");
}

#[test]
fn errors_say_where() {
    let [a, b] = balls();
    let flat = (&a | &b.scale([1.0, 0.0, 1.0]).named("flat")).named("part");
    let error = Program::compile(&flat).unwrap_err();
    assert!(matches!(error.problem, CompileProblem::Transform(_)), "{error:?}");
    assert_eq!(
        error.to_string(),
        "part/flat/transform: the transform is singular: it has no inverse. Check for a scale factor of 0."
    );
    let nan = a.translate([f64::NAN, 0.0, 0.0]);
    assert!(Program::compile(&nan).unwrap_err().to_string().contains("NaN"));
    let lost = a.place(vec![Affine::IDENTITY, Affine::scale(Vec3::ZERO)]);
    assert_eq!(Program::compile(&lost).unwrap_err().path, "place[1]");
}

#[test]
fn placements_are_numbered_depth_first() {
    let [a, b] = balls();
    let shift = |x: f64| Affine::translate(Vec3::new(x, 0.0, 0.0));
    let pair = (&a | &b).place(vec![shift(0.0), shift(10.0)]);
    let grid = pair.place(vec![shift(0.0), shift(100.0), shift(200.0)]);
    let program = Program::compile(&(grid | shape("box", &[("size", 1.0)]))).unwrap();
    assert_eq!(program.prototypes().len(), 3);
    assert_eq!(program.prototype(PrototypeId(0)).placements, 10);
    // 0 the model; 1 first pair, 2 and 3 in it; 4 second pair, ...
    let origin = |k: u32| program.placement(PlacementId(k)).0.point(Vec3::ZERO).x;
    assert_eq!(
        (0..10).map(origin).collect::<Vec<_>>(),
        [0., 0., 0., 10., 100., 100., 110., 200., 200., 210.]
    );
    assert!(matches!(program.leaf(LeafId(0)).kind(), LeafKind::Instance { .. }));
}

#[test]
fn copies_keep_their_maps_to_the_bit() {
    let [a, b] = balls();
    let turn = |k: u32| {
        Affine::scale(Vec3::new(1.0, 1.0 + 0.1 * f64::from(k), 0.7))
            .then(&Affine::rotation(Vec3::new(1.0, 2.0, f64::from(k)), 17.0 * f64::from(k)))
            .then(&Affine::translate(Vec3::new(0.1 * f64::from(k), 3.0, -1.0 / 3.0)))
    };
    let shift = |k: u32| turn(2).then(&Affine::translate(Vec3::new(0.1 * f64::from(k), 1e-3, 7.0)));
    let outer =
        Affine::rotation(Vec3::new(1.0, 1.0, 0.2), 33.0).then(&Affine::translate(Vec3::new(0.3, 0.2, 0.1)));
    let families: [&dyn Fn(u32) -> Affine; 2] = [&turn, &shift];
    for (maps, placed) in families.map(|map| ((0..5).map(map).collect::<Vec<_>>(), a.named("ball"))) {
        let row = placed.place(maps.clone());
        let program = Program::compile(&(&b | &row.apply(outer).named("row") | &row)).unwrap();
        assert_eq!(program.leaves().len(), 12);
        // leaf 0 is the ball; then the copies within the map, then those without it
        for (k, map) in maps.iter().map(|map| map.then(&outer)).chain(maps.iter().copied()).enumerate() {
            let leaf = program.leaf(LeafId(k as u32 + 1));
            assert_eq!(program.placement(PlacementId(k as u32 + 1)), (map, PrototypeId(1)));
            assert_eq!(program.descend(PlacementId(k as u32 + 1)).collect::<Vec<_>>(), [leaf.place()]);
            assert_eq!(leaf.place().local_from_world, map.inverse().unwrap());
            let (run, within) = (if k < 5 { "row" } else { "place" }, k % 5);
            assert_eq!(leaf.name(), format!("{run}[{within}]"));
            assert_eq!(
                program.leaf_bounds(leaf.id()),
                Bounds::centred(Vec3::ZERO, Vec3::ONE).transformed(&map)
            );
        }
    }
}

#[test]
fn faces_of_all_copies_are_named() {
    let [a, b] = balls();
    let row = a.named("dot").place([0.0, 9.0].map(|x| Affine::translate(Vec3::new(x, 5.0, 0.0))).to_vec());
    let tile = shape("box", &[("size", 1.0)]).named("tile");
    let solid =
        Solid::union([row.clone(), tile, row.apply(Affine::translate(Vec3::Z)), Solid::universe(), b]);
    let program = Program::compile(&solid).unwrap();
    let names: Vec<String> = program.face_names().collect();
    let tiles = ["x-", "x+", "y-", "y+", "z-", "z+"].map(|face| format!("tile.{face}"));
    assert_eq!(names[..6], tiles);
    // the face of the ball after the second row, then that of the placed solid
    assert_eq!(names[6..], ["sphere.side", "dot.side"]);
    for (number, name) in names.iter().enumerate() {
        assert_eq!(program.face_name(number as u32), *name);
    }
}

#[test]
fn too_many_placements_are_rejected() {
    let shifts: Vec<_> = (0..2000).map(|k| Affine::translate(Vec3::splat(f64::from(k)))).collect();
    let [a] = balls();
    let error = Program::compile(&a.place(shifts.clone()).place(shifts.clone()).place(shifts)).unwrap_err();
    assert_eq!(error.problem, CompileProblem::TooLarge { what: "placements" });
}

#[test]
fn bounds_follow_the_operators() {
    let [a, b, c] = balls();
    let of = |s: &Solid| Program::compile(s).unwrap().bounds();
    let ball = |x: f64| Bounds::centred(Vec3::new(x, 0.0, 0.0), Vec3::ONE);
    assert_eq!(of(&(&a | &b)), ball(0.0).union(&ball(2.0)));
    assert_eq!(of(&(&a - &b)), ball(0.0));
    assert!(of(&(&a & &c)).is_empty());
    assert_eq!(of(&!&a), Bounds::ALL);
    assert_eq!(of(&(&a & shape("cylinder", &[("radius", 0.5)]))).size(), Vec3::new(1.0, 1.0, 2.0));
}

#[test]
fn regions_keep_their_order_and_media() {
    let [a, b] = balls();
    let region =
        |name: &str, solid: &Solid, medium| Region { name: name.into(), solid: solid.clone(), medium };
    let program = Program::compile_regions(&[region("crown", &a, 2), region("flint", &b, 1)]).unwrap();
    assert_eq!(program.expression_text(PrototypeId(0)), "0\n1");
    assert_eq!(program.medium_of(rayweave_model::RegionId(1)), 2);
    assert_eq!(program.medium_of(rayweave_model::RegionId(0)), 0);
    assert_eq!(Program::compile_regions(&[]).unwrap().regions().len(), 0);
}

#[test]
fn printing_uses_the_fewest_parentheses() {
    let [a, b, c] = balls();
    let (a, b, c) = (a.named("a"), b.named("b"), c.named("c"));
    let check = |s: Solid, text: &str| assert_eq!(s.to_string(), text);
    check(&a - (&b - &c), "a - (b - c)");
    check(&a - &b - &c, "a - b - c");
    check((&a | &b) & &c, "(a | b) & c");
    check(&a | &b & &c, "a | b & c");
    check(!(&a ^ &b), "~(a ^ b)");
    check(!&a - &b, "~a - b");
    check((&a | &b).translate([1.0, 2.0, 3.0]), "(a | b).translate(1, 2, 3)");
    check((&a | &b).named("pair"), "pair = a | b");
    check(Solid::union([a.clone()]), "union(a)");
    check(shape("sphere", &[("radius", 2.0)]), "sphere(radius=2)");
}

/// Beyond 1e100 squares and products of lengths overflow: rays and models are rejected there.
#[test]
fn models_out_of_reach_are_rejected() {
    let ball = shape("sphere", &[("radius", 1.0)]);
    let problem = |solid: &Solid| Program::compile(solid).err().map(|error| error.problem);
    for far in [1e101, 1e200] {
        assert_eq!(problem(&ball.translate([0.0, far, 0.0])), Some(CompileProblem::NotFinite));
        assert_eq!(problem(&ball.scale(Vec3::splat(far))), Some(CompileProblem::NotFinite));
        let places = [Affine::IDENTITY, Affine::translate(Vec3::new(far, 0.0, 0.0))];
        assert_eq!(problem(&ball.place(places)), Some(CompileProblem::NotFinite));
        // the inverse translation does not restore the lost digits
        assert_eq!(
            problem(&ball.translate([far, 0.0, 0.0]).translate([-far, 0.0, 0.0])),
            Some(CompileProblem::NotFinite)
        );
    }
    assert_eq!(problem(&ball.translate([0.0, 1e99, 0.0])), None);
    let text = CompileProblem::NotFinite.to_string();
    assert!(text.contains("beyond 1e100") && text.ends_with("Is a scale far too large or small?"), "{text}");
}

/// `s | s.translate(v)`, repeated `steps` times: 2^steps leaves.
fn doubled(steps: usize) -> Solid {
    let ball = shape("sphere", &[("radius", 1.0)]);
    (0..steps).fold(ball, |s, k| &s | s.translate([3.0 * 2f64.powi(k as i32), 0.0, 0.0]))
}

#[test]
fn repeated_parts_are_counted_before_they_are_copied() {
    assert_eq!(Program::compile(&doubled(10)).unwrap().leaves().len(), 1024);
    assert!(doubled(10).has_more_leaves_than(1023) && !doubled(10).has_more_leaves_than(1024));
    let few = shape("sphere", &[("radius", 1.0)]);
    let chain = |step: &dyn Fn(&Solid) -> Solid| (0..60).fold(few.clone(), |s, _| step(&s));
    let steps: [&dyn Fn(&Solid) -> Solid; 4] = [
        &|s| s | s.translate([1.0, 0.0, 0.0]),
        &|s| s.named("a") | s.named("b"),
        &|s| {
            Solid::union([s.rotate_x(10.0), s.clone(), s.rotate_x(20.0)])
                .place([Affine::scale([2.0; 3].into())])
        },
        // without leaves, but with as many visits
        &|s| (s & Solid::empty()) | s.translate([1.0, 0.0, 0.0]),
    ];
    for (number, step) in steps.iter().enumerate() {
        let start = std::time::Instant::now();
        let error = Program::compile(&chain(*step)).unwrap_err();
        assert!(matches!(error.problem, CompileProblem::Repeated { .. }), "{number}: {error}");
        assert!(start.elapsed().as_secs() < 5, "{number}");
    }
}

#[test]
fn unmoved_repetitions_share_their_leaves() {
    let [ball, other] = row(0.5);
    for step in [
        &(|s: &Solid| s | s) as &dyn Fn(&Solid) -> Solid,
        &|s| s & s,
        &|s| s | s.translate([0.0; 3]),
        &|s| s.rotate_x(0.0) & s.scale([1.0; 3]),
        &|s| s.place([Affine::IDENTITY]) | s,
    ] {
        let solid = (0..60).fold(&ball | &other, |s, _| step(&s));
        check(&solid, "any{0, 1}");
    }
    // the text of this formula is long, because shared parts occur in it as often as they are used
    let rest = (0..60).fold(&ball | &other, |s, _| &s - s.translate([0.0; 3]));
    assert_eq!(Program::compile(&rest).unwrap().leaves().len(), 2);
}
