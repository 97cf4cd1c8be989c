    var near = 0u;
    for (var k = 0u; k < group.y; k++) {
        let ball = tables[params.atoms + 2u * (group.x + k) + 1u].x;
        if ball == NONE || !passes(ball, r) {
            which[near] = k;
            near += 1u;
        }
    }
