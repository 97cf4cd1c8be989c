//! Every kind of GDML solid, against Geant4.

use super::{along, model, parse, volume};
use rayweave_formats::LossKind;
use rayweave_math::Vec3;
use rayweave_model::{Evaluator, Program, Query, RayBatch, Solid};
use rayweave_shape::Ray;
use rayweave_trace::Weave;
use std::collections::HashMap;
use std::sync::Arc;

const FILE: &str = include_str!("solids.gdml");
/// Reference data of Geant4 11.4.1, through geant4-pybind 0.1.3: `GetCubicVolume` of each solid, and rays with the
/// alternating results of `DistanceToIn` and `DistanceToOut`.
const RAYS: &str = include_str!("solids.csv");

/// Approximated solids.
const APPROXIMATED: [&str; 3] = ["v_tbox1", "v_ttrd1", "v_ttrap1"];

fn solids() -> HashMap<String, Solid> {
    let imported = parse(FILE).unwrap_or_else(|problems| panic!("{problems}"));
    assert_eq!(imported.report.count(LossKind::Refused), 0);
    assert_eq!(imported.report.count(LossKind::Approximated), APPROXIMATED.len());
    imported.scene.regions.iter().map(|region| (region.name.clone(), region.solid.clone())).collect()
}

fn numbers(text: &str) -> Vec<f64> {
    text.split(',').map(|number| number.parse().unwrap()).collect()
}

#[test]
fn rays_cross_as_in_geant4() {
    let solids = solids();
    let mut rays: HashMap<&str, Vec<Vec<f64>>> = HashMap::new();
    for line in RAYS.lines().filter(|line| !line.starts_with('#')) {
        let (name, rest) = line.split_once(',').unwrap();
        rays.entry(name).or_default().push(numbers(rest));
    }
    assert_eq!(rays.len(), solids.len() - 1, "all but the world");
    for (name, rays) in rays {
        let program = Arc::new(Program::compile(&solids[name]).unwrap());
        let ray = |row: &Vec<f64>| Ray {
            origin: Vec3::from_slice(&row[..3]),
            direction: Vec3::from_slice(&row[3..6]).normalize(),
        };
        let batch = RayBatch::from_iter(rays.iter().map(ray));
        let answer = Weave::new(program).collect(batch.rays(), &Query::default()).unwrap();
        let tolerance = if APPROXIMATED.contains(&name) { 1e-4 } else { 2e-6 };
        for (k, row) in rays.iter().enumerate() {
            let crossings = &answer.crossings[answer.offsets[k]..answer.offsets[k + 1]];
            let times: Vec<f64> = crossings.iter().map(|crossing| crossing.t).collect();
            let near = times.iter().zip(&row[6..]).all(|(ours, theirs)| (ours - theirs).abs() <= tolerance);
            assert!(
                times.len() == row.len() - 6 && near,
                "{name} {:?}: {times:?} and not {:?}",
                &row[..6],
                &row[6..]
            );
        }
    }
}

#[test]
fn volumes_are_those_of_geant4() {
    let solids = solids();
    // for these, Geant4 estimates volumes from random points or contradicts its own rays (see docs/concepts/validation.md)
    let estimated = ["v_union1", "v_sub1", "v_int1", "v_mu1"];
    for line in RAYS.lines().filter_map(|line| line.strip_prefix("# v_")) {
        let (name, theirs) = line.split_once(" volume ").unwrap();
        let (name, theirs) = (format!("v_{name}"), theirs.parse::<f64>().unwrap());
        if estimated.contains(&name.as_str()) {
            continue;
        }
        let program = Arc::new(Program::compile(&solids[&name]).unwrap());
        assert!(program.prototypes()[0].bounds.is_finite(), "{name} {:?}", program.prototypes()[0].bounds);
        let ours = volume(&program, 160);
        assert!((ours / theirs - 1.0).abs() < 4e-3, "{name}: {ours} and not {theirs}");
    }
}

/// A solid of one kind, from its attributes.
fn one(solid: &str) -> rayweave_formats::Imported {
    let volume = "<volume name=\"World\"><materialref ref=\"Al\"/><solidref ref=\"s\"/></volume>";
    parse(&model("", solid, volume)).unwrap_or_else(|problems| panic!("{problems}"))
}

#[test]
fn impossible_solids_are_refused_with_the_reason() {
    let table = [
        ("<tube name=\"s\" rmin=\"5\" rmax=\"3\" z=\"1\" deltaphi=\"1\"/>", "inner"),
        ("<tube name=\"s\" rmax=\"3\" z=\"1\" deltaphi=\"-1\"/>", "is empty"),
        ("<box name=\"s\" x=\"0\" y=\"1\" z=\"1\"/>", "greater than 0"),
        ("<polycone name=\"s\"><zplane z=\"0\" rmax=\"1\"/></polycone>", "no interior"),
        ("<sphere name=\"s\" rmin=\"2\" rmax=\"2\" deltaphi=\"6.3\"/>", "not less"),
        ("<xtru name=\"s\"><section zPosition=\"0\"/><section zPosition=\"1\"/></xtru>", "no area"),
        (
            "<box name=\"b\" x=\"1\" y=\"1\" z=\"1\"/><scaledSolid name=\"s\"><solidref ref=\"b\"/><scale x=\"1\" y=\"0\"/></scaledSolid>",
            "a scale factor is 0",
        ),
        (
            "<box name=\"b\" x=\"1\" y=\"1\" z=\"1\"/><reflectedSolid name=\"s\" solid=\"b\" sx=\"1\" sy=\"0\" sz=\"-1\"/>",
            "a scale factor is 0",
        ),
    ];
    for (solid, reason) in table {
        let imported = one(solid);
        assert_eq!(imported.scene.regions.len(), 0, "{solid}");
        let losses: Vec<_> = imported.report.iter().collect();
        assert_eq!(losses.len(), 1, "{solid}");
        assert!(losses[0].first.message().contains(reason), "{}", losses[0].first.message());
        assert_eq!(losses[0].first.line_column().map(|place| place.0), Some(4));
    }
}

#[test]
fn planes_of_no_height_and_no_thickness_are_passed_over() {
    let planes = "<zplane z=\"-1\" rmax=\"2\"/><zplane z=\"-1\" rmax=\"2\"/><zplane z=\"1\" rmax=\"2\"/>\
                  <zplane z=\"1\" rmin=\"2\" rmax=\"2\"/><zplane z=\"3\" rmin=\"2\" rmax=\"2\"/>";
    let imported = one(&format!("<polycone name=\"s\">{planes}</polycone>"));
    let program = Arc::new(Program::compile(&imported.scene.regions[0].solid).unwrap());
    let found = volume(&program, 200);
    assert!((found / (8.0 * std::f64::consts::PI) - 1.0).abs() < 2e-3, "{found}");
}

/// Sections of a polycone share their planes: no ray passes between them, at any angle.
#[test]
fn stacks_have_no_seams() {
    let planes: String = (0..=10)
        .map(|k| format!("<zplane z=\"{}\" rmin=\"1\" rmax=\"{}\"/>", 0.1 * f64::from(k), 3 + k % 2))
        .collect();
    let imported = one(&format!("<polycone name=\"s\" lunit=\"cm\">{planes}</polycone>"));
    let program = Arc::new(Program::compile(&imported.scene.regions[0].solid).unwrap());
    // rays through the walls, between the radii that all sections have in common
    let rays = (0..20_000).map(|k| {
        let (angle, lean) = (0.001 * f64::from(k), f64::from(k % 100) * 1e-2);
        let (sin, cos) = angle.sin_cos();
        let from = Vec3::new(20.0 * cos, 20.0 * sin, -1.0);
        Ray { origin: from, direction: Vec3::new(7.0 * lean * cos, 7.0 * lean * sin, 12.0) }
    });
    let batch = RayBatch::from_iter(rays);
    let answer = Weave::new(program).collect(batch.rays(), &Query::default()).unwrap();
    for k in 0..20_000 {
        let count = answer.offsets[k + 1] - answer.offsets[k];
        assert_eq!(count, 2, "ray {k}");
    }
}

#[test]
fn angles_beyond_the_pole_are_the_pole() {
    let imported =
        one("<sphere name=\"s\" rmax=\"2\" deltaphi=\"6.3\" starttheta=\"0.5\" deltatheta=\"3.2\"/>");
    let program = Arc::new(Program::compile(&imported.scene.regions[0].solid).unwrap());
    // a ball minus the cone of 0.5 rad about +z: 2 pi r^3 (1 + cos 0.5) / 3
    let expected = 2.0 * std::f64::consts::PI * 8.0 * (1.0 + 0.5f64.cos()) / 3.0;
    assert!((volume(&program, 200) / expected - 1.0).abs() < 2e-3);
}

/// A faceted cube of side 2 with a pyramid of height 1 removed from its top.
#[test]
fn facets_that_are_not_convex_are_a_mesh() {
    let corners = [
        (-1, -1, -1),
        (1, -1, -1),
        (1, 1, -1),
        (-1, 1, -1),
        (-1, -1, 1),
        (1, -1, 1),
        (1, 1, 1),
        (-1, 1, 1),
        (0, 0, 0),
    ];
    let position = |(k, (x, y, z)): (usize, &(i32, i32, i32))| {
        format!("<position name=\"p{k}\" x=\"{x}\" y=\"{y}\" z=\"{z}\"/>")
    };
    let define: String = corners.iter().enumerate().map(position).collect();
    let quadrangles = [[3, 2, 1, 0], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];
    let facet = |tag: &str, corners: &[i32]| {
        let vertices = corners.iter().zip(1..).map(|(corner, k)| format!(" vertex{k}=\"p{corner}\""));
        format!("<{tag}{} type=\"ABSOLUTE\"/>", vertices.collect::<String>())
    };
    let mut facets: String = quadrangles.iter().map(|corners| facet("quadrangular", corners)).collect();
    facets.extend([[4, 5, 8], [5, 6, 8], [6, 7, 8], [7, 4, 8]].map(|corners| facet("triangular", &corners)));
    let world = "<volume name=\"World\"><materialref ref=\"Al\"/><solidref ref=\"s\"/></volume>";
    let imported =
        parse(&model(&define, &format!("<tessellated name=\"s\">{facets}</tessellated>"), world)).unwrap();
    if rayweave_shape::primitive::manual("mesh").is_none() {
        assert_eq!(imported.report.count(LossKind::Refused), 1);
        return;
    }
    let program = Arc::new(Program::compile(&imported.scene.regions[0].solid).unwrap());
    assert!((volume(&program, 100) - (8.0 - 4.0 / 3.0)).abs() < 1e-3);
}

/// A twisted solid: its element, and the vertices of its ends before the twist, about the centre of each section. The centre
/// moves by `lean` per unit of height.
struct Twist {
    element: &'static str,
    corners: [[[f64; 2]; 4]; 2],
    lean: [f64; 2],
    z: f64,
    twist: f64,
}

fn tan(degrees: f64) -> f64 {
    degrees.to_radians().tan()
}

/// Vertices of a trapezium: extent along y, along x at low and at high y, slope of the line between the midpoints of those sides.
fn trapezium([y, x1, x2, slope]: [f64; 4]) -> [[f64; 2]; 4] {
    let corner = |x: f64, y: f64| [x + y * slope, y];
    let [y, x1, x2] = [0.5 * y, 0.5 * x1, 0.5 * x2];
    [corner(-x1, -y), corner(x1, -y), corner(x2, y), corner(-x2, y)]
}

impl Twist {
    fn all() -> Vec<Twist> {
        let (theta, phi) = (10f64, 30f64.to_radians());
        vec![
            Twist {
                element: "<twistedbox name=\"s\" PhiTwist=\"60\" x=\"20\" y=\"30\" z=\"40\" aunit=\"deg\"/>",
                corners: [trapezium([30.0, 20.0, 20.0, 0.0]); 2],
                lean: [0.0; 2],
                z: 40.0,
                twist: 60.0,
            },
            Twist {
                element: "<twistedbox name=\"s\" PhiTwist=\"-89.9\" x=\"0.02\" y=\"3\" z=\"400\" aunit=\"deg\"/>",
                corners: [trapezium([3.0, 0.02, 0.02, 0.0]); 2],
                lean: [0.0; 2],
                z: 400.0,
                twist: -89.9,
            },
            Twist {
                element: "<twistedtrd name=\"s\" PhiTwist=\"40\" x1=\"10\" x2=\"20\" y1=\"16\" y2=\"3\" z=\"40\" aunit=\"deg\"/>",
                corners: [trapezium([16.0, 10.0, 10.0, 0.0]), trapezium([3.0, 20.0, 20.0, 0.0])],
                lean: [0.0; 2],
                z: 40.0,
                twist: 40.0,
            },
            Twist {
                element: "<twistedtrap name=\"s\" PhiTwist=\"50\" z=\"40\" Theta=\"10\" Phi=\"30\" y1=\"30\" x1=\"14\" x2=\"20\" \
                          y2=\"24\" x3=\"12\" x4=\"17\" Alph=\"15\" aunit=\"deg\"/>",
                corners: [trapezium([30.0, 14.0, 20.0, tan(15.0)]), trapezium([24.0, 12.0, 17.0, tan(15.0)])],
                lean: [tan(theta) * phi.cos(), tan(theta) * phi.sin()],
                z: 40.0,
                twist: 50.0,
            },
            // the twist and the shape turn a side face in opposite directions, so it may turn back within a layer
            Twist {
                element: "<twistedtrap name=\"s\" PhiTwist=\"52\" z=\"40\" Theta=\"0\" Phi=\"0\" y1=\"20\" x1=\"30\" x2=\"10\" \
                          y2=\"20\" x3=\"10\" x4=\"30\" Alph=\"0\" aunit=\"deg\"/>",
                corners: [trapezium([20.0, 30.0, 10.0, 0.0]), trapezium([20.0, 10.0, 30.0, 0.0])],
                lean: [0.0; 2],
                z: 40.0,
                twist: 52.0,
            },
        ]
    }

    /// Vertices of the section at a height, about its centre.
    fn section(&self, z: f64) -> [[f64; 2]; 4] {
        let (sin, cos) = (self.twist.to_radians() * z / self.z).sin_cos();
        let part = z / self.z + 0.5;
        std::array::from_fn(|k| {
            let [x, y] =
                [0, 1].map(|axis| (1.0 - part) * self.corners[0][k][axis] + part * self.corners[1][k][axis]);
            [cos * x - sin * y, sin * x + cos * y]
        })
    }

    /// Distance along a direction from the centre to the boundary of the section, and the cosine of the angle of incidence.
    fn reach(&self, z: f64, [x, y]: [f64; 2]) -> (f64, f64) {
        let corners = self.section(z);
        let side = |k: usize| {
            let ([ax, ay], [bx, by]) = (corners[k], corners[(k + 1) % 4]);
            let (ex, ey) = (bx - ax, by - ay);
            // positive where the direction leaves to the right of the side
            let speed = ey * x - ex * y;
            (speed > 0.0).then(|| ((ey * ax - ex * ay) / speed, speed / ex.hypot(ey)))
        };
        (0..4).filter_map(side).min_by(|a, b| a.0.total_cmp(&b.0)).unwrap()
    }

    /// Volume: the area of a section is unaffected by the twist and quadratic in z, so Simpson's rule is exact.
    fn volume(&self) -> f64 {
        let area = |z: f64| {
            let c = self.section(z);
            (0..4).map(|k| 0.5 * (c[k][0] * c[(k + 1) % 4][1] - c[k][1] * c[(k + 1) % 4][0])).sum::<f64>()
        };
        let half = 0.5 * self.z;
        self.z / 6.0 * (area(-half) + 4.0 * area(0.0) + area(half))
    }
}

/// The bound of the deviation in the message about a twisted solid.
fn stated_deviation(imported: &rayweave_formats::Imported) -> f64 {
    let loss = imported.report.iter().next().unwrap();
    assert_eq!(loss.kind, LossKind::Approximated);
    let message = loss.first.message();
    let number = message.rsplit_once("at most ").and_then(|(_, rest)| rest.strip_suffix(" mm."));
    number.and_then(|number| number.parse().ok()).unwrap_or_else(|| panic!("{message}"))
}

/// Rays from the centres of random sections leave the solid where its formula predicts, within the stated bound.
#[test]
fn twisted_solids_deviate_by_no_more_than_is_stated() {
    for solid in Twist::all() {
        let imported = one(solid.element);
        let bound = stated_deviation(&imported);
        let size =
            solid.corners.iter().flatten().map(|corner| corner[0].hypot(corner[1])).fold(0.0, f64::max);
        assert!(bound <= 1.1e-6 * size, "{}: {bound}", solid.element);
        let program = Arc::new(Program::compile(&imported.scene.regions[0].solid).unwrap());
        let cases: Vec<(f64, [f64; 2])> = (1..1500)
            .map(|k| {
                // multiples of irrational numbers are dense and even
                let [height, turn] = [0.754_877_666, 0.569_840_291].map(|step| (f64::from(k) * step).fract());
                let (sin, cos) = (std::f64::consts::TAU * turn).sin_cos();
                (solid.z * (height - 0.5), [cos, sin])
            })
            .collect();
        let ray = |(z, [x, y]): &(f64, [f64; 2])| Ray {
            origin: Vec3::new(solid.lean[0] * z, solid.lean[1] * z, *z),
            direction: Vec3::new(*x, *y, 0.0),
        };
        let batch = RayBatch::from_iter(cases.iter().map(ray));
        let query = Query::default();
        let answer = Weave::new(program.clone()).collect(batch.rays(), &query).unwrap();
        let mut worst = 0.0f64;
        for (k, (z, direction)) in cases.iter().enumerate() {
            let crossings = &answer.crossings[answer.offsets[k]..answer.offsets[k + 1]];
            let (expected, slope) = solid.reach(*z, *direction);
            assert_eq!(crossings.len(), 2, "{} at {z} {direction:?}: {crossings:?}", solid.element);
            worst = worst.max((crossings[1].t - expected).abs() * slope);
        }
        assert!(program.leaves().len() < 700, "{}: {} leaves", solid.element, program.leaves().len());
        assert!(worst <= bound, "{}: {worst} exceeds {bound}", solid.element);
        // the bound is not much larger than the actual error
        assert!(worst >= bound / 10.0 || solid.twist == 52.0, "{}: {worst} of {bound}", solid.element);
        let found = volume(&program, 80);
        assert!((found / solid.volume() - 1.0).abs() < 4e-3, "{}: {found} {}", solid.element, solid.volume());
    }
}

#[test]
fn twisted_solids_without_a_size_are_refused() {
    for solid in [
        "<twistedbox name=\"s\" PhiTwist=\"0\" x=\"2\" y=\"2\" z=\"5\"/>",
        "<twistedbox name=\"s\" PhiTwist=\"1\" x=\"0\" y=\"2\" z=\"5\"/>",
        "<twistedtrd name=\"s\" PhiTwist=\"1\" x1=\"1\" x2=\"1\" y1=\"1\" y2=\"-1\" z=\"5\"/>",
    ] {
        assert_eq!(one(solid).report.count(LossKind::Refused), 1, "{solid}");
    }
}

/// Solids with thousands of planes and corners: a ray along x crosses the radii interpolated between two planes, and the edges of the
/// scaled polygon. Few surfaces matter at a point, however many the solid has.
#[test]
fn solids_of_many_planes_and_corners() {
    let n = 2000u32;
    let outer = |k: u32| 20.0 + f64::from((k * 7919) % 13);
    let inner = |k: u32| 5.0 + f64::from((k * 104_729) % 7);
    let plane = |k: u32| format!("<zplane z=\"{k}\" rmin=\"{}\" rmax=\"{}\"/>", inner(k), outer(k));
    let planes: String = (0..=n).map(plane).collect();
    let point = |r: f64, k: u32| format!("<rzpoint r=\"{r}\" z=\"{k}\"/>");
    let up: String = (0..=n).map(|k| point(outer(k), k)).collect();
    let down: String = (0..=n).rev().map(|k| point(inner(k), k)).collect();
    let corner = |k: u32| {
        let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / f64::from(n)).sin_cos();
        let radius = 40.0 + f64::from((k * 7919) % 17);
        [radius * cos, radius * sin]
    };
    let star: Vec<[f64; 2]> = (0..n).map(corner).collect();
    let vertices: String =
        star.iter().rev().map(|[x, y]| format!("<twoDimVertex x=\"{x:?}\" y=\"{y:?}\"/>")).collect();
    let section = |order: u32, z: f64, scale: f64| {
        format!(
            "<section zOrder=\"{order}\" zPosition=\"{z}\" xOffset=\"0\" yOffset=\"0\" scalingFactor=\"{scale}\"/>"
        )
    };
    let polygon = rayweave_polygon::from_polygons(&[star], rayweave_rootray::Side::Outside).unwrap();
    let solids = [
        format!("<polycone name=\"S\" deltaphi=\"360\" aunit=\"deg\">{planes}</polycone>"),
        format!("<genericPolycone name=\"S\" deltaphi=\"360\" aunit=\"deg\">{up}{down}</genericPolycone>"),
        format!("<xtru name=\"S\">{vertices}{}{}</xtru>", section(0, 0.0, 1.0), section(1, 2000.0, 3.0)),
    ];
    for solid in solids {
        let world = "<box name=\"W\" x=\"9000\" y=\"9000\" z=\"9000\"/>";
        let imported = parse(&model(
            "",
            &format!("{world}{solid}"),
            "<volume name=\"V\"><materialref ref=\"Al\"/><solidref ref=\"S\"/></volume>\
             <volume name=\"World\"><materialref ref=\"Al\"/><solidref ref=\"W\"/><physvol><volumeref ref=\"V\"/></physvol></volume>",
        ))
        .unwrap();
        for z in [0.25f64, 777.5, 1234.125, 1999.75] {
            let (k, part) = (z as u32, z.fract());
            let between = |of: &dyn Fn(u32) -> f64| of(k) + part * (of(k + 1) - of(k));
            let expected: Vec<f64> = if solid.starts_with("<xtru") {
                let scale = 1.0 + z / 1000.0;
                polygon.trace([0.0, 0.5 / scale], [1.0, 0.0]).unwrap().times().map(|t| scale * t).collect()
            } else {
                let [r, q] = [between(&outer), between(&inner)].map(|r| (r * r - 0.25f64).sqrt());
                vec![-r, -q, q, r]
            };
            let found = along(&imported, [0.0, 0.5, z], [1.0, 0.0, 0.0]);
            let times: Vec<f64> = found[1..found.len() - 1].iter().map(|(t, _)| *t).collect();
            assert_eq!(times.len(), expected.len(), "{} z = {z}: {times:?} {expected:?}", &solid[..9]);
            let near = times.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-9);
            assert!(near, "{} z = {z}: {times:?} {expected:?}", &solid[..9]);
        }
        let regions = imported.scene.model_regions();
        let program = Program::compile_regions(&regions).unwrap();
        let boxes = program.matters(&program.prototypes()[0]);
        let around = boxes.iter().filter(|own| own.contains(Vec3::new(24.0, 0.5, 777.5))).count();
        assert!(around < 200, "{}: {around} surfaces matter at a point", &solid[..9]);
    }
}
