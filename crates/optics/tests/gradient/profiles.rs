//! Each kind of gradient against its closed form.

use crate::{D_NM, ball, block, close, directions, graded, near, one, plane, rod, trace};
use rayweave_math::Vec3;
use rayweave_optics::gradient::{Gradient, IndexField, IndexGrid};
use rayweave_optics::{
    Action, Assembly, Beam, Element, Event, Light, Medium, Segment, System, TraceSettings,
};
use std::sync::Arc;

const N0: f64 = 1.6;
const G: f64 = 0.25;

/// A rod of the given length in vacuum.
fn selfoc(length: f64) -> System {
    let medium = graded(N0, Gradient::selfoc(G).unwrap());
    Assembly::new().add(Element::transparent("rod", rod(2.0, length), &medium)).compile().unwrap()
}

/// x0 cos + u0 / w sin, its derivative, and the integral of its square.
fn oscillation(x0: f64, u0: f64, w: f64, t: f64) -> [f64; 3] {
    let (s, c) = (w * t).sin_cos();
    let double = (2.0 * w * t).sin() / (2.0 * w);
    let square =
        0.5 * x0 * x0 * (t + double) + 0.5 * (u0 / w).powi(2) * (t - double) + x0 * u0 / (w * w) * s * s;
    [x0 * c + u0 / w * s, u0 * c - w * x0 * s, square]
}

/// Light through the flat ends of a rod: `x'' = -(n0 g)^2 x` in tau, and z grows linearly.
/// Refraction conserves the component of n times the direction along a flat face.
#[test]
fn selfoc_rods_follow_sines() {
    let length = 17.0;
    let system = selfoc(length);
    for (x, y, slope) in [(0.3, 0.0, 0.0), (0.5, -0.4, 0.1), (0.0, 0.8, -0.2), (0.1, 0.2, 0.3)] {
        let d = Vec3::new(slope, -0.5 * slope, 1.0).normalize();
        let rows = one(&system, Light::new(Vec3::new(x, y, 0.0) - 5.0 * d, d, D_NM));
        let w = N0 * G;
        let forwards = (N0 * N0 * (1.0 - G * G * (x * x + y * y)) - d.x * d.x - d.y * d.y).sqrt();
        let t = length / forwards;
        let ([x1, u1, xx], [y1, v1, yy]) = (oscillation(x, d.x, w, t), oscillation(y, d.y, w, t));
        let last = rows[rows.len() - 1];
        close(last.start, Vec3::new(x1, y1, length), 2e-13);
        close(last.direction, Vec3::new(u1, v1, (1.0 - u1 * u1 - v1 * v1).sqrt()), 2e-13);
        near(last.path, 5.0 + N0 * N0 * t - w * w * (xx + yy), 1e-12);
        assert_eq!(rows[1..rows.len() - 2].iter().filter(|row| row.event != Event::Curved).count(), 0);
        assert!(rows.windows(2).all(|pair| pair[0].end == pair[1].start));
    }
}

/// Rays near the axis cross it a quarter of a pitch, pi / (2 g), from the flat end.
#[test]
fn a_quarter_pitch_focuses() {
    let quarter = std::f64::consts::FRAC_PI_2 / G;
    let system = selfoc(quarter);
    for height in [1e-3, -1e-4] {
        let rows = one(&system, Light::new(Vec3::new(height, 0.0, -1.0), Vec3::Z, D_NM));
        let last = rows[rows.len() - 1];
        // of third order in the height
        near(last.start.x, 0.0, 0.1 * height.abs().powi(3));
        near(last.direction.x, -N0 * G * height, 0.1 * height.abs().powi(3));
    }
}

fn spherical(gradient: Gradient, index: f64, radius: f64) -> Assembly {
    Assembly::new().add(Element::transparent("ball", ball(radius), &graded(index, gradient)))
}

/// Born & Wolf, section 4.2.2: paths are circles through a point and its image, all of the same optical length, pi n0 a.
#[test]
fn fish_eyes_image_every_point() {
    let index = 3.0;
    let gradient = Gradient::fish_eye(1.0).unwrap();
    let screen = Element::sheet("screen", crate::plane(0.0, 12.0), Action::Record);
    let system = spherical(gradient, index, 5.0).add(screen).compile().unwrap();
    let source = Vec3::new(0.5, 0.0, 0.0);
    let image = Vec3::new(-2.0, 0.0, 0.0);
    let steep = directions(400).filter(|d| d.z.abs() > 0.5);
    let mut count = 0;
    for d in steep {
        // light circulates for ever
        let settings = TraceSettings { generation_limit: 4, ..TraceSettings::default() };
        let found = trace(&system, &Beam::from_iter([Light::new(source, d, D_NM)]), &settings);
        let rows: Vec<Segment> = found.segments.iter().collect();
        let met = rows.iter().find(|row| row.event == Event::Passed && row.path > 1.0).unwrap();
        close(met.end, image, 3e-12);
        near(met.path, std::f64::consts::PI * index, 3e-12);
        // the centre of the circle through both: all points of the circle are as far from it as the
        // source
        let across = d.cross(image - source).normalize();
        let normal = across.cross(d);
        let centre = source + normal * (0.5 * (image - source).length_squared() / normal.dot(image - source));
        for row in rows.iter().filter(|row| row.path <= met.path) {
            near((row.end - centre).length(), (source - centre).length(), 5e-12);
        }
        count += 1;
    }
    assert!(count > 150);
}

/// Luneburg, section 29: parallel light converges on the far side; all paths from the plane in
/// front of the lens have the length a (1 + pi / 2).
#[test]
fn luneburg_lenses_focus_parallel_light() {
    let a = 4.0;
    let system = spherical(Gradient::luneburg(a).unwrap(), 1.0, a).compile().unwrap();
    for k in 1..40 {
        let height = 0.1 * f64::from(k);
        let light = Light::new(Vec3::new(0.6 * height, 0.8 * height, -a), Vec3::Z, D_NM);
        let rows = one(&system, light);
        let last = rows[rows.len() - 1];
        close(last.start, Vec3::Z * a, 2e-12);
        near(last.path, a * (1.0 + std::f64::consts::FRAC_PI_2), 2e-12);
    }
}

/// In n = c0 + c1 z, the component u of n times the direction perpendicular to z is conserved, and
/// x grows by the integral of u / sqrt(n^2 - u^2), which is u / c1 arcosh(n / u).
#[test]
fn axial_gradients_keep_the_invariant_of_snell() {
    let (c0, c1, thickness) = (1.5, 0.04, 6.0);
    let medium = graded(1.0, Gradient::axial(&[c0, c1]).unwrap());
    let slab = block(40.0, 40.0, thickness).translate(Vec3::Z * (0.5 * thickness));
    let system = Assembly::new().add(Element::transparent("slab", slab, &medium)).compile().unwrap();
    for degrees in [1.0_f64, 20.0, 50.0, 80.0] {
        let (u, c) = degrees.to_radians().sin_cos();
        let d = Vec3::new(0.6 * u, 0.8 * u, c);
        let rows = one(&system, Light::new(-3.0 * d, d, D_NM));
        let last = rows[rows.len() - 1];
        close(last.direction, d, 5e-14);
        let moved = u / c1 * (((c0 + c1 * thickness) / u).acosh() - (c0 / u).acosh());
        close(last.start, Vec3::new(0.6 * moved, 0.8 * moved, thickness), 2e-12);
        for row in &rows[1..rows.len() - 1] {
            near(row.index, c0 + c1 * row.end.z, 1e-14);
            near(row.index * row.direction.truncate().length(), u, 1e-14);
        }
    }
}

/// Bouguer's theorem: n r sin(phi) is conserved in every spherically symmetric field (Born & Wolf,
/// section 3.2.1, equation 7).
#[test]
fn spherical_gradients_keep_the_invariant_of_bouguer() {
    #[derive(Debug)]
    struct Onion;
    impl IndexField for Onion {
        fn at(&self, point: Vec3, _: f64) -> (f64, Vec3) {
            let square = point.length_squared();
            let wave = 0.3 * (3.0 * square).cos();
            (1.6 + wave, -1.8 * (3.0 * square).sin() * point)
        }
    }
    let gradient = Gradient::own(Arc::new(Onion));
    let system = spherical(gradient, 1.0, 1.5).compile().unwrap();
    for (k, d) in directions(60).enumerate() {
        let aim = Vec3::new(0.4, 0.02 * k as f64, -0.3);
        let light = Light::new(aim - 4.0 * d, d, D_NM);
        let invariant = |row: &Segment| row.index * row.end.cross(row.direction).length();
        let rows = one(&system, light);
        let wanted = light.ray.origin.cross(d).length();
        assert!(rows.len() > 4, "{k}");
        for row in rows.iter().filter(|row| row.end.is_finite()) {
            near(invariant(row), wanted, 3e-13);
        }
    }
}

/// The same fish-eye from its formula and from values on finer and finer grids: the error of a
/// direction falls like that of the slopes, with the third power of the spacing.
#[test]
fn grids_converge_to_the_sampled_profile() {
    let formula = Gradient::fish_eye(3.0).unwrap();
    let index = |p: Vec3| 2.0 / (1.0 + p.length_squared() / 9.0);
    let grid = |count: usize| {
        let spacing = 4.0 / (count as f64 - 1.0);
        let place = |k: usize| -2.0 + spacing * k as f64;
        let mut values = Vec::new();
        for z in 0..count {
            for y in 0..count {
                values.extend((0..count).map(|x| index(Vec3::new(place(x), place(y), place(z)))));
            }
        }
        let grid = IndexGrid::new([count; 3], Vec3::splat(-2.0), Vec3::splat(spacing), &values);
        Gradient::sampled(grid.unwrap())
    };
    let last = |gradient: Gradient| {
        let system = spherical(gradient, 1.0, 0.9).compile().unwrap();
        let light = Light::new(Vec3::new(0.4, -0.2, -3.0), Vec3::new(0.02, 0.05, 1.0), D_NM);
        let rows = one(&system, light);
        rows[rows.len() - 1].direction
    };
    let wanted = last(formula);
    let off = [17, 33].map(|count| (last(grid(count)) - wanted).length());
    assert!(off[0] < 1e-5 && off[1] < off[0] / 6.0, "{off:?}");
}

/// The index of the medium multiplies the gradient, so that each colour follows its own path.
#[test]
fn gradients_have_the_dispersion_of_their_medium() {
    let glass = Medium::glass("N-BK7").unwrap();
    let medium = glass.clone().graded(Gradient::selfoc(G).unwrap());
    let rod = Element::transparent("rod", rod(2.0, 9.0), &medium);
    let screen = Element::sheet("screen", plane(5.0, 4.0), Action::Record);
    let system = Assembly::new().add(rod).add(screen).compile().unwrap();
    for wavelength_nm in [486.1327, 656.2725] {
        let n0 = glass.index(wavelength_nm).re;
        let d = Vec3::new(0.3, 0.0, 1.0).normalize();
        let rows = one(&system, Light::new(-2.0 * d, d, wavelength_nm));
        let t = 5.0 / (n0 * n0 - d.x * d.x).sqrt();
        let met = rows.iter().find(|row| row.event == Event::Passed).unwrap();
        close(met.end, Vec3::new(d.x / (n0 * G) * (n0 * G * t).sin(), 0.0, 5.0), 1e-13);
        near(met.index, n0 * (1.0 - G * G * met.end.x.powi(2)).sqrt(), 1e-14);
    }
}
