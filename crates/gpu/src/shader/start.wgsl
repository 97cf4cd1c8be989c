// The region at the start of each ray, for containment of points: a flag and the region.
@compute @workgroup_size(@WORKGROUP@)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let i = id.x + id.y * params.row;
    if i >= params.rays {
        return;
    }
    limited = false;
    let from_ = start_of(i);
    let found = find(ray_of(i), from_);
    // of some surfaces the side is known only for times up to FAR
    let open = limited && params.bounded == 0u && (early || from_.y > FAR);
    answers[i] = vec4u(select(0u, UNCERTAIN, open || !found.change.certain), found.change.start, 0u, 0u);
}
