//! Vectors as arrays.

use super::words::{Entries, Lanes, ShareShift, Sums};

/// Vectors as arrays: the definition of the operations, and what processors without an implementation of their own use.
/// Tests need not have its operations inlined, which took half of the time in which they compile and saved 2 of 16
/// seconds in which they run.
#[derive(Clone, Copy, Debug)]
pub struct Portable;

/// Eight words of 64 bits as an array.
type Words = [i64; 8];

#[inline(always)]
fn zip(a: Words, b: Words, operation: impl Fn(i64, i64) -> i64) -> Words {
    std::array::from_fn(|k| operation(a[k], b[k]))
}

/// A shift amount, if it is one.
#[inline(always)]
fn amount(by: i64) -> Option<u32> {
    u32::try_from(by).ok().filter(|by| *by < 64)
}

#[inline(always)]
fn double(bits: i64) -> f64 {
    f64::from_bits(bits as u64)
}

#[inline(always)]
fn zip_doubles(a: Words, b: Words, operation: impl Fn(f64, f64) -> f64) -> Words {
    std::array::from_fn(|k| operation(double(a[k]), double(b[k])).to_bits() as i64)
}

#[inline(always)]
fn fused(a: Words, b: Words, c: [f64; 8]) -> Words {
    std::array::from_fn(|k| double(a[k]).mul_add(double(b[k]), c[k]).to_bits() as i64)
}

/// A pixel's last sum ends here.
const FULL: u32 = 1 << 31;

impl Lanes for Portable {
    const WIDE: usize = 8;
    /// Where arrays are there to be compared with, on x86-64 and in tests: an operation is ten times the instructions
    /// of a vector's.
    const ROWS_APART: bool = cfg!(any(target_arch = "x86_64", test));
    type Word = Words;
    type Truth = [bool; 8];
    type Attributes = ([i32; 8], ShareShift);
    type Singles = Portable;

    #[cfg_attr(not(test), inline(always))]
    fn splat(self, value: i64) -> Words {
        [value; 8]
    }
    #[cfg_attr(not(test), inline(always))]
    fn load(self, from: &[i64; 8]) -> Words {
        *from
    }
    #[cfg_attr(not(test), inline(always))]
    fn columns(self, row: impl Fn(usize) -> [i32; 4]) -> [Words; 4] {
        let rows: [[i32; 4]; 8] = std::array::from_fn(row);
        std::array::from_fn(|column| rows.map(|row| row[column].into()))
    }
    #[cfg_attr(not(test), inline(always))]
    fn rows(self, columns: [Words; 4]) -> [[i32; 4]; 8] {
        std::array::from_fn(|k| columns.map(|word| word[k] as i32))
    }
    #[cfg_attr(not(test), inline(always))]
    fn store(self, to: &mut [i64; 8], value: Words) {
        *to = value;
    }
    #[cfg_attr(not(test), inline(always))]
    fn add(self, a: Words, b: Words) -> Words {
        zip(a, b, i64::wrapping_add)
    }
    #[cfg_attr(not(test), inline(always))]
    fn sub(self, a: Words, b: Words) -> Words {
        zip(a, b, i64::wrapping_sub)
    }
    #[cfg_attr(not(test), inline(always))]
    fn and(self, a: Words, b: Words) -> Words {
        zip(a, b, |a, b| a & b)
    }
    #[cfg_attr(not(test), inline(always))]
    fn or(self, a: Words, b: Words) -> Words {
        zip(a, b, |a, b| a | b)
    }
    #[cfg_attr(not(test), inline(always))]
    fn xor(self, a: Words, b: Words) -> Words {
        zip(a, b, |a, b| a ^ b)
    }
    #[cfg_attr(not(test), inline(always))]
    fn mul(self, a: Words, b: Words) -> Words {
        zip(a, b, |a, b| i64::from(a as i32) * i64::from(b as i32))
    }
    #[cfg_attr(not(test), inline(always))]
    fn mul_whole(self, a: Words, b: Words) -> Words {
        zip(a, b, i64::wrapping_mul)
    }
    #[cfg_attr(not(test), inline(always))]
    fn shl(self, a: Words, by: Words) -> Words {
        zip(a, by, |a, by| amount(by).map_or(0, |by| a << by))
    }
    #[cfg_attr(not(test), inline(always))]
    fn sar(self, a: Words, by: Words) -> Words {
        zip(a, by, |a, by| a >> amount(by).unwrap_or(63))
    }
    #[cfg_attr(not(test), inline(always))]
    fn leading_zeros(self, a: Words) -> Words {
        a.map(|a| a.leading_zeros().into())
    }
    #[cfg_attr(not(test), inline(always))]
    fn mul_unsigned(self, a: Words, b: Words) -> Words {
        zip(a, b, |a, b| {
            (u64::from(a as u32) * u64::from(b as u32)) as i64
        })
    }
    #[cfg_attr(not(test), inline(always))]
    fn shr(self, a: Words, by: Words) -> Words {
        zip(a, by, |a, by| {
            amount(by).map_or(0, |by| (a as u64 >> by) as i64)
        })
    }
    #[cfg_attr(not(test), inline(always))]
    fn pairs(self, table: Entries, index: Words) -> Words {
        let (entries, last) = table.to_last();
        index.map(|index| {
            let first = (index as u32).min(last) as usize;
            i64::from(entries[first]) | i64::from(entries[first + 1]) << 32
        })
    }
    #[cfg_attr(not(test), inline(always))]
    fn greater(self, a: Words, b: Words) -> [bool; 8] {
        std::array::from_fn(|k| a[k] > b[k])
    }
    #[cfg_attr(not(test), inline(always))]
    fn equal(self, a: Words, b: Words) -> [bool; 8] {
        std::array::from_fn(|k| a[k] == b[k])
    }
    #[cfg_attr(not(test), inline(always))]
    fn select(self, a: Words, b: Words, truth: [bool; 8]) -> Words {
        std::array::from_fn(|k| if truth[k] { b[k] } else { a[k] })
    }
    #[cfg_attr(not(test), inline(always))]
    fn any(self, a: Words) -> bool {
        a.iter().any(|a| *a != 0)
    }
    #[cfg_attr(not(test), inline(always))]
    fn flags(self, truth: [bool; 8]) -> u32 {
        let bits = truth.iter().enumerate();
        bits.fold(0, |all, (k, truth)| all | u32::from(*truth) << k)
    }
    #[cfg_attr(not(test), inline(always))]
    fn singles(self) -> Portable {
        self
    }
    #[cfg_attr(not(test), inline(always))]
    fn double_add(self, a: Words, b: Words) -> Words {
        zip_doubles(a, b, |a, b| a + b)
    }
    #[cfg_attr(not(test), inline(always))]
    fn double_sub(self, a: Words, b: Words) -> Words {
        zip_doubles(a, b, |a, b| a - b)
    }
    #[cfg_attr(not(test), inline(always))]
    fn double_mul(self, a: Words, b: Words) -> Words {
        zip_doubles(a, b, |a, b| a * b)
    }
    #[cfg_attr(not(test), inline(always))]
    fn double_min(self, a: Words, b: Words) -> Words {
        zip_doubles(a, b, |a, b| if a < b { a } else { b })
    }
    #[cfg_attr(not(test), inline(always))]
    fn double_max(self, a: Words, b: Words) -> Words {
        zip_doubles(a, b, |a, b| if a > b { a } else { b })
    }
    #[cfg_attr(not(test), inline(always))]
    fn double_floor(self, a: Words) -> Words {
        a.map(|a| double(a).floor().to_bits() as i64)
    }
    #[cfg_attr(not(test), inline(always))]
    fn double_root(self, a: Words) -> Words {
        a.map(|a| double(a).sqrt().to_bits() as i64)
    }
    #[cfg_attr(not(test), inline(always))]
    fn double_mul_add(self, a: Words, b: Words, c: Words) -> Words {
        fused(a, b, c.map(double))
    }
    #[cfg_attr(not(test), inline(always))]
    fn double_mul_sub(self, a: Words, b: Words, c: Words) -> Words {
        fused(a, b, c.map(|c| -double(c)))
    }
    #[cfg_attr(not(test), inline(always))]
    fn double_greater(self, a: Words, b: Words) -> [bool; 8] {
        std::array::from_fn(|k| double(a[k]) > double(b[k]))
    }
    #[cfg_attr(not(test), inline(always))]
    fn halves(self, low: Words, high: Words) -> Words {
        std::array::from_fn(|k| low[k] & 0xffff_ffff | high[k] & !0xffff_ffff)
    }
    #[cfg_attr(not(test), inline(always))]
    fn add_halves(self, a: Words, b: Words) -> Words {
        self.halves(self.add(a, b), self.add(a, b.map(|b| b & !0xffff_ffff)))
    }
    #[cfg_attr(not(test), inline(always))]
    fn marked(self, a: Words) -> [bool; 8] {
        a.map(|a| a < 0)
    }
    #[cfg_attr(not(test), inline(always))]
    fn first(self, count: usize) -> [bool; 8] {
        std::array::from_fn(|k| k < count)
    }
    #[cfg_attr(not(test), inline(always))]
    fn both(self, a: [bool; 8], b: [bool; 8]) -> [bool; 8] {
        std::array::from_fn(|k| a[k] && b[k])
    }
    #[cfg_attr(not(test), inline(always))]
    fn except(self, a: [bool; 8], b: [bool; 8]) -> [bool; 8] {
        std::array::from_fn(|k| a[k] && !b[k])
    }
    #[cfg_attr(not(test), inline(always))]
    fn keep(self, a: Words, truth: [bool; 8]) -> Words {
        std::array::from_fn(|k| if truth[k] { a[k] } else { 0 })
    }
    #[cfg_attr(not(test), inline(always))]
    fn clear(self, a: Words, truth: [bool; 8]) -> Words {
        std::array::from_fn(|k| if truth[k] { 0 } else { a[k] })
    }
    #[cfg_attr(not(test), inline(always))]
    fn min_short(self, a: Words, b: Words) -> Words {
        std::array::from_fn(|k| a[k].min(b[k]))
    }
    #[cfg_attr(not(test), inline(always))]
    fn multiples(self, a: Words) -> Words {
        std::array::from_fn(|k| a[k].wrapping_mul(k as i64))
    }
    #[cfg_attr(not(test), inline(always))]
    fn attributes(self, values: &[i32; 8], shift: ShareShift) -> Self::Attributes {
        (*values, shift)
    }

    #[cfg_attr(not(test), inline(always))]
    fn add_shares(self, sums: &mut Sums, weight: &i64, attributes: &Self::Attributes) -> bool {
        let (values, ShareShift { by, half }) = attributes;
        let share = |value: i32| {
            let product = (*weight as u64).wrapping_mul(value.unsigned_abs().into());
            let magnitude = (product.wrapping_add(*half) >> by) as u32;
            if value < 0 {
                magnitude.wrapping_neg()
            } else {
                magnitude
            }
        };
        let added: Sums = std::array::from_fn(|k| sums[k].wrapping_add(share(values[k])));
        if added[7] & FULL != 0 {
            return false;
        }
        *sums = added;
        true
    }
}
