//! Proof that the processor has AVX2.
//!
//! Two reasons make the `unsafe` code sound, here and in the siblings that build on [`Avx2`] and `Avx512`:
//! a value of [`Avx2`] exists only after detection, so every intrinsic finds its instruction; and the operations that
//! touch memory (load, store, gather) are given a checked array or an index that has been brought into the table.

/// Proof that the processor has AVX2, BMI, LZCNT, POPCNT and FMA.
#[derive(Clone, Copy, Debug)]
pub struct Avx2(());

impl Avx2 {
    /// The proof, if the processor has all of it.
    #[inline]
    pub fn detect() -> Option<Self> {
        let all = is_x86_feature_detected!("avx2")
            && is_x86_feature_detected!("bmi1")
            && is_x86_feature_detected!("bmi2")
            && is_x86_feature_detected!("lzcnt")
            && is_x86_feature_detected!("popcnt")
            && is_x86_feature_detected!("fma");
        all.then_some(Avx2(()))
    }
}
