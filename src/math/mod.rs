//! Integer arithmetic shared by the stages, one function per file, the derivation at its head.

mod extended;
mod ln;
mod reciprocal;
mod soft_float;
mod shift;
mod sqrt;
pub(crate) mod words;

pub use extended::Extended;
pub use ln::{LN_2, LOGARITHMS, REST, fraction, ln};
pub use reciprocal::{RECIPROCALS, reciprocal};
pub use shift::{shift_left, shift_round, shift_signed, shift_unsigned};
pub use soft_float::{GUARD, Product, SoftFloat, sum_below, sum_of_products};
pub(crate) use soft_float::{by_mantissa, known};
pub use sqrt::{ROOTS, root_of, root_seed, square_root};
