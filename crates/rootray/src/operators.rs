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
