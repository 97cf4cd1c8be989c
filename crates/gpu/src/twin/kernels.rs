//! The kernels of planes, spheres, cylinders and quadrics, and the maps of placed solids, on a device against their twins. Skipped with
//! a message where there is no adapter.

use super::Bounds;
use super::adversary::{Adversary, V3};
use super::surfaces::{TwinRay, cylinder, placed, plane, quadric, sphere};
use crate::adapter::{Adapter, AdapterKind, Device, Gpu};
use crate::trial::compute;
use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};

/// Rays; the numbers of each: six rows of a surface and two of a ray; the results: up to four numbers, each with its bound.
const RAYS: usize = 1 << 12;
const NUMBERS: usize = 32;
const RESULTS: usize = 8;

/// The rows of a surface and a ray.
type Case = ([[f32; 4]; 6], TwinRay);

/// A kernel: its call in the shader, its twin, and expressions of the shader that the test changes by one unit in the last place.
struct Kernel {
    name: &'static str,
    call: &'static str,
    twin: fn(&Case) -> [f32; RESULTS],
    changes: &'static [&'static str],
}

const KERNELS: [Kernel; 5] = [
    Kernel {
        name: "plane",
        call: "_ = plane(0u, r);",
        twin: |(rows, r)| {
            let [(h, eh), (v, ev)] =
                plane(&mut Adversary::nearest(), room(), rows[0], [rows[1][0], rows[1][1]], r);
            [h, eh, v, ev, 0.0, 0.0, 0.0, 0.0]
        },
        changes: &["p.w - sum(no)", "sum(nd)"],
    },
    Kernel {
        name: "sphere",
        call: "_ = sphere(0u, r);",
        twin: |(rows, r)| {
            coefficients(sphere(&mut Adversary::nearest(), room(), rows[0], [rows[1][0], rows[1][1]], r))
        },
        changes: &["sum(pp) - m.w", "-sum(q * r.d) / a"],
    },
    Kernel {
        name: "cylinder",
        call: "_ = cylinder(0u, r);",
        twin: |(rows, r)| {
            let rows = [rows[0], rows[1], rows[2], rows[3]];
            coefficients(cylinder(&mut Adversary::nearest(), room(), &rows, r))
        },
        changes: &["pp - rr", "y.x * y.x + y.y * y.y"],
    },
    Kernel {
        name: "quadric",
        call: "_ = quadric(0u, r);",
        twin: |(rows, r)| coefficients(quadric(&mut Adversary::nearest(), room(), rows, r)),
        changes: &["sum(wpp) + sum(lp) + w.w", "sum(wpy) + 0.5 * sum(ly)", "sum(wyy)"],
    },
    Kernel {
        name: "placed",
        call: "let to = placed(0u, r); \
               noted = array<f32, 8>(to.o.x, to.eo, to.o.z, to.eo, to.d.x, to.ed, to.d.y, to.ed);",
        twin: |(rows, r)| {
            let rows = [rows[0], rows[1], rows[2], rows[3]];
            let TwinRay { o, d, eo, ed } = placed(&mut Adversary::nearest(), room(), &rows, r);
            [o[0], eo, o[2], eo, d[0], ed, d[1], ed]
        },
        changes: &["sum(oc)"],
    },
];

fn room() -> f32 {
    Bounds::default().room
}

fn coefficients(([a, b, c], s): ([(f32, f32); 3], f32)) -> [f32; RESULTS] {
    [a.0, a.1, b.0, b.1, c.0, c.1, s, 0.0]
}

/// The functions of the shader, with places that note the numbers of planes and quadratics, and a kernel that returns them.
fn source(kernel: &Kernel, change: Option<&str>) -> String {
    let Bounds { room, step } = Bounds::default();
    let replacements = [
        ("@SHARED@", crate::codes::declarations()),
        ("@ROOM@", format!("{room:?}")),
        ("@STEP@", format!("{step:?}")),
        ("fn quadratic(", "fn unused_quadratic(".to_owned()),
        (
            "    if abs(v) > 2.0 * ev {",
            "    noted = array<f32, 8>(h, eh, v, ev, 0.0, 0.0, 0.0, 0.0);\n    if abs(v) > 2.0 * ev {"
                .to_owned(),
        ),
    ];
    let given = include_str!("../shader/surfaces.wgsl").to_owned();
    let mut functions = replacements.iter().fold(given, |text, (name, value)| text.replace(name, value));
    if let Some(right) = change {
        assert!(functions.contains(right), "{right}");
        functions = functions.replace(right, &format!("off({right})"));
    }
    let main = "
struct Params { zero: vec4u }
@group(0) @binding(0) var<storage, read> input: array<vec4f>;
@group(0) @binding(1) var<storage, read_write> results: array<f32>;
@group(0) @binding(2) var<uniform> params: Params;
var<private> data: array<vec4f, 6>;
var<private> noted: array<f32, 8>;

fn off(x: f32) -> f32 {
    return bitcast<f32>(bitcast<u32>(x) + 1u);
}

fn quadratic(a: f32, b: f32, c: f32, ea: f32, eb: f32, ec: f32, s: f32) -> Roots {
    noted = array<f32, 8>(a, ea, b, eb, c, ec, s, 0.0);
    return constant(false);
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let i = id.x + params.zero.x;
    for (var k = 0u; k < 6u; k++) {
        data[k] = input[8u * i + k];
    }
    let o = input[8u * i + 6u];
    let d = input[8u * i + 7u];
    let r = Ray(o.xyz, d.xyz, o.w, d.w);
    @CALL@
    for (var k = 0u; k < 8u; k++) {
        results[8u * i + k] = noted[k];
    }
}
";
    functions + &main.replace("@CALL@", kernel.call)
}

fn cases() -> Vec<Case> {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let mut case = || {
        let mut vector = |size: f32| -> V3 { std::array::from_fn(|_| size * rng.random_range(-1.0f32..1.0)) };
        let (o, d) = (vector(3.0), vector(1.0));
        let mut rows = std::array::from_fn(|_| {
            let [x, y, z] = vector(1.5);
            [x, y, z, 1e-7]
        });
        // of planes and spheres, these are errors
        rows[1] = rows[1].map(f32::abs);
        (rows, TwinRay { o, d, eo: 3e-6, ed: 3e-8 })
    };
    (0..RAYS).map(|_| case()).collect()
}

fn on_device(device: &Device, cases: &[Case], source: String) -> Vec<[f32; RESULTS]> {
    let numbers = |(rows, r): &Case| -> [f32; NUMBERS] {
        let (o, d) = (r.o, r.d);
        let ray = [[o[0], o[1], o[2], r.eo], [d[0], d[1], d[2], r.ed]];
        [rows.as_flattened(), ray.as_flattened()].concat().try_into().unwrap()
    };
    let bytes: Vec<u8> = cases.iter().flat_map(numbers).flat_map(f32::to_le_bytes).collect();
    let found = compute(device, source, &bytes, 4 * RESULTS * cases.len(), cases.len() / 64).unwrap();
    let number = |bytes: &[u8]| f32::from_le_bytes(bytes.try_into().unwrap());
    found
        .chunks_exact(4 * RESULTS)
        .map(|row| std::array::from_fn(|k| number(&row[4 * k..4 * k + 4])))
        .collect()
}

fn with_adapter(test: impl FnOnce(&Adapter, &Device)) {
    let gpu = Gpu::new();
    match gpu.adapter(0) {
        Ok(adapter) => test(adapter, &adapter.open().unwrap()),
        Err(problem) => rayweave_conformance::skipped(problem),
    }
}

/// The numbers and bounds of each kernel are those of its twin: on any device up to the bounds, and bit by bit on one that
/// neither contracts nor reassociates, such as lavapipe. There an error of one unit in the last place is noticed.
#[test]
fn the_kernels_are_their_twins() {
    with_adapter(|adapter, device| {
        let cases = cases();
        for kernel in KERNELS {
            let twin: Vec<_> = cases.iter().map(kernel.twin).collect();
            let values = |row: &[f32; RESULTS]| [row[0], row[2], row[4], row[6]].map(f32::to_bits);
            let differing = |found: &[[f32; RESULTS]]| {
                found.iter().zip(&twin).filter(|(a, b)| values(a) != values(b)).count()
            };
            let found = on_device(device, &cases, source(&kernel, None));
            println!("{}: {} of {RAYS} rays have other bits", kernel.name, differing(&found));
            if adapter.kind() != AdapterKind::Software {
                continue;
            }
            assert_eq!(differing(&found), 0, "{}", kernel.name);
            for (row, own) in found.iter().zip(&twin) {
                // the bounds themselves are rounded, in any order
                let is_near = |k: usize| (row[k] - own[k]).abs() <= 1e-5 * own[k].abs();
                assert!([1, 3, 5].into_iter().all(is_near), "{}: {row:?}, twin {own:?}", kernel.name);
            }
            for change in kernel.changes {
                let wrong = differing(&on_device(device, &cases, source(&kernel, Some(change))));
                println!("{}, {change}: {wrong} rays", kernel.name);
                assert!(wrong > RAYS / 8, "{}: {change}", kernel.name);
            }
        }
    });
}
