//! SIMD lanes against the scalar kernels: certain lanes agree with them to the bit.

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch};
use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};
use rayweave_math::roots::Crossings;
use rayweave_math::{Affine, Mat3, Transform, Vec3, any_perpendicular};
use rayweave_shape::Ray;
use rayweave_shape::lanes::{
    Gap, Kernel, LANES, LaneFacet, LaneGradient, LaneLimits, LaneRay, LaneSpan, Lanes, Uncertain, Vec3Lanes,
    splat,
};
use rayweave_shape::surface::{Surface, coincides_along, lies_in};

/// All instruction sets of this machine.
fn levels() -> Vec<Level> {
    let best = Level::new();
    #[cfg(target_arch = "x86_64")]
    {
        use fearless_simd::Level as L;
        let below = [
            best.as_avx512().map(L::Avx512),
            best.as_avx2().map(L::Avx2),
            best.as_sse4_2().map(L::Sse4_2),
            best.as_sse2().map(L::Sse2),
        ];
        below.into_iter().flatten().collect()
    }
    #[cfg(not(target_arch = "x86_64"))]
    vec![best]
}

struct Dice(ChaCha8Rng);

impl Dice {
    fn new(seed: u64) -> Dice {
        Dice(ChaCha8Rng::seed_from_u64(seed))
    }

    fn unit(&mut self) -> f64 {
        self.0.random_range(-1.0..1.0)
    }

    fn vector(&mut self) -> Vec3 {
        Vec3::new(self.unit(), self.unit(), self.unit())
    }

    fn below(&mut self, n: usize) -> usize {
        self.0.random_range(0..n)
    }

    /// 10 to a random power.
    fn wide(&mut self, lo: f64, hi: f64) -> f64 {
        libm::pow(10.0, self.0.random_range(lo..hi))
    }
}

/// A surface of size `scale`, near `at`.
#[derive(Clone, Debug)]
struct Case {
    surface: Surface,
    at: Vec3,
    axis: Vec3,
    scale: f64,
}

fn stretched(surface: &Surface, by: Vec3, at: Vec3, turn: Vec3) -> Surface {
    let map = Affine::scale(by).then(&Affine::rotation(turn, 0.7)).then(&Affine::translate(at));
    surface.transformed(&Transform::from_affine(map).unwrap())
}

/// One surface of every kind.
fn cases(scale: f64, dice: &mut Dice) -> Vec<Case> {
    let mut cases = Vec::new();
    for axis in [Vec3::Z, Vec3::X, dice.vector()] {
        let at = if dice.below(3) == 0 { Vec3::ZERO } else { scale * dice.vector() };
        let mut put = |surface| cases.push(Case { surface, at, axis: axis.normalize(), scale });
        let square = scale * scale;
        let diagonal = |x, y, z| Mat3::from_diagonal(Vec3::new(x, y, z));
        let about = |m: Mat3, linear: Vec3, constant| {
            let turn = Affine::rotation(Vec3::new(1.0, 2.0, 0.3), if axis == Vec3::Z { 0.0 } else { 0.9 });
            let map = turn.then(&Affine::translate(at));
            let here = Surface::quadric_about(Vec3::ZERO, m, linear, constant);
            here.transformed(&Transform::from_affine(map).unwrap())
        };
        put(Surface::plane(axis, axis.normalize().dot(at)));
        put(Surface::sphere(at, scale));
        put(Surface::cylinder(at, axis, 0.6 * scale));
        for slope in [0.05, 0.5, 1.0, 8.0] {
            put(Surface::cone(at, axis, slope));
        }
        // ellipsoids, hyperboloids of one sheet and of two, an elliptic cone, cylinder and paraboloid, a saddle
        put(about(diagonal(1.0, 2.0, 0.3), Vec3::ZERO, -square));
        put(about(diagonal(1.0, 1.0, 1e-6), Vec3::ZERO, -square));
        put(about(diagonal(-1.0, -2.0, -0.3), Vec3::ZERO, square));
        put(about(diagonal(1.0, 0.7, -1.3), Vec3::ZERO, -0.3 * square));
        put(about(diagonal(1.0, 0.7, -1.3), Vec3::ZERO, 0.2 * square));
        put(about(diagonal(1.0, 0.5, -0.4), Vec3::ZERO, 0.0));
        put(about(diagonal(1.0, 0.5, 0.0), Vec3::ZERO, -square));
        put(about(diagonal(1.0, 1.0, 0.0), Vec3::new(0.0, 0.0, -scale), 0.0));
        put(about(diagonal(1.0, -0.8, 0.0), Vec3::new(0.0, 0.0, scale), 0.0));
        put(about(diagonal(1.0, 1.0, -1e-4), Vec3::new(0.0, 0.0, -0.02 * scale), -square));
        put(stretched(&Surface::sphere(Vec3::ZERO, scale), Vec3::new(1.0, 0.4, 2.0), at, axis));
        put(Surface::torus(at, axis, scale, 0.4 * scale));
        put(Surface::torus(at, axis, scale, 0.02 * scale));
        put(Surface::torus(at, axis, 0.5 * scale, 0.8 * scale));
        let ring = Surface::torus(Vec3::ZERO, Vec3::Z, scale, 0.4 * scale);
        put(stretched(&ring, Vec3::new(1.0, 0.5, 1.7), at, axis));
    }
    cases
}

impl Case {
    fn limits(&self) -> LaneLimits {
        let mut limits = LaneLimits {
            centre: self.at,
            radius: 3.0 * self.scale,
            magnitude: self.surface.magnitude() + self.scale + self.at.length(),
            largest_radius: 0.0,
            bend: 0.0,
            is_spherical: matches!(self.surface, Surface::Sphere(_)),
        };
        match &self.surface {
            Surface::Sphere(s) => limits.largest_radius = s.radius,
            Surface::Cylinder(s) => limits.largest_radius = s.radius,
            Surface::Cone(s) => limits.bend = 1.0 + s.slope * s.slope,
            Surface::Quadric(_) => limits.bend = 1.0,
            _ => {}
        }
        limits
    }

    /// A ray from some distance through the neighbourhood of the surface.
    fn generic(&self, dice: &mut Dice) -> Ray {
        let from = self.at + 6.0 * self.scale * dice.vector().normalize();
        let to = self.at + 1.2 * self.scale * dice.vector();
        Ray::new(from, (to - from).normalize())
    }

    /// A point near the surface, on a ray that hits it.
    fn point(&self, dice: &mut Dice) -> Option<Vec3> {
        let ray = self.generic(dice);
        self.surface.crossings(&ray).times().first().map(|&t| ray.at(t))
    }

    fn tangent(&self, dice: &mut Dice) -> Option<Ray> {
        let point = self.point(dice)?;
        let normal = self.surface.value_and_gradient(point).1.normalize();
        let along = normal.cross(dice.vector()).normalize();
        let perturbation = dice.wide(-17.0, -1.0) * self.scale * if dice.below(2) == 0 { 1.0 } else { -1.0 };
        let back = dice.wide(-2.0, 2.0) * self.scale;
        let tilt = [0.0, dice.wide(-16.0, -3.0)][dice.below(2)];
        Some(Ray::new(point + perturbation * normal - back * along, along + tilt * normal))
    }

    /// A ray along a ruling of a cone or a cylinder, nearly or exactly.
    fn ruling(&self, dice: &mut Dice) -> Option<Ray> {
        let point = self.point(dice)?;
        let along = match &self.surface {
            Surface::Cone(s) => point - s.apex,
            Surface::Cylinder(s) => s.axis,
            _ => any_perpendicular(self.surface.value_and_gradient(point).1),
        };
        let mut noise = || [0.0, dice.wide(-17.0, -1.0)][dice.below(2)] * dice.vector();
        let (perturbation, tilt) = (self.scale * noise(), along.length() * noise());
        let back = 5.0 * dice.unit();
        Some(Ray::new(point + perturbation - back * along, along + tilt))
    }

    fn adversarial(&self, dice: &mut Dice) -> Ray {
        let place = self.at + self.scale * dice.vector();
        let tiny = dice.wide(-18.0, -2.0);
        let ray = match dice.below(9) {
            0 | 1 => self.tangent(dice),
            2 => self.ruling(dice),
            3 => Some(Ray::new(place - 3.0 * self.scale * self.axis, self.axis + tiny * dice.vector())),
            4 => Some(Ray::new(place, [self.axis, Vec3::X, -Vec3::Y, Vec3::Z][dice.below(4)])),
            // through the apex or centre
            5 => {
                let way = dice.vector();
                Some(Ray::new(self.at - 4.0 * self.scale * way + tiny * self.scale * dice.vector(), way))
            }
            6 => {
                let from = self.at + 1e8 * self.scale * dice.vector();
                Some(Ray::new(from, place - from))
            }
            7 => Some(Ray::new(self.at, dice.vector())),
            _ => None,
        };
        let ray = ray.unwrap_or_else(|| self.generic(dice));
        let length = if dice.below(3) == 0 { dice.wide(-90.0, 90.0) } else { 1.0 };
        Ray::new(ray.origin, length * ray.direction.normalize())
    }
}

/// Results of the lanes for eight rays.
struct LaneResults {
    crossings: [Crossings<4>; LANES],
    /// One bit per ray for each kind of uncertainty.
    always: u64,
    grazes: u64,
    /// For each pair of times whether the piece between them may coincide with the surface.
    may_coincide: Vec<u64>,
}

fn load<S: Simd>(simd: S, rays: &[Ray; LANES], part: impl Fn(&Ray) -> Vec3) -> Vec3Lanes<S> {
    let column = |k: usize| Lanes::from_fn(simd, |lane| part(&rays[lane])[k]);
    Vec3Lanes { x: column(0), y: column(1), z: column(2) }
}

/// Crossings of a span with a gap cut out.
fn holds([from, to, gap_from, gap_to]: [f64; 4]) -> Crossings<4> {
    if from >= to {
        return Crossings::constant(false);
    }
    if gap_from >= gap_to || gap_to <= from || to <= gap_from {
        return Crossings::new(false, &[from, to]);
    }
    match (from < gap_from, gap_to < to) {
        (true, true) => Crossings::new(false, &[from, gap_from, gap_to, to]),
        (true, false) => Crossings::new(false, &[from, gap_from]),
        (false, true) => Crossings::new(false, &[gap_to, to]),
        (false, false) => Crossings::constant(false),
    }
}

#[inline(always)]
fn evaluate<S: Simd>(
    simd: S,
    facet: &LaneFacet,
    limits: &LaneLimits,
    rays: &[Ray; LANES],
    pairs: &[[(f64, f64); LANES]],
) -> LaneResults {
    let (origins, directions) = (load(simd, rays, |r| r.origin), load(simd, rays, |r| r.direction));
    let (ray, mut uncertain): (LaneRay<S>, Uncertain<S>) = LaneRay::new(simd, origins, directions, limits);
    let mut span = LaneSpan::line(simd);
    let none = Gap { from: splat(simd, f64::INFINITY), to: splat(simd, f64::NEG_INFINITY) };
    let gap = facet.narrow(simd, &ray, &mut span, &mut uncertain).unwrap_or(none);
    let columns = [span.from, span.to, gap.from, gap.to].map(|x| x.to_array());
    let may_coincide = pairs
        .iter()
        .map(|pair| {
            let ends: [Lanes<S>; 2] =
                [Lanes::from_fn(simd, |k| pair[k].0), Lanes::from_fn(simd, |k| pair[k].1)];
            let may_coincide = ray.may_coincide(ends[0], ends[1], limits);
            let longest = ray.longest_coincident(ends[0].abs().max(ends[1].abs()), limits);
            let is_longer = (ends[1] - ends[0]).simd_gt(longest);
            assert!(!(is_longer & may_coincide).any_true(), "{pair:?} {longest:?}");
            may_coincide.to_bitmask()
        })
        .collect();
    LaneResults {
        crossings: std::array::from_fn(|k| holds(columns.map(|column| column[k]))),
        always: uncertain.always.to_bitmask(),
        grazes: uncertain.grazes.to_bitmask(),
        may_coincide,
    }
}

fn facet(surface: &Surface, inside: bool) -> Option<LaneFacet> {
    let kernel = Kernel::of(surface)?;
    let facet = LaneFacet { kernel, inside, face: 0.0, surfaces: [0.0; 2], gap: 0, is_one_piece: false };
    facet.has_one_gap().then_some(facet)
}

fn bits(crossings: &Crossings<4>) -> (bool, Vec<u64>) {
    (crossings.starts_negative(), crossings.times().iter().map(|t| t.to_bits()).collect())
}

/// Pieces from the first or the last crossing to a time not far from it.
fn pairs(case: &Case, rays: &[Ray; LANES], dice: &mut Dice) -> Vec<[(f64, f64); LANES]> {
    let mut pair = |ray: &Ray| {
        let crossings = case.surface.crossings(ray);
        let times = crossings.times();
        let Some(&t) = (if dice.below(2) == 0 { times.first() } else { times.last() }) else {
            return (0.0, f64::INFINITY);
        };
        let size = case.scale + if dice.below(4) == 0 { (ray.origin - case.at).length() } else { 0.0 };
        let step = dice.wide(-17.0, 1.0) * size / ray.direction.length();
        if dice.below(2) == 0 { (t, t + step) } else { (t - step, t) }
    };
    (0..4).map(|_| std::array::from_fn(|k| pair(&rays[k]))).collect()
}

/// Checks the lanes for eight rays; returns the numbers of uncertain lanes of either kind.
fn check(case: &Case, inside: bool, rays: &[Ray; LANES], levels: &[Level], dice: &mut Dice) -> [u32; 2] {
    let Some(facet) = facet(&case.surface, inside) else { return [0, 0] };
    let limits = case.limits();
    let pairs = pairs(case, rays, dice);
    let mut first = None;
    for &level in levels {
        let results = dispatch!(level, simd => evaluate(simd, &facet, &limits, rays, &pairs));
        for (k, ray) in rays.iter().enumerate() {
            if results.always >> k & 1 == 1 {
                continue;
            }
            let mut expected = case.surface.crossings(ray);
            if !inside {
                expected = expected.negated();
            }
            assert_eq!(bits(&results.crossings[k]), bits(&expected), "{case:?} {inside} {ray:?} {level:?}");
            let middle = ray.closest_time(limits.centre);
            let half = limits.radius / ray.direction.length();
            let lies = lies_in(&case.surface, limits.magnitude, ray, (middle - half, middle + half));
            assert!(!lies, "{case:?} {ray:?}");
            for (pair, may_coincide) in pairs.iter().zip(&results.may_coincide) {
                let (a, b) = pair[k];
                let sure = (may_coincide | results.grazes) >> k & 1 == 0 && b < f64::INFINITY;
                assert!(
                    !sure || !coincides_along(&case.surface, limits.magnitude, ray, a, b),
                    "{case:?} {ray:?} {a} {b}"
                );
            }
        }
        let uncertain_lanes = (results.always, results.grazes, results.may_coincide);
        assert_eq!(*first.get_or_insert(uncertain_lanes.clone()), uncertain_lanes, "{case:?} {level:?}");
    }
    first.map_or([0, 0], |(always, grazes, _)| [always.count_ones(), grazes.count_ones()])
}

fn rounds(count: usize, seed: u64) {
    let (mut dice, levels) = (Dice::new(seed), levels());
    for round in 0..count {
        let scale = [1.0, 1e-8, 1e8][round % 3];
        for case in cases(scale, &mut dice) {
            let rays = std::array::from_fn(|_| case.adversarial(&mut dice));
            check(&case, round % 2 == 0, &rays, &levels, &mut dice);
        }
    }
}

#[test]
fn adversarial_rays_get_the_bits_of_the_scalar_kernels() {
    rounds(60, 1);
}

#[test]
#[ignore = "long"]
fn long_adversarial_rays_get_the_bits_of_the_scalar_kernels() {
    for seed in 0..20 {
        rounds(1000, 100 + seed);
    }
}

/// Thick and thin tori, self-tangent or nearly so, spindles and affine images.
fn tori(scale: f64, dice: &mut Dice) -> Vec<Case> {
    let sizes = [(1.0, 0.4), (1.0, 1.0), (1.0, 1.0 - 1e-12), (1.0, 0.999), (0.5, 0.8), (1e-3, 1.0)];
    let mut cases = Vec::new();
    for (major, minor) in sizes.into_iter().chain([(1.0, 1e-2), (1.0, 1e-4), (1.0, 1e-7)]) {
        for axis in [Vec3::Z, dice.vector().normalize()] {
            let at = if dice.below(3) == 0 { Vec3::ZERO } else { scale * dice.vector() };
            let ring = Surface::torus(at, axis, scale * major, scale * minor);
            cases.push(Case { surface: ring, at, axis, scale });
            let ring = Surface::torus(Vec3::ZERO, axis, scale * major, scale * minor);
            let by = Vec3::new(1.0, dice.wide(-1.0, 0.0), dice.wide(0.0, 0.5));
            cases.push(Case { surface: stretched(&ring, by, at, axis), at, axis, scale });
        }
    }
    cases
}

impl Case {
    /// Rays in tangent planes of a torus, along its axis, along its tube, through its centre, at both sides of its hole,
    /// along its inflectional tangents.
    fn at_torus(&self, dice: &mut Dice) -> Ray {
        let (axis, major, minor) = match &self.surface {
            Surface::Torus(s) => (s.axis, s.major, s.minor),
            _ => return self.adversarial(dice),
        };
        let u = axis.cross(dice.vector()).normalize();
        let v = axis.cross(u);
        let side = [-1.0, 1.0][dice.below(2)];
        let rho = [0.0, major - minor, major, major + minor, major + minor * dice.unit()][dice.below(5)];
        let (from, along) = match dice.below(9) {
            // in the planes that are tangent along a circle
            0 => (side * minor * axis + rho * u, v),
            // across the axis, at any height
            1 => (dice.unit() * minor * axis + rho * u, v),
            2 => (rho * u, side * axis),
            // through the centre and at both sides of it: bitangent where the hole allows it
            3 => (Vec3::ZERO, (1.0 - (minor / major).min(1.0).powi(2)).sqrt() * u + minor / major * axis),
            // along the tube, and out of it
            4 => (major * u + minor * dice.unit() * axis, v),
            5 => (major * u + minor * dice.unit() * u, dice.vector()),
            // through the axis
            6 => (dice.unit() * self.scale * axis, dice.vector()),
            // inflectional tangents of the inner half, where the normal curvature vanishes
            7 => {
                let (sin, cos) = libm::sincos((0.5 + dice.unit().abs()) * std::f64::consts::PI);
                let squared = (-cos * minor / (major + minor * cos)).max(0.0);
                ((major + minor * cos) * u + minor * sin * axis, v + squared.sqrt() * (cos * axis - sin * u))
            }
            _ => return self.adversarial(dice),
        };
        let along = along.normalize() + [0.0, dice.wide(-18.0, -1.0)][dice.below(2)] * dice.vector();
        let perturbation = [0.0, minor * dice.wide(-17.0, 0.0)][dice.below(2)] * dice.vector();
        let back = [0.0, 3.0, 1e3, 1e8][dice.below(4)] * self.scale;
        let length = if dice.below(3) == 0 { dice.wide(-60.0, 60.0) } else { 1.0 };
        Ray::new(self.at + from + perturbation - back * along, length * along.normalize())
    }
}

#[test]
fn tori_get_the_bits_of_the_scalar_kernel() {
    let (mut dice, levels, effort) = (Dice::new(3), levels(), effort());
    let (mut uncertain_lanes, mut rays) = (0, 0);
    for round in 0..100 * effort {
        let scale = [1.0, 1e-8, 1e8][round % 3];
        for case in tori(scale, &mut dice) {
            let eight = std::array::from_fn(|_| case.at_torus(&mut dice));
            let [always, _] = check(&case, true, &eight, &levels, &mut dice);
            uncertain_lanes += always;
            rays += LANES as u32;
        }
    }
    println!("{uncertain_lanes} of {rays} uncertain");
    assert!(2 * uncertain_lanes < rays, "{uncertain_lanes} of {rays} uncertain");
}

fn bits_of(v: Vec3) -> [u64; 3] {
    v.to_array().map(|x| if x.is_nan() { f64::NAN } else { x }.to_bits())
}

#[inline(always)]
fn gradients<S: Simd>(simd: S, gradient: &LaneGradient, points: &[Vec3; LANES]) -> [[f64; LANES]; 3] {
    let column = |k: usize| Lanes::from_fn(simd, |lane| points[lane][k]);
    let points: Vec3Lanes<S> = Vec3Lanes { x: column(0), y: column(1), z: column(2) };
    let Vec3Lanes { x, y, z } = gradient.at(simd, points);
    [x.to_array(), y.to_array(), z.to_array()]
}

/// Points on surfaces, near them, at centres and apexes, on axes, far away.
#[test]
fn gradients_have_the_bits_of_the_scalar_ones() {
    let (mut dice, levels) = (Dice::new(4), levels());
    for round in 0..30 {
        let scale = [1.0, 1e-8, 1e8][round % 3];
        for case in cases(scale, &mut dice).into_iter().chain(tori(scale, &mut dice)) {
            let points = std::array::from_fn(|_| match dice.below(6) {
                0 => case.at,
                1 => case.at + scale * dice.unit() * case.axis,
                2 => case.at + 1e9 * scale * dice.vector(),
                3 => case.at + scale * dice.vector(),
                _ => case.point(&mut dice).unwrap_or(case.at),
            });
            let gradient = LaneGradient::of(&case.surface).unwrap();
            for &level in &levels {
                let [x, y, z] = dispatch!(level, simd => gradients(simd, &gradient, &points));
                for (k, &point) in points.iter().enumerate() {
                    let (_, expected) = case.surface.value_and_gradient(point);
                    let got = Vec3::new(x[k], y[k], z[k]);
                    assert_eq!(bits_of(got), bits_of(expected), "{case:?} {point:?} {level:?}");
                }
            }
        }
    }
}

/// Factor of the number of rays.
fn effort() -> usize {
    std::env::var("RAYWEAVE_EFFORT").ok().and_then(|s| s.parse().ok()).unwrap_or(1)
}

/// Lanes are certain for ordinary rays.
#[test]
fn generic_rays_are_seldom_uncertain() {
    let (mut dice, levels) = (Dice::new(2), levels());
    let mut uncertain_lanes = std::collections::BTreeMap::new();
    for round in 0..100 {
        let scale = [1.0, 1e-8, 1e8][round % 3];
        for (kind, case) in cases(scale, &mut dice).into_iter().enumerate() {
            let rays = std::array::from_fn(|_| case.generic(&mut dice));
            let [always, grazes] = check(&case, round % 4 != 0, &rays, &levels[..1], &mut dice);
            let count = uncertain_lanes.entry(kind).or_insert([0, 0, 0]);
            *count = [count[0] + always, count[1] + grazes, count[2] + LANES as u32];
        }
    }
    println!("{uncertain_lanes:?}");
    for (kind, [always, grazes, rays]) in uncertain_lanes {
        assert!(100 * (always + grazes) <= rays, "kind {kind}: {always} and {grazes} of {rays}");
    }
}
