//! Images of surfaces under affine maps, and their bounding boxes.

mod oracle;

use oracle::*;
use rand::RngExt;
use rand::rngs::ChaCha8Rng;
use rayweave_math::{Affine, Mat3, Transform, Vec3};
use rayweave_shape::surface::Surface;

fn paraboloid(w: f64) -> Surface {
    let form = Mat3::from_diagonal(Vec3::new(1.0, w, 0.0));
    Surface::quadric_about(Vec3::ZERO, form, Vec3::new(0.0, 0.0, -2.0), 0.0)
}

fn surfaces() -> Vec<Surface> {
    let form = Mat3::from_diagonal(Vec3::new(1.0, 0.5, -0.25));
    vec![
        Surface::plane(Vec3::new(1.0, 2.0, -0.5), 0.3),
        Surface::sphere(Vec3::new(0.1, 0.2, 0.3), 0.8),
        Surface::cylinder(Vec3::X, Vec3::new(0.1, 1.0, 1.0), 0.4),
        Surface::cone(Vec3::Y, Vec3::new(1.0, 0.0, 1.0), 0.6),
        Surface::quadric_about(Vec3::Z, form, 0.2 * Vec3::X, -0.5),
        paraboloid(0.5),
        Surface::torus(Vec3::X, Vec3::new(0.2, -1.0, 0.4), 0.9, 0.3),
        Surface::torus(Vec3::X, Vec3::Z, 0.3, 0.5),
    ]
}

fn random_map(rng: &mut ChaCha8Rng) -> Affine {
    let shear = Mat3::from_cols(Vec3::X, Vec3::new(rng.random_range(-2.0..2.0), 1.0, 0.3), Vec3::Z);
    let factors = Vec3::ZERO.map(|_| size(rng, 0.05, 5.0) * if rng.random() { 1.0 } else { -1.0 });
    Affine::rotation(unit_vector(rng), rng.random_range(0.0..360.0))
        .then(&Affine::scale(factors))
        .then(&Affine::from_linear(shear))
        .then(&Affine::rotation(unit_vector(rng), rng.random_range(0.0..360.0)))
        .then(&Affine::translate(3.0 * unit_vector(rng)))
}

fn similarity(rng: &mut ChaCha8Rng) -> Affine {
    Affine::rotation(unit_vector(rng), rng.random_range(0.0..360.0))
        .then(&Affine::mirror(unit_vector(rng)))
        .then(&Affine::scale(Vec3::splat(size(rng, 1e-6, 1e6))))
        .then(&Affine::translate(3.0 * unit_vector(rng)))
}

/// Asserts that a point is inside the surface if and only if its image is inside the image.
fn check_image(surface: &Surface, maps: &[Affine], rng: &mut ChaCha8Rng) -> Surface {
    let mut image = surface.clone();
    let mut whole = Affine::IDENTITY;
    for map in maps {
        image = image.transformed(&Transform::from_affine(*map).unwrap());
        whole = whole.then(map);
    }
    for _ in 0..100 {
        let p = surface.anchor() + 2.0 * rng.random_range(0.0..1.0) * unit_vector(rng);
        let (value, gradient) = surface.value_and_gradient(p);
        if value.abs() > 1e-9 * gradient.length() {
            let there = image.value_and_gradient(whole.point(p)).0;
            assert_eq!(value < 0.0, there < 0.0, "{surface:?}\n{image:?}\n{p}");
        }
    }
    image
}

#[test]
fn inside_stays_inside_under_any_map() {
    let mut rng = rng(41);
    for surface in surfaces() {
        for _ in 0..100 {
            let image = check_image(&surface, &[random_map(&mut rng)], &mut rng);
            assert!(image.is_finite());
            let moves = [random_map(&mut rng), similarity(&mut rng), random_map(&mut rng)];
            check_image(&surface, &moves, &mut rng);
        }
    }
}

#[test]
fn similarities_keep_the_kind_and_the_identity_all_bits() {
    let mut rng = rng(42);
    for surface in surfaces() {
        assert_eq!(surface.transformed(&Transform::IDENTITY), surface);
        for _ in 0..30 {
            let image = check_image(&surface, &[similarity(&mut rng)], &mut rng);
            assert_eq!(std::mem::discriminant(&image), std::mem::discriminant(&surface));
        }
    }
}

/// Scaling along the axis keeps cylinders and cones circular: such images share their faces with plain ones.
#[test]
fn a_stretch_along_the_axis_keeps_the_kind() {
    let mut rng = rng(14);
    for round in 0..200 {
        let turn = Affine::rotation(unit_vector(&mut rng), if round % 2 == 0 { 0.0 } else { 77.0 });
        let (along, across) = (size(&mut rng, 0.25, 4.0), size(&mut rng, 0.25, 4.0));
        let maps = [Affine::scale(Vec3::new(across, -across, along)).then(&turn)];
        let cylinder = check_image(&Surface::cylinder(Vec3::X, Vec3::Z, 0.4), &maps, &mut rng);
        let Surface::Cylinder(c) = cylinder else { panic!("{cylinder:?} is not a cylinder") };
        assert!((c.radius - 0.4 * across).abs() <= 1e-15 * across, "{c:?}");
        let cone = check_image(&Surface::cone(Vec3::Y, Vec3::Z, 0.5), &maps, &mut rng);
        let Surface::Cone(c) = cone else { panic!("{cone:?} is not a cone") };
        assert!((c.slope - 0.5 * across / along).abs() <= 1e-14 * c.slope, "{c:?}");
        // any other scaling makes them elliptic
        let other = [Affine::scale(Vec3::new(across, 1.001 * across, along)).then(&turn)];
        for surface in [Surface::cylinder(Vec3::X, Vec3::Z, 0.4), Surface::cone(Vec3::Y, Vec3::Z, 0.5)] {
            let image = check_image(&surface, &other, &mut rng);
            assert!(matches!(image, Surface::Quadric(_)), "{image:?}");
        }
    }
}

#[test]
fn a_stretch_undone_gives_back_a_torus() {
    let scaling = Affine::scale(Vec3::new(2.0, 1.0, 0.5));
    let torus = Surface::torus(Vec3::X, Vec3::Z, 2.0, 0.5);
    let there = torus.transformed(&Transform::from_affine(scaling).unwrap());
    assert!(matches!(there, Surface::AffineTorus(_)));
    let back = there.transformed(&Transform::from_affine(scaling.inverse().unwrap()).unwrap());
    let Surface::Torus(back) = back else {
        panic!("a torus, not {back:?}");
    };
    assert_eq!((back.axis, back.major, back.minor), (Vec3::Z, 2.0, 0.5));
    assert!((back.centre - Vec3::X).length() < 4e-16);
}

/// A long thin ellipsoid far from the axes keeps its ends: half axes 1 and 1e-6, at any rotation.
#[test]
fn needles_keep_their_ends() {
    let mut rng = rng(43);
    for _ in 0..200 {
        let turn = Affine::rotation(unit_vector(&mut rng), rng.random_range(0.0..360.0));
        let map = Affine::scale(Vec3::new(1e-6, 1e-6, 1.0)).then(&turn);
        let needle = Surface::sphere(Vec3::ZERO, 1.0).transformed(&Transform::from_affine(map).unwrap());
        let end = map.vector(Vec3::Z);
        for tip in [end, -end] {
            let (value, gradient) = needle.value_and_gradient(tip);
            assert!(value.abs() <= 4e-15 * gradient.length(), "{value} {needle:?}");
        }
        let half = needle.inside_bounds().hi;
        let wanted = Vec3::from_array([0, 1, 2].map(|k| {
            let row = map.linear.row(k);
            row.length()
        }));
        assert!((half - wanted).abs().max_element() < 2e-15, "{half} {wanted}");
    }
}

#[test]
fn boxes_hold_the_inside_and_touch_it() {
    let mut rng = rng(44);
    for surface in surfaces() {
        for _ in 0..60 {
            let map = random_map(&mut rng);
            let image = surface.transformed(&Transform::from_affine(map).unwrap());
            let bounds = image.inside_bounds();
            for _ in 0..200 {
                let p = surface.anchor() + 3.0 * rng.random_range(0.0..1.0) * unit_vector(&mut rng);
                if surface.value_and_gradient(p).0 < 0.0 {
                    let there = map.point(p);
                    assert!(bounds.grown(1e-12).contains(there), "{image:?}\n{there} {bounds:?}");
                }
            }
            check_touched(&image, &mut rng);
        }
    }
}

/// Asserts that a face of the box, moved slightly inwards, cuts the inside; found by a walk along the surface.
fn check_touched(surface: &Surface, rng: &mut ChaCha8Rng) {
    let bounds = surface.inside_bounds();
    if !bounds.is_finite() {
        return;
    }
    let (centre, size) = (bounds.centre(), bounds.size());
    for k in 0..3 {
        let mut best = f64::NEG_INFINITY;
        for _ in 0..4000 {
            let start = centre + 0.5 * size * Vec3::ZERO.map(|_| rng.random_range(-1.0..1.0));
            let (value, _) = surface.value_and_gradient(start);
            if value < 0.0 {
                best = best.max(start[k]);
            }
        }
        let ray = rayweave_shape::Ray::new(centre, Vec3::AXES[k]);
        let magnitude = surface.crossings(&ray).times().last().map_or(best, |t| centre[k] + t);
        assert!(best.max(magnitude) > centre[k] - 0.1 * size[k] && best <= bounds.hi[k]);
    }
}

#[test]
fn boxes_of_standard_surfaces() {
    let inf = f64::INFINITY;
    let same = |surface: &Surface, lo: Vec3, hi: Vec3| {
        let bounds = surface.inside_bounds();
        for (got, want) in [(bounds.lo, lo), (bounds.hi, hi)] {
            for k in 0..3 {
                let equal = got[k] == want[k] || (got[k] - want[k]).abs() < 1e-14;
                assert!(equal, "{surface:?}: {bounds:?}");
            }
        }
    };
    let v = Vec3::new;
    same(&Surface::plane(Vec3::Z, 2.0), v(-inf, -inf, -inf), v(inf, inf, 2.0));
    same(&Surface::plane(-Vec3::X, 2.0), v(-2.0, -inf, -inf), v(inf, inf, inf));
    same(&Surface::cylinder(Vec3::X, Vec3::Z, 2.0), v(-1.0, -2.0, -inf), v(3.0, 2.0, inf));
    same(&Surface::cone(Vec3::X, Vec3::Z, 2.0), Vec3::splat(-inf), Vec3::splat(inf));
    same(&paraboloid(1.0), v(-inf, -inf, 0.0), v(inf, inf, inf));
    same(&Surface::torus(Vec3::X, Vec3::Z, 2.0, 0.5), v(-1.5, -2.5, -0.5), v(3.5, 2.5, 0.5));
    let half = 0.5 * 3f64.sqrt();
    let tilted = Surface::torus(Vec3::ZERO, v(0.5, 0.0, half), 2.0, 0.5);
    same(&tilted, v(-2.0 * half - 0.5, -2.5, -1.5), v(2.0 * half + 0.5, 2.5, 1.5));
    let form = |x, y, z| Mat3::from_diagonal(v(x, y, z));
    let ball = |f, c| Surface::quadric_about(Vec3::ZERO, f, Vec3::ZERO, c);
    same(&ball(form(1.0, 4.0, 16.0), -4.0), v(-2.0, -1.0, -0.5), v(2.0, 1.0, 0.5));
    same(&ball(form(-1.0, -4.0, -16.0), 4.0), Vec3::splat(-inf), Vec3::splat(inf));
    same(&ball(form(0.0, 4.0, 16.0), -4.0), v(-inf, -1.0, -0.5), v(inf, 1.0, 0.5));
    same(&ball(form(0.0, 4.0, 0.0), -4.0), v(-inf, -1.0, -inf), v(inf, 1.0, inf));
    assert!(ball(form(1.0, 4.0, 16.0), 4.0).inside_bounds().is_empty());
    assert!(ball(form(0.0, 4.0, 0.0), 4.0).inside_bounds().is_empty());
    // z > x^2 + y^2, tilted by 45 degrees: the lowest point is where the slope is 1
    let turn = Affine::rotation(Vec3::Y, 45.0);
    let bowl = Surface::quadric_about(Vec3::ZERO, form(1.0, 1.0, 0.0), v(0.0, 0.0, -1.0), 0.0);
    let bounds = bowl.transformed(&Transform::from_affine(turn).unwrap()).inside_bounds();
    let lowest = -0.25 * 0.5f64.sqrt();
    assert!((bounds.lo.x - lowest).abs() < 1e-15 && (bounds.lo.z - lowest).abs() < 1e-15);
    assert_eq!((bounds.lo.y, bounds.hi), (-inf, Vec3::splat(inf)));
}

#[test]
fn general_quadrics_find_their_centre() {
    let place = Vec3::new(1e4, -2e3, 5.0);
    // |p - place|^2 < 4
    let mut q = [[0.0; 4]; 4];
    for k in 0..3 {
        q[k][k] = 1.0;
        (q[k][3], q[3][k]) = (-place[k], -place[k]);
    }
    q[3][3] = place.length_squared() - 4.0;
    let Some(Surface::Quadric(ball)) = Surface::quadric(&q) else {
        panic!("a quadric");
    };
    assert_eq!((ball.centre, ball.linear), (place, Vec3::ZERO));
    assert!((ball.constant + 4.0).abs() < 1e-7);
    // only the symmetric part counts: 2 x y + 2 z = 0, a saddle
    let mut q = [[0.0; 4]; 4];
    (q[0][1], q[3][2]) = (2.0, 2.0);
    let saddle = Surface::quadric(&q).unwrap();
    for p in [Vec3::new(1.0, 2.0, -3.0), Vec3::new(0.3, 0.7, 0.1)] {
        let (value, gradient) = saddle.value_and_gradient(p);
        let (want, slope) = (2.0 * p.x * p.y + 2.0 * p.z, Vec3::new(2.0 * p.y, 2.0 * p.x, 2.0));
        let scale = gradient.length() / slope.length();
        assert!((value - scale * want).abs() < 1e-14 && (gradient - scale * slope).length() < 1e-14);
    }
    // without quadratic terms: a plane; constant: no surface
    let mut q = [[0.0; 4]; 4];
    (q[1][3], q[3][1], q[3][3]) = (1.0, 1.0, -6.0);
    assert_eq!(Surface::quadric(&q), Some(Surface::plane(Vec3::Y, 3.0)));
    let mut q = [[0.0; 4]; 4];
    q[3][3] = 1.0;
    assert_eq!(Surface::quadric(&q), None);
    q[0][0] = f64::NAN;
    assert_eq!(Surface::quadric(&q), None);
}
