//! Circles and ellipses, `r(t) = centre + cos(w t) a + sin(w t) b`; the time window selects an arc. The curve is an ellipse if the
//! axes are not perpendicular or have different lengths.

use crate::curve::vector::{self, Direction};
use crate::point::{add_scaled, dot, is_finite, length, minus};
use crate::{Curve, CurveError, Point};

/// A circle or ellipse in R^d, traversed at a constant rate of its parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arc<const D: usize> {
    centre: Point<D>,
    axes: [Point<D>; 2],
    angular_speed: f64,
}

impl<const D: usize> Arc<D> {
    /// The curve `centre + cos(w t) axes[0] + sin(w t) axes[1]` with the angular speed w in radians per unit of t; if it is 1, t
    /// is the angle.
    ///
    /// The curve is at `centre + axes[0]` at t = 0. Two perpendicular axes of equal length give a circle, others an ellipse (conjugate
    /// semi-diameters).
    ///
    /// # Errors
    /// A number is NaN or infinite.
    pub fn new(centre: Point<D>, axes: [Point<D>; 2], angular_speed: f64) -> Result<Arc<D>, CurveError> {
        vector::finite("centre", &centre)?;
        vector::finite("axes", &axes[0])?;
        vector::finite("axes", &axes[1])?;
        vector::finite("angular_speed", &[angular_speed])?;
        Ok(Arc { centre, axes, angular_speed })
    }

    /// The centre.
    pub fn centre(&self) -> Point<D> {
        self.centre
    }

    /// The two axes.
    pub fn axes(&self) -> [Point<D>; 2] {
        self.axes
    }

    /// The angle, in radians, per unit of t.
    pub fn angular_speed(&self) -> f64 {
        self.angular_speed
    }

    /// `(cos, sin)` of the angle at a time.
    fn turn(&self, t: f64) -> (f64, f64) {
        let (sin, cos) = libm::sincos(self.angular_speed * t);
        (cos, sin)
    }

    fn combined(&self, cos: f64, sin: f64) -> Point<D> {
        let [a, b] = &self.axes;
        std::array::from_fn(|k| cos * a[k] + sin * b[k])
    }

    /// The largest distance from the centre: the largest singular value of the axes as columns,
    /// `s^2 = (aa + bb) / 2 + sqrt(((aa - bb) / 2)^2 + ab^2)` (the larger eigenvalue of a symmetric 2 x 2 matrix).
    fn radius(&self) -> f64 {
        let [a, b] = &self.axes;
        let unit = length(a).max(length(b));
        if unit == 0.0 || !is_finite(&[unit]) {
            return unit;
        }
        let (a, b) = (a.map(|x| x / unit), b.map(|x| x / unit));
        let (aa, bb, ab) = (dot(&a, &a), dot(&b, &b), dot(&a, &b));
        let half = 0.5 * (aa - bb);
        unit * (0.5 * (aa + bb) + (half * half + ab * ab).sqrt()).sqrt()
    }
}

impl Arc<3> {
    /// The circle around `centre` from `start`, right-handed about `normal`, with `angular_speed` radians per unit of t. The component of
    /// `start - centre` along the normal is dropped: the circle lies in the plane through the centre.
    ///
    /// # Errors
    /// A number is NaN or infinite, the normal is zero, or `start` lies on the axis of the circle.
    pub fn about(
        centre: Point<3>,
        normal: Point<3>,
        start: Point<3>,
        angular_speed: f64,
    ) -> Result<Arc<3>, CurveError> {
        vector::finite("start", &start)?;
        let normal = Direction::new("normal", &normal)?;
        let from = normal.across(&minus(&start, &centre));
        if from == [0.0; 3] {
            return Err(CurveError::InvalidArgument {
                what: "start",
                why: "it lies on the axis of the circle",
            });
        }
        Arc::new(centre, [from, normal.cross(&from)], angular_speed)
    }
}

impl<const D: usize> Curve<D> for Arc<D> {
    fn position(&self, t: f64) -> Point<D> {
        let (cos, sin) = self.turn(t);
        add_scaled(&self.centre, 1.0, &self.combined(cos, sin))
    }

    fn velocity(&self, t: f64) -> Point<D> {
        let (cos, sin) = self.turn(t);
        self.combined(-sin, cos).map(|x| self.angular_speed * x)
    }

    fn acceleration_bound(&self, _: f64, _: f64) -> f64 {
        self.angular_speed * self.angular_speed * self.radius()
    }

    fn size(&self, t: f64) -> f64 {
        // the rounding error u |w t| of the angle moves the point along the circle
        length(&self.centre) + self.radius() * (1.0 + (self.angular_speed * t).abs())
    }
}
