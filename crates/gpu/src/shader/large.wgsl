// The nearest crossing in a union of many items, each a small group, through a bounding volume hierarchy.

const STACK: u32 = @STACK@;
const STEPS: u32 = 64u;

fn reciprocal(d: f32) -> f32 {
    return 1.0 / select(d, select(-1e-12, 1e-12, d >= 0.0), abs(d) < 1e-12);
}

// The first change of medium after `start`.
fn find(r: Ray, start: vec2f) -> Found {
    var from_ = start;
    let inverse = vec3f(reciprocal(r.d.x), reciprocal(r.d.y), reciprocal(r.d.z));
    var stack: array<vec2u, STACK>;
    var began = NONE;
    for (var step = 0u; step < STEPS; step++) {
        // for the region at the start, only boxes around it count
        var best = Change(true, 0u, 0u, 0u, BIG, select(BIG, from_.y, ONLY_START), NONE, 0u);
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
                // an inner node: 12 rows of planes
                let at = params.nodes + 12u * entry.x;
                let base = depth;
                for (var half = 0u; half < 2u; half++) {
                    // four boxes at a time
                    let children = tables[params.children + 2u * entry.x + half];
                    if children.x == NONE {
                        break;
                    }
                    let ax = (data[at + half] - r.o.x) * inverse.x;
                    let ay = (data[at + 2u + half] - r.o.y) * inverse.y;
                    let az = (data[at + 4u + half] - r.o.z) * inverse.z;
                    let bx = (data[at + 6u + half] - r.o.x) * inverse.x;
                    let by = (data[at + 8u + half] - r.o.y) * inverse.y;
                    let bz = (data[at + 10u + half] - r.o.z) * inverse.z;
                    let near = max(max(min(ax, bx), min(ay, by)), max(min(az, bz), vec4f(from_.x)));
                    let far = min(min(max(ax, bx), max(ay, by)), max(az, bz));
                    for (var lane = 0u; lane < 4u; lane++) {
                        let enter = near[lane];
                        if children[lane] == NONE || enter > far[lane] || enter > best.hi {
                            continue;
                        }
                        // sorted: the nearest child on top
                        var place = depth;
                        while place > base && bitcast<f32>(stack[place - 1u].y) < enter {
                            stack[place] = stack[place - 1u];
                            place -= 1u;
                        }
                        stack[place] = vec2u(children[lane], bitcast<u32>(enter));
                        depth += 1u;
                    }
                }
                continue;
            }
            let number = entry.x & 0x7fffffffu;
            let row = tables[params.items + number];
            var local = r;
@PLACED_ITEM@
            let c = walk(row.x, local, from_);
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
                } else {
                    other = min(other, c.lo);
                }
            }
        }
        if began == NONE {
            began = region;
        }
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
            return Found(best, item);
        }
        from_ = vec2f(best.hi, best.hi);
    }
    return lost();
}
