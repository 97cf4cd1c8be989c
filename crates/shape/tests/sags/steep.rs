//! Unbounded second derivatives: tips of odd terms, vertical rims, and lines along both.

use super::oracle::{Sturm, approximate, effort, exact, rng, unit_vector, value};
use super::{all, along, conic, depth, plus, surface, times};
use dashu::rational::RBig;
use rand::RngExt;
use rayweave_math::{UNIT_ROUNDOFF, Vec3};
use rayweave_shape::Ray;
use rayweave_shape::surface::sag::{Base, Description, Sag};

/// A hemisphere with odd terms, and with even ones.
fn hemispheres() -> Vec<Description> {
    let odd = |list: &[f64]| Description { odd: list.to_vec(), ..conic(1.0, 1.0, 0.0) };
    vec![
        odd(&[0.25]),
        odd(&[-0.25]),
        odd(&[-0.5, 0.75]),
        odd(&[0.0, -0.5]),
        Description { even: vec![0.0, -0.25, 0.125], ..odd(&[0.5, -0.25]) },
        Description { odd: vec![0.5], ..conic(1.0, -1.0, 0.0) },
        Description { odd: vec![-0.75], ..conic(1.0, 0.0, 0.0) },
    ]
}

/// A line along the axis, or nearly so within rounding, crosses the surface once: at its vertex, up to the offset of the
/// line.
#[test]
fn lines_along_the_axis_meet_the_vertex() {
    let offsets = [0.0, 1e-300, 1e-17, 1e-9];
    for of in hemispheres() {
        let surface = surface(&of);
        for (x, y, tilt) in offsets.iter().flat_map(|&x| offsets.map(|y| (x, y)).map(|(x, y)| (x, y, x + y)))
        {
            for direction in [Vec3::Z, -Vec3::Z, Vec3::new(tilt, -tilt, 1.0), Vec3::new(-tilt, tilt, -1.0)] {
                let (starts, times) = all(&surface, &Ray::new(Vec3::new(x, y, -2.0), direction));
                assert_eq!((starts, times.len()), (direction.z > 0.0, 1), "{of:?} {x} {y} {direction:?}");
                let off = (times[0].abs() - 2.0).abs();
                assert!(off <= 4.0 * (x + y + tilt) + 4.0 * UNIT_ROUNDOFF, "{off} {of:?} {x} {y}");
            }
        }
    }
}

/// A line through the tip of a cone, or past it at a tiny distance, to both sides of the slope.
#[test]
fn lines_past_the_tip_of_a_cone_meet_it_as_often_as_they_must() {
    let cone = |slope: f64| surface(&Description { odd: vec![slope], ..conic(1.0, 0.0, 0.0) });
    for offset in [0.0, 1e-300, 1e-17, 1e-9] {
        for height in [1e-3, 1e-12, -1e-3, -1e-12] {
            let level = Ray::new(Vec3::new(-3.0, offset, height), Vec3::X);
            let (starts, times) = all(&cone(0.5), &level);
            // z = r / 2, level beyond r = 1: no surface above the rim
            let expected =
                if height > 0.5 * offset { vec![3.0 - 2.0 * height, 3.0 + 2.0 * height] } else { vec![] };
            assert!(starts, "{offset} {height}");
            assert_eq!(times.len(), expected.len(), "{offset} {height} {times:?}");
            for (t, expected) in times.iter().zip(expected) {
                // r = 2 z is as far along the line as the offset allows
                assert!((t - expected).abs() <= 2.0 * offset + 4e-15, "{offset} {height} {t}");
            }
        }
    }
}

/// Lines that touch a vertical rim from inside: both ends of the remaining chord are crossings, or neither is.
#[test]
fn lines_along_a_vertical_rim_are_decided_to_its_last_bits() {
    for of in hemispheres() {
        let surface = surface(&of);
        let rim = -depth(&of, Vec3::new(1.0, 0.0, 0.0));
        for inset in [0.0, 1e-16, 1e-15, 1e-12, 1e-8, 1e-4] {
            for rise in [0.0, 1e-9, 1e-3, 1.0, 1e9] {
                let direction = Vec3::new(0.0, 1.0, rise);
                let ray = Ray::new(Vec3::new(1.0 - inset, 0.0, rim), direction);
                let (starts, times) = all(&surface, &ray);
                let parity = times.len() % 2 == 1;
                assert!(
                    times.len() <= 4 && (rise == 0.0 || (starts && parity)),
                    "{of:?} {inset} {rise} {times:?}"
                );
                for &t in &times {
                    let p = ray.at(t);
                    // near the rim a rounding of r becomes its square root in z
                    let s = (1.0 - p.truncate().length_squared()).abs().sqrt();
                    let across = UNIT_ROUNDOFF / s.max(1e-8);
                    let off = depth(&of, p).abs();
                    assert!(
                        off <= 32.0 * (across + UNIT_ROUNDOFF * (1.0 + t.abs() * rise)),
                        "{off} {of:?} {inset} {rise}"
                    );
                }
            }
        }
    }
}

/// Rounds to 12 bits, to keep exact arithmetic fast.
fn few_bits(x: f64) -> f64 {
    f64::from_bits(x.to_bits() & !((1 << 41) - 1))
}

/// Number of crossings along a line for a conic base with even and odd terms, without a search along the line. With the
/// base's root s, `c s = M + g r O` where `M = c - g L`, and L is z minus the even terms. Squared twice, this is a
/// polynomial; its roots are isolated by Sturm's theorem and kept if both square roots have the right sign. `None` if a
/// sign is undecided.
fn crossings_by_algebra(of: &Description, ray: &Ray, raise: f64, window: (f64, f64)) -> Option<usize> {
    let Base::Conic { curvature: c, conic: k } = of.base else { return None };
    let (c, g) = (exact(c), exact((1.0 + k) * c * c));
    let linear = |k: usize| vec![exact(ray.origin[k]), exact(ray.direction[k])];
    let v = plus(&times(&linear(0), &linear(0)), &times(&linear(1), &linear(1)));
    let scaled = |p: &[RBig], by: &RBig| p.iter().map(|x| x * by).collect::<Vec<_>>();
    let height = along(&Description { odd: vec![], ..of.clone() }, ray, raise);
    let m = plus(std::slice::from_ref(&c), &scaled(&height, &-g.clone()));
    let odd = of.odd.iter().rev().fold(vec![RBig::ZERO], |sum, &o| plus(&times(&sum, &v), &[exact(o)]));
    let odd = scaled(&odd, &g);
    // c^2 s^2
    let square = plus(&[&c * &c], &scaled(&v, &-(&c * &c * &g)));
    // (M + r O)^2 = c^2 s^2, without its term in r
    let even = plus(&plus(&times(&m, &m), &times(&v, &times(&odd, &odd))), &scaled(&square, &exact(-1.0)));
    let mixed = scaled(&times(&m, &odd), &exact(2.0));
    let whole = match of.odd.is_empty() {
        true => even.clone(),
        false => plus(&times(&even, &even), &scaled(&times(&v, &times(&mixed, &mixed)), &exact(-1.0))),
    };
    let mut count = 0;
    for t in Sturm::new(&whole).roots(window.0, window.1) {
        let [m, odd, even, mixed, v] = [&m, &odd, &even, &mixed, &v].map(|p| approximate(&value(p, &t)));
        let (r, s) = (v.sqrt(), m + v.sqrt() * odd);
        let is_even = even.abs() <= 1e-9 && !of.odd.is_empty();
        if is_even || s.abs() <= 1e-9 {
            return None;
        }
        count += usize::from((of.odd.is_empty() || even * mixed * r < 0.0) && s * approximate(&c) > 0.0);
    }
    Some(count)
}

/// Lines past the axis and along the rim of hemispheres with odd terms have the number of crossings of the algebraic
/// solution, if that is the same for the surface raised and lowered slightly.
#[test]
fn steep_surfaces_have_the_number_of_crossings_of_algebra() {
    let mut rng = rng(21);
    let (mut clear, mut many, mut unclear) = (0, 0, 0);
    for round in 0..5 * effort() {
        for of in
            hemispheres().into_iter().filter(|of| of.base != (Base::Conic { curvature: 0.0, conic: 0.0 }))
        {
            let side = [0.0, 1e-17, 1e-9, 0.3, 0.9999][round % 5];
            let mut direction = unit_vector(&mut rng);
            direction.z *= [0.3, 1.0, 1e-3][(round / 5 + round) % 3];
            let across = Vec3::new(-direction.y, direction.x, 0.0).normalize();
            let [low, high] = Sag::new(&of).unwrap().heights();
            let height = rng.random_range(low..high) * Vec3::Z;
            let ray = Ray::new((side * across + height).map(few_bits), direction.map(few_bits));
            let half = 0.999999 * (1.0 - side * side).sqrt() / ray.direction.truncate().length();
            let window = (-half, half);
            let count = |raise: f64| crossings_by_algebra(&of, &ray, raise, window);
            let found = all(&surface(&of), &ray).1.into_iter().filter(|t| t.abs() < half).count();
            let (low, high) = (count(-(2.0f64).powi(-43)), count(2.0f64.powi(-43)));
            if low.is_none() || low != high {
                unclear += 1;
                continue;
            }
            assert_eq!(Some(found), low, "{of:?} {ray:?}");
            clear += 1;
            many += usize::from(found > 1);
        }
    }
    assert!(
        clear > 25 && many > 8 && unclear < clear / 3,
        "{clear} clear, {many} of many, {unclear} unclear"
    );
}
