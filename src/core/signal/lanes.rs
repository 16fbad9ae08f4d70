//! Three axes in one vector register.

#![expect(
    clippy::inline_always,
    reason = "one instruction each; they must be inlined even into functions compiled for other vector widths"
)]

use std::ops::{Add, AddAssign, Div, Index, IndexMut, Mul, MulAssign, Neg, Sub, SubAssign};

use nalgebra::Vector3;
use wide::f64x4;

/// A number closer to zero than this is treated as zero.
///
/// Exponentially weighted means decay for as long as their input is zero. After some minutes they would be subnormal
/// numbers, which are a hundred times slower to compute with and whose reciprocals are infinite.
/// Far below any physical quantity here, and its square is still a normal number.
pub const NOTHING: f64 = 1e-100;

/// Returns `value`, or 0 if it is closer to zero than [`NOTHING`].
#[inline(always)]
pub fn settled(value: f64) -> f64 {
    if value.abs() < NOTHING { 0.0 } else { value }
}

/// Number of lanes in [`Lanes`]: x, y, z and a spare, so that one value fills one 256-bit register.
pub const LANES: usize = 4;

/// One quantity for every axis: x, y, z, and a spare lane that stays zero.
///
/// Stored as an array and computed as one vector. Without this type the compiler vectorises across the loop instead of
/// across the lanes, which needs shuffles (a Cholesky factorisation took twice as long). Products and sums are never
/// fused, so the results are the same on every computer.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(align(32))]
pub struct Lanes(pub [f64; LANES]);

impl Lanes {
    pub const ZERO: Self = Self([0.0; LANES]);

    #[inline(always)]
    pub const fn splat(value: f64) -> Self {
        Self([value; LANES])
    }

    #[must_use]
    #[inline(always)]
    pub fn map(self, f: impl Fn(f64) -> f64) -> Self {
        let [x, y, z, w] = self.0;
        Self([f(x), f(y), f(z), f(w)])
    }

    #[must_use]
    #[inline(always)]
    pub fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        let [a0, a1, a2, a3] = self.0;
        let [b0, b1, b2, b3] = other.0;
        Self([f(a0, b0), f(a1, b1), f(a2, b2), f(a3, b3)])
    }

    /// Returns each lane, limited to two bounds.
    #[must_use]
    #[inline(always)]
    pub fn within(self, low: Self, high: Self) -> Self {
        self.zip(low, f64::max).zip(high, f64::min)
    }

    /// Returns the square roots.
    #[must_use]
    #[inline(always)]
    pub fn sqrt(self) -> Self {
        Self(f64x4::new(self.0).sqrt().to_array())
    }

    /// Returns `1 / self`, and 0 where a lane is 0 or subnormal (its reciprocal may be infinite).
    #[must_use]
    #[inline(always)]
    pub fn recip_or_zero(self) -> Self {
        // Not `== 0.0`: the reciprocal of a subnormal number is infinite.
        self.map(|value| if value.abs() < f64::MIN_POSITIVE { 0.0 } else { 1.0 / value })
    }

    /// Returns the lanes, with those closer to zero than [`NOTHING`] set to zero.
    #[must_use]
    #[inline(always)]
    pub fn settled(self) -> Self {
        self.map(settled)
    }

    #[inline(always)]
    pub fn is_finite(self) -> bool {
        self.0.iter().all(|value| value.is_finite())
    }

    /// Returns the three axes as a vector, without the spare lane.
    #[inline(always)]
    pub fn vector(self) -> Vector3<f64> {
        let [x, y, z, _] = self.0;
        Vector3::new(x, y, z)
    }

    #[inline(always)]
    pub fn norm(self) -> f64 {
        let [x, y, z, _] = self.0;
        (x * x + y * y + z * z).sqrt()
    }
}

impl From<Vector3<f64>> for Lanes {
    fn from(v: Vector3<f64>) -> Self {
        // The spare lane is zero, so that sums over all lanes are sums over the axes.
        Self([v.x, v.y, v.z, 0.0])
    }
}

impl Index<usize> for Lanes {
    type Output = f64;
    #[inline(always)]
    fn index(&self, lane: usize) -> &f64 {
        &self.0[lane]
    }
}

impl IndexMut<usize> for Lanes {
    #[inline(always)]
    fn index_mut(&mut self, lane: usize) -> &mut f64 {
        &mut self.0[lane]
    }
}

macro_rules! lane_wise {
    ($($trait:ident $method:ident $assign_trait:ident $assign_method:ident;)*) => {$(
        impl $assign_trait for Lanes {
            #[inline(always)]
            fn $assign_method(&mut self, other: Self) {
                *self = $trait::$method(*self, other);
            }
        }
    )*};
}

impl Add for Lanes {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self((f64x4::new(self.0) + f64x4::new(other.0)).to_array())
    }
}

impl Sub for Lanes {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self((f64x4::new(self.0) - f64x4::new(other.0)).to_array())
    }
}

impl Mul for Lanes {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self((f64x4::new(self.0) * f64x4::new(other.0)).to_array())
    }
}

impl Mul<f64> for Lanes {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: f64) -> Self {
        Self((f64x4::new(self.0) * f64x4::splat(factor)).to_array())
    }
}

impl Div for Lanes {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        Self((f64x4::new(self.0) / f64x4::new(other.0)).to_array())
    }
}

impl Neg for Lanes {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.map(|a| -a)
    }
}

lane_wise! {
    Add add AddAssign add_assign;
    Sub sub SubAssign sub_assign;
    Mul mul MulAssign mul_assign;
}
