// Rays through pixels, by the operations of `PixelCamera::ray` and `PixelRays::place`.

// 13 numbers of two words each: position, forward, right and up of the camera, half of its height; then width and height of the
// picture, 1 for perspective, points per side of a pixel, the number of points of the first pixel to leave out; then the pixels
@group(0) @binding(2) var<storage, read> rays: array<u32>;

const PICTURE: u32 = 26u;
const PIXELS: u32 = @PIXELS@u;

fn camera_number(k: u32) -> f64 {
    return bitcast<f64>(u64(rays[2u * k]) | (u64(rays[2u * k + 1u]) << 32u));
}

fn camera_vector(k: u32) -> vec3<f64> {
    return vec3<f64>(camera_number(k), camera_number(k + 1u), camera_number(k + 2u));
}

// A coordinate of a point in pixels.
fn place(whole: u32, part: u32, per_side: u32) -> f64 {
    return plus(f64(whole), over(plus(f64(part), 0.5lf), f64(per_side)));
}

fn line_of(i: u32) -> Line {
    let width = max(rays[PICTURE], 1u);
    let side = rays[PICTURE + 3u];
    let at = i + rays[PICTURE + 4u];
    let pixel = rays[PIXELS + at / (side * side)];
    let k = at % (side * side);
    let w = f64(rays[PICTURE]);
    let h = f64(rays[PICTURE + 1u]);
    let x = place(pixel % width, k % side, side);
    let y = place(pixel / width, k / side, side);
    let half = camera_number(12u);
    let u = times_(over(minus(times_(2.0lf, x), w), h), half);
    let v = times_(over(minus(h, times_(2.0lf, y)), h), half);
    let offset = sum64(scaled64(u, camera_vector(6u)), scaled64(v, camera_vector(9u)));
    let position = camera_vector(0u);
    let forward = camera_vector(3u);
    if rays[PICTURE + 2u] == 0u {
        return Line(sum64(position, offset), forward);
    }
    let d = sum64(forward, offset);
    return Line(position, scaled64(over(1.0lf, root(dot64(d, d))), d));
}
