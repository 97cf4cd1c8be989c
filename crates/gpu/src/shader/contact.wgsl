// The contact of a line with the face that it crosses, and the start list of a line from there.

// The value of the surface of a facet at a point of a line in its frame, and the gradient.
struct Value {
    f: f64,
    gradient: vec3<f64>,
}

fn value_of(facet: u32, p: vec3<f64>) -> Value {
    let row = FACET_ROWS + 5u * facet;
    let at = words[row + 2u];
    switch words[row] {
        case PLANE: {
            let n = vector(at);
            return Value(minus(dot64(p, n), exact[at + 3u]), n);
        }
        case SPHERE: {
            let offset = difference64(p, vector(at));
            return Value(minus(dot64(offset, offset), exact[at + 3u]), scaled64(2.0lf, offset));
        }
        default: {
            let offset = across(difference64(p, vector(at)), vector(at + 3u));
            return Value(minus(dot64(offset, offset), exact[at + 6u]), scaled64(2.0lf, offset));
        }
    }
}

// A point of a line on a facet, as the CPU computes it: the unit normal, the slope of the surface along the line, and the point,
// moved onto the surface along the normal.
struct Touch {
    is_certain: bool,
    normal: vec3<f64>,
    slope: f64,
    position: vec3<f64>,
}

fn at_time(l: Line, t: f64) -> vec3<f64> {
    return sum64(l.o, scaled64(t, l.d));
}

fn rotated(v: vec3<f64>, at: u32) -> vec3<f64> {
    return sum64(
        sum64(scaled64(v.x, vector(at)), scaled64(v.y, vector(at + 3u))), scaled64(v.z, vector(at + 6u))
    );
}

fn touch(line: Line, t: f64, facet: u32, item: u32) -> Touch {
    var touched = Touch(false, vec3<f64>(), 0.0lf, vec3<f64>());
    let frame = FRAME_ROWS + 3u * frame_of(facet, item);
    let maps = words[frame];
    let count = words[frame + 1u];
    var inner = line;
    for (var k = 0u; k < count; k++) {
        inner = moved(inner, maps + MAP * k);
    }
    let value = value_of(facet, at_time(inner, t));
    var up = value.gradient;
    for (var k = count; k > 0u; k--) {
        let at = maps + MAP * (k - 1u);
        up = vec3<f64>(dot64(vector(at), up), dot64(vector(at + 3u), up), dot64(vector(at + 6u), up));
    }
    let largest = largest64(up);
    if !(largest > 1e-100lf && largest < 1e100lf) {
        return touched;
    }
    up = vec3<f64>(over(up.x, largest), over(up.y, largest), over(up.z, largest));
    touched.slope = dot64(up, line.d);
    let unit = scaled64(over(1.0lf, root(dot64(up, up))), up);
    let rise = dot64(unit, line.d);
    touched.is_certain = abs(rise) > 1e-9lf && (rise > 0.0lf) == (touched.slope > 0.0lf);
    touched.normal = select(unit, -unit, rise > 0.0lf);
    var along = touched.normal;
    for (var k = 0u; k < count; k++) {
        along = rotated(along, maps + MAP * k);
    }
    let step = over(value.f, dot64(value.gradient, along));
    touched.position = difference64(at_time(line, t), scaled64(step, touched.normal));
    return touched;
}

// The start list of a line that leaves a point of another one: the surface that it crosses there and all others within the tolerance.
struct Starts {
    certain: bool,
    list: vec4u,
}

fn is_around(at: u32, point: vec3<f64>) -> bool {
    let low = vec3<f64>(exact[at], exact[at + 8u], exact[at + 16u]);
    let high = vec3<f64>(exact[at + 24u], exact[at + 32u], exact[at + 40u]);
    return all(point >= low) && all(point <= high);
}

// `own` is the word for the crossed surface. As `StartSurfaces::append_on`; a surface whose item is elsewhere does not matter.
fn starts_at(line: Line, t: f64, own: u32, is_behind: bool) -> Starts {
    var starts = Starts(false, vec4u(own, 0u, 0u, 0u));
    var count = 1u;
    let point = line.o + t * line.d;
    var depth = 1u;
    stack[0] = 0u;
    while depth > 0u {
        depth -= 1u;
        let entry = stack[depth];
        if entry < ITEM {
            for (var k = 0u; k < 8u; k++) {
                let child = words[CHILDREN + 8u * entry + k];
                if child == NONE {
                    break;
                }
                if is_around(BOXES + 48u * entry + k, point) {
                    stack[depth] = child;
                    depth += 1u;
                }
            }
            continue;
        }
        let number = entry ^ ITEM;
        let item = seen(number, line);
        let first_atom = ATOM_ROWS + 4u * words[item.group];
        for (var j = 0u; j < words[item.group + 1u]; j++) {
            let atom = first_atom + 4u * j;
            var local = item.own;
            if words[atom + 2u] != 0u {
                local = framed(line, item.frame + words[atom + 2u]);
            }
            for (var k = words[atom]; k < words[atom] + words[atom + 1u]; k++) {
                let row = FACET_ROWS + 5u * k;
                let key = words[item.row + 3u] + words[row + 3u];
                if words[row] == BALL {
                    return starts;
                }
                if start_on(key, starts.list) != 0u {
                    continue;
                }
                let value = value_of(k, at_time(local.line, t));
                let near = near_of(local.lengths, magnitude_of(k));
                if abs(value.f) > 2.0lf * near * (largest64(value.gradient) + near) {
                    continue;
                }
                let on = is_on(k, local_of(line, frame_of(k, number)), t);
                if on == NO {
                    continue;
                }
                let slope = dot64(value.gradient, local.line.d);
                let steep = 1e-9lf * largest64(value.gradient) * largest64(local.line.d);
                if on == OPEN || count == 4u || !(abs(slope) > steep) {
                    return starts;
                }
                starts.list[count] = 2u * key + 1u + select(0u, 1u, (slope < 0.0lf) == is_behind);
                count += 1u;
            }
        }
    }
    starts.certain = true;
    return starts;
}
