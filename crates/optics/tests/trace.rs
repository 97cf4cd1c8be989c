//! Light through systems, against closed forms.

mod common;

use common::{D_NM, along_z, ball, below, block, disk, glass, near, plane, rod, solid, trace};
use num_complex::Complex64;
use rayweave_math::{Affine, Mat3, Vec3};
use rayweave_model::Solid;
use rayweave_optics::component::Sheet;
use rayweave_optics::interface::{Film, Stokes, fresnel};
use rayweave_optics::{
    Action, Assembly, Beam, Branches, Element, Event, Finish, Keep, Light, Material, Medium, OpticsError,
    Segment, System, Trace, TraceSettings, Tracer,
};
use rayweave_shape::primitive::{Ellipsoid, HalfSpace, Paraboloid, Prism};
use rayweave_trace::{Packets, Reference};
use std::num::NonZeroUsize;

fn one(system: &System, light: Light, settings: &TraceSettings) -> Vec<Segment> {
    trace(system, &Beam::from_iter([light]), settings).segments.iter().collect()
}

/// True if the traces are equal; end points of light that escapes are NaN and are not compared.
fn is_same(a: &Trace, b: &Trace) -> bool {
    let open = |trace: &Trace| {
        let rows = trace.segments.iter().map(|row| match row.event {
            Event::Escaped => Segment { end: Vec3::ZERO, ..row },
            _ => row,
        });
        rows.collect::<Vec<_>>()
    };
    a.balance == b.balance && open(a) == open(b)
}

#[test]
fn a_plate_shifts_light_sideways() {
    // Born & Wolf, section 4.9.5: d = thickness sin(i - r) / cos(r)
    let plate = Element::transparent("plate", block(40.0, 40.0, 10.0), &glass(1.5));
    let system = Assembly::new().add(plate).compile().unwrap();
    let (sine, cosine) = 40.0_f64.to_radians().sin_cos();
    let light = Light::new(Vec3::new(-20.0 * sine, 0.0, -20.0 * cosine), Vec3::new(sine, 0.0, cosine), D_NM);
    let rows = one(&system, light, &TraceSettings::default());
    assert_eq!(
        rows.iter().map(|row| row.event).collect::<Vec<_>>(),
        [Event::Transmitted, Event::Transmitted, Event::Escaped]
    );
    let inside = (sine / 1.5).asin();
    let expected = 10.0 * (40.0_f64.to_radians() - inside).sin() / inside.cos();
    let last = rows[2];
    let offset = (last.start - light.ray.origin).cross(last.direction).length();
    near(offset, expected, 1e-13);
    near((last.direction - light.ray.direction).length(), 0.0, 1e-15);
    near(rows[1].path, rows[0].start.distance(rows[0].end) + 1.5 * 10.0 / inside.cos(), 1e-12);
    assert_eq!(rows.iter().map(|row| row.index).collect::<Vec<_>>(), [1.0, 1.5, 1.0]);
    assert_eq!((rows[1].parent, rows[1].generation, rows[0].element, last.element), (0, 1, 0, -1));
    assert_eq!(system.surface_name(rows[0].surface as usize), "plate.z-");
}

/// In a cube with an index of 1.5, light along its diagonal hits each face at 54.7 degrees, beyond the critical angle of 41.8
/// degrees: it stays for ever. All rays hit edges of the cube exactly, the first one its corners.
#[test]
fn light_does_not_leak_at_edges() {
    let cube = Element::transparent("cube", block(10.0, 10.0, 10.0), &glass(1.5));
    let system = Assembly::new().add(cube).compile().unwrap();
    let inside = |k: i32| Light::new(Vec3::new(0.1 * f64::from(k), 0.0, 0.0), Vec3::ONE, D_NM);
    let beam: Beam = (0..40).map(inside).collect();
    let settings = TraceSettings { generation_limit: 300, ..TraceSettings::default() };
    let found = trace(&system, &beam, &settings);
    assert_eq!((found.balance.escaped, found.balance.dropped), (0.0, 40.0));
    assert!(found.segments.iter().all(|row| row.event == Event::TotallyReflected));
    assert!(found.segments.iter().all(|row| row.end.abs().max_element() < 5.0 + 1e-9));
}

#[test]
fn lenses_agree_with_a_sequential_trace() {
    // a biconvex lens of radius 50, 8 thick; the reference is the same ray by hand in the meridional plane
    let (r, thickness, n) = (50.0, 8.0, 1.5168);
    let centre = |sign: f64| Vec3::Z * (sign * (r - thickness / 2.0));
    let lens = ball(r).translate(centre(1.0)) & ball(r).translate(centre(-1.0)) & rod(15.0, 20.0);
    let system = Assembly::new().add(Element::transparent("lens", lens, &glass(n))).compile().unwrap();
    for [x, y] in disk(500, 14.5) {
        let rows = one(&system, along_z(x, y), &TraceSettings::default());
        let (h, d) = (x.hypot(y), rows[2].direction);
        // angles against the axis: at the first surface and at the second one
        let (z1, i1) = (r - thickness / 2.0 - (r * r - h * h).sqrt(), (h / r).asin());
        let u = -(i1 - (h / r / n).asin());
        // intersect the second sphere: its centre is at z = thickness / 2 - r
        let (oz, oh) = (z1 - (thickness / 2.0 - r), h);
        let b = oz * u.cos() + oh * u.sin();
        let t = -b + (b * b - oz * oz - oh * oh + r * r).sqrt();
        let (nz, nh) = ((oz + t * u.cos()) / r, (oh + t * u.sin()) / r);
        let i2 = nh.atan2(nz) - u;
        let out = nh.atan2(nz) - (n * i2.sin()).asin();
        near(d.z, out.cos(), 2e-14);
        near((d.x * x + d.y * y) / h, out.sin(), 2e-14);
        near(rows[2].start.z, thickness / 2.0 - r + oz + t * u.cos(), 1e-13);
    }
}

#[test]
fn a_prism_deviates_least_when_passed_symmetrically() {
    // n = sin((A + D) / 2) / sin(A / 2) (Born & Wolf, section 4.7.1, equation 10)
    let n = 1.6_f64;
    let prism = solid(Prism::new(3, 20.0, 30.0).unwrap());
    let system = Assembly::new().add(Element::transparent("prism", prism, &glass(n))).compile().unwrap();
    let expected = 2.0 * (n * 30.0_f64.to_radians().sin()).asin() - 60.0_f64.to_radians();
    let deviation = |incidence: f64| {
        // the first vertex is on +x: enter by the face whose normal is at 60 degrees, leave by that at -60 degrees
        let normal = Vec3::new(0.5, 0.75_f64.sqrt(), 0.0);
        let tangent = Vec3::new(0.75_f64.sqrt(), -0.5, 0.0);
        let d = -incidence.cos() * normal + incidence.sin() * tangent;
        let light = Light::new(10.0 * normal - 30.0 * d, d, D_NM);
        let rows = one(&system, light, &TraceSettings::default());
        assert_eq!(rows.len(), 3, "{rows:?}");
        d.angle_between(rows[2].direction)
    };
    let best = (n * 0.5).asin();
    near(deviation(best), expected, 1e-14);
    for off in [-0.1, -0.01, 0.01, 0.1] {
        assert!(deviation(best + off) > expected, "{off}");
    }
}

#[test]
fn parabolas_and_ellipsoids_focus_perfectly() {
    // x^2 + y^2 < 4 f z removed from a block: light along -z converges at z = f
    let dish = rod(20.0, 40.0) - solid(Paraboloid::new(25.0, f64::INFINITY).unwrap());
    let screen = Element::sheet("focus", plane(25.0, 2.0), Action::Absorb);
    let system = Assembly::new().add(Element::mirror("dish", dish)).add(screen).compile().unwrap();
    let rays = disk(1000, 15.0).filter(|[x, y]| x.hypot(*y) > 2.0);
    let beam: Beam = rays.map(|[x, y]| Light::new(Vec3::new(x, y, 90.0), -Vec3::Z, D_NM)).collect();
    let found = trace(&system, &beam, &TraceSettings::default());
    let ends: Vec<Segment> = found.segments.iter().filter(|row| row.element == 1).collect();
    assert_eq!(ends.len(), beam.len());
    for row in ends {
        near((row.end - 25.0 * Vec3::Z).length(), 0.0, 3e-14 * 25.0);
        // all paths are equal: from z = 90 to the directrix z = -25
        near(row.path, 115.0, 1e-13 * 115.0);
    }
    // an ellipsoid with half axes 5, 4, 4 has its foci at 3 and -3
    let cave = ball(20.0) - solid(Ellipsoid::new(Vec3::new(5.0, 4.0, 4.0)).unwrap());
    let target = ball(1e-6).translate(3.0 * Vec3::X);
    let system = Assembly::new()
        .add(Element::mirror("cave", cave))
        .add(Element::absorber("target", target))
        .compile()
        .unwrap();
    for [x, y] in disk(300, 0.9) {
        let d = Vec3::new(x, y, (1.0 - x * x - y * y).sqrt());
        let rows = one(&system, Light::new(-3.0 * Vec3::X, d, D_NM), &TraceSettings::default());
        assert_eq!((rows.len(), rows[1].element), (2, 1), "{rows:?}");
        near(rows[1].path, 10.0, 2e-6);
    }
}

/// Two lenses that share a face: crown in front of flint.
fn doublet() -> (Solid, Solid) {
    let middle = ball(40.0).translate(-Vec3::Z * 38.0);
    let front = ball(60.0).translate(Vec3::Z * 55.0);
    let crown = &front & &middle & rod(12.0, 40.0);
    let flint = (rod(12.0, 40.0) & below(6.0)) - &middle - (below(0.0) - &front);
    (crown, flint)
}

#[test]
fn cemented_lenses_have_no_gap() {
    let (crown, flint) = doublet();
    let (axis, angle) = (Vec3::new(0.3, -0.5, 0.8), 37.0);
    let world = Medium::constant("water", 1.333, 0.0).unwrap();
    let turned = |solid: &Solid| solid.rotate(axis, angle).translate(Vec3::new(7.3, -2.9, 11.7));
    let system = Assembly::new()
        .world(world)
        .add(Element::transparent("crown", turned(&crown), &glass(1.5168)))
        .add(Element::transparent("flint", turned(&flint), &glass(1.6200)))
        .compile()
        .unwrap();
    let map = Affine::rotation(axis, angle).then(&Affine::translate(Vec3::new(7.3, -2.9, 11.7)));
    let beam: Beam = disk(20_000, 10.0)
        .map(|[x, y]| {
            let light = Light::new(Vec3::new(x, y, -50.0), Vec3::new(0.002 * x, 0.01, 1.0), D_NM);
            Light { ray: light.ray.transformed(&map), ..light }
        })
        .collect();
    let found = trace(&system, &beam, &TraceSettings::default());
    let mut indices = vec![Vec::new(); beam.len()];
    found.segments.iter().for_each(|row| indices[row.id as usize].push(row.index));
    for (ray, indices) in indices.iter().enumerate() {
        assert_eq!(*indices, [1.333, 1.5168, 1.62, 1.333], "ray {ray}");
    }
    // the same from the reference evaluator
    let truth = Tracer::new(&system, Reference::new).trace(&beam, &TraceSettings::default()).unwrap();
    assert!(is_same(&truth, &found));
}

#[test]
fn light_paths_are_reversible() {
    let (crown, flint) = doublet();
    let system = Assembly::new()
        .add(Element::transparent("crown", crown, &glass(1.5168)))
        .add(Element::transparent("flint", flint, &glass(1.6200)))
        .compile()
        .unwrap();
    for [x, y] in disk(300, 10.0) {
        let light = Light::new(Vec3::new(x, y, -50.0), Vec3::new(0.01, 0.002 * x, 1.0), D_NM);
        let out = one(&system, light, &TraceSettings::default()).last().copied().unwrap();
        let back = Light::new(out.start + 30.0 * out.direction, -out.direction, D_NM);
        let home = one(&system, back, &TraceSettings::default()).last().copied().unwrap();
        near((home.direction + light.ray.direction.normalize()).length(), 0.0, 1e-13);
        let offset = (light.ray.origin - home.start).cross(home.direction).length();
        near(offset, 0.0, 1e-12);
    }
}

#[test]
fn power_is_conserved() {
    let (crown, flint) = doublet();
    let stained = Medium::constant("stained", 1.5168, 1e-6).unwrap();
    let silver = Medium::constant("silver", 0.13, 3.9).unwrap();
    let film = Film { index: Complex64::new(2.0, 0.01), thickness_nm: 130.0 };
    let crown = Element::transparent("crown", crown, &stained).face("side", Finish::Coated(vec![film]));
    let system = Assembly::new()
        .add(crown)
        .add(Element::transparent("flint", flint, &glass(1.62)))
        .add(Element::new("wall", block(80.0, 80.0, 5.0).translate(Vec3::Z * 40.0), Material::Metal(silver)))
        .add(
            Element::absorber("hood", block(90.0, 90.0, 5.0).translate(Vec3::Z * -60.0))
                .finish(Finish::Diffuse { reflectance: 0.5 }),
        )
        .add(Element::sheet("splitter", plane(25.0, 60.0), Action::Splitter { reflectance: 0.3 }))
        .compile()
        .unwrap();
    let beam: Beam = disk(100, 11.0)
        .map(|[x, y]| Light {
            power: 2.5,
            ..Light::new(Vec3::new(x, y, -50.0), Vec3::new(0.02, 0.0, 1.0), D_NM)
        })
        .collect();
    for branches in [Branches::Ideal, Branches::Both, Branches::Random] {
        for polarised in [false, true] {
            let settings = TraceSettings { branches, polarised, threshold: 1e-2, ..TraceSettings::default() };
            let found = trace(&system, &beam, &settings).balance;
            near(found.emitted, 250.0, 1e-9);
            near(found.error(), 0.0, 1e-9 * found.emitted);
            assert!(found.absorbed_in_media > 0.03 && found.absorbed[2] > 3.0 && found.absorbed[3] > 0.3);
            assert!(found.absorbed.iter().all(|&power| power > -1e-9), "{found:?}");
        }
    }
}

#[test]
fn random_branches_agree_with_both_branches_on_average() {
    let plate = Element::transparent("plate", block(40.0, 40.0, 10.0), &glass(1.8));
    let system = Assembly::new().add(plate).compile().unwrap();
    let count = 20_000;
    let d = Vec3::new(0.8, 0.0, 0.6);
    let beam: Beam = (0..count).map(|_| Light::new(-20.0 * d, d, D_NM)).collect();
    // incoherent: T = (1 - R) / (1 + R) for each polarisation (Born & Wolf, section 7.6.1 without interference)
    let found = fresnel(1.0, Complex64::from(1.8), 0.6).reflected;
    let through = |r: Complex64| (1.0 - r.norm_sqr()) / (1.0 + r.norm_sqr());
    let expected = 0.5 * (through(found[0]) + through(found[1]));
    let forward = |trace: &Trace| -> f64 {
        let escaped =
            trace.segments.iter().filter(|row| row.event == Event::Escaped && row.direction.z > 0.0);
        escaped.map(|row| row.intensity).sum::<f64>() / trace.balance.emitted
    };
    let polarised = TraceSettings { polarised: true, threshold: 1e-12, ..TraceSettings::default() };
    let both = trace(
        &system,
        &Beam::from_iter([beam.get(0)]),
        &TraceSettings { branches: Branches::Both, ..polarised.clone() },
    );
    near(forward(&both), expected, 1e-10);
    let random = trace(&system, &beam, &TraceSettings { branches: Branches::Random, ..polarised });
    // five standard deviations of a binomial
    near(forward(&random), expected, 5.0 * (expected * (1.0 - expected) / f64::from(count)).sqrt());
}

#[test]
fn brewster_plates_polarise() {
    let n = 1.5_f64;
    let plate = Element::transparent("plate", block(40.0, 40.0, 2.0), &glass(n));
    let system = Assembly::new().add(plate).compile().unwrap();
    let theta = n.atan();
    let d = Vec3::new(theta.sin(), 0.0, theta.cos());
    let settings = TraceSettings {
        branches: Branches::Both,
        polarised: true,
        threshold: 1e-15,
        ..TraceSettings::default()
    };
    let p_light = Light { stokes: Stokes::linear(1.0, d, Vec3::X), ..Light::new(-20.0 * d, d, D_NM) };
    let through: f64 = one(&system, p_light, &settings)
        .iter()
        .filter(|row| row.event == Event::Escaped && row.direction.z > 0.0)
        .map(|row| row.intensity)
        .sum();
    near(through, 1.0, 1e-14);
    let s_light = Light { stokes: Stokes::linear(1.0, d, Vec3::Y), ..p_light };
    let first = one(&system, s_light, &settings)
        .iter()
        .find(|row| row.event == Event::Escaped && row.direction.z < 0.0)
        .map(|row| row.intensity);
    // at Brewster's angle r_s = (1 - n^2) / (1 + n^2)
    near(first.unwrap(), ((1.0 - n * n) / (1.0 + n * n)).powi(2), 1e-14);
}

#[test]
fn absorption_follows_beer_and_lambert() {
    // one percent per millimetre
    let k = -0.99_f64.ln() * D_NM * 1e-6 / (4.0 * std::f64::consts::PI);
    let filter = Medium::constant("filter", 1.5, k).unwrap();
    let plate = Element::transparent("plate", block(40.0, 40.0, 10.0), &filter);
    let system = Assembly::new().add(plate).compile().unwrap();
    let rows = one(&system, along_z(1.0, 2.0), &TraceSettings::default());
    near(rows[2].intensity, 0.99_f64.powi(10), 1e-13);
}

#[test]
fn sheets_stop_record_and_bend() {
    let stop = Sheet { trim: block(40.0, 40.0, 2.0) - rod(5.0, 10.0), ..plane(0.0, 1.0) };
    let system = Assembly::new()
        .add(Element::sheet("stop", stop, Action::Absorb))
        .add(Element::sheet("before", plane(-10.0, 100.0), Action::Record))
        .add(Element::sheet("lens", plane(20.0, 60.0), Action::ThinLens { focal_length: 30.0 }))
        .add(Element::sheet("screen", plane(50.0, 60.0), Action::Absorb))
        .compile()
        .unwrap();
    for [x, y] in disk(500, 15.0) {
        let rows = one(&system, along_z(x, y), &TraceSettings::default());
        let names: Vec<&str> = rows.iter().map(|row| system.surface_name(row.surface as usize)).collect();
        if x.hypot(y) > 5.0 {
            assert_eq!(names, ["before", "stop"]);
            continue;
        }
        assert_eq!(names, ["before", "lens", "screen"]);
        assert_eq!(
            rows.iter().map(|row| row.event).collect::<Vec<_>>(),
            [Event::Passed, Event::Bent, Event::Absorbed]
        );
        near(rows[2].end.x.hypot(rows[2].end.y), 0.0, 1e-13);
        assert_eq!((rows[0].end.z, rows[1].start.z, rows[2].generation), (-10.0, -10.0, 2));
    }
}

#[test]
fn gratings_obey_their_equation() {
    let lines = Vec3::new(600.0, 0.0, 0.0);
    let grating = Action::Grating { lines, order: 1, reflects: true };
    let system = Assembly::new().add(Element::sheet("grating", plane(0.0, 50.0), grating)).compile().unwrap();
    let (sine, cosine) = 20.0_f64.to_radians().sin_cos();
    let light = Light::new(Vec3::new(-sine, 0.0, -cosine) * 10.0, Vec3::new(sine, 0.0, cosine), 500.0);
    let rows = one(&system, light, &TraceSettings::default());
    // sin(b) = sin(a) + m wavelength / d
    near(rows[1].direction.x, sine + 600.0 * 500e-6, 1e-15);
    assert!(rows[1].direction.z < 0.0);
    assert_eq!(rows[0].event, Event::Reflected);
}

/// A grating stretched by two has half the lines, in directions and in paths; one sheared along its
/// normal keeps them.
#[test]
fn stretched_gratings_have_fewer_lines() {
    let (light, order) = (Light::new(Vec3::new(1.0, 2.0, -9.0), Vec3::Z, 500.0), 1);
    let behind = |lines: Vec3, linear: Mat3| {
        let action = Action::Grating { lines, order, reflects: false };
        let sheet = plane(0.0, 50.0).apply(&Affine::from_linear(linear)).unwrap();
        one(
            &Assembly::new().add(Element::sheet("grating", sheet, action)).compile().unwrap(),
            light,
            &TraceSettings::default(),
        )[1]
    };
    let lines = Vec3::new(600.0, 100.0, 0.0);
    let plain = behind(lines, Mat3::IDENTITY);
    near(plain.direction.x, 0.3, 1e-15);
    let cases = [
        (2.0 * lines, Mat3::from_diagonal(Vec3::splat(2.0))),
        (Vec3::new(1800.0, 50.0, 0.0), Mat3::from_diagonal(Vec3::new(3.0, 0.5, 1.0))),
        (lines, Mat3::from_cols(Vec3::X, Vec3::Y, Vec3::new(0.5, 0.3, 1.0))),
    ];
    for (lines, linear) in cases {
        let found = behind(lines, linear);
        near((found.direction - plain.direction).length(), 0.0, 1e-14);
        near(found.path, plain.path, 1e-12);
    }
}

/// All rays of a beam have the same path length through an ideal lens to its focus: the wavefront
/// converges to a point.
#[test]
fn thin_lenses_make_spheres_of_plane_wavefronts() {
    let system = Assembly::new()
        .add(Element::sheet("lens", plane(0.0, 60.0), Action::ThinLens { focal_length: 30.0 }))
        .add(Element::sheet("focus", plane(30.0, 60.0), Action::Absorb))
        .compile()
        .unwrap();
    for [x, y] in disk(40, 20.0) {
        let rows = one(&system, along_z(x, y), &TraceSettings::default());
        near(rows[1].path, 80.0, 1e-13);
    }
}

/// Order m adds m wavelengths for each period from the middle: the wavefronts behind a grating are
/// perpendicular to the rays.
#[test]
fn gratings_tilt_wavefronts() {
    let (lines, order) = (0.1 * Vec3::new(6000.0, -2000.0, 0.0), 2);
    for reflects in [false, true] {
        let action = Action::Grating { lines, order, reflects };
        let system =
            Assembly::new().add(Element::sheet("grating", plane(0.0, 60.0), action)).compile().unwrap();
        let d = Vec3::new(0.1, 0.05, 1.0).normalize();
        let phase = |x: f64, y: f64| {
            let foot = Vec3::new(x, y, 0.0);
            // from a plane perpendicular to the ray, so that all have the same path
            let rows = one(
                &system,
                Light::new(foot - (50.0 + foot.dot(d)) * d, d, 500.0),
                &TraceSettings::default(),
            );
            let last = rows[1];
            // back to the plane through the origin, perpendicular to the ray that leaves
            last.path - last.start.dot(last.direction)
        };
        for [x, y] in disk(20, 15.0) {
            near(phase(x, y), phase(0.0, 0.0), 1e-13);
        }
    }
}

/// At any roughness and angle, reflected light stays on its side of the mean face, and transmitted
/// light leaves on the other.
#[test]
fn rough_faces_send_light_to_the_right_side() {
    let slab = block(1e4, 1e4, 1.0).translate(Vec3::Z * 0.5);
    for slope in [0.05, 0.5, 2.0] {
        let rough = Element::transparent("slab", slab.clone(), &glass(1.5)).finish(Finish::Rough { slope });
        let system = Assembly::new().add(rough).compile().unwrap();
        for degrees in [0.0_f64, 60.0, 85.0, 89.9] {
            let (s, c) = degrees.to_radians().sin_cos();
            let light = Light::new(Vec3::new(-s, 0.0, -c), Vec3::new(s, 0.0, c), D_NM);
            let beam: Beam = (0..200).map(|_| light).collect();
            let settings =
                TraceSettings { branches: Branches::Both, generation_limit: 2, ..TraceSettings::default() };
            let found = trace(&system, &beam, &settings);
            near(found.balance.error(), 0.0, 1e-11);
            let first = found.segments.iter().filter(|row| row.generation == 1);
            // all the light in the glass, none of it above the face
            for row in first {
                assert_eq!(row.index == 1.5, row.direction.z > 0.0, "{slope} {degrees}: {row:?}");
            }
            assert!(found.balance.absorbed[0].abs() < 1e-11);
        }
    }
}

/// The mean slope of the visible facets of a rough face whose slopes have the standard deviation s:
/// towards light at the angle a it is s^2 tan(a) (Walter et al. 2007, the distribution of visible
/// normals, here of slopes).
#[test]
fn visible_facets_are_tilted_towards_the_light() {
    let half = solid(HalfSpace::new(Vec3::Z, 0.0).unwrap());
    for (slope, degrees) in [(0.1, 60.0_f64), (0.05, 75.0), (0.1, 0.0)] {
        let (s, c) = degrees.to_radians().sin_cos();
        let metal = Element::new("metal", half.clone(), Material::Metal(Medium::glass("Al").unwrap()));
        let system = Assembly::new().add(metal.finish(Finish::Rough { slope })).compile().unwrap();
        let light = Light::new(Vec3::new(-s, 0.0, c), Vec3::new(s, 0.0, -c), D_NM);
        let count = 40_000;
        let found = trace(&system, &(0..count).map(|_| light).collect(), &TraceSettings::default());
        let after = found.segments.iter().filter(|row| row.generation == 1);
        let slopes = after.map(|row| {
            let facet = row.direction - light.ray.direction;
            -facet.x / facet.z
        });
        let mean = slopes.sum::<f64>() / f64::from(count);
        let expected = slope * slope * degrees.to_radians().tan();
        assert!(
            (mean - expected).abs() < 5.0 * slope / f64::from(count).sqrt(),
            "{degrees}: {mean} {expected}"
        );
    }
}

#[test]
fn crossed_polarisers_block_light_and_a_third_between_them_transmits_an_eighth() {
    let at = |z: f64, degrees: f64| {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let action = Action::Polariser { axis: Vec3::new(cosine, sine, 0.0) };
        Element::sheet(&format!("at {z}"), plane(z, 50.0), action)
    };
    let settings = TraceSettings { polarised: true, ..TraceSettings::default() };
    let power =
        |system: &System| trace(system, &Beam::from_iter([along_z(0.1, 0.2)]), &settings).balance.escaped;
    let crossed = Assembly::new().add(at(0.0, 0.0)).add(at(1.0, 90.0));
    near(power(&crossed.compile().unwrap()), 0.0, 1e-16);
    let three = Assembly::new().add(at(0.0, 0.0)).add(at(0.5, 45.0)).add(at(1.0, 90.0));
    near(power(&three.compile().unwrap()), 0.125, 1e-15);
}

#[test]
fn corner_cubes_send_light_back() {
    let corner = ball(30.0) - block(60.0, 60.0, 60.0).translate(Vec3::splat(30.0));
    let system = Assembly::new().add(Element::mirror("corner", corner)).compile().unwrap();
    for [x, y] in disk(300, 3.0) {
        let d = -Vec3::new(1.0 + 0.02 * x, 1.1 + 0.03 * y, 0.9).normalize();
        let origin = Vec3::new(3.0 + 0.3 * x, 4.0, 3.5 + 0.3 * y);
        let rows = one(&system, Light::new(origin, d, D_NM), &TraceSettings::default());
        let last = rows.last().unwrap();
        assert_eq!((rows.len(), last.event), (4, Event::Escaped));
        near((last.direction + d).length(), 0.0, 1e-15);
    }
}

#[test]
fn a_shared_face_has_the_finish_of_the_entered_element() {
    // the silvered spot of a lens: the mirror begins in the same face in which the lens would end
    let centre = Vec3::Z * -25.0;
    let round = (
        ball(30.0).translate(centre) - below(-5.0),
        (ball(40.0).translate(centre) & rod(4.0, 60.0)) - ball(30.0).translate(centre),
    );
    let flat = (block(20.0, 20.0, 10.0), (rod(4.0, 60.0) & below(8.0)) - below(5.0));
    for (lens, spot) in [round, flat].map(|(lens, spot)| (lens, spot.named("back"))) {
        let silver = Element::absorber("spot", spot).face("back", Finish::Mirror { reflectance: 1.0 });
        let system = Assembly::new()
            .add(Element::transparent("lens", lens.named("back"), &glass(1.5)))
            .add(silver)
            .compile()
            .unwrap();
        let rows = one(&system, along_z(1.0, 0.5), &TraceSettings::default());
        assert_eq!(rows[1].event, Event::Reflected, "{rows:?}");
        // light outside the spot is transmitted, regardless of the names of the leaves
        let beside = one(&system, along_z(5.0, 0.5), &TraceSettings::default());
        assert_eq!(beside[1].event, Event::Transmitted, "{beside:?}");
    }
}

#[test]
#[cfg(target_os = "linux")]
fn segments_that_do_not_fit_into_memory_are_refused() {
    use rayweave_optics::source::{Pattern, Source, Sources};
    let system = Assembly::new().add(Element::transparent("ball", ball(1.0), &glass(1.5))).compile().unwrap();
    let tracer = Tracer::new(&system, Packets::new);
    let line = Source::new(Pattern::Line { length: 1.0, count: 1 << 53 }).unwrap();
    for light in [Sources::new(vec![line.clone()]), Sources::new(vec![line; 5000])] {
        let refused = tracer.trace(&light, &TraceSettings::default()).unwrap_err();
        assert!(matches!(refused, OpticsError::Memory { .. }), "{refused:?}");
        let text = refused.to_string();
        assert!(text.starts_with("the segments of ") && text.contains(" rays cannot be kept: "), "{text}");
    }
}

#[test]
fn results_do_not_depend_on_threads() {
    let (crown, flint) = doublet();
    let rough = Element::transparent("flint", flint, &glass(1.62)).finish(Finish::Rough { slope: 0.05 });
    let system = Assembly::new()
        .add(Element::transparent("crown", crown, &glass(1.5168)))
        .add(rough)
        .compile()
        .unwrap();
    let beam: Beam = disk(10_000, 11.0).map(|[x, y]| along_z(x, y)).collect();
    let with = |threads| {
        let settings = TraceSettings {
            branches: Branches::Random,
            polarised: true,
            threads: NonZeroUsize::new(threads),
            ..TraceSettings::default()
        };
        trace(&system, &beam, &settings)
    };
    let single = with(1);
    assert!(is_same(&single, &with(2)));
    assert!(is_same(&single, &with(3)));
    assert!(single.segments.len() > 3 * 9000);
}

#[test]
fn bundled_rays_equal_single_rays_bit_for_bit() {
    let lens = ball(50.0).translate(Vec3::Z * 46.0) & ball(60.0).translate(Vec3::Z * -56.0) & rod(15.0, 20.0);
    let turned = lens.rotate(Vec3::new(0.3, -0.5, 0.8), 11.0).translate(Vec3::new(0.3, -0.7, 1.1));
    let system = Assembly::new().add(Element::transparent("lens", turned, &glass(1.5168))).compile().unwrap();
    let lights: Vec<Light> = disk(512, 10.0).map(|[x, y]| along_z(x, y)).collect();
    let together = trace(&system, &lights.iter().copied().collect(), &TraceSettings::default());
    for (id, light) in lights.into_iter().enumerate() {
        let alone = one(&system, light, &TraceSettings::default());
        let own = together.segments.iter().filter(|row| row.id == id as i64);
        let text = |row: Segment| format!("{:?}", Segment { id: 0, parent: 0, ..row });
        assert_eq!(alone.into_iter().map(text).collect::<Vec<_>>(), own.map(text).collect::<Vec<_>>());
    }
}

#[test]
fn ends_alone_are_the_last_rows_of_all() {
    let (crown, flint) = doublet();
    let system = Assembly::new()
        .add(Element::transparent("crown", crown, &glass(1.5168)))
        .add(Element::transparent("flint", flint, &glass(1.62)))
        .add(Element::sheet("screen", plane(60.0, 60.0), Action::Absorb))
        .compile()
        .unwrap();
    let beam: Beam = disk(5000, 14.0).map(|[x, y]| along_z(x, y)).collect();
    for branches in [Branches::Ideal, Branches::Both] {
        let settings = TraceSettings { branches, threshold: 1e-3, ..TraceSettings::default() };
        let all = trace(&system, &beam, &settings);
        let ends = trace(&system, &beam, &TraceSettings { keep: Keep::Ends, ..settings });
        let mut goes_on = vec![false; all.segments.len()];
        all.segments.parent.iter().filter(|&&row| row >= 0).for_each(|&row| goes_on[row as usize] = true);
        let is_last = |row: &Segment| [Event::Absorbed, Event::Escaped].contains(&row.event);
        let last = all.segments.iter().zip(&goes_on).filter(|(row, goes_on)| is_last(row) && !**goes_on);
        let bare = |row: Segment| format!("{:?}", Segment { parent: -1, ..row });
        let mut expected: Vec<String> = last.map(|(row, _)| bare(row)).collect();
        let found = ends.segments.iter().filter(is_last);
        let mut found: Vec<String> = found.map(bare).collect();
        expected.sort();
        found.sort();
        assert!(expected.len() >= 5000 && expected == found, "{} {}", expected.len(), found.len());
        assert_eq!(all.balance, ends.balance);
    }
}

#[test]
fn errors_name_the_problem() {
    let message = |found: Result<System, OpticsError>| found.unwrap_err().to_string();
    let lens = || Element::transparent("lens", ball(1.0), &glass(1.5));
    assert_eq!(
        message(Assembly::new().add(lens()).add(lens()).compile()),
        "two elements are called `lens`: element names must be unique, since results refer to them. Rename one of them."
    );
    assert_eq!(
        message(Assembly::new().add(lens().face("frnt", Finish::Absorber)).compile()),
        "element `lens` has no face `frnt`: its faces are lens.side."
    );
    let half = lens().finish(Finish::Mirror { reflectance: 1.5 });
    assert_eq!(
        message(Assembly::new().add(half).compile()),
        "reflectance of `lens` is 1.5: it must be from 0 to 1."
    );
    let crown = Element::transparent("crown", ball(1.0), &Medium::glass("N-BK7").unwrap());
    let ultraviolet = Beam::from_iter([Light { wavelength_nm: 250.0, ..along_z(0.0, 0.0) }]);
    let system = Assembly::new().add(crown).compile().unwrap();
    assert_eq!(
        Tracer::new(&system, Packets::new)
            .trace(&ultraviolet, &TraceSettings::default())
            .unwrap_err()
            .to_string(),
        "ray 0 has a wavelength of 250 nm: the index of `N-BK7` is known from 300 nm to 2500 nm."
    );
    let system = Assembly::new().add(lens()).compile().unwrap();
    let tracer = Tracer::new(&system, Packets::new);
    let problem = |bad: Light| {
        let lights = (0..3000).map(|k| if k == 2500 { bad } else { along_z(0.0, 0.0) });
        tracer.trace(&lights.collect::<Beam>(), &TraceSettings::default()).unwrap_err().to_string()
    };
    let good = along_z(0.0, 0.0);
    assert_eq!(
        problem(Light { power: f64::NAN, ..good }),
        "power[2500] is NaN: it must be at least 0 and finite."
    );
    assert_eq!(
        problem(Light { wavelength_nm: 0.0, ..good }),
        "wavelength_nm[2500] is 0: it must be greater than 0 and finite."
    );
    assert!(problem(Light::new(Vec3::ZERO, Vec3::ZERO, D_NM)).starts_with("ray 2500: the direction is zero"));
}
