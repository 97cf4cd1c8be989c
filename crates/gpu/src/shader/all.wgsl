// Up to MOST crossings of each ray: a row with their number and the region at the start, then the crossings.
const MOST: u32 = @MOST@;

fn answer(i: u32) {
    let r = ray_of(i);
    var from_ = start_of(i);
    let at = i * (MOST + 1u);
    var start = 0u;
    for (var k = 0u; k <= MOST; k++) {
        let found = find(r, from_);
        let row = packed(found);
        if row.x == UNCERTAIN {
            answers[at] = row;
            return;
        }
        if k == 0u {
            start = found.change.start;
        }
        if row.x == MISS {
            answers[at] = vec4u(k, start, 0u, 0u);
            return;
        }
        if k < MOST {
            answers[at + 1u + k] = row;
        }
        from_ = vec2f(found.change.hi);
    }
    answers[at] = vec4u(MORE, start, 0u, 0u);
}
