//! Diagnosis and repair of meshes with known defects.

mod shapes;

use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};
use rayweave_math::{Affine, Vec3};
use rayweave_mesh::{
    Diagnosis, EarBudget, Mesh, MeshError, PairBudget, Polyhedron, Repair, RepairOptions, triangulate_polygon,
};
use shapes::{ball, both, cuboid, potato, torus, vector};

fn cube() -> Mesh {
    cuboid(Vec3::ZERO, Vec3::ONE)
}

fn with_triangles(mesh: &Mesh, change: impl FnOnce(&mut Vec<[u32; 3]>)) -> Mesh {
    let mut triangles = mesh.triangles().to_vec();
    change(&mut triangles);
    Mesh::new(mesh.vertices().to_vec(), triangles).unwrap()
}

fn repaired(mesh: &Mesh) -> (Mesh, Repair) {
    mesh.repaired(&RepairOptions::default()).unwrap()
}

#[test]
fn sound_meshes_have_no_faults() {
    for mesh in [cube(), torus(2.0, 0.5, 20, 10), potato(3)] {
        let found = mesh.diagnose();
        assert!(found.is_sound(), "{found}");
        assert_eq!((found.components.len(), found.holes.count, found.degenerate.count), (1, 0, 0));
        assert!((found.components[0].volume - mesh.volume()).abs() < 1e-12 * mesh.volume());
        assert_eq!(repaired(&mesh), (mesh.welded(), Repair::default()));
    }
}

/// Shells that cross have no depth: a repair leaves their orientation, while it reverses the cavity of a third shell.
#[test]
fn shells_that_cross_are_not_reversed() {
    for k in 0..27 {
        // the second cube covers a corner, an edge, a face or the middle of the first
        let shift =
            0.4 * Vec3::new(f64::from(k % 3), f64::from(k / 3 % 3), f64::from(k / 9)) - Vec3::splat(0.37);
        let pair = both(&cube(), &cuboid(shift, shift + Vec3::splat(0.8)));
        let found = pair.diagnose();
        let inside_out = |found: &Diagnosis| found.components.iter().filter(|c| c.is_inside_out()).count();
        let crossing = found.components.iter().filter(|shell| shell.is_mixed).count();
        let is_inside = shift.to_array().iter().all(|x| (0.0..=0.2).contains(x));
        assert_eq!(
            (crossing, inside_out(&found)),
            if is_inside { (0, 1) } else { (2, 0) },
            "{shift:?}: {found}"
        );
        let (mesh, done) = repaired(&pair);
        assert_eq!(done.reversed, if is_inside { 12 } else { 0 }, "{shift:?}");
        assert!((mesh.volume() - 1.0 - if is_inside { -0.512 } else { 0.512 }).abs() < 1e-12);
        // beside them, a shell within a shell
        let far = |margin: f64| cuboid(Vec3::splat(5.0 + margin), Vec3::splat(9.0 - margin));
        let (_, done) = repaired(&both(&pair, &both(&far(0.0), &far(1.0))));
        assert_eq!(done.reversed, if is_inside { 24 } else { 12 }, "{shift:?}");
    }
}

#[test]
fn volume_area_and_centre_have_closed_forms() {
    let shift = Vec3::new(1e3, 2e3, -3e3);
    let block = cuboid(shift, shift + Vec3::new(1.0, 2.0, 3.0));
    assert!((block.volume() - 6.0).abs() < 1e-12 && (block.area() - 22.0).abs() < 1e-12);
    assert!((block.centroid().unwrap() - shift - Vec3::new(0.5, 1.0, 1.5)).length() < 1e-12);
    // a torus of n x m cells is a sum of frusta; it tends to 2 pi^2 R r^2 from below by squares of the steps
    let coarse = 2.0 * std::f64::consts::PI.powi(2) * 2.0 * 0.25 - torus(2.0, 0.5, 100, 50).volume();
    let fine = 2.0 * std::f64::consts::PI.powi(2) * 2.0 * 0.25 - torus(2.0, 0.5, 200, 100).volume();
    assert!((coarse / fine - 4.0).abs() < 0.02, "{coarse} {fine}");
}

/// The volume of the solid by the even-odd rule, in closed form, whatever the orientation of the triangles.
#[test]
fn the_volume_of_a_solid_counts_cavities_and_islands() {
    let (lo, hi) = (Vec3::new(1e3, 2e3, -3e3), Vec3::new(1e3 + 9.0, 2e3 + 9.0, -3e3 + 9.0));
    let at = |margin: f64| cuboid(lo + Vec3::splat(margin), hi - Vec3::splat(margin));
    let nested = both(&both(&at(0.0), &at(2.0)), &at(4.0));
    assert!((nested.diagnose().volume().unwrap() - (729.0 - 125.0 + 1.0)).abs() < 1e-9);
    let reversed = with_triangles(&nested, |triangles| triangles.iter_mut().for_each(|t| t.swap(0, 1)));
    assert_eq!(reversed.diagnose().volume(), nested.diagnose().volume());
    assert_eq!(Polyhedron::new(&nested).unwrap().volume(), nested.diagnose().volume());
    // the sum over the triangles would be 1458: 729 twice, and by the even-odd rule 0
    assert_eq!(both(&at(0.0), &at(0.0)).diagnose().volume(), None);
    let crossing = cuboid(lo + Vec3::splat(5.0), hi + Vec3::splat(5.0));
    // all edges cross diagonals of faces: interiors cross although no edge crosses one
    let found = both(&at(0.0), &crossing).diagnose();
    assert!(!found.crossings.is_empty() && !found.is_sound() && found.volume().is_none());
    let open = with_triangles(&at(0.0), |triangles| {
        triangles.pop();
    });
    assert_eq!(open.diagnose().volume(), None);
}

/// Two cubes of side 8 at all whole offsets: the exact volume exists where their surfaces have no common point.
#[test]
fn the_volume_is_unknown_where_surfaces_meet() {
    let first = cuboid(Vec3::ZERO, Vec3::splat(8.0));
    for k in 0..12 * 12 * 12 {
        let offset = [k % 12, k / 12 % 12, k / 144].map(f64::from);
        let found =
            both(&first, &cuboid(offset.into(), Vec3::from_array(offset) + Vec3::splat(8.0))).diagnose();
        // corner to corner the welded vertex is common, edge to edge the welded edge has four triangles
        let is_apart = offset.iter().any(|&x| x > 8.0) || offset == [8.0; 3];
        let is_right = found.volume().map_or(!is_apart, |volume| is_apart && (volume - 1024.0).abs() < 1e-10);
        assert!(is_right, "{offset:?} {found}");
    }
}

#[test]
fn holes_are_found_and_plane_ones_are_filled() {
    let open = with_triangles(&cube(), |triangles| {
        triangles.drain(..2);
    });
    let found = open.diagnose();
    assert_eq!((found.open_edges, found.holes.count), (4, 1));
    let hole = &found.holes.first[0];
    assert_eq!((hole.edges, hole.length, hole.centre), (4, 4.0, Vec3::new(0.5, 0.5, 0.0)));
    assert!(!found.is_closed() && found.to_string().contains("holes: 1 (the first: (0.5, 0.5, 0), 4 edges)"));
    let (closed, done) = repaired(&open);
    assert_eq!(done, Repair { filled: 1, ..Repair::default() });
    assert!(closed.diagnose().is_sound());
    assert_eq!(closed.volume(), 1.0);
    let (unchanged, done) = open.repaired(&RepairOptions::default().with_fill(false)).unwrap();
    assert_eq!((unchanged, done), (open.welded(), Repair::default()));
}

/// The hole around a removed vertex is not planar and stays open.
#[test]
fn non_planar_holes_stay_open() {
    let bent = with_triangles(&potato(2), |triangles| {
        triangles.retain(|corners| !corners.contains(&0));
    });
    let (left, done) = repaired(&bent);
    assert_eq!((done.filled, left.diagnose().holes.count), (0, 1));
    assert!(matches!(Polyhedron::new(&left), Err(MeshError::Open { .. })));
}

#[test]
fn a_star_shaped_hole_is_filled_by_ear_clipping() {
    // a prism over a star, without its top
    let count = 10;
    let at = |k: u32, z: f64| {
        let (radius, angle) = (
            if k.is_multiple_of(2) { 1.0 } else { 0.4 },
            f64::from(k) * std::f64::consts::TAU / f64::from(count),
        );
        Vec3::new(radius * libm::cos(angle), radius * libm::sin(angle), z)
    };
    let mut vertices: Vec<Vec3> =
        (0..count).map(|k| at(k, 0.0)).chain((0..count).map(|k| at(k, 1.0))).collect();
    vertices.push(Vec3::ZERO);
    let mut triangles = Vec::new();
    for k in 0..count {
        let next = (k + 1) % count;
        triangles.extend([[k, next, next + count], [k, next + count, k + count], [2 * count, next, k]]);
    }
    let open = Mesh::new(vertices, triangles).unwrap();
    let (closed, done) = repaired(&open);
    assert_eq!(done.filled, 1);
    let star = 10.0 * 0.5 * 0.4 * libm::sin(std::f64::consts::TAU / 10.0);
    assert!(closed.diagnose().is_sound());
    assert!((closed.volume() - star).abs() < 1e-15 * 10.0, "{} {star}", closed.volume());
}

#[test]
fn wrong_orientations_are_found_and_reversed() {
    let flipped = with_triangles(&potato(2), |triangles| {
        for k in [3, 40, 41] {
            triangles[k].swap(0, 1);
        }
    });
    let found = flipped.diagnose();
    assert_eq!(found.flipped.first, [3, 40, 41]);
    assert!(found.is_closed() && !found.is_sound());
    let (fixed, done) = repaired(&flipped);
    assert_eq!(done.reversed, 3);
    assert!(fixed.diagnose().is_sound());

    let inside_out = with_triangles(&cube(), |triangles| triangles.iter_mut().for_each(|t| t.swap(0, 1)));
    let found = inside_out.diagnose();
    assert!(found.components[0].is_inside_out() && found.flipped.is_empty());
    assert!((repaired(&inside_out).0.volume() - 1.0).abs() < 1e-15);
}

#[test]
fn nested_shells_have_alternating_orientations() {
    let sizes = [4.0, 3.0, 2.0];
    let boxes = sizes.map(|size| cuboid(Vec3::splat(-size), Vec3::splat(size)));
    let nested = both(&both(&boxes[2], &boxes[0]), &boxes[1]);
    let found = nested.diagnose();
    assert_eq!(found.components.iter().map(|shell| shell.depth).collect::<Vec<_>>(), [2, 0, 1]);
    assert!(!found.is_sound());
    let (fixed, done) = repaired(&nested);
    assert_eq!(done.reversed, 12);
    assert!(fixed.diagnose().is_sound());
    assert_eq!(fixed.volume(), 512.0 - 216.0 + 64.0);
}

#[test]
fn degenerate_and_duplicate_triangles_are_found_and_removed() {
    let mut vertices = cube().vertices().to_vec();
    vertices.push(Vec3::new(0.5, 0.0, 0.0));
    let mut triangles = cube().triangles().to_vec();
    triangles.extend([[0, 0, 1], triangles[5], [0, 8, 1]]);
    let broken = Mesh::new(vertices, triangles).unwrap();
    let found = broken.diagnose();
    assert_eq!(found.degenerate.first, [12, 14]);
    assert_eq!(found.duplicates.first, [[5, 13]]);
    let (fixed, done) = repaired(&broken);
    assert_eq!((done.collapsed, done.duplicates), (1, 1));
    // the remaining sliver of three collinear points has open edges, which cannot be repaired safely
    assert!(!fixed.diagnose().is_closed());
}

#[test]
fn close_vertices_are_merged() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let mesh = potato(2);
    // a triangle soup with perturbed corners
    let soup = (0..mesh.triangles().len()).flat_map(|k| mesh.corners(k));
    let shaken: Vec<Vec3> = soup.map(|p| p + 1e-9 * vector(&mut rng)).collect();
    let count = shaken.len() as u32;
    let torn = Mesh::new(shaken, (0..count / 3).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect()).unwrap();
    assert_eq!(torn.diagnose().open_edges, 3 * mesh.triangles().len());
    let (fixed, done) = torn.repaired(&RepairOptions::default().with_weld(1e-8)).unwrap();
    assert_eq!(done.welded, count as usize - mesh.vertices().len());
    assert!(fixed.diagnose().is_sound());
    assert!((fixed.volume() - mesh.volume()).abs() < 1e-7);
}

/// Two interpenetrating boxes: exact predicates report every pair of triangles that share more than an edge.
#[test]
fn self_intersections_are_found() {
    let turn = Affine::rotation(Vec3::new(1.0, 2.0, 0.5), 25.0);
    let tilted = cube().mapped(|p| turn.point(p) + Vec3::new(0.4, 0.3, 0.6)).unwrap();
    let found = both(&cube(), &tilted).diagnose();
    assert!(found.crossings.count > 4 && found.overlaps.is_empty(), "{found}");
    let first = found.crossings.first[0];
    assert!(first.triangles[0] < 12 && first.triangles[1] >= 12 && cube().bounds().contains(first.at));

    // shifted along an axis: side faces overlap, and no edge crosses the interior of a triangle
    let along = cube().mapped(|p| p + Vec3::new(0.5, 0.0, 0.0)).unwrap();
    let found = both(&cube(), &along).diagnose();
    assert!(found.overlaps.count >= 8 && !found.is_sound(), "{found}");

    // adjacent boxes share a face, separate boxes nothing
    let beside = cube().mapped(|p| p + Vec3::new(1.0, 0.0, 0.0)).unwrap();
    let found = both(&cube(), &beside).diagnose();
    assert_eq!((found.crossings.count, found.non_manifold_edges.count), (0, 4 + found.duplicates.count / 2));
    let apart = cube().mapped(|p| p + Vec3::new(1.5, 0.0, 0.0)).unwrap();
    assert!(both(&cube(), &apart).diagnose().is_sound());
}

/// Intersecting pairs against a brute-force test of all pairs.
#[test]
fn intersecting_pairs_agree_with_brute_force() {
    let mut rng = ChaCha8Rng::seed_from_u64(9);
    for _ in 0..5 {
        let shift = 0.7 * vector(&mut rng);
        let other = ball(1, |_| 1.0).mapped(|p| p + shift).unwrap();
        let pair = both(&ball(1, |_| 1.0), &other);
        let found = pair.diagnose().crossings;
        let truth = (0..80).flat_map(|a| (80..160).map(move |b| (a, b)));
        let truth: Vec<[u32; 2]> = truth
            .filter(|&(a, b)| intersect(pair.corners(a as usize), pair.corners(b as usize)))
            .map(|(a, b)| [a, b])
            .collect();
        assert_eq!(found.first.iter().map(|x| x.triangles).collect::<Vec<_>>(), truth);
        assert!(!truth.is_empty());
    }
}

/// True if an edge of one triangle crosses the other (T. Möller, B. Trumbore, 1997), for triangles in general position.
fn intersect(a: [Vec3; 3], b: [Vec3; 3]) -> bool {
    let hits = |p: Vec3, q: Vec3, [a, b, c]: [Vec3; 3]| {
        let (d, e, f) = (q - p, b - a, c - a);
        let h = d.cross(f);
        let det = e.dot(h);
        let (u, s) = ((p - a).dot(h) / det, (p - a).cross(e));
        let (v, t) = (d.dot(s) / det, f.dot(s) / det);
        u >= 0.0 && v >= 0.0 && u + v <= 1.0 && (0.0..=1.0).contains(&t)
    };
    (0..3).any(|k| hits(a[k], a[(k + 1) % 3], b) || hits(b[k], b[(k + 1) % 3], a))
}

#[test]
fn non_manifold_vertices_and_edges_are_found() {
    // two tetrahedra that share a corner, and two boxes that share an edge
    let tip = Vec3::ZERO;
    let corners = [Vec3::X, Vec3::Y, Vec3::Z];
    let vertices: Vec<Vec3> = [tip].into_iter().chain(corners).chain(corners.map(|p| -p)).collect();
    let sides = |a: u32, b: u32, c: u32| [[0, b, a], [0, c, b], [0, a, c], [a, b, c]];
    let triangles = sides(1, 2, 3).into_iter().chain(sides(4, 6, 5)).collect();
    let found = Mesh::new(vertices, triangles).unwrap().diagnose();
    assert_eq!(found.non_manifold_vertices.first, [tip]);
    assert!(found.is_closed() && found.components.len() == 2);
    let found = both(&cube(), &cuboid(Vec3::new(1.0, 1.0, 0.0), Vec3::new(2.0, 2.0, 1.0))).diagnose();
    assert_eq!(found.non_manifold_edges.first, [Vec3::new(1.0, 1.0, 0.5)]);
    assert_eq!(found.components.len(), 2);
    assert!(found.components.iter().all(|shell| shell.is_closed && shell.volume > 0.0));
}

/// A Klein bottle: a grid with one seam joined in reverse.
#[test]
fn non_orientable_shells_are_reported() {
    let (rows, columns) = (8u32, 6u32);
    let number = |i: u32, j: u32| {
        let j = if i == rows { (columns - j % columns) % columns } else { j % columns };
        (i % rows) * columns + j
    };
    let cells = (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j)));
    let triangles: Vec<[u32; 3]> = cells
        .flat_map(|(i, j)| {
            let [a, b, c, d] = [number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    let vertices = (0..rows * columns).map(|_| vector(&mut rng)).collect();
    let found = Mesh::new(vertices, triangles).unwrap().diagnose();
    assert!(found.is_closed() && !found.components[0].is_orientable && !found.is_sound());
}

#[test]
fn invalid_coordinates_and_indices_are_rejected_with_their_location() {
    let bad = |point: Vec3| Mesh::new(vec![Vec3::ZERO, point], vec![]).unwrap_err().to_string();
    assert!(
        bad(Vec3::new(0.0, f64::NAN, 0.0))
            .starts_with("vertex 1 is (0.0, NaN, 0.0): coordinates must be finite")
    );
    assert!(bad(Vec3::new(0.0, 0.0, 1e61)).contains("1e61"));
    let error = Mesh::new(vec![Vec3::ZERO; 3], vec![[0, 1, 2], [0, 3, 1]]).unwrap_err();
    assert_eq!(error, MeshError::Index { triangle: 1, vertex: 3, count: 3 });
}

/// Random triangles between few points.
#[test]
fn random_soups_are_diagnosed_and_repaired() {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    for _ in 0..300 {
        let points = rng.random_range(3..12u32);
        let coordinate = |rng: &mut ChaCha8Rng| f64::from(rng.random_range(0..3i32));
        let vertices = (0..points)
            .map(|_| Vec3::new(coordinate(&mut rng), coordinate(&mut rng), coordinate(&mut rng)))
            .collect();
        let count = rng.random_range(0..20);
        let triangles = (0..count).map(|_| [0, 1, 2].map(|_| rng.random_range(0..points))).collect();
        let mesh = Mesh::new(vertices, triangles).unwrap();
        let found = mesh.diagnose();
        match Polyhedron::new(&mesh) {
            Ok(_) => assert!(found.is_closed()),
            Err(MeshError::Open { edges, .. }) => assert_eq!(edges, found.open_edges),
            Err(error) => assert_eq!((error, found.open_edges), (MeshError::Empty, 0)),
        }
        let (fixed, done) = mesh.repaired(&RepairOptions::default().with_weld(0.5)).unwrap();
        assert!(fixed.diagnose().duplicates.is_empty() || done.filled > 0);
        let again = fixed.repaired(&RepairOptions::default()).unwrap().1;
        assert_eq!((again.welded, again.collapsed), (0, 0));
    }
}

/// Triangles close together, each kind of which took quadratic time or more: the time limit is for a slow machine without
/// optimisation.
#[test]
fn many_triangles_in_one_place_take_little_time() {
    let start = std::time::Instant::now();
    let cube = cube();
    // duplicates count, but only the first is compared with the others
    let repeated = with_triangles(&cube, |triangles| {
        let first = triangles[0];
        triangles.extend(std::iter::repeat_n(first, 8_000));
    });
    let found = repeated.diagnose();
    assert_eq!((found.duplicates.count, found.overlaps.count, found.uncompared), (8_000, 0, None));
    assert!(!found.is_sound() && found.is_closed());
    assert_eq!(repaired(&repeated).0.triangles().len(), 12);
    // a fan of a large polygon, and needles through one point
    let count = 400;
    let angle = |k: usize| 2.0 * std::f64::consts::PI * k as f64 / count as f64;
    let rim = |k: usize| Vec3::new(libm::cos(angle(k)), libm::sin(angle(k)), 0.3 * libm::sin(angle(k)));
    let fan =
        Mesh::new((0..count).map(rim).collect(), (1..count as u32 - 1).map(|k| [0, k, k + 1]).collect());
    let found = fan.unwrap().diagnose_within(&mut PairBudget::of(20_000));
    assert!(found.uncompared.is_some() && !found.is_sound());
    assert!(found.to_string().contains("too many triangles are close together"), "{found}");
    let needle = |k: usize| [rim(k), -rim(k), rim(k) + 1e-3 * Vec3::Z];
    let needles = Mesh::new(
        (0..count).flat_map(needle).collect(),
        (0..count as u32).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect(),
    )
    .unwrap();
    // the meshes of a file share a budget
    let mut budget = PairBudget::of(count * count);
    assert!(needles.diagnose_within(&mut budget).uncompared.is_none());
    let found = needles.diagnose_within(&mut budget);
    assert!(found.uncompared.is_some() && found.crossings.count > 0);
    assert!(start.elapsed().as_secs() < 60);
}

/// A chain of open edges that ends in many small loops: the walk along it is not repeated for each.
#[test]
fn boundary_loops_at_the_end_of_a_chain_are_found_once() {
    let (mut vertices, mut triangles) = (vec![Vec3::ZERO], Vec::new());
    let count = 3000;
    // a strip of triangles that share one vertex each makes one long loop with small ones hanging on it
    for k in 0..count {
        let x = f64::from(k);
        vertices.extend([Vec3::new(x + 0.5, 1.0, 0.0), Vec3::new(x + 1.0, 0.0, 0.0)]);
        let first = 2 * k as u32;
        triangles.push([first, first + 2, first + 1]);
    }
    let start = std::time::Instant::now();
    let found = Mesh::new(vertices, triangles).unwrap().diagnose();
    assert_eq!(found.open_edges, 3 * count as usize);
    assert_eq!(
        found.holes.first.iter().map(|hole| hole.edges).sum::<usize>(),
        3 * found.holes.count.min(1000)
    );
    assert_eq!(found.holes.count, count as usize);
    assert!(start.elapsed().as_secs() < 20);
}

#[test]
fn large_polygons_are_triangulated_within_a_budget() {
    let area = |vertices: &[Vec3], triangles: &[[u32; 3]]| {
        let of = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|k| vertices[k as usize]);
            0.5 * (b - a).cross(c - a).z
        };
        triangles.iter().map(of).sum::<f64>()
    };
    let polygon = |count: usize, radius: &dyn Fn(usize) -> f64| -> Vec<Vec3> {
        let angle = |k: usize| 2.0 * std::f64::consts::PI * k as f64 / count as f64;
        (0..count).map(|k| radius(k) * Vec3::new(libm::cos(angle(k)), libm::sin(angle(k)), 0.0)).collect()
    };
    let round = polygon(4000, &|_| 1.0);
    let corners: Vec<u32> = (0..4000).collect();
    let mut budget = EarBudget::default();
    let (triangles, is_plane) = triangulate_polygon(&round, &corners, &mut budget);
    let expected = 2000.0 * libm::sin(2.0 * std::f64::consts::PI / 4000.0);
    assert!(is_plane && triangles.len() == 3998 && (area(&round, &triangles) - expected).abs() < 1e-9);
    // ears all around leave small triangles: few boxes overlap, so that all pairs are compared
    let mesh = Mesh::new(round, triangles).unwrap();
    assert!(mesh.diagnose().uncompared.is_none());
    // stars have few ears; when the budget is used up, they become fans, which have the same signed area
    let star = polygon(900, &|k| if k % 2 == 0 { 1.0 } else { 0.2 });
    let corners: Vec<u32> = (0..900).collect();
    let start = std::time::Instant::now();
    for _ in 0..200 {
        let (triangles, _) = triangulate_polygon(&star, &corners, &mut budget);
        assert!(
            (area(&star, &triangles) - 450.0 * 0.2 * libm::sin(2.0 * std::f64::consts::PI / 900.0)).abs()
                < 1e-9
        );
    }
    assert!(start.elapsed().as_secs() < 60);
}

/// Boxes within boxes: each line through one of them crosses all of them.
#[test]
fn many_nested_shells_take_little_time() {
    let count = 2000;
    let shell = |k: usize| {
        let half = Vec3::splat(1.0 + k as f64);
        let cube = cuboid(-half, half);
        // every second one is a cavity
        if k.is_multiple_of(2) {
            cube
        } else {
            with_triangles(&cube, |all| all.iter_mut().for_each(|t| t.swap(0, 1)))
        }
    };
    let all = (1..count).map(shell).fold(shell(0).into_parts(), |(mut vertices, mut triangles), mesh| {
        let first = vertices.len() as u32;
        let (more, corners) = mesh.into_parts();
        vertices.extend(more);
        triangles.extend(corners.into_iter().map(|corners| corners.map(|vertex| vertex + first)));
        (vertices, triangles)
    });
    let start = std::time::Instant::now();
    let mesh = Mesh::new(all.0, all.1).unwrap();
    let found = mesh.diagnose();
    for (k, component) in found.components.iter().enumerate() {
        assert_eq!(component.depth, count - 1 - k, "{k}");
    }
    let solid = Polyhedron::new(&mesh).unwrap();
    // outward of the outermost shell is out of the mesh, and shells alternate
    let wrong = (0..count).filter(|&k| found.components[k].is_inside_out() != ((count - 1 - k) % 2 != k % 2));
    assert_eq!((wrong.count(), solid.triangle_count()), (0, 12 * count));
    assert!(start.elapsed().as_secs() < 60, "{:?}", start.elapsed());
}
