//! One stage's records: fields, their places, and the text form.

use super::record::{Words, record};
use serde::{Deserialize, Serialize};
use std::fmt::Write;

/// A field of a record.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct RecordField {
    /// Name.
    pub name: String,
    /// First bit, counted from the record's least significant.
    pub offset: usize,
    /// Bits, at most 64.
    pub bits: usize,
    /// Two's complement?
    pub signed: bool,
    /// Fraction bits; 0 for integers, mantissas and exponents.
    pub fraction: usize,
}

impl RecordField {
    /// Of 64 bits, those left of the field.
    fn spare(&self) -> u32 {
        64 - self.bits as u32
    }

    /// What the field holds in a record of these words, the least significant first; bits behind the last word are
    /// zeros.
    pub(super) fn value(&self, words: &[u64]) -> i64 {
        let word = |index: usize| words.get(index).copied().unwrap_or(0);
        let (index, shift) = (self.offset / 64, self.offset % 64);
        // In two steps, since a shift by 64 is none.
        let bits = word(index) >> shift | word(index + 1) << 1 << (63 - shift);
        let top = bits.unbounded_shl(self.spare());
        if self.signed {
            top.cast_signed().unbounded_shr(self.spare())
        } else {
            top.unbounded_shr(self.spare()).cast_signed()
        }
    }

    /// Puts a value's least significant bits into a record of zeros that has a word more than its bits need.
    fn put(&self, words: &mut [u64], value: i64) {
        let top = value.cast_unsigned().unbounded_shl(self.spare());
        let bits = top.unbounded_shr(self.spare());
        let (index, shift) = (self.offset / 64, self.offset % 64);
        words[index] |= bits << shift;
        words[index + 1] |= bits >> 1 >> (63 - shift);
    }
}

/// FNV-1a: not against forgery, but for finding out that a file has changed.
pub fn digest(bytes: &[u8]) -> String {
    let step = |hash: u64, byte: &u8| (hash ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3);
    format!("{:016x}", bytes.iter().fold(0xcbf2_9ce4_8422_2325, step))
}

/// A stage's table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct VectorStage {
    /// Name; the file is `NAME.hex`.
    pub name: &'static str,
    /// What a record is.
    pub about: &'static str,
    /// The fields.
    pub fields: Vec<RecordField>,
    /// One value per field and record.
    pub records: Vec<Vec<i64>>,
}

impl VectorStage {
    /// A stage without records, of fields `name*count:-bits.fraction`; without `*` one, without `-` not signed, without
    /// `.` an integer, without `:` a word of 32 bits. `name:n` is mantissa and exponent.
    pub(super) fn new(name: &'static str, about: &'static str, fields: &str) -> Self {
        let mut stage = VectorStage {
            name,
            about,
            fields: Vec::new(),
            records: Vec::new(),
        };
        for text in fields.split_whitespace() {
            let (name, format) = text.split_once(':').unwrap_or((text, "32"));
            let (name, count) = name.split_once('*').unwrap_or((name, "1"));
            let (bits, fraction) = format.split_once('.').unwrap_or((format, "0"));
            let number = |text: &str| text.trim_start_matches('-').parse().unwrap_or(1);
            let names: Vec<String> = match (bits, number(count)) {
                ("n", _) => vec![format!("{name}_mantissa"), format!("{name}_exponent")],
                (_, 1) => vec![name.to_owned()],
                (_, count) => (0..count).map(|place| format!("{name}_{place}")).collect(),
            };
            let bits = if bits == "n" { "-32" } else { bits };
            for name in names {
                stage.fields.push(RecordField {
                    name,
                    offset: stage.bits(),
                    bits: number(bits),
                    signed: bits.starts_with('-'),
                    fraction: number(fraction),
                });
            }
        }
        stage
    }

    /// A stage with a record for each of these.
    pub(super) fn of(
        name: &'static str,
        about: &'static str,
        fields: &str,
        all: &[impl Words],
    ) -> Self {
        let mut stage = VectorStage::new(name, about, fields);
        stage.fill(all);
        stage
    }

    /// Gives it a record for each of these.
    pub(super) fn fill(&mut self, all: &[impl Words]) {
        self.records = all.iter().map(|one| record![one]).collect();
    }

    /// One more record.
    pub(super) fn add(&mut self, record: Vec<i64>) {
        self.records.push(record);
    }

    /// Bits of a record.
    pub fn bits(&self) -> usize {
        self.fields.last().map_or(0, |last| last.offset + last.bits)
    }

    /// The file's text.
    pub fn to_text(&self) -> String {
        let mut text = format!("// {}: {}\n", self.name, self.about);
        for record in &self.records {
            self.write_record(&mut text, record);
        }
        text
    }

    /// Zeros for a record's bits, and a word more.
    fn words(&self) -> Vec<u64> {
        vec![0; self.bits() / 64 + 2]
    }

    fn write_record(&self, text: &mut String, record: &[i64]) {
        let mut words = self.words();
        for (field, value) in self.fields.iter().zip(record) {
            field.put(&mut words, *value);
        }
        // Sixteen digits a word, the last word first, which has what remains.
        let digits = self.bits().div_ceil(4);
        for (at, word) in words.iter().enumerate().take(digits.div_ceil(16)).rev() {
            let width = (digits - 16 * at).min(16);
            let _ = write!(text, "{word:0width$x}"); // A string takes all.
        }
        text.push('\n');
    }

    /// Reads the records of a file's text. The message names the line and what is wrong with it.
    pub fn parse(&self, text: &str) -> Result<Vec<Vec<i64>>, String> {
        let mut records = Vec::new();
        for (index, line) in text.lines().enumerate() {
            let line = line.split("//").next().unwrap_or_default();
            for word in line.split_ascii_whitespace() {
                let record = self.parse_record(word);
                records.push(record.map_err(|message| format!("line {}: {message}", index + 1))?);
            }
        }
        Ok(records)
    }

    fn parse_record(&self, word: &str) -> Result<Vec<i64>, String> {
        let bits = self.bits();
        let mut words = self.words();
        let mut too_long = false;
        for (at, digit) in word.chars().rev().filter(|c| *c != '_').enumerate() {
            let Some(value) = digit.to_digit(16) else {
                return Err(format!(
                    "'{digit}' is not a hexadecimal digit (x and z mean that a bit is undefined)"
                ));
            };
            too_long |= value >> bits.saturating_sub(4 * at).min(4) != 0;
            if let Some(word) = words.get_mut(at / 16) {
                *word |= u64::from(value) << (4 * (at % 16));
            }
        }
        if too_long {
            return Err(format!("the record has more than {bits} bits"));
        }
        let values = self.fields.iter().map(|field| field.value(&words));
        Ok(values.collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stage() -> VectorStage {
        VectorStage::new("test", "", "a:-3 b:-64 c:5.2")
    }

    #[test]
    fn records_are_written_least_significant_field_first() {
        let mut stage = stage();
        stage.records = vec![vec![-1, 0, 0], vec![0, i64::MIN, 0x11], vec![3, -2, 31]];
        let text = stage.to_text();
        let lines = [
            "// test: ",
            "000000000000000007",
            "8c0000000000000000",
            "fffffffffffffffff3",
        ];
        assert_eq!(text, lines.join("\n") + "\n");
        assert_eq!(stage.parse(&text), Ok(stage.records.clone()));
    }

    /// Fields of every width at every place within a word, against one number of 128 bits.
    #[test]
    fn fields_are_the_bits_of_one_number() {
        let all = (1..64usize).flat_map(|before| (1..=64).map(move |bits| (before, bits)));
        for (before, bits) in all {
            for signed in [false, true] {
                let sign = if signed { "-" } else { "" };
                let fields = format!("before:{before} field:{sign}{bits}");
                let mut stage = VectorStage::new("test", "", &fields);
                let mask = u64::MAX >> (64 - bits);
                let words = [0, 1, u64::MAX, 1 << (bits - 1), 0x9e37_79b9_7f4a_7c15];
                for word in words.map(|word| word & mask) {
                    let negative = signed && word >> (bits - 1) == 1;
                    let value = if negative { word | !mask } else { word } as i64;
                    let digits = (before + bits).div_ceil(4);
                    let number = u128::from(word) << before;
                    stage.records = vec![vec![0, value]];
                    let text = stage.to_text();
                    assert_eq!(text, format!("// test: \n{number:0digits$x}\n"));
                    assert_eq!(stage.parse(&text), Ok(stage.records.clone()));
                }
            }
        }
    }

    #[test]
    fn what_is_not_a_record_is_named() {
        let comment = stage().parse("\n// only a comment\n00_07\n");
        assert_eq!(comment, Ok(vec![vec![-1, 0, 0]]));
        let undefined = stage().parse("1\nxx").unwrap_err();
        assert!(undefined.starts_with("line 2: 'x' is not"), "{undefined}");
        let long = stage().parse("1ff0000000000000000000").unwrap_err();
        assert_eq!(long, "line 1: the record has more than 72 bits");
    }
}
