//! Vectors for whatever the processor has. Setup computes on 64-bit words ([`Wide`]) and double-precision numbers
//! ([`Doubles`]), pixels on [`words::PixelWords`] and [`singles::Singles`], sums of a surface's pixels on
//! [`sums::PixelSums`].
//!
//! | implementation | 64-bit words | chosen |
//! |---|--:|---|
//! | [`Portable`] | 8 | everywhere else; arrays that the compiler turns into NEON on aarch64 |
//! | [`avx2::Avx2`] | 4 | x86-64 that reports AVX2 |
//! | [`avx512::Avx512`] | 8 | x86-64 that reports AVX-512 F, BW, DQ, VL, CD and IFMA |
//!
//! A value of an x86 type is the proof that the processor has its instructions, because only detection makes one; that
//! is what makes the methods safe to call. [`dispatch_vectors`] runs a [`VectorTask`] on the widest of them, compiled
//! for it. Every method is one or two instructions; the portable implementation is their definition, and tests compare
//! the others with it word for word.

/// An intrinsic on registers, never one that touches memory, or a function that is compiled for such. SAFETY of every
/// use: the vectors' value (`self`, `lanes`) proves that the processor has the instructions.
#[cfg(target_arch = "x86_64")]
macro_rules! op {
    ($call:expr) => {
        // SAFETY: see above.
        unsafe { $call }
    };
}

#[cfg(target_arch = "x86_64")]
pub mod avx2;
#[cfg(target_arch = "x86_64")]
pub mod avx512;
mod doubles;
pub mod packed;
mod portable;
mod run;
pub mod singles;
pub mod sums;
mod wide;
pub mod words;

pub use doubles::Doubles;
pub use portable::Portable;
pub use run::{
    VectorLevel, VectorTask, dispatch_pixels, dispatch_vectors, draws_pixels, has_vectors, name,
    prefetch,
};
pub use wide::{Wide, apart};

#[cfg(test)]
mod tests;
