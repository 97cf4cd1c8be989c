//! Solids of the plane over polygons, against the line crossings of the polygons.

#[path = "../../polygon/tests/support/mod.rs"]
mod support;

use rand::{SeedableRng, rngs::ChaCha8Rng};
use rayweave_space::{Solid, Tracer};
use support::{lines, region, regions};

#[test]
fn solids_of_the_plane_agree_with_lines() {
    let mut rng = ChaCha8Rng::seed_from_u64(16);
    let mut crossings = 0;
    for (contours, outside) in regions(&mut rng) {
        let region = region(&contours, outside).unwrap();
        let mut tracer = Tracer::new(&Solid::over_polygons(&region).unwrap()).unwrap();
        for (p, q) in lines(&mut rng, &contours) {
            let (p, q) = (p.map(|x| x as f64), q.map(|x| x as f64));
            let traced = region.trace(p, [q[0] - p[0], q[1] - p[1]]).unwrap();
            let solid = tracer.trace(p, q).unwrap();
            let near = |(a, b): (f64, f64)| (a - b).abs() <= 1e-10 * (1.0 + b.abs());
            let agree = traced.start() == solid.start()
                && traced.roots().len() == solid.roots().len()
                && traced.times().zip(solid.times()).all(near);
            assert!(agree, "{contours:?} {outside} {p:?} {q:?} {traced} {solid}");
            crossings += traced.roots().len();
        }
    }
    assert!(crossings > 5000, "{crossings}");
}
