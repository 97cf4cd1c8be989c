//! Eight leaves of one form in lanes against the kernels for bundles of rays, which `lanes.rs` compares with the scalar kernels:
//! the same spans, to the bit, and the same lanes uncertain.

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch};
use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};
use rayweave_math::Vec3;
use rayweave_shape::Ray;
use rayweave_shape::lanes::{
    FormRow, Gap, Kernel, LANES, LaneFacet, LaneLimits, LaneRay, LaneSpan, LeafForm, Mask, Uncertain,
    Vec3Lanes,
};
use rayweave_shape::surface::{Quadric, Surface};

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

/// The number of forms of [`leaves`].
const FORMS: usize = 17;

/// The facets of a leaf, given its surfaces, the insides of which it is the intersection of. The inside of a surface with two
/// pieces is one piece.
fn facets(surfaces: &[Surface]) -> Vec<LaneFacet> {
    let mut facets: Vec<LaneFacet> = Vec::new();
    for (k, surface) in surfaces.iter().enumerate() {
        let kernel = Kernel::of(surface).unwrap();
        let facet = LaneFacet {
            is_one_piece: kernel.waist().is_some(),
            kernel,
            inside: true,
            face: FIRST + k as f64,
            surfaces: [k as f64; 2],
            gap: 0,
        };
        match facets.last().and_then(|last| last.joined(&facet)) {
            Some(both) => *facets.last_mut().unwrap() = both,
            None => facets.push(facet),
        }
    }
    facets
}

/// The facets of a leaf with a hole: outside of the last surface.
fn with_hole(surfaces: &[Surface]) -> Vec<LaneFacet> {
    let mut facets = facets(surfaces);
    facets.last_mut().unwrap().inside = false;
    facets
}

/// The quadric with these half axes along the vectors of a frame, and signs of their squares.
fn quadric(
    at: Vec3,
    frame: [Vec3; 3],
    half: [f64; 3],
    signs: [f64; 3],
    linear: Vec3,
    constant: f64,
) -> Surface {
    let rows = std::array::from_fn(|k| frame[k] / half[k]);
    Surface::Quadric(Box::new(Quadric::from_squares(at, rows, signs, linear, constant)))
}

/// Slabs across three axes around a point.
fn block(axes: [Vec3; 3], at: Vec3, size: f64) -> Vec<Surface> {
    let across = |n: Vec3| [Surface::plane(-n, size - n.dot(at)), Surface::plane(n, size + n.dot(at))];
    axes.into_iter().flat_map(across).collect()
}

/// Eight leaves of one form.
fn leaves(form: usize, dice: &mut Dice) -> Vec<Vec<LaneFacet>> {
    let axis = dice.0.random_range(0..3);
    let leaf = |_| {
        let tilted = dice.vector().normalize();
        let side = tilted.cross(Vec3::new(0.3, 0.1, 1.0)).normalize();
        let frame = [tilted, side, tilted.cross(side).normalize()];
        let at = Vec3::from_array(std::array::from_fn(|_| dice.coordinate()));
        let size = dice.pick(&[0.5, 0.25, 0.1, 1e-3]);
        let along = Vec3::AXES[axis];
        let end = |n: Vec3| [Surface::plane(-n, size - n.dot(at)), Surface::plane(n, size + n.dot(at))];
        let half = [size, 0.5 * size, 2.0 * size];
        let wall = |along: Vec3, radius: f64| vec![Surface::cylinder(at, along, radius)];
        let hole = match form {
            7 => Some([end(along).into(), wall(along, size), wall(along, 0.5 * size)].concat()),
            8 => Some([wall(tilted, size), end(tilted).into(), wall(tilted, 0.75 * size)].concat()),
            9 => Some(vec![Surface::sphere(at, size), Surface::sphere(at + 0.3 * size * along, size)]),
            _ => None,
        };
        if let Some(surfaces) = hole {
            return with_hole(&surfaces);
        }
        facets(&match form {
            0 => vec![Surface::sphere(at, size)],
            1 => block(Vec3::AXES, at, size),
            2 => [vec![Surface::cylinder(at, along, size)], end(along).into()].concat(),
            3 => block(frame, at, size),
            4 => vec![Surface::plane(along, at[axis])],
            5 => vec![Surface::plane(tilted + 0.1 * at, size), Surface::sphere(at, size)],
            10 => [wall(tilted, size), end(tilted).into()].concat(),
            11 => [end(tilted).into(), vec![Surface::cone(at - 1.5 * size * tilted, tilted, 0.4)]].concat(),
            12 => vec![quadric(at, frame, half, [1.0; 3], Vec3::ZERO, -1.0)],
            13 => [end(tilted).into(), vec![quadric(at, frame, half, [0.0, 1.0, 1.0], Vec3::ZERO, -1.0)]]
                .concat(),
            14 => vec![quadric(at, frame, half, [0.0, 1.0, 1.0], tilted / size, -0.25)],
            15 => [end(tilted).into(), vec![quadric(at, frame, half, [-1.0, 1.0, 1.0], Vec3::ZERO, 0.0)]]
                .concat(),
            16 => [end(along).into(), vec![quadric(at, frame, half, [-1.0, 1.0, 1.0], Vec3::ZERO, 0.5)]]
                .concat(),
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

/// The bits of a span, whether a lane is uncertain in either way, and the bits of a gap with the number of its face.
type Lane = ([u64; 4], [bool; 2], Option<[u64; 3]>);

fn lane<S: Simd>(span: &LaneSpan<S>, uncertain: &Uncertain<S>, gap: Option<(Gap<S>, f64)>, k: usize) -> Lane {
    let numbers = [span.from, span.to, span.from_face, span.to_face].map(|x| x.to_array()[k].to_bits());
    let unsure = [uncertain.always, uncertain.grazes].map(|mask| mask.to_bitmask() >> k & 1 == 1);
    let gap = gap.map(|(gap, face)| [gap.from.to_array()[k], gap.to.to_array()[k], face].map(f64::to_bits));
    (numbers, unsure, gap)
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
    let (span, gap) = forms[0].spans(simd, &rays.only(simd, 3), &parameters, &mut uncertain);
    let expected = |k: usize| {
        let (mut all, mut own, mut hole) = (LaneSpan::line(simd), never, None);
        for facet in &leaves[k] {
            let gap = facet.narrow(simd, &rays, &mut all, &mut own);
            match gap.filter(|gap| !facet.inside || gap.from.simd_lt(gap.to).any_true()) {
                Some(gap) if !facet.inside => hole = Some((gap, facet.face - FIRST)),
                gap => assert!(gap.is_none(), "{facet:?}"),
            }
        }
        let ([from, to, from_face, to_face], uncertain, hole) = lane(&all, &own, hole, k);
        // numbered within the leaf
        let within = |face: u64| {
            let face = f64::from_bits(face);
            (if face < 0.0 { face } else { face - FIRST }).to_bits()
        };
        ([from, to, within(from_face), within(to_face)], uncertain, hole)
    };
    (0..LANES).map(|k| (lane(&span, &uncertain, gap, k), expected(k))).collect()
}

#[test]
fn leaves_in_lanes_get_the_bits_of_bundles() {
    let mut dice = Dice(ChaCha8Rng::seed_from_u64(5));
    let (mut met, mut uncertain, mut holes) = ([0; FORMS], 0, 0);
    for round in 0..FORMS * 4000 {
        let (leaves, ray) = (leaves(round % FORMS, &mut dice), ray(&mut dice));
        for (found, expected) in dispatch!(Level::new(), simd => evaluate(simd, &leaves, &ray)) {
            assert_eq!(found, expected, "{leaves:?} {ray:?}");
            let ([from, to, ..], unsure, hole) = found;
            met[round % FORMS] += usize::from(f64::from_bits(from) < f64::from_bits(to));
            holes += usize::from(hole.is_some_and(|[from, to, _]| f64::from_bits(from) < f64::from_bits(to)));
            uncertain += usize::from(unsure[0] || unsure[1]);
        }
    }
    let is_met = met.iter().all(|&count| count > 1000);
    assert!(is_met && uncertain > 1000 && holes > 3000, "{met:?} {uncertain} {holes}");
}

#[test]
fn leaves_with_several_gaps_or_pieces_have_no_form() {
    let mut rows = Vec::new();
    let mut holes = facets(&[Surface::sphere(Vec3::X, 0.5), Surface::sphere(Vec3::ZERO, 0.5)]);
    for (inside, can_gap) in
        [([true, true], Some(false)), ([true, false], Some(true)), ([false, false], None)]
    {
        rows.clear();
        holes.iter_mut().zip(inside).for_each(|(facet, inside)| facet.inside = inside);
        assert_eq!(LeafForm::of(&holes, FIRST, &mut rows).map(|form| form.can_gap()), can_gap);
    }
    assert_eq!(rows, []);
    let frame = [Vec3::X, Vec3::Y, Vec3::Z];
    let double = quadric(Vec3::ZERO, frame, [1.0, 1.5, 2.0], [-1.0, 1.0, 1.0], Vec3::ZERO, 0.0);
    let tower = quadric(Vec3::ZERO, frame, [1.0, 1.5, 2.0], [-1.0, 1.0, 1.0], Vec3::ZERO, -1.0);
    for surface in [Surface::cone(Vec3::ZERO, Vec3::Z, 0.5), double, tower] {
        let mut leaf = facets(&[surface]);
        leaf[0].is_one_piece = false;
        assert_eq!(LeafForm::of(&leaf, FIRST, &mut rows), None, "{leaf:?}");
        leaf[0].inside = false;
        assert_eq!(LeafForm::of(&leaf, FIRST, &mut rows), None, "{leaf:?}");
    }
    assert_eq!(rows, []);
}
