//! Outlines with arcs against closed forms: areas, and the membership of points by signed distances.

use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};
use rayweave_math::Vec3;
use rayweave_model::{Evaluator, Program, Query, Solid};
use rayweave_polygon::{Corner, Outline, OutlineError, Rim, Vertex};
use rayweave_shape::Ray;
use rayweave_trace::Weave;
use std::f64::consts::PI;
use std::sync::Arc;

fn rounded(points: &[[f64; 2]], corner: Corner) -> Vec<Vertex> {
    points.iter().map(|at| Vertex { at: *at, bulge: 0.0, corner }).collect()
}

/// A rectangle of half sides `a` and `b`, with fillets of radius `r`.
fn plate(a: f64, b: f64, r: f64) -> Vec<Vertex> {
    rounded(&[[-a, -b], [a, -b], [a, b], [-a, b]], Corner::Fillet(r))
}

/// The signed distance of a point from this rectangle.
fn from_plate([x, y]: [f64; 2], a: f64, b: f64, r: f64) -> f64 {
    let (u, v) = (x.abs() - a + r, y.abs() - b + r);
    u.max(v).min(0.0) + libm::hypot(u.max(0.0), v.max(0.0)) - r
}

/// Compares the membership of points with a function that is negative inside. Points nearer to 0 than 1e-9 are skipped.
fn agrees(solid: &Solid, half: [f64; 3], seed: u64, depth: impl Fn([f64; 3]) -> f64) {
    let weave = Weave::new(Arc::new(Program::compile(solid).unwrap()));
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let (mut inside, mut outside) = (0, 0);
    for _ in 0..4000 {
        let p = half.map(|h| rng.random_range(-h..h));
        let expected = depth(p);
        if expected.abs() < 1e-9 {
            continue;
        }
        assert_eq!(weave.contains(p.into()).unwrap(), expected < 0.0, "{p:?} {expected}");
        if expected < 0.0 { inside += 1 } else { outside += 1 }
    }
    assert!(inside > 200 && outside > 200, "{inside} {outside}");
}

#[test]
fn areas_are_those_of_closed_forms() {
    let (a, b, r) = (3.0, 2.0, 0.75);
    let close = |outline: &Outline, area: f64| {
        assert!((outline.area() - area).abs() < 1e-13 * area, "{} {area}", outline.area());
    };
    close(&Outline::new(&[plate(a, b, r)]).unwrap(), 4.0 * a * b - (4.0 - PI) * r * r);
    // clockwise, with a chamfer: four triangles are cut off
    let clockwise = rounded(&[[0.0, 0.0], [0.0, 4.0], [6.0, 4.0], [6.0, 0.0]], Corner::Chamfer(0.5));
    close(&Outline::new(&[clockwise]).unwrap(), 24.0 - 4.0 * 0.125);
    // the corner of an L is rounded to the other side
    let corners = [[0.0, 0.0], [4.0, 0.0], [4.0, 1.0], [1.0, 1.0], [1.0, 4.0], [0.0, 4.0]];
    let mut bracket = rounded(&corners, Corner::Sharp);
    bracket[3].corner = Corner::Fillet(0.5);
    close(&Outline::new(&[bracket]).unwrap(), 7.0 + 0.25 * (1.0 - PI / 4.0));
    // a slot: nothing is left of two edges
    close(&Outline::new(&[plate(3.0, 1.0, 1.0)]).unwrap(), 8.0 + PI);
    // an annulus with a pin in its hole
    let rings = [3.0, 2.0, 1.0].map(|r| Vertex::circle([7.0, -2.0], r).to_vec());
    close(&Outline::new(&rings).unwrap(), PI * (9.0 - 4.0 + 1.0));
    // a thin crescent between a half circle and a flatter arc with the same ends: arcs are divided until the chords are apart
    let arc = |x: f64, bulge: f64| Vertex { at: [x, 0.0], bulge, corner: Corner::Sharp };
    let segment = |bulge: f64| {
        let (half, radius) = (2.0 * libm::atan(bulge), (1.0 + bulge * bulge) / (2.0 * bulge));
        radius * radius * (half - libm::sin(half) * libm::cos(half))
    };
    close(&Outline::new(&[vec![arc(1.0, 1.0), arc(-1.0, -0.9)]]).unwrap(), segment(1.0) - segment(0.9));
}

#[test]
fn prisms_contain_the_points_of_the_outline() {
    let (a, b, r) = (3.0, 2.0, 0.75);
    let outline = Outline::new(&[plate(a, b, r), Vertex::circle([1.0, 0.25], 0.8).to_vec()]).unwrap();
    let flat =
        |p: [f64; 3]| from_plate([p[0], p[1]], a, b, r).max(0.8 - libm::hypot(p[0] - 1.0, p[1] - 0.25));
    let prism = outline.extrude(-1.0, 1.5, [Rim::Sharp; 2]).unwrap();
    agrees(&prism, [3.5, 2.5, 2.0], 1, |p| flat(p).max(p[2] - 1.5).max(-1.0 - p[2]));
    // arcs that bulge inwards, and one of more than a half turn
    let at = |x: f64, y: f64, bulge: f64| Vertex { at: [x, y], bulge, corner: Corner::Sharp };
    let key = vec![
        at(-2.0, -1.0, -0.4),
        at(2.0, -1.0, 0.0),
        at(2.0, 1.0, 0.0),
        at(0.5, 1.0, 2.0),
        at(-0.5, 1.0, 0.0),
        at(-2.0, 1.0, 0.0),
    ];
    let key = Outline::new(&[key]).unwrap();
    let disc = |p: [f64; 3], bulge: f64, y: f64, half: f64| {
        let (radius, up) =
            (half * (1.0 + bulge * bulge) / (2.0 * bulge), half * (1.0 - bulge * bulge) / (2.0 * bulge));
        libm::hypot(p[0], p[1] - y - up) - radius
    };
    agrees(&key.extrude(-1.0, 1.0, [Rim::Sharp; 2]).unwrap(), [2.5, 2.6, 1.2], 2, |p| {
        let rectangle = (p[0].abs() - 2.0).max(p[1].abs() - 1.0);
        // the arcs are mirrored: that at the top bulges upwards, and that at the bottom upwards too
        let head = disc([p[0], 2.0 - p[1], 0.0], 2.0, 1.0, 0.5).max(1.0 - p[1]);
        let bite = disc([p[0], -p[1], 0.0], 0.4, 1.0, 2.0);
        rectangle.max(-bite).min(head).max(p[2].abs() - 1.0)
    });
}

/// The rim of an outline with rounded corners has a constant distance from the walls.
#[test]
fn rims_follow_the_distance_from_the_walls() {
    let (a, b, r, w) = (3.0, 2.0, 0.9, 0.5);
    let outline = Outline::new(&[plate(a, b, r), Vertex::circle([0.75, 0.25], 0.6).to_vec()]).unwrap();
    let flat =
        |p: [f64; 3]| from_plate([p[0], p[1]], a, b, r).max(0.6 - libm::hypot(p[0] - 0.75, p[1] - 0.25));
    let solid = outline.extrude(-1.0, 1.0, [Rim::Chamfer(w), Rim::Fillet(w)]).unwrap();
    agrees(&solid, [3.2, 2.2, 1.2], 3, |p| {
        let wall = flat(p);
        let chamfer = wall - (p[2] + 1.0) + w;
        let (u, v) = (wall + w, p[2] - 1.0 + w);
        let fillet = u.max(v).min(0.0) + libm::hypot(u.max(0.0), v.max(0.0)) - w;
        chamfer.max(fillet).max(-1.0 - p[2])
    });
}

/// At sharp corners, rims meet in mitres: the walls are moved, and the corners with them.
#[test]
fn rims_meet_in_mitres() {
    let corners = [[-2.0, -2.0], [2.0, -2.0], [2.0, 0.0], [0.0, 0.0], [0.0, 2.0], [-2.0, 2.0]];
    let bracket = Outline::new(&[rounded(&corners, Corner::Sharp)]).unwrap();
    let w = 0.5;
    // the inner corner of the L is mitred as well
    let flat = |p: [f64; 3]| {
        let outer = (p[0].abs() - 2.0).max(p[1].abs() - 2.0);
        outer.max(p[0].min(p[1]))
    };
    let solid = bracket.extrude(-1.0, 1.0, [Rim::Fillet(w), Rim::Chamfer(w)]).unwrap();
    agrees(&solid, [2.2, 2.2, 1.1], 4, |p| {
        let wall = flat(p);
        let chamfer = wall + p[2] - 1.0 + w;
        let (u, v) = (wall + w, -p[2] - 1.0 + w);
        let fillet = u.max(v).min(0.0) + libm::hypot(u.max(0.0), v.max(0.0)) - w;
        chamfer.max(fillet).max(p[2].abs() - 1.0)
    });
}

#[test]
fn revolved_outlines_are_cones_tori_and_spheres() {
    // a rounded rectangle around the point (3, 0) of the half-plane
    let (a, b, r) = (1.0, 1.5, 0.5);
    let ring: Vec<Vertex> =
        plate(a, b, r).into_iter().map(|v| Vertex { at: [v.at[0] + 3.0, v.at[1]], ..v }).collect();
    let ring = Outline::new(&[ring]).unwrap();
    let radius = |p: [f64; 3]| libm::hypot(p[0], p[1]);
    agrees(&ring.revolve(0.0, 360.0).unwrap(), [4.5, 4.5, 2.0], 5, |p| {
        from_plate([radius(p) - 3.0, p[2]], a, b, r)
    });
    // a quarter of it
    agrees(&ring.revolve(0.0, 90.0).unwrap(), [4.5, 4.5, 2.0], 6, |p| {
        from_plate([radius(p) - 3.0, p[2]], a, b, r).max(-p[0]).max(-p[1])
    });
    // a half disc, and one with a conical end
    let at = |x: f64, y: f64, bulge: f64| Vertex { at: [x, y], bulge, corner: Corner::Sharp };
    let drop =
        Outline::new(&[vec![at(0.0, -2.0, 0.0), at(1.0, 0.0, 0.414_213_562_373_095_05), at(0.0, 1.0, 0.0)]])
            .unwrap();
    agrees(&drop.revolve(0.0, 360.0).unwrap(), [1.2, 1.2, 2.2], 7, |p| {
        let ball = libm::hypot(radius(p), p[2]) - 1.0;
        if p[2] > 0.0 { ball } else { radius(p) - 0.5 * (p[2] + 2.0) }
    });
    // an ogive: its arc has a centre beyond the axis, and is made of chords within 1e-6 of the height
    let bulge = libm::tan(0.25 * PI / 3.0);
    let ogive =
        Outline::new(&[vec![at(0.0, 0.0, 0.0), at(1.0, 0.0, bulge), at(0.0, 3.0_f64.sqrt(), 0.0)]]).unwrap();
    let exact = |p: [f64; 3]| (libm::hypot(radius(p) + 1.0, p[2]) - 2.0).max(-p[2]);
    agrees(&ogive.revolve(0.0, 360.0).unwrap(), [1.1, 1.1, 2.0], 8, |p| {
        let depth = exact(p);
        if depth.abs() < 4e-6 { 0.0 } else { depth }
    });
}

#[test]
fn impossible_outlines_are_errors() {
    let square = |corner| rounded(&[[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]], corner);
    let fails = |contours: &[Vec<Vertex>]| Outline::new(contours).unwrap_err();
    assert!(matches!(fails(&[square(Corner::Fillet(2.5))]), OutlineError::NoRoom { vertex: 1, .. }));
    assert!(matches!(fails(&[square(Corner::Fillet(-1.0))]), OutlineError::NotPositive { vertex: 0, .. }));
    assert!(matches!(
        fails(&[rounded(&[[0.0, 0.0], [1.0, 0.0]], Corner::Sharp)]),
        OutlineError::NoArea { contour: 0 }
    ));
    let bow = rounded(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]], Corner::Sharp);
    assert!(matches!(fails(&[bow]), OutlineError::Touching { first: (0, _), .. }));
    // a hole that reaches over an edge, by its arc only
    let hole = Vertex::circle([2.0, 0.5], 0.51).to_vec();
    assert!(matches!(fails(&[square(Corner::Sharp), hole]), OutlineError::Touching { .. }));
    assert!(Outline::new(&[square(Corner::Sharp), Vertex::circle([2.0, 0.5], 0.49).to_vec()]).is_ok());
    let mut arc = square(Corner::Sharp);
    (arc[0].bulge, arc[1].corner) = (0.5, Corner::Fillet(0.5));
    assert!(matches!(fails(&[arc]), OutlineError::CornerAtArc { vertex: 1, .. }));
    let mut infinite = square(Corner::Sharp);
    infinite[2].at[1] = f64::NAN;
    assert!(matches!(fails(&[infinite]), OutlineError::NotFinite { vertex: 2, .. }));
    let outline = Outline::new(&[square(Corner::Fillet(0.5))]).unwrap();
    let rim = |rims| outline.extrude(0.0, 1.0, rims).unwrap_err();
    assert!(matches!(rim([Rim::Sharp, Rim::Fillet(0.6)]), OutlineError::Rim { .. }));
    assert!(matches!(rim([Rim::Chamfer(0.5), Rim::Fillet(0.501)]), OutlineError::RimHeight { .. }));
    assert!(matches!(rim([Rim::Chamfer(f64::NAN), Rim::Sharp]), OutlineError::Rim { .. }));
    assert!(outline.extrude(1.0, 0.0, [Rim::Sharp; 2]).is_err());
    let left = Outline::new(&[Vertex::circle([1.0, 0.0], 1.25).to_vec()]).unwrap();
    assert!(matches!(left.revolve(0.0, 360.0), Err(OutlineError::Axis { contour: 0, x }) if x == -0.25));
}

/// The wall of a hole that is vertical up to a few roundings, or nearly so, keeps its crossings: the cone through it has its apex as
/// far away as 1e17.
#[test]
fn nearly_vertical_walls_are_crossed() {
    for lean in [0.0, 8.9e-16, -8.9e-16, 1e-14, 1e-12, -1e-12, 1e-9, -1e-7, 1e-5, 1e-3] {
        let corners = [[0.0, -5.0], [10.0, -5.0], [10.0, 5.0], [6.0, 5.0], [6.0 + lean, 1.0], [0.0, 1.0]];
        let solid = Outline::new(&[rounded(&corners, Corner::Sharp)]).unwrap().revolve(0.0, 360.0).unwrap();
        let weave = Weave::new(Arc::new(Program::compile(&solid).unwrap()));
        for z in [1.5, 3.0, 4.5] {
            let ray = Ray::new(Vec3::new(-20.0, 0.5, z), Vec3::X);
            let found = weave.one(ray, &Query::default()).unwrap();
            let times: Vec<f64> = found.crossings.iter().map(|crossing| crossing.t).collect();
            let wall = 6.0 + lean * (5.0 - z) / 4.0;
            let [outer, inner] = [10.0, wall].map(|radius: f64| (radius * radius - 0.25).sqrt());
            let expected = [20.0 - outer, 20.0 - inner, 20.0 + inner, 20.0 + outer];
            assert_eq!(times.len(), 4, "{lean} {z}: {times:?}");
            assert!(times.iter().zip(expected).all(|(t, e)| (t - e).abs() < 1e-9), "{lean} {z}: {times:?}");
        }
    }
}

/// A plate with 144 rounded holes, half of them with a round island, and 20 round holes: more than a thousand edges, so that the
/// formula is divided into cells.
#[test]
fn plates_with_many_holes_contain_the_points_of_their_outlines() {
    let plate_of = |x: f64, y: f64| plate(x, y, 1.0);
    let mut contours = vec![plate_of(13.0, 13.0)];
    let mut holes = Vec::new();
    for (i, j) in (0..12).flat_map(|i| (0..12).map(move |j| (i, j))) {
        let centre = [2.0 * f64::from(i) - 11.0, 2.0 * f64::from(j) - 11.0];
        let diamond = [[0.7, 0.0], [0.0, 0.7], [-0.7, 0.0], [0.0, -0.7]];
        let corners = diamond.map(|[x, y]| [centre[0] + x, centre[1] + y]);
        contours.push(rounded(&corners, Corner::Fillet(0.125)));
        let island = ((i + j) % 2 == 0).then_some(0.3);
        contours.extend(island.map(|radius| Vertex::circle(centre, radius).to_vec()));
        holes.push((centre, island));
    }
    let dots: Vec<[f64; 2]> = (0..5)
        .flat_map(|i| (0..4).map(move |j| [4.0 * f64::from(i) - 8.0, 4.0 * f64::from(j) - 6.0]))
        .collect();
    contours.extend(dots.iter().map(|at| Vertex::circle(*at, 0.2).to_vec()));
    let outline = Outline::new(&contours).unwrap();
    let (half, diagonal) = (0.7 / 2f64.sqrt(), 0.5f64.sqrt());
    let depth = |[x, y]: [f64; 2]| {
        let mut deepest = from_plate([x, y], 13.0, 13.0, 1.0);
        for ([a, b], island) in &holes {
            let (u, v) = (x - a, y - b);
            let hole = from_plate([diagonal * (u + v), diagonal * (u - v)], half, half, 0.125);
            let island = island.map_or(f64::INFINITY, |radius| libm::hypot(u, v) - radius);
            deepest = deepest.max((-hole).min(island));
        }
        let dot = dots.iter().map(|[a, b]| 0.2 - libm::hypot(x - a, y - b));
        dot.fold(deepest, f64::max)
    };
    let area: f64 = outline.area();
    let hole = 4.0 * half * half - (4.0 - PI) * 0.125 * 0.125;
    let exact = 676.0 - (4.0 - PI) - 144.0 * hole + 72.0 * PI * 0.09 - 20.0 * PI * 0.04;
    assert!((area - exact).abs() < 1e-12 * exact, "{area} {exact}");
    let prism = outline.extrude(0.0, 2.0, [Rim::default(); 2]).unwrap();
    agrees(&prism, [13.5, 13.5, 2.5], 31, |[x, y, z]| depth([x, y]).max(-z).max(z - 2.0));
    let names: Vec<String> = Program::compile(&prism).unwrap().face_names().collect();
    for name in ["contour0.edge1.", "contour3.arc2.", "contour2.", "ends.z+"] {
        assert!(names.iter().any(|own| own.starts_with(name)), "{name}");
    }
    // the same plate beside the axis
    let moved: Vec<Vec<Vertex>> = contours
        .iter()
        .map(|contour| contour.iter().map(|v| Vertex { at: [v.at[0] + 20.0, v.at[1]], ..*v }).collect())
        .collect();
    let ring = Outline::new(&moved).unwrap().revolve(0.0, 360.0).unwrap();
    agrees(&ring, [34.0, 34.0, 14.0], 32, |[x, y, z]| depth([libm::hypot(x, y) - 20.0, z]));
}

/// The name of a solid precedes the names of its faces, also under maps, beside other solids, and with a second name around it.
#[test]
fn faces_have_the_name_of_their_solid() {
    let outline =
        Outline::new(&[rounded(&[[2.0, 0.0], [6.0, 0.0], [6.0, 4.0], [2.0, 4.0]], Corner::Sharp)]).unwrap();
    let plate = outline.extrude(0.0, 2.0, [Rim::default(); 2]).unwrap().named("plate");
    let ring = outline.revolve(0.0, 360.0).unwrap().named("ring");
    let moved = plate.translate([10.0, 0.0, 0.0]).named("copy");
    let faces = |solid: &Solid| Program::compile(solid).unwrap().face_names().collect::<Vec<String>>();
    let begin = |solid: &Solid, names: &[&str]| {
        let all = faces(solid);
        let is_named = |own: &String| names.iter().any(|name| own.starts_with(&format!("{name}.")));
        assert!(!all.is_empty() && all.iter().all(is_named), "{all:?}");
        all
    };
    let all = begin(&plate, &["plate"]);
    assert!(all.contains(&"plate.contour0.edge3.plane".to_owned()), "{all:?}");
    assert!(all.contains(&"plate.ends.z+".to_owned()), "{all:?}");
    begin(&ring, &["ring"]);
    begin(&(&plate | &ring), &["plate", "ring"]);
    begin(&(&plate - &moved).named("part"), &["plate"]);
    begin(&Solid::union([!&plate, ring.translate([0.0, 0.0, 9.0])]), &["plate", "ring"]);
    let unnamed = outline.extrude(0.0, 2.0, [Rim::default(); 2]).unwrap();
    assert!(faces(&(unnamed & ring).named("part")).contains(&"contour0.edge3.plane".to_owned()));
}

/// A turned part of a profile with thousands of edges.
#[test]
fn revolved_profiles_of_many_edges() {
    let radius = |k: u32| 5.0 + f64::from((k * 7919) % 13) / 13.0;
    let n = 2000;
    let mut profile: Vec<[f64; 2]> = (0..=n).map(|k| [radius(k), 0.01 * f64::from(k)]).collect();
    profile.extend([[0.0, 0.01 * f64::from(n)], [0.0, 0.0]]);
    let part = Outline::new(&[rounded(&profile, Corner::Sharp)]).unwrap().revolve(0.0, 360.0).unwrap();
    agrees(&part, [7.0, 7.0, 21.0], 33, |[x, y, z]| {
        let k = (z / 0.01).floor().clamp(0.0, f64::from(n - 1)) as u32;
        let part = z / 0.01 - f64::from(k);
        let wall = radius(k) + part * (radius(k + 1) - radius(k));
        (libm::hypot(x, y) - wall).max(-z).max(z - 20.0)
    });
    let program = Program::compile(&part).unwrap();
    let boxes = program.matters(&program.prototypes()[0]);
    let around = boxes.iter().filter(|own| own.contains([5.3, 0.0, 7.777].into())).count();
    assert!(around < 100, "{around} surfaces matter at one point");
}
