//! Conservation laws and invariants of light in every gradient.

use crate::{D_NM, ball, block, close, directions, graded, near, one, plane, rod, trace};
use rayweave_math::{Affine, Vec3};
use rayweave_optics::gradient::Gradient;
use rayweave_optics::interface::Stokes;
use rayweave_optics::{
    Action, Assembly, Beam, Branches, Element, Event, Finish, Keep, Light, Medium, Paths, Segment, System,
    Trace, TraceSettings,
};
use std::num::NonZeroUsize;

/// A lens of one gradient, cemented to a block of another, in water.
fn cemented() -> System {
    let map = Affine::rotation(Vec3::X, 25.0).then(&Affine::translate(Vec3::new(0.2, -0.3, 1.0)));
    let first = graded(1.0, Gradient::polynomial(&[1.7, -0.004, 1e-5], &[0.01]).unwrap());
    let second = graded(1.2, Gradient::fish_eye(9.0).unwrap().placed(&map).unwrap());
    let lens = ball(8.0).translate(Vec3::Z * 5.0) & block(6.0, 6.0, 6.0);
    let behind = block(6.0, 6.0, 4.0).translate(Vec3::Z * 5.0);
    let water = Medium::constant("water", 1.33, 0.0).unwrap();
    let assembly = Assembly::new().world(water).add(Element::transparent("lens", lens, &first));
    assembly.add(Element::transparent("block", behind, &second)).compile().unwrap()
}

#[test]
fn light_paths_are_reversible() {
    let system = cemented();
    for (x, y) in [(0.1, 0.2), (-1.5, 0.4), (2.0, -2.0), (0.0, 2.7)] {
        let d = Vec3::new(0.03, -0.05, 1.0).normalize();
        let rows = one(&system, Light::new(Vec3::new(x, y, -20.0), d, D_NM));
        let last = rows[rows.len() - 1];
        assert!(rows.iter().filter(|row| row.event == Event::Transmitted).count() >= 3, "{x} {y}");
        let there = last.start + 10.0 * last.direction;
        let back = one(&system, Light::new(there, -last.direction, D_NM));
        let home = back[back.len() - 1];
        close(home.direction, -d, 1e-12);
        let offset = (Vec3::new(x, y, -20.0) - home.start).cross(d);
        close(offset, Vec3::ZERO, 1e-11);
        let length = (home.start - Vec3::new(x, y, -20.0)).length();
        near(home.path + 1.33 * (length - 10.0), last.path - 13.3 + 1.33 * 10.0, 1e-11);
    }
}

/// A step along a curve does not count as an element of a path.
#[test]
fn paths_list_the_elements_hit() {
    let rod = Element::transparent("rod", rod(2.0, 30.0), &graded(1.6, Gradient::selfoc(0.1).unwrap()));
    let screen = Element::absorber("screen", block(20.0, 20.0, 1.0).translate(Vec3::Z * 40.0));
    let system = Assembly::new().add(rod).add(screen).compile().unwrap();
    let found = trace(
        &system,
        &Beam::from_iter([Light::new(Vec3::new(0.5, 0.0, -20.0), Vec3::Z, D_NM)]),
        &TraceSettings::default(),
    );
    assert!(found.segments.iter().any(|row| row.event == Event::Curved));
    let mut paths = Paths::default();
    paths.add(&found.segments);
    let texts: Vec<String> = paths.list().iter().map(|path| path.text(system.element_names())).collect();
    assert_eq!(texts, ["rod rod screen"]);
}

/// Liouville's theorem: the determinant of the map of position and n times direction is 1 for every
/// path.
#[test]
fn etendue_is_conserved() {
    // the same law without gradients
    let lens = ball(20.0).translate(Vec3::Z * 18.0) & ball(15.0).translate(Vec3::Z * -12.0);
    let glass = Medium::glass("N-SF11").unwrap();
    let lens = Assembly::new().add(Element::transparent("lens", lens, &glass)).compile().unwrap();
    for system in [cemented(), lens] {
        etendue_is_kept_by(&system);
    }
}

fn etendue_is_kept_by(system: &System) {
    let through = |q: [f64; 4]| -> [f64; 4] {
        let [x, y, u, v] = q;
        let d = Vec3::new(u, v, (1.0 - u * u - v * v).sqrt());
        let rows = one(system, Light::new(Vec3::new(x, y, -9.0), d, D_NM));
        let last = rows[rows.len() - 1];
        let p = last.start + last.direction * ((12.0 - last.start.z) / last.direction.z);
        [p.x, p.y, last.direction.x, last.direction.y]
    };
    for (x, y) in [(0.3, 0.2), (-1.2, 0.7), (1.0, -1.9)] {
        let at = [x, y, 0.02, -0.03];
        let step = 1e-4;
        let columns: [[f64; 4]; 4] = std::array::from_fn(|k| {
            let moved = |by: f64| through(std::array::from_fn(|i| at[i] + if i == k { by } else { 0.0 }));
            let (a, b, c, e) = (moved(-2.0 * step), moved(-step), moved(step), moved(2.0 * step));
            std::array::from_fn(|i| (a[i] - 8.0 * b[i] + 8.0 * c[i] - e[i]) / (12.0 * step))
        });
        near(determinant(columns), 1.0, 1e-8);
    }
}

fn determinant(mut m: [[f64; 4]; 4]) -> f64 {
    let mut product = 1.0;
    for k in 0..4 {
        let pivot = (k..4).max_by(|a, b| m[*a][k].abs().total_cmp(&m[*b][k].abs())).unwrap();
        if pivot != k {
            m.swap(k, pivot);
            product = -product;
        }
        product *= m[k][k];
        for i in k + 1..4 {
            let factor = m[i][k] / m[k][k];
            for j in k..4 {
                m[i][j] -= factor * m[k][j];
            }
        }
    }
    product
}

/// Random rays through balls whose index falls or rises towards the rim: no ray is lost, and each
/// leaves with the invariant of Bouguer with which it entered, after any number of total
/// reflections.
#[test]
fn no_ray_is_lost() {
    none_is_lost(5000);
}

#[test]
#[ignore = "long"]
fn long_no_ray_of_many_is_lost() {
    none_is_lost(100_000);
}

fn none_is_lost(count: usize) {
    for gradient in [Gradient::luneburg(3.0).unwrap(), Gradient::squared(&[1.0, 0.05]).unwrap()] {
        let medium = graded(1.6, gradient);
        // the gradient is about the axis; a ball with it conserves the moment about that axis only
        let system = Assembly::new().add(Element::transparent("ball", ball(2.0), &medium)).compile().unwrap();
        let all: Vec<Vec3> = directions(count).collect();
        let lights = all.iter().enumerate().map(|(k, &d)| {
            let spread = all[(k * 2741) % count];
            Light::new(1.99 * spread - 6.0 * d, d, D_NM)
        });
        let beam: Beam = lights.collect();
        let settings = TraceSettings { keep: Keep::Ends, generation_limit: 50, ..TraceSettings::default() };
        let found = trace(&system, &beam, &settings);
        near(found.balance.escaped, beam.len() as f64, 0.0);
        assert_eq!(found.segments.len(), beam.len());
        for row in found.segments.iter() {
            let light = beam.get(row.id as usize);
            let moment = |p: Vec3, d: Vec3| p.cross(d).z;
            near(moment(row.start, row.direction), moment(light.ray.origin, light.ray.direction), 2e-12);
        }
    }
}

/// Every ray hits a wall far thinner than any step.
#[test]
fn no_wall_is_missed() {
    let medium = graded(1.6, Gradient::selfoc(0.25).unwrap());
    let wall = block(6.0, 6.0, 1e-9).translate(Vec3::Z * 11.3);
    let system = Assembly::new()
        .add(Element::transparent("rod", rod(2.0, 40.0), &medium))
        .add(Element::absorber("wall", wall))
        .compile()
        .unwrap();
    let fan = (0..400).map(|k| Light::new([0.3, 0.1, -1.0], [1e-3 * f64::from(k) - 0.2, 0.0, 1.0], D_NM));
    let found =
        trace(&system, &fan.collect(), &TraceSettings { keep: Keep::Ends, ..TraceSettings::default() });
    assert!(found.balance.absorbed[1] == 400.0, "{:?}", found.balance);
}

#[test]
fn power_is_conserved() {
    let medium = Medium::constant("dim", 1.6, 1e-8).unwrap().graded(Gradient::selfoc(0.25).unwrap());
    let inner = Element::transparent(
        "inner",
        ball(0.5).translate(Vec3::Z * 6.0),
        &graded(1.0, Gradient::fish_eye(2.0).unwrap()),
    );
    let stop = Element::sheet("stop", plane(9.0, 0.5), Action::Splitter { reflectance: 0.3 });
    let system = Assembly::new()
        .add(Element::transparent("rod", rod(1.0, 12.0), &medium))
        .add(inner.finish(Finish::Rough { slope: 0.1 }))
        .add(stop)
        .compile()
        .unwrap();
    let lights = (0..60).map(|k| Light::new([0.01 * f64::from(k), 0.2, -1.0], [0.1, -0.15, 1.0], D_NM));
    let beam: Beam = lights.collect();
    for (branches, polarised) in [(Branches::Both, true), (Branches::Both, false), (Branches::Random, true)] {
        let settings = TraceSettings { branches, polarised, threshold: 1e-5, ..TraceSettings::default() };
        let balance = trace(&system, &beam, &settings).balance;
        near(balance.error(), 0.0, 1e-12);
        assert!(balance.absorbed_in_media > 0.1 && balance.escaped > 10.0, "{balance:?}");
        assert!(balance.dropped < 0.1, "{balance:?}");
    }
}

/// The Beer-Lambert law along a path of known length: the length of the slab on the axis, the arc
/// length off it.
#[test]
fn absorption_counts_the_length_of_the_path() {
    let k = 1e-6;
    let medium = Medium::constant("dim", 1.6, k).unwrap().graded(Gradient::axial(&[1.0, 0.02]).unwrap());
    let slab = block(9.0, 9.0, 5.0).translate(Vec3::Z * 2.5);
    let system = Assembly::new().add(Element::transparent("slab", slab, &medium)).compile().unwrap();
    let rows = one(&system, Light::new([0.0, 0.0, -1.0], [0.0, 0.0, 1.0], D_NM));
    let coefficient = 4.0 * std::f64::consts::PI * k / (D_NM * 1e-6);
    near(rows[rows.len() - 1].intensity, (-coefficient * 5.0).exp(), 1e-14);
}

/// Polarisation undergoes parallel transport (Rytov): after one period of a helix the plane has
/// rotated by the solid angle that the tangent encloses, 2 pi (1 - cos).
#[test]
fn polarisation_rotates_along_helices() {
    let (n0, g, r) = (1.6, 0.25, 1.0);
    let medium = graded(n0, Gradient::selfoc(g).unwrap());
    // on a circle the transverse speed is n0 g r; the rest is along the axis
    let w = n0 * g;
    let index = n0 * (1.0 - g * g * r * r).sqrt();
    let forwards = (index * index - w * w * r * r).sqrt();
    let pitch = forwards * std::f64::consts::TAU / w;
    let screen = Element::sheet("polariser", plane(1.0 + pitch, 6.0), Action::Polariser { axis: Vec3::X });
    let system = Assembly::new()
        .add(Element::transparent("rod", rod(3.0, 40.0), &medium))
        .add(screen)
        .compile()
        .unwrap();
    let mut light = Light::new(Vec3::new(r, 0.0, 1.0), Vec3::new(0.0, w * r, forwards), D_NM);
    light.stokes = Some(Stokes { parameters: [1.0, 1.0, 0.0, 0.0], axis: Vec3::X });
    let settings = TraceSettings { polarised: true, ..TraceSettings::default() };
    let found = trace(&system, &Beam::from_iter([light]), &settings);
    let rows: Vec<Segment> = found.segments.iter().collect();
    let met = rows.iter().position(|row| row.event == Event::Passed).unwrap();
    close(rows[met].end, Vec3::new(r, 0.0, 1.0 + pitch), 1e-12);
    let turned = std::f64::consts::TAU * (1.0 - forwards / index);
    assert!(turned > 0.1);
    near(rows[met + 1].intensity, turned.cos().powi(2), 1e-7);
}

/// Light that a sheet splits, or a thin lens deflects, inside a gradient continues in the gradient.
#[test]
fn sheets_work_inside_gradients() {
    let (n0, g) = (1.5, 0.2);
    let medium = graded(n0, Gradient::selfoc(g).unwrap());
    let lens = Element::sheet("lens", plane(4.0, 9.0), Action::ThinLens { focal_length: 10.0 });
    let screen = Element::sheet("screen", plane(7.0, 9.0), Action::Record);
    let system = Assembly::new()
        .add(Element::transparent("rod", rod(4.0, 10.0), &medium))
        .add(lens)
        .add(screen)
        .compile()
        .unwrap();
    let rows = one(&system, Light::new(Vec3::new(1.0, 0.0, -1.0), Vec3::Z, D_NM));
    // a sine to the lens, the slope changed by x / f, a sine to the screen
    let w = n0 * g;
    let go = |x: f64, slope: f64, z: f64| {
        let index = n0 * (1.0 - g * g * x * x).sqrt();
        let forwards = index / (1.0 + slope * slope).sqrt();
        let (s, c) = (w * z / forwards).sin_cos();
        let u = slope * forwards;
        (x * c + u / w * s, (u * c - w * x * s) / forwards)
    };
    let (x, slope) = go(1.0, 0.0, 4.0);
    let (x, _) = go(x, slope - x / 10.0, 3.0);
    let met = rows.iter().find(|row| row.event == Event::Passed).unwrap();
    close(met.end, Vec3::new(x, 0.0, 7.0), 1e-13);
    assert_eq!(rows.iter().filter(|row| row.event == Event::Bent).count(), 1);
}

/// A mirage: the index of the air rises with the height, and a flat ray turns upwards before it
/// reaches the ground.
#[test]
fn the_world_may_have_a_gradient() {
    // n = 1 + 1e-3 z: the path is a cosh; u = n cos at the start is conserved
    let air = graded(1.0, Gradient::axial(&[1.0, 1e-3]).unwrap());
    let screen = Element::absorber("screen", block(1.0, 20.0, 20.0).translate(Vec3::X * 60.5));
    let road = Element::absorber("road", block(200.0, 20.0, 1.0).translate(Vec3::Z * -5.5));
    let system = Assembly::new().world(air).add(screen).add(road).compile().unwrap();
    let (s, u) = (-0.02_f64).sin_cos();
    let rows = one(&system, Light::new(Vec3::ZERO, Vec3::new(u, 0.0, s), D_NM));
    let last = rows[rows.len() - 1];
    // n = u cosh(c1 (x - x0) / u), with the lowest point at x0
    let x0 = u / 1e-3 * (1.0 / u).acosh();
    let n = u * (1e-3 * (60.0 - x0) / u).cosh();
    assert_eq!(last.event, Event::Absorbed);
    close(last.end, Vec3::new(60.0, 0.0, (n - 1.0) / 1e-3), 1e-9);
    // a ray that starts upwards never returns
    let rows = one(&system, Light::new(Vec3::ZERO, Vec3::new(-1.0, 0.0, 1.0), D_NM));
    assert_eq!(rows[rows.len() - 1].event, Event::Escaped);
}

#[test]
fn results_do_not_depend_on_threads_and_ends_are_the_last_rows() {
    let system = cemented();
    let lights = directions(3000).map(|d| Light::new(Vec3::new(0.3, -0.4, 2.0) - 20.0 * d, d, D_NM));
    let beam: Beam = lights.collect();
    let settings = |threads, keep| TraceSettings {
        threads: NonZeroUsize::new(threads),
        keep,
        keep_escaped: false,
        branches: Branches::Random,
        ..TraceSettings::default()
    };
    let all = trace(&system, &beam, &settings(1, Keep::All));
    assert_eq!(all, trace(&system, &beam, &settings(2, Keep::All)));
    let ends = trace(&system, &beam, &settings(2, Keep::Ends));
    assert_eq!(ends.balance, all.balance);
    let curved = |trace: &Trace| trace.segments.iter().filter(|row| row.event == Event::Curved).count();
    assert!(curved(&all) > 100 && curved(&ends) == 0);
}
