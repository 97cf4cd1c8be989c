use crate::surface::{Plane, Sphere, Surface};
use rayweave_math::Vec3;
pub trait Bridge {
    fn plane(normal: Vec3, offset: f64) -> Surface {
        Surface::Plane(Plane::new(normal, offset))
    }
    fn sphere(centre: Vec3, radius: f64) -> Surface {
        Surface::Sphere(Sphere { centre, radius })
    }
}
impl Bridge for Surface {}
