//! Tessellation of sag surfaces (aspheres) on a polar grid.

use super::implicit::too_coarse;
use super::polytope;
use super::revolved::{circle_count, stacked};
use crate::kernel::Body;
use rayweave_math::{Bounds, Vec3, sin_cos_degrees};
use rayweave_model::MAX_POINTS;
use rayweave_shape::primitive::Lowered;
use rayweave_shape::surface::Surface;

/// Grid over the surface z = sag(x, y) within an aperture.
struct Grid<'a> {
    surface: &'a Surface,
    aperture: f64,
    rings: usize,
    around: usize,
}

pub(super) fn body(
    surface: &Surface,
    lowered: &Lowered,
    clip: &Bounds,
    tolerance: f64,
) -> Result<Option<Body>, String> {
    let (aperture, top) = (lowered.bounds.hi.x, lowered.bounds.hi.z);
    let around = circle_count(aperture, 0.5 * tolerance)?;
    let mut grid = Grid { surface, aperture, rings: 4, around };
    while grid.worst() > 0.5 * tolerance {
        grid = Grid { rings: 2 * grid.rings, around: (3 * grid.around).div_ceil(8) * 4, ..grid };
        if grid.rings * grid.around > MAX_POINTS {
            return Err(too_coarse(tolerance));
        }
    }
    let rings: Vec<Vec<Vec3>> = (0..=grid.rings).map(|ring| grid.ring(ring)).collect();
    let highest = rings.iter().flatten().map(|p| p.z).fold(f64::NEG_INFINITY, f64::max);
    let end = match top.is_finite() {
        true => highest.max(top) + aperture,
        false => clip.hi.z.max(highest + aperture),
    };
    let rim: Vec<Vec3> = rings[grid.rings].iter().map(|p| Vec3::new(p.x, p.y, end)).collect();
    let Some(tall) = stacked(rings.into_iter().chain([rim, vec![Vec3::Z * end]]).collect(), false)? else {
        return Ok(None);
    };
    if !top.is_finite() {
        return Ok(Some(tall));
    }
    let low = lowered.bounds.lo.z.min(top);
    let clip =
        Bounds::new(Vec3::new(-aperture, -aperture, low), Vec3::new(aperture, aperture, end)).grown(aperture);
    below(&tall, Vec3::Z, top, &clip)
}

/// The part of a body below a plane.
fn below(body: &Body, normal: Vec3, offset: f64, clip: &Bounds) -> Result<Option<Body>, String> {
    match polytope::body(&[(normal, offset)], false, clip)? {
        Some(half) => body.intersection(&half),
        None => Ok(None),
    }
}

impl Grid<'_> {
    fn sag(&self, x: f64, y: f64) -> f64 {
        -self.surface.value_and_gradient(Vec3::new(x, y, 0.0)).0
    }

    /// The point at fractional ring and step indices.
    fn point(&self, ring: f64, step: f64) -> Vec3 {
        let (sin, cos) = sin_cos_degrees(360.0 * step / self.around as f64);
        let r = self.aperture * ring / self.rings as f64;
        let (x, y) = (r * cos, r * sin);
        Vec3::new(x, y, self.sag(x, y))
    }

    fn ring(&self, ring: usize) -> Vec<Vec3> {
        let count = if ring == 0 { 1 } else { self.around };
        (0..count).map(|step| self.point(ring as f64, step as f64)).collect()
    }

    /// Largest height of the surface above the midpoints of the edges and diagonals of the grid.
    fn worst(&self) -> f64 {
        let mut worst = 0.0f64;
        for ring in 0..self.rings {
            for step in 0..self.around {
                let (r, s) = (ring as f64, step as f64);
                for (dr, ds) in [(1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
                    let ends = 0.5 * (self.point(r, s).z + self.point(r + dr, s + ds).z);
                    // the midpoint of the chord, not of the arc
                    let chord = 0.5 * (self.point(r, s) + self.point(r + dr, s + ds));
                    worst = worst.max((self.sag(chord.x, chord.y) - ends).abs());
                }
            }
        }
        worst
    }
}
