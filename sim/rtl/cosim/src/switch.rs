//! Many mistakes in one circuit, of which a number picks one when it is simulated: building a circuit takes longer than judging a mistake by it.
//!
//! An item of a module (`always_ff`, `always_comb`, `assign`, a function) with mistakes in it becomes a choice between its texts with one of them each and
//! the text as it is, so that what runs is the circuit with that mistake and nothing else. A mistake outside such items (a parameter, a port, a
//! package) has no choice and is built alone. Nothing of this is in the committed circuit: the copies lie in a scratch folder.

use crate::mutants::Mutant;
use crate::verilate::units;
use anyhow::{Context, Result, bail, ensure};
use std::ops::Range;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// The place of a mistake in its list, from 1 on; 0 is none.
pub type MistakeNumber = usize;

/// A unit with choices, and which of the mistakes are among them.
#[derive(Debug)]
pub struct Switched {
    /// The text.
    pub text: String,
    /// Mistakes of this unit that have a choice.
    pub chosen: Vec<MistakeNumber>,
}

/// What a module is told the number by: `+mistake=NUMBER`.
const NUMBER: &str = "
  int mistake;
  initial if ($value$plusargs(\"mistake=%d\", mistake) == 0) mistake = 0;
";

/// The end of a module's ports.
const PORTS_END: &str = "\n);\n";

/// A unit's text with a choice for each of its mistakes that can have one.
pub fn switched(file: &str, text: &str, mistakes: &[Mutant]) -> Result<Switched> {
    // Without ports it is a package.
    let of_module = text.contains(PORTS_END);
    let numbered = (1..)
        .zip(mistakes)
        .filter(|(_, mistake)| of_module && mistake.file == file);
    let mut places: Vec<(MistakeNumber, Range<usize>, String)> = Vec::new();
    let items = items(text);
    for (number, mistake) in numbered {
        let changed = mistake.applied(text)?;
        let place = text.find(mistake.from).context("its place is there once")?;
        let holds =
            |item: &&Range<usize>| item.start <= place && place + mistake.from.len() <= item.end;
        let Some(item) = items.iter().find(holds) else {
            continue;
        };
        let end = item.end + changed.len() - text.len();
        places.push((number, item.clone(), changed[item.start..end].to_owned()));
    }
    let chosen: Vec<MistakeNumber> = places.iter().map(|place| place.0).collect();
    if chosen.is_empty() {
        return Ok(Switched {
            text: text.to_owned(),
            chosen,
        });
    }
    let mut result = String::new();
    let mut done = 0;
    for item in &items {
        let wrong: Vec<(MistakeNumber, &str)> = places
            .iter()
            .filter(|place| place.1 == *item)
            .map(|place| (place.0, place.2.as_str()))
            .collect();
        if wrong.is_empty() {
            continue;
        }
        result += &text[done..item.start];
        result += &choice(&text[item.clone()], &wrong).with_context(|| file.to_owned())?;
        done = item.end;
    }
    result += &text[done..];
    Ok(Switched {
        text: result.replacen(PORTS_END, &format!("{PORTS_END}{NUMBER}"), 1),
        chosen,
    })
}

/// Units by name and text, with choices of the mistakes.
pub fn with_choices(
    files: Vec<(String, String)>,
    mistakes: &[Mutant],
) -> Result<Vec<(String, String)>> {
    let of = |(name, text): (String, String)| {
        let text = switched(&name, &text, mistakes)?.text;
        Ok((name, text))
    };
    files.into_iter().map(of).collect()
}

/// Mistakes that have a choice in the units of a list in `sim/rtl`; the others are built alone.
pub fn chosen(list: &str, mistakes: &[Mutant]) -> Result<Vec<MistakeNumber>> {
    let mut all = Vec::new();
    for (name, text) in units(list)? {
        all.extend(switched(&name, &text, mistakes)?.chosen);
    }
    Ok(all)
}

/// Builds a circuit in a folder: with one mistake, or with choices of these.
pub type BuildCircuit = fn(&Path, Option<&Mutant>, &[Mutant]) -> Result<PathBuf>;

/// A circuit with all mistakes of a list that have a choice; the others are built when they are asked for.
pub struct SwitchedCircuit {
    mistakes: &'static [Mutant],
    chosen: Vec<MistakeNumber>,
    build: BuildCircuit,
    library: PathBuf,
    folder: TempDir,
}

impl SwitchedCircuit {
    /// Builds the circuit of the units of a list in `sim/rtl`.
    pub fn new(list: &str, mistakes: &'static [Mutant], build: BuildCircuit) -> Result<Self> {
        let folder = tempfile::tempdir()?;
        Ok(SwitchedCircuit {
            mistakes,
            chosen: chosen(list, mistakes)?,
            build,
            library: build(folder.path(), None, mistakes)?,
            folder,
        })
    }

    /// Where it lies; without a number it has no mistake.
    pub fn library(&self) -> &Path {
        &self.library
    }

    /// What is said of the library with a mistake and of the number that picks it there, 0 where it is the only one.
    pub fn judged<T>(
        &self,
        mistake: &Mutant,
        judge: impl FnOnce(&Path, MistakeNumber) -> Result<T>,
    ) -> Result<T> {
        let place = self
            .mistakes
            .iter()
            .position(|known| known.name == mistake.name);
        let number = place.map_or(0, |place| place + 1);
        if self.chosen.contains(&number) {
            return judge(&self.library, number);
        }
        let folder = TempDir::new_in(self.folder.path())?;
        judge(&(self.build)(folder.path(), Some(mistake), &[])?, 0)
    }
}

/// What is said of a circuit without a mistake must be nothing; else no verdict means anything.
pub fn expect_no_difference(word: Option<String>) -> Result<()> {
    match word {
        None => Ok(()),
        Some(word) => bail!("without a mistake: {word}"),
    }
}

/// The choice between an item and its wrong texts.
fn choice(right: &str, wrong: &[(MistakeNumber, &str)]) -> Result<String> {
    let (head, body) = parts(right)?;
    let mut text = format!("{head} begin\n");
    for (number, wrong) in wrong {
        let (same, wrong) = parts(wrong)?;
        ensure!(same == head, "a mistake changes an item's head: {head}");
        text += &format!("if (mistake == {number}) begin\n{wrong}\nend else ");
    }
    text += &format!("begin\n{body}\nend\nend\n");
    if right.starts_with("function") {
        text += "endfunction";
    }
    Ok(text)
}

/// What stands before an item's statement, and the statement.
fn parts(item: &str) -> Result<(&str, &str)> {
    if let Some(body) = item.strip_prefix("assign") {
        return Ok(("always_comb", body));
    }
    if let Some(body) = item.strip_prefix("always_comb") {
        return Ok(("always_comb", body));
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

/// Where a module's items begin and end; others than those above are passed over.
fn items(text: &str) -> Vec<Range<usize>> {
    let mut items = Vec::new();
    let mut open: Option<(usize, &str)> = None;
    let mut depth = 0;
    for (place, word) in words(text) {
        let Some((start, kind)) = open else {
            if ["assign", "always_comb", "always_ff", "function"].contains(&word) {
                (open, depth) = (Some((place, word)), 0);
            }
            continue;
        };
        match word {
            "begin" | "case" => depth += 1,
            "end" | "endcase" => depth -= 1,
            _ => {}
        }
        let ends = match kind {
            "function" => word == "endfunction",
            _ => depth == 0 && ["end", "endcase", ";"].contains(&word),
        };
        if ends {
            items.push(start..place + word.len());
            open = None;
        }
    }
    items
}

/// Words and semicolons, without those of comments.
fn words(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut place = 0;
    std::iter::from_fn(move || {
        loop {
            let rest = text.get(place..)?;
            let first = rest.chars().next()?;
            let begin = place;
            if rest.starts_with("//") {
                place += rest.find('\n').unwrap_or(rest.len());
            } else if first.is_ascii_alphanumeric() || first == '_' {
                let of_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
                place += rest.find(|c| !of_word(c)).unwrap_or(rest.len());
                return Some((begin, &text[begin..place]));
            } else {
                place += first.len_utf8();
                if first == ';' {
                    return Some((begin, &text[begin..place]));
                }
            }
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mutants::mutant;

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

    #[test]
    fn items_with_mistakes_become_choices() {
        let mistakes = [
            mutant("another unit's", "rest.sv", "a", "b"),
            mutant("wire", "unit.sv", "c = !a", "c = a"),
            mutant("parameter", "unit.sv", "EMPTY(1)", "EMPTY(0)"),
            mutant("register", "unit.sv", "b <= turned(c);", "b <= c;"),
            mutant("condition", "unit.sv", "if (a)", "if (1'b1)"),
            mutant("function", "unit.sv", "turned = !value", "turned = value"),
        ];
        let Switched { text, chosen } = switched("unit.sv", UNIT, &mistakes).unwrap();
        assert_eq!(chosen, [2, 4, 5, 6]);
        let plain: Vec<&str> = text.split_whitespace().collect();
        let plain = plain.join(" ");
        for part in [
            "); int mistake; initial",
            "always_comb begin if (mistake == 2) begin c = a; end else begin c = !a; end end",
            "other #(.EMPTY(1)) rest",
            "function automatic logic turned(input logic value); begin if (mistake == 6) begin turned = value; end else begin turned = !value; end end endfunction",
            "always_ff @(posedge clk) begin if (mistake == 4) begin begin if (a) begin b <= c; end end end else if (mistake == 5) begin begin if (1'b1) begin",
        ] {
            assert!(plain.contains(part), "{part}\n{text}");
        }
    }

    /// The circuits change; a mistake whose place has gone would say so only when it is judged.
    #[test]
    fn every_mistake_has_its_place() {
        let lists: [(&str, &[Mutant], usize); 5] = [
            ("files.txt", &crate::mutants::MUTANTS, 42),
            ("setup_files.txt", &crate::setup::mistakes::MISTAKES, 50),
            ("machine_files.txt", &crate::machine::mistakes::MISTAKES, 22),
            ("order_files.txt", &crate::order::mistakes::MISTAKES, 26),
            (
                "harmonics_files.txt",
                &crate::harmonics::mistakes::MISTAKES,
                41,
            ),
        ];
        for (list, mistakes, choices) in lists {
            let units = units(list).unwrap();
            for mistake in mistakes {
                let unit = units.iter().find(|unit| unit.0 == mistake.file);
                mistake.applied(&unit.unwrap().1).unwrap();
            }
            assert_eq!(chosen(list, mistakes).unwrap().len(), choices, "{list}");
        }
    }

    #[test]
    fn a_unit_without_mistakes_stays_as_it_is() {
        let Switched { text, chosen } = switched("unit.sv", UNIT, &[]).unwrap();
        assert_eq!((text.as_str(), chosen.len()), (UNIT, 0));
    }
}
