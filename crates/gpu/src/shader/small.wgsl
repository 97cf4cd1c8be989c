// A model of one small group.
fn find(r: Ray, from_: vec2f) -> Found {
    return Found(walk(0u, r, from_), 0u);
}
