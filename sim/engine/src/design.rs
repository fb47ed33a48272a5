//! Designs by name or from a TOML file.
//!
//! A file names the design it starts from and the widths it changes:
//!
//! ```toml
//! base = "standard24"   # classic8, micro16, lean18, standard24 or deep32
//! mantissa = 20
//! alpha = 16
//! rounding = "truncate" # or "nearest", "nearest-even"
//! traversal = "box"     # or "spans"
//! ```

use crate::input::{self, Refused, line_of};
use serde::{Deserialize, Deserializer, Serialize};
use splatline::format::{
    Classic8, Deep32, Design, Lane, Lean18, Micro16, Rounding, RuntimeWidths, Standard24,
    Traversal, WIDTH_RANGES, WidthError, Widths,
};
use std::borrow::Cow;
use std::path::Path;

/// The named designs, from the cheapest to the most accurate.
pub const NAMES: [&str; 5] = ["classic8", "micro16", "lean18", "standard24", "deep32"];

/// A design as the command line chose it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(into = "ResolvedDesign", try_from = "ResolvedDesign")]
pub struct DesignChoice {
    /// Name of the design or of its file.
    pub name: String,
    /// Its widths.
    pub widths: Widths,
    /// Its own traversal, used unless the command line asks for another.
    pub traversal: Traversal,
    /// Bits of its lanes, in which the radial indices of setup's footprints are the same: vectors draw 32 sooner than
    /// 64.
    lane_bits: u32,
}

impl DesignChoice {
    /// A named design, or the design in a TOML file.
    pub fn load(name: &str) -> Result<Self, Refused> {
        match Self::named(name) {
            Some(choice) => Ok(choice),
            None if name.ends_with(".toml") => Self::from_file(Path::new(name)),
            None => Err(Refused(format!(
                "unknown design '{name}': expected {} or a file that ends in .toml",
                NAMES.join(", ")
            ))),
        }
    }

    /// A design of [`NAMES`].
    pub fn named(name: &str) -> Option<Self> {
        fn of<D: Design>(name: &str, design: D, traversal: Traversal) -> DesignChoice {
            DesignChoice {
                name: name.to_owned(),
                widths: design.widths(),
                traversal,
                lane_bits: D::Lane::BITS,
            }
        }
        Some(match name {
            "classic8" => of(name, Classic8, Traversal::Box),
            "micro16" => of(name, Micro16, Traversal::Spans),
            "lean18" => of(name, Lean18, Traversal::Spans),
            "standard24" => of(name, Standard24, Traversal::Spans),
            "deep32" => of(name, Deep32, Traversal::Spans),
            _ => return None,
        })
    }

    /// All named designs.
    pub fn all() -> Vec<Self> {
        NAMES.iter().filter_map(|name| Self::named(name)).collect()
    }

    /// Bits of its lanes.
    pub fn lane_bits(&self) -> u32 {
        self.lane_bits
    }

    /// The same in lanes of 64 bits: what widths chosen at run time have.
    pub fn at_run_time(&self) -> Self {
        DesignChoice {
            lane_bits: i64::BITS,
            ..self.clone()
        }
    }

    /// What the host draws by: widths in fields. The bits are those of a type with constant widths, one compiled copy
    /// serves all designs, and beside vectors constants gain nothing that can be measured.
    pub fn in_fields(&self) -> RuntimeWidths {
        RuntimeWidths::new(self.widths).expect("widths are checked when a choice is made")
    }

    /// The same in the design's own lanes, if they have 32 bits.
    pub fn in_short_lanes(&self) -> Option<RuntimeWidths<i32>> {
        let short = self.lane_bits == i32::BITS;
        short.then(|| {
            RuntimeWidths::for_lanes(self.widths).expect("only a named design's are short")
        })
    }

    /// The resolved design for reports.
    pub fn resolved(&self) -> ResolvedDesign {
        let mut widths = serde_json::Map::new();
        for ((field, ..), value) in WIDTH_RANGES.iter().zip(self.widths.numbers()) {
            widths.insert((*field).to_owned(), value.into());
        }
        ResolvedDesign {
            name: self.name.clone(),
            traversal: traversal_name(self.traversal).into(),
            rounding: match self.widths.rounding {
                Rounding::Nearest => "nearest".into(),
                Rounding::NearestEven => "nearest-even".into(),
                Rounding::Truncate => "truncate".into(),
            },
            widths,
        }
    }

    fn from_file(path: &Path) -> Result<Self, Refused> {
        let file = path.display().to_string();
        let text = input::text(path, input::SETTINGS)
            .map_err(|error| Refused(format!("{file}: cannot read the design: {error}")))?;
        Self::from_toml(&file, &text)
    }

    /// Parses the text of a design file; `file` is its name for messages.
    pub fn from_toml(file: &str, text: &str) -> Result<Self, Refused> {
        let choice = Self::unchecked(file, text)?;
        choice.widths.check().map_err(|error| {
            let line = line_of(text, &[error.field]);
            Refused(format!("{file}:{line}: {}", out_of_range(&error)))
        })?;
        Ok(choice)
    }

    /// The same with widths that may be out of their ranges, or exclude each other.
    pub fn unchecked(file: &str, text: &str) -> Result<Self, Refused> {
        let parsed: DesignFile =
            toml::from_str(text).map_err(|error| Refused(format!("{file}: {error}")))?;
        let Some(mut choice) = Self::named(&parsed.base) else {
            let (base, names) = (&parsed.base, NAMES.join(", "));
            return Err(Refused(format!(
                "{file}: base = \"{base}\": expected one of {names}"
            )));
        };
        choice.lane_bits = i64::BITS;
        choice.name = Path::new(file)
            .file_stem()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        parsed.apply(&mut choice);
        Ok(choice)
    }
}

/// Which width is refused, and what it may be.
pub fn out_of_range(error: &WidthError) -> String {
    let (field, value, (low, high)) = (error.field, error.value, error.range);
    format!("{field} = {value} is out of range: allowed are {low} to {high}")
}

/// A design with every field resolved, as reports show it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ResolvedDesign {
    /// Name of the design or of its file.
    pub name: String,
    /// `box` or `spans`.
    pub traversal: Cow<'static, str>,
    /// `nearest`, `nearest-even` or `truncate`.
    pub rounding: Cow<'static, str>,
    /// Bits of every quantity.
    pub widths: serde_json::Map<String, serde_json::Value>,
}

impl ResolvedDesign {
    /// The same as a design file.
    pub fn to_toml(&self) -> String {
        let ResolvedDesign {
            traversal,
            rounding,
            widths,
            ..
        } = self;
        let widths = widths.iter();
        let lines: String = widths
            .map(|(name, bits)| format!("{name} = {bits}\n"))
            .collect();
        format!(
            "base = \"standard24\"\nrounding = \"{rounding}\"\ntraversal = \"{traversal}\"\n{lines}"
        )
    }
}

impl From<DesignChoice> for ResolvedDesign {
    fn from(choice: DesignChoice) -> ResolvedDesign {
        choice.resolved()
    }
}

/// A named design with its constants if it has the widths of that name; otherwise one with the widths in fields,
/// through the text of a design file, which checks all ranges.
impl TryFrom<ResolvedDesign> for DesignChoice {
    type Error = Refused;

    fn try_from(resolved: ResolvedDesign) -> Result<DesignChoice, Refused> {
        let mut choice = DesignChoice::from_toml("design", &resolved.to_toml())?;
        choice.name.clone_from(&resolved.name);
        let named = DesignChoice::named(&resolved.name);
        if let Some(named) = named.filter(|named| named.widths == choice.widths) {
            choice.lane_bits = named.lane_bits;
        }
        Ok(choice)
    }
}

/// A traversal as its name, for serde.
#[derive(Serialize, Deserialize)]
#[serde(remote = "Traversal", rename_all = "lowercase")]
pub enum TraversalByName {
    /// `box`.
    Box,
    /// `spans`.
    Spans,
}

/// A traversal that a file may leave out.
pub fn some_traversal<'de, D: Deserializer<'de>>(from: D) -> Result<Option<Traversal>, D::Error> {
    TraversalByName::deserialize(from).map(Some)
}

/// Name of a traversal on the command line.
pub fn traversal_name(traversal: Traversal) -> &'static str {
    match traversal {
        Traversal::Box => "box",
        Traversal::Spans => "spans",
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct DesignFile {
    base: String,
    position: Option<u8>,
    view: Option<u8>,
    mantissa: Option<u8>,
    subpixel: Option<u8>,
    radial: Option<u8>,
    table: Option<u8>,
    interpolation: Option<u8>,
    weight: Option<u8>,
    peak: Option<u8>,
    alpha: Option<u8>,
    transmittance: Option<u8>,
    colour: Option<u8>,
    accumulator: Option<u8>,
    #[serde(default, deserialize_with = "some_rounding")]
    rounding: Option<Rounding>,
    #[serde(default, deserialize_with = "some_traversal")]
    traversal: Option<Traversal>,
}

#[derive(Deserialize)]
#[serde(remote = "Rounding", rename_all = "kebab-case")]
enum RoundingByName {
    Nearest,
    NearestEven,
    Truncate,
}

fn some_rounding<'de, D: Deserializer<'de>>(from: D) -> Result<Option<Rounding>, D::Error> {
    RoundingByName::deserialize(from).map(Some)
}

impl DesignFile {
    fn apply(&self, choice: &mut DesignChoice) {
        let base = choice.widths;
        choice.widths = Widths {
            position: self.position.unwrap_or(base.position),
            view: self.view.unwrap_or(base.view),
            mantissa: self.mantissa.unwrap_or(base.mantissa),
            subpixel: self.subpixel.unwrap_or(base.subpixel),
            radial: self.radial.unwrap_or(base.radial),
            table: self.table.unwrap_or(base.table),
            interpolation: self.interpolation.unwrap_or(base.interpolation),
            weight: self.weight.unwrap_or(base.weight),
            peak: self.peak.unwrap_or(base.peak),
            alpha: self.alpha.unwrap_or(base.alpha),
            transmittance: self.transmittance.unwrap_or(base.transmittance),
            colour: self.colour.unwrap_or(base.colour),
            accumulator: self.accumulator.unwrap_or(base.accumulator),
            rounding: self.rounding.unwrap_or(base.rounding),
        };
        choice.traversal = self.traversal.unwrap_or(choice.traversal);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_changes_its_base() {
        let text =
            "base = \"standard24\"\nmantissa = 20\nrounding = \"truncate\"\ntraversal = \"box\"\n";
        let choice = DesignChoice::from_toml("dir/mine.toml", text).unwrap();
        let expected = Widths {
            mantissa: 20,
            rounding: Rounding::Truncate,
            ..Standard24::WIDTHS
        };
        assert_eq!(
            (choice.name.as_str(), choice.widths, choice.traversal),
            ("mine", expected, Traversal::Box)
        );
    }

    #[test]
    fn errors_name_file_line_and_range() {
        let message = |text: &str| {
            DesignChoice::from_toml("d.toml", text)
                .unwrap_err()
                .to_string()
        };
        assert_eq!(
            message("base = \"lean18\"\n\nmantissa = 40\n"),
            "d.toml:3: mantissa = 40 is out of range: allowed are 8 to 31"
        );
        assert_eq!(
            message("base = \"lean18\"\nradial = 8\ntable = 11\n"),
            "d.toml:3: table = 11 is out of range: allowed are 2 to 10"
        );
        assert_eq!(
            message("base = \"standard24\"\nrounding = \"nearest-even\"\n"),
            "d.toml:1: accumulator = 26 is out of range: allowed are 4 to 23"
        );
        assert!(message("base = \"lean18\"\nmantisa = 4\n").contains("unknown field `mantisa`"));
        assert!(message("base = \"lean18\"\nmantisa = 4\n").contains("line 2"));
        assert!(message("base = \"lean\"").contains("expected one of classic8, micro16, lean18"));
        assert!(message("base = 3").contains("line 1"));
        assert!(
            DesignChoice::load("nonesuch")
                .unwrap_err()
                .to_string()
                .contains("unknown design 'nonesuch'")
        );
    }
}
