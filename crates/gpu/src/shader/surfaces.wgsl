// Roots of surfaces along a ray, each in an interval that holds the exact root and the CPU's root.
//
// Every error bound below counts the roundings of the expression above it. WGSL rounds each operation to either neighbour of the
// exact result (relative error EPS), may contract and reassociate sums (every term is counted as if added last), flushes
// denormals (TINY) and divides within 2.5 ulp. docs/concepts/gpu.md derives the bounds. `twin/surfaces.rs` is the same algorithm.

const EPS: f32 = 1.1920929e-7;
// room for the roundings of the bounds themselves
const ROOM: f32 = @ROOM@;
const TINY: f32 = 1e-30;
const BIG: f32 = 1e30;
// the interval of times in which a surface has to be known, in units of the model's size
const FAR: f32 = 8.0;
@SHARED@
const UNKNOWN: u32 = 3u;

struct Ray {
    o: vec3f,
    d: vec3f,
    // bounds of the error of each component of `o` and of `d`
    eo: f32,
    ed: f32,
}

// Sides and sign changes: n = 0, 1 or 2 roots, or UNKNOWN; `inside` is the side before all roots, or before and after the interval
// lo0, hi0 in which the side is unknown.
struct Roots {
    n: u32,
    inside: bool,
    lo0: f32,
    hi0: f32,
    lo1: f32,
    hi1: f32,
}

fn sum(v: vec3f) -> f32 {
    return v.x + v.y + v.z;
}

fn l1(v: vec3f) -> f32 {
    return sum(abs(v));
}

fn largest(v: vec3f) -> f32 {
    let a = abs(v);
    return max(a.x, max(a.y, a.z));
}

// True once the side of a surface is known only for times up to FAR.
var<private> limited: bool;

fn constant(inside: bool) -> Roots {
    return Roots(0u, inside, BIG, BIG, BIG, BIG);
}

fn unknown() -> Roots {
    return Roots(UNKNOWN, false, -BIG, BIG, BIG, BIG);
}

// data: (normal, offset), (error of a component of the normal, error of the offset)
fn plane(at: u32, r: Ray) -> Roots {
    let p = data[at];
    let e = data[at + 1u];
    let no = p.xyz * r.o;
    let nd = p.xyz * r.d;
    let h = p.w - sum(no);
    let v = sum(nd);
    let n1 = l1(p.xyz) + 3.0 * e.x;
    let eh = ROOM * (EPS * (4.0 * l1(no) + 3.0 * abs(p.w)) + e.y + e.x * l1(r.o) + n1 * r.eo) + TINY;
    let ev = ROOM * (EPS * 3.0 * l1(nd) + e.x * l1(r.d) + n1 * r.ed) + TINY;
    if abs(v) > 2.0 * ev {
        let t = h / v;
        let w = ROOM * (eh + abs(t) * ev) / (abs(v) - ev) + 6.0 * EPS * abs(t);
        return Roots(1u, v > 0.0, t - w, t + w, BIG, BIG);
    }
    if abs(h) - eh > ROOM * (abs(v) + ev) * FAR {
        limited = true;
        return constant(h > 0.0);
    }
    return unknown();
}

// f(x) = a x^2 + 2 b x + c, and a bound of its error
fn value(a: f32, b: f32, c: f32, x: f32) -> f32 {
    return (a * x + 2.0 * b) * x + c;
}

fn value_error(a: f32, b: f32, c: f32, ea: f32, eb: f32, ec: f32, x: f32) -> f32 {
    let y = abs(x);
    return ROOM * ((ea + 4.0 * EPS * abs(a)) * y * y + 2.0 * (eb + 3.0 * EPS * abs(b)) * y + ec + EPS * 2.0 * abs(c)) + TINY;
}

// Sign changes of a x^2 + 2 b x + c about the time s, with errors of the coefficients.
fn quadratic(a: f32, b: f32, c: f32, ea: f32, eb: f32, ec: f32, s: f32) -> Roots {
    let d = b * b - a * c;
    let ed = ROOM
        * (2.0 * abs(b) * eb + eb * eb + abs(a) * ec + abs(c) * ea + ea * ec + EPS * 2.0 * (b * b + abs(a * c)))
        + TINY;
    if d < -ed {
        return constant(c < 0.0);
    }
    if d > ed && abs(a) > 4.0 * ea {
        let root = sqrt(d);
        let q = -(b + select(-root, root, b >= 0.0));
        let x0 = q / a;
        let x1 = c / q;
        let first = min(x0, x1);
        let last = max(x0, x1);
        let w0 = @STEP@ * (abs(value(a, b, c, first)) + value_error(a, b, c, ea, eb, ec, first)) / (2.0 * root) + EPS * abs(first);
        let w1 = @STEP@ * (abs(value(a, b, c, last)) + value_error(a, b, c, ea, eb, ec, last)) / (2.0 * root) + EPS * abs(last);
        let p = vec4f(first - w0, first + w0, last - w1, last + w1);
        let sa = select(-1.0, 1.0, a > 0.0);
        // the signs at the ends are certain, and a quadratic has no more than two sign changes
        let certain = sa * value(a, b, c, p.x) > value_error(a, b, c, ea, eb, ec, p.x)
            && -sa * value(a, b, c, p.y) > value_error(a, b, c, ea, eb, ec, p.y)
            && -sa * value(a, b, c, p.z) > value_error(a, b, c, ea, eb, ec, p.z)
            && sa * value(a, b, c, p.w) > value_error(a, b, c, ea, eb, ec, p.w);
        if certain {
            let g = 2.0 * EPS * (abs(vec4f(s)) + abs(p));
            let t = vec4f(s) + p;
            return Roots(2u, a < 0.0, t.x - g.x, t.y + g.y, t.z - g.z, t.w + g.w);
        }
    }
    let far = FAR + abs(s);
    if abs(c) - ec > ROOM * (2.0 * (abs(b) + eb) + (abs(a) + ea) * far) * far {
        limited = true;
        return constant(c < 0.0);
    }
    return unknown();
}

// data: (centre, squared radius), (error of a component of the centre, error of the square)
fn sphere(at: u32, r: Ray) -> Roots {
    let m = data[at];
    let e = data[at + 1u];
    let q = r.o - m.xyz;
    let dd = r.d * r.d;
    let a = sum(dd);
    let s = -sum(q * r.d) / a;
    let sd = s * r.d;
    let p = q + sd;
    let ep = ROOM * (EPS * (largest(q) + largest(sd) + largest(p)) + e.x + r.eo + abs(s) * r.ed) + TINY;
    let pp = p * p;
    let pd = p * r.d;
    let c = sum(pp) - m.w;
    let b = sum(pd);
    let ec = ROOM * (2.0 * l1(p) * ep + 3.0 * ep * ep + EPS * (4.0 * sum(pp) + 3.0 * m.w) + e.y) + TINY;
    let eb = ROOM * (l1(p) * r.ed + l1(r.d) * ep + 3.0 * ep * r.ed + EPS * 3.0 * l1(pd)) + TINY;
    let ea = ROOM * (2.0 * l1(r.d) * r.ed + 3.0 * r.ed * r.ed + EPS * 3.0 * a) + TINY;
    return quadratic(a, b, c, ea, eb, ec, s);
}

// data: (point, error of a component), (first axis across, error of a component), (second axis across, squared radius),
// (error of the square)
fn cylinder(at: u32, r: Ray) -> Roots {
    let m = data[at];
    let e1 = data[at + 1u];
    let e2 = data[at + 2u];
    let q = r.o - m.xyz;
    let eq = ROOM * (EPS * largest(q) + m.w + r.eo) + TINY;
    let n1 = vec2f(l1(e1.xyz), l1(e2.xyz)) + 3.0 * e1.w;
    let x = vec2f(sum(e1.xyz * q), sum(e2.xyz * q));
    let y = vec2f(sum(e1.xyz * r.d), sum(e2.xyz * r.d));
    let ex = n1 * eq + e1.w * l1(q) + EPS * 3.0 * vec2f(l1(e1.xyz * q), l1(e2.xyz * q));
    let ey = ROOM * (n1 * r.ed + e1.w * l1(r.d) + EPS * 3.0 * vec2f(l1(e1.xyz * r.d), l1(e2.xyz * r.d))) + TINY;
    let a = y.x * y.x + y.y * y.y;
    let s = select(0.0, clamp(-(x.x * y.x + x.y * y.y) / a, -FAR, FAR), a > TINY);
    let sy = s * y;
    let p = x + sy;
    let ep = ROOM * (ex + abs(s) * ey + EPS * (abs(sy) + abs(p))) + TINY;
    let pp = p.x * p.x + p.y * p.y;
    let rr = e2.w;
    let two = abs(p) * (2.0 * ep) + ep * ep;
    let c = pp - rr;
    let ec = ROOM * (two.x + two.y + EPS * (3.0 * pp + 2.0 * rr) + data[at + 3u].x) + TINY;
    let py = p * y;
    let b = py.x + py.y;
    let mixed = abs(p) * ey + abs(y) * ep + ep * ey;
    let eb = ROOM * (mixed.x + mixed.y + EPS * 2.0 * (abs(py.x) + abs(py.y))) + TINY;
    let square = abs(y) * (2.0 * ey) + ey * ey;
    let ea = ROOM * (square.x + square.y + EPS * 2.0 * a) + TINY;
    return quadratic(a, b, c, ea, eb, ec, s);
}

// A ray along three axes with the origin in a centre, p + x y with x the time after `s`, and the bounds of the errors of components.
struct AxisRay {
    p: vec3f,
    ep: vec3f,
    y: vec3f,
    ey: vec3f,
    s: f32,
}

// data: (centre, error of a component), three axes, the first with the error of a component of the axes
fn along_axes(at: u32, r: Ray) -> AxisRay {
    let m = data[at];
    let e1 = data[at + 1u];
    let e2 = data[at + 2u];
    let e3 = data[at + 3u];
    let q = r.o - m.xyz;
    let s = -sum(q * r.d) / sum(r.d * r.d);
    let sd = s * r.d;
    let z = q + sd;
    let ez = ROOM * (EPS * (largest(q) + largest(sd) + largest(z)) + m.w + r.eo + abs(s) * r.ed) + TINY;
    let n1 = vec3f(l1(e1.xyz), l1(e2.xyz), l1(e3.xyz)) + 3.0 * e1.w;
    let p = vec3f(sum(e1.xyz * z), sum(e2.xyz * z), sum(e3.xyz * z));
    let y = vec3f(sum(e1.xyz * r.d), sum(e2.xyz * r.d), sum(e3.xyz * r.d));
    let ep = ROOM * (n1 * ez + e1.w * l1(z) + EPS * 3.0 * vec3f(l1(e1.xyz * z), l1(e2.xyz * z), l1(e3.xyz * z))) + TINY;
    let ey = ROOM
        * (n1 * r.ed + e1.w * l1(r.d) + EPS * 3.0 * vec3f(l1(e1.xyz * r.d), l1(e2.xyz * r.d), l1(e3.xyz * r.d)))
        + TINY;
    return AxisRay(p, ep, y, ey, s);
}

// data: those of `along_axes`, the second and the third axis with the error of a weight and of a linear coefficient; (weights, constant), (linear coefficients along the axes, error of the constant). Cones, too.
fn quadric(at: u32, r: Ray) -> Roots {
    let e2 = data[at + 2u];
    let e3 = data[at + 3u];
    let w = data[at + 4u];
    let l = data[at + 5u];
    let own = along_axes(at, r);
    let p = own.p;
    let ep = own.ep;
    let y = own.y;
    let ey = own.ey;
    let aw = abs(w.xyz) + e2.w;
    let al = abs(l.xyz) + e3.w;
    let wpp = w.xyz * p * p;
    let lp = l.xyz * p;
    let c = sum(wpp) + sum(lp) + w.w;
    let ec = ROOM
        * (sum(aw * (2.0 * abs(p) * ep + ep * ep)) + e2.w * sum(p * p) + sum(al * ep) + e3.w * l1(p)
            + EPS * (8.0 * l1(wpp) + 7.0 * l1(lp) + 6.0 * abs(w.w)) + l.w)
        + TINY;
    let wpy = w.xyz * p * y;
    let ly = l.xyz * y;
    let b = sum(wpy) + 0.5 * sum(ly);
    let eb = ROOM
        * (sum(aw * (abs(p) * ey + abs(y) * ep + ep * ey)) + e2.w * l1(p * y) + 0.5 * (sum(al * ey) + e3.w * l1(y))
            + EPS * (7.0 * l1(wpy) + 3.5 * l1(ly)))
        + TINY;
    let wyy = w.xyz * y * y;
    let a = sum(wyy);
    let ea = ROOM * (sum(aw * (2.0 * abs(y) * ey + ey * ey)) + e2.w * sum(y * y) + EPS * 4.0 * l1(wyy)) + TINY;
    return quadratic(a, b, c, ea, eb, ec, own.s);
}

// The ball around a leaf that has facets without a kernel: the leaf is not outside of it, and inside of it the CPU decides.
fn ball(at: u32, r: Ray) -> Roots {
    let roots = sphere(at, r);
    if roots.n == 2u {
        return Roots(UNKNOWN, false, roots.lo0, roots.hi1, BIG, BIG);
    }
    return roots;
}

// A ray in the frame of a placed solid. data: three rows of the map, (error of a coefficient, error of a translation)
fn placed(at: u32, r: Ray) -> Ray {
    let a = data[at];
    let b = data[at + 1u];
    let c = data[at + 2u];
    let e = data[at + 3u];
    let oa = a.xyz * r.o;
    let ob = b.xyz * r.o;
    let oc = c.xyz * r.o;
    let da = a.xyz * r.d;
    let db = b.xyz * r.d;
    let dc = c.xyz * r.d;
    let shift = vec3f(a.w, b.w, c.w);
    let n1 = max(l1(a.xyz), max(l1(b.xyz), l1(c.xyz))) + 3.0 * e.x;
    let o = vec3f(sum(oa), sum(ob), sum(oc)) + shift;
    let d = vec3f(sum(da), sum(db), sum(dc));
    let so = max(l1(oa), max(l1(ob), l1(oc)));
    let sd = max(l1(da), max(l1(db), l1(dc)));
    let eo = ROOM * (n1 * r.eo + e.x * l1(r.o) + e.y + EPS * (4.0 * so + 3.0 * largest(shift))) + TINY;
    let ed = ROOM * (n1 * r.ed + e.x * l1(r.d) + EPS * 3.0 * sd) + TINY;
    return Ray(o, d, eo, ed);
}
