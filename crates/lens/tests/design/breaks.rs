//! Folded and tilted axes: a plane mirror changes nothing; Zemax files trace as in Optiland.

use crate::lenses::{D_NM, at_image, disk, doublet, near};
use rayweave_lens::analysis::Study;
use rayweave_lens::prescription::{Behind, CoordinateBreak, Prescription, PrescriptionError, read_zmx};
use rayweave_math::{Affine, Vec3};
use rayweave_optics::Tracer;
use rayweave_trace::Packets;

/// A lens with a plane mirror at 45 degrees, 40 behind it, as a Zemax file: one break before the mirror, one
/// behind it.
fn folded(lens: &Prescription) -> String {
    let mut text =
        "ENPD 20\nFTYP 0 0 2 1\nXFLN 0 0\nYFLN 0 1\nWAVM 1 0.5875618 1\nSURF 0\n DISZ INFINITY\n".to_owned();
    let last = lens.surfaces.len() - 1;
    for (k, surface) in lens.surfaces[..=last].iter().enumerate() {
        let stop = if k == 0 { " STOP\n" } else { "" };
        let thickness = if k == last { 40.0 } else { surface.thickness };
        let glass = match &surface.behind {
            Behind::Glass(name) => format!(" GLAS {name}\n"),
            _ => String::new(),
        };
        text +=
            &format!("SURF {}\n{stop} CURV {:e}\n DISZ {thickness}\n{glass}", k + 1, 1.0 / surface.radius);
    }
    let on = 40.0 - lens.surfaces[last].thickness;
    text + &format!(
        "SURF 4\n TYPE COORDBRK\n PARM 3 45\n DISZ 0\nSURF 5\n DISZ 0\n GLAS MIRROR\nSURF 6\n TYPE COORDBRK\n PARM 3 45\n \
         DISZ {on}\nSURF 7\n"
    )
}

#[test]
fn a_fold_changes_nothing() {
    let (lens, text) = (doublet(), folded(&doublet()));
    let lens = Prescription { fields: vec![[0.0; 2], [0.0, 1.0]], ..lens }.entrance_pupil_diameter(20.0);
    let folded = read_zmx(text.as_bytes()).unwrap().prescription;
    let points = disk(200, 0.98);
    let [straight, around] = [&lens, &folded].map(|lens| {
        let layout = lens.assembly().unwrap();
        let system = layout.assembly.compile().unwrap();
        let tracer = Tracer::new(&system, Packets::new);
        let study = Study::new(lens, &layout, &tracer);
        [0, 1].map(|field| study.arrivals(field, D_NM, &points).unwrap())
    });
    for (one, other) in straight.iter().flatten().zip(around.iter().flatten()) {
        assert_eq!(one.id, other.id);
        // the frame of the image turns with the light
        near((one.position - other.position).length(), 0.0, 1e-9);
        // light on the longer axis starts farther in front
        near((one.path - straight[0][0].path) - (other.path - around[0][0].path), 0.0, 1e-9);
    }
    assert!(straight[1].len() > 150 && straight[1].len() == around[1].len());
    let data = [&lens, &folded].map(|lens| lens.first_order(D_NM).unwrap());
    near(data[0].focal_length, data[1].focal_length, 1e-10);
}

#[test]
fn inverse_breaks_cancel() {
    let (decentre, tilts) = ([0.3, -1.2], [12.0, -7.0, 31.0]);
    let there = CoordinateBreak::new(1, decentre, tilts).map;
    let back = CoordinateBreak::tilts_first(1, decentre.map(|x| -x), tilts.map(|x| -x)).map;
    let point = Vec3::new(3.0, 5.0, 7.0);
    near((back.then(&there).point(point) - point).length(), 0.0, 1e-14);
    // decentre first, then tilt about the new axes: x is unchanged by the tilt about x, z is rotated
    let turned = CoordinateBreak::new(1, [1.0, 2.0], [30.0, 0.0, 0.0]).map;
    near((turned.point(Vec3::Z) - Vec3::new(1.0, 2.0 - 0.5, 0.75_f64.sqrt())).length(), 0.0, 1e-15);
    let both = CoordinateBreak::new(1, [0.0; 2], [90.0, 90.0, 0.0]).map;
    near((both.vector(Vec3::Z) - Vec3::X).length(), 0.0, 1e-15);
}

#[test]
fn invalid_breaks_are_rejected() {
    let message = |lens: Prescription| lens.assembly().unwrap_err().to_string();
    let tilt = |before| CoordinateBreak::new(before, [0.0; 2], [1.0, 0.0, 0.0]);
    assert_eq!(
        message(doublet().broken(tilt(2))),
        "surfaces 1 and 2 are tilted or decentred relative to each other, with glass between them: a lens has one axis."
    );
    assert_eq!(
        message(doublet().broken(tilt(5))),
        "the surface behind a coordinate break is 5: it must be from 1 to 4."
    );
    let scaled = CoordinateBreak { before: 1, map: Affine::scale(Vec3::splat(2.0)) };
    assert!(
        message(doublet().broken(scaled))
            .starts_with("the scale of the coordinate break in front of surface 1 is 2")
    );
    let mirrored = CoordinateBreak { before: 1, map: Affine::mirror(Vec3::X) };
    assert!(message(doublet().broken(mirrored)).contains("surface 1 is -1"));
    let seidel = doublet().broken(tilt(1)).seidel().unwrap_err();
    assert!(matches!(seidel, PrescriptionError::Undefined { what: "Seidel sums", .. }));
    let file = "ENPD 1\nWAVM 1 0.5 1\nSURF 0\n DISZ INFINITY\nSURF 1\n STOP\n DISZ 1\nSURF 2\n TYPE COORDBRK\n PARM 9 1\n";
    let problems = read_zmx(file.as_bytes()).unwrap_err().to_string();
    assert!(
        problems.contains("line 9: the coordinate break has parameter 9: only 1 to 6 are read"),
        "{problems}"
    );
}

/// A lens and two mirrors, tilted about x and about y, decentred, with a mirror that is a conic.
const CROOKED: &str = "ENPD 8\nFTYP 0 0 2 1\nXFLN 0 0.5\nYFLN 0 1\nWAVM 1 0.5875618 1\nSURF 0\n DISZ INFINITY\n\
    SURF 1\n STOP\n CURV 0.01\n DISZ 3\n GLAS N-BK7\n DIAM 6 1\nSURF 2\n CURV -0.002\n DISZ 60\n DIAM 6 1\n\
    SURF 3\n TYPE COORDBRK\n PARM 2 0.5\n PARM 3 20\n DISZ 0\n\
    SURF 4\n CURV -0.0025\n DISZ 0\n GLAS MIRROR\n CONI -0.7\n DIAM 12 1\n\
    SURF 5\n TYPE COORDBRK\n PARM 3 20\n DISZ -70\nSURF 6\n TYPE COORDBRK\n PARM 1 -0.3\n PARM 4 15\n DISZ 0\n\
    SURF 7\n CURV 0.001\n DISZ 0\n GLAS MIRROR\n DIAM 12 1\nSURF 8\n TYPE COORDBRK\n PARM 4 15\n DISZ 40\n\
    SURF 9\n DIAM 20 1\n";

type End = (usize, [f64; 2], [f64; 3], [f64; 3]);

/// End points in the coordinates of the first surface: field, pupil point, position and direction by Optiland
/// 0.6.3.
const OPTILAND: [End; 8] = [
    (
        0,
        [0.0, 0.0],
        [19.938307878728704, 23.176663517929317, 35.69049750818241],
        [0.4994597549464021, -0.5543646424644926, 0.6657475470282227],
    ),
    (
        0,
        [0.0, 1.0],
        [19.93795742458417, 21.894726451206033, 34.615088717618285],
        [0.4991618589246351, -0.5827628810118786, 0.6412681678593123],
    ),
    (
        0,
        [1.0, 0.0],
        [18.61366307021377, 22.693107700962948, 36.283100656885615],
        [0.4677360243000687, -0.5655271247994117, 0.6792658409548323],
    ),
    (
        0,
        [-0.6, -0.7],
        [20.735420425872235, 24.390284903532574, 36.10808117284057],
        [0.5179451028439223, -0.5267851902835813, 0.6739660479118298],
    ),
    (
        1,
        [0.0, 0.0],
        [20.924342238242886, 25.239494418173635, 36.67826649137484],
        [0.5030212155287381, -0.5468818328662466, 0.6692457826604857],
    ),
    (
        1,
        [0.0, 1.0],
        [20.92103833681257, 23.958627471929283, 35.60598158453797],
        [0.5028505735763348, -0.5754721791941613, 0.6449597441914294],
    ),
    (
        1,
        [1.0, 0.0],
        [19.613296162213764, 24.75828111499142, 37.26258618722835],
        [0.4714553386697462, -0.5581237161893076, 0.6828087441347209],
    ),
    (
        1,
        [-0.6, -0.7],
        [21.716068412366276, 26.452326409724556, 37.099247362579575],
        [0.521306416299361, -0.5191516499372353, 0.6772895870250504],
    ),
];

#[test]
fn tilted_mirrors_agree_with_optiland() {
    let lens = read_zmx(CROOKED.as_bytes()).unwrap().prescription;
    let layout = lens.assembly().unwrap();
    for (field, point, place, direction) in OPTILAND {
        let beam = lens.beam(field, D_NM, &[point]).unwrap();
        let passes = lens.follow(&beam.get(0).ray, D_NM).unwrap();
        let last = passes.last().unwrap();
        near((last.point - Vec3::from(place)).length(), 0.0, 1e-10);
        near((last.direction - Vec3::from(direction)).length(), 0.0, 1e-12);
        // the solids agree
        let rows = at_image(&layout, &beam);
        near((rows[0].end - last.point).length(), 0.0, 1e-10);
    }
}

/// Collimated light parallel to the axis of a paraboloid converges at its focus: an off-axis mirror as in
/// catalogues, with its vertex decentred.
#[test]
fn an_off_axis_paraboloid_has_its_focus_on_its_axis() {
    let file = "ENPD 50\nWAVM 1 0.5875618 1\nSURF 0\n DISZ INFINITY\nSURF 1\n STOP\n DISZ 200\n\
        SURF 2\n TYPE COORDBRK\n PARM 2 -190\n DISZ 0\nSURF 3\n CURV -0.005\n CONI -1\n DISZ -100\n GLAS MIRROR\n\
        DIAM 25 1\n CLAP 0 25 0\n OBDC 0 190\nSURF 4\n DISZ 0\n";
    let read = read_zmx(file.as_bytes()).unwrap();
    assert!(read.notes.iter().any(|note| note.to_string().contains("OBDC")), "{:?}", read.notes);
    let layout = read.prescription.assembly().unwrap();
    let system = layout.assembly.compile().unwrap();
    let tracer = Tracer::new(&system, Packets::new);
    let rays = Study::new(&read.prescription, &layout, &tracer).arrivals(0, D_NM, &disk(100, 0.99)).unwrap();
    assert_eq!(rays.len(), 100);
    for ray in &rays {
        near((ray.position).length(), 0.0, 1e-9);
        // all paths to the focus of a paraboloid have the same length
        near(ray.path, rays[0].path, 1e-9);
    }
}
