//! Vectors of 32-bit words: the few operations that the pixel path needs, for whatever the processor has. Those of 64-bit words are in
//! [`Wide`] and [`fused::Fused`], those of a cell of sixteen short words in [`narrow::Narrow`].
//!
//! | implementation | words | chosen |
//! |---|--:|---|
//! | [`Portable`] | 8 | everywhere else; arrays that the compiler turns into NEON on aarch64 |
//! | [`avx2::Avx2`] | 8 | x86-64 that reports AVX2 |
//! | [`avx512::Avx512`] | 16 | x86-64 that reports AVX-512 F, BW, DQ, VL, CD and IFMA |
//!
//! A value of an x86 type is the proof that the processor has its instructions, because only detection makes one; that is what makes the
//! methods safe to call. [`dispatch`] runs a [`VectorTask`] on the widest of them, compiled for it. Every method is one or two instructions;
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
mod floats;
pub mod fused;
pub mod narrow;
mod portable;
pub mod sums;
mod wide;
pub mod words;

pub use doubles::Doubles;
pub use floats::Floats;
pub use portable::Portable;
pub use wide::Wide;

use std::str::FromStr;

/// How a product is brought back to 32 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ProductShift {
    /// Bits dropped at the low end, 1 to 63.
    pub shift: u32,
    /// Added before the shift: half of `2^shift`, or 0 to truncate.
    pub half: u64,
    /// Do product and half fit 32 bits?
    pub narrow: bool,
}

/// Operations on vectors of [`Lanes::WIDTH`] words. Arithmetic wraps.
pub trait Lanes: Doubles {
    /// Words of a vector.
    const WIDTH: usize;
    /// A vector.
    type Words: Copy;
    /// One truth value per word.
    type Mask: Copy;
    /// Counters of truth values.
    type Count: Copy;

    /// The same word everywhere.
    fn splat(self, value: u32) -> Self::Words;
    /// 0, 1, 2, ...
    fn iota(self) -> Self::Words;
    /// The first words of `from`, which must have [`Lanes::WIDTH`] of them; zeros if it has not.
    fn load(self, from: &[u32]) -> Self::Words;
    /// Stores into the first words of `to`; nothing if it has fewer than [`Lanes::WIDTH`].
    fn store(self, to: &mut [u32], value: Self::Words);
    /// a + b.
    fn add(self, a: Self::Words, b: Self::Words) -> Self::Words;
    /// a - b.
    fn sub(self, a: Self::Words, b: Self::Words) -> Self::Words;
    /// Low half of a b.
    fn mul(self, a: Self::Words, b: Self::Words) -> Self::Words;
    /// a << by, by < 32.
    fn shl(self, a: Self::Words, by: u32) -> Self::Words;
    /// a >> by, by < 32.
    fn shr(self, a: Self::Words, by: u32) -> Self::Words;
    /// a >> by as signed words, by < 32.
    fn sar(self, a: Self::Words, by: u32) -> Self::Words;
    /// a & b.
    fn and(self, a: Self::Words, b: Self::Words) -> Self::Words;
    /// a | b.
    fn or(self, a: Self::Words, b: Self::Words) -> Self::Words;
    /// The larger signed word.
    fn max_signed(self, a: Self::Words, b: Self::Words) -> Self::Words;
    /// The smaller unsigned word.
    fn min_unsigned(self, a: Self::Words, b: Self::Words) -> Self::Words;
    /// `(a b + half) >> shift` in 64 bits, low word: the product of the pixel path.
    fn product(self, a: Self::Words, b: Self::Words, drop: ProductShift) -> Self::Words;
    /// The same, 0 where the product, which must be below 2^63, or 2^31 if it is narrow, is less than `least`.
    fn product_from(
        self,
        a: Self::Words,
        b: Self::Words,
        drop: ProductShift,
        least: u64,
    ) -> Self::Words;
    /// The product with signed words; the shift is at most 32.
    fn signed_product(self, a: Self::Words, b: Self::Words, drop: ProductShift) -> Self::Words;
    /// `table[index]` where the mask holds, the table's last entry for an unsigned index beyond it; 0 elsewhere, and of an empty table.
    fn gather(self, table: &[u32], index: Self::Words, mask: Self::Mask) -> Self::Words;

    /// a > b as signed words.
    fn greater(self, a: Self::Words, b: Self::Words) -> Self::Mask;
    /// The first `count` words.
    fn first(self, count: usize) -> Self::Mask;
    /// Both.
    fn both(self, a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// a and not b.
    fn except(self, a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// Words whose most significant bit is set.
    fn negative(self, a: Self::Words) -> Self::Mask;
    /// Is it nowhere true?
    fn is_none(self, a: Self::Mask) -> bool;
    /// a where the mask does not hold, 0 where it does.
    fn clear(self, a: Self::Words, mask: Self::Mask) -> Self::Words;
    /// `b` where the mask holds, else `a`.
    fn select(self, a: Self::Words, b: Self::Words, mask: Self::Mask) -> Self::Words;

    /// No truth value counted yet.
    fn no_count(self) -> Self::Count;
    /// Counts the true ones; at most 2^31 per word.
    fn count(self, count: Self::Count, mask: Self::Mask) -> Self::Count;
    /// Number of true ones counted.
    fn total(self, count: Self::Count) -> u64;

    /// Runs a task compiled for this processor.
    fn run<T: VectorTask>(self, task: T) -> T::Output;
}

/// Work that is generic over the vectors. Implement `run` and all that it calls with `#[inline(always)]`, or it is not compiled for
/// the instructions it needs.
pub trait VectorTask {
    /// The result.
    type Output;
    /// The work.
    fn run<L: Floats>(self, lanes: L) -> Self::Output;
}

/// Which vectors to use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VectorLevel {
    /// The best that the processor has.
    Best,
    /// At most 8 words: AVX2 or portable.
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

/// Runs the task on the vectors chosen.
#[inline]
pub fn dispatch<T: VectorTask>(choice: VectorLevel, task: T) -> T::Output {
    match dispatch_vectors(choice, task) {
        Ok(output) => output,
        Err(task) => Portable.run(task),
    }
}

/// The same, but for processors without these vectors, which get the task back: on arrays some work is slower than the kernel's. Arrays count as
/// vectors where the compiler knows the processor's own.
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
        _ => Ok(Portable.run(task)),
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

/// Name of the vectors that [`dispatch`] uses.
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
