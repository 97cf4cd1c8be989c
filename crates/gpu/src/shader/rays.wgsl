// Rays that the CPU has rounded to the frame of the model.

// origin and start of the window; direction and error of the origin
@group(0) @binding(2) var<storage, read> rays: array<vec4f>;

fn ray_of(i: u32) -> Ray {
    let o = rays[2u * i];
    let d = rays[2u * i + 1u];
    return Ray(o.xyz, d.xyz, d.w, @DIRECTION_ERROR@);
}

fn start_of(i: u32) -> vec2f {
    return window_start(rays[2u * i].w);
}
