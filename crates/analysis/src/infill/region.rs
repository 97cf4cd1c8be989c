//! Regions that can be filled, and their intersections with scan lines.

use super::Raster;
use crate::features::extent;
use rayweave_math::{Bounds, Vec3};
use rayweave_model::{Evaluator, Query, RayAnswer, RayBatch, RegionId};
use rayweave_polygon::Polygons;
use rayweave_rootray::Side;
use rayweave_shape::Ray;
use std::ops::Range;

/// A piece of a scan line: the number of the line and the interval of times, as lengths from the point of the
/// line nearest to the origin.
pub type Piece = (i64, [f64; 2]);

/// A solid or a region of the plane whose layers can be filled.
pub trait Fillable: Sync {
    /// The scratch memory of a thread.
    type Scratch: Send;

    /// The name in messages.
    fn name(&self) -> String;

    /// A bounding box, which may be too large.
    fn bounds(&self) -> Bounds;

    /// The box that the region reaches on each side, if it can be found. It may miss a thin part at the outside.
    fn extent(&self) -> Bounds {
        self.bounds()
    }

    /// Allocates scratch memory for one thread.
    fn scratch(&self) -> Self::Scratch;

    /// The pieces of scan lines inside at height z, sorted by line, then time. Both ends are finite.
    fn pieces(&self, raster: &Raster, z: f64, lines: Range<i64>, scratch: &mut Self::Scratch) -> Vec<Piece>;
}

/// The layers of a model: the union of all its regions.
#[derive(Clone, Copy, Debug)]
pub struct Slices<'a, E>(pub &'a E);

impl<E: Evaluator> Fillable for Slices<'_, E> {
    type Scratch = (E::Scratch, RayBatch);

    fn name(&self) -> String {
        let names: Vec<&str> = self.0.program().regions().iter().map(|region| region.name.as_str()).collect();
        match names.len() {
            0 => "the model".to_owned(),
            1..=4 => names.join(", "),
            n => format!("{}, ... and {} more", names[..3].join(", "), n - 3),
        }
    }

    fn bounds(&self) -> Bounds {
        self.0.program().bounds()
    }

    fn extent(&self) -> Bounds {
        extent(self.0).map_or(self.bounds(), |extent| extent.bounds)
    }

    fn scratch(&self) -> Self::Scratch {
        (self.0.scratch(), RayBatch::default())
    }

    fn pieces(
        &self,
        raster: &Raster,
        z: f64,
        lines: Range<i64>,
        (scratch, batch): &mut Self::Scratch,
    ) -> Vec<Piece> {
        batch.clear();
        let [dx, dy] = raster.direction();
        for k in lines.clone() {
            let [x, y] = raster.origin(k);
            batch.push(Ray::new(Vec3::new(x, y, z), Vec3::new(dx, dy, 0.0)));
        }
        let mut pieces = Vec::new();
        let mut take = |answer: RayAnswer<'_>| {
            let ends = answer.crossings.iter().map(|crossing| (crossing.t, crossing.after != RegionId(0)));
            gather(lines.start + answer.ray as i64, answer.start != RegionId(0), ends, &mut pieces);
        };
        self.0.crossings(batch.rays(), &Query::default(), scratch, &mut take);
        pieces
    }
}

impl Fillable for Polygons {
    type Scratch = ();

    fn name(&self) -> String {
        "the region".to_owned()
    }

    /// The unbounded prism over the region.
    fn bounds(&self) -> Bounds {
        if self.outside() == Side::Inside {
            return Bounds::ALL;
        }
        let [lo, hi] = self.corner_bounds();
        Bounds::new(Vec3::new(lo[0], lo[1], f64::NEG_INFINITY), Vec3::new(hi[0], hi[1], f64::INFINITY))
    }

    fn scratch(&self) {}

    fn pieces(&self, raster: &Raster, _z: f64, lines: Range<i64>, (): &mut ()) -> Vec<Piece> {
        let origins: Vec<[f64; 2]> = lines.clone().map(|k| raster.origin(k)).collect();
        let mut pieces = Vec::new();
        // the direction is a unit vector and the origins are within bounds, so the scan succeeds
        if let Ok(scan) = self.scan(raster.direction(), &origins) {
            for (k, line) in lines.enumerate() {
                let mut is_inside = scan.start().is_inside();
                let ends = scan.roots(k).iter().map(|root| {
                    is_inside = !is_inside;
                    (root.t, is_inside)
                });
                gather(line, false, ends, &mut pieces);
            }
        }
        pieces
    }
}

/// Appends the pieces of a line that are inside, given its crossing times and the side after each.
fn gather(line: i64, starts_inside: bool, ends: impl Iterator<Item = (f64, bool)>, pieces: &mut Vec<Piece>) {
    let mut since = starts_inside.then_some(f64::NEG_INFINITY);
    for (t, is_inside) in ends {
        match (since, is_inside) {
            (None, true) => since = Some(t),
            (Some(from), false) => {
                // a bounded region does not start inside: a piece without a start cannot occur
                pieces.extend(from.is_finite().then_some((line, [from, t])));
                since = None;
            }
            _ => {}
        }
    }
}
