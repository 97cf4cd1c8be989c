//! Outlines of straight edges and circular arcs: rounded corners, prisms with exact round faces and treated edges, solids of
//! revolution.
//!
//! An outline is a set of closed contours that neither cross nor touch each other or themselves, in any orientation. Points within
//! an odd number of contours are inside.
//!
//! Each arc is divided into pieces of at most a quarter turn. The chords of the pieces form polygons, which
//! [`Polygons::fold`](crate::Polygons::fold) turns into formulas of half-planes; the circular segments between pieces and chords are added to it, or
//! removed. This is the region within the arcs if no triangle between the ends of a piece and its apex, where the tangents at the
//! ends meet, touches another triangle or edge. It is verified with exact predicates: the four contours through all chords, all
//! apexes, and the apexes on one side only are simple. Arcs are divided further until they are.

mod contour;
mod corner;
mod error;
mod facets;
mod rim;
mod solid;

pub use corner::{Corner, Vertex};
pub use error::OutlineError;
pub use rim::Rim;
pub use solid::near_cylinder;

use crate::{Point, Polygons, from_polygons};
use contour::{Edge, is_within, turning};
use rayweave_rootray::Side;

/// The number of divisions of arcs that are tried: pieces of 90 degrees, 45 degrees and so on.
const DIVISIONS: u32 = 8;

/// A region of the plane bounded by straight edges and circular arcs.
///
/// ```
/// use rayweave_polygon::{Corner, Outline, Vertex};
///
/// let corners = [[0.0, 0.0], [6.0, 0.0], [6.0, 4.0], [0.0, 4.0]];
/// let plate = corners.map(|at| Vertex { at, bulge: 0.0, corner: Corner::Fillet(1.0) });
/// let outline = Outline::new(&[plate.to_vec(), Vertex::circle([2.0, 2.0], 0.5).to_vec()])?;
/// let pi = std::f64::consts::PI;
/// assert!((outline.area() - (24.0 - (4.0 - pi) - 0.25 * pi)).abs() < 1e-14 * 24.0);
/// let plate = outline.extrude(0.0, 2.0, [Default::default(); 2])?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Outline {
    contours: Vec<Contour>,
    /// The smallest and largest coordinates of a box around the region.
    bounds: [Point; 2],
}

/// A contour, counter-clockwise.
#[derive(Clone, Debug)]
struct Contour {
    edges: Vec<Edge>,
    /// Centre and radius, if the contour is a circle.
    circle: Option<(Point, f64)>,
    /// The contour around it.
    parent: Option<usize>,
    /// True if the region is on the inner side.
    is_island: bool,
}

/// The apexes that a contour goes through.
#[derive(Clone, Copy)]
struct Apexes {
    convex: bool,
    concave: bool,
}

impl Outline {
    /// The region within an odd number of the contours; empty without contours.
    ///
    /// # Errors
    ///
    /// [`OutlineError`]: fewer than three corners, a corner that has no room for its fillet or chamfer, or contours that cross or
    /// touch.
    pub fn new(contours: &[Vec<Vertex>]) -> Result<Outline, OutlineError> {
        let mut all = Vec::new();
        for (number, vertices) in contours.iter().enumerate() {
            let mut pieces = corner::pieces(number, vertices)?;
            if turning(&pieces) < 0.0 {
                pieces = contour::reversed(pieces);
            }
            all.push((circle(vertices), pieces));
        }
        let rough: Vec<Vec<Point>> = all
            .iter()
            .map(|(_, pieces)| Edge::divide(pieces, 3).iter().map(|edge| edge.from).collect())
            .collect();
        // most contours are ruled out by their boxes
        let boxes: Vec<[Point; 2]> = rough.iter().map(|points| bounds_of(points)).collect();
        let is_in_box =
            |[x, y]: Point, [lo, hi]: [Point; 2]| lo[0] <= x && x <= hi[0] && lo[1] <= y && y <= hi[1];
        let is_island: Vec<bool> = (0..all.len())
            .map(|own| {
                let point = rough[own][0];
                let around = (0..all.len()).filter(|other| *other != own && is_in_box(point, boxes[*other]));
                around.filter(|other| is_within(point, &rough[*other])).count() % 2 == 0
            })
            .collect();
        let mut problem = None;
        for division in 0..DIVISIONS {
            let edges: Vec<Vec<Edge>> =
                all.iter().map(|(_, pieces)| Edge::divide(pieces, division)).collect();
            match simple(&edges, &is_island) {
                Ok((polygons, bounds)) => {
                    let parents = polygons.contours().map(|contour| contour.parent);
                    let contours = edges.into_iter().zip(parents).zip(&all).zip(&is_island);
                    let contours = contours.map(|(((edges, parent), (circle, _)), is_island)| Contour {
                        edges,
                        circle: *circle,
                        parent,
                        is_island: *is_island,
                    });
                    return Ok(Outline { contours: contours.collect(), bounds });
                }
                Err(error) => problem = Some(error),
            }
            if all.iter().flat_map(|(_, pieces)| pieces).all(|piece| piece.arc.is_none()) {
                break;
            }
        }
        match problem {
            Some(error) => Err(error),
            None => Ok(Outline { contours: Vec::new(), bounds: [[0.0; 2]; 2] }),
        }
    }

    /// The area of the region.
    pub fn area(&self) -> f64 {
        let areas = self.contours.iter().map(|contour| {
            let inner = match contour.circle {
                Some((_, radius)) => std::f64::consts::PI * radius * radius,
                None => contour::area(&contour.edges),
            };
            if contour.is_island { inner } else { -inner }
        });
        areas.sum()
    }

    /// The smallest and largest coordinates of a box around the region, not always the smallest box.
    pub fn bounds(&self) -> [Point; 2] {
        self.bounds
    }
}

/// True for the names that [`Outline::extrude`] and [`Outline::revolve`] give to parts of their solids, such as `contour0.edge3` and
/// `top.contour0.arc1`.
pub fn is_outline_part(name: &str) -> bool {
    let part = ["top.", "bottom."].iter().find_map(|rim| name.strip_prefix(rim)).unwrap_or(name);
    let rest = part.strip_prefix("contour");
    rest.is_some_and(|rest| rest.starts_with(|next: char| next.is_ascii_digit() || next == '.'))
}

/// True for the names of the leaves that divide the solid of an outline with many edges into cells: their boxes are no faces of it.
pub fn is_outline_cell(name: &str) -> bool {
    name.split('.').zip(name.split('.').skip(1)).any(|pair| pair == ("contour", "cell"))
}

/// The smallest and largest coordinates of points.
fn bounds_of(points: &[Point]) -> [Point; 2] {
    let none = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
    points.iter().fold(none, |[lo, hi], point| {
        [[lo[0].min(point[0]), lo[1].min(point[1])], [hi[0].max(point[0]), hi[1].max(point[1])]]
    })
}

/// The circle that two half circles form.
fn circle(vertices: &[Vertex]) -> Option<(Point, f64)> {
    let [a, b] = vertices else { return None };
    if a.bulge != b.bulge || a.bulge.abs() != 1.0 {
        return None;
    }
    let centre = [0, 1].map(|k| 0.5 * (a.at[k] + b.at[k]));
    Some((centre, 0.5 * libm::hypot(b.at[0] - a.at[0], b.at[1] - a.at[1])))
}

/// The polygons of all chords, and a box around the outline, if the triangles of the arcs touch nothing else.
fn simple(contours: &[Vec<Edge>], is_island: &[bool]) -> Result<(Polygons, [Point; 2]), OutlineError> {
    let polygons = |apexes: Apexes| {
        let mut origins = Vec::new();
        let points: Vec<Vec<Point>> = contours
            .iter()
            .zip(is_island)
            .map(|(edges, is_island)| {
                let (mut points, mut own) = (Vec::new(), Vec::new());
                for edge in edges {
                    points.push(edge.from);
                    own.push(edge.origin);
                    if edge.is_convex().is_some_and(|yes| if yes { apexes.convex } else { apexes.concave }) {
                        points.push(edge.apex());
                        own.push(edge.origin);
                    }
                }
                if !is_island {
                    points.reverse();
                    own.reverse();
                }
                origins.push(own);
                points
            })
            .collect();
        from_polygons(&points, Side::Outside).map_err(|error| OutlineError::of_polygons(error, &origins))
    };
    let chords = polygons(Apexes { convex: false, concave: false })?;
    if chords.contours().len() < contours.len() {
        let missing = (0..contours.len()).find(|k| chords.contours().all(|contour| contour.number != *k));
        return Err(OutlineError::NoArea { contour: missing.unwrap_or(0) });
    }
    if contours.iter().flatten().all(|edge| edge.arc.is_none()) {
        let bounds = chords.corner_bounds();
        return Ok((chords, bounds));
    }
    polygons(Apexes { convex: true, concave: false })?;
    polygons(Apexes { convex: false, concave: true })?;
    let bounds = polygons(Apexes { convex: true, concave: true })?.corner_bounds();
    Ok((chords, bounds))
}
