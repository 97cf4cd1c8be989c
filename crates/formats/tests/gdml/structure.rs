//! GDML volume hierarchies: placements, replicas, divisions, parameterised volumes.

use super::{along, model, parse};
use rayweave_formats::LossKind;
use rayweave_math::Vec3;
use rayweave_model::{Evaluator, Program, Query, RegionId, Window};
use rayweave_scene::Datum;
use rayweave_shape::Ray;
use rayweave_trace::Weave;
use std::sync::Arc;

/// A volume element with a name, a solid and further content.
fn volume(name: &str, solid: &str, content: &str) -> String {
    format!("<volume name=\"{name}\"><materialref ref=\"Al\"/><solidref ref=\"{solid}\"/>{content}</volume>")
}

const BOXES: &str = "<box name=\"big\" x=\"200\" y=\"200\" z=\"200\"/><box name=\"slab\" x=\"20\" y=\"40\" z=\"60\"/>\
                     <box name=\"cube\" x=\"2\" y=\"2\" z=\"2\"/>";

fn names(list: &[(f64, String)]) -> Vec<(f64, &str)> {
    list.iter().map(|(t, name)| ((t * 1e6).round() / 1e6, name.as_str())).collect()
}

#[test]
fn daughters_carve_their_mothers() {
    let structure = [
        volume("Inner", "cube", ""),
        volume("Outer", "slab", "<physvol><volumeref ref=\"Inner\"/><position x=\"5\"/></physvol>"),
        volume(
            "World",
            "big",
            "<physvol name=\"a\"><volumeref ref=\"Outer\"/><position x=\"-50\"/></physvol>\
                                <physvol name=\"b\"><volumeref ref=\"Outer\"/><position x=\"50\"/></physvol>",
        ),
    ];
    let imported = parse(&model("", BOXES, &structure.concat())).unwrap();
    let order: Vec<&str> = imported.scene.regions.iter().map(|region| region.name.as_str()).collect();
    assert_eq!(order, ["World", "Outer", "Inner"]);
    let expected = [
        (0.0, "World"),
        (40.0, "Outer"),
        (54.0, "Inner"),
        (56.0, "Outer"),
        (60.0, "World"),
        (140.0, "Outer"),
        (154.0, "Inner"),
        (156.0, "Outer"),
        (160.0, "World"),
        (200.0, "-"),
    ];
    assert_eq!(names(&along(&imported, [-100.0, 0.1, 0.2], [1.0, 0.0, 0.0])), expected);
}

/// The positions of the small cube's centre are those of Geant4 11.4.1 for this file.
#[test]
fn rotations_are_those_of_the_mothers_frame() {
    let turned = "<physvol><volumeref ref=\"Arm\"/><position x=\"10\" y=\"20\" z=\"30\"/>\
                  <rotation x=\"30\" y=\"40\" z=\"50\" unit=\"deg\"/></physvol>";
    let structure = [
        volume("Tip", "cube", ""),
        "<assembly name=\"Arm\"><physvol><volumeref ref=\"Tip\"/><position x=\"30\" y=\"0\" z=\"0\"/></physvol></assembly>"
            .to_owned(),
        volume("World", "big", turned),
    ];
    let imported = parse(&model("", BOXES, &structure.concat())).unwrap();
    let program = Program::compile(&imported.scene.regions[1].solid).unwrap();
    let bounds = program.prototypes()[0].bounds;
    let middle = 0.5 * (bounds.lo + bounds.hi);
    let expected = TIP;
    for axis in 0..3 {
        assert!((middle[axis] - expected[axis]).abs() < 1e-9, "{middle}");
    }
}

const TIP: [f64; 3] = [24.77211629518312, 6.295220222429869, 52.22529170584472];

/// Rotated and reflected placements, assemblies, replicas, divisions and parameterised copies, against `G4Navigator` of
/// Geant4 11.4.1 (through geant4-pybind 0.1.3).
#[test]
fn media_along_rays_are_those_of_geant4() {
    media_are_those_of(include_str!("structure.gdml"), include_str!("structure.csv"), 300);
}

/// Divisions of parallelepipeds, polycones, polyhedra and along radii, replicas along the radius of a cone, polycones with
/// non-monotonic z, and parameterised polycones and polyhedra, against the same reference.
#[test]
fn media_in_pieces_are_those_of_geant4() {
    media_are_those_of(include_str!("copies.gdml"), include_str!("copies.csv"), 150);
}

fn media_are_those_of(file: &str, rays: &str, count: usize) {
    let imported = parse(file).unwrap();
    assert!(imported.report.is_empty());
    let program = Arc::new(Program::compile_regions(&imported.scene.model_regions()).unwrap());
    let weave = Weave::new(program);
    let medium = |region: RegionId| match region.index() {
        0 => "-",
        k => imported.scene.media[imported.scene.regions[k - 1].medium as usize].name.as_str(),
    };
    let lines: Vec<&str> = rays.lines().filter(|line| !line.starts_with('#')).collect();
    assert_eq!(lines.len(), count);
    for line in lines {
        let words: Vec<&str> = line.split(',').collect();
        let number = |k: usize| words[k].parse::<f64>().unwrap();
        let vector = |k: usize| Vec3::new(number(k), number(k + 1), number(k + 2));
        let ray = Ray { origin: vector(0), direction: vector(3).normalize() };
        let query = Query { window: Window::new(0.0, f64::INFINITY).unwrap(), ..Query::default() };
        let answer = weave.one(ray, &query).unwrap();
        let mut ours = vec![(0.0, medium(answer.starts[0]))];
        ours.extend(answer.crossings.iter().map(|crossing| (crossing.t, medium(crossing.after))));
        ours.dedup_by_key(|(_, medium)| *medium);
        let theirs: Vec<(f64, &str)> =
            (6..words.len()).step_by(2).map(|k| (number(k), words[k + 1])).collect();
        let near = |(a, b): (&(f64, &str), &(f64, &str))| (a.0 - b.0).abs() < 2e-6 && a.1 == b.1;
        assert!(ours.len() == theirs.len() && ours.iter().zip(&theirs).all(near), "{line}\n{ours:?}");
    }
}

/// Volume of all regions whose names have a prefix, from a grid of rays.
fn volume_of(imported: &rayweave_formats::Imported, name: &str) -> f64 {
    // each region gets its own medium, since only changes of medium are crossings
    let mut regions = imported.scene.model_regions();
    regions.iter_mut().zip(1..).for_each(|(region, medium)| region.medium = medium);
    let program = Arc::new(Program::compile_regions(&regions).unwrap());
    let weave = Weave::new(program);
    let is_wanted = |region: RegionId| {
        region.index() > 0 && imported.scene.regions[region.index() - 1].name.starts_with(name)
    };
    let (count, half) = (160, 60.0);
    let place = |k: usize| half * (2.0 * (k as f64 + 0.5) / count as f64 - 1.0);
    let mut length = 0.0;
    for (i, k) in (0..count).flat_map(|i| (0..count).map(move |k| (i, k))) {
        let ray = Ray { origin: Vec3::new(place(i), place(k), -1000.0), direction: Vec3::Z };
        for crossing in &weave.one(ray, &Query::default()).unwrap().crossings {
            let sign = f64::from(u8::from(is_wanted(crossing.before)))
                - f64::from(u8::from(is_wanted(crossing.after)));
            length += sign * crossing.t;
        }
    }
    length * (2.0 * half / count as f64).powi(2)
}

/// The total volume of the slices equals the volume of the mother according to its formula; nothing is left of the mother.
#[test]
fn pieces_fill_their_mother() {
    let half_turn = std::f64::consts::PI;
    let trd = |x: &str| format!("<trd name=\"{x}\" x1=\"40\" x2=\"80\" y1=\"60\" y2=\"60\" z=\"100\"/>");
    let trd_y = |x: &str| format!("<trd name=\"{x}\" x1=\"60\" x2=\"60\" y1=\"80\" y2=\"40\" z=\"100\"/>");
    let frusta = |x: &str| {
        format!(
            "<polycone name=\"{x}\" startphi=\"1\" deltaphi=\"3\"><zplane z=\"-50\" rmin=\"5\" rmax=\"20\"/>\
             <zplane z=\"30\" rmin=\"5\" rmax=\"50\"/></polycone>"
        )
    };
    let frustum =
        half_turn / 3.0 * 80.0 * (20.0 * 20.0 + 20.0 * 50.0 + 50.0 * 50.0) - half_turn * 25.0 * 80.0;
    let cases: [(String, &str, f64); 3] = [
        (trd("m") + &trd("s"), "axis=\"kXAxis\" number=\"4\"", 360_000.0),
        (trd_y("m") + &trd_y("s"), "axis=\"kYAxis\" number=\"5\"", 360_000.0),
        (
            frusta("m") + &frusta("s"),
            "axis=\"kPhi\" number=\"3\" unit=\"rad\"",
            frustum * 3.0 / (2.0 * half_turn),
        ),
    ];
    for (solids, division, expected) in cases {
        let inner = format!(
            "<divisionvol {division} width=\"0\" offset=\"0\"><volumeref ref=\"Piece\"/></divisionvol>"
        );
        let place = "<physvol><volumeref ref=\"Mother\"/></physvol>";
        let structure =
            volume("Piece", "s", "") + &volume("Mother", "m", &inner) + &volume("World", "big", place);
        let imported = parse(&model("", &(BOXES.to_owned() + &solids), &structure)).unwrap();
        let (pieces, rest) = (volume_of(&imported, "Piece"), volume_of(&imported, "Mother"));
        assert!((pieces / expected - 1.0).abs() < 3e-3, "{division}: {pieces}, not {expected}");
        assert!(rest.abs() < 1e-6 * expected, "{division}: {rest}");
    }
}

/// In older files, axis, width and offset are attributes of `replicavol`.
#[test]
fn old_replicas_are_read() {
    let row = "<replicavol axis=\"kXAxis\" number=\"4\" width=\"20\" offset=\"0\" unit=\"mm\"><volumeref ref=\"Slice\"/></replicavol>";
    let structure = volume("Slice", "slab", "") + &volume("World", "big", row);
    let imported = parse(&model("", BOXES, &structure)).unwrap();
    let hits = along(&imported, [-100.0, 0.3, 0.1], [1.0, 0.0, 0.0]);
    assert_eq!(names(&hits), [(0.0, "World"), (60.0, "Slice"), (140.0, "World"), (200.0, "-")]);
}

/// The syntax of pyg4ometry: the angular width of copies around an axis is in millimetres, which Geant4 treats as radians.
#[test]
fn angles_in_millimetres_are_radians() {
    let wheel = |unit: &str| {
        let row = format!(
            "<replicavol number=\"2\"><volumeref ref=\"Slice\"/><replicate_along_axis><direction phi=\"1\"/>\
             <width value=\"1.25\" unit=\"{unit}\"/><offset value=\"0.5\" unit=\"{unit}\"/></replicate_along_axis></replicavol>"
        );
        parse(&model("", BOXES, &(volume("Slice", "slab", "") + &volume("World", "big", &row)))).unwrap()
    };
    let (millimetres, radians) = (wheel("mm"), wheel("rad"));
    assert_eq!(millimetres.scene.regions, radians.scene.regions);
    assert!(
        millimetres.scene.warnings.iter().any(|warning| warning.message().contains("not a unit of an angle"))
    );
    assert_eq!(radians.scene.warnings.iter().count(), 0);
}

/// A loop with an empty range has no iterations, regardless of the sign of its step.
#[test]
fn empty_loops_generate_nothing() {
    let down = "<loop for=\"i\" from=\"3\" to=\"1\" step=\"-1\"><physvol><volumeref ref=\"Slice\"/></physvol></loop>";
    let structure = volume("Slice", "slab", "") + &volume("World", "big", down);
    let imported = parse(&model("<variable name=\"i\" value=\"3\"/>", BOXES, &structure)).unwrap();
    assert_eq!(imported.scene.regions.len(), 1);
}

#[test]
fn loops_make_volumes_and_places() {
    let define = "<variable name=\"i\" value=\"1\"/><variable name=\"k\" value=\"1\"/><constant name=\"step\" value=\"1*cm\"/>";
    let structure = volume("Pixel", "cube", "")
        + &volume(
            "World",
            "big",
            "<loop for=\"i\" to=\"3\" step=\"1\"><loop for=\"k\" from=\"1\" to=\"2\" step=\"1\">\
             <physvol name=\"pixel[i,k]\"><volumeref ref=\"Pixel\"/><position x=\"i*step\" y=\"k*step\"/></physvol></loop></loop>",
        );
    let imported = parse(&model(define, BOXES, &structure)).unwrap();
    let hits = along(&imported, [-100.0, 20.3, 0.1], [1.0, 0.0, 0.0]);
    let pixels = hits.iter().filter(|(_, name)| name == "Pixel").map(|(t, _)| t - 100.0);
    assert_eq!(pixels.collect::<Vec<_>>(), [9.0, 19.0, 29.0]);
    let document = imported.document();
    let table = &document.foreign("gdml").unwrap().text;
    assert!(table.contains("pixel_2_1"), "names count from 0: {table}");
}

#[test]
fn replicas_and_divisions_fill_their_mothers() {
    let replicas = "<replicavol number=\"4\"><volumeref ref=\"Layer\"/><replicate_along_axis><direction z=\"1\"/>\
                    <width value=\"15\" unit=\"mm\"/><offset value=\"0\" unit=\"mm\"/></replicate_along_axis></replicavol>";
    let solids = BOXES.to_owned() + "<box name=\"layer\" x=\"20\" y=\"40\" z=\"15\"/>";
    let core = "<physvol><volumeref ref=\"Core\"/></physvol>";
    let structure = [
        volume("Core", "cube", ""),
        volume("Layer", "layer", core),
        volume("Stack", "slab", replicas),
        volume("World", "big", "<physvol><volumeref ref=\"Stack\"/></physvol>"),
    ];
    let imported = parse(&model("", &solids, &structure.concat())).unwrap();
    let hits = along(&imported, [0.1, 0.2, -100.0], [0.0, 0.0, 1.0]);
    let cores: Vec<f64> = hits.iter().filter(|(_, name)| name == "Core").map(|(t, _)| t - 100.0).collect();
    assert_eq!(cores, [-23.5, -8.5, 6.5, 21.5]);

    // a division creates its own slices if the solid of the volume is not a slice
    let divided = "<divisionvol axis=\"kXAxis\" number=\"5\" unit=\"mm\" width=\"4\" offset=\"0\"><volumeref ref=\"Core\"/></divisionvol>";
    let structure = [volume("Core", "cube", ""), volume("World", "slab", divided)];
    let imported = parse(&model("", BOXES, &structure.concat())).unwrap();
    assert_eq!(imported.scene.regions.len(), 6);
    let hits = along(&imported, [-50.0, 15.0, 20.0], [1.0, 0.0, 0.0]);
    assert_eq!(names(&hits)[..3], [(40.0, "Core[0]"), (44.0, "Core[1]"), (48.0, "Core[2]")]);
}

#[test]
fn rings_along_rho_and_sectors_around_phi() {
    let solids = "<tube name=\"disc\" rmax=\"50\" z=\"10\" deltaphi=\"360\" aunit=\"deg\"/>\
                  <tube name=\"ring\" rmax=\"10\" z=\"10\" deltaphi=\"360\" aunit=\"deg\"/>";
    let row = |axis: &str, number: u32, width: &str| {
        format!(
            "<replicavol number=\"{number}\"><volumeref ref=\"Ring\"/><replicate_along_axis><direction {axis}=\"1\"/>\
                 {width}</replicate_along_axis></replicavol>"
        )
    };
    let rings = row("rho", 5, "<width value=\"10\" unit=\"mm\"/><offset value=\"0\" unit=\"mm\"/>");
    let structure = volume("Ring", "ring", "") + &volume("World", "disc", &rings);
    let imported = parse(&model("", solids, &structure)).unwrap();
    let hits = along(&imported, [0.5, 0.3, 0.1], [1.0, 0.0, 0.0]);
    let outward: Vec<&str> = hits.iter().filter(|(t, _)| *t > 0.0).map(|(_, name)| name.as_str()).collect();
    assert_eq!(outward, ["Ring[1]", "Ring[2]", "Ring[3]", "Ring[4]", "-"]);
}

#[test]
fn copies_may_have_their_own_dimensions() {
    let parameters = |k: u32, x: i32, size: u32| {
        format!(
            "<parameters number=\"{k}\"><position name=\"p{k}\" x=\"{x}\"/><box_dimensions x=\"{size}\" y=\"{size}\" z=\"{size}\"/></parameters>"
        )
    };
    let list = [parameters(1, -40, 10), parameters(2, 40, 30)].concat();
    let content = format!(
        "<paramvol ncopies=\"2\"><volumeref ref=\"Piece\"/><parameterised_position_size>{list}</parameterised_position_size></paramvol>"
    );
    let structure = volume("Piece", "cube", "") + &volume("World", "big", &content);
    let imported = parse(&model("", BOXES, &structure)).unwrap();
    let hits = along(&imported, [-100.0, 0.1, 0.2], [1.0, 0.0, 0.0]);
    let expected = [
        (0.0, "World"),
        (55.0, "Piece[0]"),
        (65.0, "World"),
        (125.0, "Piece[1]"),
        (155.0, "World"),
        (200.0, "-"),
    ];
    assert_eq!(names(&hits), expected);
}

#[test]
fn mirrored_placements_are_mirrored() {
    let solids = BOXES.to_owned() + "<trd name=\"wedge\" x1=\"20\" x2=\"10\" y1=\"20\" y2=\"20\" z=\"20\"/>";
    let content = "<physvol><volumeref ref=\"Wedge\"/><scale x=\"1\" y=\"1\" z=\"-1\"/></physvol>";
    let structure = volume("Wedge", "wedge", "") + &volume("World", "big", content);
    let imported = parse(&model("", &solids, &structure)).unwrap();
    // the narrow end is below now
    let hits = along(&imported, [-100.0, 0.1, -10.0 + 1e-9], [1.0, 0.0, 0.0]);
    assert!((hits[1].0 - 95.0).abs() < 1e-6 && hits[1].1 == "Wedge", "{hits:?}");
}

#[test]
fn a_refused_solid_removes_only_its_own_volume() {
    let solids = BOXES.to_owned() + "<box name=\"flat\" x=\"10\" y=\"10\" z=\"0\"/>";
    let structure = [
        volume("Inner", "cube", ""),
        volume("Flat", "flat", "<physvol><volumeref ref=\"Inner\"/></physvol>"),
        volume("World", "big", "<physvol><volumeref ref=\"Flat\"/><position x=\"20\"/></physvol>"),
    ];
    let imported = parse(&model("", &solids, &structure.concat())).unwrap();
    assert_eq!(imported.report.count(LossKind::Refused), 1);
    let hits = along(&imported, [-100.0, 0.1, 0.2], [1.0, 0.0, 0.0]);
    assert_eq!(names(&hits), [(0.0, "World"), (119.0, "Inner"), (121.0, "World"), (200.0, "-")]);
}

#[test]
fn optical_data_are_kept_in_a_table() {
    let define = "<matrix name=\"N\" coldim=\"2\" values=\"1*eV 1.5 3*eV 1.7\"/>";
    let text = model(define, BOXES, &volume("World", "big", "<auxiliary auxtype=\"SensDet\" auxvalue=\"pmt\"/>"))
        .replace("</solids>", "<opticalsurface name=\"Skin\" model=\"unified\" finish=\"polished\" type=\"dielectric_metal\" value=\"1\">\
                  <property name=\"REFLECTIVITY\" ref=\"N\"/></opticalsurface></solids>")
        .replace("</structure>", "<skinsurface name=\"s\" surfaceproperty=\"Skin\"><volumeref ref=\"World\"/></skinsurface></structure>")
        .replace("</material>", "<property name=\"RINDEX\" ref=\"N\"/></material>");
    let imported = parse(&text).unwrap();
    let index = imported.scene.media[1].index.unwrap();
    // 2.1039 eV on the line from (1 eV, 1.5) to (3 eV, 1.7)
    assert!((index - 1.610_392_836).abs() < 1e-6, "{index}");
    // the table survives a round trip
    let toml = imported.document().to_toml();
    let (document, scene) = rayweave_scene::parse(&toml).unwrap_or_else(|problems| panic!("{problems}"));
    assert_eq!(document.foreign("gdml"), imported.document().foreign("gdml"));
    assert_eq!(scene.regions.len(), imported.scene.regions.len());
    let Datum::Table(table) = &document.foreign("gdml").unwrap().value.value else {
        panic!("no table");
    };
    let keys: Vec<&str> = table.iter().map(|(key, _)| key.value.as_str()).collect();
    assert_eq!(keys, ["world", "volume", "material", "matrix", "surface", "skin"]);
}

/// Pointer suffixes are removed from names, and equal names are numbered.
#[test]
fn volumes_of_one_name_are_numbered() {
    let mut text = String::new();
    let mut places = String::new();
    for k in 0..3000 {
        text += &volume(&format!("Pixel0x{k:x}"), "cube", "");
        places += &format!("<physvol><volumeref ref=\"Pixel0x{k:x}\"/><position x=\"{}\"/></physvol>", 3 * k);
    }
    let imported = parse(&model("", BOXES, &(text + &volume("World", "big", &places)))).unwrap();
    let names: Vec<&str> = imported.scene.regions.iter().map(|region| region.name.as_str()).collect();
    assert_eq!((names[0], names[1], names[2], names[3000]), ("World", "Pixel", "Pixel2", "Pixel3000"));
}

/// A million million copies take a few lines in the file and a few maps in memory.
#[test]
fn copies_of_copies_take_no_more_room() {
    let mut text = volume("L0", "cube", "");
    for k in 1..7 {
        let places: String = (0..100)
            .map(|i| format!("<physvol><volumeref ref=\"L{}\"/><position x=\"{i}\"/></physvol>", k - 1))
            .collect();
        text += &format!("<assembly name=\"L{k}\">{places}</assembly>");
    }
    text += &volume("World", "big", "<physvol><volumeref ref=\"L6\"/></physvol>");
    let imported = parse(&model("", BOXES, &text)).unwrap();
    assert_eq!(imported.scene.regions.len(), 2);
    // they are too many to be numbered, which is an error before any work is done
    assert!(Program::compile_regions(&imported.scene.model_regions()).is_err());
}

/// Twenty kinds of boards at four thousand positions.
#[test]
fn many_placements_stay_small() {
    let mut text = String::new();
    for kind in 0..20 {
        text += &volume(&format!("Board{kind}"), "cube", "");
    }
    let place = |volume: &str, at: [f64; 3]| {
        format!(
            "<physvol name=\"placement-of-{volume}\"><volumeref ref=\"{volume}\"/><position name=\"p\" unit=\"mm\" x=\"{}\" y=\"{}\" \
                 z=\"{}\"/><rotation name=\"r\" unit=\"deg\" x=\"0\" y=\"0\" z=\"90\"/></physvol>\n",
            at[0], at[1], at[2]
        )
    };
    let grid = |k: usize, step: f64| [k % 16, k / 16 % 16, k / 256].map(|i| step * (i as f64 - 7.5));
    let boards: String = (0..4000).map(|k| place(&format!("Board{}", k % 20), grid(k, 4.0))).collect();
    text += &volume("World", "big", &boards);
    let text = model("", BOXES, &text);
    assert!(text.len() > 500_000);
    let imported = parse(&text).unwrap();
    assert_eq!(imported.scene.regions.len(), 21);
    let program = Program::compile_regions(&imported.scene.model_regions()).unwrap();
    // the model, and the solid that all copies share
    assert_eq!(program.prototypes().len(), 2);
    assert_eq!(program.prototypes()[0].placements, 4001);
}

/// The paths of the crossings along a ray, each truncated at its innermost placement.
fn placements_along(scene: &rayweave_scene::Scene, origin: [f64; 3], direction: [f64; 3]) -> Vec<String> {
    let mut regions = scene.model_regions();
    regions.iter_mut().zip(1..).for_each(|(region, medium)| region.medium = medium);
    let program = Arc::new(Program::compile_regions(&regions).unwrap());
    let ray = Ray { origin: Vec3::from_array(origin), direction: Vec3::from_array(direction) };
    let found = Weave::new(program.clone()).one(ray, &Query::default()).unwrap();
    let path = |crossing: &rayweave_model::Crossing| {
        program.occurrence_path(crossing.face.occurrence()).placed().to_string()
    };
    found.crossings.iter().map(path).collect()
}

fn physvol(volume: &str, copy: &str, x: f64) -> String {
    format!("<physvol{copy}><volumeref ref=\"{volume}\"/><position x=\"{x}\"/></physvol>")
}

/// Names of volumes with the copy numbers of the file, through any number of levels and formats.
#[test]
fn occurrence_paths_have_the_copy_numbers_of_the_file() {
    let structure = [
        volume("Tip0x55d0", "cube", ""),
        volume(
            "Arm",
            "slab",
            &(physvol("Tip0x55d0", " copynumber=\"4\"", -5.0) + &physvol("Tip0x55d0", "", 5.0)),
        ),
        volume(
            "World",
            "big",
            &(physvol("Arm", " copynumber=\"17\"", -50.0) + &physvol("Arm", " copynumber=\"12\"", 50.0)),
        ),
    ];
    let imported = parse(&model("", BOXES, &structure.concat())).unwrap();
    let arm = |k: u32| {
        let (own, tip) = (format!("Arm[{k}]"), |j: u32| format!("Arm[{k}]/Tip[{j}]"));
        [own.clone(), tip(4), tip(4), tip(1), tip(1), own]
    };
    // the surface of the world has no placement
    let expected = [vec![String::new()], arm(17).to_vec(), arm(12).to_vec(), vec![String::new()]].concat();
    let ray = ([-100.0, 0.1, 0.2], [1.0, 0.0, 0.0]);
    assert_eq!(placements_along(&imported.scene, ray.0, ray.1), expected);
    // a native file keeps names and numbers; the paths begin with the name of the solid of the region
    let text = rayweave_scene::Document::from_scene(&imported.scene).to_toml();
    let (_, scene) = rayweave_scene::parse(&text).unwrap();
    let read = placements_along(&scene, ray.0, ray.1);
    let below = |path: &String| path.split_once('/').map_or(String::new(), |(_, rest)| rest.to_owned());
    assert_eq!(read.iter().map(below).collect::<Vec<_>>(), expected, "{text}");
    assert_eq!(scene.regions[2].solid, imported.scene.regions[2].solid.named("Tip"));
}

#[test]
fn replicas_and_divisions_are_counted() {
    let replicas = "<replicavol number=\"4\"><volumeref ref=\"Cell\"/><replicate_along_axis><direction x=\"1\"/>\
                    <width value=\"5\"/><offset value=\"0\"/></replicate_along_axis></replicavol>";
    let structure = [
        volume("Cell", "cube", ""),
        volume("Row", "slab", replicas),
        volume("World", "big", &physvol("Row", " copynumber=\"3\"", 0.0)),
    ];
    let imported = parse(&model("", BOXES, &structure.concat())).unwrap();
    let cells = (0..4).flat_map(|k| [format!("Row[3]/Cell[{k}]"), format!("Row[3]/Cell[{k}]")]);
    let row = || ["Row[3]".to_owned()];
    let expected: Vec<String> = row().into_iter().chain(cells).chain(row()).collect();
    let mut found = placements_along(&imported.scene, [-100.0, 0.1, 0.2], [1.0, 0.0, 0.0]);
    found.retain(|path| !path.is_empty());
    assert_eq!(found, expected);
    // slices with different sizes are separate volumes, named after the volume that is divided
    let divided = "<divisionvol axis=\"kXAxis\" number=\"2\" width=\"0\" offset=\"0\" unit=\"mm\">\
                   <volumeref ref=\"Cell\"/></divisionvol>";
    let structure = [
        volume("Cell", "cube", ""),
        volume("Row", "slab", divided),
        volume("World", "big", &physvol("Row", "", 0.0)),
    ];
    let imported = parse(&model("", BOXES, &structure.concat())).unwrap();
    let program = Program::compile_regions(&imported.scene.model_regions()).unwrap();
    let paths = program.occurrences().map(|k| program.occurrence_path(k).placed().to_string());
    let mut found: Vec<String> = paths.filter(|path| path.contains("Cell")).collect();
    found.sort();
    found.dedup();
    assert_eq!(found, ["Row/Cell[0]", "Row/Cell[1]"]);
}
