//! Eight leaves of one form in lanes against the kernels for bundles of rays, which `lanes.rs` compares with the scalar kernels:
//! the same spans, to the bit, and the same lanes uncertain.

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch};
use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};
use rayweave_math::Vec3;
use rayweave_shape::Ray;
use rayweave_shape::lanes::{
    FormRow, Kernel, LANES, LaneFacet, LaneLimits, LaneRay, LaneSpan, LeafForm, Mask, Uncertain, Vec3Lanes,
};
use rayweave_shape::surface::Surface;

struct Dice(ChaCha8Rng);

impl Dice {
    fn vector(&mut self) -> Vec3 {
        Vec3::from_array(std::array::from_fn(|_| self.0.random_range(-1.0..1.0)))
    }

    fn pick<T: Copy>(&mut self, values: &[T]) -> T {
        values[self.0.random_range(0..values.len())]
    }

    /// A coordinate that other leaves have too, or any.
    fn coordinate(&mut self) -> f64 {
        let any = self.0.random_range(-1.0..1.0);
        self.pick(&[0.0, 0.5, -0.5, any])
    }
}

const FIRST: f64 = 700.0;

/// The facets of a leaf, given its surfaces, the insides of which it is the intersection of.
fn facets(surfaces: &[Surface]) -> Vec<LaneFacet> {
    let mut facets: Vec<LaneFacet> = Vec::new();
    for (k, surface) in surfaces.iter().enumerate() {
        let facet = LaneFacet {
            kernel: Kernel::of(surface).unwrap(),
            inside: true,
            face: FIRST + k as f64,
            surfaces: [k as f64; 2],
            gap: 0,
            is_one_piece: false,
        };
        match facets.last().and_then(|last| last.joined(&facet)) {
            Some(both) => *facets.last_mut().unwrap() = both,
            None => facets.push(facet),
        }
    }
    facets
}

/// Slabs across three axes around a point.
fn block(axes: [Vec3; 3], at: Vec3, size: f64) -> Vec<Surface> {
    let across = |n: Vec3| [Surface::plane(-n, size - n.dot(at)), Surface::plane(n, size + n.dot(at))];
    axes.into_iter().flat_map(across).collect()
}

/// Eight leaves of one form.
fn leaves(form: usize, dice: &mut Dice) -> Vec<Vec<LaneFacet>> {
    let (axis, tilted) = (dice.0.random_range(0..3), dice.vector().normalize());
    let side = tilted.cross(Vec3::new(0.3, 0.1, 1.0)).normalize();
    let frame = [tilted, side, tilted.cross(side).normalize()];
    let leaf = |_| {
        let at = Vec3::from_array(std::array::from_fn(|_| dice.coordinate()));
        let size = dice.pick(&[0.5, 0.25, 0.1, 1e-3]);
        let along = Vec3::AXES[axis];
        let end = |n: Vec3| [Surface::plane(-n, size - n.dot(at)), Surface::plane(n, size + n.dot(at))];
        facets(&match form {
            0 => vec![Surface::sphere(at, size)],
            1 => block(Vec3::AXES, at, size),
            2 => [vec![Surface::cylinder(at, along, size)], end(along).into()].concat(),
            3 => block(frame, at, size),
            4 => vec![Surface::plane(along, at[axis])],
            5 => vec![Surface::plane(tilted + 0.1 * at, size), Surface::sphere(at, size)],
            _ => [end(along).into(), vec![Surface::plane(along + tilted, at.x), Surface::sphere(at, size)]]
                .concat(),
        })
    };
    (0..LANES).map(leaf).collect()
}

/// A ray, often in a plane, along an axis or tangent to one of the leaves.
fn ray(dice: &mut Dice) -> Ray {
    let at = Vec3::from_array(std::array::from_fn(|_| dice.coordinate()));
    let tiny = libm::pow(10.0, dice.0.random_range(-18.0..-1.0));
    let (any, noise) = (dice.vector(), dice.pick(&[0.0, tiny]) * dice.vector());
    let axis = dice.pick(&Vec3::AXES);
    let along = dice.pick(&[axis, any, axis + any.cross(axis)]);
    let away = dice.pick(&[0.0, 3.0, 1e6]);
    Ray::new(
        at - away * along + noise,
        dice.pick(&[1.0, 1e-30, -7.0]) * (along + dice.pick(&[0.0, tiny]) * any),
    )
}

/// The bits of a span, and whether a lane is uncertain in either way.
type Lane = ([u64; 4], [bool; 2]);

fn lane<S: Simd>(span: &LaneSpan<S>, uncertain: &Uncertain<S>, k: usize) -> Lane {
    let numbers = [span.from, span.to, span.from_face, span.to_face].map(|x| x.to_array()[k].to_bits());
    (numbers, [uncertain.always, uncertain.grazes].map(|mask| mask.to_bitmask() >> k & 1 == 1))
}

#[inline(always)]
fn evaluate<S: Simd>(simd: S, leaves: &[Vec<LaneFacet>], ray: &Ray) -> Vec<(Lane, Lane)> {
    let limits = LaneLimits {
        centre: Vec3::ZERO,
        radius: 4.0,
        magnitude: 4.0,
        largest_radius: 0.5,
        bend: 0.0,
        is_spherical: false,
    };
    let (origin, direction) = (Vec3Lanes::splat(simd, ray.origin), Vec3Lanes::splat(simd, ray.direction));
    let (rays, _) = LaneRay::new(simd, origin, direction, &limits);
    let never = Uncertain { always: Mask::splat(simd, false), grazes: Mask::splat(simd, false) };
    let mut rows: Vec<Vec<FormRow>> = vec![Vec::new(); LANES];
    let forms: Vec<LeafForm> = leaves
        .iter()
        .zip(&mut rows)
        .map(|(facets, rows)| LeafForm::of(facets, FIRST, rows).expect("a form"))
        .collect();
    assert!(forms.iter().all(|form| *form == forms[0] && form.rows() == rows[0].len()));
    let mut uncertain = never;
    let parameters = std::array::from_fn(|k| &rows[k][..]);
    let span = forms[0].spans(simd, &rays.only(simd, 3), &parameters, &mut uncertain);
    let expected = |k: usize| {
        let (mut all, mut own) = (LaneSpan::line(simd), never);
        for facet in &leaves[k] {
            assert!(facet.narrow(simd, &rays, &mut all, &mut own).is_none());
        }
        let ([from, to, from_face, to_face], uncertain) = lane(&all, &own, k);
        // numbered within the leaf
        let within = |face: u64| {
            let face = f64::from_bits(face);
            (if face < 0.0 { face } else { face - FIRST }).to_bits()
        };
        ([from, to, within(from_face), within(to_face)], uncertain)
    };
    (0..LANES).map(|k| (lane(&span, &uncertain, k), expected(k))).collect()
}

#[test]
fn leaves_in_lanes_get_the_bits_of_bundles() {
    let mut dice = Dice(ChaCha8Rng::seed_from_u64(5));
    let (mut met, mut uncertain) = ([0; 7], 0);
    for round in 0..7 * 4000 {
        let (leaves, ray) = (leaves(round % 7, &mut dice), ray(&mut dice));
        for (found, expected) in dispatch!(Level::new(), simd => evaluate(simd, &leaves, &ray)) {
            assert_eq!(found, expected, "{leaves:?} {ray:?}");
            let ([from, to, ..], unsure) = found;
            met[round % 7] += usize::from(f64::from_bits(from) < f64::from_bits(to));
            uncertain += usize::from(unsure[0] || unsure[1]);
        }
    }
    assert!(met.iter().all(|&count| count > 1000) && uncertain > 1000, "{met:?} {uncertain}");
}

#[test]
fn leaves_that_may_have_gaps_have_no_form() {
    let mut rows = Vec::new();
    let mut hole = facets(&[Surface::plane(Vec3::Z, 1.0), Surface::sphere(Vec3::ZERO, 0.5)]);
    assert!(LeafForm::of(&hole, FIRST, &mut rows).is_some());
    rows.clear();
    hole[1].inside = false;
    assert_eq!(LeafForm::of(&hole, FIRST, &mut rows), None);
    let cone = facets(&[Surface::cone(Vec3::ZERO, Vec3::Z, 0.5)]);
    assert_eq!(LeafForm::of(&cone, FIRST, &mut rows), None);
    assert_eq!(rows, []);
}
