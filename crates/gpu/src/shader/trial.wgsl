// Operations whose results a compiler could change, for a comparison with the CPU.

struct Params {
    zero: u32,
}

@group(0) @binding(0) var<storage, read> numbers: array<f64>;
@group(0) @binding(1) var<storage, read_write> results: array<f64>;
@group(0) @binding(2) var<uniform> params: Params;

@ARITHMETIC@

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let i = id.x;
    let a = numbers[3u * i];
    let b = numbers[3u * i + 1u];
    let c = numbers[3u * i + 2u];
    results[6u * i] = plus(times_(a, b), c);
    results[6u * i + 1u] = minus(plus(a, b), a);
    results[6u * i + 2u] = over(a, b);
    results[6u * i + 3u] = root(abs(a));
    results[6u * i + 4u] = plus(times_(a, c), times_(b, c));
    results[6u * i + 5u] = minus(times_(a, a), times_(b, b));
}
