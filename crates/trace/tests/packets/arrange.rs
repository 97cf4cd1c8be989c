//! Parts whose faces are close to each other, with targets for rays.

use crate::aim::Target;
use rayweave_conformance::Random;
use rayweave_conformance::models::{block, half_space, shape};
use rayweave_math::{Affine, Vec3};
use rayweave_model::Solid;
use rayweave_shape::primitive::{Value, build};

/// Returns parts, and targets at their degenerate places.
pub type Arrangement = fn(&mut Random) -> (Vec<Solid>, Vec<Target>);

/// All arrangements.
pub const ALL: [Arrangement; 12] = [
    thin_shells,
    thin_gaps,
    touching_balls,
    coaxial_rods,
    edges_and_corners,
    rims,
    bores_beside_faces,
    unbounded_parts,
    whole_coordinates,
    cones,
    conics,
    rings,
];

/// Zero, or a length from far below the tolerance, which is about 5e-14 here, to far above it, most often
/// near it.
pub fn gap(rng: &mut Random) -> f64 {
    match rng.below(10) {
        0 => 0.0,
        1..4 => rng.magnitude(-16.0, -8.0),
        _ => rng.magnitude(-14.5, -12.0),
    }
}

pub fn sphere(radius: f64) -> Solid {
    shape("sphere", &[("radius", radius)])
}

pub fn cylinder(radius: f64, height: f64) -> Solid {
    shape("cylinder", &[("radius", radius), ("height", height)])
}

pub fn cube(half: Vec3) -> Solid {
    block(-half, half)
}

/// A target on a unit ball.
fn on_ball(rng: &mut Random) -> Target {
    let normal = rng.direction();
    Target::new(normal, normal, normal.cross(rng.direction()).normalize())
}

fn on_rod(rng: &mut Random) -> Target {
    let turn = rng.between(-3.2, 3.2);
    let normal = Vec3::new(libm::cos(turn), libm::sin(turn), 0.0);
    Target::new(normal + rng.between(-0.9, 0.9) * Vec3::Z, normal, Vec3::Z)
}

/// A target on the cube of half width 1, in the middle of a face or near its border.
fn on_cube(rng: &mut Random) -> Target {
    let axis = rng.below(3);
    let (mut normal, mut along) = (Vec3::AXES[axis], Vec3::AXES[(axis + 1) % 3]);
    if rng.chance(0.5) {
        normal = -normal;
    }
    if rng.chance(0.3) {
        along = (along + rng.between(-2.0, 2.0) * normal.cross(along)).normalize();
    }
    let half_width = rng.pick(&[0.0, 0.5, 0.9, 1.0]);
    let level = rng.between(-half_width, half_width) * Vec3::AXES[(axis + 1) % 3];
    Target::new(
        normal + level + rng.between(-half_width, half_width) * Vec3::AXES[(axis + 2) % 3],
        normal,
        along,
    )
}

fn several(rng: &mut Random, count: usize, target: fn(&mut Random) -> Target) -> Vec<Target> {
    (0..count).map(|_| target(rng)).collect()
}

/// Two or three nested solids of one shape, of nearly equal size.
pub fn thin_shells(rng: &mut Random) -> (Vec<Solid>, Vec<Target>) {
    let (a, b) = (gap(rng), gap(rng));
    let sizes = [1.0, 1.0 - a, 1.0 - a - b];
    let count = 2 + rng.below(2);
    let kind = rng.below(3);
    let solid = |&size: &f64| match kind {
        0 => sphere(size),
        1 => cylinder(size, 2.0 * size),
        _ => cube(Vec3::splat(size)),
    };
    let target = [on_ball, on_rod, on_cube][kind];
    let mut parts: Vec<Solid> = sizes[..count].iter().map(solid).collect();
    if rng.chance(0.3) {
        parts.push(cube(Vec3::new(2.0, 0.3, 0.4)));
    }
    (parts, several(rng, 6, target))
}

/// Boxes with a narrow gap or overlap between them.
pub fn thin_gaps(rng: &mut Random) -> (Vec<Solid>, Vec<Target>) {
    let top = 1.0 + gap(rng);
    let next = block(Vec3::new(-0.5, -1.0, top), Vec3::new(1.5, 1.0, 2.0));
    let mut parts = vec![cube(Vec3::ONE), next];
    if rng.chance(0.5) {
        let side = 1.0 + gap(rng);
        parts.push(block(Vec3::new(side, -1.0, -1.0), Vec3::new(2.0, 1.0, 1.0 + gap(rng))));
    }
    if rng.chance(0.5) {
        parts.push(sphere(0.5).translate([0.0, 0.0, 1.5 + gap(rng)]));
    }
    let level = |rng: &mut Random| {
        let point = Vec3::new(rng.between(-0.5, 1.0), rng.between(-1.0, 1.0), 1.0);
        let any = rng.between(0.0, 3.0);
        let turn = rng.pick(&[0.0, 1.0, any]);
        Target::new(point, Vec3::Z, Vec3::new(libm::cos(turn), libm::sin(turn), 0.0))
    };
    let targets = vec![level(rng), level(rng), level(rng), on_cube(rng)];
    (parts, targets)
}

/// Balls, or a ball and a rod, that nearly touch: rays through the contact and along common tangents.
pub fn touching_balls(rng: &mut Random) -> (Vec<Solid>, Vec<Target>) {
    let apart = 1.0 + gap(rng);
    let radius = rng.pick(&[0.5, 1.0, 3.0]);
    let other = if rng.chance(0.6) { sphere(radius) } else { cylinder(radius, 6.0) };
    let inner = rng.chance(0.3) && radius < 1.0;
    let at = if inner { 1.0 - radius + gap(rng) } else { apart + radius };
    let mut parts = vec![sphere(1.0), other.translate([at, 0.0, 0.0])];
    if rng.chance(0.3) {
        parts.push(half_space(Vec3::X, 1.0 + gap(rng)));
    }
    if rng.chance(0.3) {
        parts.push(cube(Vec3::new(1.0 + gap(rng), 0.5, 2.0)));
    }
    let along = |rng: &mut Random| {
        let any = rng.between(0.0, 3.0);
        let turn = rng.pick(&[0.0, 1.0, any]);
        Target::new(Vec3::X, Vec3::X, Vec3::new(0.0, libm::cos(turn), libm::sin(turn)))
    };
    let targets = vec![along(rng), along(rng), along(rng), on_ball(rng)];
    (parts, targets)
}

/// Coaxial rods, with rays nearly along the axis.
pub fn coaxial_rods(rng: &mut Random) -> (Vec<Solid>, Vec<Target>) {
    let radius = |rng: &mut Random| rng.pick(&[1.0, 1.0, 0.5, 0.999]) + gap(rng);
    let height = |rng: &mut Random| rng.pick(&[2.0, 2.0, 1.0, f64::INFINITY]);
    let mut parts: Vec<Solid> =
        (0..2 + rng.below(2)).map(|_| cylinder(radius(rng), height(rng) + gap(rng))).collect();
    parts[0] = cylinder(1.0, height(rng));
    match rng.below(4) {
        0 => parts.push(cube(Vec3::new(1.0, 2.0, 1.0 + gap(rng)))),
        1 => parts.push(sphere(1.0 + gap(rng))),
        2 => parts.push(shape(
            "tube",
            &[("outer_radius", 1.0 + gap(rng).abs()), ("inner_radius", 0.5), ("height", 2.0)],
        )),
        _ => {}
    }
    let mut targets = several(rng, 5, on_rod);
    targets.push(Target::new(Vec3::ZERO, Vec3::X, Vec3::Z));
    (parts, targets)
}

/// Boxes, prisms and wedges with common or nearly common edges.
pub fn edges_and_corners(rng: &mut Random) -> (Vec<Solid>, Vec<Target>) {
    let shift = |rng: &mut Random| {
        let mut by = Vec3::ZERO;
        by[rng.below(3)] = rng.pick(&[0.0, 1.0, 2.0, -2.0]) + gap(rng);
        by
    };
    let part = |rng: &mut Random| match rng.below(6) {
        0..3 => cube(Vec3::ONE),
        3 => shape(
            "wedge",
            &[("start_degrees", 90.0), ("sweep_degrees", rng.pick(&[90.0, 45.0, 180.0, 300.0]))],
        )
        .translate([1.0, 1.0, 0.0]),
        4 => shape(
            "prism",
            &[("sides", rng.pick(&[3.0, 4.0, 6.0])), ("radius", 2.0f64.sqrt()), ("height", 2.0)],
        ),
        _ => half_space(Vec3::new(1.0, 1.0, 0.0), 2.0 + gap(rng)),
    };
    let mut parts = vec![cube(Vec3::ONE)];
    for _ in 0..1 + rng.below(3) {
        let by = shift(rng);
        parts.push(part(rng).translate(by));
    }
    let edge = |rng: &mut Random| {
        let normal = Vec3::new(1.0, 1.0, 0.0).normalize();
        Target::new(Vec3::new(1.0, 1.0, rng.pick(&[0.25, 1.0, -1.0])), normal, Vec3::Z)
    };
    let targets = vec![edge(rng), edge(rng), on_cube(rng), on_cube(rng)];
    (parts, targets)
}

/// Rims between caps and sides: rods, tubes, balls cut by planes.
pub fn rims(rng: &mut Random) -> (Vec<Solid>, Vec<Target>) {
    let thin = 1.0 - gap(rng).abs().max(1e-15);
    let inner = rng.pick(&[0.6, 0.8, thin]);
    let tube = shape("tube", &[("outer_radius", 1.0), ("inner_radius", inner), ("height", 2.0)]);
    let cut = half_space(rng.pick(&[Vec3::Z, -Vec3::Z, Vec3::new(0.6, 0.0, 0.8)]), 1.0 + gap(rng));
    let all = [
        cylinder(1.0, 2.0 + gap(rng)),
        tube,
        sphere(2.0f64.sqrt() + gap(rng)),
        cut,
        cube(Vec3::new(1.0, 1.0, 1.0 + gap(rng))),
        cylinder(1.0, f64::INFINITY),
    ];
    let order = rng.order(all.len());
    let parts = order[..2 + rng.below(2)].iter().map(|&k| all[k].clone()).collect();
    let rim = |rng: &mut Random| {
        let any = rng.between(0.0, 6.0);
        let turn = rng.pick(&[0.0, any]);
        let out = Vec3::new(libm::cos(turn), libm::sin(turn), 0.0);
        Target::new(out + Vec3::Z, rng.pick(&[out, Vec3::Z, (out + Vec3::Z).normalize()]), out.cross(Vec3::Z))
    };
    (parts, vec![rim(rng), rim(rng), rim(rng), on_rod(rng)])
}

/// Bores that nearly break through a face.
pub fn bores_beside_faces(rng: &mut Random) -> (Vec<Solid>, Vec<Target>) {
    let bore = |rng: &mut Random| {
        let radius = rng.pick(&[0.25, 0.5]);
        let length = rng.pick(&[f64::INFINITY, 1.0, 4.0]);
        cylinder(radius, length).translate([1.0 - radius - gap(rng), rng.pick(&[0.0, 0.5]), 0.0])
    };
    let mut parts = vec![cube(Vec3::ONE), bore(rng)];
    if rng.chance(0.5) {
        parts.push(bore(rng).rotate_z(rng.pick(&[90.0, 180.0])));
    }
    if rng.chance(0.5) {
        parts.push(bore(rng).rotate_x(90.0));
    }
    let wall = |rng: &mut Random| {
        let along = rng.pick(&[Vec3::Z, Vec3::Y, Vec3::new(0.0, 0.6, 0.8)]);
        Target::new(Vec3::new(1.0, rng.pick(&[0.0, 0.5, 0.3]), rng.between(-1.0, 1.0)), Vec3::X, along)
    };
    (parts, vec![wall(rng), wall(rng), wall(rng), on_cube(rng)])
}

/// Half-spaces, slabs, wedges and infinite rods, and complements of bounded parts.
pub fn unbounded_parts(rng: &mut Random) -> (Vec<Solid>, Vec<Target>) {
    let slab = |normal: Vec3, hi: f64| half_space(normal, hi) - half_space(normal, -1.0);
    let part = |rng: &mut Random| match rng.below(8) {
        0..2 => half_space(rng.pick(&Vec3::AXES), 1.0 + gap(rng)),
        2 => half_space(rng.direction(), 1.0),
        3 => slab(rng.pick(&Vec3::AXES), 1.0 + gap(rng)),
        4 => shape("wedge", &[("start_degrees", 10.0), ("sweep_degrees", rng.pick(&[30.0, 90.0, 200.0]))]),
        5 => cylinder(1.0 + gap(rng), f64::INFINITY),
        6 => !cube(Vec3::splat(1.0 + gap(rng))),
        _ => !sphere(1.0),
    };
    let parts = (0..2 + rng.below(4)).map(|_| part(rng)).collect();
    (parts, vec![on_cube(rng), on_cube(rng), on_rod(rng), on_ball(rng)])
}

/// Parts at integer coordinates, some of them turned by 90 degrees: ties on nearly every ray along an axis.
pub fn whole_coordinates(rng: &mut Random) -> (Vec<Solid>, Vec<Target>) {
    let part = |rng: &mut Random| {
        let size = 1.0 + rng.below(2) as f64;
        let solid = match rng.below(6) {
            0 => sphere(size),
            1 => cylinder(size, rng.pick(&[2.0, f64::INFINITY])),
            2 => shape("tube", &[("outer_radius", 1.0 + size), ("inner_radius", size), ("height", 2.0)]),
            3 => half_space(rng.pick(&Vec3::AXES), 0.0),
            _ => cube(Vec3::new(size, 1.0, 1.0)),
        };
        let turn = Affine::rotation(rng.pick(&Vec3::AXES), rng.pick(&[0.0, 90.0]));
        let whole = |rng: &mut Random| rng.below(3) as f64 - 1.0;
        solid.apply(turn).translate([whole(rng), whole(rng), whole(rng)])
    };
    let parts = (0..2 + rng.below(4)).map(|_| part(rng)).collect();
    let target = |rng: &mut Random| {
        let axis = rng.below(3);
        let mut half = || 0.5 * (rng.below(9) as f64 - 4.0);
        let point = Vec3::new(half(), half(), half());
        Target::new(point, Vec3::AXES[axis], Vec3::AXES[(axis + 1) % 3])
    };
    (parts, (0..8).map(|_| target(rng)).collect())
}

fn cone(radius1: f64, radius2: f64, height: f64) -> Solid {
    shape("cone", &[("radius1", radius1), ("radius2", radius2), ("height", height)])
}

/// The solid `x p^2 + y q^2 + z r^2 + constant < 0`.
fn diagonal(x: f64, y: f64, z: f64, constant: f64) -> Solid {
    let rows = [[x, 0.0, 0.0, 0.0], [0.0, y, 0.0, 0.0], [0.0, 0.0, z, 0.0], [0.0, 0.0, 0.0, constant]];
    Solid::from(build("quadric", &[("matrix", Value::from(&rows[..]))]).expect("a legal shape"))
}

/// A target on the cone of slope 1 around z with apex at the origin; `along` is the generator.
fn on_cone(rng: &mut Random) -> Target {
    let turn = rng.pick(&[0.0, 1.0, 2.5]);
    let out = Vec3::new(libm::cos(turn), libm::sin(turn), 0.0);
    let line = (out + Vec3::Z).normalize();
    let height = rng.pick(&[0.0, 1e-9, 0.5, 1.0, -0.5]);
    Target::new(height * (out + Vec3::Z), (out - Vec3::Z).normalize(), line)
}

/// Cones with a common or nearly common apex and flush frusta, with rays along generators and through the
/// apex.
pub fn cones(rng: &mut Random) -> (Vec<Solid>, Vec<Target>) {
    let tip = cone(0.0, 1.0, 1.0).translate([0.0, 0.0, 0.5]);
    let both = diagonal(1.0, 1.0, -1.0, 0.0) & cylinder(2.0, 3.0);
    let part = |rng: &mut Random| match rng.below(9) {
        0 => tip.scale([1.0 + gap(rng), 1.0 + gap(rng), 1.0]),
        1 => tip.translate([0.0, gap(rng), gap(rng)]),
        2 => cone(1.0, 0.0, 1.0).translate([0.0, 0.0, -0.5 + gap(rng)]),
        3 => cone(0.5, 1.0, 0.5).translate([0.0, 0.0, 0.75 + gap(rng)]),
        4 => both.clone(),
        5 => diagonal(1.0, 1.0, -1.0, gap(rng)),
        6 => half_space(rng.pick(&[Vec3::Z, -Vec3::Z, Vec3::new(1.0, 0.0, 1.0)]), gap(rng)),
        7 => cylinder(0.5, rng.pick(&[2.0, f64::INFINITY])),
        _ => cube(Vec3::new(1.0, 1.0, 0.5)),
    };
    let first = if rng.chance(0.7) { tip.clone() } else { both.clone() };
    let parts = [first].into_iter().chain((0..1 + rng.below(3)).map(|_| part(rng))).collect();
    (parts, several(rng, 6, on_cone))
}

/// Ellipsoids, paraboloids and hyperboloids that nearly coincide with each other, with rods or with balls.
pub fn conics(rng: &mut Random) -> (Vec<Solid>, Vec<Target>) {
    let bowl = shape("paraboloid", &[("focal_length", 0.25), ("height", 2.0)]);
    let part = |rng: &mut Random| match rng.below(8) {
        0 => sphere(1.0).scale([1.0 + gap(rng), 1.0, 1.0]),
        1 => sphere(1.0).scale([1.0, rng.pick(&[0.5, 0.01, 3.0]), 1.0 + gap(rng)]),
        2 => bowl.translate([0.0, 0.0, -1.0 + gap(rng)]),
        3 => diagonal(1.0, 1.0, -1.0, rng.pick(&[0.25, -0.25])) & cylinder(2.0, 3.0),
        4 => diagonal(1.0, 1.0, rng.magnitude(-15.0, -3.0), -1.0),
        5 => cylinder(1.0, 2.0).scale([1.0, 0.5 + gap(rng), 1.0]),
        6 => diagonal(1.0, -1.0, 0.0, rng.pick(&[0.0, 0.5])) & sphere(1.0),
        _ => half_space(rng.pick(&Vec3::AXES), rng.pick(&[0.0, 1.0]) + gap(rng)),
    };
    let parts = (0..2 + rng.below(3)).map(|_| part(rng)).collect();
    (parts, vec![on_ball(rng), on_rod(rng), on_rod(rng), on_cone(rng), on_cube(rng)])
}

/// Tori that nearly touch rods, balls, planes and each other; rays in planes that touch them along circles.
pub fn rings(rng: &mut Random) -> (Vec<Solid>, Vec<Target>) {
    let torus = |major: f64, minor: f64| shape("torus", &[("major", major), ("minor", minor)]);
    let part = |rng: &mut Random| match rng.below(8) {
        0 => torus(1.0, 0.25 + gap(rng)),
        1 => torus(1.0 + gap(rng), 0.25),
        2 => cylinder(rng.pick(&[0.75, 1.25]) + gap(rng), rng.pick(&[0.5, 2.0])),
        3 => sphere(rng.pick(&[0.75, 1.25]) + gap(rng)),
        4 => half_space(Vec3::Z, 0.25 + gap(rng)),
        5 => torus(0.75, rng.pick(&[0.5, 1.0])),
        6 => torus(1.0, 0.25).scale([1.0, rng.pick(&[0.5, 1.0 + 1e-9]), 1.0]),
        _ => torus(1.0, 0.25).rotate_x(90.0).translate([1.0, 0.0, 0.0]),
    };
    let parts = [torus(1.0, 0.25)].into_iter().chain((0..1 + rng.below(2)).map(|_| part(rng))).collect();
    let on_ring = |rng: &mut Random| {
        let any = rng.between(0.0, 6.0);
        let turn = rng.pick(&[0.0, any]);
        let out = Vec3::new(libm::cos(turn), libm::sin(turn), 0.0);
        let normal = rng.pick(&[Vec3::Z, out, -out, Vec3::new(0.6 * out.x, 0.6 * out.y, 0.8)]);
        Target::new(out + 0.25 * normal, normal, out.cross(Vec3::Z))
    };
    let targets = vec![on_ring(rng), on_ring(rng), on_ring(rng), on_ring(rng)];
    (parts, targets)
}
