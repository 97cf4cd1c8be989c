// Roots of a torus along a ray. A line has up to two chords in a torus, and each is an atom of its own: its roots are those of one
// chord. `twin/torus.rs` has the functions with error bounds, and docs/concepts/gpu.md the proof.
//
// In coordinates along three axes with the origin in the centre, the third along the axis of the torus, the ray is p + x y, and
// G(x) = (rho - R)^2 + z^2 - r^2 is the signed function of the torus, with rho the distance from the axis. Half of its second
// derivative is a - R c^2 / rho^3 with a = |y|^2 and c the moment of the ray about the axis. Since rho is convex, G is convex,
// concave and convex on up to three pieces of the ray. The extrema and roots below are candidates; `holds` proves the signs of G
// between the intervals of the roots.

// Bound of the relative error of a square root: 1 / inverseSqrt within 2 and 2.5 units in the last place.
const ROOT_ERROR: f32 = 4.5;
const STEPS_TO_ROOT: u32 = 12u;

struct TorusLine {
    p: vec3f,
    ep: vec3f,
    y: vec3f,
    ey: vec3f,
    // major and minor radius, and their errors
    major: f32,
    minor: f32,
    emajor: f32,
    eminor: f32,
    // |y|^2 and the moment about the axis, with their errors
    a: f32,
    ea: f32,
    c: f32,
    ec: f32,
    // the pieces: convex up to `bends.x`, concave up to `bends.y`, then convex, up to an error of half of the second derivative
    bends: vec2f,
    slack: f32,
    // candidates for the minimum, maximum and minimum of the three pieces
    turns: vec3f,
    // all roots lie between -span and span
    span: f32,
}

// The chords of a line, in order.
struct Chords {
    first: Roots,
    second: Roots,
}

// G and half of its slope with error bounds, and the distance from the axis.
struct TorusJet {
    g: f32,
    eg: f32,
    h: f32,
    eh: f32,
    rho: f32,
    erho: f32,
    // the slope of rho
    u: f32,
    eu: f32,
}

fn torus_jet(l: TorusLine, x: f32) -> TorusJet {
    let xy = x * l.y;
    let p = l.p + xy;
    let e = ROOM * (l.ep + abs(x) * l.ey + EPS * (abs(xy) + abs(p))) + TINY;
    let pp = p.xy * p.xy;
    let rho = sqrt(pp.x + pp.y);
    let aside = abs(p.xy) * e.xy;
    // the error along p and that across it, at most the length of the error
    let shift = min((aside.x + aside.y + 0.5 * (e.x * e.x + e.y * e.y)) / max(rho, TINY), e.x + e.y);
    let erho = ROOM * (shift + (ROOT_ERROR + 1.0) * EPS * rho) + 1e-14;
    let m = rho - l.major;
    let em = ROOM * (erho + l.emajor + EPS * abs(m)) + TINY;
    let zz = p.z * p.z;
    let mm = m * m;
    let rr = l.minor * l.minor;
    let g = mm + zz - rr;
    let eg = ROOM
        * (2.0 * abs(m) * em + em * em + 2.0 * abs(p.z) * e.z + e.z * e.z + 2.0 * l.minor * l.eminor + l.eminor * l.eminor
            + EPS * 3.0 * (mm + zz + rr))
        + TINY;
    let py = p * l.y;
    let mixed = abs(p) * l.ey + abs(l.y) * e + e * l.ey;
    let u = (py.x + py.y) / max(rho, TINY);
    let near = rho - erho;
    let eu = ROOM * ((mixed.x + mixed.y + EPS * 2.0 * (abs(py.x) + abs(py.y)) + abs(u) * erho) / max(near, TINY) + 3.0 * EPS * abs(u)) + TINY;
    let mu = m * u;
    let h = mu + py.z;
    let eh = ROOM * (abs(m) * eu + abs(u) * em + em * eu + mixed.z + EPS * 2.0 * (abs(mu) + abs(py.z))) + TINY;
    if !(near > 0.5 * rho) {
        // close to the axis the slope is open
        return TorusJet(g, eg, 0.0, BIG, rho, erho, 0.0, BIG);
    }
    return TorusJet(g, eg, h, eh, rho, erho, u, eu);
}

// G, half of its slope and half of its second derivative, without error bounds.
fn torus_estimate(l: TorusLine, x: f32) -> vec3f {
    let p = l.p + x * l.y;
    let rho = max(sqrt(p.x * p.x + p.y * p.y), 1e-12);
    let m = rho - l.major;
    let h = m * (p.x * l.y.x + p.y * l.y.y) / rho + p.z * l.y.z;
    let v = l.c / rho;
    return vec3f(m * m + p.z * p.z - l.minor * l.minor, h, l.a - l.major * v * v / rho);
}

fn nonzero(x: f32) -> f32 {
    return select(x, TINY, abs(x) < TINY);
}

// A candidate for a zero of G in a piece, or of its slope, from a point on one side of it: the steps approach it from there.
fn torus_zero(l: TorusLine, of_slope: bool, start: f32, lo: f32, hi: f32) -> f32 {
    var x = start;
    for (var i = 0u; i < STEPS_TO_ROOT; i++) {
        let e = torus_estimate(l, x);
        let step = select(0.5 * e.x / nonzero(e.y), e.y / nonzero(e.z), of_slope);
        let next = clamp(x - step, lo, hi);
        if !(abs(next - x) > EPS * (abs(x) + abs(next))) {
            break;
        }
        x = next;
        // there is none before the end
        if x == lo || x == hi {
            break;
        }
    }
    return x;
}

// True if a function of the sign `v` at one end of a stretch and `w` at the other, both lower bounds, has it in between, where its
// second derivative is at most twice `slack` on the wrong side.
fn chord_holds(v: f32, w: f32, length: f32, slack: f32) -> bool {
    let sag = 1.00001 * slack * length * length;
    return min(v, w) > 0.0 && (abs(w - v) > sag + EPS * (v + w) || min(v, w) > 0.25 * sag);
}

// True if G certainly has a sign between two times in one piece, with the candidate `turn` for its extremum there.
fn piece_holds(l: TorusLine, side: f32, from_: f32, to_: f32, turn: f32, convex: bool) -> bool {
    if from_ > to_ {
        return true;
    }
    let m = clamp(turn, from_, to_);
    let at = torus_jet(l, m);
    let v = side * at.g - at.eg;
    let after = to_ - m;
    let before = m - from_;
    if convex == (side > 0.0) {
        // above the tangent
        let h = side * at.h;
        let error = at.eh + 2.0 * EPS * abs(h);
        let right = after * (2.0 * (h - error) - 1.00001 * l.slack * after);
        let left = before * (2.0 * (-h - error) - 1.00001 * l.slack * before);
        return v > -1.00001 * min(0.0, min(left, right));
    }
    // above the chords
    var holds = true;
    for (var k = 0u; k < 2u && holds; k++) {
        let end = torus_jet(l, select(from_, to_, k == 1u));
        holds = chord_holds(v, side * end.g - end.eg, select(before, after, k == 1u), l.slack);
    }
    return holds;
}

// True if G certainly has a sign between two times. One loop: each copy of the functions costs time to compile.
fn holds_between(l: TorusLine, side: f32, from_: f32, to_: f32) -> bool {
    var holds = true;
    for (var k = 0u; k < 3u && holds; k++) {
        let lo = max(from_, select(l.bends[max(k, 1u) - 1u], from_, k == 0u));
        let hi = min(to_, select(l.bends[min(k, 1u)], to_, k == 2u));
        holds = piece_holds(l, side, lo, hi, l.turns[k], k != 1u);
    }
    return holds;
}

// The pieces and their extrema; the slack is BIG if they are not certain.
fn torus_pieces(line: TorusLine) -> TorusLine {
    var l = line;
    let flat = l.y.x * l.y.x + l.y.y * l.y.y;
    let px = l.p.x * l.y.x + l.p.y * l.y.y;
    let axis = select(0.0, -px / flat, flat > TINY);
    let nearest = clamp(axis, -l.span, l.span);
    let at = torus_jet(l, nearest);
    // rho is convex: above its tangent
    let drop = at.eu + max(0.0, select(abs(at.u), sign(axis) * at.u, axis != nearest));
    let least = at.rho - 4.0 * EPS * at.rho - at.erho - 2.0 * ROOM * drop * l.span;
    let moment = (abs(l.c) + l.ec) / max(least, 1e-9);
    let turn = ROOM * (l.major + l.emajor) * moment * moment / max(least, 1e-9);
    l.bends = vec2f(l.span);
    l.slack = max(0.0, turn - (l.a - l.ea));
    if !(least > 1e-9 && turn <= 1.001 * l.a) {
        // concave near the axis
        l.slack = BIG;
        if !(flat > 1e-10 * l.a) {
            return l;
        }
        let at_bend = pow(l.major * l.c * l.c / l.a, 1.0 / 3.0);
        let square = (at_bend * at_bend - l.c * l.c / flat) / flat;
        let half = sqrt(max(square, 0.0));
        let ey = abs(l.y.xy) * (2.0 * l.ey.xy) + l.ey.xy * l.ey.xy;
        let eflat = ROOM * (ey.x + ey.y + EPS * 2.0 * flat) + TINY;
        let mixed = abs(l.p.xy) * l.ey.xy + abs(l.y.xy) * l.ep.xy + l.ep.xy * l.ey.xy;
        let epx = ROOM * (mixed.x + mixed.y + EPS * 2.0 * (abs(l.p.x * l.y.x) + abs(l.p.y * l.y.y))) + TINY;
        let eaxis = 1.1 * (epx + abs(axis) * eflat) / flat + 4.0 * EPS * abs(axis);
        l.bends = vec2f(axis - half, axis + half);
        // candidates at equal distances from the axis
        var farthest = 0.0;
        var closest = BIG;
        var eaway = 0.0;
        for (var k = 0u; k < 2u; k++) {
            let bend = torus_jet(l, l.bends[k]);
            farthest = max(farthest, bend.rho);
            closest = min(closest, bend.rho);
            eaway = max(eaway, bend.erho);
        }
        let share = l.emajor / l.major + 2.0 * l.ec / max(abs(l.c), TINY) + 3.0 * eaway / max(closest, TINY);
        if !(square > 0.0 && half > 4.0 * eaxis && eflat < 0.01 * flat && share < 0.03) {
            return l;
        }
        let v = l.c * l.c * l.major;
        let bent = vec2f(v / (closest * closest * closest), v / (farthest * farthest * farthest));
        let away = abs(l.a - bent) + l.ea + bent * (1.1 * share + 12.0 * EPS);
        l.slack = ROOM * max(away.x, away.y);
        l.bends = clamp(l.bends, vec2f(-l.span), vec2f(l.span));
    }
    // half of the slope is concave before the point nearest to the axis, and convex after it
    let is_late = l.bends.x == l.span && torus_estimate(l, nearest).y < 0.0;
    l.turns.x = torus_zero(l, true, select(-l.span, l.span, is_late), -l.span, l.bends.x);
    l.turns.z = torus_zero(l, true, l.span, l.bends.y, l.span);
    l.turns.y = torus_zero(l, true, clamp(axis, l.bends.x, l.bends.y), l.bends.x, l.bends.y);
    return l;
}

// The interval of a root near a candidate, and true if G is monotonic in it.
struct Crossed {
    lo: f32,
    hi: f32,
    certain: bool,
}

fn crossed(l: TorusLine, x: f32) -> Crossed {
    let at = torus_jet(l, x);
    let w = @STEP@ * (abs(at.g) + at.eg) / max(2.0 * abs(at.h), TINY) + EPS * abs(x);
    let least = at.rho - 4.0 * EPS * at.rho - at.erho - 1.01 * w * (l1(vec3f(l.y.xy, 0.0)) + l.ey.x + l.ey.y);
    let moment = (abs(l.c) + l.ec) / max(least, 1e-9);
    let most = max(l.a + l.ea, (l.major + l.emajor) * moment * moment / max(least, 1e-9));
    return Crossed(x - w, x + w, least > 1e-9 && abs(at.h) - at.eh > 1.01 * w * most);
}

// data: (centre, error of a component), (first axis across, error of a component of the axes), (second axis across, major radius),
// (axis, minor radius), (errors of the radii)
fn torus_chords(at: u32, r: Ray) -> Chords {
    let e2 = data[at + 2u];
    let e3 = data[at + 3u];
    let own = along_axes(at, r);
    let p = own.p;
    let ep = own.ep;
    let y = own.y;
    let ey = own.ey;
    let s = own.s;
    let yy = y * y;
    let a = sum(yy);
    let ea = ROOM * (sum(abs(y) * (2.0 * ey) + ey * ey) + EPS * 3.0 * a) + TINY;
    let c = p.x * y.y - p.y * y.x;
    let ec = ROOM
        * (abs(p.x) * ey.y + abs(y.y) * ep.x + ep.x * ey.y + abs(p.y) * ey.x + abs(y.x) * ep.y + ep.y * ey.x
            + EPS * 2.0 * (abs(p.x * y.y) + abs(p.y * y.x)))
        + TINY;
    let size = e2.w + e3.w;
    // a ball around the torus that the errors of the ray do not reach
    let outer = 1.02 * size + 8.0 * (largest(ep) + 1.2 * size * largest(ey) / sqrt(a)) + TINY;
    let pp = sum(p * p);
    if pp > 1.05 * outer * outer {
        return Chords(constant(false), constant(false));
    }
    let b = abs(sum(p * y));
    let span = 1.001 * (b + sqrt(b * b + a * (1.1 * outer * outer - pp))) / a;
    let e = data[at + 4u];
    let l = torus_pieces(TorusLine(p, ep, y, ey, e2.w, e3.w, e.x, e.y, a, ea, c, ec, vec2f(), BIG, vec3f(), span));
    let wide = 2.0 * EPS * (abs(s) + span);
    let open = Chords(Roots(UNKNOWN, false, s - span - wide, s + span + wide, BIG, BIG), constant(false));
    if !(l.slack < 0.1 * a) {
        return open;
    }
    // (start, lower end, upper end) of the search for each root between two extrema
    let t = l.turns;
    var brackets = array<vec3f, 4>(
        vec3f(-span, -span, t.x),
        vec3f(l.bends.x, t.x, t.y),
        vec3f(l.bends.y, t.y, t.z),
        vec3f(span, t.z, span),
    );
    var is_below = array<bool, 5>(false, false, false, false, false);
    for (var k = 0u; k < 3u; k++) {
        is_below[k + 1u] = torus_estimate(l, t[k]).x < 0.0;
    }
    var lo = array<f32, 4>();
    var hi = array<f32, 4>();
    var n = 0u;
    var from_ = -span;
    for (var k = 0u; k < 5u; k++) {
        if k < 4u && is_below[k] == is_below[k + 1u] {
            continue;
        }
        let side = select(1.0, -1.0, (n & 1u) == 1u);
        var next = Crossed(span, span, side > 0.0);
        if k < 4u {
            next = crossed(l, torus_zero(l, false, brackets[k].x, brackets[k].y, brackets[k].z));
        }
        // the CPU decides if intervals overlap or leave the span
        if !(next.certain && next.lo > from_ && holds_between(l, side, from_, next.lo)) {
            return open;
        }
        if k == 4u {
            break;
        }
        from_ = next.hi;
        let g = 2.0 * EPS * (abs(s) + abs(next.lo) + abs(next.hi));
        lo[n] = s + next.lo - g;
        hi[n] = s + next.hi + g;
        n += 1u;
    }
    if n == 0u {
        return Chords(constant(false), constant(false));
    }
    let first = Roots(2u, false, lo[0], hi[0], lo[1], hi[1]);
    if n == 2u {
        return Chords(first, constant(false));
    }
    if !(hi[1] < lo[2]) {
        return open;
    }
    return Chords(first, Roots(2u, false, lo[2], hi[2], lo[3], hi[3]));
}

// The chords of the last torus: the atoms of both follow each other.
var<private> chords_at: u32 = NONE;
var<private> chords_ray: Ray;
var<private> chords: Chords;

fn torus(at: u32, r: Ray, second: bool) -> Roots {
    let is_same = at == chords_at && all(r.o == chords_ray.o) && all(r.d == chords_ray.d) && r.eo == chords_ray.eo && r.ed == chords_ray.ed;
    if !is_same {
        chords = torus_chords(at, r);
        chords_at = at;
        chords_ray = r;
    }
    if second {
        return chords.second;
    }
    return chords.first;
}
