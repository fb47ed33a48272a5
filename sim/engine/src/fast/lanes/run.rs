//! Work that is generic over the vectors, and what runs it on those that the processor has, compiled for them.

#![allow(unsafe_code)]

use super::words::Lanes;
use std::str::FromStr;

/// Work that is generic over the vectors. Implement `run` and all that it calls with `#[inline(always)]`, or it is not
/// compiled for the instructions it needs.
pub trait VectorTask {
    /// The result.
    type Output;
    /// The work.
    fn run<L: Lanes>(self, lanes: L) -> Self::Output;
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
    /// The levels that this processor tells apart, by their names on the command line: what most people's processors
    /// have comes first.
    pub fn levels() -> Vec<(&'static str, VectorLevel)> {
        let mut levels = Vec::new();
        #[cfg(target_arch = "x86_64")]
        {
            if super::avx2::Avx2::detect().is_some() {
                levels.push(("avx2", VectorLevel::Avx2));
            }
            if super::avx512::Avx512::detect().is_some() {
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

/// Runs the task on the vectors chosen. Processors without these vectors get the task back: on arrays some work is
/// slower than the kernel's. Arrays count as vectors where the compiler knows the processor's own.
#[inline]
pub fn dispatch_vectors<T: VectorTask>(choice: VectorLevel, task: T) -> Result<T::Output, T> {
    #[cfg(target_arch = "x86_64")]
    {
        if choice == VectorLevel::Best
            && let Some(lanes) = super::avx512::Avx512::detect()
        {
            return Ok(op!(x86::run_on_avx512(lanes, task)));
        }
        if choice != VectorLevel::Portable
            && let Some(lanes) = super::avx2::Avx2::detect()
        {
            return Ok(op!(x86::run_on_avx2(lanes, task)));
        }
        Err(task)
    }
    #[cfg(not(target_arch = "x86_64"))]
    match choice {
        VectorLevel::Portable => Err(task),
        _ => Ok(task.run(super::Portable)),
    }
}

/// Are vectors faster than the kernel's painter here? On x86-64 without AVX2 they are not: its baseline has neither
/// gathers nor products of signed words.
pub fn has_vectors() -> bool {
    #[cfg(target_arch = "x86_64")]
    return super::avx2::Avx2::detect().is_some();
    #[cfg(not(target_arch = "x86_64"))]
    true
}

/// Name of the vectors that [`dispatch_vectors`] uses.
pub fn name(choice: VectorLevel) -> &'static str {
    #[cfg(target_arch = "x86_64")]
    {
        if choice == VectorLevel::Best && super::avx512::Avx512::detect().is_some() {
            return "AVX-512";
        }
        if choice != VectorLevel::Portable && super::avx2::Avx2::detect().is_some() {
            return "AVX2";
        }
    }
    let _ = choice;
    "portable"
}

/// The same for work on pixels. Without AVX2 the kernel's painter is faster than arrays, so that x86-64 gets the task
/// back; other processors draw by arrays, and so do tests.
#[inline]
pub fn dispatch_pixels<T: VectorTask>(choice: VectorLevel, task: T) -> Result<T::Output, T> {
    let done = dispatch_vectors(choice, task);
    #[cfg(any(test, not(target_arch = "x86_64")))]
    return done.or_else(|task| Ok(task.run(super::Portable)));
    #[cfg(not(any(test, not(target_arch = "x86_64"))))]
    done
}

/// Does [`dispatch_pixels`] run tasks on this level?
pub fn draws_pixels(choice: VectorLevel) -> bool {
    cfg!(test)
        || has_vectors() && (cfg!(not(target_arch = "x86_64")) || choice != VectorLevel::Portable)
}

/// Asks for memory that will be read soon.
#[inline(always)]
pub fn prefetch<T>(place: &T) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        let first = std::ptr::from_ref(place).cast::<i8>();
        let last = size_of::<T>().saturating_sub(1);
        let mut byte = 0;
        loop {
            // SAFETY: asking for memory never faults; the byte lies in the same object as the first.
            unsafe { _mm_prefetch::<_MM_HINT_T0>(first.add(byte)) };
            if byte == last {
                break;
            }
            byte = (byte + 64).min(last);
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = place;
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::super::avx2::Avx2;
    use super::super::avx512::Avx512;
    use super::VectorTask;

    #[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt,fma")]
    pub fn run_on_avx2<T: VectorTask>(lanes: Avx2, task: T) -> T::Output {
        task.run(lanes)
    }

    #[target_feature(
        enable = "avx512f,avx512bw,avx512dq,avx512vl,avx512cd,avx512ifma,avx2,bmi1,bmi2,lzcnt,popcnt,fma"
    )]
    pub fn run_on_avx512<T: VectorTask>(lanes: Avx512, task: T) -> T::Output {
        task.run(lanes)
    }
}
