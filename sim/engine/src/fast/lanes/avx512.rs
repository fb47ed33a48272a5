//! Proof that the processor has AVX-512. Sound for the reasons given in [`avx2`](super::avx2).

/// Proof that the processor has AVX-512 F, BW, DQ, VL, CD and IFMA and all that AVX2 processors have.
#[derive(Clone, Copy, Debug)]
pub struct Avx512(());

impl Avx512 {
    /// The proof, if the processor has all of it.
    #[inline]
    pub fn detect() -> Option<Self> {
        let all = super::avx2::Avx2::detect().is_some()
            && is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512bw")
            && is_x86_feature_detected!("avx512dq")
            && is_x86_feature_detected!("avx512vl")
            && is_x86_feature_detected!("avx512cd")
            && is_x86_feature_detected!("avx512ifma");
        all.then_some(Avx512(()))
    }
}
