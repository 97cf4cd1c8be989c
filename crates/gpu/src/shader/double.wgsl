// Rays in double precision, and the times of the CPU.
//
// The CPU's kernels use +, -, *, / and square roots, each rounded to nearest. A device may round differently, and compilers
// reassociate sums and contract products. `keep` hides each result from the compiler: it changes the bits by a mask that is 0 at
// run time. `trial.wgsl` compares results with the CPU's; if any bit differs, the CPU computes all times.

// the frame, surfaces and maps
@group(0) @binding(5) var<storage, read> exact: array<f64, @EXACT_ROWS@>;
// a row per facet: (kind, surface, maps, number of maps), then a row per item: (maps, number of maps)
@group(0) @binding(6) var<storage, read> lookup: array<vec4u, @LOOKUP_ROWS@>;
// the bits of the time, or the events among which the CPU decides
@group(0) @binding(7) var<storage, read_write> completed: array<vec2u>;

@ARITHMETIC@

@VECTORS@

@LINES@

// A ray in the frame of the model, as `Sender::send`; device times t are times `shift + t * rate`.
struct Sent {
    ray: Ray,
    start: f32,
    shift: f64,
    rate: f64,
    // 0, PASSES or DISTANT
    route: u32,
}

fn largest64(v: vec3<f64>) -> f64 {
    return max(abs(v.x), max(abs(v.y), abs(v.z)));
}

fn sent_of(l: Line) -> Sent {
    var sent = Sent(Ray(vec3f(), vec3f(), 0.0, 0.0), 0.0, 0.0lf, 0.0lf, DISTANT);
    // squares of other directions overflow or lose digits
    let size = largest64(l.d);
    if !(size >= 1e-90lf && size < 1e90lf) {
        return sent;
    }
    let centre = vector(0u);
    let scale = exact[3];
    let per_scale = 1.0lf / scale;
    let per_length = 1.0lf / sqrt(dot64(l.d, l.d));
    let unit = scaled64(per_length, l.d);
    let offset = difference64(l.o, centre);
    let square = dot64(offset, offset);
    var shift = 0.0lf;
    if square > @NEAR_SQUARE@lf * scale * scale {
        shift = -dot64(offset, unit);
    }
    let at = scaled64(per_scale, sum64(offset, scaled64(shift, unit)));
    let l1 = abs(l.o.x) + abs(l.o.y) + abs(l.o.z) + abs(centre.x) + abs(centre.y) + abs(centre.z);
    let tolerance = @TOLERANCE@lf * (3.0lf * l1 + 16.0lf * scale + exact[4]) * per_scale;
    if !(tolerance < @MOST_TOLERANCE@lf) {
        return sent;
    }
    if !(largest64(at) <= @NEAR@lf) {
        sent.route = select(DISTANT, PASSES, params.bounded == 1u);
        return sent;
    }
    if shift < 0.0lf && params.bounded == 1u && square > 4.0lf * scale * scale {
        // behind the start, and outside of everything
        sent.route = PASSES;
        return sent;
    }
    let o = vec3f(f32(at.x), f32(at.y), f32(at.z));
    let error = largest64(difference64(at, vec3<f64>(f64(o.x), f64(o.y), f64(o.z))));
    let d = vec3f(f32(unit.x), f32(unit.y), f32(unit.z));
    // rounded up
    let eo = f32(error + tolerance) * 1.000001;
    let start = f32(clamp(-shift * per_scale, -1e30lf, 1e30lf));
    // a device may round to either neighbour
    let rounding = largest64(difference64(unit, vec3<f64>(f64(d.x), f64(d.y), f64(d.z))));
    let ed = max(@DIRECTION_ERROR@, f32(rounding) * 1.000001 + 1e-15);
    return Sent(Ray(o, d, eo, ed), start, shift * per_length, scale * per_length, 0u);
}

// Up to two roots in order; n = 0 also if the CPU has to compute them.
struct Times {
    n: u32,
    t0: f64,
    t1: f64,
}

// as `Approach::crossings`
fn about(time: f64, square: f64, inside: f64) -> Times {
    if !(inside > 0.0lf) || square == 0.0lf {
        return Times(0u, 0.0lf, 0.0lf);
    }
    let half = root(over(inside, square));
    if !(half < 1e300lf) {
        return Times(0u, 0.0lf, 0.0lf);
    }
    return Times(2u, minus(time, half), plus(time, half));
}

// as `Plane::crossings`. exact: normal, offset
fn plane_times(at: u32, l: Line) -> Times {
    let n = vector(at);
    let height = minus(exact[at + 3u], dot64(n, l.o));
    let speed = dot64(n, l.d);
    if abs(speed) <= times_(@DOT_NOISE@lf, dot64(abs(n), abs(l.d))) {
        return Times(0u, 0.0lf, 0.0lf);
    }
    return Times(1u, over(height, speed), 0.0lf);
}

// as `Sphere::crossings`. exact: centre, squared radius
fn sphere_times(at: u32, l: Line) -> Times {
    let centre = vector(at);
    let square = dot64(l.d, l.d);
    let time = over(dot64(difference64(centre, l.o), l.d), square);
    let offset = difference64(sum64(l.o, scaled64(time, l.d)), centre);
    return about(time, square, minus(exact[at + 3u], dot64(offset, offset)));
}

// as `Cylinder::crossings`. exact: point, axis, squared radius
fn cylinder_times(at: u32, l: Line) -> Times {
    let axis = vector(at + 3u);
    let from_ = across(difference64(l.o, vector(at)), axis);
    let along = across(l.d, axis);
    let square = dot64(along, along);
    // the CPU examines rays that are nearly parallel to the axis
    if !(square >= times_(@SLOW_SQUARE@lf, dot64(l.d, l.d))) {
        return Times(0u, 0.0lf, 0.0lf);
    }
    let time = over(-dot64(from_, along), square);
    let apart = sum64(from_, scaled64(time, along));
    return about(time, square, minus(exact[at + 6u], dot64(apart, apart)));
}

fn times_of(facet: vec4u, line: Line, maps: u32, count: u32) -> Times {
    var l = line;
    for (var k = 0u; k < count; k++) {
        l = moved(l, maps + 12u * k);
    }
    let size = largest64(l.d);
    if !(size >= 1e-90lf && size < 1e90lf) {
        return Times(0u, 0.0lf, 0.0lf);
    }
    switch facet.x {
        case PLANE: { return plane_times(facet.y, l); }
        case SPHERE: { return sphere_times(facet.y, l); }
        case CYLINDER: { return cylinder_times(facet.y, l); }
        default: { return Times(0u, 0.0lf, 0.0lf); }
    }
}

// An answer, with the time of the root near the predicted one if there is only one such root.
fn completed_row(i: u32, row: vec4u, line: Line, sent: Sent) -> vec4u {
    let facet = lookup[row.x & FACET_BITS];
    var maps = facet.zw;
    if maps.y == 0u && params.placed_items == 1u {
        maps = lookup[params.items_lookup + row.y].xy;
    }
    let times = times_of(facet, line, maps.x, maps.y);
    if times.n == 0u {
        return row;
    }
    let on_device = f64(bitcast<f32>(row.w));
    let predicted = sent.shift + on_device * sent.rate;
    var t = times.t0;
    var distance = abs(times.t0 - predicted);
    if times.n == 2u {
        let other = abs(times.t1 - predicted);
        let far = max(distance, other);
        if other < distance {
            t = times.t1;
            distance = other;
        }
        // as on the CPU, a prediction about halfway between two roots is rejected; a double root is left to the CPU
        if !(far > 2.0lf * distance) || times.t0 == times.t1 {
            return row;
        }
    }
    if !(t > 0.0lf && distance < (1.0lf + abs(on_device)) * sent.rate) {
        return row;
    }
    let bits = bitcast<u64>(t);
    completed[i] = vec2u(u32(bits), u32(bits >> 32u));
    return vec4u(row.x | COMPLETED, row.yzw);
}

fn answer(i: u32) {
    let line = line_of(i);
    let sent = sent_of(line);
    if sent.route != 0u {
        answers[i] = vec4u(select(UNCERTAIN, MISS, sent.route == PASSES), sent.route, 0u, 0u);
        return;
    }
    var row = packed(find(sent.ray, window_start(sent.start)));
    if row.x < MISS && (row.x & TIED) != 0u {
        completed[i] = tied;
    } else if row.x < MISS {
        row = completed_row(i, row, line, sent);
    }
    answers[i] = row;
}
