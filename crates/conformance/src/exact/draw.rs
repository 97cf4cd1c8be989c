//! Random models and rays full of coincidences, in dyadic numbers.

use super::{Map, Part, Shape, Tree};
use crate::Random;
use rayweave_math::Vec3;
use rayweave_shape::Ray;

/// A random scale by a power of two or a shift, to be applied to a model and its rays; empty for most models.
pub fn stage(rng: &mut Random) -> Vec<Map> {
    match rng.below(6) {
        0 => vec![Map::Scale([libm::ldexp(1.0, rng.below(53) as i32 - 26); 3])],
        1 => vec![Map::Move(halves(rng).map(|x| x * libm::ldexp(1.0, rng.below(20) as i32)))],
        _ => Vec::new(),
    }
}

/// A ray transformed to a stage; `None` if that would round it.
pub fn staged(ray: Ray, stage: &[Map]) -> Option<Ray> {
    stage.iter().try_fold(ray, |ray, map| {
        let affine = map.affine();
        let moved = ray.transformed(&affine);
        let exact = match affine.inverse() {
            Ok(back) => moved.transformed(&back) == ray,
            Err(_) => false,
        };
        exact.then_some(moved)
    })
}

/// A model of one part, or of several with any media, on a grid of pitch 0.5 with few sizes: many faces,
/// edges, axes and points of contact coincide.
pub fn parts(rng: &mut Random) -> Vec<Part> {
    let count = if rng.chance(0.7) { 1 } else { 2 + rng.below(3) };
    let leaves = if count == 1 { 1 + rng.below(7) } else { 1 + rng.below(3) };
    (0..count)
        .map(|_| {
            let recipe = rng.chance(0.3);
            let tree = if recipe { special(rng) } else { tree(rng, leaves) };
            Part { tree, medium: 1 + rng.below(3) as u32 }
        })
        .collect()
}

/// A random tree of about `leaves` leaves.
fn tree(rng: &mut Random, leaves: usize) -> Tree {
    if leaves <= 1 {
        let shape = shape(rng);
        let moved = placed(rng, Tree::Leaf(shape));
        return if rng.chance(0.1) { moved.complement() } else { moved };
    }
    let left = 1 + rng.below(leaves - 1);
    let (a, b) = (tree(rng, left), tree(rng, leaves - left));
    let both = match rng.below(12) {
        0..4 => Tree::Any(vec![a, b]),
        4..6 => Tree::All(vec![a, b]),
        6..9 => a.minus(b),
        9 => Tree::Odd(vec![a, b]),
        10 => many(rng, a, b),
        _ => Tree::Any(vec![a, b]).complement(),
    };
    match rng.below(12) {
        0 => both.moved(map(rng)),
        1 => Tree::Placed(vec![map(rng), map(rng)], Box::new(both)),
        _ => both,
    }
}

fn many(rng: &mut Random, a: Tree, b: Tree) -> Tree {
    let mut all = vec![a, b];
    match rng.below(4) {
        0 => all.push(Tree::Empty),
        1 => all.push(Tree::Universe),
        2 => all.push(all[0].clone()),
        _ => all.push(placed_shape(rng)),
    }
    match rng.below(3) {
        0 => Tree::Any(all),
        1 => Tree::All(all),
        _ => Tree::Odd(all),
    }
}

fn placed_shape(rng: &mut Random) -> Tree {
    let shape = shape(rng);
    placed(rng, Tree::Leaf(shape))
}

fn placed(rng: &mut Random, tree: Tree) -> Tree {
    let mut tree = tree;
    for _ in 0..rng.below(3) {
        tree = tree.moved(map(rng));
    }
    tree
}

fn half(rng: &mut Random) -> f64 {
    0.5 * (rng.below(7) as f64 - 3.0)
}

fn halves(rng: &mut Random) -> [f64; 3] {
    [half(rng), half(rng), half(rng)]
}

fn map(rng: &mut Random) -> Map {
    match rng.below(10) {
        0..5 => Map::Move(halves(rng)),
        5..8 => Map::Turn(rng.below(3), 1 + rng.below(3) as u8),
        8 => Map::Mirror(rng.below(3)),
        _ => Map::Scale(rng.pick(&[[2.0; 3], [0.5; 3], [1.0, 2.0, 1.0], [-1.0, 0.5, 1.0]])),
    }
}

fn size(rng: &mut Random) -> f64 {
    rng.pick(&[0.5, 1.0, 1.0, 2.0])
}

fn normal(rng: &mut Random) -> [f64; 3] {
    let axis = Vec3::AXES[rng.below(3)].to_array();
    let sign = rng.pick(&[1.0, -1.0]);
    match rng.below(6) {
        0 => {
            rng.pick(&[[1.0, 1.0, 0.0], [1.0, 0.0, -1.0], [0.0, 1.0, 1.0], [1.0, 1.0, 1.0], [1.0, 2.0, 0.0]])
        }
        _ => axis.map(|x| sign * x + 0.0),
    }
}

fn shape(rng: &mut Random) -> Shape {
    match rng.below(3) {
        0 => flat(rng),
        1 => round(rng),
        _ => block(rng),
    }
}

fn block(rng: &mut Random) -> Shape {
    let edges = [size(rng), size(rng), size(rng)];
    if rng.chance(0.3) {
        return Shape::Box(edges);
    }
    let lo = halves(rng);
    Shape::Corners(lo, std::array::from_fn(|k| lo[k] + edges[k]))
}

fn flat(rng: &mut Random) -> Shape {
    match rng.below(6) {
        0 => Shape::HalfSpace(normal(rng), half(rng)),
        1 => {
            let lo = half(rng);
            Shape::Slab(normal(rng), lo, lo + size(rng))
        }
        2..4 => Shape::Wedge(rng.below(4) as u8, 1 + rng.below(3) as u8),
        4 => Shape::Prism(size(rng), size(rng)),
        _ => {
            let rows = (0..3 + rng.below(3)).map(|_| {
                let [a, b, c] = normal(rng);
                [a, b, c, half(rng).abs()]
            });
            Shape::Convex(rows.collect())
        }
    }
}

fn round(rng: &mut Random) -> Shape {
    let radius = rng.pick(&[0.5, 1.0]);
    let height = rng.pick(&[1.0, 2.0, f64::INFINITY]);
    match rng.below(12) {
        0..3 => Shape::Sphere(rng.pick(&[0.5, 1.0, 1.5])),
        3..7 => Shape::Cylinder(radius, height),
        7 => Shape::Ellipsoid([size(rng), size(rng), size(rng)]),
        8..10 => {
            let (a, b) = rng.pick(&[(1.0, 0.0), (0.0, 1.0), (1.0, 0.5), (0.5, 1.5), (1.0, 1.0), (0.5, 0.0)]);
            Shape::Cone(a, b, rng.pick(&[1.0, 2.0]))
        }
        10 => Shape::Paraboloid(rng.pick(&[0.25, 0.5]), rng.pick(&[1.0, 2.0, f64::INFINITY])),
        _ if rng.chance(0.3) => Shape::Tube(2.0 * radius, radius, rng.pick(&[1.0, 2.0])),
        _ => general(rng),
    }
}

/// Quadrics of all other kinds, many of which contain straight lines of the grid.
fn general(rng: &mut Random) -> Shape {
    let (entries, size): (&[(usize, usize, f64)], f64) = match rng.below(9) {
        k @ 0..3 => return hyperboloid([1.0, -1.0, 0.0][k]),
        // saddles: x y < z, x^2 - y^2 < z
        3 => (&[(0, 1, 0.5), (2, 3, -0.5)], 2.0),
        4 => (&[(0, 0, 1.0), (1, 1, -1.0), (2, 3, -0.5)], 1.0),
        // cylinders over a parabola and over a hyperbola
        5 => (&[(0, 0, 1.0), (2, 3, -0.5)], 1.0),
        6 => (&[(0, 0, 1.0), (1, 1, -1.0), (3, 3, -0.25)], 0.5),
        // two crossing planes, and a cone about a slanted axis: x y < 0, z^2 < x y
        7 => (&[(0, 1, 0.5)], 0.0),
        _ => (&[(0, 1, -0.5), (2, 2, 1.0)], 0.0),
    };
    let mut matrix = [[0.0; 4]; 4];
    entries.iter().for_each(|&(i, j, x)| (matrix[i][j], matrix[j][i]) = (x, x));
    Shape::Quadric(matrix, size)
}

/// The hyperboloid x^2 + y^2 < z^2 + level: of one sheet, of two, or the double cone between them.
fn hyperboloid(level: f64) -> Shape {
    let mut matrix = [[0.0; 4]; 4];
    (matrix[0][0], matrix[1][1], matrix[2][2], matrix[3][3]) = (1.0, 1.0, -1.0, -level);
    Shape::Quadric(matrix, level.abs())
}

/// Arrangements in which most rays have a coincidence.
fn special(rng: &mut Random) -> Tree {
    let corners = |lo: [f64; 3], hi: [f64; 3]| Tree::Leaf(Shape::Corners(lo, hi));
    let cube = corners([-1.0; 3], [1.0; 3]);
    let rod = Tree::Leaf(Shape::Cylinder(0.5, 2.0));
    let ball = Tree::Leaf(Shape::Sphere(1.0));
    let tree = match rng.below(12) {
        // a hole flush with both faces
        0 => cube.minus(rod),
        // two blocks side by side
        1 => Tree::Any(vec![cube.clone(), cube.at(2.0, 0.0, 0.0)]),
        // four around an edge
        2 => {
            let at = |x: f64, y: f64| corners([x, y, -1.0], [x + 1.0, y + 1.0, 1.0]);
            Tree::Any(vec![at(-1.0, -1.0), at(0.0, -1.0), at(-1.0, 0.0), at(0.0, 0.0)])
        }
        // two balls in contact
        3 => Tree::Any(vec![ball.clone(), ball.at(2.0, 0.0, 0.0)]),
        // a ball in a box
        4 => cube.minus(ball),
        // rods on one axis, flush
        5 => Tree::Any(vec![rod.clone(), rod.at(0.0, 0.0, 2.0)]),
        // a pin in its hole
        6 => Tree::Any(vec![cube.minus(rod.clone()), rod]),
        // wedges all around
        7 => {
            let slice = |k: u8| Tree::Leaf(Shape::Wedge(k, 1));
            let fan = Tree::Any((0..4).map(slice).collect());
            Tree::All(vec![fan, Tree::Leaf(Shape::Cylinder(1.0, 2.0))])
        }
        // a cone on a rod, apex to apex with another
        8 => {
            let cone = Tree::Leaf(Shape::Cone(0.5, 0.0, 1.0));
            let other = Tree::Leaf(Shape::Cone(0.0, 0.5, 1.0));
            Tree::Any(vec![rod, cone.at(0.0, 0.0, 1.5), other.at(0.0, 0.0, 2.5)])
        }
        // a solid minus itself
        9 => Tree::Any(vec![cube.clone(), ball.clone()]).minus(Tree::Any(vec![ball, cube])),
        // a block cut by a face-sharing block
        10 => cube.clone().minus(corners([0.0, -1.0, -1.0], [1.0, 1.0, 0.5])),
        // a ball around a rod, which intersect in a circle, within a tube
        _ => {
            let tube = Tree::Leaf(Shape::Tube(1.0, 0.5, 2.0));
            Tree::Odd(vec![ball, tube, rod])
        }
    };
    match rng.below(3) {
        0 => tree.moved(map(rng)),
        1 => Tree::Placed(vec![map(rng), map(rng)], Box::new(tree)),
        _ => tree,
    }
}

/// A ray with coordinates that `f64` holds exactly, mostly through points and along lines of the grid.
pub fn ray(rng: &mut Random) -> Ray {
    let point = Vec3::from_array(halves(rng));
    let whole = |rng: &mut Random| rng.below(7) as f64 - 3.0;
    let mut direction = Vec3::ZERO;
    match rng.below(16) {
        // anywhere
        0..4 => {
            let (a, b) = (rng.point(2.5), rng.point(2.5));
            return Ray::new(a - 2.0 * (b - a), b - a);
        }
        4..7 => direction[rng.below(3)] = rng.pick(&[1.0, -1.0, 2.0, 0.125]),
        7..9 => direction = Vec3::from_array(std::array::from_fn(|_| rng.below(3) as f64 - 1.0)),
        9 => direction = Vec3::new(whole(rng), whole(rng), whole(rng)),
        // along rulings of the cones of the grid, whose radii and heights are powers of two
        10 => {
            let axis = rng.below(3);
            direction[axis] = 1.0;
            direction[(axis + 1 + rng.below(2)) % 3] = rng.pick(&[1.0, -1.0, 2.0, -2.0, 0.5, -0.5, 0.25]);
        }
        // from a point of the grid in any direction
        11 => direction = rng.direction(),
        // at a tiny angle to an axis
        12..14 => {
            let axis = rng.below(3);
            direction[axis] = rng.pick(&[1.0, -1.0]);
            direction[(axis + 1) % 3] = libm::ldexp(rng.pick(&[1.0, -1.0, 3.0]), -(4 + rng.below(38) as i32));
        }
        14 => {
            direction[rng.below(3)] = 1.0;
            let axis = rng.below(3);
            let perturbation = libm::ldexp(1.0, -(6 + rng.below(45) as i32));
            return Ray::new(point + Vec3::AXES[axis] * perturbation, direction);
        }
        _ => {
            direction =
                Vec3::new(whole(rng), whole(rng), whole(rng)) * libm::ldexp(1.0, rng.below(41) as i32 - 20)
        }
    }
    if direction == Vec3::ZERO {
        direction = Vec3::X;
    }
    let far = if rng.chance(0.1) { libm::ldexp(1.0, rng.below(21) as i32) } else { whole(rng) };
    let origin = point - far * direction;
    // the ray passes through the point only if nothing was rounded
    let exact = (0..3).all(|k| origin[k] + far * direction[k] == point[k]);
    Ray::new(if exact { origin } else { point }, direction)
}
