//! Boxes and rays for the tests, and an oracle in exact arithmetic.

use dashu::rational::RBig;
use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};
use rayweave_math::{Bounds, Vec3};

#[derive(Clone, Copy, Debug)]
pub struct Ray {
    pub origin: Vec3,
    pub direction: Vec3,
    pub window: [f64; 2],
}

pub const ALL: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

pub fn vector(rng: &mut ChaCha8Rng) -> Vec3 {
    Vec3::from_array(std::array::from_fn(|_| rng.random_range(-1.0..1.0)))
}

/// Boxes with centres in a cube of size 2 around a point.
pub fn scattered(seed: u64, count: usize, size: f64, at: Vec3) -> Vec<Bounds> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    (0..count).map(|_| Bounds::centred(at + vector(&mut rng), size * vector(&mut rng).abs())).collect()
}

/// Boxes that fill a grid and share their faces.
pub fn grid(side: usize, step: f64) -> Vec<Bounds> {
    let corner = |k: usize| Vec3::new((k % side) as f64, (k / side % side) as f64, (k / side / side) as f64);
    (0..side * side * side)
        .map(|k| Bounds { lo: step * corner(k), hi: step * (corner(k) + Vec3::ONE) })
        .collect()
}

/// Lists of finite boxes: random and hard ones.
pub fn lists() -> Vec<Vec<Bounds>> {
    let point = |x: f64| Bounds { lo: Vec3::splat(x), hi: Vec3::splat(x) };
    let shrinking = |k: usize| Bounds { lo: Vec3::ZERO, hi: Vec3::splat(libm::exp2(-(k as f64) / 7.0)) };
    let mut lists: Vec<Vec<Bounds>> =
        [1, 2, 7, 8, 9, 63, 65, 150].map(|n| scattered(n as u64, n, 0.2, Vec3::ZERO)).into();
    lists.extend([
        scattered(3, 100, 0.1, Vec3::splat(1e6)),
        scattered(4, 50, 0.1, Vec3::ZERO)
            .iter()
            .map(|b| Bounds { lo: 1e-30 * b.lo, hi: 1e-30 * b.hi })
            .collect(),
        scattered(5, 50, 1e-9, Vec3::new(1e-3, 2.0, -50.0)),
        grid(4, 0.1),
        (0..100).map(shrinking).collect(),
        vec![Bounds::centred(Vec3::ONE, Vec3::ONE); 70],
        vec![point(3.0); 20],
        (0..30).map(|k| point(0.1 * f64::from(k))).collect(),
        Vec::new(),
    ]);
    lists
}

/// The bounding box of finite boxes.
pub fn around(boxes: &[Bounds]) -> Bounds {
    boxes.iter().filter(|bounds| bounds.is_finite()).fold(Bounds::EMPTY, |all, bounds| all.union(bounds))
}

/// Rays near finite boxes: at random, in faces, along edges, through corners, nearly parallel to an axis, and from
/// afar.
pub fn rays(seed: u64, boxes: &[Bounds], count: usize) -> Vec<Ray> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let finite: Vec<Bounds> = boxes.iter().copied().filter(Bounds::is_finite).collect();
    let all = if finite.is_empty() { Bounds::centred(Vec3::ZERO, Vec3::ONE) } else { around(&finite) };
    let size = all.size().max_element().max(1e-30);
    (0..count)
        .map(|k| {
            let mut through = all.centre() + 0.5 * size * vector(&mut rng);
            let axis = rng.random_range(0..3);
            let mut direction = vector(&mut rng);
            if let Some(bounds) = finite.get(rng.random_range(0..finite.len().max(1))) {
                through = match k % 3 {
                    0 => bounds.corners()[rng.random_range(0..8)],
                    1 => 0.5 * (bounds.corners()[rng.random_range(0..8)] + bounds.centre()),
                    _ => through,
                };
            }
            match k % 5 {
                0 => direction = Vec3::AXES[axis],
                1 => direction[axis] = 0.0,
                2 => direction = 1e-13 * direction - Vec3::AXES[axis],
                _ => {}
            }
            let (far, length) = ([0.0, 2.0, 1e3][k / 5 % 3] * size, size * [1.0, 1e-3, 1e7][k / 3 % 3]);
            let origin = through - far * direction;
            let middle = if direction == Vec3::ZERO { 0.0 } else { far / length };
            let half = rng.random_range(0.0..1.0) * size / length;
            let window = if k % 2 == 0 { ALL } else { [middle - half, middle + half] };
            Ray { origin, direction: length * direction, window }
        })
        .collect()
}

/// The oracle: whether a ray passes a box within its window, in rational numbers. The box contains its faces.
pub fn passes(ray: &Ray, bounds: &Bounds) -> bool {
    let exact = |x: f64| RBig::try_from(x).ok();
    let (mut enter, mut leave) = (exact(ray.window[0]), exact(ray.window[1]));
    for k in 0..3 {
        let (o, d) = (ray.origin[k], ray.direction[k]);
        if d == 0.0 {
            if !(bounds.lo[k]..=bounds.hi[k]).contains(&o) {
                return false;
            }
            continue;
        }
        // `None` for an infinite plane, which has no effect
        let time = |plane: f64| Some((exact(plane)? - exact(o)?) / exact(d)?);
        let (near, far) = if d > 0.0 { (bounds.lo[k], bounds.hi[k]) } else { (bounds.hi[k], bounds.lo[k]) };
        enter = enter.max(time(near));
        leave = match (leave, time(far)) {
            (Some(a), Some(b)) => Some(a.min(b)),
            (a, b) => a.or(b),
        };
    }
    match (enter, leave) {
        (Some(enter), Some(leave)) => enter <= leave,
        _ => true,
    }
}
