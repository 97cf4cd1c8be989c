// Vectors and lines in double precision, by the operations of the CPU. `exact` holds the numbers of surfaces and maps.
struct Line {
    o: vec3<f64>,
    d: vec3<f64>,
}

fn vector(at: u32) -> vec3<f64> {
    return vec3<f64>(exact[at], exact[at + 1u], exact[at + 2u]);
}

fn dot64(a: vec3<f64>, b: vec3<f64>) -> f64 {
    return plus(plus(times_(a.x, b.x), times_(a.y, b.y)), times_(a.z, b.z));
}

fn sum64(a: vec3<f64>, b: vec3<f64>) -> vec3<f64> {
    return vec3<f64>(plus(a.x, b.x), plus(a.y, b.y), plus(a.z, b.z));
}

fn difference64(a: vec3<f64>, b: vec3<f64>) -> vec3<f64> {
    return vec3<f64>(minus(a.x, b.x), minus(a.y, b.y), minus(a.z, b.z));
}

fn scaled64(factor: f64, v: vec3<f64>) -> vec3<f64> {
    return vec3<f64>(times_(factor, v.x), times_(factor, v.y), times_(factor, v.z));
}

// A line in the frame of a placed solid, as `Ray::transformed`.
fn moved(l: Line, at: u32) -> Line {
    let x = vector(at);
    let y = vector(at + 3u);
    let z = vector(at + 6u);
    let o = sum64(sum64(scaled64(l.o.x, x), scaled64(l.o.y, y)), scaled64(l.o.z, z));
    let d = sum64(sum64(scaled64(l.d.x, x), scaled64(l.d.y, y)), scaled64(l.d.z, z));
    return Line(sum64(o, vector(at + 9u)), d);
}

fn across(v: vec3<f64>, axis: vec3<f64>) -> vec3<f64> {
    return difference64(v, scaled64(dot64(v, axis), axis));
}
