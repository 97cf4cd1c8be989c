//! Features of the facade crate beyond its re-exports.

use rayweave::model::RayBatch;
use rayweave::scene::{Scene, parse};
use rayweave::table::{RayChunk, RayReader};
use rayweave::{AnyEvaluator, Classified, Compiled, Evaluator, Query, Ray, Vec3};

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
    let error = rayweave::Error::from(Compiled::named(&scene, Some("cor")).unwrap_err());
    assert!(error.is_name() && error.to_string().ends_with("Did you mean `core`?"), "{error}");
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
    let error = AnyEvaluator::new(Some("wave"), compiled.program.clone()).unwrap_err();
    assert_eq!(error.kind(), rayweave::ErrorKind::Name);
}

/// Rays from files and from arrays are subject to the same range checks.
#[test]
fn rays_out_of_range_are_refused_everywhere() {
    let (most, least) = (Ray::MAX_COMPONENT, Ray::MIN_DIRECTION);
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

/// A model of which a part is missing is an error here, with the reason; `formats::load` reads it.
#[test]
fn models_with_missing_parts_are_errors() {
    let folder = std::env::temp_dir().join(format!("rayweave-missing-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("torso.csg");
    std::fs::write(&path, "cube(size = [10, 10, 10]); import(file = \"gone.stl\");").unwrap();
    let error = rayweave::load(&path).unwrap_err();
    let read = rayweave::formats::load(&path, None, &[], &rayweave::formats::Options::default());
    std::fs::remove_dir_all(&folder).unwrap();
    assert!(error.is_model_file());
    let text = error.to_string();
    assert!(text.contains("a part of the geometry is missing") && text.contains("gone.stl"), "{text}");
    assert_eq!(read.unwrap().scene.regions.len(), 1);
}
