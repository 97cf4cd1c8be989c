// Rays as arrays: six columns, each with params.rays numbers.
@group(0) @binding(2) var<storage, read> rays: array<f64>;

fn line_of(i: u32) -> Line {
    let n = params.rays;
    return Line(
        vec3<f64>(rays[i], rays[n + i], rays[2u * n + i]),
        vec3<f64>(rays[3u * n + i], rays[4u * n + i], rays[5u * n + i]),
    );
}
