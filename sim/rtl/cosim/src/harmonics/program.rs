//! The program of the harmonics unit's basis: `basis` of src/setup/harmonics.rs, one line for one line, as sums of terms.
//!
//! A term is a product of two registers (rounded to Q.30), a register times a small number, or a polynomial times its constant, whose result is a harmonic. Sums of
//! squares are written where they stand: x x, x x + y y and x x + y y + z z are three terms. What the kernel writes with y y and z z is written here with those three;
//! no multiple of them is rounded, so that both are the same number.

use RightFactor::{Halves, Register, Root};
use std::f64::consts::PI;

/// Harmonics of the highest degree.
pub const HARMONICS: usize = 24;

/// The right factor of a term; the left one is a register.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RightFactor {
    /// A register.
    Register(&'static str),
    /// A small number in halves: exact, no rounding but that of a half.
    Halves(u32),
    /// The root of numerator / (denominator pi) in Q2.29, for a polynomial clamped to 4.
    Root(u32, u32),
}

/// Where a sum goes after a term.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// Nowhere yet.
    Nothing,
    /// A register.
    Register(&'static str),
    /// The harmonic of this index, from 1 on.
    Harmonic(usize),
}

/// One term of a sum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Term {
    /// The left factor's register.
    pub left: &'static str,
    /// The right factor.
    pub right: RightFactor,
    /// Is it subtracted?
    pub negated: bool,
    /// Where the sum goes.
    pub target: Target,
}

/// A sum, whose terms stand one behind the other.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sum {
    /// The lowest degree that needs it.
    pub degree: usize,
    /// Its terms.
    pub terms: Vec<Term>,
}

const fn term(left: &'static str, right: RightFactor, negated: bool, target: Target) -> Term {
    Term {
        left,
        right,
        negated,
        target,
    }
}

/// A product of two registers.
fn product(degree: usize, name: &'static str, left: &'static str, right: &'static str) -> Sum {
    let target = Target::Register(name);
    Sum {
        degree,
        terms: vec![term(left, Register(right), false, target)],
    }
}

/// Small multiples of registers.
fn multiples(degree: usize, name: &'static str, parts: &[(i32, &'static str)]) -> Sum {
    let last = parts.len() - 1;
    let terms = parts.iter().enumerate().map(|(place, (number, left))| {
        let target = if place == last {
            Target::Register(name)
        } else {
            Target::Nothing
        };
        term(left, Halves(2 * number.unsigned_abs()), *number < 0, target)
    });
    Sum {
        degree,
        terms: terms.collect(),
    }
}

/// A harmonic: its polynomial times the root of a number / pi, with a sign.
fn harmonic(index: usize, sign: i32, root: (u32, u32), polynomial: &'static str) -> Sum {
    let degree = (1..).find(|degree| index < (degree + 1) * (degree + 1));
    let right = Root(root.0, root.1);
    Sum {
        degree: degree.unwrap_or(0),
        terms: vec![term(polynomial, right, sign < 0, Target::Harmonic(index))],
    }
}

/// All of it. The direction is in "x", "y" and "z" before.
#[rustfmt::skip]
pub fn sums() -> Vec<Sum> {
    let squares = Sum {
        degree: 2,
        terms: vec![
            term("x", Register("x"), false, Target::Register("xx")),
            term("y", Register("y"), false, Target::Register("xx + yy")),
            term("z", Register("z"), false, Target::Register("rr")),
        ],
    };
    // The second product is rounded before it is subtracted: halves of the two go the same way, so that it has a register.
    let four = Sum {
        degree: 4,
        terms: vec![
            term("three_x", Register("xx"), false, Target::Nothing),
            term("yy three_y", Halves(2), true, Target::Register("four")),
        ],
    };
    let half = Sum {
        degree: 4,
        terms: vec![term("twice zero", Halves(1), false, Target::Register("zero"))],
    };
    vec![
        squares,
        product(2, "xy", "x", "y"),
        product(2, "yz", "y", "z"),
        product(2, "xz", "x", "z"),
        multiples(2, "3 zz - rr", &[(2, "rr"), (-3, "xx + yy")]),
        multiples(2, "squares", &[(2, "xx"), (-1, "xx + yy")]),
        multiples(3, "three_x", &[(4, "xx"), (-3, "xx + yy")]),
        multiples(3, "three_y", &[(4, "xx"), (-1, "xx + yy")]),
        multiples(3, "five", &[(4, "rr"), (-5, "xx + yy")]),
        multiples(3, "5 zz - 3 rr", &[(2, "rr"), (-5, "xx + yy")]),
        product(3, "y three_y", "three_y", "y"),
        product(3, "xyz", "xy", "z"),
        product(3, "y five", "five", "y"),
        product(3, "z (5 zz - 3 rr)", "5 zz - 3 rr", "z"),
        product(3, "x five", "five", "x"),
        product(3, "z squares", "squares", "z"),
        product(3, "x three_x", "three_x", "x"),
        multiples(4, "seven", &[(6, "rr"), (-7, "xx + yy")]),
        multiples(4, "odd", &[(4, "rr"), (-7, "xx + yy")]),
        multiples(4, "yy", &[(1, "xx + yy"), (-1, "xx")]),
        // 35 zz - 30 rr = 5 (rr - 7 (xx + yy)): the 5 stands in the other factor, which has room for it.
        multiples(4, "7 zz - 6 rr", &[(1, "rr"), (-7, "xx + yy")]),
        multiples(4, "5 zz", &[(5, "rr"), (-5, "xx + yy")]),
        multiples(4, "3 rr", &[(3, "rr")]),
        product(4, "zero, zz", "7 zz - 6 rr", "5 zz"),
        product(4, "zero, rr", "3 rr", "rr"),
        multiples(4, "twice zero", &[(1, "zero, zz"), (1, "zero, rr")]),
        half,
        product(4, "xy squares", "xy", "squares"),
        product(4, "yz three_y", "three_y", "yz"),
        product(4, "xy seven", "seven", "xy"),
        product(4, "yz odd", "odd", "yz"),
        product(4, "xz odd", "odd", "xz"),
        product(4, "squares seven", "seven", "squares"),
        product(4, "xz three_x", "three_x", "xz"),
        product(4, "yy three_y", "three_y", "yy"),
        four,
        harmonic(1, -1, (3, 4), "y"),
        harmonic(2, 1, (3, 4), "z"),
        harmonic(3, -1, (3, 4), "x"),
        harmonic(4, 1, (15, 4), "xy"),
        harmonic(5, -1, (15, 4), "yz"),
        harmonic(6, 1, (5, 16), "3 zz - rr"),
        harmonic(7, -1, (15, 4), "xz"),
        harmonic(8, 1, (15, 16), "squares"),
        harmonic(9, -1, (35, 32), "y three_y"),
        harmonic(10, 1, (105, 4), "xyz"),
        harmonic(11, -1, (21, 32), "y five"),
        harmonic(12, 1, (7, 16), "z (5 zz - 3 rr)"),
        harmonic(13, -1, (21, 32), "x five"),
        harmonic(14, 1, (105, 16), "z squares"),
        harmonic(15, -1, (35, 32), "x three_x"),
        harmonic(16, 1, (315, 16), "xy squares"),
        harmonic(17, -1, (315, 32), "yz three_y"),
        harmonic(18, 1, (45, 16), "xy seven"),
        harmonic(19, -1, (45, 32), "yz odd"),
        harmonic(20, 1, (9, 64), "zero"),
        harmonic(21, -1, (45, 32), "xz odd"),
        harmonic(22, 1, (45, 64), "squares seven"),
        harmonic(23, -1, (315, 32), "xz three_x"),
        harmonic(24, 1, (315, 256), "four"),
    ]
}

impl RightFactor {
    /// The slot's constant: roots with 29 fraction bits for a quotient by 2^31, halves with 15 for one by 2^16.
    pub fn constant(self) -> u32 {
        match self {
            Register(_) => 0,
            Halves(number) => number << 15,
            Root(numerator, denominator) => {
                let square = f64::from(numerator) / (f64::from(denominator) * PI);
                (square.sqrt() * 2f64.powi(29)).round() as u32
            }
        }
    }
}
