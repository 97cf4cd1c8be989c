//! The expected cost of rays: the number of leaves that they reach.

use crate::{LeafId, Program};
use rayweave_math::Bounds;

/// The leaves of a model by the boxes where they matter, for estimates of the work of rays.
///
/// Rays are parallel to an axis and spread evenly over the cross-sections of a box, as those that measure volumes. Such a ray meets a
/// box within with the ratio of the areas of both cross-sections as probability.
#[derive(Clone, Debug)]
pub struct RayLoad {
    /// The boxes, and the number of leaves that a ray reaches in each.
    boxes: Vec<(Bounds, f64)>,
}

/// The number of gates above a leaf whose updates take as long as intersecting a leaf.
const GATES_PER_LEAF: f64 = 16.0;

/// The most leaves of a group of which each box counts; a ray through a larger group counts as one leaf.
const MOST_LEAVES: usize = 1 << 22;

impl Program {
    /// The leaves by the boxes where they matter.
    ///
    /// Computed on each call, in time linear in the size of the model.
    pub fn ray_load(&self) -> RayLoad {
        let mut loads: Vec<Option<f64>> = vec![None; self.prototypes().len()];
        let mut waiting = vec![0];
        // placed solids before the groups that place them, without recursion
        while let Some(&group) = waiting.last() {
            if loads[group].is_some() {
                waiting.pop();
                continue;
            }
            let before = waiting.len();
            self.placed_in(group, &mut |placed| {
                if loads[placed].is_none() {
                    waiting.push(placed);
                }
            });
            if waiting.len() == before {
                waiting.pop();
                let bounds = self.prototypes()[group].bounds;
                loads[group] = Some(RayLoad { boxes: self.boxes_of_leaves(group, &loads) }.through(&bounds));
            }
        }
        RayLoad { boxes: self.boxes_of_leaves(0, &loads) }
    }

    /// Calls a function with each solid that is placed in a group.
    fn placed_in(&self, group: usize, found: &mut impl FnMut(usize)) {
        let mut last = None;
        for leaf in self.prototypes()[group].leaves.clone() {
            let placed = self.leaf(LeafId(leaf)).instance().map(|(run, _)| run.prototype);
            // copies are consecutive
            if let Some(placed) = placed.filter(|_| placed != last) {
                found(placed.index());
            }
            last = placed;
        }
    }

    /// The mean work of a ray for a leaf that it reaches, in units of that for a leaf alone: changes of leaves below many operators, such
    /// as the edges of a large outline, take several times as long.
    ///
    /// Computed on each call, in time linear in the size of the model.
    pub fn work_per_leaf(&self) -> f64 {
        let depths = self.prototypes().iter().map(|group| group.network.mean_depth());
        1.0 + depths.fold(0.0, f64::max) / GATES_PER_LEAF
    }

    fn boxes_of_leaves(&self, group: usize, loads: &[Option<f64>]) -> Vec<(Bounds, f64)> {
        let group = &self.prototypes()[group];
        if group.leaves.len() > MOST_LEAVES {
            return vec![(group.bounds, 1.0)];
        }
        let boxes = self.matters(group).into_iter().zip(group.leaves.clone());
        let placed = |leaf: u32| self.leaf(LeafId(leaf)).instance().map(|(run, _)| run.prototype.index());
        let load = |leaf: u32| 1.0 + placed(leaf).and_then(|placed| loads[placed]).unwrap_or(0.0);
        boxes.map(|(bounds, leaf)| (bounds, load(leaf))).filter(|(bounds, _)| !bounds.is_empty()).collect()
    }
}

impl RayLoad {
    /// The number of boxes.
    pub fn len(&self) -> usize {
        self.boxes.len()
    }

    /// True if no leaf matters anywhere.
    pub fn is_empty(&self) -> bool {
        self.boxes.is_empty()
    }

    /// The mean number of leaves that a ray through a box reaches, with as many rays along each axis. Rays that miss a leaf within its
    /// box are counted.
    pub fn through(&self, bounds: &Bounds) -> f64 {
        let areas = cross_sections(bounds);
        let axes = match has_no_area(&areas) {
            true => 3,
            false => areas.iter().filter(|area| **area > 0.0).count(),
        };
        self.along_axes(bounds).iter().sum::<f64>() / axes as f64
    }

    /// Like [`through`](Self::through), for the rays along each axis. A flat box has no rays along the axes in its plane.
    pub fn along_axes(&self, bounds: &Bounds) -> [f64; 3] {
        let areas = cross_sections(bounds);
        let has_no_area = has_no_area(&areas);
        let mut sums = [0.0; 3];
        for (own, load) in &self.boxes {
            let common = own.intersection(bounds);
            if common.is_empty() {
                continue;
            }
            let met = cross_sections(&common);
            for axis in 0..3 {
                sums[axis] += match areas[axis] {
                    _ if has_no_area => *load,
                    area if area > 0.0 => load * (met[axis] / area),
                    _ => 0.0,
                };
            }
        }
        sums
    }
}

/// True for an unbounded box and for a line: rays cannot be spread over it, and each counts as one that reaches every box.
fn has_no_area(areas: &[f64; 3]) -> bool {
    areas.iter().all(|area| *area == 0.0) || !areas.iter().all(|area| area.is_finite())
}

/// The areas of the cross-sections of a box along the three axes.
fn cross_sections(own: &Bounds) -> [f64; 3] {
    let size = own.size();
    [size.y * size.z, size.z * size.x, size.x * size.y]
}

#[cfg(test)]
mod tests {
    use crate::{Program, Solid};
    use rayweave_math::{Affine, Bounds, Vec3};
    use rayweave_shape::primitive::{BoxFromCorners, Primitive};

    fn cube() -> Solid {
        Solid::from(Primitive::from(BoxFromCorners::new(Vec3::splat(-1.0), Vec3::splat(1.0)).unwrap()))
    }

    fn load(solid: &Solid, bounds: &Bounds) -> f64 {
        Program::compile(solid).unwrap().ray_load().through(bounds)
    }

    /// Boxes are a little larger than the leaves: by rounding errors.
    #[test]
    fn each_leaf_counts_by_its_cross_section() {
        let whole = Bounds::new(Vec3::splat(-1.0), Vec3::splat(1.0));
        assert!((load(&cube(), &whole) - 1.0).abs() < 1e-9);
        let twice = Bounds::new(Vec3::splat(-2.0), Vec3::splat(2.0));
        assert!((load(&cube(), &twice) - 0.25).abs() < 1e-9);
        let both = cube() | cube().translate([0.5, 0.0, 0.0]);
        let around = Bounds::new(Vec3::splat(-1.0), Vec3::new(1.5, 1.0, 1.0));
        // each along x, and four fifths of the rays along y and z
        assert!((load(&both, &around) - 2.0 * (1.0 + 0.8 + 0.8) / 3.0).abs() < 1e-9);
        assert_eq!(load(&Solid::empty(), &whole), 0.0);
    }

    /// A third of the rays is parallel to a row of boxes, however small the cross-section of the row is.
    #[test]
    fn rays_along_a_row_reach_all_of_it() {
        let row = Solid::union((0..100).map(|k| cube().translate([f64::from(4 * k), 0.0, 0.0])));
        let around = Bounds::new(Vec3::splat(-1.0), Vec3::new(397.0, 1.0, 1.0));
        let across = 100.0 * 2.0 / 398.0;
        assert!((load(&row, &around) - (100.0 + 2.0 * across) / 3.0).abs() < 1e-6, "{}", load(&row, &around));
        let along = Program::compile(&row).unwrap().ray_load().along_axes(&around);
        let expected = [100.0, across, across];
        assert!(along.iter().zip(expected).all(|(own, sum)| (own - sum).abs() < 1e-6), "{along:?}");
        let flat = Bounds::new(Vec3::new(-1.0, -1.0, 0.0), Vec3::new(397.0, 1.0, 0.0));
        assert!((load(&row, &flat) - across).abs() < 1e-6, "{}", load(&row, &flat));
    }

    /// A chain of 32 operators has 17 of them above a leaf on average.
    #[test]
    fn leaves_below_many_operators_take_more_work() {
        let work = |solid: &Solid| Program::compile(solid).unwrap().work_per_leaf();
        assert_eq!(work(&cube()), 1.0);
        let chain = (0..32).fold(cube(), |all, k| {
            let own = cube().translate([0.01 * f64::from(k + 1), 0.0, 0.0]);
            if k % 2 == 0 { all | own } else { all & own }
        });
        assert!((work(&chain) - (1.0 + 560.0 / 33.0 / 16.0)).abs() < 1e-9, "{}", work(&chain));
        // a parity gate counts as 20 gates
        let odd =
            Solid::symmetric_difference((0..3).map(|k| cube().translate([0.1 * f64::from(k), 0.0, 0.0])));
        assert!((work(&odd) - (1.0 + 20.0 / 16.0)).abs() < 1e-9, "{}", work(&odd));
    }

    #[test]
    fn copies_count_with_their_leaves() {
        let pair = cube() | cube().translate([0.0, 0.0, 1.0]);
        let copies = [0.0, 100.0].map(|x| Affine::translate(Vec3::new(x, 0.0, 0.0)));
        let placed = pair.place(copies.to_vec());
        let around = Bounds::new(Vec3::splat(-1.0), Vec3::new(1.0, 1.0, 2.0));
        // the copy itself, and both leaves: each along z, and two thirds of the rays along x and y
        assert!(
            (load(&placed, &around) - (1.0 + 2.0 * (1.0 + 2.0 / 3.0 + 2.0 / 3.0) / 3.0)).abs() < 1e-6,
            "{}",
            load(&placed, &around)
        );
    }
}
