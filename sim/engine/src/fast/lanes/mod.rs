//! Vectors for whatever the processor has. Setup and rows compute on 64-bit words and double-precision numbers in their
//! bits ([`Lanes`]), pixels on the same or on [`singles::Singles`].
//!
//! | implementation | 64-bit words | chosen |
//! |---|--:|---|
//! | [`Portable`] | 8 | everywhere else; arrays that the compiler turns into NEON on aarch64 |
//! | [`avx2::Avx2`] | 4 | x86-64 that reports AVX2 |
//! | [`avx512::Avx512`] | 8 | x86-64 that reports AVX-512 F, BW, DQ, VL, CD and IFMA |
//!
//! A value of an x86 type is the proof that the processor has its instructions, because only detection makes one; that
//! is what makes the methods safe to call. [`dispatch_vectors`] runs a [`VectorTask`] on the widest of them, compiled
//! for it. What an implementation gives is one or two instructions for each method; the portable one is the definition,
//! and tests compare the others with it word for word.

/// An intrinsic on registers, never one that touches memory, or a function that is compiled for such. SAFETY of every
/// use: the vectors' value (`self`, `lanes`) proves that the processor has the instructions.
#[cfg(target_arch = "x86_64")]
macro_rules! op {
    ($call:expr) => {
        // SAFETY: see above.
        unsafe { $call }
    };
}

/// The operations that have the same shape at every level: the word, its casts to numbers and back, and an
/// instruction for each.
#[cfg(target_arch = "x86_64")]
macro_rules! arithmetic {
    ($word:ty, $to:ident, $from:ident, two: $($two:ident = $op2:ident),+; three: $($three:ident = $op3:ident),+) => {
        $(#[inline(always)]
        fn $two(self, a: $word, b: $word) -> $word {
            op!($from($op2($to(a), $to(b))))
        })+
        $(#[inline(always)]
        fn $three(self, a: $word, b: $word, c: $word) -> $word {
            op!($from($op3($to(a), $to(b), $to(c))))
        })+
    };
}

#[cfg(target_arch = "x86_64")]
pub mod avx2;
#[cfg(target_arch = "x86_64")]
pub mod avx512;
pub mod packed;
mod portable;
mod run;
pub mod singles;
pub mod words;

pub use portable::Portable;
pub use run::{
    VectorLevel, VectorTask, dispatch_pixels, dispatch_vectors, draws_pixels, has_vectors, name,
    prefetch,
};
pub use words::{Lanes, apart};

#[cfg(test)]
mod tests;
