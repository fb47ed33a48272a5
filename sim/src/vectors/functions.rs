//! Stages of the functions that have a table, which do not depend on the subject: the tables, and what the functions
//! give.

use super::VectorStage;
use super::builtin::{BuiltinRandom, soft};
use super::record::{Words, record};
use super::stage::digest;
use splatline::math::{LOGARITHMS, RECIPROCALS, ROOTS, SoftFloat, ln, reciprocal, square_root};
use std::sync::LazyLock;

/// The stages and their digests: computed once, since each subject has them.
static STAGES: LazyLock<Vec<(VectorStage, String)>> = LazyLock::new(|| {
    let with_digest = |stage: VectorStage| {
        let text = stage.to_text();
        (stage, digest(text.as_bytes()))
    };
    tables()
        .into_iter()
        .chain([cases()])
        .map(with_digest)
        .collect()
});

/// All of them: tables, then results.
pub fn stages() -> impl Iterator<Item = VectorStage> {
    STAGES.iter().map(|(stage, _)| stage.clone())
}

/// The digest of a stage that is one of these.
pub fn known_digest(stage: &VectorStage) -> Option<String> {
    let known = STAGES.iter().find(|(known, _)| known == stage);
    known.map(|(_, digest)| digest.clone())
}

/// Bits of results.
const BITS: [u32; 3] = [16, 17, 31];

/// Mantissas whose results hang on a single rounding within: two of each in reciprocal and logarithm, from a walk
/// through all of 31 bits.
const EDGES: [i32; 14] = [
    1_073_750_048, // the chord of the reciprocal's seed
    1_073_766_496,
    1_074_070_783, // what its seed lacks
    1_074_109_344,
    1_430_077_363, // the step that adds it
    2_147_483_645,
    1_109_472_809, // the logarithm's terms, from the inmost
    1_134_511_442,
    1_073_801_031,
    1_073_805_336,
    1_073_758_484,
    1_073_758_725,
    1_073_758_303,
    1_073_758_363,
];

/// Arguments of which [`cases`] has the results.
const CASES: usize = 4096;

/// Reciprocal, root and logarithm of numbers of all lengths, signs and exponents: to 16 bits, the most without the step
/// behind the table, to 17 and to 31. What has no result has zeros.
fn cases() -> VectorStage {
    let mut stage = VectorStage::new(
        "functions",
        "an argument; its reciprocal and root to 16, 17 and 31 bits, and its logarithm; zeros where there is none",
        "x:n reciprocal_16:n reciprocal_17:n reciprocal_31:n root_16:n root_17:n root_31:n logarithm:-64.32",
    );
    let mut random = BuiltinRandom(1);
    let none = soft(0, 0);
    let edges = EDGES.map(|mantissa| soft(mantissa, -31));
    let random = (0..CASES).map(|case| argument(&mut random, case));
    for x in edges.into_iter().chain(random) {
        let inverses = BITS.map(|bits| reciprocal(x, bits).unwrap_or(none));
        let roots = BITS.map(|bits| square_root(x, bits));
        stage.add(record![x; inverses; roots; ln(x).unwrap_or(0)]);
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
    let exponent = match case % 8 {
        1 => exponent,
        _ => exponent >> 26,
    };
    soft(if case % 4 == 3 { -magnitude } else { magnitude }, exponent)
}

/// The read-only memories of setup and rows, which do not depend on the design.
fn tables() -> [VectorStage; 3] {
    let table = |name, about, fields, words: &[u32]| {
        let mut stage = VectorStage::new(name, about, fields);
        let records = words.chunks(stage.fields.len());
        stage.records = records.map(|record| record![record]).collect();
        stage
    };
    [
        table(
            "reciprocals",
            "1/(1 + i/256), entry i of 0 to 256",
            "entry:31.30",
            &RECIPROCALS,
        ),
        table(
            "roots",
            "sqrt(i/256), entry i - 64 for i of 64 to 256",
            "entry:25.24",
            &ROOTS,
        ),
        table(
            "logarithms",
            "1/middle of 32 intervals of [1, 2), and minus its logarithm",
            "inverse:17.16 logarithm:32.32",
            &LOGARITHMS,
        ),
    ]
}
