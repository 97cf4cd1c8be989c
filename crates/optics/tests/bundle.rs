//! Light in ray bundles with hit prediction has bit for bit the same results as each ray traced
//! alone: on ordinary systems, and in cases in which SIMD lanes are prone to errors.

mod common;

use common::{D_NM, along_z, ball, block, disk, flat, glass, rod, solid};
use rayweave_math::{Affine, Vec3};
use rayweave_model::{Evaluator, Solid};
use rayweave_optics::component::Sheet;
use rayweave_optics::{
    Action, Assembly, Beam, Element, Keep, Light, Medium, Segment, System, TraceSettings, Tracer,
};
use rayweave_shape::primitive::HalfSpace;
use rayweave_trace::{Packets, Reference};

fn transparent(name: &str, solid: &Solid, n: f64) -> Element {
    Element::transparent(name, solid.clone(), &glass(n))
}

/// An absorbing sheet.
fn screen(name: &str, surface: Solid, trim: Solid) -> Element {
    Element::sheet(name, Sheet { surface, trim, frame: Affine::IDENTITY }, Action::Absorb)
}

fn flat_screen(name: &str, z: f64, size: f64) -> Element {
    let (surface, trim) = flat(z, size);
    screen(name, surface, trim)
}

/// The rows of each ray of a beam, as text that shows every bit, and the power sums: absorbed by
/// elements, absorbed in media, dropped.
fn rows_by_ray<E: Evaluator>(
    tracer: &Tracer<'_, E>,
    lights: &[Light],
    (keep, threshold): (Keep, f64),
) -> (Vec<Vec<String>>, [f64; 3]) {
    let settings = TraceSettings { keep, threshold, generation_limit: 40, ..TraceSettings::default() };
    let trace = tracer.trace(&lights.iter().copied().collect::<Beam>(), &settings).unwrap();
    assert!(trace.balance.error().abs() < 1e-9 * lights.len() as f64);
    let mut rows = vec![Vec::new(); lights.len()];
    for row in trace.segments.iter() {
        let is_first = row.generation == 0 || keep == Keep::Ends;
        assert_eq!(is_first, row.parent == -1);
        if !is_first {
            let parent = trace.segments.get(row.parent as usize);
            assert_eq!((parent.id, parent.generation + 1), (row.id, row.generation));
        }
        rows[row.id as usize].push(format!("{:?}", Segment { id: 0, parent: 0, ..row }));
    }
    let balance = &trace.balance;
    (rows, [balance.absorbed.iter().sum(), balance.absorbed_in_media, balance.dropped])
}

/// Traces light together, and ray by ray with an evaluator without SIMD lanes, and compares the
/// results.
fn assert_same_alone(what: &str, system: &System, lights: &[Light]) {
    let (packets, reference) = (Tracer::new(system, Packets::new), Tracer::new(system, Reference::new));
    for options in [(Keep::All, 0.0), (Keep::Ends, 0.0), (Keep::All, 0.8)] {
        let (together, ends) = rows_by_ray(&packets, lights, options);
        let mut sums = [0.0; 3];
        for (light, rows) in lights.iter().zip(together) {
            let (alone, ends) = rows_by_ray(&reference, std::slice::from_ref(light), options);
            assert_eq!(rows, alone[0], "{what}: {light:?}");
            sums.iter_mut().zip(ends).for_each(|(sum, end)| *sum += end);
        }
        for (end, sum) in ends.into_iter().zip(sums) {
            assert!((end - sum).abs() <= 1e-12 * sum, "{what}: {ends:?} {sums:?}");
        }
    }
}

/// Ordinary light, from which hits are predicted, before and after each hostile bundle.
fn between_ordinary(hostile: impl Iterator<Item = [Light; 8]>) -> Vec<Light> {
    let ordinary = || disk(16, 4.0).map(|[x, y]| along_z(x, y));
    ordinary().chain(hostile.flat_map(|eight| eight.into_iter().chain(ordinary()))).collect()
}

/// Eight rays along z near a point, at a distance from each other.
fn bundle(x: f64, y: f64, apart: f64) -> [Light; 8] {
    std::array::from_fn(|k| along_z(x + apart * k as f64, y - apart * (k % 3) as f64))
}

fn cemented() -> Assembly {
    let crown =
        ball(61.47).translate(Vec3::Z * 61.47) & ball(44.64).translate(Vec3::Z * -38.64) & rod(12.0, 30.0);
    let flint = (rod(12.0, 30.0) & ball(129.94).translate(Vec3::Z * -121.44))
        - ball(44.64).translate(Vec3::Z * -38.64)
        - solid(HalfSpace::new(Vec3::Z, 0.0).unwrap());
    Assembly::new().add(transparent("crown", &crown, 1.5168)).add(transparent("flint", &flint, 1.62))
}

/// Systems in which most hits can be predicted.
fn predictable() -> Vec<Assembly> {
    let concave =
        rod(11.0, 12.0) - ball(40.0).translate(Vec3::Z * -41.0) - ball(40.0).translate(Vec3::Z * 41.0);
    let convex =
        ball(40.0).translate(Vec3::Z * 37.0) & ball(40.0).translate(Vec3::Z * -37.0) & rod(11.0, 20.0);
    let pair = |medium: &Medium| {
        Assembly::new()
            .add(transparent("tank", &block(60.0, 60.0, 70.0), 1.33))
            .add(Element::transparent("concave", concave.clone().translate(Vec3::Z * -9.0), medium))
            .add(transparent("convex", &convex.clone().translate(Vec3::Z * 9.0), 1.7))
    };
    let passed = {
        let (surface, trim) = flat(50.0, 80.0);
        Element::sheet("passed", Sheet { surface, trim, frame: Affine::IDENTITY }, Action::Record)
    };
    let tilted = block(20.0, 20.0, 8.0).rotate_x(20.0).translate(Vec3::Z * 25.0);
    let bulk = Medium::constant("smoke", 1.4, 1e-6).unwrap();
    vec![
        cemented().add(flat_screen("screen", 60.0, 60.0)),
        cemented().add(flat_screen("small", 60.0, 4.0)).add(flat_screen("behind", 70.0, 60.0)),
        pair(&glass(1.6)).add(flat_screen("screen", 60.0, 80.0)),
        pair(&bulk).add(passed).add(flat_screen("screen", 60.0, 80.0)),
        Assembly::new()
            .add(transparent("ball", &ball(10.0), 1.9))
            .add(transparent("core", &ball(5.0).translate(Vec3::X), 1.2))
            .add(transparent("plate", &tilted, 1.6))
            .add(Element::absorber("stop", rod(1.0, 2.0).translate(Vec3::Z * 40.0))),
    ]
}

#[test]
fn lenses() {
    for (number, assembly) in predictable().into_iter().enumerate() {
        let straight = disk(384, 12.0).map(|[x, y]| along_z(x, y));
        let askew = disk(128, 12.0).map(|[x, y]| {
            let direction = Vec3::new(0.02 * (y - x), 0.03 * (x + 1.0), 1.0);
            Light { wavelength_nm: 480.0, ..Light::new(Vec3::new(x, y, -50.0), direction, D_NM) }
        });
        let lights: Vec<Light> = straight.chain(askew).collect();
        assert_same_alone(&format!("system {number}"), &assembly.compile().unwrap(), &lights);
    }
}

#[test]
fn rays_that_graze_a_ball() {
    let system = Assembly::new()
        .add(transparent("ball", &ball(10.0), 1.5))
        .add(flat_screen("screen", 40.0, 90.0))
        .compile()
        .unwrap();
    let within = |k: i32| bundle(10.0 - 10.0_f64.powi(-k), 0.0, 10.0_f64.powi(-k - 2));
    let beyond = |k: i32| bundle(10.0 + 10.0_f64.powi(-k), 0.0, -3e-1 * 10.0_f64.powi(-k));
    let lights = between_ordinary((1..17).map(within).chain((1..17).map(beyond)));
    assert_same_alone("graze", &system, &lights);
}

#[test]
fn rays_through_the_edges_of_apertures() {
    let lens = ball(50.0).translate(Vec3::Z * 46.0) & ball(60.0).translate(Vec3::Z * -56.0) & rod(8.0, 20.0);
    let system = Assembly::new()
        .add(transparent("lens", &lens, 1.5))
        .add(flat_screen("small", 20.0, 7.0))
        .add(flat_screen("screen", 40.0, 90.0))
        .compile()
        .unwrap();
    let at = |edge: f64| (0..17).map(move |k| bundle(edge - 10.0_f64.powi(-k), 0.0, 10.0_f64.powi(-k)));
    let rim = (0..8).map(|k| bundle(8.0, 0.0, 10.0_f64.powi(-2 * k)));
    let lights = between_ordinary(at(8.0).chain(at(3.5)).chain(at(4.6)).chain(rim));
    assert_same_alone("edges", &system, &lights);
}

#[test]
fn coincident_faces_and_tiny_gaps() {
    let plate = |z: f64| block(20.0, 20.0, 4.0).translate(Vec3::Z * z);
    for gap in [0.0, 1e-15, 1e-14, 1e-12, 1e-9, 1e-7, 1e-3] {
        let (surface, trim) = flat(6.0 + gap, 9.0);
        let system = Assembly::new()
            .add(transparent("first", &plate(0.0), 1.5))
            .add(transparent("second", &plate(4.0 + gap), 1.7))
            .add(screen("on its face", surface, trim))
            .add(flat_screen("screen", 40.0, 90.0))
            .compile()
            .unwrap();
        let askew = |k: usize| {
            bundle(0.0, 0.0, 1.0).map(|light| Light::new(light.ray.origin, [0.0, 0.02 * k as f64, 1.0], D_NM))
        };
        assert_same_alone(&format!("gap {gap}"), &system, &between_ordinary((0..6).map(askew)));
    }
}

#[test]
fn rays_of_several_media_and_colours_at_a_time() {
    let crown = Medium::glass("N-BK7").unwrap();
    let system = Assembly::new()
        .add(transparent("tank", &block(30.0, 30.0, 30.0), 1.33))
        .add(Element::transparent("ball", ball(8.0), &crown))
        .add(transparent("core", &ball(3.0).translate(Vec3::X), 1.1))
        .add(flat_screen("screen", 40.0, 90.0))
        .compile()
        .unwrap();
    let starting = |z: f64| {
        bundle(-9.0, 1.0, 2.5)
            .map(|light| Light::new(light.ray.origin * Vec3::new(1.0, 1.0, 0.0) + Vec3::Z * z, Vec3::Z, D_NM))
    };
    let coloured = |shift: usize| {
        let mut eight = bundle(-3.0, 1.0, 0.8);
        eight
            .iter_mut()
            .enumerate()
            .for_each(|(k, light)| light.wavelength_nm = 450.0 + 40.0 * ((k + shift) % 5) as f64);
        eight
    };
    let lights = between_ordinary((-16..16).map(|z| starting(f64::from(z))).chain((0..8).map(coloured)));
    assert_same_alone("media", &system, &lights);
}

#[test]
fn sheets_of_many_faces_and_curved_ones() {
    let box_sheet = screen("box", block(6.0, 6.0, 6.0).translate(Vec3::Z * 20.0), block(40.0, 40.0, 60.0));
    let bowl = screen(
        "bowl",
        ball(30.0).translate(Vec3::Z * 10.0),
        block(90.0, 90.0, 20.0).translate(Vec3::Z * 40.0),
    );
    let system =
        Assembly::new().add(transparent("ball", &ball(5.0), 1.5)).add(box_sheet).add(bowl).compile().unwrap();
    let sideways = |k: usize| {
        bundle(0.0, 0.0, 0.3)
            .map(|light| Light::new(light.ray.origin + Vec3::new(-40.0, 0.0, 68.0 + k as f64), Vec3::X, D_NM))
    };
    let askew = |k: usize| {
        bundle(-4.0, 0.0, 0.3).map(|light| Light::new(light.ray.origin, [0.05 * k as f64, 0.01, 1.0], D_NM))
    };
    let lights = between_ordinary((0..8).map(sideways).chain((0..8).map(askew)));
    assert_same_alone("sheets", &system, &lights);
}
