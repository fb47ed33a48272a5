//! What headers of lines have in common, NRRD's and MetaImage's: fields by name, each with the line on which it stands.

use super::super::error::{Problem, shorten};
use super::numbers;
use anyhow::anyhow;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt::Display;

/// The fields that matter, by their names in lower case.
pub struct LineHeader {
    format: &'static str,
    found: BTreeMap<String, HeaderField>,
    /// Lines read so far.
    pub lines: usize,
}

/// A field as it stands in the file.
pub struct HeaderField {
    format: &'static str,
    line: usize,
    name: String,
    pub value: String,
}

fn malformed(
    format: &str,
    line: usize,
    field: &str,
    found: impl Display,
    fix: impl Display,
) -> Problem {
    anyhow!("{format} header line {line}, {field}: {found}; {fix}")
}

impl LineHeader {
    /// Of a format, no line of which has been read.
    pub fn new(format: &'static str) -> LineHeader {
        LineHeader {
            format,
            found: BTreeMap::new(),
            lines: 0,
        }
    }

    /// Takes the next line off `rest`; its end is left out.
    pub fn next_line<'a>(&mut self, rest: &mut &'a [u8]) -> Result<Cow<'a, str>, Problem> {
        let end = rest.iter().position(|byte| *byte == b'\n');
        let (line, after) = rest.split_at(end.unwrap_or(rest.len()));
        let line = line.strip_suffix(b"\r").unwrap_or(line);
        self.lines += 1;
        if end.is_none() && !line.is_empty() {
            let found = "it ends in the middle of a line";
            return Err(self.malformed("header", found, "fetch the file again"));
        }
        *rest = after.get(1..).unwrap_or_default();
        Ok(String::from_utf8_lossy(line))
    }

    /// A problem of the line that was read last.
    pub fn malformed(&self, field: &str, found: impl Display, fix: &str) -> Problem {
        malformed(self.format, self.lines, &shorten(field), found, fix)
    }

    /// The line that was read last has no field.
    pub fn no_field(&self, line: &str, form: &str) -> Problem {
        let found = format!("'{}' is no field", shorten(line));
        self.malformed("header", found, &format!("write '{form}'"))
    }

    /// Nobody knows what the field of the line that was read last does to the data.
    pub fn unsupported(&self, name: &str) -> Problem {
        let fix = "remove it if the data can be read without it, or convert the volume";
        self.malformed(name, "this field is not supported", fix)
    }

    /// Keeps the field of the line that was read last, whose name is a way to write `key`.
    pub fn add(&mut self, key: &str, name: &str, value: &str) -> Result<(), Problem> {
        let field = HeaderField {
            format: self.format,
            line: self.lines,
            name: name.to_owned(),
            value: value.trim().to_owned(),
        };
        match self.found.insert(key.to_owned(), field) {
            Some(_) => Err(self.malformed(name, "it is given twice", "give it once")),
            None => Ok(()),
        }
    }

    /// A field that there may be.
    pub fn get(&self, key: &str) -> Option<&HeaderField> {
        self.found.get(key)
    }

    /// A field that there must be.
    pub fn required(&self, key: &str) -> Result<&HeaderField, Problem> {
        let lacks = || self.malformed(key, "the header lacks it", "add it before the data");
        self.get(key).ok_or_else(lacks)
    }
}

impl HeaderField {
    /// A problem of this field.
    pub fn malformed(&self, found: impl Display, fix: &str) -> Problem {
        malformed(self.format, self.line, &self.name, found, fix)
    }

    /// Its value is not what it must be.
    pub fn is_not(&self, wanted: &str, fix: &str) -> Problem {
        self.malformed(format!("'{}' is not {wanted}", shorten(&self.value)), fix)
    }

    /// Its value is another one than is read.
    pub fn is(&self, fix: &str) -> Problem {
        self.malformed(format!("it is '{}'", shorten(&self.value)), fix)
    }

    /// Its value as voxels along the axes.
    pub fn sizes(&self) -> Result<[usize; 3], Problem> {
        let fix = "write the number of voxels along x, y and z";
        let sizes = numbers(&self.value).filter(|sizes: &[usize; 3]| !sizes.contains(&0));
        sizes.ok_or_else(|| self.is_not("three positive whole numbers", fix))
    }

    /// Its value as distances between voxels, if it is that.
    pub fn spacings(&self, read: Option<[f64; 3]>) -> Result<[f64; 3], Problem> {
        let fix = "write the distances between voxels along x, y and z";
        read.ok_or_else(|| self.is_not("three positive lengths", fix))
    }

    /// Its value as the name of the file with the data.
    pub fn data_file(&self) -> Result<&str, Problem> {
        let name = self.value.as_str();
        if name.is_empty() || name.contains('%') || name.starts_with("LIST") {
            return Err(self.is_not("one file", "join the slices into one data file"));
        }
        Ok(name)
    }
}
