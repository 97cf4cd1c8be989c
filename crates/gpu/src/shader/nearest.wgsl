// The first crossing of each ray.
fn answer(i: u32) {
    answers[i] = packed(find(ray_of(i), start_of(i)));
}
