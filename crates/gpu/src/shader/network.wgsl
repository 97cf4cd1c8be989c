// The walk along a group of atoms, through its boolean network.

@NETWORK@

// The last region that is inside; 0 if none is.
fn owner(group: vec4u, outputs: vec4u, bits: Bits) -> u32 {
    let nodes = evaluated(group, bits);
    for (var i = outputs.y; i > 0u; i--) {
        let out = tables[params.outputs + outputs.x + i - 1u];
        if holds(nodes, out.x) {
            return out.y;
        }
    }
    return 0u;
}

// Events with overlapping intervals, in an order that is not known.
struct Tie {
    // the number of events and, of each, the number of the atom in the group and the facet
    count: u32,
    events: array<vec2u, MOST_GATHERED>,
    // bit s is 1 if the events in the set s change the region from `before` to `after`, and 0 if they do not change it
    table: u32,
    after: u32,
    // false if the region has another value in between
    is_clear: bool,
}

// Events that are gathered, and those that the CPU decides about.
const MOST_GATHERED: u32 = 5u;
const MOST_TIED: u32 = 4u;

// The events of a set, as a change of bits.
fn changed(tie: Tie, subset: u32) -> Bits {
    var bits = no_bits();
    for (var j = 0u; j < tie.count; j++) {
        if ((subset >> j) & 1u) == 1u {
            bits = flipped(bits, tie.events[j].x);
        }
    }
    return bits;
}

// The regions after every subset of the events.
fn tabulated(given: Tie, group: vec4u, outputs: vec4u, bits: Bits, before: u32) -> Tie {
    var tie = given;
    let medium = medium_in(outputs, before);
    tie.table = 0u;
    tie.after = before;
    tie.is_clear = true;
    for (var s = 1u; s < (1u << tie.count); s++) {
        let region = owner(group, outputs, both(bits, changed(tie, s)));
        if region == before {
            continue;
        }
        if tie.after == before {
            tie.after = region;
            tie.is_clear = medium_in(outputs, region) != medium;
        }
        tie.is_clear = tie.is_clear && region == tie.after;
        tie.table |= 1u << s;
    }
    return tie;
}

// The events that matter in any order.
fn reduced(tie: Tie) -> Tie {
    var kept = tie;
    kept.count = 0u;
    var numbers: array<u32, MOST_GATHERED>;
    for (var j = 0u; j < tie.count; j++) {
        var matters = false;
        for (var s = 0u; s < (1u << tie.count); s++) {
            matters = matters || (((tie.table >> s) ^ (tie.table >> (s ^ (1u << j)))) & 1u) == 1u;
        }
        if matters {
            kept.events[kept.count] = tie.events[j];
            numbers[kept.count] = j;
            kept.count += 1u;
        }
    }
    kept.table = 0u;
    for (var s = 0u; s < (1u << kept.count); s++) {
        var subset = 0u;
        for (var j = 0u; j < kept.count; j++) {
            subset |= ((s >> j) & 1u) << numbers[j];
        }
        kept.table |= ((tie.table >> subset) & 1u) << s;
    }
    return kept;
}

// Passes the events to the CPU, which computes their order; false if they do not fit. See `Tied` in `tied.rs`.
fn passed_on(tie: Tie) -> bool {
    if tie.count > MOST_TIED {
        return false;
    }
    let base = tie.events[0].y;
    var offsets = array<u32, MOST_TIED>(0u, 0u, 0u, 0u);
    var fits = true;
    for (var j = 0u; j < tie.count; j++) {
        let facet = tie.events[j].y;
        fits = fits && facet < HIDDEN && max(facet, base) - min(facet, base) < 0x8000u;
        offsets[j] = (facet - base) & 0xffffu;
    }
    tied = vec2u(tie.table | (offsets[1] << 16u), offsets[2] | (offsets[3] << 16u));
    return fits;
}

var<private> times: array<vec4f, ATOMS>;
var<private> first: array<u32, ATOMS>;
var<private> second: array<u32, ATOMS>;
// the atoms with events after the start, by their number in the group
var<private> which: array<u32, ATOMS>;

// The first change of medium (of value, for a placed group) of a group after `from`, a certain time in an interval.
fn walk(g: u32, r: Ray, from_: vec2f) -> Change {
    tied = vec2u();
    let group = tables[params.groups + 2u * g];
    let outputs = tables[params.groups + 2u * g + 1u];
    var bits = no_bits();
    var certain = true;
    var live = 0u;
@NEAR_ATOMS@
    for (var j = 0u; j < near; j++) {
        let k = @NEAR_ATOM@;
        let started = started_at(events_of(group.x + k, r), from_);
        let e = started.events;
        certain = certain && started.certain;
        if e.f0 != NONE || e.f1 != NONE {
            times[live] = e.t;
            first[live] = e.f0;
            second[live] = e.f1;
            which[live] = k;
            live += 1u;
        }
        if e.inside {
            bits = flipped(bits, k);
        }
    }
    if !certain {
        return Change(false, 0u, 0u, 0u, from_.x, BIG, HIDDEN, 0u);
    }
    let start = owner(group, outputs, bits);
    if ONLY_START {
        return Change(true, start, start, start, BIG, BIG, NONE, 0u);
    }
    var region = start;
    for (var step = 0u; step < 2u * ATOMS + 1u; step++) {
        // the earliest event
        var lo = BIG;
        var hi = BIG;
        var facet = NONE;
        var atom = 0u;
        for (var k = 0u; k < live; k++) {
            if first[k] != NONE && times[k].x < lo {
                lo = times[k].x;
                hi = times[k].y;
                facet = first[k];
                atom = k;
            }
            if second[k] != NONE && times[k].z < lo {
                lo = times[k].z;
                hi = times[k].w;
                facet = second[k];
                atom = k;
            }
        }
        if facet == NONE {
            return Change(true, start, region, region, BIG, BIG, NONE, 0u);
        }
        if facet == HIDDEN {
            return uncertain(start, lo);
        }
        // events at the same time: those of the same surface are exact ties, others leave the order open
        let key = key_of(facet);
        var ties = no_bits();
        var count = 0u;
        var tie: Tie;
        var is_exact = true;
        var reach = hi;
        var has_more = true;
        while has_more {
            for (var k = 0u; k < live; k++) {
                var mine = NONE;
                if first[k] != NONE && times[k].x <= hi {
                    mine = first[k];
                    reach = max(reach, times[k].y);
                    first[k] = NONE;
                } else if second[k] != NONE && times[k].z <= hi {
                    mine = second[k];
                    reach = max(reach, times[k].w);
                    second[k] = NONE;
                }
                if mine == NONE {
                    continue;
                }
                if mine == HIDDEN || has(ties, which[k]) || (second[k] != NONE && times[k].z <= hi) {
                    return uncertain(start, lo);
                }
                is_exact = is_exact && key_of(mine) == key && (facet != EITHER || k == atom);
                if count < MOST_GATHERED {
                    tie.events[count] = vec2u(which[k], mine);
                }
                ties = flipped(ties, which[k]);
                count += 1u;
            }
            // events in one surface have one time, so that the interval of one of them holds it
            has_more = !is_exact && reach > hi;
            hi = select(reach, hi, is_exact);
        }
        if !is_exact {
            if count > MOST_GATHERED {
                return uncertain(start, lo);
            }
            tie.count = count;
            tie = tabulated(tie, group, outputs, bits, region);
            bits = both(bits, ties);
            if tie.table == 0u {
                continue;
            }
            if !tie.is_clear || ((tie.table >> ((1u << count) - 1u)) & 1u) == 0u {
                return uncertain(start, lo);
            }
            tie = reduced(tie);
            if !passed_on(tie) {
                return uncertain(start, lo);
            }
            if tie.count == 1u {
                tied = vec2u();
            }
            return Change(true, start, region, tie.after, lo, hi, tie.events[0].y, NONE);
        }
        atom = which[atom];
        let next_bits = both(bits, ties);
        let next = owner(group, outputs, next_bits);
        let medium = medium_in(outputs, region);
        let next_medium = medium_in(outputs, next);
        if medium != next_medium {
            if facet == EITHER {
                return uncertain(start, lo);
            }
            if count > 1u {
                atom = NONE;
                var instance = 0u;
                for (var k = 0u; k < group.y; k++) {
                    if !has(ties, k) {
                        continue;
                    }
                    // a placed solid is one leaf; if several of its atoms change, the CPU determines its face. They follow each other
                    let own = tables[params.atoms + 2u * (group.x + k)].w;
                    if own != 0u && own == instance {
                        return uncertain(start, lo);
                    }
                    instance = own;
                    if atom == NONE
                        && (medium_in(outputs, owner(group, outputs, flipped(bits, k))) != medium
                            || medium_in(outputs, owner(group, outputs, flipped(next_bits, k))) != next_medium) {
                        atom = k;
                    }
                }
                if atom == NONE {
                    return uncertain(start, lo);
                }
                facet = facet_with(group.x + atom, key);
                atom = NONE;
            }
            return Change(true, start, region, next, lo, hi, facet, atom);
        }
        bits = next_bits;
        region = next;
    }
    return uncertain(start, -BIG);
}

// The medium of a region of the model; the value itself in a placed group.
fn medium_in(outputs: vec4u, region: u32) -> u32 {
    if outputs.z == 1u {
        return region;
    }
    return medium_of(region);
}

// The facet of an atom with a key.
fn facet_with(atom: u32, key: u32) -> u32 {
    let a = tables[params.atoms + 2u * atom];
    for (var i = 0u; i < a.y; i++) {
        if tables[params.facets + a.x + i].z == key {
            return a.x + i;
        }
    }
    return a.x;
}
