//! Queries on a component for tests: chords, hits, volumes, and paths with perfect internal
//! reflection.

use rayweave_math::Vec3;
use rayweave_model::{Crossing, Evaluator, Program, Query, Region, Solid, Window, attributes};
use rayweave_shape::Ray;
use rayweave_trace::Weave;
use std::sync::Arc;

/// A compiled component.
pub struct Probe {
    pub program: Arc<Program>,
    weave: Weave,
}

/// A hit of a ray with a face.
#[derive(Debug)]
pub struct Hit {
    pub t: f64,
    pub point: Vec3,
    pub normal: Vec3,
    pub face: String,
}

impl Probe {
    pub fn new(solid: &Solid) -> Probe {
        Probe::of(Program::compile(solid).unwrap())
    }

    /// A component of several solids, each of a medium of its own, numbered from 1.
    pub fn regions(solids: &[Solid]) -> Probe {
        let region = |(k, solid): (usize, &Solid)| Region {
            name: k.to_string(),
            solid: solid.clone(),
            medium: k as u32 + 1,
        };
        let regions: Vec<Region> = solids.iter().enumerate().map(region).collect();
        Probe::of(Program::compile_regions(&regions).unwrap())
    }

    fn of(program: Program) -> Probe {
        let program = Arc::new(program);
        Probe { weave: Weave::new(program.clone()), program }
    }

    pub fn contains(&self, point: Vec3) -> bool {
        self.weave.contains(point).unwrap()
    }

    pub fn crossings(&self, origin: Vec3, direction: Vec3) -> Vec<Crossing> {
        let answer = self.weave.one(Ray::new(origin, direction), &Query::default()).unwrap();
        answer.of(0).to_vec()
    }

    pub fn hits(&self, origin: Vec3, direction: Vec3) -> Vec<Hit> {
        let ray = Ray::new(origin, direction);
        self.crossings(origin, direction).iter().map(|crossing| self.hit(&ray, crossing)).collect()
    }

    /// The first hit after t.
    pub fn next(&self, origin: Vec3, direction: Vec3, t_min: f64) -> Option<Hit> {
        let query = Query { window: Window::new(t_min, f64::INFINITY).unwrap(), ..Query::nearest() };
        let ray = Ray::new(origin, direction);
        let answer = self.weave.one(ray, &query).unwrap();
        answer.of(0).first().map(|crossing| self.hit(&ray, crossing))
    }

    fn hit(&self, ray: &Ray, crossing: &Crossing) -> Hit {
        let number = self.program.face_number(crossing.face.leaf, crossing.face.facet);
        Hit {
            t: crossing.t,
            point: attributes::point(ray, crossing),
            normal: attributes::normal(&self.program, ray, crossing),
            face: self.program.face_name(number),
        }
    }

    /// The length inside along z at (x, y).
    pub fn chord(&self, x: f64, y: f64) -> f64 {
        let hits = self.crossings(Vec3::new(x, y, 0.0), Vec3::Z);
        hits.iter().map(|hit| if hit.enters() { -hit.t } else { hit.t }).sum()
    }

    /// The volume of a solid of revolution out to a radius: the integral of 2 pi r chord(r).
    pub fn volume_of_revolution(&self, radius: f64) -> f64 {
        gauss_legendre(0.0, radius, |r| {
            // any azimuth will do
            let (sin, cos) = (r * 1.3).sin_cos();
            2.0 * std::f64::consts::PI * r * self.chord(r * cos, r * sin)
        })
    }

    /// The faces that light hits if every face but the last reflects it, with the whole path and
    /// the last direction.
    pub fn reflect(&self, origin: Vec3, direction: Vec3, times: usize) -> Path {
        let mut path = Path { faces: Vec::new(), length: 0.0, point: origin, direction };
        for k in 0..=times {
            let Some(hit) = self.next(path.point, path.direction, 1e-9) else { break };
            path.length += hit.t;
            path.point = hit.point;
            path.faces.push(hit.face);
            if k < times {
                path.direction = reflected(path.direction, hit.normal);
            }
        }
        path
    }
}

/// The path of a ray inside a component.
#[derive(Debug)]
pub struct Path {
    pub faces: Vec<String>,
    pub length: f64,
    pub point: Vec3,
    pub direction: Vec3,
}

pub fn reflected(direction: Vec3, normal: Vec3) -> Vec3 {
    direction - 2.0 * direction.dot(normal) * normal
}

/// The integral of a smooth function: 40 panels of 5 Gauss points.
pub fn gauss_legendre(from: f64, to: f64, f: impl Fn(f64) -> f64) -> f64 {
    let nodes = [0.0, 0.538_469_310_105_683_1, 0.906_179_845_938_664];
    let weights = [0.568_888_888_888_888_9, 0.478_628_670_499_366_47, 0.236_926_885_056_189_08];
    let half = 0.5 * (to - from) / 40.0;
    let panel = |k: usize| {
        let middle = from + (2 * k + 1) as f64 * half;
        let pair = |i: usize| weights[i] * (f(middle - half * nodes[i]) + f(middle + half * nodes[i]));
        half * (weights[0] * f(middle) + pair(1) + pair(2))
    };
    (0..40).map(panel).sum()
}

/// Numbers in [0, 1) that fill space evenly (Weyl's sequence with the square roots of primes).
pub fn numbers(k: usize) -> [f64; 4] {
    [2f64, 3.0, 5.0, 7.0].map(|prime| ((k + 1) as f64 * prime.sqrt()).fract())
}

#[track_caller]
pub fn assert_close(found: f64, exact: f64, tolerance: f64) {
    assert!((found - exact).abs() <= tolerance, "found {found}, not {exact}: off by {:e}", found - exact);
}
