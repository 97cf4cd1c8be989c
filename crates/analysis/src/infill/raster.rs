//! The grid of scan lines.

use super::InfillError;
use rayweave_math::sin_cos_degrees;
use std::ops::Range;

/// Equidistant parallel scan lines over the whole plane, numbered by all integers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Raster {
    spacing: f64,
    angle: f64,
    phase: f64,
}

/// The numbers of scan lines are below this magnitude, so that they are exact in `f64`.
const MAX_NUMBER: f64 = 9_007_199_254_740_992.0; // 2^53

impl Raster {
    /// Creates scan lines at a distance of `spacing` > 0, at `angle` degrees from +x towards +y. `phase` (0 to 1) times the
    /// spacing is the distance of line 0 from the origin, to the left of the direction.
    ///
    /// # Errors
    ///
    /// [`InfillError::Spacing`], [`InfillError::Angle`] or [`InfillError::Phase`] for a number out of its range.
    pub fn new(spacing: f64, angle: f64, phase: f64) -> Result<Raster, InfillError> {
        match () {
            () if !(spacing > 0.0 && spacing.is_finite()) => Err(InfillError::Spacing(spacing)),
            () if !angle.is_finite() => Err(InfillError::Angle(angle)),
            () if !(0.0..=1.0).contains(&phase) => Err(InfillError::Phase(phase)),
            () => Ok(Raster { spacing, angle, phase }),
        }
    }

    /// The scan lines rotated about the origin by an angle in degrees, counter-clockwise.
    ///
    /// # Errors
    ///
    /// [`InfillError::Angle`] if the resulting angle is not finite.
    pub fn turned(&self, degrees: f64) -> Result<Raster, InfillError> {
        Raster::new(self.spacing, self.angle + degrees, self.phase)
    }

    /// The distance between scan lines.
    pub fn spacing(&self) -> f64 {
        self.spacing
    }

    /// The direction of scan lines: a unit vector, exact at multiples of 90 degrees.
    pub fn direction(&self) -> [f64; 2] {
        let (sin, cos) = sin_cos_degrees(self.angle);
        [cos, sin]
    }

    /// The point of scan line k that is nearest to the origin.
    pub fn origin(&self, k: i64) -> [f64; 2] {
        let [x, y] = self.direction();
        let level = (k as f64 + self.phase) * self.spacing;
        [-y * level, x * level]
    }

    /// The numbers of all scan lines that intersect a box, given by its smallest and largest coordinates, and
    /// of one or two more on either side, to allow for rounding of the corners. The additional lines are
    /// omitted where their distance from the origin exceeds twice the larger |x| + |y| of the two corners:
    /// with a large spacing they may be too far away to be traced.
    ///
    /// # Errors
    ///
    /// [`InfillError::TooManyLines`] if there are more than `most`, including omitted ones, or if a number reaches
    /// 2^53 in magnitude.
    pub fn scanlines(&self, [lo, hi]: [[f64; 2]; 2], most: u64) -> Result<Range<i64>, InfillError> {
        let [x, y] = self.direction();
        let level = |px: f64, py: f64| (x * py - y * px) / self.spacing - self.phase;
        let levels = [level(lo[0], lo[1]), level(hi[0], lo[1]), level(lo[0], hi[1]), level(hi[0], hi[1])];
        let first = levels.into_iter().fold(f64::INFINITY, f64::min).floor() - 1.0;
        let last = levels.into_iter().fold(f64::NEG_INFINITY, f64::max).ceil() + 1.0;
        let is_countable = first > -MAX_NUMBER && last < MAX_NUMBER;
        match is_countable && last - first < most as f64 {
            true => {
                let reach = [lo, hi].iter().map(|p| p[0].abs() + p[1].abs()).fold(0.0, f64::max);
                let is_far = |k: i64| ((k as f64 + self.phase) * self.spacing).abs() > 2.0 * reach;
                let mut lines = first as i64..last as i64 + 1;
                while !lines.is_empty() && is_far(lines.start) {
                    lines.start += 1;
                }
                while !lines.is_empty() && is_far(lines.end - 1) {
                    lines.end -= 1;
                }
                Ok(lines)
            }
            false => {
                let lines = if is_countable { last - first + 1.0 } else { last.abs().max(first.abs()) };
                Err(InfillError::TooManyLines { spacing: self.spacing, lines, most })
            }
        }
    }
}
