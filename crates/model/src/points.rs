//! Check of points before their regions are computed.

use crate::Program;
use rayweave_error::{Classified, ErrorKind};
use rayweave_math::Vec3;

/// A point with a coordinate that is not finite.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("point {point} is {at}: its coordinates must be finite.")]
pub struct BadPoint {
    /// The index of the point.
    pub point: usize,
    /// Its coordinates.
    pub at: Vec3,
}

impl Classified for BadPoint {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Value
    }
}

impl BadPoint {
    /// Checks that the coordinates of all points are finite.
    ///
    /// # Errors
    /// [`BadPoint`] for the first point that is not.
    pub fn check(points: impl IntoIterator<Item = Vec3>) -> Result<(), BadPoint> {
        match points.into_iter().enumerate().find(|(_, at)| !at.is_finite()) {
            Some((point, at)) => Err(BadPoint { point, at }),
            None => Ok(()),
        }
    }
}

impl Program {
    /// Checks that the coordinates of all points, given as columns, are finite, as [`Program::check_rays`] does for rays.
    ///
    /// # Errors
    /// [`BadPoint`] for the first point that is not.
    pub fn check_points(&self, [x, y, z]: [&[f64]; 3]) -> Result<(), BadPoint> {
        BadPoint::check(x.iter().zip(y).zip(z).map(|((&x, &y), &z)| Vec3::new(x, y, z)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Solid;

    #[test]
    fn points_that_are_not_finite() {
        let program = Program::compile(&Solid::empty()).unwrap();
        assert_eq!(program.check_points([&[0.0, 1e300], &[1.0, -0.0], &[2.0, 5e-324]]), Ok(()));
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            for axis in 0..3 {
                let mut columns = [[0.0; 4]; 3];
                columns[axis][2] = bad;
                let problem = program.check_points(columns.each_ref().map(|column| &column[..])).unwrap_err();
                assert_eq!(problem.point, 2);
                assert!(problem.to_string().starts_with("point 2 is ["), "{problem}");
            }
        }
    }
}
