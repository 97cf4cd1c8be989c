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

var<private> times: array<vec4f, ATOMS>;
var<private> first: array<u32, ATOMS>;
var<private> second: array<u32, ATOMS>;
// the atoms with events after the start, by their number in the group
var<private> which: array<u32, ATOMS>;

// The first change of medium (of value, for a placed group) of a group after `from`, a certain time in an interval.
fn walk(g: u32, r: Ray, from_: vec2f) -> Change {
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
            return unsure(start, lo);
        }
        // events at the same time: those of the same surface are exact ties, others leave the order open
        let key = key_of(facet);
        var ties = no_bits();
        var count = 0u;
        for (var k = 0u; k < live; k++) {
            var mine = 0u;
            if first[k] != NONE && times[k].x <= hi {
                mine += 1u;
                if key_of(first[k]) != key || (facet == EITHER && k != atom) {
                    return unsure(start, lo);
                }
                first[k] = NONE;
            }
            if second[k] != NONE && times[k].z <= hi {
                mine += 1u;
                if key_of(second[k]) != key || (facet == EITHER && k != atom) {
                    return unsure(start, lo);
                }
                second[k] = NONE;
            }
            if mine > 1u {
                return unsure(start, lo);
            }
            if mine == 1u {
                ties = flipped(ties, which[k]);
                count += 1u;
            }
        }
        atom = which[atom];
        let next_bits = both(bits, ties);
        let next = owner(group, outputs, next_bits);
        let medium = medium_in(outputs, region);
        let next_medium = medium_in(outputs, next);
        if medium != next_medium {
            if facet == EITHER {
                return unsure(start, lo);
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
                        return unsure(start, lo);
                    }
                    instance = own;
                    if atom == NONE
                        && (medium_in(outputs, owner(group, outputs, flipped(bits, k))) != medium
                            || medium_in(outputs, owner(group, outputs, flipped(next_bits, k))) != next_medium) {
                        atom = k;
                    }
                }
                if atom == NONE {
                    return unsure(start, lo);
                }
                facet = facet_with(group.x + atom, key);
                atom = NONE;
            }
            return Change(true, start, region, next, lo, hi, facet, atom);
        }
        bits = next_bits;
        region = next;
    }
    return unsure(start, -BIG);
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
