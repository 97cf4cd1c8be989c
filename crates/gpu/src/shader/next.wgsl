// The first crossing of a line after its start, in double precision, with the time of the CPU.
//
// Each event, an entry or exit of an atom, has the time that the CPU's kernel gives, and an interval around it. Outside of the
// interval the line is farther from the surface than a thousand times the CPU's tolerance: no event there is welded, and the order of
// two events with disjoint intervals is certain. Everything else is in doubt, and left to the CPU.

// exact: numbers; words: tables of atoms, facets, frames, gates and outputs
@group(0) @binding(0) var<storage, read> exact: array<f64>;
@group(0) @binding(1) var<storage, read> words: array<u32>;

@VECTORS@

const ATOMS: u32 = @ATOMS@;
const GATES: u32 = @GATES@;
const OUTPUTS: u32 = @OUTPUTS@;
const ATOM_ROWS: u32 = @ATOM_ROWS@;
const FACET_ROWS: u32 = @FACET_ROWS@;
const FRAME_ROWS: u32 = @FRAME_ROWS@;
const GATE_ROWS: u32 = @GATE_ROWS@;
const OUTPUT_ROWS: u32 = @OUTPUT_ROWS@;
// see the row of an atom
const NO_FRAME: u32 = 0xffffffffu;
const FAR: f64 = 1e300lf;

const FOUND: u32 = 0u;
const NOTHING: u32 = 1u;
const DOUBT: u32 = 2u;

struct Next {
    // FOUND, NOTHING or DOUBT
    route: u32,
    t: f64,
    facet: u32,
    before: u32,
    after: u32,
}

// The part of a line inside a facet or an atom: from `enter` to `leave`, each with the interval of its event.
struct Part {
    enter_lo: f64,
    enter_hi: f64,
    enter: f64,
    leave_lo: f64,
    leave_hi: f64,
    leave: f64,
    enter_facet: u32,
    leave_facet: u32,
    // 1: which facet is entered is not clear; 2: the same for the exit
    unclear: u32,
    empty: bool,
}

fn whole() -> Part {
    return Part(-FAR, -FAR, -FAR, FAR, FAR, FAR, 0u, 0u, 0u, false);
}

fn nowhere() -> Part {
    var part = whole();
    part.empty = true;
    return part;
}

fn constant_part(inside: bool) -> Part {
    var part = whole();
    part.empty = !inside;
    return part;
}

// Whether the line is inside is not known between two times; outside of them it is not.
fn unknown_part(lo: f64, hi: f64) -> Part {
    return Part(lo, hi, lo, lo, hi, hi, 0u, 0u, 3u, false);
}

fn single_event(enters: bool, t: f64, width: f64, facet: u32) -> Part {
    var part = whole();
    if enters {
        part.enter_lo = t - width;
        part.enter_hi = t + width;
        part.enter = t;
        part.enter_facet = facet;
    } else {
        part.leave_lo = t - width;
        part.leave_hi = t + width;
        part.leave = t;
        part.leave_facet = facet;
    }
    return part;
}

// as `Plane::crossings`. exact: normal, offset, magnitude
fn plane_part(at: u32, l: Line, near: f64, inside: bool, facet: u32) -> Part {
    let n = vector(at);
    let height = minus(exact[at + 3u], dot64(n, l.o));
    let speed = dot64(n, l.d);
    if abs(speed) <= times_(@DOT_NOISE@lf, dot64(abs(n), abs(l.d))) {
        if abs(height) <= near {
            return unknown_part(-FAR, FAR);
        }
        return constant_part((height > 0.0lf) == inside);
    }
    return single_event((speed > 0.0lf) != inside, over(height, speed), near / abs(speed), facet);
}

// The plane on which a line starts: no other root.
fn plane_start(at: u32, l: Line, started_inside: bool, inside: bool) -> Part {
    let speed = dot64(l.d, vector(at));
    if abs(speed) < 1e-12lf || (speed < 0.0lf) != started_inside {
        return unknown_part(-FAR, FAR);
    }
    return constant_part(started_inside == inside);
}

// as `Approach::crossings`; `near_f` bounds what the tolerance changes f by
fn about(time: f64, square: f64, inside: f64, near_f: f64, facet: u32) -> Part {
    if inside < -2.0lf * near_f {
        return nowhere();
    }
    if !(inside > 8.0lf * near_f) {
        let width = sqrt(16.0lf * near_f / square);
        return unknown_part(time - width, time + width);
    }
    let half = root(over(inside, square));
    let width = near_f / (half * square);
    let enter = minus(time, half);
    let leave = plus(time, half);
    return Part(
        enter - width, enter + width, enter, leave - width, leave + width, leave, facet, facet, 0u, false
    );
}

// The other root of a surface of degree 2 on which a line starts, as `Surface::departing`: half_b is half of the slope of f at the
// start, a the factor of t^2. `start_root` has the time before it is polished.
fn leaving(t: f64, a: f64, step: f64, near_f: f64, facet: u32) -> Part {
    let width = 2.0lf * near_f / (a * t);
    if !(abs(step) <= times_(1e-6lf, t)) || !(t > 8.0lf * width) {
        return unknown_part(-FAR, FAR);
    }
    return single_event(false, plus(t, -step), width, facet);
}

// exact: centre, squared radius, radius, magnitude
fn sphere_part(at: u32, l: Line, near: f64, facet: u32) -> Part {
    let centre = vector(at);
    let square = dot64(l.d, l.d);
    let time = over(dot64(difference64(centre, l.o), l.d), square);
    let offset = difference64(sum64(l.o, scaled64(time, l.d)), centre);
    let inside = minus(exact[at + 3u], dot64(offset, offset));
    return about(time, square, inside, 2.0lf * near * (exact[at + 4u] + near), facet);
}

fn sphere_start(at: u32, l: Line, started_inside: bool, near: f64, facet: u32) -> Part {
    let centre = vector(at);
    let a = dot64(l.d, l.d);
    let half_b = dot64(difference64(l.o, centre), l.d);
    if half_b == 0.0lf || (half_b < 0.0lf) != started_inside {
        return unknown_part(-FAR, FAR);
    }
    if !started_inside {
        return nowhere();
    }
    let t = over(times_(-2.0lf, half_b), a);
    let offset = difference64(sum64(l.o, scaled64(t, l.d)), centre);
    let value = minus(dot64(offset, offset), exact[at + 3u]);
    let step = over(value, dot64(scaled64(2.0lf, offset), l.d));
    return leaving(t, a, step, 2.0lf * near * (exact[at + 4u] + near), facet);
}

// exact: point, axis, squared radius, radius, magnitude
fn cylinder_part(at: u32, l: Line, near: f64, facet: u32) -> Part {
    let axis = vector(at + 3u);
    let from_ = across(difference64(l.o, vector(at)), axis);
    let along = across(l.d, axis);
    let square = dot64(along, along);
    // the CPU examines lines that are nearly parallel to the axis
    if !(square >= times_(@SLOW_SQUARE@lf, dot64(l.d, l.d))) {
        return unknown_part(-FAR, FAR);
    }
    let time = over(-dot64(from_, along), square);
    let apart = sum64(from_, scaled64(time, along));
    let inside = minus(exact[at + 6u], dot64(apart, apart));
    return about(time, square, inside, 2.0lf * near * (exact[at + 7u] + near), facet);
}

fn cylinder_start(at: u32, l: Line, started_inside: bool, near: f64, facet: u32) -> Part {
    let axis = vector(at + 3u);
    let from_ = across(difference64(l.o, vector(at)), axis);
    let along = across(l.d, axis);
    let a = dot64(along, along);
    let half_b = dot64(from_, along);
    if !(a >= times_(@SLOW_SQUARE@lf, dot64(l.d, l.d))) || half_b == 0.0lf || (half_b < 0.0lf) != started_inside {
        return unknown_part(-FAR, FAR);
    }
    if !started_inside {
        return nowhere();
    }
    let t = over(times_(-2.0lf, half_b), a);
    let offset = across(difference64(sum64(l.o, scaled64(t, l.d)), vector(at)), axis);
    let value = minus(dot64(offset, offset), exact[at + 6u]);
    let step = over(value, dot64(scaled64(2.0lf, offset), l.d));
    return leaving(t, a, step, 2.0lf * near * (exact[at + 7u] + near), facet);
}

const PLANE: u32 = 1u;
const SPHERE: u32 = 2u;
const CYLINDER: u32 = 3u;
// the ball around a leaf that has other surfaces
const BALL: u32 = 4u;

// In the ball the CPU decides. exact: centre, squared radius
fn ball_part(at: u32, l: Line) -> Part {
    let square = dot(l.d, l.d);
    let time = dot(vector(at) - l.o, l.d) / square;
    let offset = l.o + time * l.d - vector(at);
    let inside = exact[at + 3u] - dot(offset, offset);
    if inside < 0.0lf {
        return nowhere();
    }
    let half = sqrt(inside / square);
    return unknown_part(time - half, time + half);
}

// The row of a facet: kind, inside, numbers, key. A line that starts on a surface has `key * 2 + inside + 1` as its start.
fn facet_part(facet: u32, l: Line, lengths: f64, start: u32) -> Part {
    let row = FACET_ROWS + 4u * facet;
    let at = words[row + 2u];
    let inside = words[row + 1u] == 1u;
    let started = start != 0u && (start - 1u) / 2u == words[row + 3u];
    let side = ((start - 1u) & 1u) == 1u;
    switch words[row] {
        case PLANE: {
            if started {
                return plane_start(at, l, side, inside);
            }
            return plane_part(at, l, near_of(lengths, exact[at + 4u]), inside, facet);
        }
        case SPHERE: {
            let near = near_of(lengths, exact[at + 5u]);
            if started {
                return sphere_start(at, l, side, near, facet);
            }
            return sphere_part(at, l, near, facet);
        }
        case BALL: {
            return ball_part(at, l);
        }
        default: {
            let near = near_of(lengths, exact[at + 8u]);
            if started {
                return cylinder_start(at, l, side, near, facet);
            }
            return cylinder_part(at, l, near, facet);
        }
    }
}

// A thousand times the tolerance of a surface.
fn near_of(lengths: f64, magnitude: f64) -> f64 {
    return @TOLERANCE@lf * (lengths + magnitude);
}

fn largest64(v: vec3<f64>) -> f64 {
    return max(abs(v.x), max(abs(v.y), abs(v.z)));
}

fn taxicab64(v: vec3<f64>) -> f64 {
    return abs(v.x) + abs(v.y) + abs(v.z);
}

// A line in the frame of an atom, and the lengths in it on which the tolerance depends.
struct Framed {
    line: Line,
    lengths: f64,
}

// The row of a frame: maps, number of maps, numbers of its lengths.
fn framed(l: Line, frame: u32) -> Framed {
    let lengths = taxicab64(l.o) + @REACH@lf;
    if frame == NO_FRAME {
        return Framed(l, lengths);
    }
    let row = FRAME_ROWS + 3u * frame;
    let at = words[row];
    var inner = l;
    for (var k = 0u; k < words[row + 1u]; k++) {
        inner = moved(inner, at + 12u * k);
    }
    let own = words[row + 2u];
    return Framed(inner, exact[own] * lengths + exact[own + 1u]);
}

fn both(a: Part, b: Part) -> Part {
    if a.empty || b.empty {
        return nowhere();
    }
    var part = a;
    if b.enter_lo > a.enter_hi {
        part.enter_lo = b.enter_lo;
        part.enter_hi = b.enter_hi;
        part.enter = b.enter;
        part.enter_facet = b.enter_facet;
        part.unclear = (part.unclear & 2u) | (b.unclear & 1u);
    } else if b.enter_hi >= a.enter_lo && b.enter_hi > -FAR {
        part.enter_lo = max(a.enter_lo, b.enter_lo);
        part.enter_hi = max(a.enter_hi, b.enter_hi);
        part.unclear |= 1u;
    }
    if b.leave_hi < a.leave_lo {
        part.leave_lo = b.leave_lo;
        part.leave_hi = b.leave_hi;
        part.leave = b.leave;
        part.leave_facet = b.leave_facet;
        part.unclear = (part.unclear & 1u) | (b.unclear & 2u);
    } else if b.leave_lo <= a.leave_hi && b.leave_lo < FAR {
        part.leave_lo = min(a.leave_lo, b.leave_lo);
        part.leave_hi = min(a.leave_hi, b.leave_hi);
        part.unclear |= 2u;
    }
    part.empty = part.enter_lo > part.leave_hi;
    return part;
}

fn operand(bits: u64, edge: u32) -> u32 {
    return (u32((bits >> (edge >> 1u)) & 1lu)) ^ (edge & 1u);
}

// The region of a point from the atoms that contain it: the last of the outputs.
fn owner_of(atoms: u64) -> u32 {
    var bits = atoms;
    for (var gate = 0u; gate < GATES; gate++) {
        let row = GATE_ROWS + 3u * gate;
        let rule = words[row];
        let first = words[row + 1u];
        var count = 0u;
        for (var k = 0u; k < words[row + 2u]; k++) {
            count += operand(bits, words[first + k]);
        }
        let holds = select(count >= (rule >> 1u), (count & 1u) == 1u, (rule & 1u) == 1u);
        bits |= u64(select(0u, 1u, holds)) << (ATOMS + gate);
    }
    for (var k = OUTPUTS; k > 0u; k--) {
        if operand(bits, words[OUTPUT_ROWS + k - 1u]) == 1u {
            return k;
        }
    }
    return 0u;
}

// The event with the earliest interval, and the start of the next one.
struct First {
    lo: f64,
    hi: f64,
    t: f64,
    facet: u32,
    atom: u32,
    unclear: bool,
    second: f64,
}

fn earlier(first: First, lo: f64, hi: f64, t: f64, facet: u32, atom: u32, unclear: bool) -> First {
    if lo < first.lo {
        return First(lo, hi, t, facet, atom, unclear, first.lo);
    }
    var kept = first;
    kept.second = min(kept.second, lo);
    return kept;
}

// The row of an atom: first facet, number of facets, frame, 1 if the atom is the outside of its facet, numbers of its box.
fn atom_part(row: u32, own: Framed, start: u32) -> Part {
    var part = whole();
    let first = words[row];
    for (var k = 0u; k < words[row + 1u]; k++) {
        part = both(part, facet_part(first + k, own.line, own.lengths, start));
        if part.empty {
            break;
        }
    }
    return part;
}

fn next_crossing(line: Line, start: u32) -> Next {
    var next = Next(DOUBT, 0.0lf, 0u, 0u, 0u);
    var after = 0.0lf;
    for (var round = 0u; round < @ROUNDS@; round++) {
        var bits = 0lu;
        var first = First(FAR, FAR, FAR, 0u, 0u, true, FAR);
        var frame = NO_FRAME;
        var own = framed(line, NO_FRAME);
        for (var atom = 0u; atom < ATOMS; atom++) {
            let row = ATOM_ROWS + 5u * atom;
            if words[row + 2u] != frame {
                frame = words[row + 2u];
                own = framed(line, frame);
            }
            let part = atom_part(row, own, start);
            var inside = false;
            if part.empty {
            } else if !(part.enter_hi < part.leave_lo) {
                let lo = min(part.enter_lo, part.leave_lo);
                let hi = max(part.enter_hi, part.leave_hi);
                if hi > after {
                    if lo <= after {
                        return next;
                    }
                    first = earlier(first, lo, hi, lo, 0u, atom, true);
                }
            } else if part.leave_hi > after {
                if part.leave_lo <= after {
                    return next;
                }
                if part.enter_hi <= after {
                    inside = true;
                    if part.leave_lo < FAR {
                        first = earlier(
                            first, part.leave_lo, part.leave_hi, part.leave, part.leave_facet, atom,
                            (part.unclear & 2u) != 0u
                        );
                    }
                } else if part.enter_lo > after {
                    first = earlier(
                        first, part.enter_lo, part.enter_hi, part.enter, part.enter_facet, atom,
                        (part.unclear & 1u) != 0u
                    );
                } else {
                    return next;
                }
            }
            if inside != (words[row + 3u] == 1u) {
                bits |= 1lu << atom;
            }
        }
        next.before = owner_of(bits);
        if first.lo == FAR {
            next.route = NOTHING;
            next.after = next.before;
            return next;
        }
        if first.unclear || first.second <= first.hi {
            return next;
        }
        next.after = owner_of(bits ^ (1lu << first.atom));
        if next.after != next.before {
            next.route = FOUND;
            next.t = first.t;
            next.facet = first.facet;
            return next;
        }
        after = first.hi;
    }
    return next;
}

// The value of the surface of a facet at a point of a line in its frame, and the gradient.
struct Value {
    f: f64,
    gradient: vec3<f64>,
}

fn value_of(facet: u32, p: vec3<f64>) -> Value {
    let row = FACET_ROWS + 4u * facet;
    let at = words[row + 2u];
    switch words[row] {
        case PLANE: {
            let n = vector(at);
            return Value(minus(dot64(p, n), exact[at + 3u]), n);
        }
        case SPHERE: {
            let offset = difference64(p, vector(at));
            return Value(minus(dot64(offset, offset), exact[at + 3u]), scaled64(2.0lf, offset));
        }
        default: {
            let offset = across(difference64(p, vector(at)), vector(at + 3u));
            return Value(minus(dot64(offset, offset), exact[at + 6u]), scaled64(2.0lf, offset));
        }
    }
}

// A point of a line on a facet, as the CPU computes it: the unit normal, the slope of the surface along the line, and the point,
// moved onto the surface along the normal.
struct Touch {
    is_certain: bool,
    normal: vec3<f64>,
    slope: f64,
    position: vec3<f64>,
}

fn at_time(l: Line, t: f64) -> vec3<f64> {
    return sum64(l.o, scaled64(t, l.d));
}

fn rotated(v: vec3<f64>, at: u32) -> vec3<f64> {
    return sum64(
        sum64(scaled64(v.x, vector(at)), scaled64(v.y, vector(at + 3u))), scaled64(v.z, vector(at + 6u))
    );
}

fn touch(line: Line, t: f64, facet: u32, atom_frame: u32) -> Touch {
    var touched = Touch(false, vec3<f64>(), 0.0lf, vec3<f64>());
    var count = 0u;
    var maps = 0u;
    if atom_frame != NO_FRAME {
        maps = words[FRAME_ROWS + 3u * atom_frame];
        count = words[FRAME_ROWS + 3u * atom_frame + 1u];
    }
    var inner = line;
    for (var k = 0u; k < count; k++) {
        inner = moved(inner, maps + 12u * k);
    }
    let value = value_of(facet, at_time(inner, t));
    var up = value.gradient;
    for (var k = count; k > 0u; k--) {
        let at = maps + 12u * (k - 1u);
        up = vec3<f64>(dot64(vector(at), up), dot64(vector(at + 3u), up), dot64(vector(at + 6u), up));
    }
    let largest = largest64(up);
    if !(largest > 1e-100lf && largest < 1e100lf) {
        return touched;
    }
    up = vec3<f64>(over(up.x, largest), over(up.y, largest), over(up.z, largest));
    touched.slope = dot64(up, line.d);
    let unit = scaled64(over(1.0lf, root(dot64(up, up))), up);
    let rise = dot64(unit, line.d);
    touched.is_certain = abs(rise) > 1e-9lf && (rise > 0.0lf) == (touched.slope > 0.0lf);
    touched.normal = select(unit, -unit, rise > 0.0lf);
    var along = touched.normal;
    for (var k = 0u; k < count; k++) {
        along = rotated(along, maps + 12u * k);
    }
    let step = over(value.f, dot64(value.gradient, along));
    touched.position = difference64(at_time(line, t), scaled64(step, touched.normal));
    return touched;
}

// True if no surface is near a point of the line, except for that with a key: then it has no other start surface.
fn is_alone(line: Line, t: f64, key: u32) -> bool {
    let point = line.o + t * line.d;
    let lengths = taxicab64(line.o) + @REACH@lf;
    var frame = NO_FRAME;
    var own = framed(line, NO_FRAME);
    for (var atom = 0u; atom < ATOMS; atom++) {
        let row = ATOM_ROWS + 5u * atom;
        let box = words[row + 4u];
        let margin = @TOLERANCE@lf * lengths;
        if any(point < vector(box) - margin) || any(point > vector(box + 3u) + margin) {
            continue;
        }
        if words[row + 2u] != frame {
            frame = words[row + 2u];
            own = framed(line, frame);
        }
        let first = words[row];
        for (var k = first; k < first + words[row + 1u]; k++) {
            let facet = FACET_ROWS + 4u * k;
            if words[facet + 3u] == key {
                continue;
            }
            if words[facet] == BALL {
                return false;
            }
            let value = value_of(k, at_time(own.line, t));
            let offset = select(select(8u, 5u, words[facet] == SPHERE), 4u, words[facet] == PLANE);
            let near = near_of(own.lengths, exact[words[facet + 2u] + offset]);
            if !(abs(value.f) > 2.0lf * near * (largest64(value.gradient) + near)) {
                return false;
            }
        }
    }
    return true;
}
