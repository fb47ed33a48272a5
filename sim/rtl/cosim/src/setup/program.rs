//! What a core of `setup_unit.sv` computes: `setup_program.txt` as the operations of a design.
//!
//! The list says nothing of the arithmetic: what a sum, a rounding or a table is stands in `setup_core.sv`.

use super::assemble::{Fields, Operand, Operation, Program, Term, Value};
use crate::mutation::Mutation;
use anyhow::{Context, Result, bail, ensure};
use splatline::format::Widths;
use splatline::math::GUARD;
use splatline_sim::machine::area::setup::is_turned;

/// The programs' file in the folder of the co-simulation.
pub const FILE: &str = "setup_program.txt";

/// What stands for several lines of it.
const FORMS: &str = include_str!("../../setup_forms.txt");

/// Items of a record, two in a beat: a component of an axis, and in this order the difference to the eye (high and low
/// parts), the last component and the weight.
const ITEMS: [&str; 16] = [
    "a0x", "dx", "a0y", "dy", "a0z", "dz", "a1x", "dx_low", "a1y", "dy_low", "a1z", "dz_low",
    "a2x", "a2z", "a2y", "weight",
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

/// What a program computes: setup, with what protects its splats against samples closer together than pixels, or
/// something else.
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
            unit: None,
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
    /// The last sum's base and step.
    unit: Option<(i64, i64)>,
}

/// Where a sum's last bit lies, by the slot's `base`: so many bits below the end of the largest term's format (of at
/// most four, of normalised factors), so many powers above the first term's exponent, or there.
const BY_LARGEST: i64 = 0;
const BY_FIRST: i64 = 1;
const THERE: i64 = 2;

impl Reader<'_> {
    fn line(&mut self, line: &str) -> Result<()> {
        let (name, rest) = line.split_once(" = ").context("no '='")?;
        let (form, terms) = rest.split_once(": ").context("no ':'")?;
        if let Some(from) = form.strip_prefix("out") {
            let first = from.strip_prefix(" from ").map_or(Ok(0), str::parse)?;
            return self.out(first, terms);
        }
        let (word, bits) = form.rsplit_once(' ').unwrap_or((form, ""));
        let mut lines = FORMS.split("\n\n");
        let lines = lines.find_map(|lines| lines.strip_prefix(word)?.strip_prefix('\n'));
        let Some(lines) = lines else {
            return self.operation(name, form, terms);
        };
        let lines = lines.replace("NAME", name).replace("BITS", bits);
        let lines = lines.replace("TERM", terms);
        lines.lines().try_for_each(|line| self.line(line))
    }

    fn out(&mut self, first: usize, values: &str) -> Result<()> {
        for (word, value) in (first..).zip(values.split(" + ")) {
            match self.operand(value, &mut Fields::new())? {
                Operand::Value(value) => self.results.push((word, value)),
                _ => bail!("{value} is no result"),
            }
        }
        Ok(())
    }

    fn operation(&mut self, name: &str, form: &str, terms: &str) -> Result<()> {
        let (mut fields, mut addend, mut below) = (Fields::new(), None, 0);
        let (mut unit, mut follows) = ((BY_FIRST, 0), false);
        for part in form.split(", ") {
            let (word, value) = part.split_once(' ').unwrap_or((part, "0"));
            let window =
                |above: i64| Ok::<_, anyhow::Error>(above - self.number(value)? - GUARD as i64);
            match word {
                "exact" | "pick" | "rounded" => {}
                "word" => (unit, follows) = (self.unit.context("no sum before")?, true),
                "sum" => unit = (BY_LARGEST, window(2 * PLAIN)?),
                "turn" => unit = (BY_FIRST, window(61)?),
                "heron" => unit = (BY_FIRST, window(32)?),
                "first" => unit = (BY_FIRST, self.number(value)?),
                "at" => unit = (THERE, self.number(value)?),
                "long" => {
                    below = faint_bits(self.widths).into();
                    fields.insert("extended", 1);
                }
                "from" => below = self.number(value)?,
                "plus" => addend = Some(self.constant(value)),
                _ => bail!("no form '{word}'"),
            }
            let cut = ["sum", "turn", "heron"].contains(&word);
            if cut || word == "rounded" {
                fields.extend([("normal", 1), ("drop", 31 - self.number(value)?)]);
            }
            if cut {
                fields.insert("down", 1);
            }
        }
        let mut terms = match form.strip_prefix("pick ") {
            Some(condition) => {
                let condition = condition.split(", ").next().unwrap_or(condition);
                vec![self.pick(condition, terms)?]
            }
            None => self.terms(terms)?,
        };
        let (base, step) = unit;
        let plain = base == BY_FIRST && terms[0].fields["plain"] == 1;
        let step = if plain { step + PLAIN } else { step };
        fields.extend([("base", base), ("step", step), ("spare", 32 - below)]);
        let (last, mut ends) = (terms.len() - 1, true);
        for term in terms.iter_mut().rev() {
            term.fields.extend(&fields);
            term.fields.insert("last", ends.into());
            ends = term.fields["again"] == 1;
        }
        terms[last].fields.insert("write", 1);
        let first = &mut terms[0].fields;
        first.insert("first", (!follows).into());
        if let Some(addend) = addend {
            first.extend([("addend", 1), ("start", addend as i64)]);
        }
        self.unit = Some(unit);
        self.operations.push(Operation {
            name: name.to_owned(),
            terms,
            follows,
            ..Operation::default()
        });
        Ok(())
    }

    fn number(&self, word: &str) -> Result<i64> {
        match word {
            "view" => Ok(self.widths.view.into()),
            "mantissa" => Ok(self.widths.mantissa.into()),
            _ => word
                .parse()
                .with_context(|| format!("'{word}' is no number")),
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

    /// A factor of a slot, whose fields are told its constant.
    fn operand(&mut self, word: &str, fields: &mut Fields) -> Result<Operand> {
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
        let address = self.constant(word) as i64;
        let other = fields.insert("constant", address).unwrap_or(address);
        ensure!(other == address, "a slot has one constant");
        Ok(Operand::Constant)
    }

    fn pick(&mut self, condition: &str, parts: &str) -> Result<Term> {
        let mut fields = Fields::from([("plain", 1), ("again", 0)]);
        let mut operands = Vec::new();
        for part in parts.split(" | ") {
            operands.push(self.operand(part, &mut fields)?);
        }
        let [a, b, ..] = operands[..] else {
            bail!("a choice of one");
        };
        let pick = match condition {
            "negative" => 1,
            "not negative" => 2,
            _ => bail!("no condition '{condition}'"),
        };
        fields.insert("pick", pick);
        Ok(Term {
            a,
            b,
            fields,
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
                    term = Term::default();
                    term.fields.extend([
                        ("plain", 1),
                        ("negated", (word == "-").into()),
                        ("subtracted", (word == "--").into()),
                        ("again", (word == "|").into()),
                    ]);
                }
                "*" | "step" => _ = term.fields.insert("plain", 0),
                "reciprocal" => _ = term.fields.insert("lookup", 1),
                "root" => _ = term.fields.insert("lookup", 2),
                "logarithm" => _ = term.fields.insert("lookup", 3),
                "entry" => _ = term.fields.insert("entry", 1),
                "power" => _ = term.fields.insert("power", 1),
                "double" => _ = term.fields.insert("offset", 1),
                "perspective" => term.fields.extend([("by_flag", 1), ("flag", 0)]),
                "normalised" => term.fields.extend([("by_flag", 1), ("flag", 1)]),
                "else" => is_other = true,
                _ => {
                    let operand = self.operand(word, &mut term.fields)?;
                    match term.a {
                        _ if is_other => (term.other, is_other) = (operand, false),
                        Operand::None => term.a = operand,
                        _ => term.b = operand,
                    }
                }
            }
        }
        terms.push(term);
        for Term { a, fields, .. } in &mut terms {
            ensure!(*a != Operand::None, "a term without a factor");
            let offset = offset(fields);
            *fields.entry("offset").or_default() += offset;
        }
        Ok(terms)
    }
}

/// Bits by which a plain term stands higher in the core than its exponent says: those of a mantissa.
const PLAIN: i64 = 31;

/// What the core adds to the exponents of each table's steps and entries. A root's rest stands 8 bits higher in the
/// core, 7 where its exponent is even.
const OFFSETS: [[i64; 2]; 4] = [[0, 0], [-81, -59], [-32, -8], [PLAIN - 46, PLAIN - 32]];

/// What the core adds to the factors' exponents. A first factor whose exponent does not count gives `-PLAIN`.
fn offset(fields: &Fields) -> i64 {
    let [table, entry, power, plain] =
        ["lookup", "entry", "power", "plain"].map(|name| fields.get(name).copied().unwrap_or(0));
    OFFSETS[table as usize][entry as usize] + (power - plain) * PLAIN
}
