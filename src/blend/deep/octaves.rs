//! Logarithm and exponential of the optical depth, base 2, by a table of 128 intervals and a short series.
//!
//! `-log2 q` for q in (0, 1]: q = m 2^-k with m in (1/2, 1]; the nearest i/128 to m has the tabled reciprocal
//! `s = 128/i`, so `m s = 1 + e` with |e| <= 2^-7, and `log2 m = log2(1/s) + log2(1 + e)` with four terms of the
//! series. For q near 1 the table gives s = 1 exactly and e = -alpha, so the smallest opacities keep their relative
//! accuracy: they are what a deep stack consists of. `2^-D`: the integer part shifts, seven bits index `2^-(i/128)`,
//! the rest is a cubic. A plain linearly interpolated table would need 2^14 entries for the same accuracy.

/// Fraction bits of [`of_opacity`]'s result.
pub const FRACTION: u32 = 44;

/// The result for full opacity: 31 octaves and more is all that UQ1.31 can tell, 20 is beyond every channel.
const OPAQUE: u64 = 20 << FRACTION;

/// log2 e - 1, UQ0.27, and ln 2, UQ0.32.
const LOG2_E_LESS_1: i64 = 59417523;
const LN_2: u64 = 2_977_044_472;

const INTERVALS: usize = 128;

/// 128/i for i in 64..=128, UQ2.30, rounded to nearest.
static RECIPROCALS: [u32; INTERVALS / 2 + 1] = {
    let mut table = [0; INTERVALS / 2 + 1];
    let mut i = 64;
    while i <= INTERVALS {
        table[i - 64] = (((INTERVALS as u64) << 30) + i as u64 / 2).div_euclid(i as u64) as u32;
        i += 1;
    }
    table
};

/// log2 of [`RECIPROCALS`] as rounded, UQ1.44: one bit of the result per squaring.
static LOGARITHMS: [u64; INTERVALS / 2 + 1] = {
    let mut table = [0; INTERVALS / 2 + 1];
    let mut i = 0;
    while i < table.len() {
        table[i] = log2_by_squaring((RECIPROCALS[i] as u64) << 32);
        i += 1;
    }
    table
};

/// 2^-(i/128), UQ1.32: by repeated multiplication with 2^-(1/128) from 62 fraction bits.
static POWERS: [u64; INTERVALS] = {
    let mut table = [0; INTERVALS];
    let factor = inverse_root_of_two(7);
    let mut value = 1u64 << 62;
    let mut i = 0;
    while i < INTERVALS {
        table[i] = (value + (1 << 29)) >> 30;
        value = ((value as u128 * factor as u128 + (1 << 61)) >> 62) as u64;
        i += 1;
    }
    table
};

/// -log2(1 - alpha), UQ5.44, for alpha in UQ1.31 (clamped to 1).
///
/// Error: at most 2^-35 absolute, and for alpha < 2^-8 at most 2^-42 and 2^-28 relative. Full opacity gives 20 octaves.
#[inline]
pub const fn of_opacity(alpha: u32) -> u64 {
    if alpha >= super::ONE {
        return OPAQUE;
    }
    let q = super::ONE - alpha;
    // m in (1/2, 1] as UQ1.31: q = m 2^-k.
    let k = (q - 1).leading_zeros().saturating_sub(1);
    let m = (q as u64) << k;
    let nearest = ((m + (1 << 23)) >> 24) as usize; // 64 to 128
    let index = (nearest & 0xff).saturating_sub(64) % RECIPROCALS.len();
    let defect = (m * RECIPROCALS[index] as u64) as i64 - (1 << 61);
    let octaves = ((k as u64) << FRACTION) + LOGARITHMS[index];
    octaves.saturating_add_signed(-log2_near_one(round_shift(defect, 23)))
}

/// log2(1 + e), Q0.44, for e in Q0.38, |e| < 2^-6: e (1 - e (1/2 - e (1/3 - e/4))) log2 e.
const fn log2_near_one(e: i64) -> i64 {
    const THIRD: i64 = (1 << 28) / 3;
    let short = round_shift(e, 10); // Q0.28
    let inner = THIRD - (short >> 2);
    let middle = (1 << 27) - round_shift(short * inner, 28);
    let outer = (1 << 30) - round_shift(e * middle, 36);
    let series = round_shift(e * outer, 26); // Q0.42
    (series << 2) + round_shift(series * LOG2_E_LESS_1, 25)
}

/// 2^-D for D in UQ4.fraction, UQ1.31. Error: at most 2^-30. Beyond the format depths of 32 octaves and more give 0,
/// and more than 28 fraction bits count as 28.
#[inline]
pub const fn transmittance(depth: u32, fraction: u32) -> u32 {
    let depth = (depth as u64) << (28 - if fraction > 28 { 28 } else { fraction });
    let octaves = (depth >> 28) as u32;
    let index = (depth >> 21) as usize & (INTERVALS - 1);
    // x = rest ln 2, UQ0.38, below 2^-7.
    let x = ((depth & 0x1f_ffff) * LN_2) >> 22;
    let square = (x * x) >> 38;
    let cube = (square * x) >> 38;
    // 2^-rest = 1 - x + x^2/2 - x^3/6, UQ1.31.
    let power = ((1 << 38) - x + square / 2 - cube / 6 + (1 << 6)) >> 7;
    let whole = POWERS[index] * power; // UQ1.63
    let drop = octaves.saturating_add(32);
    if drop > 63 {
        return 0;
    }
    (((whole >> (drop - 1)) + 1) >> 1) as u32
}

const fn round_shift(value: i64, shift: u32) -> i64 {
    (value + (1 << (shift - 1))) >> shift
}

/// log2 of x in [1, 2], UQ2.62, as UQ1.44, rounded down from 46 bits of squaring.
const fn log2_by_squaring(x: u64) -> u64 {
    if x >= 1 << 63 {
        return 1 << FRACTION;
    }
    let mut x = x;
    let mut bits = 0;
    let mut step = 0;
    while step < FRACTION + 1 {
        x = ((x as u128 * x as u128) >> 62) as u64;
        bits <<= 1;
        if x >= 1 << 63 {
            bits |= 1;
            x >>= 1;
        }
        step += 1;
    }
    (bits + 1) >> 1
}

/// 2^-(2^-roots), UQ1.62: 1/2 with `roots` square roots taken, each bit by bit.
const fn inverse_root_of_two(roots: u32) -> u64 {
    let mut value = 1u64 << 61;
    let mut taken = 0;
    while taken < roots {
        let square = (value as u128) << 62;
        let mut root = 0u64;
        let mut bit = 62;
        while bit > 0 {
            bit -= 1;
            let candidate = root | (1 << bit);
            if candidate as u128 * candidate as u128 <= square {
                root = candidate;
            }
        }
        value = root;
        taken += 1;
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What the compiler evaluates, at run time: the logarithm against double precision, the root by its square.
    #[test]
    fn tables_are_made_of_the_nearest_numbers() {
        let two = 1u64 << 63;
        for x in RECIPROCALS
            .map(|r| u64::from(r) << 32)
            .into_iter()
            .chain([two - 1, two + 1])
        {
            let exact = (x as f64 / 2f64.powi(62)).log2() * 2f64.powi(44);
            let found = log2_by_squaring(x);
            assert!((found as f64 - exact).abs() < 0.51, "{x}: {found}, {exact}");
        }
        assert_eq!(log2_by_squaring(two), 1 << 44);
        assert_eq!(inverse_root_of_two(0), 1 << 61);
        for roots in 1..20 {
            let square = u128::from(inverse_root_of_two(roots - 1)) << 62;
            let root = u128::from(inverse_root_of_two(roots));
            assert!(
                root * root <= square && square < (root + 1) * (root + 1),
                "{roots}"
            );
        }
    }
    #[test]
    fn octaves_are_these() {
        assert_eq!([1 << 31, u32::MAX].map(of_opacity), [20 << 44; 2]);
        let mut next = crate::random();
        let words = (0..4000).flat_map(|_| {
            let depth = next() as u32 >> (next() % 30);
            [of_opacity(depth), transmittance(depth, 27).into()]
        });
        assert_eq!(crate::digest(words), 4_838_507_992_869_563_245);
    }
}
