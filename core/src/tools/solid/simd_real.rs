//! Real numbers one at a time or eight at a time. The inside tests of solids are generic over both, so that the test of
//! a voxel and that of a row of voxels are the same operations in the same order, and agree to the bit. Knows no solid.

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Sub};

use fearless_simd::{Simd, f64x8, mask64x8, prelude::*};

/// A number, or eight of them.
pub trait SimdReal:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
{
    /// A truth value for each number.
    type Mask: Copy + BitAnd<Output = Self::Mask> + BitOr<Output = Self::Mask>;

    /// Returns `value` in all lanes.
    fn all(self, value: f64) -> Self;
    fn abs(self) -> Self;
    fn sqrt(self) -> Self;
    /// Returns the larger number, and the smaller; neither may be NaN.
    fn max(self, other: Self) -> Self;
    fn min(self, other: Self) -> Self;
    /// Compares by at most, and by less than.
    fn at_most(self, other: Self) -> Self::Mask;
    fn below(self, other: Self) -> Self::Mask;
    /// Selects `self` where the mask is true, `other` elsewhere.
    fn where_true(self, mask: Self::Mask, other: Self) -> Self;
    /// Returns whether the mask is true in all lanes, and in none.
    fn is_all(mask: Self::Mask) -> bool;
    fn is_none(mask: Self::Mask) -> bool;
}

impl SimdReal for f64 {
    type Mask = bool;

    #[inline(always)]
    fn all(self, value: f64) -> f64 {
        value
    }

    #[inline(always)]
    fn abs(self) -> f64 {
        f64::abs(self)
    }

    #[inline(always)]
    fn sqrt(self) -> f64 {
        f64::sqrt(self)
    }

    #[inline(always)]
    fn max(self, other: f64) -> f64 {
        f64::max(self, other)
    }

    #[inline(always)]
    fn min(self, other: f64) -> f64 {
        f64::min(self, other)
    }

    #[inline(always)]
    fn at_most(self, other: f64) -> bool {
        self <= other
    }

    #[inline(always)]
    fn below(self, other: f64) -> bool {
        self < other
    }

    #[inline(always)]
    fn where_true(self, mask: bool, other: f64) -> f64 {
        if mask { self } else { other }
    }

    #[inline(always)]
    fn is_all(mask: bool) -> bool {
        mask
    }

    #[inline(always)]
    fn is_none(mask: bool) -> bool {
        !mask
    }
}

impl<S: Simd> SimdReal for f64x8<S> {
    type Mask = mask64x8<S>;

    #[inline(always)]
    fn all(self, value: f64) -> Self {
        f64x8::splat(self.simd, value)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        self.simd.abs_f64x8(self)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        self.simd.sqrt_f64x8(self)
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.simd.max_f64x8(self, other)
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.simd.min_f64x8(self, other)
    }

    #[inline(always)]
    fn at_most(self, other: Self) -> Self::Mask {
        self.simd_le(other)
    }

    #[inline(always)]
    fn below(self, other: Self) -> Self::Mask {
        self.simd_lt(other)
    }

    #[inline(always)]
    fn where_true(self, mask: Self::Mask, other: Self) -> Self {
        mask.select(self, other)
    }

    #[inline(always)]
    fn is_all(mask: Self::Mask) -> bool {
        mask.all_true()
    }

    #[inline(always)]
    fn is_none(mask: Self::Mask) -> bool {
        mask.all_false()
    }
}
