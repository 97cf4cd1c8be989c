//! Primitive solids in R^d: half-spaces, slabs, boxes, balls, cylinders, cones and quadrics.

use crate::affine::{Affine, check_axis};
use crate::error::{SpaceError, check};
use crate::surface::{Plane, Quadric, Surface};
use crate::vector::{axis_vector, padded, times};
use crate::{Point, Solid};
use std::array::from_fn;

/// A primitive: the intersection of the insides of its surfaces.
#[derive(Clone, Debug, PartialEq)]
pub struct Shape<const D: usize> {
    /// The name of a leaf without a name of its own.
    pub(crate) kind: &'static str,
    /// The faces.
    pub(crate) facets: Vec<Surface<D>>,
    /// The centre and half extents of a box around the shape or, if it is unbounded, around its corners. Without a box, the anchors of
    /// the surfaces are used.
    pub(crate) finite: Option<(Point<D>, Point<D>)>,
}

impl<const D: usize> Shape<D> {
    fn unbounded(kind: &'static str, facets: Vec<Surface<D>>) -> Self {
        Shape { kind, facets, finite: None }
    }

    /// The shape in a space of more dimensions, unbounded in the additional ones.
    pub(crate) fn extruded<const N: usize>(&self) -> Shape<N> {
        let facets = self.facets.iter().map(|surface| match surface {
            Surface::Plane(plane) => {
                Surface::Plane(Plane { normal: padded(&plane.normal), offset: plane.offset })
            }
            Surface::Quadric(quadric) => Surface::Quadric(Box::new(Quadric {
                centre: padded(&quadric.centre),
                axes: from_fn(|k| quadric.axes.get(k).map_or([0.0; N], padded)),
                weights: padded(&quadric.weights),
                constant: quadric.constant,
            })),
        });
        let finite = self.finite.map(|(middle, half)| (padded(&middle), padded(&half)));
        Shape { kind: self.kind, facets: facets.collect(), finite }
    }
}

/// Shapes. Axes are numbered from 0. Nonzero lengths must be between 1e-60 and 1e60 in magnitude.
impl<const D: usize> Solid<D> {
    /// The points whose coordinate along an axis is negative: x_axis < 0.
    ///
    /// # Errors
    /// `Axis`.
    pub fn half_space(axis: usize) -> Result<Self, SpaceError> {
        check_axis::<D>(axis)?;
        Self::half_space_below(axis_vector(axis), 0.0)
    }

    /// The points with `normal . p < offset`; the normal may have any length.
    ///
    /// # Errors
    /// `NotFinite`, `Extreme` or `ZeroNormal`.
    pub fn half_space_below(normal: Point<D>, offset: f64) -> Result<Self, SpaceError> {
        check::point("normal", &normal)?;
        check::length("offset", &[], offset)?;
        if normal == [0.0; D] {
            return Err(SpaceError::ZeroNormal);
        }
        let plane = Plane::new(&normal, offset);
        check::length("offset", &[], plane.offset)?;
        Ok(Shape::unbounded("half_space", vec![Surface::Plane(plane)]).into())
    }

    /// The points with lo < x_axis < hi.
    ///
    /// # Errors
    /// `Axis`, `NotFinite`, `Extreme` or `NotIncreasing`.
    pub fn slab(axis: usize, lo: f64, hi: f64) -> Result<Self, SpaceError> {
        check_axis::<D>(axis)?;
        check::length("lo", &[], lo)?;
        check::length("hi", &[], hi)?;
        if lo >= hi {
            return Err(SpaceError::NotIncreasing { index: Vec::new(), lo, hi });
        }
        Ok(Shape::unbounded("slab", slab_faces(axis, lo, hi).into()).into())
    }

    /// The box between two opposite corners: lo_k < x_k < hi_k for every axis.
    ///
    /// # Errors
    /// `NotFinite`, `Extreme` or `NotIncreasing`.
    pub fn box_from_corners(lo: Point<D>, hi: Point<D>) -> Result<Self, SpaceError> {
        check::point("lo", &lo)?;
        check::point("hi", &hi)?;
        if let Some(k) = (0..D).find(|&k| lo[k] >= hi[k]) {
            return Err(SpaceError::NotIncreasing { index: vec![k], lo: lo[k], hi: hi[k] });
        }
        let facets = (0..D).flat_map(|k| slab_faces(k, lo[k], hi[k])).collect();
        let finite = Some((from_fn(|k| 0.5 * (lo[k] + hi[k])), from_fn(|k| 0.5 * (hi[k] - lo[k]))));
        Ok(Shape { kind: "box", facets, finite }.into())
    }

    /// The points where the sum of the first m squared coordinates minus that of the next n - m, plus `bias`, is
    /// negative; the other D - n coordinates are free.
    ///
    /// `n = m = D` is a ball of radius sqrt(-bias), `n = m < D` a cylinder, `m < n` with bias 0 a cone; with bias < 0 a hyperboloid of
    /// one sheet (if m > 1), with bias > 0 the inside of a hyperboloid of two sheets. If the sum has the same sign for all
    /// points, the result is [`Solid::empty`] or, up to a set of measure zero, [`Solid::universe`].
    ///
    /// # Errors
    /// `Squares` unless m <= n <= D, `NotFinite` or `Extreme` for the bias.
    pub fn quadric(n: usize, m: usize, bias: f64) -> Result<Self, SpaceError> {
        if m > n || n > D {
            return Err(SpaceError::Squares { n, m, dimension: D });
        }
        check::length("bias", &[], bias)?;
        let never = bias >= 0.0 && m == n;
        let always = if n == 0 { bias < 0.0 } else { bias <= 0.0 && m == 0 };
        if never || always {
            return Ok(if always { Self::universe() } else { Self::empty() });
        }
        let weights = from_fn(|k| match k {
            _ if k < m => 1.0,
            _ if k < n => -1.0,
            _ => 0.0,
        });
        let surface = Surface::Quadric(Box::new(Quadric::along_axes(weights, bias)));
        let finite = (m == D).then(|| ([0.0; D], [(-bias).sqrt(); D]));
        Ok(Shape { kind: "quadric", facets: vec![surface], finite }.into())
    }

    /// The ball of this radius (> 0) around the origin.
    ///
    /// # Errors
    /// `NotFinite`, `Extreme` or `NotPositive`.
    pub fn ball(radius: f64) -> Result<Self, SpaceError> {
        check::size("radius", radius)?;
        Ok(Shape { kind: "ball", facets: vec![round(D, radius)], finite: Some(([0.0; D], [radius; D])) }
            .into())
    }

    /// The points whose first m coordinates lie in a ball of this radius (> 0), unbounded in the others: in space, m = 2 is the
    /// cylinder along z; in space-time, m = 3 is a ball at rest.
    ///
    /// # Errors
    /// `Squares` unless 1 <= m <= D; `NotFinite`, `Extreme` or `NotPositive`.
    pub fn cylinder(m: usize, radius: f64) -> Result<Self, SpaceError> {
        check_squares::<D>(m, m)?;
        check::size("radius", radius)?;
        let finite = (m == D).then_some(([0.0; D], [radius; D]));
        Ok(Shape { kind: "cylinder", facets: vec![round(m, radius)], finite }.into())
    }

    /// The double cone with its apex at the origin: the norm of the first m coordinates is less than `slope` (> 0) times the norm of
    /// the others. m = D - 1 is a cone about the last axis; in space-time, with time as the last coordinate and slope c, it is
    /// the light cone of the origin.
    ///
    /// # Errors
    /// `Squares` unless 1 <= m < D; `NotFinite`, `Extreme` or `NotPositive`.
    pub fn cone(m: usize, slope: f64) -> Result<Self, SpaceError> {
        check_squares::<D>(D, m)?;
        check::size("slope", slope)?;
        if m == D {
            return Err(SpaceError::Squares { n: D, m, dimension: D });
        }
        let weights = from_fn(|k| if k < m { 1.0 } else { -slope * slope });
        let surface = Surface::Quadric(Box::new(Quadric::along_axes(weights, 0.0)));
        Ok(Shape::unbounded("cone", vec![surface]).into())
    }
}

/// Maps.
impl<const D: usize> Solid<D> {
    /// The image under an invertible affine map, given by the rows of its matrix and the image of the origin.
    ///
    /// # Errors
    /// As for [`Affine::new`].
    pub fn affine(&self, matrix: [Point<D>; D], translation: Point<D>) -> Result<Self, SpaceError> {
        Ok(self.apply(Affine::new(matrix, translation)?))
    }

    /// The solid translated by a vector.
    ///
    /// # Errors
    /// `NotFinite` or `Extreme`.
    pub fn translate(&self, by: Point<D>) -> Result<Self, SpaceError> {
        Ok(self.apply(Affine::translation(by)?))
    }

    /// The solid scaled about the origin by one factor per axis (`[s; D]` for all); negative factors mirror.
    ///
    /// # Errors
    /// As for [`Affine::scale`].
    pub fn scale(&self, factors: Point<D>) -> Result<Self, SpaceError> {
        Ok(self.apply(Affine::scale(factors)?))
    }

    /// The solid rotated about the origin in a coordinate plane, axis `from` towards axis `to`, by an angle in degrees.
    ///
    /// # Errors
    /// As for [`Affine::rotation`].
    pub fn rotate(&self, from: usize, to: usize, degrees: f64) -> Result<Self, SpaceError> {
        Ok(self.apply(Affine::rotation(from, to, degrees)?))
    }
}

fn check_squares<const D: usize>(n: usize, m: usize) -> Result<(), SpaceError> {
    match (1..=n).contains(&m) && n <= D {
        true => Ok(()),
        false => Err(SpaceError::Squares { n, m, dimension: D }),
    }
}

/// The two planes of a slab. Adjacent slabs have bit-identical planes.
fn slab_faces<const D: usize>(axis: usize, lo: f64, hi: f64) -> [Surface<D>; 2] {
    let normal = axis_vector(axis);
    [
        Surface::Plane(Plane { normal: times(-1.0, &normal), offset: -lo }),
        Surface::Plane(Plane { normal, offset: hi }),
    ]
}

/// The surface on which the sum of the first m squared coordinates is the square of the radius.
fn round<const D: usize>(m: usize, radius: f64) -> Surface<D> {
    let weights = from_fn(|k| if k < m { 1.0 } else { 0.0 });
    Surface::Quadric(Box::new(Quadric::along_axes(weights, -radius * radius)))
}
