//! Crossings of lines with solids, against rational arithmetic, planes and winding numbers.

mod shapes;

use dashu::rational::RBig;
use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};
use rayweave_math::{Affine, Vec3};
use rayweave_mesh::{Line, Mesh, MeshCrossing, MeshError, Polyhedron};
use shapes::{ASIDE, ball, both, cuboid, potato, torus, vector, winding};

fn crossings(solid: &Polyhedron, line: &Line) -> Vec<MeshCrossing> {
    let mut found = Vec::new();
    solid.crossings(line, &ASIDE, &mut found);
    found
}

fn times(solid: &Polyhedron, origin: Vec3, direction: Vec3) -> Vec<f64> {
    crossings(solid, &Line { origin, direction }).iter().map(|crossing| crossing.t).collect()
}

type Exact = [RBig; 3];

fn exact(v: Vec3) -> Exact {
    v.to_array().map(|x| RBig::try_from(x).unwrap())
}

fn minus(a: &Exact, b: &Exact) -> Exact {
    std::array::from_fn(|k| &a[k] - &b[k])
}

/// The determinant of three vectors.
fn det(a: &Exact, b: &Exact, c: &Exact) -> RBig {
    let minor = |i: usize, j: usize| &b[i] * &c[j] - &b[j] * &c[i];
    &a[0] * minor(1, 2) + &a[1] * minor(2, 0) + &a[2] * minor(0, 1)
}

/// The triangles that a line crosses, with times, in rational arithmetic. The line must not intersect an
/// edge.
fn crossed_exactly(mesh: &Mesh, line: &Line) -> Vec<(u32, f64)> {
    let (o, d) = (exact(line.origin), exact(line.direction));
    let mut found = Vec::new();
    for triangle in 0..mesh.triangles().len() {
        let [a, b, c] = mesh.corners(triangle).map(|corner| minus(&exact(corner), &o));
        let sides = [det(&d, &a, &b), det(&d, &b, &c), det(&d, &c, &a)];
        assert!(sides.iter().all(|side| *side != RBig::ZERO));
        if sides.iter().all(|s| *s > RBig::ZERO) || sides.iter().all(|s| *s < RBig::ZERO) {
            let t = det(&a, &b, &c) / (&sides[0] + &sides[1] + &sides[2]);
            found.push((triangle as u32, t.to_f64().value()));
        }
    }
    found.sort_by(|a, b| a.1.total_cmp(&b.1));
    found
}

#[test]
fn lines_in_general_position_agree_with_rationals() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let mut many = 0;
    for mesh in [torus(2.0, 0.7, 14, 9), potato(2), cuboid(-Vec3::ONE, Vec3::ONE)] {
        let solid = Polyhedron::new(&mesh).unwrap();
        for _ in 0..60 {
            let line = Line { origin: 1.5 * vector(&mut rng), direction: vector(&mut rng) };
            let truth = crossed_exactly(&mesh, &line);
            let found = crossings(&solid, &line);
            assert_eq!(found.len(), truth.len(), "{line:?}");
            for (found, truth) in found.iter().zip(&truth) {
                assert_eq!(found.triangle, truth.0);
                let magnitude = line.origin.length() + 3.0;
                let distance = (found.t - truth.1).abs() * line.direction.length();
                assert!(distance < 1e-13 * magnitude, "{distance}");
            }
            many += usize::from(found.len() > 2);
        }
    }
    assert!(many >= 5, "{many}");
}

/// A line through corners or along edges, often with small integer components.
fn hostile_line(mesh: &Mesh, rng: &mut ChaCha8Rng) -> Line {
    let mut corner = || {
        let [a, b, c] = mesh.corners(rng.random_range(0..mesh.triangles().len()));
        match rng.random_range(0..4) {
            0 => a,
            1 => 0.5 * (a + b),
            2 => b + 0.25 * (c - b),
            _ => c,
        }
    };
    let (from, to) = (corner(), corner());
    let [a, b, _] = mesh.corners(rng.random_range(0..mesh.triangles().len()));
    let along = [Vec3::X, Vec3::Y, Vec3::Z, b - a, to - from][rng.random_range(0..5)];
    let back = [0.0, 1.0, 3.0, 1e3][rng.random_range(0..4)];
    let direction = if along == Vec3::ZERO { Vec3::X } else { along };
    Line { origin: to - back * direction, direction }
}

/// Checks lines through corners and edges and in faces: the number of crossings is even, and between them containment agrees with
/// the winding number (solid angles) at points away from the mesh. Returns the number of compared points.
fn check_hostile_lines(mesh: &Mesh, rays: usize, compare: usize, seed: u64) -> usize {
    let solid = Polyhedron::new(mesh).unwrap();
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let size = mesh.bounds().size().max_element();
    let mut compared = 0;
    for k in 0..rays {
        let line = hostile_line(mesh, &mut rng);
        let found = crossings(&solid, &line);
        assert!(found.len().is_multiple_of(2), "{line:?} {found:?}");
        if k >= compare {
            continue;
        }
        for (index, pair) in found.windows(2).enumerate() {
            let point = line.at(0.5 * (pair[0].t + pair[1].t));
            let delta = line.delta(pair[1].t, solid.magnitude());
            if solid.nearest(point, (16.0 * delta).max(1e-7 * size)).is_none() {
                let inside = winding(mesh, point).abs() > 0.5;
                assert_eq!(index % 2 == 0, inside, "{line:?} at {point:?}");
                compared += 1;
            }
        }
    }
    compared
}

#[test]
fn lines_through_corners_and_edges_agree_with_winding_numbers() {
    let far = 1e6 * Vec3::new(1.0, -1.0, 1.0);
    let turn = Affine::rotation(Vec3::new(1.0, 2.0, 3.0), 33.0);
    let mut compared = 0;
    for (seed, mesh) in
        [cuboid(-Vec3::ONE, Vec3::ONE), torus(2.0, 0.5, 16, 8), potato(2)].into_iter().enumerate()
    {
        for (scale, shift) in
            [(1.0, Vec3::ZERO), (1.0, far), (1e-6, Vec3::ZERO), (1e6, far), (1e-60, Vec3::ZERO)]
        {
            for turned in [false, true] {
                let map = |p: Vec3| scale * if turned { turn.point(p) } else { p } + shift;
                compared += check_hostile_lines(&mesh.mapped(map).unwrap(), 1000, 60, seed as u64);
            }
        }
    }
    assert!(compared > 500, "{compared}");
}

#[test]
#[ignore = "long"]
fn long_lines_through_corners_and_edges_have_even_crossings() {
    for (seed, mesh) in [torus(2.0, 0.5, 64, 32), potato(4), cuboid(-Vec3::ONE, Vec3::ONE)].iter().enumerate()
    {
        check_hostile_lines(mesh, 400_000, 200, 100 + seed as u64);
    }
}

/// A triangulated ball is convex: a line is inside where it is inside all planes.
#[test]
fn chords_of_a_convex_mesh_are_those_of_its_planes() {
    let mesh = ball(3, |_| 1.0);
    let solid = Polyhedron::new(&mesh).unwrap();
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let (mut hits, mut misses) = (0, 0);
    for _ in 0..300 {
        let line = Line { origin: vector(&mut rng) * 2.0, direction: vector(&mut rng) };
        let (mut enter, mut leave) = (f64::NEG_INFINITY, f64::INFINITY);
        for triangle in 0..mesh.triangles().len() {
            let [a, b, c] = mesh.corners(triangle);
            let normal = (b - a).cross(c - a);
            let (slope, t) =
                (normal.dot(line.direction), normal.dot(a - line.origin) / normal.dot(line.direction));
            (enter, leave) = if slope < 0.0 { (enter.max(t), leave) } else { (enter, leave.min(t)) };
        }
        let found = times(&solid, line.origin, line.direction);
        if enter >= leave {
            assert!(found.is_empty());
            misses += 1;
            continue;
        }
        hits += 1;
        assert_eq!(found.len(), 2);
        assert!((found[0] - enter).abs() < 1e-12 && (found[1] - leave).abs() < 1e-12);
    }
    assert!(hits > 50 && misses > 50, "{hits} {misses}");
}

/// A line in a face, exactly or nearly, counts as moved along the perturbation direction, in any orientation of the face.
#[test]
fn a_line_in_a_face_is_on_one_side_of_it() {
    let cube = cuboid(Vec3::ZERO, Vec3::ONE);
    for degrees in [0.0, 30.0, 77.0] {
        let turn = Affine::rotation(Vec3::new(3.0, 1.0, 2.0), degrees);
        let solid = Polyhedron::new(&cube.mapped(|p| turn.point(p)).unwrap()).unwrap();
        for axis in 0..3 {
            let (mut along, mut normal) = (Vec3::ZERO, Vec3::ZERO);
            along[(axis + 1) % 3] = 1.0;
            along[(axis + 2) % 3] = 0.25;
            normal[axis] = 1.0;
            for face in [0.0, 1.0] {
                let origin = face * normal + Vec3::splat(0.25) - 0.25 * normal - 3.0 * along;
                let found = times(&solid, turn.point(origin), turn.vector(along));
                let leads_up = turn.vector(normal).dot(ASIDE[0]) > 0.0;
                let inside = leads_up == (face == 0.0);
                assert_eq!(found.len(), if inside { 2 } else { 0 }, "{degrees} {axis} {face} {found:?}");
            }
        }
    }
}

/// A line in the common face of two solids crosses exactly one of them, for any triangulations.
#[test]
fn a_line_in_a_common_face_is_in_one_of_two_solids() {
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    for _ in 0..40 {
        let turn = Affine::rotation(vector(&mut rng), rng.random_range(0.0..180.0));
        let map = |mesh: Mesh| Polyhedron::new(&mesh.mapped(|p| turn.point(p)).unwrap()).unwrap();
        let lower = map(cuboid(Vec3::new(-2.0, -1.0, -1.0), Vec3::new(2.0, 1.0, 0.0)));
        let upper = map(cuboid(Vec3::new(-2.0, -1.0, 0.0), Vec3::new(2.0, 3.0, 1.5)));
        let along = Vec3::new(1.0, rng.random_range(-0.2..0.2), 0.0);
        let origin = turn.point(Vec3::new(0.0, rng.random_range(-0.4..0.4), 0.0) - 5.0 * along);
        let counts = [&lower, &upper].map(|solid| times(solid, origin, turn.vector(along)).len());
        assert!(counts == [2, 0] || counts == [0, 2], "{counts:?}");
    }
}

#[test]
fn two_boxes_with_a_common_face_are_one() {
    let pair = both(&cuboid(Vec3::ZERO, Vec3::ONE), &cuboid(Vec3::X, Vec3::new(2.0, 1.0, 1.0)));
    let solid = Polyhedron::new(&pair).unwrap();
    let found = times(&solid, Vec3::new(-1.0, 0.3, 0.4), Vec3::X);
    // both crossings of the common face have the same time, to the bit
    assert_eq!(found, [1.0, 2.0, 2.0, 3.0]);
    assert!(solid.contains(Vec3::new(1.0 + 1e-9, 0.5, 0.5), &ASIDE));
    assert!(!solid.contains(Vec3::new(1.0, 1.5, 0.5), &ASIDE));
}

#[test]
fn shells_within_shells_are_cavities() {
    let nested = both(&ball(2, |_| 1.0), &ball(2, |_| 0.5));
    let solid = Polyhedron::new(&nested).unwrap();
    let inside = [0.0, 0.3, 0.7, 0.9, 1.1].map(|x| solid.contains(Vec3::new(x, 0.01, 0.02), &ASIDE));
    assert_eq!(inside, [false, false, true, true, false]);
}

/// Containment against winding numbers (solid angles).
#[test]
fn containment_agrees_with_winding_numbers() {
    let mesh = potato(2);
    let solid = Polyhedron::new(&mesh).unwrap();
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let mut inside = 0;
    for _ in 0..500 {
        let point = 1.4 * vector(&mut rng);
        let truth = winding(&mesh, point) > 0.5;
        assert_eq!(solid.contains(point, &ASIDE), truth, "{point:?}");
        inside += usize::from(truth);
    }
    assert!((100..400).contains(&inside), "{inside}");
}

/// The distance from a box, which has a closed form.
#[test]
fn the_nearest_point_of_a_box_agrees_with_the_closed_form() {
    let solid = Polyhedron::new(&cuboid(-Vec3::ONE, Vec3::ONE)).unwrap();
    let mut rng = ChaCha8Rng::seed_from_u64(6);
    for _ in 0..500 {
        let point = 3.0 * vector(&mut rng);
        let clamped = point.clamp(-Vec3::ONE, Vec3::ONE);
        let outside = (point - clamped).length();
        let inside = (Vec3::ONE - point.abs()).min_element();
        let truth = if outside > 0.0 { outside } else { inside };
        let found = solid.nearest(point, 10.0).unwrap();
        assert!(((found.point - point).length() - truth).abs() < 1e-14);
        assert_eq!(solid.nearest(point, 0.999 * truth), None);
    }
}

#[test]
fn faces_are_those_in_one_plane_and_no_others() {
    let solid = Polyhedron::new(&cuboid(Vec3::ZERO, Vec3::ONE)).unwrap();
    let mut faces: Vec<u32> = (0..12).map(|triangle| solid.face(triangle)).collect();
    assert!((0..12).all(|triangle| solid.face(triangle) == solid.face(triangle ^ 1)));
    faces.sort_unstable();
    faces.dedup();
    assert_eq!(faces.len(), 6);
    assert_eq!(solid.normal(0), -Vec3::Z);
}

#[test]
fn open_meshes_are_rejected() {
    let mesh = cuboid(Vec3::ZERO, Vec3::ONE);
    let open = Mesh::new(mesh.vertices().to_vec(), mesh.triangles()[1..].to_vec()).unwrap();
    assert!(matches!(Polyhedron::new(&open), Err(MeshError::Open { edges: 3, .. })));
    assert_eq!(Polyhedron::new(&Mesh::default()).unwrap_err(), MeshError::Empty);
}

/// Time and memory of a large mesh; run with `--release` for figures.
#[test]
#[ignore = "long"]
fn long_a_million_triangles() {
    let clock = std::time::Instant::now();
    let mesh = torus(2.0, 0.5, 1000, 500);
    let made = clock.elapsed();
    let solid = Polyhedron::new(&mesh).unwrap();
    let built = clock.elapsed() - made;
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let lines: Vec<Line> = (0..100_000)
        .map(|_| {
            let (origin, at) = (10.0 * vector(&mut rng), 2.0 * vector(&mut rng));
            Line { origin, direction: at - origin }
        })
        .collect();
    let clock = std::time::Instant::now();
    let (mut found, mut count) = (Vec::new(), 0);
    for line in &lines {
        solid.crossings(line, &ASIDE, &mut found);
        count += found.len();
    }
    let traced = clock.elapsed();
    let bytes = solid.bytes() as f64 / solid.triangle_count() as f64;
    println!(
        "build {built:?}, {bytes:.1} bytes a triangle, {:?} a line, {count} crossings",
        traced / 100_000
    );
    assert!(bytes < 60.0 && count > 50_000);
}
