// The walk along a placed group of a single atom, which needs no network.

// The first change of value of an atom after `from`, a certain time in an interval.
fn walk(atom: u32, r: Ray, from_: vec2f) -> Change {
    let started = started_at(events_of(atom, r), from_);
    let e = started.events;
    let certain = started.certain;
    let start = u32(e.inside);
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
