//! What the facade adds to the crates that it joins.

use rayweave::model::RayBatch;
use rayweave::picture::{Picture, PictureKind, Wishes, arrange};
use rayweave::render::{Background, LightKind, Projection, Rgba, Run, Size, Style, View};
use rayweave::scene::{Scene, parse};
use rayweave::table::{RayChunk, RayReader};
use rayweave::{AnyEvaluator, Compiled, Evaluator, Query, Ray, Vec3, timeline};

const TWO: &str = r##"
rayweave = 1
[solid.core]
sphere = { radius = 1 }
[solid.shell]
sphere = { radius = 2 }
[solid.other]
box = { size = 1 }
[[region]]
solid = "shell"
medium = "water"
colour = "#010203"
[[region]]
solid = "core"
colour = "#040506"
[medium.water]
index = 1.33
"##;

fn scene(more: &str) -> Scene {
    parse(&format!("{TWO}{more}")).unwrap().1
}

fn arranged(scene: &Scene, wishes: &Wishes) -> (rayweave::render::Camera, rayweave::render::Settings) {
    arrange(scene, &Compiled::new(scene).unwrap(), wishes).unwrap()
}

#[test]
fn a_solid_alone_keeps_the_medium_of_its_region() {
    let scene = scene("");
    let shell = Compiled::solid(&scene, "shell").unwrap();
    assert_eq!(shell.program.regions().len(), 1);
    assert_eq!(shell.medium_name(rayweave::model::RegionId(1)), "water");
    assert_eq!(shell.region_name(rayweave::model::RegionId(1)), Some("shell"));
    assert_eq!(shell.region_name(rayweave::model::RegionId(0)), None);
    let other = Compiled::named(&scene, Some("other")).unwrap();
    assert_eq!(other.medium_name(rayweave::model::RegionId(1)), "other");
    assert_eq!(other.medium_name(rayweave::model::RegionId(0)), "world");
    let error = Compiled::named(&scene, Some("cor")).unwrap_err();
    assert!(error.is_name() && error.to_string().ends_with("did you mean `core`?"), "{error}");
}

#[test]
fn evaluators_by_name_agree() {
    let compiled = Compiled::new(&scene("")).unwrap();
    let ray = Ray::new(Vec3::new(-5.0, 0.0, 0.0), Vec3::X);
    let answers = AnyEvaluator::NAMES.map(|name| {
        let evaluator = AnyEvaluator::new(Some(name), compiled.program.clone()).unwrap();
        assert_eq!(evaluator.name(), name);
        evaluator.one(ray, &Query::default()).unwrap()
    });
    let times: Vec<f64> = answers[0].of(0).iter().map(|c| c.t).collect();
    assert_eq!(times, [3.0, 4.0, 6.0, 7.0]);
    assert!(answers.iter().all(|answer| *answer == answers[0]));
    assert!(AnyEvaluator::new(Some("wave"), compiled.program.clone()).unwrap_err().is_name());
}

/// Rays come in by files and by arrays: both doors are equally wide.
#[test]
fn rays_out_of_range_are_refused_everywhere() {
    let (most, least) = (Ray::MOST, Ray::LEAST);
    let x = [1.0, 0.0, 0.0];
    let cases = [
        ([most, -most, 0.0], x, true),
        ([most * 1.01, 0.0, 0.0], x, false),
        ([0.0, f64::NEG_INFINITY, 0.0], x, false),
        (x, [f64::NAN, 0.0, 0.0], false),
        (x, [-least, 0.0, 0.0], true),
        (x, [0.0, least * 0.99, 0.0], false),
        (x, [0.0, -0.0, 0.0], false),
        (x, [0.0, most * 1.01, 0.0], false),
    ];
    let compiled = Compiled::new(&scene("")).unwrap();
    let evaluator = AnyEvaluator::new(None, compiled.program.clone()).unwrap();
    for (origin, direction, is_good) in cases {
        let row = [origin, direction].concat().iter().map(|x| format!("{x:e}")).collect::<Vec<_>>().join(",");
        let file = format!("ox,oy,oz,dx,dy,dz\n{row}\n").to_lowercase();
        let mut reader = RayReader::from_csv(std::io::Cursor::new(file), "rays.csv").unwrap();
        assert_eq!(reader.read(&mut RayChunk::default(), 9).is_ok(), is_good, "{row}");
        let ray = Ray::new(origin.into(), direction.into());
        assert_eq!(evaluator.one(ray, &Query::default()).is_ok(), is_good, "{row}");
        let batch = RayBatch::from_iter([Ray::new(Vec3::ZERO, Vec3::X), ray]);
        let found = evaluator.collect(batch.rays(), &Query::default());
        assert_eq!(found.is_ok(), is_good, "{row}");
        if let Err(error) = found.map_err(rayweave::Error::from) {
            assert!(error.is_value() && error.to_string().starts_with("ray 1: the "), "{error}");
        }
    }
}

#[test]
fn the_scratch_of_another_evaluator_is_replaced() {
    let compiled = Compiled::new(&scene("")).unwrap();
    let all =
        AnyEvaluator::NAMES.map(|name| AnyEvaluator::new(Some(name), compiled.program.clone()).unwrap());
    for (k, evaluator) in all.iter().enumerate() {
        let mut scratch = all[(k + 1) % all.len()].scratch();
        let mut regions = [rayweave::model::RegionId(9); 2];
        evaluator.regions_at([&[0.0, 1.5], &[0.0; 2], &[0.0; 2]], &mut scratch, &mut regions);
        assert_eq!(regions.map(|region| region.0), [2, 1], "{}", evaluator.name());
    }
}

#[test]
fn wishes_come_before_what_the_file_says() {
    let said = scene(
        "[camera]\nposition = [9, 0, 0]\nfov = 20\nsize = [40, 30]\n[render]\nshading = \"headlight\"\nedges = false\n\
         samples = 2\nbackground = \"#070809\"\n[[light]]\nposition = [5, 5, 5]\nintensity = 0.5\n",
    );
    let (camera, settings) = arranged(&said, &Wishes::default());
    assert_eq!(camera.position(), Vec3::new(9.0, 0.0, 0.0));
    assert_eq!(camera.projection(), Projection::Perspective { field_of_view: 20.0 });
    assert_eq!(settings.size, Size::new(40, 30).unwrap());
    assert_eq!((settings.style, settings.samples), (Style::Headlight, 2));
    assert!(settings.lines.is_none());
    assert_eq!(settings.background, Background::Colour(Rgba::opaque(7, 8, 9)));
    assert_eq!(settings.colours, [Rgba::opaque(1, 2, 3), Rgba::opaque(4, 5, 6)]);
    assert_eq!(settings.lights[0].kind, LightKind::Position(Vec3::splat(5.0)));
    assert_eq!((settings.lights[0].intensity, settings.shadows), (0.5, false));
    let wishes = Wishes {
        size: Some(Size::new(50, 50).unwrap()),
        view: Some(View::Top),
        style: Some(Style::Flat),
        edges: Some(true),
        samples: Some(1),
        ..Wishes::default()
    };
    let (camera, settings) = arranged(&said, &wishes);
    assert_eq!(camera.forward(), Vec3::NEG_Z);
    // the ball of radius 2 with a margin of 4 % on both sides
    assert_eq!(camera.projection(), Projection::Orthographic { height: 4.0 / 0.92 });
    assert_eq!((settings.size, settings.style, settings.samples), (wishes.size.unwrap(), Style::Flat, 1));
    assert!(settings.lines.is_some());
    let wide = Wishes { field_of_view: Some(60.0), ..wishes };
    let (camera, _) = arranged(&said, &wide);
    assert_eq!(camera.projection(), Projection::Perspective { field_of_view: 60.0 });
}

#[test]
fn shadows_need_a_light() {
    let with = Wishes { shadows: Some(true), ..Wishes::default() };
    let (camera, settings) = arranged(&scene(""), &with);
    let [light] = &settings.lights[..] else { panic!("{:?}", settings.lights) };
    let LightKind::Direction(along) = light.kind else { panic!("{light:?}") };
    // from behind, from the left, from above
    assert!(along.dot(camera.forward()) > 0.0 && along.dot(camera.right()) > 0.0);
    assert!(along.dot(camera.up()) < 0.0);
    assert!(arranged(&scene(""), &Wishes::default()).1.lights.is_empty());
}

#[test]
fn a_solid_alone_keeps_its_colour() {
    let scene = scene("");
    let colours = |name| {
        let compiled = Compiled::solid(&scene, name).unwrap();
        arrange(&scene, &compiled, &Wishes::default()).unwrap().1.colours
    };
    assert_eq!(colours("core"), [Rgba::opaque(4, 5, 6)]);
    assert_eq!(colours("shell"), [Rgba::opaque(1, 2, 3)]);
    assert_eq!(colours("other"), [rayweave::render::PALETTE[0]]);
}

#[test]
fn kinds_of_pictures_have_names() {
    for (kind, name) in PictureKind::ALL {
        assert_eq!(name.parse::<PictureKind>().unwrap(), kind);
    }
    assert!("color".parse::<PictureKind>().unwrap_err().to_string().contains("did you mean `colour`?"));
    let scene = scene("");
    let compiled = Compiled::new(&scene).unwrap();
    let wishes =
        Wishes { size: Some(Size::new(9, 9).unwrap()), view: Some(View::Front), ..Wishes::default() };
    let (camera, settings) = arrange(&scene, &compiled, &wishes).unwrap();
    let evaluator = AnyEvaluator::new(None, compiled.program.clone()).unwrap();
    let mut run = Run::default();
    let Picture::Depth(depth) =
        Picture::draw(PictureKind::Depth, &evaluator, &camera, &settings, &mut run).unwrap()
    else {
        panic!("no depth");
    };
    // the middle of the picture looks at the middle of the ball, of radius 2
    let expected = camera.position().length() - 2.0;
    assert!((depth.get(4, 4).unwrap() - expected).abs() < 1e-12);
    run.cancel.cancel();
    let cancelled = Picture::draw(PictureKind::Colour, &evaluator, &camera, &settings, &mut run);
    assert!(cancelled.unwrap_err().is_cancelled());
}

#[test]
fn time_lines_show_leaves_once() {
    let (_, scene) = parse(
        "rayweave = 1\n[solid.ball]\nsphere = { radius = 1 }\n[solid.pair]\nexpr = \"ball | ball\"\n\
         [solid.far]\nexpr = \"pair - ~pair\"\ntransform = [{ translate = [3, 0, 0] }]\n[solid.all]\nexpr = \"pair | far\"\n",
    )
    .unwrap();
    let compiled = Compiled::new(&scene).unwrap();
    let ray = Ray::new(Vec3::new(-5.0, 0.0, 0.0), Vec3::X);
    let svg = timeline(&scene, None, &compiled, ray).unwrap().to_svg();
    // the ball at the origin and the one beside it: their names on the left, numbers where they change
    assert_eq!(svg.matches(">ball<").count(), 2);
    for time in [4, 6, 7, 9] {
        assert!(svg.contains(&format!(">{time}<")), "{time}: {svg}");
    }
    let alone = timeline(&scene, Some("pair"), &Compiled::solid(&scene, "pair").unwrap(), ray).unwrap();
    assert_eq!(alone.to_svg().matches(">ball<").count(), 1);
}

#[test]
fn time_lines_of_large_models_show_regions() {
    let mut text = "rayweave = 1\n[solid.ball]\nsphere = { radius = 0.3 }\n".to_owned();
    for k in 0..50 {
        text += &format!("[solid.s{k}]\nexpr = \"ball\"\ntransform = [{{ translate = [{k}, 0, 0] }}]\n");
    }
    let names: Vec<String> = (0..50).map(|k| format!("s{k}")).collect();
    text += &format!("[solid.row]\nexpr = \"{}\"\n", names.join(" | "));
    let (_, scene) = parse(&text).unwrap();
    let compiled = Compiled::new(&scene).unwrap();
    let ray = Ray::new(Vec3::new(-5.0, 0.0, 0.0), Vec3::X);
    let svg = timeline(&scene, None, &compiled, ray).unwrap().to_svg();
    assert_eq!(svg.matches(">ball<").count(), 0);
    // as an operand and as the result
    assert!(svg.matches(">row<").count() >= 2, "{svg}");
    // a solid with 2^60 occurrences of one leaf
    let mut text = "rayweave = 1\n[solid.d0]\nsphere = { radius = 1 }\n".to_owned();
    for k in 1..60 {
        text += &format!("[solid.d{k}]\nexpr = \"d{0} | d{0}\"\n", k - 1);
    }
    let (_, scene) = parse(&text).unwrap();
    let compiled = Compiled::new(&scene).unwrap();
    assert!(timeline(&scene, None, &compiled, ray).unwrap().to_svg().contains(">d59<"));
}
