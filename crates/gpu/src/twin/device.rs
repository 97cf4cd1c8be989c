//! The kernel of tori on a device against its twin. Skipped with a message where there is no adapter.

use super::Bounds;
use super::adversary::{Adversary, V3};
use super::torus::{self, TwinLine};
use crate::adapter::{Adapter, AdapterKind, Device, Gpu};
use crate::trial::compute;
use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};

/// Lines, numbers of a line, and results: G, half of its slope and the distance from the axis, each with its bound.
const LINES: usize = 1 << 13;
const NUMBERS: usize = 17;
const RESULTS: usize = 6;

/// The functions of the shader, and a kernel that computes the results at one point of each line.
fn source(change: impl Fn(String) -> String) -> String {
    let Bounds { room, step } = Bounds::default();
    let functions =
        [include_str!("../shader/surfaces.wgsl"), include_str!("../shader/torus.wgsl")].join("\n");
    let replacements = [
        ("@SHARED@", crate::codes::declarations()),
        ("@ROOM@", format!("{room:?}")),
        ("@STEP@", format!("{step:?}")),
        ("@DIRECTION_ERROR@", format!("{:?}", super::DIRECTION_ERROR)),
    ];
    let functions = replacements.iter().fold(functions, |text, (name, value)| text.replace(name, value));
    let main = "
struct Params { zero: vec4u }
@group(0) @binding(0) var<storage, read> input: array<f32>;
@group(0) @binding(1) var<storage, read_write> results: array<f32>;
@group(0) @binding(2) var<uniform> params: Params;
var<private> data: array<vec4f, 8>;

fn vector_at(at: u32) -> vec3f {
    return vec3f(input[at], input[at + 1u], input[at + 2u]);
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let i = id.x + params.zero.x;
    let n = 17u * i;
    let line = TorusLine(
        vector_at(n), vector_at(n + 3u), vector_at(n + 6u), vector_at(n + 9u), input[n + 12u], input[n + 13u], input[n + 14u],
        input[n + 15u], 0.0, 0.0, 0.0, 0.0, vec2f(), 0.0, vec3f(), 0.0,
    );
    let at = torus_jet(line, input[n + 16u]);
    results[6u * i] = at.g;
    results[6u * i + 1u] = at.eg;
    results[6u * i + 2u] = at.h;
    results[6u * i + 3u] = at.eh;
    results[6u * i + 4u] = at.rho;
    results[6u * i + 5u] = at.erho;
}
";
    change(functions) + main
}

/// Lines of random points and directions, each with a time.
fn lines() -> Vec<(TwinLine, f32)> {
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    let mut line = || {
        let mut vector = |size: f32| -> V3 { std::array::from_fn(|_| size * rng.random_range(-1.0f32..1.0)) };
        let (p, y) = (vector(2.0), vector(1.0));
        let [ep, ey] = [3e-6, 3e-8].map(|size: f32| vector(size).map(f32::abs));
        let radii = [rng.random_range(0.5f32..2.0), rng.random_range(0.2f32..1.5)];
        let errors = [6e-8; 2];
        (TwinLine { p, ep, y, ey, radii, errors }, rng.random_range(-2.0f32..2.0))
    };
    (0..LINES).map(|_| line()).collect()
}

/// The results of a device.
fn on_device(device: &Device, lines: &[(TwinLine, f32)], source: String) -> Vec<[f32; RESULTS]> {
    let numbers = lines.iter().flat_map(|(l, x)| -> [f32; NUMBERS] {
        let [p, ep, y, ey] = [l.p, l.ep, l.y, l.ey];
        let all = [p, ep, y, ey].concat().into_iter().chain(l.radii).chain(l.errors).chain([*x]);
        all.collect::<Vec<_>>().try_into().unwrap()
    });
    let bytes: Vec<u8> = numbers.flat_map(f32::to_le_bytes).collect();
    let found = compute(device, source, &bytes, 4 * RESULTS * lines.len(), lines.len() / 64).unwrap();
    let number = |bytes: &[u8]| f32::from_le_bytes(bytes.try_into().unwrap());
    let row = |row: &[u8]| std::array::from_fn(|k| number(&row[4 * k..4 * k + 4]));
    found.chunks_exact(4 * RESULTS).map(row).collect()
}

/// The results of the twin, rounded to nearest.
fn on_the_twin(lines: &[(TwinLine, f32)]) -> Vec<[f32; RESULTS]> {
    let room = Bounds::default().room;
    let row = |(line, x): &(TwinLine, f32)| {
        let [(g, eg), (h, eh), (rho, erho)] = torus::jet(&mut Adversary::nearest(), room, line, *x);
        [g, eg, h, eh, rho, erho]
    };
    lines.iter().map(row).collect()
}

/// The number of lines with another value than those of the twin, bit by bit.
fn differing(found: &[[f32; RESULTS]], twin: &[[f32; RESULTS]]) -> usize {
    let values = |row: &[f32; RESULTS]| [row[0], row[2], row[4]].map(f32::to_bits);
    found.iter().zip(twin).filter(|(a, b)| values(a) != values(b)).count()
}

fn with_adapter(test: impl FnOnce(&Adapter, &Device)) {
    let gpu = Gpu::new();
    match gpu.adapter(0) {
        Ok(adapter) => test(adapter, &adapter.open().unwrap()),
        Err(problem) => rayweave_conformance::skipped(problem),
    }
}

/// The bounds of the kernel are those of the twin up to their own rounding, and the values differ by less than the bounds. A device
/// that neither contracts nor reassociates computes the values of the twin bit by bit, so that an error of one unit in the last place
/// is noticed; such a device is lavapipe.
#[test]
fn the_kernel_of_tori_is_its_twin() {
    with_adapter(|adapter, device| {
        let lines = lines();
        // close to the axis the kernel gives no slope
        let is_clear = |row: &[f32; RESULTS]| row[4] - row[5] > 0.6 * row[4];
        let (lines, twin): (Vec<_>, Vec<_>) =
            lines.iter().cloned().zip(on_the_twin(&lines)).filter(|(_, row)| is_clear(row)).unzip();
        let count = lines.len() / 64 * 64;
        let (lines, twin) = (&lines[..count], &twin[..count]);
        assert!(count > LINES / 2);
        let found = on_device(device, lines, source(|text| text));
        for (row, own) in found.iter().zip(twin) {
            for k in [0, 2, 4] {
                assert!((row[k] - own[k]).abs() <= own[k + 1], "{row:?}, twin {own:?}");
                assert!((row[k + 1] - own[k + 1]).abs() <= 1e-5 * own[k + 1], "{row:?}, twin {own:?}");
            }
        }
        let differing = |found: &[[f32; RESULTS]]| differing(found, twin);
        println!("{}: {} of {count} lines have other bits", adapter.name(), differing(&found));
        if adapter.kind() != AdapterKind::Software {
            return;
        }
        assert_eq!(differing(&found), 0);
        let changes = [
            ("let rho = sqrt(pp.x + pp.y);", "let rho = off(sqrt(pp.x + pp.y));"),
            ("let g = mm + zz - rr;", "let g = off(mm + zz - rr);"),
            ("let mu = m * u;", "let mu = off(m * u);"),
        ];
        for (right, wrong) in changes {
            let off = "fn off(x: f32) -> f32 { return bitcast<f32>(bitcast<u32>(x) + 1u); }\n";
            let changed = source(|text| {
                assert!(text.contains(right), "{right}");
                off.to_owned() + &text.replace(right, wrong)
            });
            let wrong_lines = differing(&on_device(device, lines, changed));
            println!("{wrong}: {wrong_lines} lines");
            assert!(wrong_lines > count / 4, "{wrong}");
        }
    });
}
