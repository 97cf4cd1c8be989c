// The first crossing of each ray.
@compute @workgroup_size(@WORKGROUP@)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let i = id.x + id.y * params.row;
    if i >= params.rays {
        return;
    }
    limited = false;
    answers[i] = packed(find(ray_of(i), start_of(i)));
}
