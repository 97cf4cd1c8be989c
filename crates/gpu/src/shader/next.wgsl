// The first crossing of a line after its start, in double precision, with the time of the CPU.
//
// Each event, an entry or exit of an atom, has the time that the CPU's kernel gives, and an interval around it. Outside of the
// interval the line is farther from the surface than a thousand times the CPU's tolerance: no event there is welded, and the order of
// two events with disjoint intervals is certain. Events with overlapping intervals, such as those of faces that touch, are welded by
// the rules of the CPU (`resolved`). Everything else is in doubt, and left to the CPU.
//
// The model is a union of items, each a small network over atoms. A point in several items belongs to the region of the one with the
// highest priority.

// exact: numbers; words: tables of atoms, facets, frames, gates and outputs
@group(0) @binding(0) var<storage, read> exact: array<f64>;
@group(0) @binding(1) var<storage, read> words: array<u32>;

@VECTORS@

const ITEM_ROWS: u32 = @ITEM_ROWS@;
const GROUP_ROWS: u32 = @GROUP_ROWS@;
const ATOM_ROWS: u32 = @ATOM_ROWS@;
const FACET_ROWS: u32 = @FACET_ROWS@;
const FRAME_ROWS: u32 = @FRAME_ROWS@;
const GATE_ROWS: u32 = @GATE_ROWS@;
const CHILDREN: u32 = @CHILDREN@;
const REGION_OF: u32 = @REGION_OF@;
const BOXES: u32 = @BOXES@;
const STACK: u32 = @STACK@;
@SHARED@
const FAR: f64 = 1e300lf;

const FOUND: u32 = 0u;
const NOTHING: u32 = 1u;
const DOUBT: u32 = 2u;

struct Next {
    // FOUND, NOTHING or DOUBT
    route: u32,
    t: f64,
    facet: u32,
    item: u32,
    // the face of the region behind
    entered_facet: u32,
    entered_item: u32,
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

// The word of the start list of a line for a surface, 0 if the line does not start on it: twice its key, plus 1, plus 1 on its inside.
fn start_on(key: u32, starts: vec4u) -> u32 {
    let same = ((starts - 1u) >> vec4u(1u)) == vec4u(key);
    let found = select(vec4u(), starts, same);
    return max(max(found.x, found.y), max(found.z, found.w));
}

// The row of a facet: kind, inside, numbers, key in the item, frame in the item.
fn facet_part(facet: u32, own: Framed, first_key: u32, starts: vec4u) -> Part {
    let row = FACET_ROWS + 5u * facet;
    let at = words[row + 2u];
    let inside = words[row + 1u] == 1u;
    let start = start_on(first_key + words[row + 3u], starts);
    let started = start != 0u;
    let side = (start & 1u) == 0u;
    let l = own.line;
    switch words[row] {
        case PLANE: {
            if started {
                return plane_start(at, l, side, inside);
            }
            return plane_part(at, l, near_of(own.lengths, exact[at + 4u]), inside, facet);
        }
        case SPHERE: {
            let near = near_of(own.lengths, exact[at + 5u]);
            if started {
                return sphere_start(at, l, side, near, facet);
            }
            return sphere_part(at, l, near, facet);
        }
        case BALL: {
            return ball_part(at, l);
        }
        default: {
            let near = near_of(own.lengths, exact[at + 8u]);
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

// The magnitude of the surface of a facet.
fn magnitude_of(facet: u32) -> f64 {
    let row = FACET_ROWS + 5u * facet;
    return exact[words[row + 2u] + select(select(8u, 5u, words[row] == SPHERE), 4u, words[row] == PLANE)];
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

// The row of a frame: maps, number of maps, numbers of its lengths. Behind each map are its norm and the length of its path.
const MAP: u32 = 14u;

fn framed(l: Line, frame: u32) -> Framed {
    let lengths = taxicab64(l.o) + @REACH@lf;
    let row = FRAME_ROWS + 3u * frame;
    let at = words[row];
    var inner = l;
    for (var k = 0u; k < words[row + 1u]; k++) {
        inner = moved(inner, at + MAP * k);
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

fn operand(bits: u64, edge: u32) -> bool {
    return ((u32(bits >> (edge >> 1u)) ^ edge) & 1u) == 1u;
}

// True if a point is in a group, from the atoms that contain it. The row of a group: first atom, number of atoms, first gate, number
// of gates, output.
fn holds(group: u32, atoms: u64) -> bool {
    var bits = atoms;
    let count = words[group + 1u];
    for (var gate = 0u; gate < words[group + 3u]; gate++) {
        let row = GATE_ROWS + 3u * (words[group + 2u] + gate);
        let rule = words[row];
        let first = words[row + 1u];
        var held = 0u;
        for (var k = 0u; k < words[row + 2u]; k++) {
            held += select(0u, 1u, operand(bits, words[first + k]));
        }
        if select(held >= (rule >> 1u), (held & 1u) == 1u, (rule & 1u) == 1u) {
            bits |= 1lu << (count + gate);
        }
    }
    return operand(bits, words[group + 4u]);
}

// The side of an atom at a time, and its first event after it.
struct Turn {
    // true if the interval of an event contains the time
    doubt: bool,
    inside: bool,
    // FAR without an event
    lo: f64,
    hi: f64,
    t: f64,
    facet: u32,
    unclear: bool,
    // the begin of the interval of the event after it
    next: f64,
}

fn turn_of(part: Part, time: f64) -> Turn {
    var turn = Turn(false, false, FAR, FAR, FAR, 0u, false, FAR);
    if part.empty {
        return turn;
    }
    if !(part.enter_hi < part.leave_lo) {
        let hi = max(part.enter_hi, part.leave_hi);
        if hi > time {
            let lo = min(part.enter_lo, part.leave_lo);
            turn = Turn(lo <= time, false, lo, hi, lo, 0u, true, FAR);
        }
        return turn;
    }
    if part.leave_hi <= time {
        return turn;
    }
    if part.enter_hi <= time {
        let doubt = part.leave_lo <= time;
        let unclear = (part.unclear & 2u) != 0u;
        if part.leave_lo < FAR {
            return Turn(doubt, true, part.leave_lo, part.leave_hi, part.leave, part.leave_facet, unclear, FAR);
        }
        turn.inside = true;
        return turn;
    }
    let doubt = part.enter_lo <= time;
    let unclear = (part.unclear & 1u) != 0u;
    return Turn(doubt, false, part.enter_lo, part.enter_hi, part.enter, part.enter_facet, unclear, part.leave_lo);
}

// An item along a line. The row of an item: group, first frame, region, first key, number of its leaf.
struct Seen {
    row: u32,
    group: u32,
    frame: u32,
    own: Framed,
}

fn seen(item: u32, line: Line) -> Seen {
    let row = ITEM_ROWS + 5u * item;
    let frame = words[row + 1u];
    return Seen(row, GROUP_ROWS + 5u * words[row], frame, framed(line, frame));
}

// The part of a line in an atom, by the place of its row: first facet, number of facets, frame in the item, twice the number of its
// leaf, plus 1 if the atom is the outside of its facet.
fn atom_part(atom: u32, item: Seen, line: Line, starts: vec4u) -> Part {
    var own = item.own;
    if words[atom + 2u] != 0u {
        own = framed(line, item.frame + words[atom + 2u]);
    }
    var part = whole();
    let first = words[atom];
    for (var k = 0u; k < words[atom + 1u]; k++) {
        part = both(part, facet_part(first + k, own, words[item.row + 3u], starts));
        if part.empty {
            break;
        }
    }
    return part;
}

// The first events of all items, in intervals that may overlap, and what is inside before them.
struct Scan {
    doubt: bool,
    lo: f64,
    hi: f64,
    t: f64,
    facet: u32,
    item: u32,
    unclear: bool,
    // the begin of the interval of the next change
    second: f64,
    // the highest priority of the items around the point, the item, and the highest priority of the other ones
    highest: u32,
    holder: u32,
    below: u32,
}

// The events of touching faces: time, leaf, facet, item, its priority, and whether it is inside before.
const MOST: u32 = 6u;
var<private> event_t: array<f64, MOST>;
var<private> event_leaf: array<u32, MOST>;
var<private> event_facet: array<u32, MOST>;
var<private> event_item: array<u32, MOST>;
var<private> event_priority: array<u32, MOST>;
var<private> event_inside: array<bool, MOST>;
var<private> events: u32;

// Adds an event, in order of time and leaf.
fn add_event(t: f64, leaf: u32, facet: u32, item: u32, priority: u32, inside: bool) {
    var at = events;
    while at > 0u && (event_t[at - 1u] > t || (event_t[at - 1u] == t && event_leaf[at - 1u] > leaf)) {
        event_t[at] = event_t[at - 1u];
        event_leaf[at] = event_leaf[at - 1u];
        event_facet[at] = event_facet[at - 1u];
        event_item[at] = event_item[at - 1u];
        event_priority[at] = event_priority[at - 1u];
        event_inside[at] = event_inside[at - 1u];
        at -= 1u;
    }
    event_t[at] = t;
    event_leaf[at] = leaf;
    event_facet[at] = facet;
    event_item[at] = item;
    event_priority[at] = priority;
    event_inside[at] = inside;
    events += 1u;
}

// The first change of an item after a time.
fn first_change(scan_: Scan, number: u32, line: Line, starts: vec4u, after: f64) -> Scan {
    var scan = scan_;
    let item = seen(number, line);
    let atoms = words[item.group + 1u];
    let first_atom = ATOM_ROWS + 4u * words[item.group];
    let priority = words[item.row + 2u];
    var time = after;
    var is_inside = false;
    for (var round = 0u; round < @EVENTS@; round++) {
        var bits = 0lu;
        var first = Turn(false, false, FAR, FAR, FAR, 0u, false, FAR);
        var which = 0u;
        var second = FAR;
        for (var k = 0u; k < atoms; k++) {
            let atom = first_atom + 4u * k;
            let turn = turn_of(atom_part(atom, item, line, starts), time);
            if turn.doubt {
                scan.doubt = true;
                return scan;
            }
            if turn.inside != ((words[atom + 3u] & 1u) == 1u) {
                bits |= 1lu << k;
            }
            if turn.lo < first.lo {
                second = first.lo;
                first = turn;
                which = k;
            } else {
                second = min(second, turn.lo);
            }
        }
        let inside = holds(item.group, bits);
        if round == 0u {
            is_inside = inside;
            if inside && priority > scan.highest {
                scan.below = scan.highest;
                scan.highest = priority;
                scan.holder = number;
            } else if inside {
                scan.below = max(scan.below, priority);
            }
        }
        // later ones do not matter
        if first.lo > scan.hi || first.lo == FAR {
            return scan;
        }
        let unclear = first.unclear || second <= first.hi;
        if unclear || holds(item.group, bits ^ (1lu << which)) != is_inside {
            if first.lo < scan.lo {
                scan.second = scan.lo;
                scan.lo = first.lo;
                scan.hi = first.hi;
                scan.t = first.t;
                scan.facet = first.facet;
                scan.item = number;
                scan.unclear = unclear;
            } else {
                scan.second = min(scan.second, first.lo);
            }
            return scan;
        }
        time = first.hi;
    }
    scan.doubt = true;
    return scan;
}

// Adds the event of an item within the interval of the scan, which it enlarges.
fn gather(scan_: Scan, number: u32, line: Line, starts: vec4u, after: f64) -> Scan {
    var scan = scan_;
    let item = seen(number, line);
    let first_atom = ATOM_ROWS + 4u * words[item.group];
    let priority = words[item.row + 2u];
    var bits = 0lu;
    var turning = 0u;
    var which = 0u;
    var found = Turn(false, false, FAR, FAR, FAR, 0u, false, FAR);
    for (var k = 0u; k < words[item.group + 1u]; k++) {
        let atom = first_atom + 4u * k;
        let part = atom_part(atom, item, line, starts);
        var turn = turn_of(part, after);
        // events before the interval
        for (var past = 0u; past < 2u && turn.hi < scan.lo && !turn.unclear; past++) {
            turn = turn_of(part, turn.hi);
        }
        scan.doubt = scan.doubt || turn.doubt;
        if turn.inside != ((words[atom + 3u] & 1u) == 1u) {
            bits |= 1lu << k;
        }
        if turn.lo <= scan.hi {
            scan.doubt = scan.doubt || turn.unclear || turning > 0u;
            found = turn;
            which = k;
            turning += 1u;
        }
    }
    let inside = holds(item.group, bits);
    if turning == 1u && holds(item.group, bits ^ (1lu << which)) != inside {
        scan.second = max(scan.second, found.hi);
        // both events of an atom, or too many
        if found.next <= max(scan.hi, found.hi) || events == MOST {
            scan.doubt = true;
            return scan;
        }
        var leaf = words[item.row + 4u];
        if leaf == NONE {
            leaf = words[first_atom + 4u * which + 3u] >> 1u;
        }
        add_event(found.t, leaf, found.facet, number, priority, inside);
    } else if inside {
        scan.highest = max(scan.highest, priority);
    }
    return scan;
}

// Subtrees yet to visit: node, or item with the highest bit set, and the time at which the line enters its box.
var<private> stack: array<u32, STACK>;
var<private> stack_time: array<f64, STACK>;

fn reciprocal64(d: f64) -> f64 {
    return 1.0lf / select(d, select(-1e-100lf, 1e-100lf, d >= 0.0lf), abs(d) < 1e-100lf);
}

// The region at a time and the first changes after it, or the events in an interval of times. Boxes are grown by far more than the
// rounding of the slabs.
fn scanned(line: Line, starts: vec4u, after: f64, begin: Scan, gathers: bool) -> Scan {
    var scan = begin;
    let inverse = vec3<f64>(reciprocal64(line.d.x), reciprocal64(line.d.y), reciprocal64(line.d.z));
    var depth = 0u;
    var next = 0u;
    loop {
        if next >= ITEM && next != NONE {
            if gathers {
                scan = gather(scan, next ^ ITEM, line, starts, after);
            } else {
                scan = first_change(scan, next ^ ITEM, line, starts, after);
            }
            if scan.doubt {
                return scan;
            }
            next = NONE;
        } else if next != NONE {
            let node = next;
            var time = FAR;
            next = NONE;
            for (var k = 0u; k < 8u; k++) {
                let child = words[CHILDREN + 8u * node + k];
                if child == NONE {
                    break;
                }
                let at = BOXES + 48u * node + k;
                let a = (vec3<f64>(exact[at], exact[at + 8u], exact[at + 16u]) - line.o) * inverse;
                let b = (vec3<f64>(exact[at + 24u], exact[at + 32u], exact[at + 40u]) - line.o) * inverse;
                let near = min(a, b);
                let far = max(a, b);
                let enter = max(max(near.x, near.y), max(near.z, after));
                if enter > min(min(far.x, far.y), min(far.z, scan.hi)) {
                    continue;
                }
                // the nearest first
                if enter < time {
                    if next != NONE {
                        stack[depth] = next;
                        stack_time[depth] = time;
                        depth += 1u;
                    }
                    next = child;
                    time = enter;
                } else {
                    stack[depth] = child;
                    stack_time[depth] = enter;
                    depth += 1u;
                }
            }
        }
        while next == NONE && depth > 0u {
            depth -= 1u;
            if stack_time[depth] <= scan.hi {
                next = stack[depth];
            }
        }
        if next == NONE {
            return scan;
        }
    }
    return scan;
}

const NO_SCAN = Scan(false, FAR, FAR, FAR, 0u, 0u, false, FAR, 0u, NONE, 0u);

fn next_crossing(line: Line, starts: vec4u) -> Next {
    var next = Next(DOUBT, 0.0lf, 0u, 0u, 0u, 0u, 0u, 0u);
    var after = 0.0lf;
    var begin = NO_SCAN;
    var gathers = false;
    for (var round = 0u; round < 64u; round++) {
        events = 0u;
        let scan = scanned(line, starts, after, begin, gathers);
        if scan.doubt {
            return next;
        }
        if gathers && scan.second > scan.hi {
            // an interval reaches beyond the others
            begin.hi = scan.second;
            continue;
        }
        if gathers {
            next = resolved(line, scan.highest);
            if next.route != NOTHING {
                return next;
            }
            next.route = DOUBT;
            after = scan.hi;
        } else {
            next.before = region_of(scan.highest);
            if scan.lo == FAR {
                next.route = NOTHING;
                next.after = next.before;
                return next;
            }
            if scan.unclear {
                return next;
            }
            if scan.second <= scan.hi {
                begin = Scan(false, scan.lo, scan.hi, FAR, 0u, 0u, false, scan.hi, 0u, NONE, 0u);
                gathers = true;
                continue;
            }
            if scan.item == scan.holder {
                next.after = region_of(scan.below);
            } else {
                next.after = region_of(max(scan.highest, words[ITEM_ROWS + 5u * scan.item + 2u]));
            }
            if next.after != next.before {
                next.route = FOUND;
                next.t = scan.t;
                next.facet = scan.facet;
                next.item = scan.item;
                next.entered_facet = scan.facet;
                next.entered_item = scan.item;
                return next;
            }
            after = scan.hi;
        }
        begin = NO_SCAN;
        gathers = false;
    }
    return next;
}
