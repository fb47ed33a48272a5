//! Proof that the processor has AVX-512. Sound for the reasons given in [`avx2`](super::avx2).

use super::avx2::Avx2;

/// Proof that the processor has AVX-512 F, BW, DQ, VL, CD and IFMA and all that AVX2 processors have. No
/// vector needs IFMA: it tells apart older processors, which lower their clock for 512 bits and were not measured.
#[derive(Clone, Copy, Debug)]
pub struct Avx512(Avx2);

impl Avx512 {
    /// The proof, if the processor has all of it.
    #[inline]
    pub fn detect() -> Option<Self> {
        let all = is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512bw")
            && is_x86_feature_detected!("avx512dq")
            && is_x86_feature_detected!("avx512vl")
            && is_x86_feature_detected!("avx512cd")
            && is_x86_feature_detected!("avx512ifma");
        Avx2::detect().filter(|_| all).map(Avx512)
    }

    /// The vectors of 256 bits that it has as well.
    #[inline(always)]
    pub fn avx2(self) -> Avx2 {
        self.0
    }
}
