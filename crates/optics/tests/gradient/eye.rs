//! A lens with a gradient among others: the schematic eye of H.-L. Liou and N. A. Brennan, J. Opt. Soc. Am. A 14 (1997) 1684.

use crate::common::{near, trace};
use rayweave_math::{Affine, Vec3};
use rayweave_optics::component::{Aperture, conic_lens};
use rayweave_optics::gradient::Gradient;
use rayweave_optics::{Assembly, Beam, Element, Event, Light, Medium, Segment, System, TraceSettings};

/// The length of the eye; light is evaluated at this distance.
const LENGTH: f64 = 23.95;

fn constant(n: f64) -> Medium {
    Medium::constant(&format!("n = {n}"), n, 0.0).unwrap()
}

/// The index as a function of r^2 and of the height over a vertex.
fn graded(vertex: f64, radial: &[f64], axial: &[f64]) -> Medium {
    let gradient = Gradient::polynomial(radial, axial).unwrap();
    constant(1.0).graded(gradient.placed(&Affine::translate(Vec3::Z * vertex)).unwrap())
}

/// The eye of the paper, in millimetres, at 555 nm: vertex, radius and conic constant of each
/// surface, and the medium behind it.
fn eye() -> System {
    let surfaces = [
        (0.0, 7.77, -0.18),
        (0.5, 6.40, -0.60),
        (3.66, 12.40, -0.94),
        (5.25, f64::INFINITY, 0.0),
        (7.68, -8.10, 0.96),
        (LENGTH, f64::INFINITY, 0.0),
    ];
    let media = [
        ("cornea", constant(1.376)),
        ("aqueous", constant(1.336)),
        ("lens front", graded(3.66, &[1.368, -0.001978], &[0.049057, -0.015427])),
        ("lens back", graded(5.25, &[1.407, -0.001978], &[0.0, -0.006605])),
        ("vitreous", constant(1.336)),
    ];
    let mut parts = Assembly::new();
    for (pair, (name, medium)) in surfaces.windows(2).zip(&media) {
        let [(z1, r1, k1), (z2, r2, k2)] = [pair[0], pair[1]];
        let solid = conic_lens(r1, k1, r2, k2, z2 - z1, Aperture::circle(8.0)).unwrap();
        let placed = solid.translate(Vec3::Z * (0.5 * (z1 + z2)));
        parts = parts.add(Element::transparent(name, placed, medium));
    }
    parts.compile().unwrap()
}

/// The row that ends at the retina.
fn at_retina(system: &System, origin: [f64; 3], direction: [f64; 3]) -> Segment {
    let light = Light::new(origin, direction, 555.0);
    let found = trace(system, &Beam::from_iter([light]), &TraceSettings::default());
    let row = found.segments.iter().find(|row| row.event == Event::Transmitted && row.end.z > LENGTH - 1e-9);
    row.unwrap()
}

/// Published: a power of 60.35 dioptres, and a length of 23.95, where light from far away is in focus.
#[test]
fn the_eye_of_liou_and_brennan_has_its_published_power() {
    let h = 1e-3;
    let row = at_retina(&eye(), [0.0, h, -1.0], [0.0, 0.0, 1.0]);
    let slope = row.direction.y / row.direction.z;
    let power = -slope / h * 1.336 * 1e3;
    near(power, 60.35, 0.01);
    near(LENGTH - row.end.y / slope, LENGTH, 1e-3);
}

/// The same rays by an independent integrator: DOP853 of SciPy 1.17.1 with a tolerance of 1e-13,
/// steps of at most 0.05 and Snell's law at the surfaces: x, y, direction and optical path at the
/// retina.
#[test]
fn an_independent_integrator_agrees() {
    let rays = [
        ([0.0, 1.0, -1.0], [0.0, 0.0, 1.0]),
        ([0.0, 2.0, -1.0], [0.0, 0.0, 1.0]),
        ([0.5, -0.8, -1.0], [0.05, 0.08, 1.0]),
    ];
    let expected = [
        [0.0, -0.0011054550920965855, 0.0, -0.0452297706728349, 33.25040852474691],
        [0.0, -0.008751005656085553, 0.0, -0.09083838541844988, 33.251152232840084],
        [
            0.8241650582882575,
            1.3263058878357907,
            0.008839253972815464,
            0.0865592297364223,
            33.351586499627004,
        ],
    ];
    let system = eye();
    for ((origin, direction), [x, y, u, v, path]) in rays.into_iter().zip(expected) {
        let row = at_retina(&system, origin, direction);
        near(row.end.x, x, 1e-11);
        near(row.end.y, y, 1e-11);
        near(row.direction.x, u, 1e-12);
        near(row.direction.y, v, 1e-12);
        near(row.path, path, 1e-11);
    }
}
