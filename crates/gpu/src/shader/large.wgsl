// The nearest crossing in a union of many items, each a small group, through a bounding volume hierarchy.

const STACK: u32 = @STACK@;
const STEPS: u32 = 64u;

fn reciprocal(d: f32) -> f32 {
    return 1.0 / select(d, select(-1e-12, 1e-12, d >= 0.0), abs(d) < 1e-12);
}

@compute @workgroup_size(@WORKGROUP@)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let i = id.x + id.y * params.row;
    if i >= params.rays {
        return;
    }
    limited = false;
    let r = ray_of(i);
    let inverse = vec3f(reciprocal(r.d.x), reciprocal(r.d.y), reciprocal(r.d.z));
    var from_ = start_of(i);
    var stack: array<vec2u, STACK>;
    var began = NONE;
    for (var step = 0u; step < STEPS; step++) {
        var best = Change(true, 0u, 0u, 0u, BIG, BIG, NONE, 0u);
        var item = NONE;
        // lower bound of the times of all other events
        var other = BIG;
        // the last region that is inside, its item, and the last region of the other items
        var region = 0u;
        var holder = NONE;
        var below = 0u;
        var depth = 1u;
        stack[0] = vec2u(0u, bitcast<u32>(from_.x));
        while depth > 0u {
            depth -= 1u;
            let entry = stack[depth];
            if bitcast<f32>(entry.y) > best.hi {
                continue;
            }
            if (entry.x & 0x80000000u) == 0u {
                // an inner node: 12 rows of planes, 2 of children
                let at = params.nodes + 14u * entry.x;
                let base = depth;
                for (var k = 0u; k < 8u; k++) {
                    let child = bitcast<u32>(data[at + 12u + (k >> 2u)][k & 3u]);
                    if child == NONE {
                        break;
                    }
                    let half = k >> 2u;
                    let lane = k & 3u;
                    let lo = vec3f(data[at + half][lane], data[at + 2u + half][lane], data[at + 4u + half][lane]);
                    let hi = vec3f(data[at + 6u + half][lane], data[at + 8u + half][lane], data[at + 10u + half][lane]);
                    let a = (lo - r.o) * inverse;
                    let b = (hi - r.o) * inverse;
                    let near = min(a, b);
                    let far = max(a, b);
                    let enter = max(max(near.x, near.y), max(near.z, from_.x));
                    let leave = min(far.x, min(far.y, far.z));
                    if enter > leave || enter > best.hi {
                        continue;
                    }
                    // sorted: the nearest child on top
                    var place = depth;
                    while place > base && bitcast<f32>(stack[place - 1u].y) < enter {
                        stack[place] = stack[place - 1u];
                        place -= 1u;
                    }
                    stack[place] = vec2u(child, bitcast<u32>(enter));
                    depth += 1u;
                }
                continue;
            }
            let number = entry.x & 0x7fffffffu;
            let row = tables[params.items + number];
            var local = r;
@PLACED_ITEM@
            let c = walk(row.x, local, from_);
            if !c.certain {
                answers[i] = vec4u(UNCERTAIN, 0u, 0u, 0u);
                return;
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
                } else {
                    other = min(other, c.lo);
                }
            }
        }
        if began == NONE {
            began = region;
        }
        if item == NONE {
            answer(i, Change(true, began, region, region, BIG, BIG, NONE, 0u), 0u);
            return;
        }
        if best.facet == HIDDEN || other <= best.hi {
            answers[i] = vec4u(UNCERTAIN, 0u, 0u, 0u);
            return;
        }
        let own = tables[params.items + item].z;
        let after = select(select(region, below, item == holder), max(region, own), best.start == 0u);
        if medium_of(region) != medium_of(after) {
            best.before = region;
            best.after = after;
            answer(i, best, item);
            return;
        }
        from_ = vec2f(best.hi, best.hi);
    }
    answers[i] = vec4u(UNCERTAIN, 0u, 0u, 0u);
}
