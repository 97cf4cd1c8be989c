//! Cross-sections of models by a plane.
//!
//! Parallel rays, *scan lines* (the option `columns` is their minimum number), sweep the plane. The crossings of a
//! scan line are exact. Two neighbouring scan lines with the same faces are joined by straight edges if a third scan
//! line halfway between them agrees within a tolerance; otherwise the gap is halved, until it is as narrow as a few hundred
//! rounding errors. Where scan lines have many crossings, the corners of flat faces, computed from the planes of the faces, divide
//! the gap instead, which takes about a twelfth of the scan lines for a star of 1,000 corners. A remaining difference becomes a *wall*, an edge along the scan
//! lines. The points of an edge, corners included, therefore lie on the surfaces up to rounding error, and edges deviate by at
//! most the tolerance. Straight edges stay straight: the points at their ends are kept when others are left out.
//!
//! If the plane passes through a round edge, such as that between a cylinder and its chamfer, rounding decides which of the two faces
//! a scan line crosses; crossings that lie in the surfaces of each other count as crossings of the same face.
//!
//! Scan lines are evenly spaced, with additional ones at both ends and in the middle of the box of every leaf. A
//! part that lies between scan lines is missed; such a part is thinner than their spacing and contains neither
//! ends nor middles of its leaves.

mod corner_steps;
mod corners;
mod cut;
mod edge;
mod error;
mod link;
mod plane;
mod same_curve;
mod scan_line;
mod scan_lines;
mod scene;
mod simplify;
#[cfg(test)]
mod tests;
mod tracer;
mod window;

pub use cut::Cut;
pub use edge::SectionEdge;
pub use error::SectionError;
pub use plane::{SectionPlane, axis_and_place};
pub use scene::{By, CrossSection, SectionPart, SectionSettings, cross_sections};
pub(crate) use scene::{Cutter, Kinds};
pub use window::{SectionRun, SectionWindow};

use rayweave_model::{Evaluator, RegionId};
use scan_lines::{ScanLines, Step};

/// The section of a model by a plane within a window; space outside the window counts as world.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Section {
    /// All lines between regions, in no particular order.
    pub edges: Vec<SectionEdge>,
}

/// Computes the section of a model.
///
/// ```
/// use rayweave_analysis::section::{Cut, SectionWindow, section};
/// use rayweave_math::Vec3;
/// use rayweave_model::{Program, RegionId, Solid};
/// use rayweave_shape::primitive::{Primitive, Sphere};
/// use rayweave_trace::Weave;
/// use std::sync::Arc;
///
/// let ball = Solid::from(Primitive::from(Sphere::new(2.0)?));
/// let weave = Weave::new(Arc::new(Program::compile(&ball)?));
/// let plane = Cut::new(Vec3::new(0.0, 0.0, 1.0), Vec3::X, Vec3::Y)?;
/// let found = section(&weave, &plane, &SectionWindow::new([-3.0; 2], [3.0; 2]))?;
/// // a circle of radius sqrt(3)
/// let [circle] = &found.contours(RegionId(1))[..] else { panic!("one contour") };
/// assert!(circle.iter().all(|[x, y]| (x.hypot(*y) - 3f64.sqrt()).abs() < 3e-4));
/// assert!((found.area(RegionId(1)) - 3.0 * std::f64::consts::PI).abs() < 1e-2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`SectionError`] for a window without area, a tolerance that is not positive, or a number of columns out of range.
pub fn section<E: Evaluator>(
    evaluator: &E,
    cut: &Cut,
    window: &SectionWindow,
) -> Result<Section, SectionError> {
    section_with(evaluator, cut, window, &SectionRun::default())
}

/// Like [`section`], with a number of threads and a cancellation token.
///
/// # Errors
/// [`SectionError`], including [`SectionError::Cancelled`].
pub fn section_with<E: Evaluator>(
    evaluator: &E,
    cut: &Cut,
    window: &SectionWindow,
    run: &SectionRun,
) -> Result<Section, SectionError> {
    window.check()?;
    let mut section = Section::default();
    let mut scan_lines = ScanLines::new(evaluator, cut, window, run);
    let mut lines = link::Lines::new(window);
    scan_lines.sweep(|step| match step {
        Step::Smooth(column) => lines.go_on(&column, &mut section.edges),
        Step::Jump(column) => lines.jump(&column, &mut section.edges),
        Step::Corner(corner) => lines.corner(&corner, &mut section.edges),
    })?;
    lines.end(&mut section.edges);
    Ok(section)
}

impl Section {
    /// The closed contours of a region, with the region to the left: outlines are counter-clockwise, holes
    /// clockwise. The first point is not repeated at the end.
    pub fn contours(&self, region: RegionId) -> Vec<Vec<[f64; 2]>> {
        link::contours(&self.edges, region)
    }

    /// The lines between two regions, with the first one to the left.
    pub fn between(&self, left: RegionId, right: RegionId) -> Vec<Vec<[f64; 2]>> {
        let of = |edge: &SectionEdge| match () {
            () if (edge.left, edge.right) == (left, right) => Some(edge.points.clone()),
            () if (edge.left, edge.right) == (right, left) => {
                Some(edge.points.iter().rev().copied().collect())
            }
            () => None,
        };
        link::chains(self.edges.iter().filter_map(of).collect())
    }

    /// The area of a region in the plane.
    pub fn area(&self, region: RegionId) -> f64 {
        let twice = |[a, b]: [[f64; 2]; 2]| a[0] * b[1] - a[1] * b[0];
        let of =
            |edge: &SectionEdge| edge.points.windows(2).map(|pair| twice([pair[0], pair[1]])).sum::<f64>();
        let signed = |edge: &SectionEdge| match () {
            () if edge.left == region => of(edge),
            () if edge.right == region => -of(edge),
            () => 0.0,
        };
        0.5 * self.edges.iter().map(signed).sum::<f64>()
    }

    /// The total length of the lines around a region.
    pub fn perimeter(&self, region: RegionId) -> f64 {
        let step = |pair: &[[f64; 2]]| libm::hypot(pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]);
        let own = self.edges.iter().filter(|edge| edge.left == region || edge.right == region);
        own.map(|edge| edge.points.windows(2).map(step).sum::<f64>()).sum()
    }

    /// The section with other region numbers; lines between equal regions are removed.
    pub fn renumbered(&self, number: impl Fn(RegionId) -> RegionId) -> Section {
        let renamed = |edge: &SectionEdge| SectionEdge {
            left: number(edge.left),
            right: number(edge.right),
            ..edge.clone()
        };
        let edges = self.edges.iter().map(renamed).filter(|edge| edge.left != edge.right).collect();
        Section { edges }
    }

    /// The section with fewer points: lines keep their ends, and deviate by at most `tolerance`.
    pub fn simplified(&self, tolerance: f64) -> Section {
        let fewer =
            |edge: &SectionEdge| SectionEdge { points: simplify::line(&edge.points, tolerance), ..*edge };
        Section { edges: self.edges.iter().map(fewer).collect() }
    }
}
