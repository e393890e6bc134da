//! Chooses vector instructions for plain loops at run time: the baseline that the program is compiled for has neither
//! wide vectors nor bit counts. Provides helpers that stay inlined within such a choice.

/// Runs `f`, in a version compiled for AVX2 and POPCNT if the processor has them. Only code inlined into `f` benefits:
/// mark the closure and its callees `#[inline(always)]`.
#[inline(always)]
pub(crate) fn vectorised<T>(f: impl FnOnce() -> T) -> T {
    #[cfg(target_arch = "x86_64")]
    if let Some(avx2) = fearless_simd::Level::new().as_avx2() {
        return fearless_simd::Simd::vectorize(avx2, f);
    }
    f()
}

/// Returns `f` of the three axes. Unlike [`std::array::from_fn`] and `array::map`, it is always inlined, together with
/// a closure that is marked `#[inline(always)]`. Code that is not inlined is compiled for the baseline, and calls a
/// function for each vector instruction.
#[inline(always)]
pub(crate) fn for_axes<T>(mut f: impl FnMut(usize) -> T) -> [T; 3] {
    [f(0), f(1), f(2)]
}
