// up to 32 nodes: the atoms of a group, then its gates
alias Bits = u32;

fn no_bits() -> u32 {
    return 0u;
}

fn flipped(bits: u32, k: u32) -> u32 {
    return bits ^ (1u << k);
}

fn both(a: u32, b: u32) -> u32 {
    return a ^ b;
}

fn has(bits: u32, k: u32) -> bool {
    // the node of constant outputs is beyond all others
    return k < 32u && ((bits >> (k & 31u)) & 1u) == 1u;
}

fn holds(bits: u32, edge: u32) -> bool {
    return has(bits, edge >> 1u) != ((edge & 1u) == 1u);
}

// The values of all nodes. A gate is (mask, complemented operands, threshold, node); threshold 0 is odd parity.
fn evaluated(group: vec4u, atoms: u32) -> u32 {
    var bits = atoms;
    for (var i = 0u; i < group.w; i++) {
        let gate = tables[params.gates + group.z + i];
        let count = countOneBits((bits ^ gate.y) & gate.x);
        if select((count & 1u) == 1u, count >= gate.z, gate.z > 0u) {
            bits |= 1u << gate.w;
        }
    }
    return bits;
}
