//! Boxes inside a solid, proved by the ranges of its surfaces.

use super::tree::{Place, Tree};
use rayweave_math::{Bounds, Interval};
use rayweave_model::Program;
use std::rc::Rc;

/// The rest of the tree of a solid in a box around some boxes.
struct Open {
    tree: Rc<Tree>,
    boxes: Vec<u32>,
}

/// Whether each of many boxes, made smaller by a margin on all sides, is inside a solid as far as ranges of functions prove it.
///
/// The boxes are halved as in a bounding volume hierarchy, and each half keeps only the surfaces that pass through it: of n surfaces
/// and m scattered boxes, about (n + m) log m pairs are examined.
pub(crate) fn contained(program: &Program, boxes: &[Bounds], margin: f64) -> Contained {
    let mut found = Contained { inside: vec![false; boxes.len()], examined: 0 };
    let Some((tree, surfaces)) = Tree::of(program) else { return found };
    let inner: Vec<Bounds> = boxes.iter().map(|own| shrunk(own, margin)).collect();
    let finite = (0..boxes.len() as u32).filter(|&k| inner[k as usize].is_finite()).collect();
    let mut places = vec![Place::Unknown; surfaces.len()];
    let mut scratch = Vec::new();
    let mut waiting = vec![Open { tree: Rc::new(tree), boxes: finite }];
    while let Some(Open { tree, mut boxes }) = waiting.pop() {
        let all = boxes.iter().fold(Bounds::EMPTY, |all, &k| all.union(&inner[k as usize]));
        if all.is_empty() {
            continue;
        }
        let cell: [Interval; 3] = std::array::from_fn(|axis| Interval::new(all.lo[axis], all.hi[axis]));
        let passing = tree.surfaces();
        found.examined += passing.len() as u64;
        for &number in &passing {
            let (value, _) = surfaces[number as usize].0.ranges(&cell);
            places[number as usize] = match () {
                () if value.hi < 0.0 => Place::Inside,
                () if value.lo > 0.0 => Place::Outside,
                () => Place::Unknown,
            };
        }
        let rest = tree.reduced(&places, &mut scratch);
        passing.iter().for_each(|&number| places[number as usize] = Place::Unknown);
        match rest.constant() {
            Some(is_inside) => boxes.iter().for_each(|&k| found.inside[k as usize] = is_inside),
            None if boxes.len() == 1 => {}
            None => {
                let size = all.size();
                let axis = (0..3).fold(0, |best, axis| if size[axis] > size[best] { axis } else { best });
                let half = boxes.len() / 2;
                let at = |k: u32| inner[k as usize].centre()[axis];
                boxes.select_nth_unstable_by(half, |&a, &b| at(a).total_cmp(&at(b)).then(a.cmp(&b)));
                let upper = boxes.split_off(half);
                let rest = Rc::new(rest);
                waiting.extend([upper, boxes].map(|boxes| Open { tree: rest.clone(), boxes }));
            }
        }
    }
    found
}

/// The result of [`contained`].
pub(crate) struct Contained {
    /// For each box, true if it is inside.
    pub inside: Vec<bool>,
    /// The number of pairs of a surface and a box, or a box around several, whose ranges were computed.
    pub examined: u64,
}

/// The box without a margin on all sides, at least its middle.
fn shrunk(own: &Bounds, margin: f64) -> Bounds {
    let margin = own.size().map(|width| margin.min(0.5 * width));
    Bounds::new(own.lo + margin, (own.hi - margin).max(own.lo + margin))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rayweave_math::Vec3;
    use rayweave_model::Solid;
    use rayweave_shape::primitive::{BoxFromCorners, Primitive, Sphere};

    fn block(lo: Vec3, hi: Vec3) -> Solid {
        Solid::from(Primitive::from(BoxFromCorners::new(lo, hi).unwrap()))
    }

    fn cube(centre: Vec3, half: f64) -> Bounds {
        Bounds::new(centre - Vec3::splat(half), centre + Vec3::splat(half))
    }

    /// A box within a ball, by its farthest corner, and boxes that the difference of two balls contains.
    #[test]
    fn boxes_within_balls_are_found() {
        let ball = |radius| Solid::from(Primitive::from(Sphere::new(radius).unwrap()));
        let shell = Program::compile(&(ball(10.0) - ball(3.0))).unwrap();
        let mut boxes = Vec::new();
        for k in 0..200 {
            let direction = Vec3::new((k % 7) as f64 - 3.0, (k % 11) as f64 - 5.0, (k % 13) as f64 - 6.3);
            boxes.push(cube(direction * 0.9, 0.2 + 0.01 * f64::from(k)));
        }
        let found = contained(&shell, &boxes, 0.0);
        for (own, &is_inside) in boxes.iter().zip(&found.inside) {
            let farthest = own.lo.abs().max(own.hi.abs()).length();
            let nearest = Vec3::ZERO.max(own.lo).min(own.hi).length();
            assert_eq!(is_inside, farthest < 10.0 && nearest > 3.0, "{own:?} {farthest} {nearest}");
        }
        assert!(found.inside.iter().any(|&inside| inside) && !found.inside.iter().all(|&inside| inside));
    }

    /// A daughter that fills its mother, up to rounding.
    #[test]
    fn boxes_that_touch_the_boundary_are_inside_with_a_margin() {
        let program = Program::compile(&block(Vec3::splat(-1.0), Vec3::splat(1.0))).unwrap();
        let boxes = [cube(Vec3::ZERO, 1.0 + 1e-12), cube(Vec3::ZERO, 1.0 + 1e-8), Bounds::ALL, Bounds::EMPTY];
        assert_eq!(contained(&program, &boxes, 1e-9).inside, [true, false, false, false]);
        let flat = [Bounds::new(Vec3::new(-0.5, -0.5, 0.0), Vec3::new(0.5, 0.5, 0.0))];
        assert_eq!(contained(&program, &flat, 1e-9).inside, [true]);
    }

    /// 4,096 small boxes, each within its own box of 4,096.
    #[test]
    fn the_work_of_many_boxes_in_many_boxes_is_limited() {
        let centres: Vec<Vec3> = (0..4096)
            .map(|k| 3.0 * Vec3::new(f64::from(k % 16), f64::from(k / 16 % 16), f64::from(k / 256)))
            .collect();
        let mothers =
            centres.iter().map(|&centre| block(centre - Vec3::splat(1.0), centre + Vec3::splat(1.0)));
        let program = Program::compile(&Solid::union(mothers)).unwrap();
        let boxes: Vec<Bounds> = centres.iter().map(|&centre| cube(centre, 0.9)).collect();
        let found = contained(&program, &boxes, 0.0);
        assert!(found.inside.iter().all(|&inside| inside));
        // all pairs: 4096 boxes and 96 planes, those that the mothers have in common
        assert!(found.examined < 60_000, "{}", found.examined);
    }
}
