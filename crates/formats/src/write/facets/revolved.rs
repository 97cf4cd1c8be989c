//! Tessellation of solids of revolution from their profiles.

use crate::kernel::Body;
use rayweave_math::{MAX_AROUND, Vec3, sin_cos_degrees};
use rayweave_model::MAX_POINTS;

/// Profile of a solid of revolution about z: points (r, z) with the solid on the left. It runs from axis to axis or, if all
/// radii are greater than 0, it is closed.
pub(super) struct Profile {
    pub points: Vec<[f64; 2]>,
    /// True if the profile approximates a curve, so that facets are curved in two directions.
    pub is_bent: bool,
}

/// [`rayweave_math::circle_count`], or the reason that there is none.
pub(in crate::write) fn circle_count(radius: f64, tolerance: f64) -> Result<usize, String> {
    let count = rayweave_math::circle_count(radius, tolerance);
    // callers may pass half of the tolerance that was requested
    let least = 2.0 * radius * (1.0 - libm::cos(std::f64::consts::PI / MAX_AROUND as f64));
    count.ok_or_else(|| {
        let least = rayweave_math::round_to_digits(1.05 * least, 2);
        format!(
            "a circle of radius {radius} needs more than {MAX_AROUND} vertices; a tolerance of {least:e} is large enough for it"
        )
    })
}

impl Profile {
    /// Arc about (r, z) between two angles from the r axis, in degrees; end points near the axis are moved onto it.
    pub fn arc(centre: [f64; 2], radius: f64, degrees: [f64; 2], tolerance: f64) -> Result<Profile, String> {
        let around = circle_count(radius, 0.5 * tolerance)?;
        let [start, end] = degrees;
        let count = libm::ceil(around as f64 * (end - start).abs() / 360.0).max(2.0) as usize;
        let point = |k: usize| {
            let (sin, cos) = sin_cos_degrees(start + (end - start) * k as f64 / count as f64);
            [(centre[0] + radius * cos).max(0.0), centre[1] + radius * sin]
        };
        Ok(Profile { points: (0..=count).map(point).collect(), is_bent: true })
    }

    pub fn column(radius: f64, z: [f64; 2]) -> Profile {
        Profile::frustum([radius; 2], z)
    }

    pub fn frustum(radii: [f64; 2], [lo, hi]: [f64; 2]) -> Profile {
        let mut points = vec![[0.0, lo], [radii[0], lo], [radii[1], hi], [0.0, hi]];
        points.dedup();
        Profile { points, is_bent: false }
    }

    pub fn ring([inner, outer]: [f64; 2], [lo, hi]: [f64; 2]) -> Profile {
        if inner <= 0.0 {
            return Profile::column(outer, [lo, hi]);
        }
        Profile { points: vec![[inner, lo], [outer, lo], [outer, hi], [inner, hi]], is_bent: false }
    }

    /// Profile of a torus; for a spindle torus, only the outer surface.
    pub fn torus(major: f64, minor: f64, tolerance: f64) -> Result<Profile, String> {
        if major > minor {
            let mut ring = Profile::arc([major, 0.0], minor, [0.0, 360.0], tolerance)?;
            ring.points.pop();
            return Ok(ring);
        }
        // intersection of the circle and the axis
        let end = libm::acos(-major / minor).to_degrees();
        let mut skin = Profile::arc([major, 0.0], minor, [-end, end], tolerance)?;
        let height = libm::sqrt((minor - major) * (minor + major));
        let last = skin.points.len() - 1;
        skin.points[0] = [0.0, -height];
        skin.points[last] = [0.0, height];
        Ok(skin)
    }

    /// Largest radius.
    pub fn reach(&self) -> f64 {
        self.points.iter().map(|point| point[0]).fold(0.0, f64::max)
    }
}

/// The body of a profile revolved in n steps, then scaled along the axes; `None` if it is flat.
pub(super) fn revolved(profile: &Profile, n: usize, scale: Vec3) -> Result<Option<Body>, String> {
    if profile.points.len().saturating_mul(n) > MAX_POINTS {
        return Err(format!("it needs more than {MAX_POINTS} vertices"));
    }
    let turns: Vec<(f64, f64)> = (0..n).map(|k| sin_cos_degrees(360.0 * k as f64 / n as f64)).collect();
    let ring = |[r, z]: [f64; 2]| match r > 0.0 {
        true => turns.iter().map(|(sin, cos)| scale * Vec3::new(r * cos, r * sin, z)).collect(),
        false => vec![scale * Vec3::new(0.0, 0.0, z)],
    };
    let is_ring = profile.points.iter().all(|point| point[0] > 0.0);
    stacked(profile.points.iter().map(|point| ring(*point)).collect(), is_ring)
}

/// The body between rings of points, each of n points or of one, from the bottom up. Either the last ring is joined to the
/// first, or both are single points. `None` if the body is flat.
pub(super) fn stacked(rings: Vec<Vec<Vec3>>, is_ring: bool) -> Result<Option<Body>, String> {
    let mut triangles: Vec<[u32; 3]> = Vec::new();
    let starts: Vec<u32> = rings
        .iter()
        .scan(0, |next, ring| {
            let start = *next;
            *next += ring.len() as u32;
            Some(start)
        })
        .collect();
    let pairs = rings.len() - usize::from(!is_ring);
    for k in 0..pairs {
        let next = (k + 1) % rings.len();
        between([starts[k], starts[next]], [rings[k].len() as u32, rings[next].len() as u32], &mut triangles);
    }
    Body::from_triangles(rings.into_iter().flatten().collect(), triangles)
}

/// Triangles between two neighbouring rings, counter-clockwise seen from outside.
pub(super) fn between([lower, upper]: [u32; 2], [m, n]: [u32; 2], triangles: &mut Vec<[u32; 3]>) {
    for k in 0..m.max(n) {
        let [a, b] = [lower + k % m, lower + (k + 1) % m];
        let [c, d] = [upper + k % n, upper + (k + 1) % n];
        if m > 1 {
            triangles.push([a, b, d]);
        }
        if n > 1 {
            triangles.push([a, d, c]);
        }
    }
}
