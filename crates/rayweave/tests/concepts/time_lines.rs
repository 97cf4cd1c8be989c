//! Timeline pictures: operations, inverted counts, a ray in a face, regions.

use crate::kit::{model, operands, seen};
use rayweave::draw::{Timeline, ray_timeline};
use rayweave::shapes::box_from_corners;
use rayweave::{Compiled, Ray, Vec3, Weave};

/// A, B, their count along the ray, and the results of the operations.
pub fn operations() -> String {
    let [a, b] = operands();
    let mut picture = Timeline::new();
    picture.title("Two solids along a ray, their count, and the results of the operations");
    picture.operand("A", &a).operand("B", &b);
    picture.result("A | B: count \u{2265} 1", &(&a | &b));
    picture.result("A & B: count = 2", &(&a & &b));
    picture.result("A \u{2212} B", &(&a - &b));
    picture.result("A ^ B: count odd", &(&a ^ &b));
    picture.to_svg()
}

/// The difference as an intersection with the complement.
pub fn inverted() -> String {
    let [a, b] = operands();
    let inverted = !&b;
    let mut picture = Timeline::new();
    picture.title("A \u{2212} B: the same count, of A and the complement of B");
    picture.operand("A", &a).operand("~B", &inverted);
    picture.result("A & ~B: count = 2", &(&a & &inverted));
    assert_eq!(&a & &inverted, &a - &b);
    picture.to_svg()
}

/// Two boxes on both sides of a plane that contains the ray.
pub fn ray_in_a_face() -> String {
    let a = box_from_corners([0.0, -1.0, -1.0], [4.0, 0.0, 1.0]).unwrap();
    let b = box_from_corners([1.0, 0.0, -1.0], [6.0, 1.0, 1.0]).unwrap();
    let along = Ray::new(Vec3::ZERO, Vec3::X);
    let mut picture = Timeline::new();
    picture.title("A ray in the plane y = 0, in which A (below) and B (above) touch");
    picture.operand("A: 0 < x < 4, y < 0", &seen(&a, along));
    picture.operand("B: 1 < x < 6, y > 0", &seen(&b, along));
    let results =
        [("A | B", &a | &b), ("A & B", &a & &b), ("A \u{2212} B", &a - &b), ("B \u{2212} A", &b - &a)];
    for (name, solid) in results {
        picture.result(name, &seen(&solid, along));
    }
    picture.window(-0.5, 6.5).unwrap();
    picture.to_svg()
}

/// A ray through a cemented doublet: surfaces, regions, media.
pub fn partition() -> String {
    let scene = model("doublet");
    let compiled = Compiled::new(&scene).unwrap();
    let ray = Ray::new(Vec3::new(0.0, 9.0, 2.0), Vec3::X);
    let mut picture = ray_timeline(&scene, None, &compiled, ray, Weave::new).unwrap();
    picture.title("A cemented doublet: one crossing from crown to flint, without a gap");
    picture.window(-20.0, 20.0).unwrap();
    picture.to_svg()
}
