//! Coefficients of tori along a ray with their error bounds: the functions of `shader/torus.wgsl`, operation by operation.

use super::adversary::{Adversary, V3};
use super::surfaces::{AxisRay, Bounded, TwinRay, along_axes, l1};

const EPS: f32 = f32::EPSILON;
const TINY: f32 = 1e-30;
const ROOT_ERROR: f32 = 4.5;

/// A ray in the frame of a torus: `p + x y`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TwinLine {
    pub p: V3,
    pub ep: V3,
    pub y: V3,
    pub ey: V3,
    /// Major and minor radius, and their errors.
    pub radii: [f32; 2],
    pub errors: [f32; 2],
}

/// The line of a ray, its moment about the axis and `|y|^2`, and the time of p. The rows are those of the shader.
pub(crate) fn line(
    m: &mut Adversary,
    room: f32,
    rows: &[[f32; 4]; 5],
    r: &TwinRay,
) -> (TwinLine, [Bounded; 2], f32) {
    let AxisRay { p, ep, y, ey, s } = along_axes(m, room, rows, r);
    let yy = m.product(y, y);
    let a = m.sum(yy);
    let two: V3 = std::array::from_fn(|k| y[k].abs() * (2.0 * ey[k]) + ey[k] * ey[k]);
    let ea = room * (l1(two) + EPS * 3.0 * a) + TINY;
    let c = {
        let terms = [m.mul(p[0], y[1]), m.mul(p[1], y[0])];
        m.sub(terms[0], terms[1])
    };
    let mixed = |i: usize, j: usize| p[i].abs() * ey[j] + y[j].abs() * ep[i] + ep[i] * ey[j];
    let ec =
        room * (mixed(0, 1) + mixed(1, 0) + EPS * 2.0 * ((p[0] * y[1]).abs() + (p[1] * y[0]).abs())) + TINY;
    let line = TwinLine { p, ep, y, ey, radii: [rows[2][3], rows[3][3]], errors: [rows[4][0], rows[4][1]] };
    (line, [(a, ea), (c, ec)], s)
}

/// The function of the torus, half of its slope, and the distance from the axis at a time.
pub(crate) fn jet(m: &mut Adversary, room: f32, l: &TwinLine, x: f32) -> [Bounded; 3] {
    let xy = m.product([x; 3], l.y);
    let p = m.map(l.p, xy, Adversary::add);
    let e: V3 = std::array::from_fn(|k| {
        room * (l.ep[k] + x.abs() * l.ey[k] + EPS * (xy[k].abs() + p[k].abs())) + TINY
    });
    let pair = |m: &mut Adversary, a: V3, b: V3| {
        let terms = [m.mul(a[0], b[0]), m.mul(a[1], b[1])];
        (m.add(terms[0], terms[1]), terms[0].abs() + terms[1].abs())
    };
    let square = pair(m, p, p).0;
    let rho = m.root(square);
    let aside = p[0].abs() * e[0] + p[1].abs() * e[1];
    let shift = ((aside + 0.5 * (e[0] * e[0] + e[1] * e[1])) / rho.max(TINY)).min(e[0] + e[1]);
    let erho = room * (shift + (ROOT_ERROR + 1.0) * EPS * rho) + 1e-14;
    let ([major, minor], [emajor, eminor]) = (l.radii, l.errors);
    let ring = m.sub(rho, major);
    let em = room * (erho + emajor + EPS * ring.abs()) + TINY;
    let terms = [m.mul(ring, ring), m.mul(p[2], p[2]), -m.mul(minor, minor)];
    let g = m.total(&terms);
    let two = |x: f32, e: f32| 2.0 * x.abs() * e + e * e;
    let sizes = terms[0] + terms[1] - terms[2];
    let eg = room * (two(ring, em) + two(p[2], e[2]) + two(minor, eminor) + EPS * 3.0 * sizes) + TINY;
    let mixed: V3 = std::array::from_fn(|k| p[k].abs() * l.ey[k] + l.y[k].abs() * e[k] + e[k] * l.ey[k]);
    let (across, size) = pair(m, p, l.y);
    let u = m.div(across, rho);
    let near = rho - erho;
    let eu = room * ((mixed[0] + mixed[1] + EPS * 2.0 * size + u.abs() * erho) / near + 3.0 * EPS * u.abs())
        + TINY;
    let (mu, zy) = (m.mul(ring, u), m.mul(p[2], l.y[2]));
    let h = m.add(mu, zy);
    let eh = room * (ring.abs() * eu + u.abs() * em + em * eu + mixed[2] + EPS * 2.0 * (mu.abs() + zy.abs()))
        + TINY;
    [(g, eg), (h, eh), (rho, erho)]
}
