//! Interim.
#![allow(missing_docs)]
use rayweave_math::Bounds;
use rayweave_shape::Ray;
use rayweave_shape::surface::{Surface, SurfaceCrossings};
pub trait SurfaceExt {
    fn inside_bounds(&self) -> Bounds;
    fn is_finite(&self) -> bool;
    fn crossings_from(&self, ray: &Ray, inside: bool) -> SurfaceCrossings;
}
impl SurfaceExt for Surface {
    fn inside_bounds(&self) -> Bounds {
        Bounds::ALL
    }
    fn is_finite(&self) -> bool {
        true
    }
    fn crossings_from(&self, ray: &Ray, _: bool) -> SurfaceCrossings {
        self.crossings(ray)
    }
}
pub struct Shared {
    pub representative: Vec<u32>,
    pub flipped: Vec<bool>,
}
pub struct Wide {
    pub first: usize,
    pub second: usize,
}
pub fn share(s: &[(Surface, f64)]) -> Result<Shared, Wide> {
    let mut representative: Vec<u32> = Vec::new();
    for (k, (x, _)) in s.iter().enumerate() {
        representative.push(s[..k].iter().position(|(y, _)| y == x).unwrap_or(k) as u32);
    }
    Ok(Shared {
        flipped: vec![false; s.len()],
        representative,
    })
}
