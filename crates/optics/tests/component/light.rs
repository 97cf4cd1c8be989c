//! Components and sources together, with light: foci, deviations, and fractions of the power
//! against closed forms.

use crate::probe::assert_close;
use rayweave_math::{Affine, Vec3};
use rayweave_model::Solid;
use rayweave_optics::component::*;
use rayweave_optics::source::*;
use rayweave_optics::{
    Action, Assembly, Beam, Element, Emitter, Light, Medium, System, TraceSettings, Tracer,
};
use rayweave_trace::Packets;

const INF: f64 = f64::INFINITY;

/// Solids of one glass in vacuum.
fn of_glass(solids: &[Solid], index: f64) -> System {
    let glass = Medium::constant("glass", index, 0.0).unwrap();
    let add = |assembly: Assembly, (k, solid): (usize, &Solid)| {
        assembly.add(Element::transparent(&k.to_string(), solid.clone(), &glass))
    };
    solids.iter().enumerate().fold(Assembly::new(), add).compile().unwrap()
}

/// The last position and direction of light that starts at (x, y, -500) along z.
fn last(system: &System, x: f64, y: f64) -> (Vec3, Vec3) {
    let light = Light::new([x, y, -500.0], [0.0, 0.0, 1.0], 587.6);
    let trace = Tracer::new(system, Packets::new)
        .trace(&Beam::from_iter([light]), &TraceSettings::default())
        .unwrap();
    let row = trace.segments.iter().last().unwrap();
    (row.start, row.direction)
}

/// The focal length found from a ray near the axis is that of the lensmaker's equation, up to the square of the
/// height.
#[test]
fn lensmakers() {
    let (index, height) = (1.5168, 1e-3);
    for (r1, r2, thickness) in [
        (50.0, -80.0, 6.0),
        (INF, -30.0, 4.0),
        (-40.0, 60.0, 2.0),
        (20.0, 35.0, 5.0),
        (-25.0, -15.0, 3.0),
        (8.0, -8.0, 16.0),
    ] {
        let solid = lens(r1, r2, thickness, Aperture::circle(10.0)).unwrap();
        let (_, direction) = last(&of_glass(&[solid], index), 0.0, height);
        let focal_length = -height * direction.z / direction.y;
        let exact = lensmaker(r1, r2, index, thickness).unwrap();
        assert_close(focal_length / exact, 1.0, 1e-7);
    }
}

/// A plano-convex lens whose back is a hyperboloid with k = -n^2 has a perfect focus at R / (n - 1) behind its vertex; one
/// whose front is an ellipsoid with k = -1/n^2 has it at n R / (n - 1), inside the glass (Descartes, *Dioptrique*, 1637).
#[test]
fn lenses_of_descartes() {
    let (index, radius) = (1.6, 20.0);
    let aperture = Aperture::circle(30.0);
    let solid = conic_lens(INF, 0.0, -radius, -index * index, 12.0, aperture).unwrap();
    let system = of_glass(&[solid], index);
    let focus = Vec3::Z * (6.0 + radius / (index - 1.0));
    let ellipsoid =
        conic_lens(radius, -1.0 / (index * index), INF, 0.0, 80.0, Aperture::circle(24.0)).unwrap();
    let long = of_glass(&[ellipsoid], index);
    let inside = Vec3::Z * (-40.0 + index * radius / (index - 1.0));
    for k in 1..=20 {
        let (sin, cos) = f64::from(k).sin_cos();
        let height = 0.74 * f64::from(k);
        let (point, direction) = last(&system, height * cos, height * sin);
        assert!(direction.cross(focus - point).length() < 1e-13 * 50.0);
        // inside the ellipsoid light is refracted once; it passes the focus before it leaves, so the
        // segment inside is tested
        let height = 0.55 * f64::from(k);
        let light = Light::new([height * cos, height * sin, -500.0], [0.0, 0.0, 1.0], 587.6);
        let trace = Tracer::new(&long, Packets::new)
            .trace(&Beam::from_iter([light]), &TraceSettings::default())
            .unwrap();
        let row = trace.segments.iter().nth(1).unwrap();
        assert!(row.direction.cross(inside - row.start).length() < 1e-13 * 80.0);
    }
}

/// A cone deviates all light by the same angle, as does a wedge: asin(n sin a) - a (Snell).
#[test]
fn axicons_and_wedges_bend_by_one_angle() {
    let (index, degrees) = (1.5, 12.0);
    let bent = (index * f64::to_radians(degrees).sin()).asin() - f64::to_radians(degrees);
    let cone = of_glass(&[axicon(degrees, 6.0, 20.0).unwrap()], index);
    let wedge = of_glass(&[wedge_prism(degrees, 6.0, Aperture::circle(20.0)).unwrap()], index);
    for k in 1..20 {
        let (sin, cos) = f64::from(k).sin_cos();
        let height = 0.5 * f64::from(k);
        let (_, direction) = last(&cone, height * cos, height * sin);
        let exact = Vec3::new(-cos * bent.sin(), -sin * bent.sin(), bent.cos());
        assert!((direction - exact).length() < 1e-14);
        let (_, direction) = last(&wedge, height * cos, height * sin);
        assert!((direction - Vec3::new(0.0, -bent.sin(), bent.cos())).length() < 1e-14);
    }
}

/// Each lenslet, a placement of one solid, has its focus r / (n - 1) behind its vertex; a ring of a
/// Fresnel lens deviates light like the whole surface at that height.
#[test]
fn fresnel_lenses_and_lenslets() {
    let (index, radius) = (1.5, 20.0);
    let array = of_glass(&[lenslet_array(radius, 2.0, 3.0, 4, 3).unwrap()], index);
    for (column, row) in (0..4).flat_map(|column| (0..3).map(move |row| (column, row))) {
        let (x, y) = (3.0 * (f64::from(column) - 1.5), 3.0 * (f64::from(row) - 1.0));
        let (point, direction) = last(&array, x + 1e-3, y - 1e-3);
        let focus = Vec3::new(x, y, 1.0 + radius / (index - 1.0));
        assert!(direction.cross(focus - point).length() < 1e-9);
    }
    let whole = of_glass(&[plano_convex(radius, 9.0, Aperture::circle(30.0)).unwrap()], index);
    let rings = of_glass(&[fresnel_lens(radius, 0.0, 1.0, 2.0, 30.0).unwrap()], index);
    for k in 0..13 {
        // in the outer part of a ring, where light towards the axis hits no step; beyond 13.3 it is
        // reflected
        let height = f64::from(k) + 0.55;
        let (_, direction) = last(&rings, 0.0, height);
        assert!((direction - last(&whole, 0.0, height).1).length() < 1e-13, "{height}");
    }
}

/// The focal lengths of a toric lens along x and y are those of the lensmaker's equation.
#[test]
fn toric_lenses_have_two_foci() {
    let (index, height) = (1.5168, 1e-3);
    for (front, back) in [([40.0, 60.0], [-90.0, -55.0]), ([30.0, -70.0], [INF, 45.0])] {
        let system = of_glass(&[toric_lens(front, back, 3.0, Aperture::circle(12.0)).unwrap()], index);
        for axis in 0..2 {
            let at = [height * f64::from(1 - axis), height * f64::from(axis)];
            let (_, direction) = last(&system, at[0], at[1]);
            let axis = axis as usize;
            let exact = lensmaker(front[axis], back[axis], index, 3.0).unwrap();
            assert_close(-height * direction.z / direction[axis] / exact, 1.0, 1e-7);
            assert_close(direction[1 - axis], 0.0, 1e-17);
        }
    }
}

/// The fraction of the power that a sheet records.
fn recorded(sheet: Sheet, source: &impl Emitter) -> f64 {
    let system = Assembly::new().add(Element::sheet("sheet", sheet, Action::Absorb)).compile().unwrap();
    let trace = Tracer::new(&system, Packets::new).trace(source, &TraceSettings::default()).unwrap();
    let rows = trace.segments.iter().filter(|row| row.element == 0);
    rows.map(|row| row.intensity).sum()
}

/// The fraction of the light of a Lambertian disc of radius a that reaches a disc of radius b at
/// the distance h on the same axis is `(x - sqrt(x^2 - 4 b^2/a^2)) / 2` with `x = 1 + (h^2 + b^2) /
/// a^2` (the view factor of parallel discs, e.g. J. R. Howell, *A Catalog of Radiation Heat
/// Transfer Configuration Factors*, C-41). PyRayT's lamp obeys the same law.
#[test]
fn view_factors() {
    let (a, b, h, count) = (3.0f64, 2.0f64, 4.0f64, 200_000);
    let x = 1.0 + (h * h + b * b) / (a * a);
    let part = 0.5 * (x - (x * x - 4.0 * b * b / (a * a)).sqrt());
    let sheet = || Sheet::plane(Aperture::circle(2.0 * b)).unwrap();
    let up = Affine::translate(Vec3::Z * h);
    let (aperture, emission) = (Aperture::circle(2.0 * a), Emission::Lambert);
    let disc = Pattern::Extended { aperture, emission, half_angle_degrees: 90.0, count };
    let source = Source::new(disc).unwrap().power(Power::Total(1.0)).unwrap();
    let found = recorded(sheet().apply(&up).unwrap(), &source);
    let deviation = (part * (1.0 - part) / count as f64).sqrt();
    assert_close(found, part, 5.0 * deviation);
    // a tiny lamp to a disc: sin^2 of its half angle
    let lamp = Pattern::Lamp { width: 1e-3, height: 1e-3, half_angle_degrees: 90.0, count };
    let lamp = Source::new(lamp).unwrap().power(Power::Total(1.0)).unwrap();
    let found = recorded(sheet().apply(&up).unwrap(), &lamp);
    assert_close(found, b * b / (b * b + h * h), 5.0 * deviation * 2.0);
}

/// All light of a point within its cone hits the curved sheet about it; for a point at the centre
/// of the sphere, the fraction within the sheet is its fraction of the cone's solid angle.
#[test]
fn spherical_sheets_about_a_point() {
    let sheet = || Sheet::spherical(-10.0, Aperture::circle(12.0)).unwrap();
    let at = Affine::translate(Vec3::Z * 10.0);
    let point = |half_angle_degrees| {
        let sampling = Sampling::Fibonacci { count: 100_000 };
        let source = Source::new(Pattern::Point { half_angle_degrees, sampling }).unwrap();
        source.power(Power::Total(1.0)).unwrap()
    };
    // the sheet extends to the angle with sine 0.6 and cosine 0.8
    assert_close(recorded(sheet().apply(&at).unwrap(), &point(36.8)), 1.0, 1e-9);
    assert_close(recorded(sheet().apply(&at).unwrap(), &point(90.0)), 0.2, 1e-4);
    assert_close(recorded(sheet().apply(&at).unwrap(), &point(180.0)), 0.1, 1e-4);
}

/// An iris of radius a transmits `1 - exp(-2 a^2 / w^2)` of a Gaussian beam.
#[test]
fn gaussian_beams_through_an_iris() {
    let (a, w) = (1.2f64, 2.0f64);
    let beam = Pattern::Beam {
        aperture: Aperture::circle(40.0),
        profile: BeamProfile::Gaussian { radius: w },
        sampling: Sampling::Fibonacci { count: 100_000 },
    };
    let source = Source::new(beam).unwrap().power(Power::Total(1.0)).unwrap();
    let source = source.apply(&Affine::translate(Vec3::Z * -5.0)).unwrap();
    let stopped = recorded(Sheet::iris(60.0, 2.0 * a).unwrap(), &source);
    assert_close(stopped, (-2.0 * a * a / (w * w)).exp(), 2e-5);
}
