//! Vectors as arrays: the definition of the operations, and what processors without an implementation of their own use.

use super::{Lanes, ProductShift, VectorTask};

const WIDTH: usize = 8;

/// Arrays of eight words.
#[derive(Clone, Copy, Debug)]
pub struct Portable;

type PortableWords = [u32; WIDTH];

#[inline(always)]
fn zip(a: PortableWords, b: PortableWords, operation: impl Fn(u32, u32) -> u32) -> PortableWords {
    std::array::from_fn(|k| operation(a[k], b[k]))
}

impl Lanes for Portable {
    const WIDTH: usize = WIDTH;
    type Words = PortableWords;
    type Mask = [bool; WIDTH];
    type Count = u64;

    #[inline(always)]
    fn splat(self, value: u32) -> PortableWords {
        [value; WIDTH]
    }
    #[inline(always)]
    fn iota(self) -> PortableWords {
        std::array::from_fn(|k| k as u32)
    }
    #[inline(always)]
    fn load(self, from: &[u32]) -> PortableWords {
        from.first_chunk().copied().unwrap_or_default()
    }
    #[inline(always)]
    fn store(self, to: &mut [u32], value: PortableWords) {
        if let Some(to) = to.first_chunk_mut() {
            *to = value;
        }
    }
    #[inline(always)]
    fn add(self, a: PortableWords, b: PortableWords) -> PortableWords {
        zip(a, b, u32::wrapping_add)
    }
    #[inline(always)]
    fn sub(self, a: PortableWords, b: PortableWords) -> PortableWords {
        zip(a, b, u32::wrapping_sub)
    }
    #[inline(always)]
    fn mul(self, a: PortableWords, b: PortableWords) -> PortableWords {
        zip(a, b, u32::wrapping_mul)
    }
    #[inline(always)]
    fn shl(self, a: PortableWords, by: u32) -> PortableWords {
        a.map(|a| a << by)
    }
    #[inline(always)]
    fn shr(self, a: PortableWords, by: u32) -> PortableWords {
        a.map(|a| a >> by)
    }
    #[inline(always)]
    fn sar(self, a: PortableWords, by: u32) -> PortableWords {
        a.map(|a| ((a as i32) >> by) as u32)
    }
    #[inline(always)]
    fn and(self, a: PortableWords, b: PortableWords) -> PortableWords {
        zip(a, b, |a, b| a & b)
    }
    #[inline(always)]
    fn or(self, a: PortableWords, b: PortableWords) -> PortableWords {
        zip(a, b, |a, b| a | b)
    }
    #[inline(always)]
    fn max_signed(self, a: PortableWords, b: PortableWords) -> PortableWords {
        zip(a, b, |a, b| (a as i32).max(b as i32) as u32)
    }
    #[inline(always)]
    fn min_unsigned(self, a: PortableWords, b: PortableWords) -> PortableWords {
        zip(a, b, u32::min)
    }
    #[inline(always)]
    fn product(self, a: PortableWords, b: PortableWords, drop: ProductShift) -> PortableWords {
        zip(a, b, |a, b| {
            let product = u64::from(a) * u64::from(b);
            (product.wrapping_add(drop.half) >> drop.shift) as u32
        })
    }
    #[inline(always)]
    fn product_from(
        self,
        a: PortableWords,
        b: PortableWords,
        drop: ProductShift,
        least: u64,
    ) -> PortableWords {
        zip(a, b, |a, b| {
            let product = u64::from(a) * u64::from(b);
            let product = if product < least { 0 } else { product };
            (product.wrapping_add(drop.half) >> drop.shift) as u32
        })
    }
    #[inline(always)]
    fn signed_product(
        self,
        a: PortableWords,
        b: PortableWords,
        drop: ProductShift,
    ) -> PortableWords {
        zip(a, b, |a, b| {
            let product = i64::from(a as i32) * i64::from(b as i32);
            (product.wrapping_add(drop.half as i64) >> drop.shift) as u32
        })
    }
    #[inline(always)]
    fn gather(self, table: &[u32], index: PortableWords, mask: Self::Mask) -> PortableWords {
        std::array::from_fn(|k| {
            let place = (index[k] as usize).min(table.len().saturating_sub(1));
            let entry = table.get(place).copied().unwrap_or(0);
            if mask[k] { entry } else { 0 }
        })
    }
    #[inline(always)]
    fn greater(self, a: PortableWords, b: PortableWords) -> Self::Mask {
        std::array::from_fn(|k| (a[k] as i32) > b[k] as i32)
    }
    #[inline(always)]
    fn first(self, count: usize) -> Self::Mask {
        std::array::from_fn(|k| k < count)
    }
    #[inline(always)]
    fn both(self, a: Self::Mask, b: Self::Mask) -> Self::Mask {
        std::array::from_fn(|k| a[k] & b[k])
    }
    #[inline(always)]
    fn except(self, a: Self::Mask, b: Self::Mask) -> Self::Mask {
        std::array::from_fn(|k| a[k] & !b[k])
    }
    #[inline(always)]
    fn negative(self, a: PortableWords) -> Self::Mask {
        a.map(|a| (a as i32) < 0)
    }
    #[inline(always)]
    fn is_none(self, a: Self::Mask) -> bool {
        !a.iter().any(|a| *a)
    }
    #[inline(always)]
    fn clear(self, a: PortableWords, mask: Self::Mask) -> PortableWords {
        std::array::from_fn(|k| if mask[k] { 0 } else { a[k] })
    }
    #[inline(always)]
    fn select(self, a: PortableWords, b: PortableWords, mask: Self::Mask) -> PortableWords {
        std::array::from_fn(|k| if mask[k] { b[k] } else { a[k] })
    }
    #[inline(always)]
    fn no_count(self) -> u64 {
        0
    }
    #[inline(always)]
    fn count(self, count: u64, mask: Self::Mask) -> u64 {
        count + mask.iter().map(|m| u64::from(*m)).sum::<u64>()
    }
    #[inline(always)]
    fn total(self, count: u64) -> u64 {
        count
    }
    #[inline(always)]
    fn run<T: VectorTask>(self, task: T) -> T::Output {
        task.run(self)
    }
}
