//! Owns the choice of instructions for plain loops: counts of bits and wide vectors are not in the
//! least processor that the program is compiled for, and are used where they are found.

/// Runs `f`, compiled a second time for AVX2 with its counts of bits where the processor has them.
/// Only what is inlined into `f` gains by it: mark closure and callees `#[inline(always)]`.
#[inline(always)]
pub fn vectorised<T>(f: impl FnOnce() -> T) -> T {
    #[cfg(target_arch = "x86_64")]
    if let Some(avx2) = fearless_simd::Level::new().as_avx2() {
        return fearless_simd::Simd::vectorize(avx2, f);
    }
    f()
}
