//! Stages of the functions that have a table, which do not depend on the subject: the tables, and what the functions give.

use super::VectorStage;
use super::builtin::BuiltinRandom;
use super::compute::{field, numbers, values};
use splatline::math::{LOGARITHMS, RECIPROCALS, ROOTS, SoftFloat, ln, reciprocal, square_root};

/// Arguments of which [`cases`] has the results.
const CASES: usize = 4096;

/// Reciprocal, root and logarithm of numbers of all lengths, signs and exponents, with and without the step behind the table. What has no
/// result has zeros.
pub fn cases() -> VectorStage {
    let mut stage = VectorStage::new(
        "functions",
        "an argument; its reciprocal and root to 16 and 31 bits, and its logarithm; zeros where there is none",
        numbers(["x", "reciprocal_16", "reciprocal_31", "root_16", "root_31"]).chain([field(
            "logarithm",
            64,
            true,
            32,
        )]),
    );
    let mut random = BuiltinRandom(1);
    let none = SoftFloat {
        mantissa: 0,
        exponent: 0,
    };
    for case in 0..CASES {
        let x = argument(&mut random, case);
        let inverse = |bits| reciprocal(x, bits).unwrap_or(none);
        let root = |bits| square_root(x, bits);
        let mut record: Vec<i64> =
            values([x, inverse(16), inverse(31), root(16), root(31)]).collect();
        record.push(ln(x).unwrap_or(0));
        stage.records.push(record);
    }
    stage
}

/// Every eighth with an exponent from anywhere, every fourth negative, and some that are next to a power of two.
fn argument(random: &mut BuiltinRandom, case: usize) -> SoftFloat {
    let magnitude = ((random.bits() >> 1) >> ((random.bits() >> 8) % 31)) as i32;
    let magnitude = match case % 16 {
        5 => (magnitude & 3) - 1,
        7 => (1i32 << ((magnitude as u32) % 31)).wrapping_sub(magnitude & 1),
        _ => magnitude,
    };
    let exponent = random.bits() as i32;
    SoftFloat {
        mantissa: if case % 4 == 3 { -magnitude } else { magnitude },
        exponent: if case % 8 == 1 {
            exponent
        } else {
            exponent >> 26
        },
    }
}

/// The read-only memories of setup and rows, which do not depend on the design.
pub fn tables() -> [VectorStage; 3] {
    let table = |name, about, fields: &[(&str, usize, u8)], words: &[u32]| {
        let fields = fields
            .iter()
            .map(|(name, bits, fraction)| field(name, *bits, false, *fraction));
        let mut stage = VectorStage::new(name, about, fields);
        let records = words.chunks(stage.fields.len());
        stage.records = records
            .map(|record| record.iter().map(|word| i64::from(*word)).collect())
            .collect();
        stage
    };
    [
        table(
            "reciprocals",
            "1/(1 + i/256), entry i of 0 to 256",
            &[("entry", 31, 30)],
            &RECIPROCALS,
        ),
        table(
            "roots",
            "sqrt(i/256), entry i - 64 for i of 64 to 256",
            &[("entry", 25, 24)],
            &ROOTS,
        ),
        table(
            "logarithms",
            "1/middle of 32 intervals of [1, 2), and minus its logarithm",
            &[("inverse", 17, 16), ("logarithm", 32, 32)],
            &LOGARITHMS,
        ),
    ]
}
