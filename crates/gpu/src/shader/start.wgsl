// The region at the start of each ray, for containment of points: a flag and the region.
fn answer(i: u32) {
    let from_ = start_of(i);
    let found = find(ray_of(i), from_);
    // of some surfaces the side is known only for times up to FAR
    let open = limited && params.bounded == 0u && (early || from_.y > FAR);
    answers[i] = vec4u(select(0u, UNCERTAIN, open || !found.change.certain), found.change.start, 0u, 0u);
}
