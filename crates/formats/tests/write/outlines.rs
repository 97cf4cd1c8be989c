//! Meshes of extruded and revolved outlines: closed, without intersections, with the volume of closed forms.

use rayweave_formats::{Format, RemarkKind, WriteError, WriteOptions, write};
use rayweave_mesh::Mesh;
use rayweave_mesh_io::{MeshFormat, ReadOptions, read_bytes};
use rayweave_scene::{Document, Scene};
use std::f64::consts::PI;

/// A vertex and the bulge of the edge to the next one.
type Bulged = (f64, f64, f64);

/// The bulge of the fillet of a right angle: tan(90 degrees / 4).
const QUARTER: f64 = std::f64::consts::SQRT_2 - 1.0;

fn scene(text: &str) -> Scene {
    rayweave_scene::parse(&format!("rayweave = 1\n{text}")).unwrap_or_else(|e| panic!("{text}: {e:?}")).1
}

/// The mesh of a scene, in which each edge has two triangles and no triangles intersect.
fn watertight(text: &str, tolerance: f64) -> Mesh {
    let options = WriteOptions { tolerance: Some(tolerance), text: true, ..WriteOptions::default() };
    let file = write(&scene(text), None, Format::Mesh(MeshFormat::Ply), &options);
    let file = file.unwrap_or_else(|error| panic!("{text} {tolerance}: {error}"));
    let mesh = read_bytes(&file.bytes, MeshFormat::Ply, &ReadOptions::default()).unwrap().mesh;
    let found = mesh.diagnose();
    assert!(found.is_sound() && found.non_manifold_edges.is_empty(), "{text} {tolerance}: {found}");
    mesh
}

/// Vertices lie on the surface, so that the error of the volume is at most the tolerance times the area.
fn has_volume(text: &str, expected: f64) {
    for tolerance in [0.2, 0.02] {
        let mesh = watertight(text, tolerance);
        let error = (mesh.volume() - expected).abs();
        assert!(error <= tolerance * mesh.area(), "{text} {tolerance}: {} {expected}", mesh.volume());
    }
}

/// The area within counter-clockwise vertices, and the integral of x over it: Green's theorem for the polygon, and circular segments.
///
/// *Source*: a segment of the radius R and the angle a has the area R^2 (a - sin a) / 2 and its centroid at the distance
/// 4 R sin^3(a/2) / (3 (a - sin a)) from the centre.
fn moments(vertices: &[Bulged]) -> [f64; 2] {
    let mut sums = [0.0; 2];
    for (k, &(x, y, bulge)) in vertices.iter().enumerate() {
        let (u, v, _) = vertices[(k + 1) % vertices.len()];
        let cross = x * v - u * y;
        sums[0] += 0.5 * cross;
        sums[1] += cross * (x + u) / 6.0;
        if bulge == 0.0 {
            continue;
        }
        let (b, length) = (bulge.abs(), (u - x).hypot(v - y));
        let (angle, radius) = (4.0 * b.atan(), 0.25 * length * (b + 1.0 / b));
        let area = 0.5 * radius * radius * (angle - angle.sin());
        let distance = 4.0 * radius * (0.5 * angle).sin().powi(3) / (3.0 * (angle - angle.sin()));
        // an arc that turns to the left lies on the right of its chord
        let to_arc = bulge.signum() * (v - y) / length;
        let centroid = 0.5 * (x + u) + to_arc * (0.5 * b * length - radius + distance);
        sums[0] += bulge.signum() * area;
        sums[1] += bulge.signum() * area * centroid;
    }
    sums
}

/// Outlines in x >= 0, and the same with all arcs as bulges.
fn cases() -> Vec<(&'static str, Vec<Bulged>)> {
    let q = QUARTER;
    let block = |end: &[Bulged]| [&[(0.0, 0.0, 0.0)], end, &[(0.0, 10.0, 0.0)]].concat();
    let step = |inner: &[Bulged]| {
        let start = [(0.0, 0.0, 0.0), (20.0, 0.0, 0.0), (20.0, 5.0, 0.0)];
        [&start, inner, &[(10.0, 15.0, 0.0), (0.0, 15.0, 0.0)]].concat()
    };
    vec![
        (
            "[[0,0],[20,0],{at=[20,10],fillet=3},[0,10]]",
            block(&[(20.0, 0.0, 0.0), (20.0, 7.0, q), (17.0, 10.0, 0.0)]),
        ),
        (
            "[[0,0],[20,0],[20,5],{at=[10,5],fillet=3},[10,15],[0,15]]",
            step(&[(13.0, 5.0, -q), (10.0, 8.0, 0.0)]),
        ),
        (
            "[[0,0],[20,0],{at=[20,10],chamfer=3},[0,10]]",
            block(&[(20.0, 0.0, 0.0), (20.0, 7.0, 0.0), (17.0, 10.0, 0.0)]),
        ),
        (
            "[[0,0],[20,0],[20,5],{at=[10,5],chamfer=3},[10,15],[0,15]]",
            step(&[(13.0, 5.0, 0.0), (10.0, 8.0, 0.0)]),
        ),
        ("[[0,0],{at=[20,0],bulge=1},[20,10],[0,10]]", block(&[(20.0, 0.0, 1.0), (20.0, 10.0, 0.0)])),
        ("[[0,0],{at=[20,0],bulge=-0.5},[20,10],[0,10]]", block(&[(20.0, 0.0, -0.5), (20.0, 10.0, 0.0)])),
        ("[[0,0],{at=[20,0],through=[25,5]},[20,10],[0,10]]", block(&[(20.0, 0.0, 1.0), (20.0, 10.0, 0.0)])),
        ("[[0,0],{at=[20,0],through=[15,5]},[20,10],[0,10]]", block(&[(20.0, 0.0, -1.0), (20.0, 10.0, 0.0)])),
        // the arc is tangent to both neighbours, and so are the fillets to it
        (
            "[{at=[2,0],fillet=2},{at=[20,0],fillet=2},{at=[20,10],fillet=3},{at=[2,10],fillet=3}]",
            vec![
                (4.0, 0.0, 0.0),
                (18.0, 0.0, q),
                (20.0, 2.0, 0.0),
                (20.0, 7.0, q),
                (17.0, 10.0, 0.0),
                (5.0, 10.0, q),
                (2.0, 7.0, 0.0),
                (2.0, 2.0, q),
            ],
        ),
    ]
}

const HOLE: &str = "{circle=1.5,at=[6,4]}";

#[test]
fn extruded_outlines_are_watertight() {
    let bore = PI * 1.5 * 1.5;
    for (outline, vertices) in cases() {
        let [area, _] = moments(&vertices);
        has_volume(&format!("[solid.part.extrude]\noutline={outline}\nheight=7\n"), 7.0 * area);
        let holed = format!("[solid.part.extrude]\noutline=[{outline},{HOLE}]\nheight=7\n");
        has_volume(&holed, 7.0 * (area - bore));
        let drilled = format!(
            "[solid.a.extrude]\noutline={outline}\nheight=7\n[solid.b]\ncylinder={{radius=1.5,height=30}}\n\
             transform=[{{translate=[6,4,3]}}]\n[solid.part]\nexpr='a-b'\n"
        );
        has_volume(&drilled, 7.0 * (area - bore));
    }
}

#[test]
fn revolved_outlines_are_watertight() {
    let ring = PI * 1.5 * 1.5 * 6.0;
    for (outline, vertices) in cases() {
        // Pappus
        let [_, moment] = moments(&vertices);
        let part = |rest: &str| format!("[solid.part.revolve]\noutline={outline}\n{rest}");
        has_volume(&part(""), 2.0 * PI * moment);
        has_volume(&part("angle=100\nstart=20\n"), 2.0 * PI * moment * 100.0 / 360.0);
        let holed = format!("[solid.part.revolve]\noutline=[{outline},{HOLE}]\nangle=300\n");
        has_volume(&holed, 2.0 * PI * (moment - ring) * 300.0 / 360.0);
        let drilled = format!(
            "[solid.a.revolve]\noutline={outline}\n[solid.b]\ncylinder={{radius=1.5,height=60}}\n\
             transform=[{{translate=[7.3,0.4,0]}}]\n[solid.c]\ncylinder={{radius=1,height=60}}\n\
             transform=[{{rotate_y=90}},{{translate=[0.1,0.2,3.1]}}]\n[solid.part]\nexpr='a-b-c'\n"
        );
        for tolerance in [0.2, 0.02] {
            watertight(&drilled, tolerance);
        }
    }
}

/// The plate of the documentation with other radii of its corners, without rims.
fn plate(radius: f64) -> String {
    format!(
        "[solid.plate.extrude]\noutline=[[[-30,-20],[30,-20],[30,20],[-30,20]],{{circle=4,at=[-18,0]}},\
         {{circle=4,at=[18,0]}}]\nheight=8\nfillet={radius}\n"
    )
}

const KNOB: &str =
    "[solid.knob.revolve]\noutline=[[0,8],[9,8],{at=[9,10],bulge=-0.3},[5,16],[8,20],[0,20]]\n";

/// The volume of the plate between two heights, where `inset` is the distance from the walls.
fn volume_of_layers(radius: f64, [lo, hi]: [f64; 2], inset: impl Fn(f64) -> f64) -> f64 {
    let area = |z: f64| {
        let d = inset(z);
        let corners = (4.0 - PI) * (radius - d).powi(2);
        (60.0 - 2.0 * d) * (40.0 - 2.0 * d) - corners - 2.0 * PI * (4.0 + d).powi(2)
    };
    let count = 20_000;
    let step = (hi - lo) / f64::from(count);
    (0..count).map(|k| step * area(lo + (f64::from(k) + 0.5) * step)).sum()
}

/// The inset of a fillet of the radius `r` that ends at the height 8.
fn fillet(r: f64, z: f64) -> f64 {
    r - (r * r - (z - (8.0 - r)).max(0.0).powi(2)).sqrt()
}

/// Both examples of the documentation, alone and with further rims.
#[test]
fn rims_and_documented_examples_are_watertight() {
    let whole = volume_of_layers(5.0, [0.0, 8.0], |z| (1.0 - z).max(0.0) + fillet(1.5, z));
    has_volume(&format!("{}top={{fillet=1.5}}\nbottom={{chamfer=1}}\n", plate(5.0)), whole);
    // the corners shrink to points
    let dots = volume_of_layers(3.0, [0.0, 8.0], |z| (2.0 - z).max(0.0) + fillet(3.0, z));
    has_volume(&format!("{}top={{fillet=3}}\nbottom={{chamfer=2}}\n", plate(3.0)), dots);
    let knob = [
        (0.0, 8.0, 0.0),
        (9.0, 8.0, 0.0),
        (9.0, 10.0, -0.3),
        (5.0, 16.0, 0.0),
        (8.0, 20.0, 0.0),
        (0.0, 20.0, 0.0),
    ];
    has_volume(KNOB, 2.0 * PI * moments(&knob)[1]);
    // mitres, and rims that meet
    let mitred = "[solid.part.extrude]\noutline=[[0,0],[20,0],[20,5],[10,5],[10,15],[0,15]]\nheight=4\n\
        top={fillet=2}\nbottom={fillet=2}\n";
    for tolerance in [0.2, 0.02] {
        watertight(mitred, tolerance);
        watertight(&format!("{}top={{fillet=1.5}}\n{KNOB}", plate(5.0)), tolerance);
    }
}

/// The tree of half-spaces and cylinders of an outline, without its description: the facets of its parts do not match.
#[test]
fn meshes_that_are_not_sound_are_written_on_request_only() {
    let tree = Document::from_scene(&scene(KNOB)).to_toml();
    let (_, scene) = rayweave_scene::parse(&tree).unwrap();
    let format = Format::Mesh(MeshFormat::Obj);
    let mut options = WriteOptions { tolerance: Some(0.05), ..WriteOptions::default() };
    let error = write(&scene, None, format, &options).unwrap_err();
    assert!(matches!(error, WriteError::Unsound { .. }), "{error}");
    let text = error.to_string();
    assert!(
        text.starts_with("the mesh of region `knob` is not sound: ") && text.contains("the first is at ("),
        "{text}"
    );
    options.allow_unsound = true;
    let remarks = write(&scene, None, format, &options).unwrap().remarks;
    let defect = remarks.iter().find(|remark| remark.what.contains("is not sound")).unwrap();
    assert!(defect.kind == RemarkKind::Approximated && !defect.is_expected, "{defect}");
}
