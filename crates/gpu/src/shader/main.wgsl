// The entry point: `answer` of each query computes the answer to a ray.
@compute @workgroup_size(@WORKGROUP@)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let i = id.x + id.y * params.row;
    if i >= params.rays {
        return;
    }
    limited = false;
    answer(i);
}
