struct Params {
    zero: u32,
    count: u32,
    // the number of steps of a photon in this pass
    most: u32,
    max_steps: u32,
    seed: vec2u,
    // the bits of a number: low word, high word
    max_time: vec2u,
    rules: u32,
    padding: u32,
}

@group(0) @binding(7) var<uniform> params: Params;

@compute @workgroup_size(64)
fn main(
    @builtin(global_invocation_id) id: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    if local < @COUNTS@ {
        atomicStore(&tallies[local], 0u);
    }
    workgroupBarrier();
    let i = id.y * groups.x * 64u + id.x;
    if i < params.count {
        fly(i);
    }
    workgroupBarrier();
    if local > 0u && local < @COUNTS@ {
        let tally = atomicLoad(&tallies[local]);
        if tally > 0u {
            atomicAdd(&counts[local], tally);
        }
    }
}
