// The nearest crossing in a model of one small group.
@compute @workgroup_size(@WORKGROUP@)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let i = id.x + id.y * params.row;
    if i >= params.rays {
        return;
    }
    limited = false;
    answer(i, walk(0u, ray_of(i), start_of(i)), 0u);
}
