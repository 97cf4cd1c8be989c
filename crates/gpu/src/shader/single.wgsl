// The walk along a placed group of a single atom, which needs no network.

// The first change of value of an atom after `from`, a certain time in an interval.
fn walk(atom: u32, r: Ray, from_: vec2f) -> Change {
    var e = events_of(atom, r);
    var inside = e.inside;
    var certain = true;
    if e.f0 != NONE {
        if e.t.y <= from_.x {
            inside = inside != (e.f0 != HIDDEN);
            e.f0 = NONE;
        } else if e.t.x <= from_.y {
            certain = false;
        }
    }
    if e.f1 != NONE {
        if e.t.w <= from_.x {
            inside = !inside;
            e.f1 = NONE;
        } else if e.t.z <= from_.y {
            certain = false;
        }
    }
    let start = u32(inside);
    if ONLY_START && certain {
        return Change(true, start, start, start, BIG, BIG, NONE, 0u);
    }
    let facet = select(e.f0, e.f1, e.f0 == NONE);
    let t = select(e.t.xy, e.t.zw, e.f0 == NONE);
    if !certain || (facet != NONE && facet >= HIDDEN) || (e.f0 != NONE && e.f1 != NONE && e.t.z <= e.t.y) {
        return Change(certain, start, start, start, select(from_.x, t.x, certain), BIG, HIDDEN, 0u);
    }
    if facet == NONE {
        return Change(true, start, start, start, BIG, BIG, NONE, 0u);
    }
    return Change(true, start, start, 1u - start, t.x, t.y, facet, 0u);
}
