//! Round trips: written files read back unchanged.

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use rayweave_math::{Affine, Vec3};
use rayweave_model::{Node, Solid};
use rayweave_scene::{Document, Scene, load, parse};
use rayweave_shape::primitive::Primitive;

const EVERYTHING: &str = r##"# A model with one of everything.
# It means nothing.
rayweave = 1
unit = "cm"
wiring = { harness = "A7" }

[parameters]
R = 50
half = "R / 2"

[solid.ball]
sphere = { radius = "R" }
transform = [{ rotate_x = 90 }, { translate = [0, "half", 48] }, { scale = 2 }, { scale = [1, 2, 3] }]

[solid.'odd name']
box = { size = [1, 2, "half"] }
transform = { rotate = { axis = [1, 1, 0], degrees = 30 } }

[solid.both]
expr = "ball & ~'odd name' | union(ball) - empty"

[solid._helper]
half_space = { normal = [0, 0, 1], offset = 0 }
transform = [{ mirror = [1, 0, 0] }, { rotate_y = 10 }, { rotate_z = 20 }]

[solid.relabelled]
name = "another name"
expr = "both - _helper"
transform = [{ matrix = [[1, 0.5, 0, 1], [0, 1, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]] }]

[solid.grid]
place = { solid = "ball", grid = [2, 1, "1 + 1"], step = [100, 0, 100], origin = [1, 2, 3] }
[solid.ring]
place = { solid = "ball", ring = 5, radius = 200, start = 90 }
[solid.some]
place = { solid = "ball", at = [[0, 0, 0], ["R", 0, 0]] }
[solid.turned]
place = { solid = "ball", matrices = [[[0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 1, 7], [0, 0, 0, 1]]] }

[[region]]
solid = "both"
medium = "glass"
colour = "#88aaff80"
[[region]]
solid = "relabelled"
name = "second"

[medium.glass]
index = 1.5
colour = "#fff"
density = 2.5
maker = "unknown"
[medium.world]
index = 1.0003

[camera]
projection = "orthographic"
height = 10
position = [1, 2, 3]
target = [0, 0, "half"]
up = [0, 1, 0]
size = [640, 480]

[[light]]
direction = [0, 0, -1]
intensity = 0.5
colour = "#ffeedd"
[[light]]
position = [1, 2, 3]

# This belongs to others.
[optics]
wavelengths_nm = [486.1, 587.6] # F and d

[optics.source.lamp]
at = [0, 0, 0]

[render]
background = "#000"
shading = "headlight"
edges = true
shadows = false
samples = 3

# So does this.
[[detector]]
pixels = 10
[[detector]]
pixels = 20
"##;

#[test]
fn a_document_survives() {
    let (document, scene) = parse(EVERYTHING).unwrap();
    // the tables of other programs are kept, with a warning
    let warnings: Vec<&str> = scene.warnings.iter().map(|warning| warning.message()).collect();
    assert_eq!(warnings.len(), 2, "{warnings:?}");
    for (warning, table) in warnings.iter().zip(["wiring", "detector"]) {
        assert!(warning.starts_with(&format!("the table `{table}` is not used: ")), "{warning}");
    }
    let text = document.to_toml();
    let (again, scene_again) = parse(&text).unwrap();
    assert_eq!(again, document);
    assert_eq!(scene_again, scene);
    assert_eq!(again.to_toml(), text);
}

#[test]
fn the_contents_are_read() {
    let (document, scene) = parse(EVERYTHING).unwrap();
    assert_eq!(document.heading, ["A model with one of everything.", "It means nothing."]);
    assert_eq!(scene.parameters, [("R".to_owned(), 50.0), ("half".to_owned(), 25.0)]);
    assert_eq!(scene.medium_names(), ["world", "glass", "second"]);
    assert_eq!(scene.media[0].index, Some(1.0003));
    assert_eq!(scene.media[1].numbers, [("density".to_owned(), 2.5)]);
    let regions: Vec<(&str, u32)> = scene.regions.iter().map(|r| (r.name.as_str(), r.medium)).collect();
    assert_eq!(regions, [("both", 1), ("second", 2)]);
    assert_eq!(scene.regions[0].colour.to_string(), "#88aaff80");
    assert_eq!(scene.camera.as_ref().unwrap().target, Vec3::new(0.0, 0.0, 25.0));
}

#[test]
fn solids_follow_their_operators() {
    let (_, scene) = parse(EVERYTHING).unwrap();
    let ball = build("sphere", &[("radius", 50.0)])
        .rotate_x(90.0)
        .translate(Vec3::new(0.0, 25.0, 48.0))
        .scale(Vec3::splat(2.0))
        .scale(Vec3::new(1.0, 2.0, 3.0))
        .named("ball");
    assert_eq!(scene.solid("ball"), Some(&ball));
    let odd = scene.solid("odd name").unwrap();
    let union = Solid::union([ball.clone()]) - Solid::empty();
    let both = ((&ball & !odd) | union).named("both");
    assert_eq!(scene.solid("both"), Some(&both));
    let offsets = [[1.0, 2.0, 3.0], [101.0, 2.0, 3.0], [1.0, 2.0, 103.0], [101.0, 2.0, 103.0]];
    let maps: Vec<Affine> = offsets.map(|p| Affine::translate(Vec3::from_array(p))).to_vec();
    assert_eq!(scene.solid("grid"), Some(&ball.place(maps).named("grid")));
    // names with `_` are private to the file
    let helper = scene.solid("_helper").unwrap();
    let rebuilt = Solid::from(half_space()).mirror(Vec3::X).rotate_y(10.0).rotate_z(20.0);
    assert_eq!(*helper, rebuilt);
}

fn build(name: &str, arguments: &[(&str, f64)]) -> Solid {
    let arguments: Vec<_> = arguments.iter().map(|(name, value)| (*name, (*value).into())).collect();
    rayweave_shape::primitive::build(name, &arguments).unwrap().into()
}

fn half_space() -> Primitive {
    let arguments = [("normal", Vec3::Z.into()), ("offset", 0.0.into())];
    rayweave_shape::primitive::build("half_space", &arguments).unwrap()
}

#[test]
fn tables_of_others_keep_their_text_and_places() {
    let (document, _) = parse(EVERYTHING).unwrap();
    let names: Vec<&str> = document.foreign.iter().map(|table| table.name.value.as_str()).collect();
    assert_eq!(names, ["wiring", "optics", "detector"]);
    let optics = document.foreign("optics").unwrap();
    let expected = "# This belongs to others.\n[optics]\nwavelengths_nm = [486.1, 587.6] # F and d\n\n\
                    [optics.source.lamp]\nat = [0, 0, 0]\n";
    assert_eq!(optics.text, expected);
    assert!(document.to_toml().contains(expected));
    assert_eq!(document.source.slice(optics.value.span), "[optics]");
    let detector = document.foreign("detector").unwrap();
    assert_eq!(detector.text, "# So does this.\n[[detector]]\npixels = 10\n[[detector]]\npixels = 20\n");
}

#[test]
fn overrides_replace_parameters() {
    let value = |overrides: &[(&str, &str)]| {
        let overrides: Vec<_> =
            overrides.iter().map(|(name, text)| ((*name).into(), (*text).into())).collect();
        rayweave_scene::parse_with(EVERYTHING, &overrides).unwrap().1.parameters[1].1
    };
    assert_eq!(value(&[]), 25.0);
    assert_eq!(value(&[("R", "60")]), 30.0);
    assert_eq!(value(&[("R", "2 * half"), ("half", "sqrt(16)")]), 4.0);
}

#[test]
fn a_scene_survives_as_a_document() {
    let (_, scene) = parse(EVERYTHING).unwrap();
    let document = Document::from_scene(&scene);
    let (_, again) = parse(&document.to_toml()).unwrap();
    // parameters and texts of media are lost, everything else is kept
    let expected = Scene { parameters: Vec::new(), ..scene };
    assert_eq!(again.regions, expected.regions);
    assert_eq!(again.media, expected.media);
    for (name, solid) in &expected.solids {
        assert_eq!(again.solid(name), Some(solid), "{name}");
    }
    assert_eq!(
        (again.camera, again.lights, again.render),
        (expected.camera, expected.lights, expected.render)
    );
}

#[test]
fn the_scene_of_a_document_is_that_of_its_text() {
    let (document, scene) = parse(EVERYTHING).unwrap();
    assert_eq!(document.scene(&[]).unwrap(), scene);
}

fn check_solid(solid: &Solid) {
    let document = Document::from_solid("whole", solid);
    let text = document.to_toml();
    let (_, scene) = parse(&text).unwrap_or_else(|problems| panic!("{text}\n{problems}"));
    let expected = match solid.node() {
        Node::Named(..) => solid.clone(),
        _ => solid.named("whole"),
    };
    assert_eq!(scene.solid("whole"), Some(&expected), "{text}");
    assert_eq!(document.scene(&[]).unwrap(), scene);
}

#[test]
fn solids_survive() {
    let ball = build("sphere", &[("radius", 1.0)]);
    let named = ball.named("ball");
    let moved = named.translate(Vec3::X).scale(Vec3::new(1.0, 2.0, -1.0)).rotate_z(33.0);
    check_solid(&ball);
    check_solid(&Solid::empty());
    check_solid(&!Solid::universe());
    check_solid(&named);
    check_solid(&named.named("twice"));
    check_solid(&moved);
    check_solid(&moved.named("moved").translate(Vec3::Z));
    check_solid(&((&ball | &ball) | (&ball - (&moved - &named))));
    check_solid(&Solid::union([Solid::union([]), Solid::intersection([ball.clone()])]));
    check_solid(
        &(ball.named("hole") ^ moved.named("hole") ^ ball.named("empty") ^ ball.named("") ^ ball.named("_1")),
    );
    check_solid(&ball.named("it's \"odd\"\\\n\u{e4}"));
    check_solid(&(&ball & &ball.named("whole")));
    check_solid(&Solid::empty().place(vec![Affine::IDENTITY]));
    check_solid(
        &moved.place(vec![Affine::translate(Vec3::X), Affine::rotation(Vec3::ONE, 5.0)]).translate(Vec3::Y),
    );
    let shared = &moved | &ball;
    check_solid(&(shared.translate(Vec3::Z) - shared.place(vec![Affine::translate(Vec3::X)])));
    check_solid(&ball.scale(Vec3::new(0.1, 1.0 / 3.0, 1e5)).translate(Vec3::new(-0.0, 5e-324, 0.1)));
}

#[test]
fn a_graph_stays_a_graph() {
    // expanded to a tree, it would have 2^60 leaves
    let mut solid = build("sphere", &[("radius", 1.0)]);
    for _ in 0..60 {
        solid = &solid | &solid;
    }
    let document = Document::from_solid("whole", &solid);
    assert_eq!(document.solids.len(), 61);
    let (_, scene) = parse(&document.to_toml()).unwrap();
    assert_eq!(scene.solid("whole"), Some(&solid.named("whole")));
}

#[test]
fn random_solids_survive() {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    for _ in 0..200 {
        let mut parts: Vec<Solid> = (0..4).map(|_| Primitive::random(|| rng.random()).into()).collect();
        for step in 0..30 {
            let mut pick = || parts[rng.random_range(0..parts.len())].clone();
            let (a, b, c) = (pick(), pick(), pick());
            parts.push(match rng.random_range(0..10) {
                0 => Solid::union([a, b, c]),
                1 => Solid::intersection([a, b]),
                2 => a - b,
                3 => a ^ b ^ c,
                4 => !a,
                5 => a.translate(Vec3::new(rng.random(), 0.0, rng.random())),
                6 => a.rotate(Vec3::new(1.0, rng.random(), 0.0), rng.random_range(0.0..360.0)),
                7 => a.named(&format!("part {}", step % 7)),
                8 => a.place(vec![
                    Affine::translate(Vec3::X),
                    Affine::scale(Vec3::splat(rng.random_range(0.5..2.0))),
                ]),
                _ => Solid::union([a]),
            });
        }
        check_solid(&parts[parts.len() - 1]);
    }
}

#[test]
fn saving_is_all_or_nothing() {
    let folder = std::env::temp_dir().join(format!("rayweave-scene-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("model.toml");
    let (document, scene) = parse(EVERYTHING).unwrap();
    document.save(&path).unwrap();
    document.save(&path).unwrap();
    assert_eq!(load(&path, &[]).unwrap(), (document.clone(), scene));
    let missing = document.save(folder.join("none/model.toml")).unwrap_err().to_string();
    assert!(missing.contains("does not exist. Create it first"), "{missing}");
    // a folder cannot be replaced by a file
    std::fs::create_dir_all(folder.join("full/inside")).unwrap();
    assert!(document.save(folder.join("full")).is_err());
    let left: Vec<_> = std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(left.len(), 2, "{left:?}");
    #[cfg(unix)]
    {
        let link = folder.join("link.toml");
        std::os::unix::fs::symlink("model.toml", &link).unwrap();
        std::fs::write(&path, "old").unwrap();
        document.save(&link).unwrap();
        assert!(link.is_symlink());
        assert_eq!(std::fs::read_to_string(&path).unwrap(), document.to_toml());
    }
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn tables_of_others_survive_however_they_are_written() {
    for text in [
        "a.b = 1\n",
        "a.b = 1\nsolid.s.sphere.radius = 1\na.c.d = [1, { e = 2 }]\n",
        "a.b = 1\n[a.c]\nd = 2\n",
        "a = [{ b = 1 }, { c = 2 }]\n",
        "[a.b]\nc = 1\n[optics]\nd = 2\n[a.e]\nf = '''\n[not.a.header]\n'''\n",
        "# words\n   # more words\n[a]\n\n\n[[b.c]]\n[[b.c]]\n# end",
        "'odd name' = {}\n['odd \"table\"']\nb = inf\n",
    ] {
        let (document, _) = parse(&format!("rayweave = 1\n{text}")).unwrap();
        assert!(!document.foreign.is_empty());
        let (again, _) = parse(&document.to_toml()).unwrap_or_else(|problems| panic!("{text}\n{problems}"));
        assert_eq!(again, document, "{text}\n{}", document.to_toml());
    }
}
