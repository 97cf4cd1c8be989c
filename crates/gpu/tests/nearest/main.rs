//! Nearest crossings on an adapter, against the CPU, bit for bit. Skipped with a message where there is no adapter.

mod tori;
mod touching;

use rayweave_conformance::{Model, Random, Style, rays};
use rayweave_gpu::{Gpu, GpuError, GpuProgram, GpuReport};
use rayweave_math::{Affine, Vec3};
use rayweave_model::{
    Collected, Evaluator, FirstHitColumns, Program, Query, RayBatch, Region, RegionId, Solid, Window,
};
use rayweave_shape::Ray;
use rayweave_shape::primitive::{Value, build};
use rayweave_trace::Packets;
use std::num::NonZeroUsize;
use std::sync::Arc;

/// The best adapter, or a message that says why the test is skipped.
fn adapter() -> Option<rayweave_gpu::Adapter> {
    match Gpu::new().adapter(0) {
        Ok(adapter) => Some(adapter.clone()),
        Err(problem) => {
            rayweave_conformance::skipped(problem);
            None
        }
    }
}

/// Columns whose numbers no query writes.
fn columns(rays: &RayBatch) -> FirstHitColumns {
    let mut columns = FirstHitColumns::new(rays.len());
    columns.face.fill(77);
    for numbers in [&mut columns.placement, &mut columns.before, &mut columns.after] {
        numbers.fill(77);
    }
    columns
}

/// The answer for a ray, as bits.
fn bits(own: &FirstHitColumns, i: usize) -> (u64, i32, [u32; 3], [u64; 3]) {
    let normal = own.normal(i).to_array().map(f64::to_bits);
    (own.t[i].to_bits(), own.face[i], [own.placement[i], own.before[i], own.after[i]], normal)
}

/// Compares all rays; returns what the query cost.
fn check(
    adapter: &rayweave_gpu::Adapter,
    program: &Arc<Program>,
    rays: &RayBatch,
    what: &str,
) -> Option<GpuReport> {
    let gpu = match GpuProgram::new(adapter, program.clone()) {
        Ok(gpu) => gpu,
        Err(GpuError::Unsupported(_)) => return None,
        Err(problem) => panic!("{what}: {problem}"),
    };
    let (mut ours, mut theirs) = (columns(rays), columns(rays));
    let report = gpu.nearest(rays.rays(), &mut ours.hits()).unwrap();
    let cpu = Packets::new(program.clone());
    let window = Window::new(0.0, f64::INFINITY).unwrap();
    cpu.nearest(rays.rays(), window, &mut cpu.scratch(), &mut theirs.hits());
    for i in 0..rays.len() {
        assert_eq!(bits(&ours, i), bits(&theirs, i), "{what}: ray {i}, {:?}", rays.rays().get(i));
    }
    assert_eq!(report.contradicted, 0, "{what}");
    Some(report)
}

fn shape(name: &str, arguments: &[(&str, Value)]) -> Solid {
    build(name, arguments).unwrap().into()
}

fn sphere(radius: f64, at: Vec3) -> Solid {
    shape("sphere", &[("radius", radius.into())]).apply(Affine::translate(at))
}

/// Rays between random points of a cube of half width `size`.
fn chords(rng: &mut Random, size: f64, count: usize) -> RayBatch {
    let mut ray = || {
        let (a, b) = (rng.point(2.0 * size), rng.point(size));
        Ray::new(a, b - a)
    };
    (0..count).map(|_| ray()).collect()
}

#[test]
fn random_models_give_the_bits_of_the_cpu() {
    random_models(6, 1000);
}

/// Queries of all kinds in turn, twice: the memory of one does not serve another.
#[test]
fn queries_of_all_kinds_in_turn() {
    let Some(adapter) = adapter() else { return };
    let program = Arc::new(Program::compile(&sphere(1.0, Vec3::ZERO)).unwrap());
    let gpu = GpuProgram::new(&adapter, program.clone()).unwrap();
    let rays = chords(&mut Random::new(5), 1.0, 1000);
    let cpu = Packets::new(program);
    for most in [1, 2, 1] {
        let mut found = columns(&rays);
        gpu.nearest(rays.rays(), &mut found.hits()).unwrap();
        let (first, _) = gpu.collect(rays.rays(), &Query::nearest(), NonZeroUsize::MIN).unwrap();
        assert_eq!(first, cpu.collect(rays.rays(), &Query::nearest()).unwrap());
        let (all, _) = gpu.crossings(rays.rays(), NonZeroUsize::new(most).unwrap()).unwrap();
        let window = Window::new(0.0, f64::INFINITY).unwrap();
        assert_eq!(all, cpu.collect(rays.rays(), &Query { window, ..Query::default() }).unwrap());
        let mut regions = vec![RegionId(7); rays.len()];
        gpu.regions_at(rays.rays().origins, &mut regions).unwrap();
        let inside = |i: usize| u32::from(rays.rays().get(i).origin.length() < 1.0);
        assert!(regions.iter().enumerate().all(|(i, region)| region.0 == inside(i)), "{most}");
        assert!(first.starts.iter().zip(&regions).all(|(start, region)| start == region), "{most}");
    }
}

/// A region that is everywhere, beside an overlap that it hides: a constant output does not depend on any atom.
#[test]
fn a_region_without_a_surface() {
    let Some(adapter) = adapter() else { return };
    let lens = sphere(1.0, Vec3::ZERO) & sphere(1.0, Vec3::new(0.5, 0.0, 0.0));
    let region = |name: &str, solid: Solid, medium| Region { name: name.to_owned(), solid, medium };
    let regions = [region("all", Solid::universe(), 1), region("lens", lens, 2)];
    let program = Arc::new(Program::compile_regions(&regions).unwrap());
    let report = check(&adapter, &program, &chords(&mut Random::new(9), 1.0, 5000), "universe").unwrap();
    assert!(report.cpu_share() < 0.1, "{report:?}");
}

/// Rays nearly parallel to a plane far outside of the others cross it at thousands of sizes of the model: the interval of the
/// time is as long as the way there, and the prediction still holds.
#[test]
fn far_crossings_of_planes_are_not_contradicted() {
    let Some(adapter) = adapter() else { return };
    let normal = Value::from(Vec3::new(-0.4768, 0.4010, -0.7822));
    let wall = shape("half_space", &[("normal", normal), ("offset", 0.56.into())]);
    let program = Arc::new(Program::compile(&(wall | sphere(1.0, Vec3::ZERO))).unwrap());
    let mut rng = Random::new(7);
    let along = Vec3::new(0.4010, 0.4768, 0.0);
    let mut ray = || {
        let origin = Vec3::new(0.0, 3.0, 0.0) + rng.point(1.0);
        Ray::new(origin, along + 10f64.powi(-(rng.below(7) as i32)) * rng.point(1.0))
    };
    let rays: RayBatch = (0..20_000).map(|_| ray()).collect();
    let report = check(&adapter, &program, &rays, "far planes").unwrap();
    assert!(report.uncertain < report.rays / 2, "{report:?}");
}

#[test]
#[ignore = "long"]
fn long_random_models_give_the_bits_of_the_cpu() {
    random_models(250, 40_000);
}

fn random_models(count: u64, rays: usize) {
    let Some(adapter) = adapter() else { return };
    let mut totals = [GpuReport::default(); 3];
    let mut refused = 0;
    for seed in 0..count {
        let mut rng = Random::new(seed);
        let style = [Style::Generic, Style::Grid, Style::Generic, Style::Planes][seed as usize % 4];
        let model = Model::random(&mut rng, style);
        let program = model.compile().unwrap();
        let rays = rays::batch(&rays::rays(&mut rng, style, &model.frame, rays));
        match check(&adapter, &program, &rays, &format!("seed {seed}")) {
            Some(report) => {
                println!("seed {seed}, {style:?}: {report:?}");
                totals[style as usize].add(report);
            }
            None => refused += 1,
        }
    }
    for (style, total) in [Style::Generic, Style::Grid, Style::Planes].into_iter().zip(totals) {
        println!("{style:?}: {total:?}, share of the CPU {:.4}", total.cpu_share());
        assert!(total.uncertain < total.rays, "{total:?}");
    }
    println!("{refused} models refused");
}

#[test]
fn spheres_in_a_hierarchy() {
    let Some(adapter) = adapter() else { return };
    let mut rng = Random::new(3);
    let balls: Vec<Solid> = (0..2000).map(|_| sphere(rng.between(0.005, 0.04), rng.point(1.0))).collect();
    let program = Arc::new(Program::compile(&Solid::union(balls)).unwrap());
    let rays = chords(&mut rng, 1.0, 50_000);
    let report = check(&adapter, &program, &rays, "spheres").unwrap();
    println!("{report:?}");
    assert!(report.cpu_share() < 0.01, "{report:?}");
}

/// All crossings of random models, and those of a hierarchy.
#[test]
fn all_crossings_give_the_bits_of_the_cpu() {
    let Some(adapter) = adapter() else { return };
    let query = Query { window: Window::new(0.0, f64::INFINITY).unwrap(), ..Query::default() };
    let mut total = GpuReport::default();
    for seed in [2, 5, 90] {
        let mut rng = Random::new(seed);
        let (program, rays) = if seed == 90 {
            let balls: Vec<Solid> =
                (0..500).map(|_| sphere(rng.between(0.02, 0.1), rng.point(1.0))).collect();
            (Arc::new(Program::compile(&Solid::union(balls)).unwrap()), chords(&mut rng, 1.0, 20_000))
        } else {
            let model = Model::random(&mut rng, Style::Generic);
            let rays = rays::rays(&mut rng, Style::Generic, &model.frame, 3000);
            (model.compile().unwrap(), rays::batch(&rays))
        };
        let gpu = GpuProgram::new(&adapter, program.clone()).unwrap();
        let (ours, report) = gpu.crossings(rays.rays(), NonZeroUsize::new(12).unwrap()).unwrap();
        let theirs = Packets::new(program).collect(rays.rays(), &query).unwrap();
        let bits = |list: &Collected| -> Vec<u64> { list.crossings.iter().map(|c| c.t.to_bits()).collect() };
        assert_eq!(ours, theirs, "seed {seed}");
        assert_eq!(bits(&ours), bits(&theirs), "seed {seed}");
        assert_eq!(report.contradicted, 0);
        assert!(report.rays == rays.len() as u64 && report.uncertain < report.rays, "{report:?}");
        total.add(report);
    }
    println!("{total:?}");
}

/// Overlapping regions in a hierarchy, and placed solids with all kinds of surfaces; a third of the rays start inside.
#[test]
fn regions_and_placed_solids_in_a_hierarchy() {
    let Some(adapter) = adapter() else { return };
    let mut rng = Random::new(11);
    let mut region = |k: u32| {
        let balls: Vec<Solid> = (0..100).map(|_| sphere(rng.between(0.05, 0.2), rng.point(1.0))).collect();
        Region { name: format!("r{k}"), solid: Solid::union(balls), medium: 1 + k % 2 }
    };
    let regions = [region(0), region(1), region(2)];
    let program = Arc::new(Program::compile_regions(&regions).unwrap());
    let report = check(&adapter, &program, &chords(&mut rng, 1.0, 20_000), "regions").unwrap();
    assert!(report.cpu_share() < 0.01, "{report:?}");

    let cone = shape("cone", &[("radius1", 0.12.into()), ("radius2", 0.04.into()), ("height", 0.2.into())]);
    let rod = shape("cylinder", &[("radius", 0.03.into()), ("height", 1.0.into())]);
    let egg = sphere(0.1, Vec3::ZERO).apply(Affine::scale(Vec3::new(1.0, 0.5, 1.2)));
    let part = (cone | egg.apply(Affine::translate(0.08 * Vec3::X))) - rod;
    let maps: Vec<Affine> = (0..150)
        .map(|_| {
            let turn = Affine::rotation(rng.direction(), rng.between(-180.0, 180.0));
            turn.then(&Affine::translate(rng.point(1.0)))
        })
        .collect();
    let program = Arc::new(Program::compile(&part.place(maps)).unwrap());
    let report = check(&adapter, &program, &chords(&mut rng, 1.0, 20_000), "placed").unwrap();
    println!("{report:?}");
    assert!(report.cpu_share() < 0.01, "{report:?}");
}

/// Placed solids in two regions: both contain the same surface of each copy, and the first whose change matters has the face.
#[test]
fn placed_solids_in_two_regions() {
    let Some(adapter) = adapter() else { return };
    let mut rng = Random::new(17);
    let egg = |radius| sphere(radius, Vec3::ZERO).apply(Affine::scale(Vec3::new(1.0, 1.0, 0.7)));
    // within a copy, two leaves share the inner surface
    let half = shape("half_space", &[("normal", Vec3::X.into()), ("offset", 0.0.into())]);
    let shell = (egg(0.5) - egg(0.2)) | (egg(0.2) & half);
    let maps: Vec<Affine> = (0..5)
        .map(|_| {
            let turn = Affine::rotation(rng.direction(), 40.0);
            turn.then(&Affine::translate(rng.direction()))
        })
        .collect();
    let blank = sphere(1.0, Vec3::ZERO);
    let (dents, ink) = (shell.clone().place(maps.clone()), egg(0.55).place(maps));
    let body = blank - dents.clone();
    // the last region is without the dents, or the dents
    for (k, last) in [body.clone() & ink, dents].into_iter().enumerate() {
        let region = |name: &str, solid: &Solid, medium| Region {
            name: name.to_owned(),
            solid: solid.clone(),
            medium,
        };
        let regions = [region("body", &body, 1), region("last", &last, 2)];
        let program = Arc::new(Program::compile_regions(&regions).unwrap());
        let report = check(&adapter, &program, &chords(&mut rng, 1.0, 20_000), &format!("last {k}")).unwrap();
        println!("{k}: {report:?}");
        assert!(report.cpu_share() < 0.01, "{k}: {report:?}");
    }
}
