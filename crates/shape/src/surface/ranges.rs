//! Interval bounds of f and its gradient over a box, for curved trajectories.
//!
//! Each range is the natural interval extension of the kernel's formula (R. E. Moore, *Interval Analysis*, 1966), about the
//! surface's own centre, with outward rounding: it contains the exact value at every point of the box. The gradient's range
//! is exact up to rounding for planes, spheres and cylinders: each component is linear, and each coordinate occurs in it
//! once. For cones, quadrics and tori its width is proportional to that of a small box, except on the axis of a torus. There
//! the gradient is undefined, and the range contains the convex hull of the gradients of all nearby points, so that the mean
//! value theorem holds across the axis (G. Lebourg, C. R. Acad. Sci. Paris 281 (1975)). An [`Object`] has the ranges of its
//! form ([`super::object::Form::ranges`]), which may be wider.

use super::{AffineTorus, Cone, Cylinder, Object, Plane, Quadric, Sphere, Surface, Torus};
use rayweave_math::{Interval, Mat3, Vec3};

/// A box, or a range of vectors.
type Cell = [Interval; 3];

impl Surface {
    /// Bounds of f, and of each component of its gradient, over all points of a box.
    pub fn ranges(&self, cell: &[Interval; 3]) -> (Interval, [Interval; 3]) {
        match self {
            Surface::Plane(s) => plane(s, cell),
            Surface::Sphere(s) => sphere(s, cell),
            Surface::Cylinder(s) => cylinder(s, cell),
            Surface::Cone(s) => cone(s, cell),
            Surface::Quadric(s) => quadric(s, cell),
            Surface::Torus(s) => torus(s, &about(cell, s.centre)),
            Surface::AffineTorus(s) => affine_torus(s, cell),
            Surface::Object(s) => object(s, cell),
        }
    }
}

/// The box relative to a centre.
fn about(cell: &Cell, centre: Vec3) -> Cell {
    std::array::from_fn(|k| cell[k] - Interval::point(centre[k]))
}

/// `n . q`.
fn form(n: Vec3, q: &Cell) -> Interval {
    q[0] * n.x + q[1] * n.y + q[2] * n.z
}

/// `|q|^2`.
fn square(q: &Cell) -> Interval {
    q[0].square() + q[1].square() + q[2].square()
}

/// The component of q perpendicular to a unit vector. It is computed with the rows of the projection matrix, so that each
/// coordinate of q occurs only once in a component.
fn across(q: &Cell, axis: Vec3) -> Cell {
    let row = |k: usize| {
        let entry =
            |j: usize| Interval::point(if j == k { 1.0 } else { 0.0 }) - Interval::point(axis[k]) * axis[j];
        q[0] * entry(0) + q[1] * entry(1) + q[2] * entry(2)
    };
    [row(0), row(1), row(2)]
}

/// `2 v`.
fn doubled(v: Cell) -> Cell {
    v.map(|x| x * 2.0)
}

/// `v + x axis`.
fn plus_along(v: Cell, x: Interval, axis: Vec3) -> Cell {
    std::array::from_fn(|k| v[k] + x * axis[k])
}

fn plane(s: &Plane, cell: &Cell) -> (Interval, Cell) {
    let value = form(s.normal, cell) - Interval::point(s.offset);
    (value, s.normal.to_array().map(Interval::point))
}

fn sphere(s: &Sphere, cell: &Cell) -> (Interval, Cell) {
    let q = about(cell, s.centre);
    (square(&q) - Interval::point(s.radius).square(), doubled(q))
}

fn cylinder(s: &Cylinder, cell: &Cell) -> (Interval, Cell) {
    let offset = across(&about(cell, s.point), s.axis);
    (square(&offset) - Interval::point(s.radius).square(), doubled(offset))
}

fn cone(s: &Cone, cell: &Cell) -> (Interval, Cell) {
    let q = about(cell, s.apex);
    let (offset, radius) = (across(&q, s.axis), form(s.axis, &q) * s.slope);
    let value = square(&offset) - radius.square();
    (value, doubled(plus_along(offset, -radius * s.slope, s.axis)))
}

fn quadric(s: &Quadric, cell: &Cell) -> (Interval, Cell) {
    let q = about(cell, s.centre);
    let mut value = form(s.linear, &q) + Interval::point(s.constant);
    let mut gradient = s.linear.to_array().map(Interval::point);
    for (k, &axis) in s.axes.iter().enumerate() {
        let (x, weight) = (form(axis, &q), s.weights[k]);
        value = value + x.square() * weight;
        gradient = plus_along(gradient, x * (2.0 * weight), axis);
    }
    (value, gradient)
}

/// Ranges of f for a box q relative to the centre.
fn torus(s: &Torus, q: &Cell) -> (Interval, Cell) {
    let (z, offset) = (form(s.axis, q), across(q, s.axis));
    let rho = square(&offset).sqrt();
    let ring = rho - Interval::point(s.major);
    let value = ring.square() + z.square() - Interval::point(s.minor).square();
    let unit = Interval { lo: -1.0, hi: 1.0 };
    let inverse = rho.positive_recip();
    let outwards = offset.map(|x| if rho.lo > 0.0 { (x * inverse).narrowed(unit) } else { unit });
    (value, doubled(plus_along(outwards.map(|x| x * ring), z, s.axis)))
}

/// Ranges of f, evaluated in the frame of the torus; the gradient is in the outer frame.
fn affine_torus(s: &AffineTorus, cell: &Cell) -> (Interval, Cell) {
    let (value, gradient) = torus(&s.torus, &turned(s.local_from_world, &about(cell, s.centre)));
    (value, turned(s.local_from_world.transpose(), &gradient))
}

/// Ranges of f, evaluated in the frame of the form; the gradient is in the outer frame.
fn object(s: &Object, cell: &Cell) -> (Interval, Cell) {
    let (value, gradient) = s.form.ranges(&turned(s.local_from_world, &about(cell, s.centre)));
    (value, turned(s.local_from_world.transpose(), &gradient))
}

/// `m v`.
fn turned(m: Mat3, v: &Cell) -> Cell {
    [form(m.row(0), v), form(m.row(1), v), form(m.row(2), v)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};
    use rayweave_math::{Affine, Transform};

    fn surfaces(scale: f64) -> Vec<Surface> {
        let at = scale * Vec3::new(0.3, -1.2, 0.5);
        let axis = Vec3::new(1.0, 2.0, -0.5);
        let stretched = Affine::scale(Vec3::new(1.0, 2.0, 0.7)).then(&Affine::translate(at));
        let scaling = Transform::from_affine(stretched).unwrap();
        let ring = Surface::torus(at, axis, 2.0 * scale, 0.7 * scale);
        vec![
            Surface::plane(axis, scale),
            Surface::sphere(at, scale),
            Surface::cylinder(at, axis, scale),
            Surface::cone(at, axis, 0.6),
            Surface::sphere(Vec3::ZERO, scale).transformed(&scaling),
            Surface::cone(at, axis, 0.6).transformed(&scaling),
            ring.transformed(&scaling),
            ring,
            Surface::torus(at, axis, 0.5 * scale, 0.7 * scale),
        ]
    }

    /// Values and gradients at points of a box lie in the ranges, and differences of values satisfy the mean value theorem.
    #[test]
    fn points_of_a_box_are_in_range() {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let mut uniform = |half: f64| half * (2.0 * rng.random::<f64>() - 1.0);
        for scale in [1e-8, 1.0, 1e8] {
            for (i, surface) in surfaces(scale).iter().enumerate() {
                for round in 0..300 {
                    let half = scale * libm::pow(10.0, -f64::from(round % 9));
                    let centre: [f64; 3] = std::array::from_fn(|_| uniform(2.0 * scale));
                    let cell = centre.map(|x| Interval::around(x, half));
                    let mut point = || Vec3::from_array(centre) + Vec3::splat(half).map(&mut uniform);
                    let (a, b) = (point(), point());
                    let (value, gradient) = surface.ranges(&cell);
                    let (fa, ga) = surface.value_and_gradient(a);
                    let (fb, _) = surface.value_and_gradient(b);
                    // rounding error of the kernel itself
                    let slack = 1e-14 * (scale + ga.length() * scale + fa.abs() + scale * scale);
                    assert!(value.lo - slack <= fa && fa <= value.hi + slack, "{i}: {fa} in {value:?}");
                    for k in 0..3 {
                        let slack = 1e-14 * (ga.length() + scale + 1.0);
                        assert!(gradient[k].lo - slack <= ga[k] && ga[k] <= gradient[k].hi + slack, "{i}");
                    }
                    let step = [b.x - a.x, b.y - a.y, b.z - a.z];
                    let change = gradient[0] * step[0] + gradient[1] * step[1] + gradient[2] * step[2];
                    let slack = 2.0 * slack;
                    assert!(change.lo - slack <= fb - fa && fb - fa <= change.hi + slack, "{i}");
                }
            }
        }
    }

    /// The width of the gradient's range is proportional to the size of a small box.
    #[test]
    fn gradients_narrow_with_the_box() {
        for (i, surface) in surfaces(1.0).iter().enumerate() {
            let width = |half: f64| {
                let cell = [1.1, 0.4, 0.9].map(|x| Interval::around(x, half));
                surface.ranges(&cell).1.map(|g| g.hi - g.lo).iter().fold(0.0f64, |a, &b| a.max(b))
            };
            let (wide, narrow) = (width(1e-3), width(1e-6));
            assert!(narrow <= 1.1e-3 * wide + 1e-14, "{i}: {wide} {narrow}");
        }
    }
}
