//! Mutations: circuits with one small mistake each, which the comparisons must notice. `mutations.tsv` lists them all;
//! here they are put into the sources.
//!
//! Building a circuit takes longer than judging a mutation by it, so that one circuit holds many, of which a number
//! picks one when it is simulated. An item of a module (`always_ff`, `always_comb`, `assign`, a function) with
//! mutations in it becomes a choice between its texts with one of them each and the text as it is. A mutation outside
//! such items (a parameter, a port, a package) has no choice and is built alone. The committed circuits know nothing of
//! this.

use crate::circuit::Source;
use anyhow::{Context, Result, ensure};
use std::ops::Range;

/// One mutation: in `file`, the text `from` (which occurs once) becomes `to`.
#[derive(Clone, Debug)]
pub struct Mutation {
    /// Its number.
    pub number: MutationNumber,
    /// What must notice it: a unit's comparison, or a proof.
    pub judge: String,
    /// What went wrong, in words.
    pub name: String,
    /// The file of `sim/rtl`.
    pub file: String,
    /// Text of the circuit.
    pub from: String,
    /// The mistake.
    pub to: String,
}

/// The place of a mutation among those of its judge, from 1 on; 0 is none.
pub type MutationNumber = usize;

const TABLE: &str = include_str!("../mutations.tsv");

/// The mutations that a unit's comparison or a proof must notice.
pub fn mutations(judge: &str) -> Result<Vec<Mutation>> {
    let mut all = Vec::new();
    for line in TABLE.lines().skip(1) {
        let mutation = parse(line, all.len() + 1);
        let mutation = mutation.with_context(|| format!("mutations.tsv: '{line}'"))?;
        if mutation.judge == judge {
            all.push(mutation);
        }
    }
    ensure!(!all.is_empty(), "mutations.tsv names no '{judge}'");
    Ok(all)
}

/// A line's five columns; a line break within one is written `\n`.
fn parse(line: &str, number: MutationNumber) -> Option<Mutation> {
    let columns = line.split('\t').map(|column| column.replace("\\n", "\n"));
    let [judge, name, file, from, to] = columns.collect::<Vec<String>>().try_into().ok()?;
    Some(Mutation {
        number,
        judge,
        name,
        file,
        from,
        to,
    })
}

impl Mutation {
    /// The file's text with the mistake, whose place must be there once.
    pub fn applied(&self, text: &str) -> Result<String> {
        let wrong = replaced(text, &self.from, &self.to);
        wrong.with_context(|| format!("{}; adapt mutations.tsv", self.file))
    }
}

/// The text with another in the place of one that occurs once.
pub fn replaced(text: &str, from: &str, to: &str) -> Result<String> {
    let places = text.matches(from).count();
    ensure!(places == 1, "'{from}' occurs {places} times, not once");
    Ok(text.replace(from, to))
}

/// Sources with a choice for each of the mutations that can have one, and the numbers of those.
pub fn with_choices(
    mut sources: Vec<Source>,
    mutations: &[Mutation],
) -> Result<(Vec<Source>, Vec<MutationNumber>)> {
    let mut chosen = Vec::new();
    for (name, text) in &mut sources {
        let own = mutations.iter().filter(|mutation| mutation.file == *name);
        // A file without ports is a package.
        if text.contains(PORTS_END) {
            *text = file_with_choices(text, &own.collect::<Vec<_>>(), &mut chosen)?;
        }
    }
    Ok((sources, chosen))
}

/// What a module is told the number by: `+mutation=NUMBER`.
const NUMBER: &str = "
  int mutation;
  initial if ($value$plusargs(\"mutation=%d\", mutation) == 0) mutation = 0;
";

/// The end of a module's ports.
const PORTS_END: &str = "\n);\n";

fn file_with_choices(
    text: &str,
    mutations: &[&Mutation],
    chosen: &mut Vec<MutationNumber>,
) -> Result<String> {
    let (mut result, mut done) = (String::new(), 0);
    for item in items(text) {
        let right = &text[item.clone()];
        let mut wrong = Vec::new();
        for mutation in mutations.iter().filter(|own| right.contains(&own.from)) {
            // In the item and nowhere else.
            mutation.applied(text)?;
            wrong.push((mutation.number, mutation.applied(right)?));
            chosen.push(mutation.number);
        }
        if !wrong.is_empty() {
            result += &text[done..item.start];
            result += &choice(right, &wrong)?;
            done = item.end;
        }
    }
    result += &text[done..];
    if done > 0 {
        result = result.replacen(PORTS_END, &format!("{PORTS_END}{NUMBER}"), 1);
    }
    Ok(result)
}

/// The choice between an item and its wrong texts.
fn choice(right: &str, wrong: &[(MutationNumber, String)]) -> Result<String> {
    let (head, body) = parts(right)?;
    let mut text = format!("{head} begin\n");
    for (number, wrong) in wrong {
        let (same, wrong) = parts(wrong)?;
        ensure!(same == head, "a mutation changes an item's head: {head}");
        text += &format!("if (mutation == {number}) begin\n{wrong}\nend else ");
    }
    text += &format!("begin\n{body}\nend\nend\n");
    if right.starts_with("function") {
        text += "endfunction";
    }
    Ok(text)
}

/// What stands before an item's statement, and the statement.
fn parts(item: &str) -> Result<(&str, &str)> {
    for keyword in ["assign", "always_comb"] {
        if let Some(body) = item.strip_prefix(keyword) {
            return Ok(("always_comb", body));
        }
    }
    if item.starts_with("always_ff") {
        let end = item.find(')').context("always_ff without a clock")? + 1;
        return Ok(item.split_at(end));
    }
    let end = item.find(';').context("a function without a head")? + 1;
    let body = item[end..].trim_end();
    let body = body.strip_suffix("endfunction");
    Ok((&item[..end], body.context("a function without an end")?))
}

/// Where a module's items begin and end; others than those above are passed over. An item goes on with lines that are
/// indented further, and with its own end.
fn items(text: &str) -> Vec<Range<usize>> {
    let kinds = ["assign ", "always_comb ", "always_ff ", "function "];
    let mut items: Vec<Range<usize>> = Vec::new();
    let (mut begin, mut column) = (0, usize::MAX);
    for line in text.split_inclusive('\n') {
        let words = line.trim_start();
        let place = begin + line.len() - words.len();
        let end = begin + line.trim_end().len();
        let indentation = place - begin;
        begin += line.len();
        let ends = words.starts_with("end") || words.starts_with('}');
        if indentation > column || indentation == column && ends {
            items.last_mut().expect("an item is open").end = end;
        } else if kinds.iter().any(|kind| words.starts_with(kind)) {
            items.push(place..end);
            column = indentation;
        } else if !words.is_empty() {
            column = usize::MAX;
        }
    }
    items
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::circuit::{Circuit, MACHINE, ORDER, PRIMITIVE, SETUP};
    use crate::setup::program::{ProgramKind, SetupProgram};

    const UNIT: &str = "// A unit; assign nothing.
module unit (
    input logic clk,
    input logic a,
    output logic b
);
  logic c;  // begin
  assign c = !a;
  other #(.EMPTY(1)) rest (.clk, .c);
  function automatic logic turned(input logic value);
    turned = !value;
  endfunction
  always_ff @(posedge clk) begin
    if (a) begin
      b <= turned(c);
    end
  end
endmodule
";

    fn switched(mutations: &[Mutation]) -> (String, Vec<MutationNumber>) {
        let sources = vec![("unit.sv".to_owned(), UNIT.to_owned())];
        let (mut sources, mut chosen) = with_choices(sources, mutations).unwrap();
        chosen.sort_unstable();
        (sources.remove(0).1, chosen)
    }

    #[test]
    fn items_with_mutations_become_choices() {
        let mutations = [
            "unit\tanother's\trest.sv\ta\tb",
            "unit\twire\tunit.sv\tc = !a\tc = a",
            "unit\tparameter\tunit.sv\tEMPTY(1)\tEMPTY(0)",
            "unit\tregister\tunit.sv\tb <= turned(c);\tb <= c;",
            "unit\tcondition\tunit.sv\tif (a)\tif (1'b1)",
            "unit\tfunction\tunit.sv\tturned = !value\tturned = value",
        ];
        let mutations = (1..).zip(mutations);
        let mutations = mutations.map(|(number, line)| parse(line, number).unwrap());
        let (text, chosen) = switched(&mutations.collect::<Vec<_>>());
        assert_eq!(chosen, [2, 4, 5, 6]);
        let plain: Vec<&str> = text.split_whitespace().collect();
        let plain = plain.join(" ");
        for part in [
            "); int mutation; initial",
            "always_comb begin if (mutation == 2) begin c = a; end else begin c = !a; end end",
            "other #(.EMPTY(1)) rest",
            "function automatic logic turned(input logic value); begin if (mutation == 6) begin turned = value; end else begin turned = !value; end end endfunction",
            "always_ff @(posedge clk) begin if (mutation == 4) begin begin if (a) begin b <= c; end end end else if (mutation == 5) begin begin if (1'b1) begin",
        ] {
            assert!(plain.contains(part), "{part}\n{text}");
        }
    }

    #[test]
    fn a_unit_without_mutations_stays_as_it_is() {
        assert_eq!(switched(&[]), (UNIT.to_owned(), Vec::new()));
    }

    /// The circuits change; a mutation whose place has gone would say so only when it is judged.
    #[test]
    fn every_mutation_has_its_place() {
        for (judge, unit, choices) in [
            ("primitive", &PRIMITIVE, 63),
            ("setup", &SETUP, 60),
            ("machine", &MACHINE, 24),
            ("order", &ORDER, 34),
            ("harmonics", &MACHINE, 66),
        ] {
            let sources = Circuit::new(unit, "lean18", 1).unwrap().sources().unwrap();
            let mutations = mutations(judge).unwrap();
            for mutation in &mutations {
                let source = sources.iter().find(|source| source.0 == mutation.file);
                mutation.applied(&source.unwrap().1).unwrap();
            }
            let (_, chosen) = with_choices(sources, &mutations).unwrap();
            assert_eq!(chosen.len(), choices, "{judge}");
        }
        for mutation in mutations("programs").unwrap() {
            let program = SetupProgram::new(ProgramKind::Filter);
            program.mutated(&mutation).unwrap();
        }
    }
}
