//! Windows, all crossings, first crossings and regions of points on an adapter, through the evaluator, against the CPU, bit for bit.
//! Skipped with a message where there is no adapter.

use rayweave_conformance::{Model, Random, Style, rays};
use rayweave_gpu::{Gpu, GpuDevice, GpuProgram, GpuReport};
use rayweave_math::{Affine, Vec3};
use rayweave_model::{
    Evaluator, FirstHitColumns, Limit, Program, Query, RayBatch, Region, RegionId, Solid, Window,
};
use rayweave_shape::Ray;
use rayweave_shape::primitive::{Value, build};
use rayweave_trace::{Accelerated, AnyEvaluator, Packets};
use std::sync::Arc;

/// The device of a program, or a message that says why the test is skipped.
fn device(program: &Arc<Program>) -> Option<Arc<GpuDevice>> {
    match Gpu::new().adapter(0) {
        Ok(adapter) => Some(Arc::new(GpuDevice::new(GpuProgram::new(adapter, program.clone()).unwrap()))),
        Err(problem) => {
            rayweave_conformance::skipped(problem);
            None
        }
    }
}

fn window(t_min: f64, t_max: f64) -> Window {
    Window::new(t_min, t_max).unwrap()
}

fn shape(name: &str, arguments: &[(&str, Value)]) -> Solid {
    build(name, arguments).unwrap().into()
}

fn sphere(radius: f64, at: Vec3) -> Solid {
    shape("sphere", &[("radius", radius.into())]).apply(Affine::translate(at))
}

/// A model of a few leaves with planes, a sphere, a cylinder and a cone; unbounded, if asked for.
fn part(is_bounded: bool) -> Arc<Program> {
    let size = Value::from(Vec3::new(2.0, 2.0, 2.0));
    let block = shape("box", &[("size", size)]);
    let rod = shape("cylinder", &[("radius", 0.3.into()), ("height", 4.0.into())]);
    let cone = shape("cone", &[("radius1", 0.7.into()), ("radius2", 0.2.into()), ("height", 1.0.into())]);
    let solid = (block - rod) - sphere(0.6, Vec3::new(1.0, 1.0, 0.8));
    let inner = if is_bounded { cone } else { !sphere(3.0, Vec3::ZERO) };
    let regions = [
        Region { name: "block".to_owned(), solid, medium: 1 },
        Region { name: "inner".to_owned(), solid: inner, medium: 2 },
    ];
    Arc::new(Program::compile_regions(&regions).unwrap())
}

/// A union with a hierarchy, of placed solids and spheres.
fn heap(rng: &mut Random) -> Arc<Program> {
    let balls: Vec<Solid> = (0..150).map(|_| sphere(rng.between(0.03, 0.15), rng.point(1.0))).collect();
    let egg = sphere(0.2, Vec3::ZERO).apply(Affine::scale(Vec3::new(1.0, 0.5, 1.2)));
    let maps: Vec<Affine> = (0..40)
        .map(|_| {
            let turn = Affine::rotation(rng.direction(), rng.between(-180.0, 180.0));
            turn.then(&Affine::translate(rng.point(1.0)))
        })
        .collect();
    Arc::new(Program::compile(&(Solid::union(balls) | egg.place(maps))).unwrap())
}

/// Rays between random points, from near and from far away, and along the axes.
fn some_rays(rng: &mut Random, count: usize) -> RayBatch {
    let mut ray = |k: usize| {
        let (a, b) = (rng.point(3.0), rng.point(1.5));
        match k % 4 {
            0 => Ray::new(a, b - a),
            1 => Ray::new(1e3 * a, 7.0 * (b - 1e3 * a)),
            2 => Ray::new(b, [Vec3::X, -Vec3::Y, 0.3 * Vec3::Z][k / 4 % 3]),
            _ => Ray::new(b, rng.direction()),
        }
    };
    (0..count).map(&mut ray).collect()
}

/// The same crossings, with the same bits, for all rays in several windows.
#[test]
fn windows_give_the_bits_of_the_cpu() {
    let mut rng = Random::new(8);
    for (name, program) in [("bounded", part(true)), ("unbounded", part(false)), ("heap", heap(&mut rng))] {
        let Some(device) = device(&program) else { return };
        let evaluator = AnyEvaluator::with_device(program.clone(), device.clone());
        let cpu = Packets::new(program.clone());
        let rays = some_rays(&mut rng, 2000);
        for window in [Window::ALL, window(0.0, 1.0), window(-0.3, 0.4), window(0.7, f64::INFINITY)] {
            for limit in [Limit::First, Limit::All] {
                let query = Query { window, limit, starts: None };
                let (ours, theirs) = (
                    evaluator.collect(rays.rays(), &query).unwrap(),
                    cpu.collect(rays.rays(), &query).unwrap(),
                );
                for i in 0..rays.len() {
                    let ray = rays.rays().get(i);
                    assert_eq!(ours.starts[i], theirs.starts[i], "{name}, {query:?}: ray {i}, {ray:?}");
                    assert_eq!(ours.of(i), theirs.of(i), "{name}, {query:?}: ray {i}, {ray:?}");
                }
                let bits = |all: &rayweave_model::Collected| -> Vec<u64> {
                    all.crossings.iter().map(|c| c.t.to_bits()).collect()
                };
                assert_eq!(bits(&ours), bits(&theirs), "{name}, {query:?}");
            }
            let columns = |evaluator: &AnyEvaluator| nearest(evaluator, &rays, window);
            let cpu = AnyEvaluator::new(None, program.clone()).unwrap();
            assert_eq!(columns(&evaluator), columns(&cpu), "{name}, {window:?}");
        }
        let report = device.report();
        println!("{name}: {report:?}, share of the CPU {:.4}", report.cpu_share());
        assert!(report.rays == 4 * 3 * 2000 && report.contradicted == 0, "{report:?}");
        assert!(report.cpu_share() < 0.3 && device.problem().is_none(), "{report:?}");
    }
}

/// Times, faces, placements, regions and normals as bits.
fn nearest(evaluator: &AnyEvaluator, rays: &RayBatch, window: Window) -> Vec<[u64; 8]> {
    let mut found = FirstHitColumns::new(rays.len());
    evaluator.nearest(rays.rays(), window, &mut evaluator.scratch(), &mut found.hits());
    (0..rays.len())
        .map(|i| {
            let [x, y, z] = [0, 1, 2].map(|k| found.normal[k][i].to_bits());
            let numbers = [found.placement[i], found.before[i], found.after[i]].map(u64::from);
            [found.t[i].to_bits(), found.face[i] as u64, numbers[0], numbers[1], numbers[2], x, y, z]
        })
        .collect()
}

/// Random points, points on faces, at corners and on axes, and distant points.
#[test]
fn points_are_in_the_regions_of_the_cpu() {
    let mut rng = Random::new(21);
    let mut totals = [GpuReport::default(); 2];
    let heap = heap(&mut rng);
    for (name, program) in [("bounded", part(true)), ("unbounded", part(false)), ("heap", heap)] {
        let Some(device) = device(&program) else { return };
        let evaluator = Accelerated::new(program.clone(), device.clone());
        let cpu = Packets::new(program.clone());
        let rays = some_rays(&mut rng, 500);
        let random: Vec<Vec3> = (0..4000).map(|_| rng.point(2.0)).collect();
        // on faces: the points of crossings
        let crossings = cpu.collect(rays.rays(), &Query::default()).unwrap();
        let on_faces = (0..rays.len()).flat_map(|i| {
            let ray = rays.rays().get(i);
            crossings.of(i).iter().map(move |crossing| ray.at(crossing.t))
        });
        let grid = (0..125)
            .map(|k| Vec3::new((k % 5) as f64, (k / 5 % 5) as f64, (k / 25) as f64) - Vec3::splat(2.0));
        let distant = (0..200).map(|k| libm::pow(10.0, 1.0 + (k % 12) as f64) * rng.direction());
        let planted: Vec<Vec3> = on_faces.chain(grid).chain(distant).collect();
        for (kind, points) in [random, planted].iter().enumerate() {
            let column = |k: usize| points.iter().map(|p| p[k]).collect::<Vec<f64>>();
            let [x, y, z] = [0, 1, 2].map(column);
            let (mut ours, mut theirs) = (vec![RegionId(77); points.len()], vec![RegionId(0); points.len()]);
            let before = device.report();
            evaluator.regions_at([&x, &y, &z], &mut evaluator.scratch(), &mut ours);
            cpu.regions_at([&x, &y, &z], &mut cpu.scratch(), &mut theirs);
            let wrong = (0..points.len()).find(|&i| ours[i] != theirs[i]);
            assert_eq!(wrong.map(|i| (points[i], ours[i], theirs[i])), None, "{name}");
            let report = device.report();
            println!("{name}, {kind}: {} of {} uncertain", report.uncertain - before.uncertain, points.len());
            assert_eq!(report.rays - before.rays, points.len() as u64);
            totals[kind].rays += points.len() as u64;
            totals[kind].uncertain += report.uncertain - before.uncertain;
        }
        assert!(device.problem().is_none());
    }
    println!("{totals:?}");
    let [random, planted] = totals.map(|total| total.cpu_share());
    assert!(random < 1e-3, "{totals:?}");
    // a point on a face is settled by no bound
    assert!(planted > 0.3, "{totals:?}");
}

/// The models of the conformance suite and its rays, as lines.
#[test]
fn lines_through_random_models() {
    let mut total = GpuReport::default();
    for seed in [1, 4] {
        let mut rng = Random::new(seed);
        let style = [Style::Grid, Style::Generic][seed as usize % 2];
        let model = Model::random(&mut rng, style);
        let rays = rays::batch(&rays::rays(&mut rng, style, &model.frame, 1000));
        let program = model.compile().unwrap();
        let Some(device) = device(&program) else { return };
        let evaluator = Accelerated::new(program.clone(), device.clone());
        let ours = evaluator.collect(rays.rays(), &Query::default()).unwrap();
        assert_eq!(
            ours,
            Packets::new(program).collect(rays.rays(), &Query::default()).unwrap(),
            "seed {seed}"
        );
        total.add(device.report());
    }
    println!("{total:?}");
    assert!(total.rays == 2000 && total.contradicted == 0 && total.uncertain < total.rays, "{total:?}");
}
