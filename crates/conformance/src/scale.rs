//! Families of models of any size, for tests and measurements of the cost as a function of the number of
//! leaves.
//!
//! All lie in the cube between (-1, -1, -1) and (1, 1, 1), so that the same rays serve every size. They are
//! identical on every platform.

use crate::Random;
use crate::models::{block, shape};
use rayweave_math::{Affine, Vec3};
use rayweave_model::Solid;
use std::f64::consts::PI;

/// The fraction of the cube that the spheres of [`spheres`] would fill without overlaps.
pub const FILLING: f64 = 0.2;

/// The union of `n` spheres at random places. Radii are between 0.5 and 1.5 of a mean proportional to
/// n^(-1/3), so that the sum of their volumes is the same fraction of the cube, [`FILLING`], for every n.
pub fn spheres(n: usize, seed: u64) -> Solid {
    let mut rng = Random::new(seed);
    // the mean of x^3 for x uniform in [0.5, 1.5) is 1.25
    let mean = libm::cbrt(8.0 * FILLING / (1.25 * 4.0 / 3.0 * PI * n.max(1) as f64));
    Solid::union((0..n).map(|_| {
        let radius = mean * rng.between(0.5, 1.5);
        let centre = rng.point((1.0 - radius).max(0.0));
        shape("sphere", &[("radius", radius)]).translate(centre)
    }))
}

/// The union of `n` parts at random places, each turned at random: cylinders, tubes, frustums and ellipsoids in turn. Their size
/// is proportional to n^(-1/3), so that the number of parts on a ray grows as in [`spheres`].
pub fn parts(n: usize, seed: u64) -> Solid {
    let mut rng = Random::new(seed);
    let size = libm::cbrt(0.2 / n.max(1) as f64);
    Solid::union((0..n).map(|k| {
        let (r, h) = (size * rng.between(0.25, 0.5), size * rng.between(0.5, 1.5));
        let part = match k % 4 {
            0 => shape("cylinder", &[("radius", r), ("height", h)]),
            1 => shape("tube", &[("outer_radius", r), ("inner_radius", 0.6 * r), ("height", h)]),
            2 => shape("cone", &[("radius1", r), ("radius2", 0.5 * r), ("height", h)]),
            _ => shape("sphere", &[("radius", r)]).scale([1.0, 0.7, h / (2.0 * r)]),
        };
        let turn = Affine::rotation(rng.direction(), rng.between(0.0, 360.0));
        part.apply(turn).translate(rng.point((1.0 - size).max(0.0)))
    }))
}

/// A plate, 2 by 2 by 0.1, minus `n` round holes on a square grid: `n` + 1 leaves.
pub fn plate(n: usize) -> Solid {
    let half = Vec3::new(1.0, 1.0, 0.05);
    let rows = whole_root(n, 2);
    let pitch = 2.0 / rows as f64;
    let holes = (0..n).map(|k| {
        let at = |k: usize| pitch * (k as f64 + 0.5) - 1.0;
        let hole = shape("cylinder", &[("radius", 0.3 * pitch), ("height", 0.2)]);
        hole.translate(Vec3::new(at(k % rows), at(k / rows), 0.0))
    });
    block(-half, half) - Solid::union(holes)
}

/// A sponge by nested differences: a cube minus three square bars through its middle (as in Menger's sponge), minus
/// smaller sponges of the same form in the 20 cubes that the bars leave. Each cube takes four leaves; larger cubes come
/// first, until there are `n` leaves (or up to three more).
pub fn sponge(n: usize) -> Solid {
    let cells = cells(n.div_ceil(4).max(1));
    let mut holes: Vec<Vec<Solid>> = vec![Vec::new(); cells.len()];
    let mut cube = Solid::empty();
    for (k, cell) in cells.iter().enumerate().rev() {
        let less = std::mem::take(&mut holes[k]);
        cube = cell.drilled(less);
        if let Some(parent) = cell.parent {
            holes[parent].push(cube.clone());
        }
    }
    cube
}

/// A cube of the sponge.
struct Cell {
    centre: Vec3,
    half: f64,
    parent: Option<usize>,
}

impl Cell {
    /// The cube minus the bars and the solids in `less`, which are in reverse order.
    fn drilled(&self, less: Vec<Solid>) -> Solid {
        // the bars extend beyond the cube, and no two other faces touch
        let bar = |along: Vec3| {
            let half = self.half * (Vec3::splat(0.3) + 0.71 * along);
            block(self.centre - half, self.centre + half)
        };
        let cube = block(self.centre - Vec3::splat(self.half), self.centre + Vec3::splat(self.half));
        let bars = [Vec3::X, Vec3::Y, Vec3::Z].map(bar);
        cube - Solid::union(bars.into_iter().chain(less.into_iter().rev()))
    }

    /// The 20 cubes of a third of the size that the bars leave, slightly shrunk.
    fn smaller(&self, number: usize) -> impl Iterator<Item = Cell> {
        let place = |k: usize| Vec3::new((k % 3) as f64, (k / 3 % 3) as f64, (k / 9) as f64) - Vec3::ONE;
        let beside_the_bars = |at: &Vec3| at.abs().element_sum() >= 2.0;
        (0..27).map(place).filter(beside_the_bars).map(move |at| Cell {
            centre: self.centre + at * (self.half * 2.0 / 3.0),
            half: self.half * 0.3,
            parent: Some(number),
        })
    }
}

/// The first cubes of the sponge, largest first.
fn cells(count: usize) -> Vec<Cell> {
    let mut cells = vec![Cell { centre: Vec3::ZERO, half: 1.0, parent: None }];
    for number in 0.. {
        if cells.len() >= count {
            break;
        }
        let smaller: Vec<Cell> = cells[number].smaller(number).collect();
        cells.extend(smaller);
    }
    cells.truncate(count);
    cells
}

/// One die of five leaves (a box intersected with a sphere, minus three cylinders) placed `n` times on a
/// cubic grid without rotation: `n` instances.
pub fn lattice(n: usize) -> Solid {
    die(n).place(grid(n).map(Affine::translate).collect::<Vec<_>>())
}

/// The same die placed `n` times, each with its own rotation and scale.
pub fn lattice_affine(n: usize, seed: u64) -> Solid {
    let mut rng = Random::new(seed);
    let map = |at: Vec3| {
        let scaling = Vec3::ONE - 0.25 * (rng.point(1.0) + Vec3::ONE);
        Affine::scale(scaling)
            .then(&Affine::rotation(rng.direction(), rng.between(0.0, 360.0)))
            .then(&Affine::translate(at))
    };
    die(n).place(grid(n).map(map).collect::<Vec<_>>())
}

/// The first `n` cell centres of a cubic grid that fills the cube.
fn grid(n: usize) -> impl Iterator<Item = Vec3> {
    let rows = whole_root(n, 3);
    let at = move |k: usize| (2 * k + 1) as f64 / rows as f64 - 1.0;
    (0..n).map(move |k| Vec3::new(at(k % rows), at(k / rows % rows), at(k / (rows * rows))))
}

/// A die that fits into a cell of [`grid`] in any orientation.
fn die(n: usize) -> Solid {
    let size = 2.0 / whole_root(n, 3) as f64;
    let hole = shape("cylinder", &[("radius", 0.15 * size), ("height", size)]);
    let cube = shape("box", &[("size", 0.7 * size)]);
    let ball = shape("sphere", &[("radius", 0.47 * size)]);
    (cube & ball) - Solid::union([hole.rotate_y(90.0), hole.rotate_x(90.0), hole])
}

/// The least integer >= 1 whose power is at least `n`.
fn whole_root(n: usize, power: u32) -> usize {
    (1..).find(|&k: &usize| k.pow(power) >= n).unwrap_or(1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rayweave_model::Program;

    #[test]
    fn families_have_the_requested_number_of_leaves_and_fit_the_cube() {
        let in_cube = |solid: Solid, leaves: usize| {
            let program = Program::compile(&solid).unwrap();
            let group = program.prototypes()[0].leaves.len();
            assert_eq!(group, leaves);
            let bounds = program.bounds();
            // the bounding box of a rotated box is larger than the box
            let most = if solid.to_string().contains("place") { 1.2 } else { 1.0 + 1e-12 };
            assert!(bounds.lo.abs().max(bounds.hi.abs()).max_element() <= most, "{bounds:?}");
        };
        for n in [1, 7, 100, 1000] {
            in_cube(spheres(n, 1), n);
            in_cube(parts(n, 1), n);
            in_cube(plate(n), n + 1);
            in_cube(sponge(n), n.div_ceil(4) * 4);
            // a solid placed once is not an instance
            in_cube(lattice(n), if n == 1 { 5 } else { n });
            in_cube(lattice_affine(n, 1), if n == 1 { 5 } else { n });
        }
    }
}
