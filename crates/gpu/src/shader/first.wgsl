// The first crossing of each ray: a row with the number of crossings, 0 or 1, and the region at the start, then the crossing.
fn answer(i: u32) {
    let found = find(ray_of(i), start_of(i));
    let row = packed(found);
    if row.x == UNCERTAIN {
        answers[2u * i] = row;
        return;
    }
    answers[2u * i] = vec4u(select(1u, 0u, row.x == MISS), found.change.start, 0u, 0u);
    answers[2u * i + 1u] = row;
}
