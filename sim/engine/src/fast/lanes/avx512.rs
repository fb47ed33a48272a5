//! Proof that the processor has AVX-512. Sound for the reasons given in [`avx2`](super::avx2).

#![allow(unsafe_code)]

use super::VectorTask;
use super::fused::FusedTask;

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

#[target_feature(
    enable = "avx512f,avx512bw,avx512dq,avx512vl,avx512cd,avx512ifma,avx2,bmi1,bmi2,lzcnt,popcnt,fma"
)]
fn run_with<T: VectorTask>(lanes: Avx512, task: T) -> T::Output {
    task.run(lanes)
}

#[target_feature(
    enable = "avx512f,avx512bw,avx512dq,avx512vl,avx512cd,avx512ifma,avx2,bmi1,bmi2,lzcnt,popcnt,fma"
)]
fn run_fused_with<T: FusedTask>(lanes: Avx512, task: T) -> T::Output {
    task.run(lanes)
}

impl Avx512 {
    /// Runs a task compiled for this processor.
    #[inline(always)]
    pub fn run<T: VectorTask>(self, task: T) -> T::Output {
        // SAFETY: `self` proves that the processor has what the function is compiled for.
        unsafe { run_with(self, task) }
    }

    /// Runs a task with fused products compiled for this processor.
    #[inline(always)]
    pub fn run_fused<T: FusedTask>(self, task: T) -> T::Output {
        // SAFETY: `self` proves that the processor has what the function is compiled for.
        unsafe { run_fused_with(self, task) }
    }
}
