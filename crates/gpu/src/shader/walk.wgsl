// Boundary events and the boolean network of one group.

// with constant sizes, checks of indices are comparisons with constants
@group(0) @binding(0) var<storage, read> data: array<vec4f, @DATA_ROWS@>;
@group(0) @binding(1) var<storage, read> tables: array<vec4u, @TABLE_ROWS@>;
@group(0) @binding(3) var<storage, read_write> answers: array<vec4u>;
@group(0) @binding(4) var<uniform> params: Params;

// First rows of the tables, and the number of rays.
struct Params {
    facets: u32,
    atoms: u32,
    gates: u32,
    outputs: u32,
    groups: u32,
    items: u32,
    media: u32,
    nodes: u32,
    rays: u32,
    row: u32,
    bounded: u32,
    children: u32,
    // 0, which the compiler does not know
    zero: u32,
    // for times in double precision: whether items have maps, and their first row
    placed_items: u32,
    items_lookup: u32,
    unused: u32,
}

// A face that two facets compete for, and an interval in which an atom's side is not known.
const EITHER: u32 = 0xfffffffeu;
const HIDDEN: u32 = 0xfffffffdu;
const ATOMS: u32 = @ATOMS@;
// True if the CPU computes the order of events that the device passes to it.
const COMPLETES: bool = @COMPLETES@;
// True if only the regions at the starts of the windows are computed.
const ONLY_START: bool = @ONLY_START@;

// The events of an atom: its side before them, and up to two intervals with the facet crossed in each.
struct Events {
    inside: bool,
    t: vec4f,
    f0: u32,
    f1: u32,
}

// The first change of value of a group after a time.
struct Change {
    // false if the value at that time is not certain
    certain: bool,
    // regions at that time, just before the change and after it
    start: u32,
    before: u32,
    after: u32,
    lo: f32,
    hi: f32,
    // the facet; NONE without a change, HIDDEN if the value is not certain from `lo` on
    facet: u32,
    // the atom; NONE if several change in the same surface
    atom: u32,
}

fn roots_of(facet: vec4u, r: Ray) -> Roots {
    let kind = facet.y >> 1u;
    var roots = unknown();
    switch kind {
        case PLANE: { roots = plane(facet.x, r); }
@KINDS@
        default: {}
    }
    // a facet with inside = 0 lies where f > 0
    roots.inside = roots.inside == ((facet.y & 1u) == 1u);
    return roots;
}

fn events_of(k: u32, group_ray: Ray) -> Events {
    let atom = tables[params.atoms + 2u * k];
    var r = group_ray;
@PLACED_ATOM@
    var enter = vec2f(-BIG, -BIG);
    var leave = vec2f(BIG, BIG);
    var fe = NONE;
    var fl = NONE;
    var hidden = false;
    for (var i = 0u; i < atom.y; i++) {
        let roots = roots_of(tables[params.facets + atom.x + i], r);
        let id = atom.x + i;
        if roots.n == UNKNOWN {
            if atom.y == 1u {
                return Events(roots.inside, vec4f(roots.lo0, roots.hi0, BIG, BIG), HIDDEN, NONE);
            }
            // outside of the interval a facet with f < 0 does not hold
            if !roots.inside {
                enter = max(enter, vec2f(roots.lo0));
                leave = min(leave, vec2f(roots.hi0));
            }
            hidden = true;
            continue;
        }
        if roots.n == 0u {
            if roots.inside {
                continue;
            }
            return Events(false, vec4f(BIG), NONE, NONE);
        }
        if roots.n == 2u && roots.inside {
            if atom.y == 1u {
                return Events(true, vec4f(roots.lo0, roots.hi0, roots.lo1, roots.hi1), id, id);
            }
            hidden = true;
            continue;
        }
        if roots.n == 2u || !roots.inside {
            // the later of both entries
            if roots.lo0 > enter.y {
                enter = vec2f(roots.lo0, roots.hi0);
                fe = id;
            } else if roots.hi0 >= enter.x {
                enter = max(enter, vec2f(roots.lo0, roots.hi0));
                fe = EITHER;
            }
        }
        if roots.n == 2u || roots.inside {
            let out = select(vec2f(roots.lo0, roots.hi0), vec2f(roots.lo1, roots.hi1), roots.n == 2u);
            if out.y < leave.x {
                leave = out;
                fl = id;
            } else if out.x <= leave.y {
                leave = min(leave, out);
                fl = EITHER;
            }
        }
        if enter.x > leave.y {
            return Events(false, vec4f(BIG), NONE, NONE);
        }
    }
    if hidden || enter.y >= leave.x {
        return Events(false, vec4f(enter.x, leave.y, BIG, BIG), HIDDEN, NONE);
    }
    return Events(fe == NONE, vec4f(enter, leave), fe, fl);
}

struct Started {
    events: Events,
    // false if the side at the start is not certain
    certain: bool,
}

// The events of an atom after a certain time in an interval, and its side there.
fn started_at(all: Events, from_: vec2f) -> Started {
    var e = all;
    var certain = true;
    if e.f0 != NONE {
        if e.t.y <= from_.x {
            e.inside = e.inside != (e.f0 != HIDDEN);
            e.f0 = NONE;
        } else if e.t.x <= from_.y {
            certain = false;
        }
    }
    if e.f1 != NONE {
        if e.t.w <= from_.x {
            e.inside = !e.inside;
            e.f1 = NONE;
        } else if e.t.z <= from_.y {
            certain = false;
        }
    }
    return Started(e, certain);
}

// The key of a facet: equal for facets in one surface at one placement.
fn key_of(facet: u32) -> u32 {
    if facet >= HIDDEN {
        return facet;
    }
    return tables[params.facets + facet].z;
}

// True if a ray passes a ball at a distance. data: centre, squared radius.
fn passes(at: u32, r: Ray) -> bool {
    let m = data[at];
    let q = r.o - m.xyz;
    let s = -sum(q * r.d) / sum(r.d * r.d);
    let sd = s * r.d;
    let p = q + sd;
    let ep = ROOM * (EPS * (largest(q) + largest(sd) + largest(p)) + r.eo + abs(s) * r.ed) + TINY;
    let pp = sum(p * p);
    return pp - m.w > ROOM * (2.0 * l1(p) * ep + EPS * (4.0 * pp + 3.0 * m.w)) + TINY;
}

fn medium_of(region: u32) -> u32 {
    return tables[params.media + (region >> 2u)][region & 3u];
}

// For the last change of `walk`: 0, or the events among which the CPU decides.
var<private> tied: vec2u;

fn uncertain(start: u32, lo: f32) -> Change {
    return Change(true, start, start, start, lo, BIG, HIDDEN, 0u);
}

@WALK@
// True if the window starts before -FAR.
var<private> early: bool;

// The start of the window as an interval of times.
fn window_start(start: f32) -> vec2f {
    // nothing of a bounded model lies before -FAR
    let t = max(start, select(-BIG, -FAR, params.bounded == 1u));
    early = t < -FAR;
    return vec2f(t - 4.0 * EPS * abs(t), t + 4.0 * EPS * abs(t));
}

struct Found {
    change: Change,
    item: u32,
}

fn lost() -> Found {
    return Found(Change(false, 0u, 0u, 0u, -BIG, BIG, HIDDEN, 0u), 0u);
}

// A change as the CPU reads it: facet and flags, item, regions before and after, time.
fn packed(found: Found) -> vec4u {
    let c = found.change;
    let is_tied = tied.x != 0u;
    if !c.certain || c.facet == HIDDEN || (is_tied && !COMPLETES) || (limited && params.bounded == 0u && (c.hi > FAR || early)) {
        // the time shows where the answer is open
        return vec4u(UNCERTAIN, u32(c.certain), 0u, bitcast<u32>(c.lo));
    }
    if c.facet == NONE {
        return vec4u(MISS, 0u, (c.start << 16u) | c.start, 0u);
    }
    let flags = select(0u, SHARED, c.atom == NONE) | select(0u, TIED, is_tied);
    return vec4u(c.facet | flags, found.item, (c.before << 16u) | c.after, bitcast<u32>(0.5 * (c.lo + c.hi)));
}
