//! Runs the same loop in the widest vectors of this computer.
//!
//! A build for every x86-64 processor has only 128-bit vectors, so that one [`Lanes`] takes two. Where the processor
//! has 256-bit vectors, the few loops that take most of a tick use them. Products and sums are never fused, so the
//! results are identical to the last bit.

#![expect(clippy::inline_always, reason = "they must be inlined into the function that is compiled for wider vectors")]

use wide::f64x4;

use super::Lanes;

/// Four numbers in one register or in two.
pub(crate) trait SimdVector: Copy {
    fn of(lanes: &Lanes) -> Self;
    fn lanes(self) -> Lanes;
    fn plus(self, other: Self) -> Self;
    fn minus(self, other: Self) -> Self;
    fn times(self, other: Self) -> Self;
}

/// A loop over [`SimdVector`]s; `run` and every function that it calls must be `#[inline(always)]`.
pub(crate) trait SimdLoop {
    type Output;
    fn run<V: SimdVector>(self) -> Self::Output;
}

/// Runs the work in the widest vectors of this processor.
#[inline]
pub(crate) fn widest<W: SimdLoop>(work: W) -> W::Output {
    #[cfg(target_arch = "x86_64")]
    // The standard library caches the answer, so this is one load in a tick.
    if std::arch::is_x86_feature_detected!("avx2") {
        #[expect(unsafe_code, reason = "the only way to compile a function for more than the minimum processor")]
        // SAFETY: the processor has the features that the function is compiled for.
        return unsafe { avx2::run(work) };
    }
    work.run::<f64x4>()
}

impl SimdVector for f64x4 {
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
#[expect(unsafe_code, reason = "the processor's own vectors, used only inside `run`, which is compiled for them")]
mod avx2 {
    use std::arch::x86_64::{__m256d, _mm256_add_pd, _mm256_load_pd, _mm256_mul_pd, _mm256_store_pd, _mm256_sub_pd};

    use super::{Lanes, SimdLoop, SimdVector};

    #[target_feature(enable = "avx2")]
    pub(super) fn run<W: SimdLoop>(work: W) -> W::Output {
        work.run::<WidestRegister>()
    }

    #[derive(Clone, Copy)]
    struct WidestRegister(__m256d);

    // SAFETY (all functions): only `run` creates these values, and it runs only where the processor has these features;
    // `Lanes` is aligned to its 32 bytes.
    impl SimdVector for WidestRegister {
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
