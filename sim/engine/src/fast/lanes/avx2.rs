//! Proof that the processor has AVX2.
//!
//! Two reasons make the `unsafe` code sound, here and in the siblings that build on [`Avx2`] and `Avx512`:
//! a value of [`Avx2`] exists only after detection, so every intrinsic finds its instruction; and the operations that
//! touch memory (load, store, gather) are given a checked array or an index that has been brought into the table.

#![allow(unsafe_code)]

use super::VectorTask;
use super::words::PixelTask;

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

#[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt,fma")]
fn run_with<T: VectorTask>(lanes: Avx2, task: T) -> T::Output {
    task.run(lanes)
}

#[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt,fma")]
fn run_pixels_with<T: PixelTask>(lanes: Avx2, task: T) -> T::Output {
    task.run(lanes)
}

impl Avx2 {
    /// Runs a task compiled for this processor.
    #[inline(always)]
    pub fn run<T: VectorTask>(self, task: T) -> T::Output {
        // SAFETY: `self` proves that the processor has what the function is compiled for.
        unsafe { run_with(self, task) }
    }

    /// Runs a task on pixels compiled for this processor.
    #[inline(always)]
    pub fn run_pixels<T: PixelTask>(self, task: T) -> T::Output {
        // SAFETY: `self` proves that the processor has what the function is compiled for.
        unsafe { run_pixels_with(self, task) }
    }
}
