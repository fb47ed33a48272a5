//! What a core of `setup_unit.sv` computes: `setup_program.txt` as the operations of a design.
//!
//! The list says nothing of the arithmetic: what a sum, a rounding or a table is stands in `setup_core.sv`.

use super::assemble::{Operand, Operation, Pick, Program, Table, Term, Unit, Value};
use crate::mutation::Mutation;
use anyhow::{Context, Result, bail, ensure};
use splatline::format::Widths;
use splatline::math::GUARD;
use splatline_sim::machine::area::setup::is_turned;

/// The programs' file in the folder of the co-simulation.
pub const FILE: &str = "setup_program.txt";

/// Items of a record: the difference to the eye (high and low parts), the axes, the weight.
const ITEMS: [&str; 16] = [
    "dx", "dy", "dz", "dx_low", "dy_low", "dz_low", "a0x", "a0y", "a0z", "a1x", "a1y", "a1z",
    "a2x", "a2y", "a2z", "weight",
];

/// Bits of the difference's low part; 0 where it has none.
pub fn low_bits(widths: &Widths) -> u32 {
    u32::from(widths.position).saturating_sub(30)
}

/// Bits of a position that are below its centre's rounding: where the others have room in one word, or else 0.
pub fn faint_bits(widths: &Widths) -> u32 {
    let bits = 31u32.saturating_sub(widths.subpixel.into());
    if bits < LEAST_FAINT { 0 } else { bits }
}

/// A long word has 51 bits, one of which stands for those that it has not.
const LEAST_FAINT: u32 = 14;

/// What a program computes: setup, with what protects its splats against samples closer together than pixels, or something else.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProgramKind {
    /// Setup with the low-pass filter alone.
    Filter,
    /// With distance scaling; rules without a spacing do without it.
    DistanceScaling,
    /// With opacities compensated for the filter, under rules that do so.
    Compensation,
    /// Rounding, reciprocal, root and logarithm of a record's weight, for vectors of those units alone.
    Units,
}

impl ProgramKind {
    /// Its name in the file's headings.
    fn word(self) -> &'static str {
        ["filter", "distance", "compensation", "units"][self as usize]
    }
}

/// A program, before it is assembled for a design.
#[derive(Clone, Debug)]
pub struct SetupProgram {
    /// What it computes.
    pub kind: ProgramKind,
    /// Does it give the direction of every splat as well?
    pub directs: bool,
    text: String,
}

impl SetupProgram {
    /// The program of a kind.
    pub fn new(kind: ProgramKind) -> SetupProgram {
        SetupProgram {
            kind,
            directs: false,
            text: include_str!("../../setup_program.txt").to_owned(),
        }
    }

    /// The same with the direction of every splat.
    pub fn with_direction(mut self) -> SetupProgram {
        self.directs = true;
        self
    }

    /// The same with a mistake in the text.
    pub fn mutated(&self, mutation: &Mutation) -> Result<SetupProgram> {
        let text = mutation.applied(&self.text)?;
        Ok(SetupProgram { text, ..*self })
    }

    /// A design's operations at their places.
    pub fn assembled(&self, widths: &Widths) -> Result<Program> {
        let mut reader = Reader {
            widths,
            operations: Vec::new(),
            results: Vec::new(),
            constants: Vec::new(),
        };
        let of_design = [
            ["whole", "low"][usize::from(low_bits(widths) > 0)],
            ["broad", "narrow"][usize::from(is_turned(widths.mantissa))],
            ["short", "long"][usize::from(faint_bits(widths) > 0)],
        ];
        let direction = if self.directs { "direction" } else { "" };
        let of_program = |kind| kind == self.kind.word() || kind == direction;
        let mut stands = false;
        for line in self.text.lines() {
            if let Some(heading) = line.strip_prefix("== ") {
                let (kinds, only) = heading.split_once(", ").unwrap_or((heading, of_design[0]));
                stands = of_design.contains(&only) && kinds.split(' ').any(of_program);
            } else if stands && !line.is_empty() && !line.starts_with("//") {
                let read = reader.line(line);
                read.with_context(|| format!("{FILE}: '{line}'"))?;
            }
        }
        Program::new(reader.operations, &reader.results, reader.constants)
    }
}

/// The operations so far.
struct Reader<'a> {
    widths: &'a Widths,
    operations: Vec<Operation>,
    /// What leaves the core, each as this word.
    results: Vec<(usize, Value)>,
    /// In the order of their addresses.
    constants: Vec<String>,
}

impl Reader<'_> {
    fn line(&mut self, line: &str) -> Result<()> {
        let (name, rest) = line.split_once(" = ").context("no '='")?;
        let (form, terms) = rest.split_once(": ").context("no ':'")?;
        if let Some(from) = form.strip_prefix("out") {
            let first = from.strip_prefix(" from ").map_or(Ok(0), str::parse)?;
            return self.out(first, terms);
        }
        let lines = match form.rsplit_once(' ') {
            Some(("reciprocal", bits)) => vec![
                format!("{name}, seed = exact: reciprocal entry {terms} - reciprocal step {terms}"),
                format!("{name}, defect = at -47, plus reciprocal_one: - {terms} * [{name}, seed]"),
                format!(
                    "{name} = first -30, rounded {bits}: [{name}, seed] + [{name}, seed] * [{name}, defect]"
                ),
            ],
            Some(("root", bits)) => {
                vec![format!(
                    "{name} = rounded {bits}: root entry {terms} + root step {terms}"
                )]
            }
            Some(("square root", bits)) => vec![
                format!("{name}, seed = root 31: {terms}"),
                format!("1/{name} = reciprocal 31: [{name}, seed]"),
                format!("{name}, twice = heron {bits}: [{name}, seed] + {terms} * [1/{name}]"),
            ],
            _ => return self.operation(name, form, terms),
        };
        lines.iter().try_for_each(|line| self.line(line))
    }

    fn out(&mut self, first: usize, values: &str) -> Result<()> {
        for (word, value) in (first..).zip(values.split(" + ")) {
            match self.operand(value)? {
                Operand::Value(value) => self.results.push((word, value)),
                _ => bail!("{value} is no result"),
            }
        }
        Ok(())
    }

    fn operation(&mut self, name: &str, form: &str, terms: &str) -> Result<()> {
        let mut operation = Operation {
            name: name.to_owned(),
            terms: Vec::new(),
            unit: Unit::First(0),
            addend: None,
            bits: None,
            below: 0,
            long: false,
            follows: false,
        };
        let mut floor = false;
        for part in form.split(", ") {
            let (word, value) = part.split_once(' ').unwrap_or((part, "0"));
            let window =
                |above: i32| Ok::<_, anyhow::Error>(above - self.number(value)? - GUARD as i32);
            match word {
                "exact" | "pick" | "rounded" => {}
                "word" => {
                    let before = self.operations.last().context("no sum before")?;
                    (operation.unit, operation.follows) = (before.unit, true);
                }
                "sum" => operation.unit = Unit::Below(-window(0)?),
                "turn" => operation.unit = Unit::First(window(61)?),
                "heron" => operation.unit = Unit::First(window(32)?),
                "first" => operation.unit = Unit::First(self.number(value)?),
                "at" => operation.unit = Unit::At(self.number(value)?),
                "long" => (operation.long, operation.below) = (true, faint_bits(self.widths)),
                "from" => operation.below = self.number(value)? as u32,
                "plus" => operation.addend = Some(self.constant(value)),
                _ => bail!("no form '{word}'"),
            }
            let cut = ["sum", "turn", "heron"].contains(&word);
            if cut || word == "rounded" {
                operation.bits = Some(self.number(value)? as u32);
            }
            floor |= cut;
        }
        operation.terms = match form.strip_prefix("pick ") {
            Some(condition) => {
                let condition = condition.split(", ").next().unwrap_or(condition);
                vec![self.pick(condition, terms)?]
            }
            None => self.terms(terms)?,
        };
        let terms = operation.terms.iter_mut();
        terms.for_each(|term| term.floor = floor);
        self.operations.push(operation);
        Ok(())
    }

    fn number(&self, word: &str) -> Result<i32> {
        match word {
            "view" => Ok(self.widths.view.into()),
            "mantissa" => Ok(self.widths.mantissa.into()),
            _ => Ok(word
                .parse()
                .with_context(|| format!("'{word}' is no number"))?),
        }
    }

    /// The address of a constant.
    fn constant(&mut self, name: &str) -> usize {
        let known = self.constants.iter().position(|known| known == name);
        known.unwrap_or_else(|| {
            self.constants.push(name.to_owned());
            self.constants.len() - 1
        })
    }

    fn operand(&mut self, word: &str) -> Result<Operand> {
        if let Some(name) = word.strip_prefix('[') {
            let name = name.trim_end_matches(']');
            let found = self.operations.iter().rposition(|known| known.name == name);
            let found = found.with_context(|| format!("no result '{name}'"))?;
            return Ok(Operand::Value(found));
        }
        if let Some(name) = word.strip_prefix('$') {
            let place = ITEMS.iter().position(|item| *item == name);
            let place = place.with_context(|| format!("no item '{name}'"))?;
            return Ok(Operand::Input(place as u8));
        }
        Ok(Operand::Constant(self.constant(word)))
    }

    fn pick(&mut self, condition: &str, parts: &str) -> Result<Term> {
        let parts: Vec<&str> = parts.split(" | ").collect();
        let [a, b, picked @ ..] = parts.as_slice() else {
            bail!("a choice of one");
        };
        Ok(Term {
            a: self.operand(a)?,
            b: self.operand(b)?,
            picked: picked.first().map(|name| self.constant(name)),
            plain: true,
            pick: match condition {
                "negative" => Pick::Negative,
                "not negative" => Pick::NotNegative,
                _ => bail!("no condition '{condition}'"),
            },
            ..Term::default()
        })
    }

    fn terms(&mut self, text: &str) -> Result<Vec<Term>> {
        let mut terms = Vec::new();
        let (mut term, mut is_other) = (Term::default(), false);
        // The first term is added as well.
        let text = format!("+ {text}");
        let mut rest = text.as_str();
        while !rest.is_empty() {
            let end = if rest.starts_with('[') { ']' } else { ' ' };
            let (word, behind) = rest.split_once(end).unwrap_or((rest, ""));
            rest = behind.trim_start();
            match word {
                "+" | "-" | "--" | "|" => {
                    if term.a != Operand::None {
                        terms.push(term);
                    }
                    term = Term {
                        plain: true,
                        before: word == "-",
                        after: word == "--",
                        again: word == "|",
                        ..Term::default()
                    };
                }
                "*" => term.plain = false,
                "reciprocal" => term.table = Table::Reciprocal,
                "root" => term.table = Table::Root,
                "logarithm" => term.table = Table::Logarithm,
                "entry" => term.entry = true,
                "step" => term.plain = false,
                "power" => term.power = true,
                "double" => term.doubled = true,
                "perspective" => term.flag = Some(0),
                "normalised" => term.flag = Some(1),
                "else" => is_other = true,
                _ if is_other => (term.other, is_other) = (self.operand(word)?, false),
                _ if term.a == Operand::None => term.a = self.operand(word)?,
                _ => term.b = self.operand(word)?,
            }
        }
        terms.push(term);
        let whole = terms.iter().all(|term| term.a != Operand::None);
        ensure!(whole, "a term without a factor");
        Ok(terms)
    }
}
