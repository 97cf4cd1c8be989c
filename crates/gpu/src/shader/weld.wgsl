// Events with overlapping intervals, by the rules of the CPU.

// The region of a priority.
fn region_of(priority: u32) -> u32 {
    return words[REGION_OF + priority];
}

// The region behind some of the events, given as bits, or, for a priority above 0, whether an item with it is inside there. `base` is
// the highest priority of all other items around the point.
fn state_of(base: u32, priority: u32, toggled: u32) -> u32 {
    var highest = base;
    var is_inside = base == priority;
    for (var k = 0u; k < events; k++) {
        if event_inside[k] != (((toggled >> k) & 1u) == 1u) {
            highest = max(highest, event_priority[k]);
            is_inside = is_inside || event_priority[k] == priority;
        }
    }
    return select(region_of(highest), select(0u, 1u, is_inside), priority > 0u);
}

// The events of a range that belong to the leaf of one of them: a leaf may be part of several items.
fn of_leaf(event: u32, first: u32, end: u32) -> u32 {
    var same = 0u;
    for (var k = first; k < end; k++) {
        same |= select(0u, 1u << k, event_leaf[k] == event_leaf[event]);
    }
    return same;
}

// The event of a range to which the change of a state belongs, as `responsible` in `weld.rs`; NONE without a change.
fn responsible(base: u32, priority: u32, first: u32, end: u32, toggled: u32) -> u32 {
    let all = (1u << end) - (1u << first);
    var best = NONE;
    for (var pass_ = 0u; pass_ < 2u; pass_++) {
        let here = select(toggled, toggled ^ all, pass_ == 0u);
        let now = state_of(base, priority, here);
        for (var k = first; k < end; k++) {
            if best != NONE && event_leaf[best] < event_leaf[k] {
                continue;
            }
            if state_of(base, priority, here ^ of_leaf(k, first, end)) != now {
                best = k;
            }
        }
    }
    let before = state_of(base, priority, toggled);
    if before == state_of(base, priority, toggled ^ all) {
        return NONE;
    }
    if best != NONE {
        return best;
    }
    var here = toggled;
    var now = before;
    for (var k = first; k < end; k++) {
        // events of one leaf follow each other
        if k > first && event_leaf[k - 1u] == event_leaf[k] {
            continue;
        }
        here ^= of_leaf(k, first, end);
        let next = state_of(base, priority, here);
        if next != now && (best == NONE || event_leaf[best] >= event_leaf[k]) {
            best = k;
        }
        now = next;
    }
    return best;
}

// A line in the frame of a surface, and the length that the maps add to the magnitude of the surface: `local_ray`.
fn local_of(line: Line, frame: u32) -> Framed {
    let row = FRAME_ROWS + 3u * frame;
    var inner = Framed(line, 0.0lf);
    for (var k = 0u; k < words[row + 1u]; k++) {
        let at = words[row] + MAP * k;
        let lengths = length64(inner.line.o) + exact[at + 13u] + inner.lengths;
        inner = Framed(moved(inner.line, at), exact[at + 12u] * lengths);
    }
    return inner;
}

fn length64(v: vec3<f64>) -> f64 {
    return sqrt(dot(v, v));
}

fn frame_of(facet: u32, item: u32) -> u32 {
    return words[ITEM_ROWS + 5u * item + 1u] + words[FACET_ROWS + 5u * facet + 4u];
}

const NO: u32 = 0u;
const YES: u32 = 1u;
const OPEN: u32 = 2u;

// Whether the CPU finds the point of a line on the surface of a facet: within the tolerance `delta` of it. The value has the bits of the
// CPU. The other side of the comparison, with or without its term of second order, is computed in another order.
fn is_on(facet: u32, own: Framed, t: f64) -> u32 {
    let value = value_of(facet, at_time(own.line, t));
    let lengths = length64(own.line.o) + abs(t) * length64(own.line.d) + own.lengths + magnitude_of(facet);
    let near = @DELTA@lf * lengths;
    let reach = near * length64(value.gradient);
    if abs(value.f) < 0.999lf * reach {
        return YES;
    }
    return select(OPEN, NO, abs(value.f) > 1.001lf * (reach + near * near));
}

// Whether a piece of a line lies in the surface of a facet, as `coincides_along`.
fn coincides(line: Line, a: f64, b: f64, facet: u32, item: u32) -> u32 {
    let own = local_of(line, frame_of(facet, item));
    // the CPU examines longer pieces at more places
    if !(2.0lf * (b - a) * length64(own.line.d) < length64(own.line.o) + own.lengths + magnitude_of(facet)) {
        return OPEN;
    }
    var found = YES;
    for (var k = 0u; k < 3u; k++) {
        var t = a;
        if k > 0u {
            t = select(b, times_(0.5lf, plus(a, b)), k == 1u);
        }
        let here = is_on(facet, own, t);
        if here == NO {
            return NO;
        }
        found = max(found, here);
    }
    return found;
}

// Whether the changes at two events are welded.
fn welded(line: Line, first: u32, a: f64, second: u32, b: f64) -> u32 {
    var found = YES;
    for (var k = 0u; k < 2u; k++) {
        let event = select(first, second, k == 0u);
        let here = coincides(line, a, b, event_facet[event], event_item[event]);
        if here == NO {
            return NO;
        }
        found = max(found, here);
    }
    return found;
}

// The crossing at events with overlapping intervals, by the rules of the CPU (`weld.rs`): the events at one time are one change, and
// neighbouring changes are one crossing if the line stays in both their surfaces. NOTHING if no crossing remains.
fn resolved(line: Line, base: u32) -> Next {
    var next = Next(DOUBT, 0.0lf, 0u, 0u, 0u, 0u, 0u, 0u);
    var toggled = 0u;
    var before = state_of(base, 0u, 0u);
    // the changes welded so far: events, states, the last change with its event
    var first = NONE;
    var end = 0u;
    var single = true;
    var mask = 0u;
    var t = 0.0lf;
    var last = 0u;
    var k = 0u;
    while k < events {
        let here = k;
        let time = event_t[k];
        let earlier = toggled;
        while k < events && event_t[k] == time {
            toggled ^= 1u << k;
            k += 1u;
        }
        for (var j = k; j < events; j++) {
            // the kernel gives both the same time, unless there are two events
            if of_leaf(j, here, k) != 0u {
                return next;
            }
        }
        let after = state_of(base, 0u, toggled);
        if after == before {
            continue;
        }
        let event = responsible(base, 0u, here, k, earlier);
        var joins = NO;
        if first != NONE {
            joins = welded(line, last, t, event, time);
            if joins == OPEN {
                return next;
            }
            if joins == NO && next.before != next.after {
                break;
            }
        }
        if joins == NO {
            first = here;
            mask = earlier;
            next.before = before;
            single = true;
        } else {
            single = false;
        }
        end = k;
        next.after = after;
        t = time;
        last = event;
        before = after;
    }
    next.route = NOTHING;
    if first == NONE || next.before == next.after {
        return next;
    }
    var face = last;
    if !single {
        face = responsible(base, 0u, first, end, mask);
    }
    var entered = face;
    if next.before != 0u && next.after != 0u {
        let own = responsible(base, next.after, first, end, mask);
        entered = select(own, face, own == NONE);
    }
    next.route = FOUND;
    next.t = t;
    next.facet = event_facet[face];
    next.item = event_item[face];
    next.entered_facet = event_facet[entered];
    next.entered_item = event_item[entered];
    return next;
}
