//! The number types of kernels: SIMD lanes of one register, or one lane that counts operations.

use fearless_simd::{ExtractToken, Select, Simd, SimdBase, SimdFloat, SimdNarrow};
use std::cell::Cell;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// One or more 64-bit numbers that are processed together.
pub trait Lanes:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// A boolean for each lane.
    type Mask: Copy + BitAnd<Output = Self::Mask> + BitOr<Output = Self::Mask> + Not<Output = Self::Mask>;

    /// An integer for each lane.
    type Numbers: Copy;

    /// The number of lanes.
    const COUNT: usize;

    /// The same number in all lanes, of the same type as `self`.
    fn like(self, value: f64) -> Self;

    /// Loads [`Lanes::COUNT`] numbers, of the same type as `self`.
    fn load(self, values: &[f64]) -> Self;

    /// The same integer in all lanes.
    fn number(self, value: i64) -> Self::Numbers;

    /// The square root; NaN below zero.
    fn root(self) -> Self;

    /// The lesser of two.
    fn least(self, other: Self) -> Self;

    /// The greater of two.
    fn greatest(self, other: Self) -> Self;

    /// Mask of `self < other`; false for NaN.
    fn below(self, other: Self) -> Self::Mask;

    /// Selects `yes` where the mask holds, `no` elsewhere.
    fn choose(mask: Self::Mask, yes: Self, no: Self) -> Self;

    /// The same selection for integers.
    fn choose_number(mask: Self::Mask, yes: Self::Numbers, no: Self::Numbers) -> Self::Numbers;

    /// Stores the lanes to a slice of [`Lanes::COUNT`].
    fn store(self, out: &mut [f64]);

    /// Stores two rows of integers.
    fn store_numbers(numbers: [Self::Numbers; 2], out: [&mut [i32]; 2]);
}

/// The lanes of a register of the level `S`: 8 with AVX-512, 4 with AVX2, 2 with SSE2.
#[derive(Clone, Copy)]
pub struct Native<S: Simd>(S::f64s);

impl<S: Simd> Native<S> {
    /// Zero in all lanes.
    #[inline(always)]
    pub fn zero(simd: S) -> Native<S> {
        Native(S::f64s::splat(simd, 0.0))
    }
}

macro_rules! operators {
    ($($operator:ident $method:ident),*) => {$(
        impl<S: Simd> $operator for Native<S> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Native($operator::$method(self.0, other.0))
            }
        }
        impl $operator for Counted<'_> {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                self.tally.$method();
                Counted { value: $operator::$method(self.value, other.value), ..self }
            }
        }
    )*};
}
operators!(Add add, Sub sub, Mul mul, Div div);

impl<S: Simd> Neg for Native<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Native(-self.0)
    }
}

impl<S: Simd> Lanes for Native<S> {
    type Mask = S::mask64s;
    type Numbers = S::i64s;
    const COUNT: usize = <S::f64s as SimdBase<S>>::LEN;

    #[inline(always)]
    fn like(self, value: f64) -> Self {
        Native(S::f64s::splat(self.0.token(), value))
    }

    #[inline(always)]
    fn load(self, values: &[f64]) -> Self {
        Native(S::f64s::from_slice(self.0.token(), values))
    }

    #[inline(always)]
    fn number(self, value: i64) -> S::i64s {
        S::i64s::splat(self.0.token(), value)
    }

    #[inline(always)]
    fn root(self) -> Self {
        Native(self.0.sqrt())
    }

    #[inline(always)]
    fn least(self, other: Self) -> Self {
        Native(self.0.min(other.0))
    }

    #[inline(always)]
    fn greatest(self, other: Self) -> Self {
        Native(self.0.max(other.0))
    }

    #[inline(always)]
    fn below(self, other: Self) -> S::mask64s {
        self.0.simd_lt(other.0)
    }

    #[inline(always)]
    fn choose(mask: S::mask64s, yes: Self, no: Self) -> Self {
        Native(mask.select(yes.0, no.0))
    }

    #[inline(always)]
    fn choose_number(mask: S::mask64s, yes: S::i64s, no: S::i64s) -> S::i64s {
        mask.select(yes, no)
    }

    #[inline(always)]
    fn store(self, out: &mut [f64]) {
        self.0.store_slice(out);
    }

    #[inline(always)]
    fn store_numbers([first, second]: [S::i64s; 2], [out, out2]: [&mut [i32]; 2]) {
        let both = first.narrow(second);
        let (low, high) = both.as_slice().split_at(Self::COUNT);
        out.copy_from_slice(low);
        out2.copy_from_slice(high);
    }
}

/// The number of operations of each kind that a kernel has executed.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    simple: Cell<u64>,
    divisions: Cell<u64>,
    roots: Cell<u64>,
}

impl Tally {
    /// Additions, subtractions, multiplications, minima and maxima, comparisons and selections.
    pub fn simple(&self) -> u64 {
        self.simple.get()
    }

    /// Divisions.
    pub fn divisions(&self) -> u64 {
        self.divisions.get()
    }

    /// Square roots.
    pub fn roots(&self) -> u64 {
        self.roots.get()
    }

    fn add(&self) {
        self.simple.set(self.simple() + 1);
    }

    fn sub(&self) {
        self.add();
    }

    fn mul(&self) {
        self.add();
    }

    fn div(&self) {
        self.divisions.set(self.divisions() + 1);
    }

    fn root(&self) {
        self.roots.set(self.roots() + 1);
    }
}

/// One number that counts its operations. Operations on masks, which have their own execution units
/// or are nearly free, are not counted.
#[derive(Clone, Copy, Debug)]
pub struct Counted<'t> {
    value: f64,
    tally: &'t Tally,
}

impl<'t> Counted<'t> {
    /// Zero, with operations counted in the tally.
    pub fn zero(tally: &'t Tally) -> Counted<'t> {
        Counted { value: 0.0, tally }
    }

    fn with(self, value: f64) -> Self {
        self.tally.add();
        Counted { value, ..self }
    }
}

impl Neg for Counted<'_> {
    type Output = Self;
    fn neg(self) -> Self {
        self.with(-self.value)
    }
}

impl<'t> Lanes for Counted<'t> {
    type Mask = bool;
    type Numbers = (i64, &'t Tally);
    const COUNT: usize = 1;

    fn like(self, value: f64) -> Self {
        Counted { value, ..self }
    }

    fn load(self, values: &[f64]) -> Self {
        Counted { value: values[0], ..self }
    }

    fn number(self, value: i64) -> Self::Numbers {
        (value, self.tally)
    }

    fn root(self) -> Self {
        self.tally.root();
        Counted { value: self.value.sqrt(), ..self }
    }

    fn least(self, other: Self) -> Self {
        self.with(self.value.min(other.value))
    }

    fn greatest(self, other: Self) -> Self {
        self.with(self.value.max(other.value))
    }

    fn below(self, other: Self) -> bool {
        self.tally.add();
        self.value < other.value
    }

    fn choose(mask: bool, yes: Self, no: Self) -> Self {
        yes.with(if mask { yes.value } else { no.value })
    }

    fn choose_number(mask: bool, yes: Self::Numbers, no: Self::Numbers) -> Self::Numbers {
        yes.1.add();
        if mask { yes } else { no }
    }

    fn store(self, out: &mut [f64]) {
        out[0] = self.value;
    }

    fn store_numbers([first, second]: [Self::Numbers; 2], [out, out2]: [&mut [i32]; 2]) {
        out[0] = first.0 as i32;
        out2[0] = second.0 as i32;
    }
}
