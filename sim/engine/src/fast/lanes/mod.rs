//! Vectors for whatever the processor has. Setup computes on 64-bit words ([`Wide`]) and double-precision numbers ([`Doubles`]), pixels on
//! [`words::PixelWords`], [`fused::Fused`] and, for cells of sixteen short words, [`narrow::Narrow`].
//!
//! | implementation | 64-bit words | chosen |
//! |---|--:|---|
//! | [`Portable`] | 8 | everywhere else; arrays that the compiler turns into NEON on aarch64 |
//! | [`avx2::Avx2`] | 4 | x86-64 that reports AVX2 |
//! | [`avx512::Avx512`] | 8 | x86-64 that reports AVX-512 F, BW, DQ, VL, CD and IFMA |
//!
//! A value of an x86 type is the proof that the processor has its instructions, because only detection makes one; that is what makes the
//! methods safe to call. [`dispatch_vectors`] runs a [`VectorTask`] on the widest of them, compiled for it. Every method is one or two instructions;
//! the portable implementation is their definition, and tests compare the others with it word for word.

/// An intrinsic on registers, never one that touches memory. SAFETY of every use: `self` proves that the processor has the instruction.
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
pub mod factors;
pub mod fused;
pub mod narrow;
pub mod sums;
mod wide;
pub mod words;

pub use doubles::Doubles;
pub use wide::Wide;

use std::str::FromStr;

/// Vectors as arrays: the definition of the operations, and what processors without an implementation of their own use.
#[derive(Clone, Copy, Debug)]
pub struct Portable;

/// Work that is generic over the vectors. Implement `run` and all that it calls with `#[inline(always)]`, or it is not compiled for
/// the instructions it needs.
pub trait VectorTask {
    /// The result.
    type Output;
    /// The work.
    fn run<L: Doubles>(self, lanes: L) -> Self::Output;
}

/// Which vectors to use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VectorLevel {
    /// The best that the processor has.
    Best,
    /// At most 256 bits: AVX2 or portable.
    Avx2,
    /// Portable arrays.
    Portable,
}

impl VectorLevel {
    /// The levels that this processor tells apart, by their names on the command line: what most people's processors have comes first.
    pub fn levels() -> Vec<(&'static str, VectorLevel)> {
        let mut levels = Vec::new();
        #[cfg(target_arch = "x86_64")]
        {
            if avx2::Avx2::detect().is_some() {
                levels.push(("avx2", VectorLevel::Avx2));
            }
            if avx512::Avx512::detect().is_some() {
                levels.push(("avx512", VectorLevel::Best));
            }
        }
        levels.push(("portable", VectorLevel::Portable));
        levels
    }
}

impl FromStr for VectorLevel {
    type Err = String;

    /// A level by its name; the error says what this processor has.
    fn from_str(name: &str) -> Result<Self, String> {
        let levels = VectorLevel::levels();
        if let Some((_, choice)) = levels.iter().find(|(known, _)| *known == name) {
            return Ok(*choice);
        }
        let known: Vec<&str> = levels.iter().map(|(name, _)| *name).collect();
        let here = known.join(", ");
        if ["avx2", "avx512"].contains(&name) {
            Err(format!("this processor has no {name}: give one of {here}"))
        } else {
            Err(format!("there are no vectors '{name}': give one of {here}"))
        }
    }
}

/// Runs the task on the vectors chosen. Processors without these vectors get the task back: on arrays some work is slower than the kernel's.
/// Arrays count as vectors where the compiler knows the processor's own.
#[inline]
pub fn dispatch_vectors<T: VectorTask>(choice: VectorLevel, task: T) -> Result<T::Output, T> {
    #[cfg(target_arch = "x86_64")]
    {
        if choice == VectorLevel::Best
            && let Some(lanes) = avx512::Avx512::detect()
        {
            return Ok(lanes.run(task));
        }
        if choice != VectorLevel::Portable
            && let Some(lanes) = avx2::Avx2::detect()
        {
            return Ok(lanes.run(task));
        }
        Err(task)
    }
    #[cfg(not(target_arch = "x86_64"))]
    match choice {
        VectorLevel::Portable => Err(task),
        _ => Ok(task.run(Portable)),
    }
}

/// Are vectors faster than the kernel's painter here? On x86-64 without AVX2 they are not: its baseline has neither gathers nor products of
/// signed words.
pub fn has_vectors() -> bool {
    #[cfg(target_arch = "x86_64")]
    return avx2::Avx2::detect().is_some();
    #[cfg(not(target_arch = "x86_64"))]
    true
}

/// Asks for memory that will be read soon.
#[allow(unsafe_code)]
#[inline(always)]
pub fn prefetch<T>(place: &T) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        let first = std::ptr::from_ref(place).cast::<i8>();
        let last = size_of::<T>().saturating_sub(1);
        for byte in (0..last).step_by(64).chain([last]) {
            // SAFETY: asking for memory never faults; the byte lies in the same object as the first.
            unsafe { _mm_prefetch::<_MM_HINT_T0>(first.add(byte)) };
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = place;
}

/// Name of the vectors that [`dispatch_vectors`] uses.
pub fn name(choice: VectorLevel) -> &'static str {
    #[cfg(target_arch = "x86_64")]
    {
        if choice == VectorLevel::Best && avx512::Avx512::detect().is_some() {
            return "AVX-512";
        }
        if choice != VectorLevel::Portable && avx2::Avx2::detect().is_some() {
            return "AVX2";
        }
    }
    let _ = choice;
    "portable"
}

#[cfg(test)]
mod tests;
