//! Distance scaling in the setup unit's program: `src/setup/distance.rs` as sums.
//!
//! Two things stand in constants. Both gains are the same 1/z times a focal length, and rounding keeps order, so that the smaller gain is that of the
//! smaller focal length. And rules without a spacing are given one so large that no splat lies beyond k.
//!
//! Nothing branches. A splat nearer than k gets the factor 1, which leaves its axes as they are; its weight is not rounded, so that it is chosen
//! and not multiplied: of the weight and the dimmed weight one is replaced by 0.

use super::assemble::{Pick, Unit, Value};
use super::builder::{Builder, constant, plain, taken_off, value};

/// d/k of a splat, and on which side of k it lies.
pub(super) struct EnlargementTerms {
    /// d/k; 1 where it lies nearer.
    factor: Value,
    /// Negative where it lies at k or nearer.
    beyond: Value,
}

/// `enlargement`.
pub(super) fn enlargement(builder: &mut Builder, inverse: Value, bits: u32) -> EnlargementTerms {
    let focal = constant("smaller_focal");
    let gain = builder.multiply("smaller gain", value(inverse), focal, bits);
    let distance = builder.multiply("k/d", value(gain), constant("spacing"), bits);
    // Mantissas have 31 bits at most: below 1 is at most 1 - 2^-31.
    let off = vec![taken_off(plain(value(distance)))];
    let beyond = builder.add_to("beyond k", "below_one", off, Unit::At(-47));
    let beyond = builder.from(beyond, 32);
    let factor = builder.reciprocal("d/k", distance, bits);
    let one = Some("one");
    let factor = builder.pick("d/k or 1", Pick::Negative, beyond, value(factor), one);
    EnlargementTerms { factor, beyond }
}

/// `enlarge`.
pub(super) fn enlarge(
    builder: &mut Builder,
    columns: [[Value; 2]; 3],
    enlargement: &EnlargementTerms,
    bits: u32,
) -> [[Value; 2]; 3] {
    let factor = value(enlargement.factor);
    let mut enlarged = |column| builder.multiply("enlarged", value(column), factor, bits);
    columns.map(|column| column.map(&mut enlarged))
}

/// `dim` of kernels that are not normalised.
pub(super) fn dim(
    builder: &mut Builder,
    weight: Value,
    enlargement: &EnlargementTerms,
    bits: u32,
) -> Value {
    let inverse = value(builder.reciprocal("k/d again", enlargement.factor, bits));
    let dimmed = builder.multiply("weight k/d", value(weight), inverse, bits);
    let dimmed = builder.multiply("weight (k/d)^2", value(dimmed), inverse, bits);
    let nothing = Some("nothing");
    let beyond = enlargement.beyond;
    let dimmed = builder.pick(
        "beyond k, dimmed",
        Pick::Negative,
        beyond,
        value(dimmed),
        nothing,
    );
    let kept = builder.pick(
        "nearer, as it is",
        Pick::NotNegative,
        beyond,
        value(weight),
        nothing,
    );
    let either = vec![plain(value(dimmed)), plain(value(kept))];
    builder.sum("weight, dimmed or not", either, 31)
}
