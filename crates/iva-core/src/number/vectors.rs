//! Loops over lanes in the widest vectors of the machine.
//!
//! All code is compiled for AVX2 and the fused multiply-add (`.cargo/config.toml`), vectors of four doubles. Where a
//! machine has AVX-512, loops over lanes take eight at a time. Each operation is rounded alike in both, so results
//! have the same bits.
//!
//! The only unsafe code of the core stands here: a function for AVX-512 may be called only where there is AVX-512.
#![allow(unsafe_code)]

/// Runs code, which must be inlined (`#[inline(always)]` before its `||`), with AVX-512 where the machine has it.
#[cfg(target_arch = "x86_64")]
#[inline]
pub(crate) fn in_vectors<T>(code: impl FnOnce() -> T) -> T {
    let has_avx512 = std::is_x86_feature_detected!("avx512f")
        && std::is_x86_feature_detected!("avx512bw")
        && std::is_x86_feature_detected!("avx512cd")
        && std::is_x86_feature_detected!("avx512dq")
        && std::is_x86_feature_detected!("avx512vl");
    if has_avx512 {
        // SAFETY: all features that `with_avx512` is compiled for have just been found.
        return unsafe { with_avx512(code) };
    }
    code()
}

/// Other machines have one width of vectors.
#[cfg(not(target_arch = "x86_64"))]
#[inline(always)]
pub(crate) fn in_vectors<T>(code: impl FnOnce() -> T) -> T {
    code()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
fn with_avx512<T>(code: impl FnOnce() -> T) -> T {
    code()
}
