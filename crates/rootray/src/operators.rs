//! The operators `| & - ^ !` of root-rays.

use std::ops::{BitAnd, BitOr, BitXor, Not, Sub};

use crate::RootRay;

macro_rules! binary_operator {
    ($operator:ident, $method:ident, $operation:ident) => {
        impl<S: Clone> $operator<&RootRay<S>> for &RootRay<S> {
            type Output = RootRay<S>;

            fn $method(self, other: &RootRay<S>) -> RootRay<S> {
                self.$operation(other)
            }
        }

        impl<S: Clone> $operator for RootRay<S> {
            type Output = RootRay<S>;

            fn $method(self, other: RootRay<S>) -> RootRay<S> {
                self.$operation(&other)
            }
        }

        impl<S: Clone> $operator<&RootRay<S>> for RootRay<S> {
            type Output = RootRay<S>;

            fn $method(self, other: &RootRay<S>) -> RootRay<S> {
                self.$operation(other)
            }
        }

        impl<S: Clone> $operator<RootRay<S>> for &RootRay<S> {
            type Output = RootRay<S>;

            fn $method(self, other: RootRay<S>) -> RootRay<S> {
                self.$operation(&other)
            }
        }
    };
}

binary_operator!(BitOr, bitor, union);
binary_operator!(BitAnd, bitand, intersection);
binary_operator!(Sub, sub, difference);
binary_operator!(BitXor, bitxor, symmetric_difference);

impl<S: Clone> Not for &RootRay<S> {
    type Output = RootRay<S>;

    fn not(self) -> RootRay<S> {
        self.complement()
    }
}

impl<S> Not for RootRay<S> {
    type Output = Self;

    fn not(self) -> Self {
        let (start, roots) = self.into_parts();
        Self::from_ordered(!start, roots)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Side;

    #[test]
    fn operands_are_borrowed_or_owned() {
        let span = |from: f64, to: f64| RootRay::from_times(Side::Outside, [from, to]).unwrap();
        let (a, b, c) = (span(0.0, 9.0), span(1.0, 8.0), span(3.0, 5.0));
        let expected = RootRay::from_times(Side::Outside, [1.0, 3.0, 5.0, 8.0]).unwrap();
        assert_eq!(&a & &b & !&c, expected);
        assert_eq!(&a & &b & &!&c, expected);
        assert_eq!(&a & (&b - &c), expected);
        assert_eq!(a & (b - c), expected);
    }
}
