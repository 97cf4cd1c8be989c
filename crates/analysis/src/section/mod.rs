//! True cross-sections of models by a plane.
//!
//! The plane is swept by parallel rays, *columns*. Each tells exactly where it passes from one region into another. Two
//! neighbouring columns that meet the same faces are joined by straight edges if a third one halfway between them agrees
//! within a tolerance; otherwise the gap between them is halved, until it is as narrow as the tolerance. What differs then,
//! ends there: a *wall*, an edge along the columns. So points of an edge lie on the surfaces to rounding, edges between them
//! keep to within the tolerance, and walls stand within half a tolerance of where they belong.
//!
//! What no column meets is not seen. Columns stand at even distances, and besides at both ends and in the middle of the
//! box of every leaf, so that a part is overlooked only if it is thinner than the distance and far from where its
//! leaves begin or end.

mod columns;
mod link;
mod simplify;

use columns::{Columns, Step};
use rayweave_math::{Bounds, Vec3};
use rayweave_model::drive::Cancel;
use rayweave_model::{Evaluator, RegionId};
use std::num::NonZeroUsize;

/// A plane with coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cut {
    origin: Vec3,
    across: Vec3,
    up: Vec3,
}

/// Why there is no section.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SectionError {
    /// The axes span no plane.
    #[error("the axes {across} and {up} span no plane (they have to be finite, and not parallel)")]
    Axes {
        /// The first axis.
        across: Vec3,
        /// The second axis.
        up: Vec3,
    },
    /// The window has no area.
    #[error("the window from {lo:?} to {hi:?} has no area (its ends have to be finite, the lower one first)")]
    Window {
        /// The lower left corner.
        lo: [f64; 2],
        /// The upper right corner.
        hi: [f64; 2],
    },
    /// The tolerance is none.
    #[error("the tolerance is {tolerance} (it has to be greater than 0 and finite)")]
    Tolerance {
        /// It.
        tolerance: f64,
    },
    /// Somebody asked the run to stop.
    #[error("cancelled")]
    Cancelled,
}

impl Cut {
    /// The plane through a point with two axes: the first is made a unit vector, the second one a unit vector at right
    /// angles to it.
    ///
    /// # Errors
    /// [`SectionError::Axes`].
    pub fn new(origin: Vec3, across: Vec3, up: Vec3) -> Result<Cut, SectionError> {
        let first = across.normalize_or_zero();
        let second = (up - first * first.dot(up)).normalize_or_zero();
        let is_plane = origin.is_finite() && first != Vec3::ZERO && second != Vec3::ZERO;
        match is_plane && first.is_finite() && second.is_finite() {
            true => Ok(Cut { origin, across: first, up: second }),
            false => Err(SectionError::Axes { across, up }),
        }
    }

    /// The point of space with these coordinates.
    pub fn point(&self, [u, v]: [f64; 2]) -> Vec3 {
        self.origin + self.across * u + self.up * v
    }

    /// The coordinates of the foot of the perpendicular from a point.
    pub fn place(&self, point: Vec3) -> [f64; 2] {
        [self.across, self.up].map(|axis| axis.dot(point - self.origin))
    }

    /// The unit normal: the cross product of the axes.
    pub fn normal(&self) -> Vec3 {
        self.across.cross(self.up)
    }

    /// The range of a coordinate (0 or 1), or of the height above the plane (2), over a box; infinite where the box is, and empty, from infinity to its negative,
    /// for an empty box.
    pub fn range(&self, bounds: &Bounds, coordinate: usize) -> [f64; 2] {
        if bounds.is_empty() {
            return [f64::INFINITY, f64::NEG_INFINITY];
        }
        let axis = [self.across, self.up, self.normal()][coordinate];
        let mut range = [-axis.dot(self.origin); 2];
        for k in 0..3 {
            // 0 times infinity is nothing here: the box may be infinite along an axis at right angles to this one
            let ends =
                [bounds.lo[k], bounds.hi[k]].map(|end| if axis[k] == 0.0 { 0.0 } else { end * axis[k] });
            range[0] += ends[0].min(ends[1]);
            range[1] += ends[0].max(ends[1]);
        }
        range
    }
}

/// What part of a plane is looked at, and how closely.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// The lower left corner of the window.
    pub lo: [f64; 2],
    /// The upper right corner of the window.
    pub hi: [f64; 2],
    /// How far edges may be from the truth, in the unit of the model.
    pub tolerance: f64,
    /// How many columns there are at least.
    pub columns: u32,
}

impl Look {
    /// A window, with 512 columns and a tolerance of 1/20,000 of its larger side.
    pub fn new(lo: [f64; 2], hi: [f64; 2]) -> Look {
        let tolerance = 5e-5 * (hi[0] - lo[0]).max(hi[1] - lo[1]);
        Look { lo, hi, tolerance, columns: 512 }
    }

    fn check(&self) -> Result<(), SectionError> {
        let [lo, hi] = [self.lo, self.hi];
        let is_window =
            [lo, hi].as_flattened().iter().all(|x| x.is_finite()) && lo[0] < hi[0] && lo[1] < hi[1];
        match () {
            () if !is_window => Err(SectionError::Window { lo, hi }),
            () if !(self.tolerance > 0.0 && self.tolerance.is_finite()) => {
                Err(SectionError::Tolerance { tolerance: self.tolerance })
            }
            () => Ok(()),
        }
    }
}

/// How a section is run.
#[derive(Clone, Debug, Default)]
pub struct Sweep {
    /// The number of threads; [`thread_count`](rayweave_model::drive::thread_count) if it is not given. Results do not depend
    /// on it.
    pub threads: Option<NonZeroUsize>,
    /// Stops the run.
    pub cancel: Cancel,
}

/// A line between two regions.
#[derive(Clone, Debug, PartialEq)]
pub struct Edge {
    /// Its points in order, at least two.
    pub points: Vec<[f64; 2]>,
    /// The region to the left of who walks along it; 0 is the world.
    pub left: RegionId,
    /// The region to the right.
    pub right: RegionId,
}

/// The section of a model by a plane within a window; all of space outside of the window counts as world.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Section {
    /// All lines between regions, in no particular order.
    pub edges: Vec<Edge>,
}

/// The section of the model of an evaluator.
///
/// ```
/// use rayweave_analysis::section::{Cut, Look, section};
/// use rayweave_math::Vec3;
/// use rayweave_model::{Program, RegionId, Solid};
/// use rayweave_shape::primitive::{Primitive, Sphere};
/// use rayweave_trace::Weave;
/// use std::sync::Arc;
///
/// let ball = Solid::from(Primitive::from(Sphere::new(2.0)?));
/// let weave = Weave::new(Arc::new(Program::compile(&ball)?));
/// let plane = Cut::new(Vec3::new(0.0, 0.0, 1.0), Vec3::X, Vec3::Y)?;
/// let found = section(&weave, &plane, &Look::new([-3.0; 2], [3.0; 2]))?;
/// // a circle of radius sqrt(3)
/// let [circle] = &found.contours(RegionId(1))[..] else { panic!("one contour") };
/// assert!(circle.iter().all(|[x, y]| (x.hypot(*y) - 3f64.sqrt()).abs() < 3e-4));
/// assert!((found.area(RegionId(1)) - 3.0 * std::f64::consts::PI).abs() < 1e-2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`SectionError`] for a window or a tolerance that is none.
pub fn section<E: Evaluator>(evaluator: &E, cut: &Cut, look: &Look) -> Result<Section, SectionError> {
    section_with(evaluator, cut, look, &Sweep::default())
}

/// The same on so many threads, to be cancelled.
///
/// # Errors
/// [`SectionError`], [`SectionError::Cancelled`] among them.
pub fn section_with<E: Evaluator>(
    evaluator: &E,
    cut: &Cut,
    look: &Look,
    sweep: &Sweep,
) -> Result<Section, SectionError> {
    look.check()?;
    let mut section = Section::default();
    let mut columns = Columns::new(evaluator, cut, look, sweep);
    let mut lines = link::Lines::new(look);
    for step in columns.swept()? {
        match step {
            Step::Smooth(column) => lines.go_on(&column, &mut section.edges),
            Step::Jump(column) => lines.jump(&column, &mut section.edges),
        }
    }
    lines.end(&mut section.edges);
    Ok(section)
}

impl Section {
    /// The closed contours of a region: their points in order, the region to the left of who walks along them, so that
    /// outlines go around counter-clockwise and holes clockwise. The last point is not the first one again.
    pub fn contours(&self, region: RegionId) -> Vec<Vec<[f64; 2]>> {
        link::contours(&self.edges, region)
    }

    /// The lines between two regions, the first to the left.
    pub fn between(&self, left: RegionId, right: RegionId) -> Vec<Vec<[f64; 2]>> {
        let of = |edge: &Edge| match () {
            () if (edge.left, edge.right) == (left, right) => Some(edge.points.clone()),
            () if (edge.left, edge.right) == (right, left) => {
                Some(edge.points.iter().rev().copied().collect())
            }
            () => None,
        };
        link::chains(self.edges.iter().filter_map(of).collect())
    }

    /// The area of a region.
    pub fn area(&self, region: RegionId) -> f64 {
        let twice = |[a, b]: [[f64; 2]; 2]| a[0] * b[1] - a[1] * b[0];
        let of = |edge: &Edge| edge.points.windows(2).map(|pair| twice([pair[0], pair[1]])).sum::<f64>();
        let signed = |edge: &Edge| match () {
            () if edge.left == region => of(edge),
            () if edge.right == region => -of(edge),
            () => 0.0,
        };
        0.5 * self.edges.iter().map(signed).sum::<f64>()
    }

    /// The length of all lines around a region.
    pub fn perimeter(&self, region: RegionId) -> f64 {
        let step = |pair: &[[f64; 2]]| libm::hypot(pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]);
        let own = self.edges.iter().filter(|edge| edge.left == region || edge.right == region);
        own.map(|edge| edge.points.windows(2).map(step).sum::<f64>()).sum()
    }

    /// The same with other numbers of regions; lines between two that get the same one are left out.
    pub fn renumbered(&self, number: impl Fn(RegionId) -> RegionId) -> Section {
        let renamed =
            |edge: &Edge| Edge { left: number(edge.left), right: number(edge.right), ..edge.clone() };
        let edges = self.edges.iter().map(renamed).filter(|edge| edge.left != edge.right).collect();
        Section { edges }
    }

    /// The same with fewer points: lines keep their ends, and keep to within a tolerance of what they were.
    pub fn simplified(&self, tolerance: f64) -> Section {
        let fewer = |edge: &Edge| Edge { points: simplify::line(&edge.points, tolerance), ..*edge };
        Section { edges: self.edges.iter().map(fewer).collect() }
    }
}
