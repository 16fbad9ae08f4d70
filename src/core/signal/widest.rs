//! The same loop in the widest vectors that this computer has.
//!
//! A build for every x86-64 knows 128-bit vectors only, so that a [`Lanes`] takes two. Where the processor has 256-bit ones, the
//! few loops that most of a tick goes into use them. Products and sums are never fused, so the results are the same bit for bit.

#![expect(clippy::inline_always, reason = "they must be inlined into the function that is compiled for wider vectors")]

use wide::f64x4;

use super::Lanes;

/// Four numbers in one register, or in two.
pub(crate) trait Vector: Copy {
    fn of(lanes: &Lanes) -> Self;
    fn lanes(self) -> Lanes;
    fn plus(self, other: Self) -> Self;
    fn minus(self, other: Self) -> Self;
    fn times(self, other: Self) -> Self;
}

/// A loop over [`Vector`]s; `run` and all that it calls must be `#[inline(always)]`.
pub(crate) trait Work {
    type Output;
    fn run<V: Vector>(self) -> Self::Output;
}

/// Does the work in the widest vectors.
#[inline]
pub(crate) fn widest<W: Work>(work: W) -> W::Output {
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx2") {
        #[expect(unsafe_code, reason = "only so can a function be compiled for more than the least processor")]
        // SAFETY: the processor has what the function is compiled for.
        return unsafe { avx2::run(work) };
    }
    work.run::<f64x4>()
}

impl Vector for f64x4 {
    #[inline(always)]
    fn of(lanes: &Lanes) -> Self {
        Self::new(lanes.0)
    }

    #[inline(always)]
    fn lanes(self) -> Lanes {
        Lanes(self.to_array())
    }

    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        self + other
    }

    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        self - other
    }

    #[inline(always)]
    fn times(self, other: Self) -> Self {
        self * other
    }
}

#[cfg(target_arch = "x86_64")]
#[expect(unsafe_code, reason = "the processor's own vectors; used inside of `run` alone, which is compiled for them")]
mod avx2 {
    use std::arch::x86_64::{__m256d, _mm256_add_pd, _mm256_load_pd, _mm256_mul_pd, _mm256_store_pd, _mm256_sub_pd};

    use super::{Lanes, Vector, Work};

    #[target_feature(enable = "avx2")]
    pub(super) fn run<W: Work>(work: W) -> W::Output {
        work.run::<Register>()
    }

    #[derive(Clone, Copy)]
    struct Register(__m256d);

    // SAFETY, of all: `run` is the only one that makes them, and it runs where the processor has them; `Lanes` is aligned to its
    // 32 bytes.
    impl Vector for Register {
        #[inline(always)]
        fn of(lanes: &Lanes) -> Self {
            Self(unsafe { _mm256_load_pd(lanes.0.as_ptr()) })
        }

        #[inline(always)]
        fn lanes(self) -> Lanes {
            let mut lanes = Lanes::ZERO;
            unsafe { _mm256_store_pd(lanes.0.as_mut_ptr(), self.0) };
            lanes
        }

        #[inline(always)]
        fn plus(self, other: Self) -> Self {
            Self(unsafe { _mm256_add_pd(self.0, other.0) })
        }

        #[inline(always)]
        fn minus(self, other: Self) -> Self {
            Self(unsafe { _mm256_sub_pd(self.0, other.0) })
        }

        #[inline(always)]
        fn times(self, other: Self) -> Self {
            Self(unsafe { _mm256_mul_pd(self.0, other.0) })
        }
    }
}
