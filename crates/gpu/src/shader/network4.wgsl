// up to 128 nodes: the atoms of a group, then its gates
alias Bits = vec4u;

fn no_bits() -> vec4u {
    return vec4u(0u);
}

fn one(k: u32) -> vec4u {
    return select(vec4u(0u), vec4u(1u << (k & 31u)), vec4u(k >> 5u) == vec4u(0u, 1u, 2u, 3u));
}

fn flipped(bits: vec4u, k: u32) -> vec4u {
    return bits ^ one(k);
}

fn both(a: vec4u, b: vec4u) -> vec4u {
    return a ^ b;
}

fn has(bits: vec4u, k: u32) -> bool {
    return any((bits & one(k)) != vec4u(0u));
}

fn holds(bits: vec4u, edge: u32) -> bool {
    return has(bits, edge >> 1u) != ((edge & 1u) == 1u);
}

// The values of all nodes. A gate is three rows: mask, complemented operands, (threshold, node); threshold 0 is odd parity.
fn evaluated(group: vec4u, atoms: vec4u) -> vec4u {
    var bits = atoms;
    for (var i = 0u; i < group.w; i++) {
        let at = params.gates + 3u * (group.z + i);
        let ones = countOneBits((bits ^ tables[at + 1u]) & tables[at]);
        let count = ones.x + ones.y + ones.z + ones.w;
        let gate = tables[at + 2u];
        if select((count & 1u) == 1u, count >= gate.x, gate.x > 0u) {
            bits |= one(gate.y);
        }
    }
    return bits;
}
