//! Products of the pixel path: two words multiplied, brought to a result's format and rounded once.
//!
//! Small processors multiply 32 bits by 32 to 32. Where the whole product does not fit, but either half of one factor
//! times the other does, two such multiplications replace one of 64 bits: with b = b1 2^k + b0,
//!
//! ```text
//! floor(a b 2^-k) = a b1 + floor(a b0 2^-k)
//! ```
//!
//! and what was cut off only matters to ties: the k bits are 0 there, or it is none. Same bits in all three forms.

use crate::format::Rounding;
use crate::math::shift_unsigned;

/// Words in which a product is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Words {
    /// Product and rounding constant fit 32 bits.
    One,
    /// The product without its lowest bits does, so many of them that they times the first factor fit 32 bits, too.
    Two(u32),
    /// 64 bits.
    Wide,
}

/// `a b 2^-by`, rounded. Values beyond the largest ones stated wrap.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Product {
    by: i32,
    rounding: Rounding,
    pub(super) words: Words,
}

impl Product {
    /// Of factors up to these.
    pub(super) const fn new(largest: [u32; 2], by: i32, rounding: Rounding) -> Self {
        let [a, b] = [largest[0] as u64, largest[1] as u64];
        let low = largest[0].leading_zeros();
        let half = if by > 0 { 1 << ((by - 1) & 31) } else { 0 };
        let words = if by < 0 || by > 31 {
            Words::Wide
        } else if a * b + half <= u32::MAX as u64 {
            Words::One
        } else if low > 0 && by > low as i32 && ((a * b) >> low) + (1 << 30) <= u32::MAX as u64 {
            Words::Two(low)
        } else {
            Words::Wide
        };
        Product {
            by,
            rounding,
            words,
        }
    }

    /// The same in words of 64 bits.
    #[cfg(test)]
    pub(super) fn wide(self) -> Self {
        let words = Words::Wide;
        Product { words, ..self }
    }

    /// Right shift.
    pub(super) const fn by(&self) -> i32 {
        self.by
    }

    /// The product.
    #[inline(always)]
    pub(super) fn of(&self, a: u32, b: u32) -> u64 {
        self.added_to(0, a, b)
    }

    /// What the product adds to a sum, so that the sum is what is rounded: a tie goes to the even sum.
    #[inline(always)]
    pub(super) fn added_to(&self, sum: u32, a: u32, b: u32) -> u64 {
        match self.words {
            Words::One => self.round(a.wrapping_mul(b), 0, self.by, sum).into(),
            Words::Two(low) => {
                let below = a.wrapping_mul(b & ((1 << low) - 1));
                let upper = a.wrapping_mul(b >> low).wrapping_add(below >> low);
                let cut = below << (32 - low);
                self.round(upper, cut, self.by - low as i32, sum).into()
            }
            Words::Wide => {
                let product = u64::from(a) * u64::from(b);
                if self.rounding == Rounding::NearestEven && self.by > 0 && sum & 1 == 1 {
                    // Halves to odd: one unit more or less is even.
                    let one = 1u64.wrapping_shl(self.by as u32);
                    let moved = shift_unsigned(product.wrapping_add(one), self.by, self.rounding);
                    return moved.wrapping_sub(1);
                }
                shift_unsigned(product, self.by, self.rounding)
            }
        }
    }

    /// A product of 32 bits, by 0 to 31, below which `cut` was cut off.
    #[inline(always)]
    fn round(&self, product: u32, cut: u32, by: i32, sum: u32) -> u32 {
        let raised = match self.rounding {
            Rounding::Truncate => return product >> by,
            _ if by == 0 => return product,
            _ => product.wrapping_add(1 << (by - 1)),
        };
        let result = raised >> by;
        if self.rounding == Rounding::NearestEven && raised << (32 - by) == 0 {
            return tied(result, cut, sum);
        }
        result
    }
}

/// What was rounded up from a half, or, with more below it, from beyond. One product in hundreds comes here, so that
/// all others look at one word.
#[cold]
#[inline(never)]
fn tied(result: u32, cut: u32, sum: u32) -> u32 {
    if cut != 0 {
        return result;
    }
    result.wrapping_sub(result.wrapping_add(sum) & 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All small factors, among which every tie is, in one word and in 64 bits.
    #[test]
    fn ties_go_to_the_even_sum() {
        for rounding in [Rounding::Nearest, Rounding::NearestEven, Rounding::Truncate] {
            for (by, sum) in (0..7).flat_map(|by| (0..4u32).map(move |sum| (by, sum))) {
                let product = Product::new([64, 64], by, rounding);
                for (a, b) in (0..=64u32).flat_map(|a| (0..=64u32).map(move |b| (a, b))) {
                    let exact = (sum << by) + a * b;
                    let half = if by > 0 { 1u32 << (by - 1) } else { 0 };
                    let up = match rounding {
                        Rounding::Nearest => half,
                        Rounding::NearestEven if by > 0 => half - 1 + (exact >> by & 1),
                        _ => 0,
                    };
                    let expected = u64::from(((exact + up) >> by) - sum);
                    assert_eq!(
                        [product, product.wide()].map(|form| form.added_to(sum, a, b)),
                        [expected; 2]
                    );
                }
            }
        }
    }
    /// Products of the widths of `Lean18` in two words: ties, what lies a unit of either factor beside them, and any
    /// others.
    #[test]
    fn two_words_round_as_one_does() {
        let mut next = crate::random();
        let mut ties = 0;
        for (largest, by) in [
            ([1 << 22, 1 << 18], 18u32),
            ([1 << 18, 1 << 22], 18),
            ([1 << 22, 1 << 18], 17),
        ] {
            let product = Product::new(largest, by as i32, Rounding::NearestEven);
            assert!(matches!(product.words, Words::Two(_)));
            for _ in 0..100_000 {
                let zeros = (next() % u64::from(by)) as u32;
                let odd = |zeros: u32, largest: u32, number: u64| {
                    ((number as u32 | 1) << zeros) & (largest - 1)
                };
                let [a, b] = [
                    odd(zeros, largest[0], next()),
                    odd(by - 1 - zeros, largest[1], next()),
                ];
                for (a, b) in [
                    (a, b),
                    (a, b - b.min(1)),
                    ((a + 1).min(largest[0]), b),
                    (largest[0], b),
                    (a, largest[1]),
                ] {
                    let sum = next() as u32 >> 9;
                    let exact = u64::from(a) * u64::from(b);
                    ties += u32::from(exact << (64 - by) == 1 << 63);
                    assert_eq!(
                        product.added_to(sum, a, b),
                        product.wide().added_to(sum, a, b),
                        "{a} {b} {sum}"
                    );
                }
            }
        }
        assert!(ties > 100_000, "{ties}");
    }
}
