//! Ray transfer matrices (ABCD matrices).

/// A ray transfer matrix (a, b; c, d), which maps (height, index times slope) of a ray at one plane to those
/// at a later plane.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(missing_docs, reason = "the entries of a matrix have no other names")]
pub struct Matrix {
    pub a: f64,
    pub b: f64,
    pub c: f64,
    pub d: f64,
}

impl Matrix {
    /// The identity.
    pub const IDENTITY: Matrix = Matrix { a: 1.0, b: 0.0, c: 0.0, d: 1.0 };

    /// Propagation over a length in a medium.
    pub fn distance(length: f64, index: f64) -> Matrix {
        Matrix { b: length / index, ..Matrix::IDENTITY }
    }

    /// Refraction at a surface of a curvature between two indices; reflection if one is minus the other.
    pub fn surface(curvature: f64, before: f64, behind: f64) -> Matrix {
        Matrix { c: -(behind - before) * curvature, ..Matrix::IDENTITY }
    }

    /// The product: this matrix first, then `next`.
    pub fn then(self, next: Matrix) -> Matrix {
        Matrix {
            a: next.a * self.a + next.b * self.c,
            b: next.a * self.b + next.b * self.d,
            c: next.c * self.a + next.d * self.c,
            d: next.c * self.b + next.d * self.d,
        }
    }

    /// Applies the matrix to a ray (height, index times slope).
    pub fn apply(self, [y, nu]: [f64; 2]) -> [f64; 2] {
        [self.a * y + self.b * nu, self.c * y + self.d * nu]
    }
}
