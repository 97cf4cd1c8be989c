// The nearest crossing in a union of many items, each a small group, through a bounding volume hierarchy.

const STACK: u32 = @STACK@;
const STEPS: u32 = 64u;

fn reciprocal(d: f32) -> f32 {
    return 1.0 / select(d, select(-1e-12, 1e-12, d >= 0.0), abs(d) < 1e-12);
}

// Subtrees yet to visit: node, or leaf with the highest bit set, and the time at which the ray enters its box.
var<private> stack: array<vec2u, STACK>;
var<private> depth: u32;

const EMPTY = vec2u(NONE, 0x7f800000u);

// The next subtree that the ray enters no later than `limit`; EMPTY if none is left.
fn popped(limit: f32) -> vec2u {
    while depth > 0u {
        depth -= 1u;
        let entry = stack[depth];
        if bitcast<f32>(entry.y) <= limit {
            return entry;
        }
    }
    return EMPTY;
}

// The nearer of two subtrees; the other one goes onto the stack.
fn nearer(next: vec2u, child: u32, enter: f32, far: f32) -> vec2u {
    if child == NONE || enter > far {
        return next;
    }
    let entry = vec2u(child, bitcast<u32>(enter));
    let is_first = enter < bitcast<f32>(next.y);
    if next.x != NONE {
        stack[depth] = select(entry, next, is_first);
        depth += 1u;
    }
    return select(next, entry, is_first);
}

// The child of an inner node that the ray enters first; the others go onto the stack.
fn descended(node: u32, r: Ray, inverse: vec3f, from_: f32, limit: f32) -> vec2u {
    // 12 rows of planes
    let at = params.nodes + 12u * node;
    var next = EMPTY;
    for (var half = 0u; half < 2u; half++) {
        // four boxes at a time
        let children = tables[params.children + 2u * node + half];
        if children.x == NONE {
            break;
        }
        let ax = (data[at + half] - r.o.x) * inverse.x;
        let ay = (data[at + 2u + half] - r.o.y) * inverse.y;
        let az = (data[at + 4u + half] - r.o.z) * inverse.z;
        let bx = (data[at + 6u + half] - r.o.x) * inverse.x;
        let by = (data[at + 8u + half] - r.o.y) * inverse.y;
        let bz = (data[at + 10u + half] - r.o.z) * inverse.z;
        let near = max(max(min(ax, bx), min(ay, by)), max(min(az, bz), vec4f(from_)));
        let far = min(min(min(max(ax, bx), max(ay, by)), max(az, bz)), vec4f(limit));
        next = nearer(next, children.x, near.x, far.x);
        next = nearer(next, children.y, near.y, far.y);
        next = nearer(next, children.z, near.z, far.z);
        next = nearer(next, children.w, near.w, far.w);
    }
    return next;
}

// The first change of medium after `start`.
fn find(r: Ray, start: vec2f) -> Found {
    var from_ = start;
    let inverse = vec3f(reciprocal(r.d.x), reciprocal(r.d.y), reciprocal(r.d.z));
    var began = NONE;
    for (var step = 0u; step < STEPS; step++) {
        // for the region at the start, only boxes around it count
        var best = Change(true, 0u, 0u, 0u, BIG, select(BIG, from_.y, ONLY_START), NONE, 0u);
        var item = NONE;
        var best_tied = vec2u();
        // lower bound of the times of all other events
        var other = BIG;
        // the last region that is inside, its item, and the last region of the other items
        var region = 0u;
        var holder = NONE;
        var below = 0u;
        depth = 0u;
        var next = vec2u(0u, bitcast<u32>(from_.x));
        loop {
            // inner nodes up to the next leaf, so that the rays of a subgroup reach their leaves at the same time
            while next.x < ITEM {
                next = descended(next.x, r, inverse, from_.x, best.hi);
                if next.x == NONE {
                    next = popped(best.hi);
                }
            }
            if next.x == NONE {
                break;
            }
            let number = next.x ^ ITEM;
            let row = tables[params.items + number];
            var local = r;
@PLACED_ITEM@
            let c = walk(@GROUP@, local, from_);
            if !c.certain {
                return lost();
            }
            if c.start != 0u {
                if row.z > region {
                    below = region;
                    region = row.z;
                    holder = number;
                } else {
                    below = max(below, row.z);
                }
            }
            if c.facet != NONE {
                if c.lo < best.lo {
                    other = min(other, best.lo);
                    best = c;
                    item = number;
                    best_tied = tied;
                } else {
                    other = min(other, c.lo);
                }
            }
            next = popped(best.hi);
        }
        if began == NONE {
            began = region;
        }
        tied = vec2u();
        if item == NONE {
            return Found(Change(true, began, region, region, BIG, BIG, NONE, 0u), 0u);
        }
        if best.facet == HIDDEN || other <= best.hi {
            return lost();
        }
        let own = tables[params.items + item].z;
        let after = select(select(region, below, item == holder), max(region, own), best.start == 0u);
        if medium_of(region) != medium_of(after) {
            best.before = region;
            best.after = after;
            best.start = began;
            tied = best_tied;
            return Found(best, item);
        }
        from_ = vec2f(best.hi, best.hi);
    }
    return lost();
}
