//! Coefficients of surfaces along a ray with their error bounds: the functions of `shader/surfaces.wgsl`, operation by operation.

use super::adversary::{Adversary, V3};

const EPS: f32 = f32::EPSILON;
const TINY: f32 = 1e-30;

/// A ray with the bounds of the errors of its components.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TwinRay {
    pub o: V3,
    pub d: V3,
    pub eo: f32,
    pub ed: f32,
}

/// A number with the bound of its error.
pub(crate) type Bounded = (f32, f32);

fn abs(v: V3) -> V3 {
    v.map(f32::abs)
}

pub(crate) fn l1(v: V3) -> f32 {
    v[0].abs() + v[1].abs() + v[2].abs()
}

pub(crate) fn largest(v: V3) -> f32 {
    v[0].abs().max(v[1].abs()).max(v[2].abs())
}

pub(crate) fn times(a: V3, b: V3) -> V3 {
    [a[0] * b[0], a[1] * b[1], a[2] * b[2]]
}

/// The height over a plane and the speed towards it.
pub(crate) fn plane(m: &mut Adversary, room: f32, p: [f32; 4], e: [f32; 2], r: &TwinRay) -> [Bounded; 2] {
    let normal = [p[0], p[1], p[2]];
    let no = m.product(normal, r.o);
    let nd = m.product(normal, r.d);
    let h = m.groups(&[&[p[3]], &no.map(|x| -x)]);
    let v = m.sum(nd);
    let n1 = l1(normal) + 3.0 * e[0];
    let eh = room * (EPS * (4.0 * l1(no) + 3.0 * p[3].abs()) + e[1] + e[0] * l1(r.o) + n1 * r.eo) + TINY;
    let ev = room * (EPS * 3.0 * l1(nd) + e[0] * l1(r.d) + n1 * r.ed) + TINY;
    [(h, eh), (v, ev)]
}

/// The time at which a ray crosses a plane, given height and speed.
pub(crate) fn plane_time(m: &mut Adversary, room: f32, [(h, eh), (v, ev)]: [Bounded; 2]) -> Bounded {
    let t = m.div(h, v);
    (t, room * (eh + t.abs() * ev) / (v.abs() - ev) + 6.0 * EPS * t.abs())
}

/// `a x^2 + 2 b x + c`, as a sum of three terms.
pub(crate) fn value(
    m: &mut Adversary,
    room: f32,
    [(a, ea), (b, eb), (c, ec)]: [Bounded; 3],
    x: f32,
) -> Bounded {
    let (ax, bx) = (m.mul(a, x), m.mul(2.0 * b, x));
    let axx = m.mul(ax, x);
    let y = x.abs();
    let error =
        (ea + 4.0 * EPS * a.abs()) * y * y + 2.0 * (eb + 3.0 * EPS * b.abs()) * y + ec + EPS * 2.0 * c.abs();
    (m.total(&[axx, bx, c]), room * error + TINY)
}

/// `b^2 - a c`.
pub(crate) fn discriminant(
    m: &mut Adversary,
    room: f32,
    [(a, ea), (b, eb), (c, ec)]: [Bounded; 3],
) -> Bounded {
    let (bb, ac) = (m.mul(b, b), m.mul(a, c));
    let error = 2.0 * b.abs() * eb + eb * eb + a.abs() * ec + c.abs() * ea + ea * ec;
    (m.sub(bb, ac), room * (error + EPS * 2.0 * (b * b + (a * c).abs())) + TINY)
}

/// `[a, b, c]` of a sphere about the time s, and s.
pub(crate) fn sphere(
    m: &mut Adversary,
    room: f32,
    c: [f32; 4],
    e: [f32; 2],
    r: &TwinRay,
) -> ([Bounded; 3], f32) {
    let q = m.map(r.o, [c[0], c[1], c[2]], Adversary::sub);
    let dd = m.product(r.d, r.d);
    let a = m.sum(dd);
    let qd = m.dot(q, r.d);
    let s = m.div(-qd, a);
    let sd = m.product([s; 3], r.d);
    let p = m.map(q, sd, Adversary::add);
    let ep = room * (EPS * (largest(q) + largest(sd) + largest(p)) + e[0] + r.eo + s.abs() * r.ed) + TINY;
    let pp = m.product(p, p);
    let pd = m.product(p, r.d);
    let k = m.total(&[pp[0], pp[1], pp[2], -c[3]]);
    let b = m.sum(pd);
    let ec = room * (2.0 * l1(p) * ep + 3.0 * ep * ep + EPS * (4.0 * l1(pp) + 3.0 * c[3]) + e[1]) + TINY;
    let eb = room * (l1(p) * r.ed + l1(r.d) * ep + 3.0 * ep * r.ed + EPS * 3.0 * l1(pd)) + TINY;
    let ea = room * (2.0 * l1(r.d) * r.ed + 3.0 * r.ed * r.ed + EPS * 3.0 * a) + TINY;
    ([(a, ea), (b, eb), (k, ec)], s)
}

/// A ray along three axes with the origin in a centre, `p + x y` with x the time after s, and the bounds of the errors.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AxisRay {
    pub p: V3,
    pub ep: V3,
    pub y: V3,
    pub ey: V3,
    pub s: f32,
}

/// The ray along axes; the first four rows are those of the shader.
pub(crate) fn along_axes(m: &mut Adversary, room: f32, rows: &[[f32; 4]], r: &TwinRay) -> AxisRay {
    let xyz = |k: usize| [rows[k][0], rows[k][1], rows[k][2]];
    let (axes, em, ee) = ([xyz(1), xyz(2), xyz(3)], rows[0][3], rows[1][3]);
    let q = m.map(r.o, xyz(0), Adversary::sub);
    let qd = m.dot(q, r.d);
    let dd = m.dot(r.d, r.d);
    let s = m.div(-qd, dd);
    let sd = m.product([s; 3], r.d);
    let z = m.map(q, sd, Adversary::add);
    let ez = room * (EPS * (largest(q) + largest(sd) + largest(z)) + em + r.eo + s.abs() * r.ed) + TINY;
    let n1 = axes.map(|axis| l1(axis) + 3.0 * ee);
    let p = axes.map(|axis| m.dot(axis, z));
    let y = axes.map(|axis| m.dot(axis, r.d));
    let error =
        |k: usize, v: V3, e: f32| room * (n1[k] * e + ee * l1(v) + EPS * 3.0 * l1(times(axes[k], v))) + TINY;
    let ep: V3 = std::array::from_fn(|k| error(k, z, ez));
    let ey: V3 = std::array::from_fn(|k| error(k, r.d, r.ed));
    AxisRay { p, ep, y, ey, s }
}

/// `[a, b, c]` of a quadric about the time s, and s. The rows are those of the shader.
pub(crate) fn quadric(
    m: &mut Adversary,
    room: f32,
    rows: &[[f32; 4]; 6],
    r: &TwinRay,
) -> ([Bounded; 3], f32) {
    let xyz = |k: usize| [rows[k][0], rows[k][1], rows[k][2]];
    let (w, l) = (xyz(4), xyz(5));
    let [_, _, ew, el, constant, ek] = std::array::from_fn(|k| rows[k][3]);
    let AxisRay { p, ep, y, ey, s } = along_axes(m, room, rows, r);
    let (aw, al) = (w.map(|x| x.abs() + ew), l.map(|x| x.abs() + el));
    let wp = m.product(w, p);
    let wpp = m.product(wp, p);
    let lp = m.product(l, p);
    let c = m.groups(&[&wpp, &lp, &[constant]]);
    let two = |p: V3, e: V3| -> V3 { std::array::from_fn(|k| 2.0 * p[k].abs() * e[k] + e[k] * e[k]) };
    let ec = room
        * (l1(times(aw, two(p, ep)))
            + ew * l1(times(p, p))
            + l1(times(al, ep))
            + el * l1(p)
            + EPS * (8.0 * l1(wpp) + 7.0 * l1(lp) + 6.0 * constant.abs())
            + ek)
        + TINY;
    let wpy = m.product(wp, y);
    let ly = m.product(l, y);
    let half = ly.map(|x| 0.5 * x);
    let b = m.groups(&[&wpy, &half]);
    let cross: V3 = std::array::from_fn(|k| abs(p)[k] * ey[k] + abs(y)[k] * ep[k] + ep[k] * ey[k]);
    let eb = room
        * (l1(times(aw, cross))
            + ew * l1(times(p, y))
            + 0.5 * (l1(times(al, ey)) + el * l1(y))
            + EPS * (7.0 * l1(wpy) + 3.5 * l1(ly)))
        + TINY;
    let wy = m.product(w, y);
    let wyy = m.product(wy, y);
    let a = m.sum(wyy);
    let ea = room * (l1(times(aw, two(y, ey))) + ew * l1(times(y, y)) + EPS * 4.0 * l1(wyy)) + TINY;
    ([(a, ea), (b, eb), (c, ec)], s)
}

/// `[a, b, c]` of a cylinder about the time s, and s. The rows are those of the shader.
pub(crate) fn cylinder(
    m: &mut Adversary,
    room: f32,
    rows: &[[f32; 4]; 4],
    r: &TwinRay,
) -> ([Bounded; 3], f32) {
    let xyz = |k: usize| [rows[k][0], rows[k][1], rows[k][2]];
    let (axes, ee, rr) = ([xyz(1), xyz(2)], rows[1][3], rows[2][3]);
    let q = m.map(r.o, xyz(0), Adversary::sub);
    let eq = room * (EPS * largest(q) + rows[0][3] + r.eo) + TINY;
    let x = axes.map(|axis| m.dot(axis, q));
    let y = axes.map(|axis| m.dot(axis, r.d));
    let error = |k: usize, v: V3, e: f32| {
        (l1(axes[k]) + 3.0 * ee) * e + ee * l1(v) + EPS * 3.0 * l1(times(axes[k], v))
    };
    let ex: [f32; 2] = std::array::from_fn(|k| error(k, q, eq));
    let ey: [f32; 2] = std::array::from_fn(|k| room * error(k, r.d, r.ed) + TINY);
    let pair = |m: &mut Adversary, a: [f32; 2], b: [f32; 2]| {
        let terms = [m.mul(a[0], b[0]), m.mul(a[1], b[1])];
        (m.add(terms[0], terms[1]), terms[0].abs() + terms[1].abs())
    };
    let a = pair(m, y, y).0;
    let xy = pair(m, x, y).0;
    let s = if a > TINY { m.div(-xy, a).clamp(-8.0, 8.0) } else { 0.0 };
    let sy = y.map(|y| m.mul(s, y));
    let p = [m.add(x[0], sy[0]), m.add(x[1], sy[1])];
    let ep: [f32; 2] =
        std::array::from_fn(|k| room * (ex[k] + s.abs() * ey[k] + EPS * (sy[k].abs() + p[k].abs())) + TINY);
    let (pp, _) = pair(m, p, p);
    let c = m.sub(pp, rr);
    let sum = |of: &dyn Fn(usize) -> f32| of(0) + of(1);
    let ec = room
        * (sum(&|k| p[k].abs() * 2.0 * ep[k] + ep[k] * ep[k]) + EPS * (3.0 * pp + 2.0 * rr) + rows[3][0])
        + TINY;
    let (b, size) = pair(m, p, y);
    let mixed = sum(&|k| p[k].abs() * ey[k] + y[k].abs() * ep[k] + ep[k] * ey[k]);
    let eb = room * (mixed + EPS * 2.0 * size) + TINY;
    let ea = room * (sum(&|k| y[k].abs() * 2.0 * ey[k] + ey[k] * ey[k]) + EPS * 2.0 * a) + TINY;
    ([(a, ea), (b, eb), (c, ec)], s)
}

/// Origin and direction of a ray in the frame of a placed solid, with the bounds of their components.
pub(crate) fn placed(m: &mut Adversary, room: f32, rows: &[[f32; 4]; 4], r: &TwinRay) -> TwinRay {
    let row = |k: usize| [rows[k][0], rows[k][1], rows[k][2]];
    let (em, es) = (rows[3][0], rows[3][1]);
    let shift: V3 = std::array::from_fn(|k| rows[k][3]);
    let turned: V3 = std::array::from_fn(|k| m.dot(row(k), r.o));
    let o = m.map(turned, shift, Adversary::add);
    let d: V3 = std::array::from_fn(|k| m.dot(row(k), r.d));
    let most = |of: &dyn Fn(usize) -> f32| of(0).max(of(1)).max(of(2));
    let n1 = most(&|k| l1(row(k))) + 3.0 * em;
    let so = most(&|k| l1(times(row(k), r.o)));
    let sd = most(&|k| l1(times(row(k), r.d)));
    let eo = room * (n1 * r.eo + em * l1(r.o) + es + EPS * (4.0 * so + 3.0 * largest(shift))) + TINY;
    let ed = room * (n1 * r.ed + em * l1(r.d) + EPS * 3.0 * sd) + TINY;
    TwinRay { o, d, eo, ed }
}
