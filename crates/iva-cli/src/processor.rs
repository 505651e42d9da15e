//! What the native binary needs of a processor.

/// What is told where it is missing.
#[cfg(target_arch = "x86_64")]
const NEEDS: &str =
    "iva needs a processor with AVX2 and FMA (x86-64-v3: Intel since 2013, AMD since 2015)";

/// `None` if the machine has the instructions that all code is compiled for, else one sentence.
#[cfg(target_arch = "x86_64")]
pub fn lacking() -> Option<&'static str> {
    // `is_x86_feature_detected` believes what the compiler was told.
    let leaf = std::arch::x86_64::__cpuid_count;
    let (first, seventh) = (leaf(1, 0).ecx, leaf(7, 0).ebx);
    let has = |register: u32, bits: &[u32]| bits.iter().all(|bit| register >> bit & 1 == 1);
    // FMA, MOVBE, OSXSAVE, AVX, F16C; BMI1, AVX2, BMI2
    let whole = has(first, &[12, 22, 27, 28, 29]) && has(seventh, &[3, 5, 8]);
    if whole { None } else { Some(NEEDS) }
}

/// `None`: all machines of this kind have them.
#[cfg(not(target_arch = "x86_64"))]
pub fn lacking() -> Option<&'static str> {
    None
}
