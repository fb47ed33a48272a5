//! Transfer functions as TOML; errors name the key and the line.

use serde::Deserialize;
use toml::Spanned;

use super::super::error::Problem;
use super::{GradientPoint, Shading, Transfer, ValuePoint};
use crate::input::line_at;
use anyhow::{anyhow, ensure};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TransferFile {
    #[serde(default)]
    value: Vec<FileValue>,
    #[serde(default)]
    gradient: Vec<FileGradient>,
    #[serde(default)]
    shading: FileShading,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FileValue {
    at: Spanned<f64>,
    colour: Spanned<[f64; 3]>,
    extinction: Spanned<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FileGradient {
    at: Spanned<f64>,
    multiplier: Spanned<f64>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
struct FileShading {
    ambient: Option<Spanned<f64>>,
    diffuse: Option<Spanned<f64>>,
    specular: Option<Spanned<f64>>,
    exponent: Option<Spanned<f64>>,
    surface: Option<Spanned<f64>>,
}

impl Transfer {
    /// Reads a transfer function from TOML text.
    pub fn from_toml(text: &str) -> Result<Transfer, Problem> {
        let file: TransferFile =
            toml::from_str(text).map_err(|error| syntax_error(text, &error))?;
        let check = TransferCheck { text };
        ensure!(
            !file.value.is_empty(),
            "transfer, key 'value': it is missing; add [[value]] control points"
        );
        check.increasing("value.at", file.value.iter().map(|point| &point.at))?;
        check.increasing("gradient.at", file.gradient.iter().map(|point| &point.at))?;
        Ok(Transfer {
            values: file
                .value
                .iter()
                .map(|point| check.value_point(point))
                .collect::<Result<_, _>>()?,
            gradients: file
                .gradient
                .iter()
                .map(|point| check.gradient_point(point))
                .collect::<Result<_, _>>()?,
            shading: check.shading(&file.shading)?,
        })
    }
}

/// Checks of meaning that know the text, so that errors can name lines.
struct TransferCheck<'a> {
    text: &'a str,
}

impl TransferCheck<'_> {
    fn value_point(&self, point: &FileValue) -> Result<ValuePoint, Problem> {
        let colour = *point.colour.get_ref();
        if !colour.iter().all(|channel| (0.0..=1.0).contains(channel)) {
            let start = point.colour.span().start;
            return Err(self.refuse(
                "value.colour",
                start,
                format!("it is {colour:?}"),
                "write RGB from 0 to 1",
            ));
        }
        let extinction = self.not_negative("value.extinction", &point.extinction)?;
        Ok(ValuePoint {
            at: *point.at.get_ref(),
            colour,
            extinction,
        })
    }

    fn gradient_point(&self, point: &FileGradient) -> Result<GradientPoint, Problem> {
        let multiplier = self.not_negative("gradient.multiplier", &point.multiplier)?;
        Ok(GradientPoint {
            at: *point.at.get_ref(),
            multiplier,
        })
    }

    fn shading(&self, shading: &FileShading) -> Result<Shading, Problem> {
        let term = |key: &str, value: &Option<Spanned<f64>>, default: f64| match value {
            Some(value) => self.not_negative(key, value),
            None => Ok(default),
        };
        let default = Shading::default();
        Ok(Shading {
            ambient: term("shading.ambient", &shading.ambient, default.ambient)?,
            diffuse: term("shading.diffuse", &shading.diffuse, default.diffuse)?,
            specular: term("shading.specular", &shading.specular, default.specular)?,
            exponent: term("shading.exponent", &shading.exponent, default.exponent)?,
            surface: term("shading.surface", &shading.surface, default.surface)?,
        })
    }

    fn not_negative(&self, key: &str, value: &Spanned<f64>) -> Result<f64, Problem> {
        let number = *value.get_ref();
        // The upper bound keeps every later product finite.
        if (0.0..=1e12).contains(&number) {
            return Ok(number);
        }
        Err(self.refuse(
            key,
            value.span().start,
            format!("it is {number}"),
            "write a number from 0 to 1e12",
        ))
    }

    fn increasing<'v>(
        &self,
        key: &str,
        places: impl Iterator<Item = &'v Spanned<f64>>,
    ) -> Result<(), Problem> {
        let mut previous = f64::NEG_INFINITY;
        for place in places {
            let at = *place.get_ref();
            if !at.is_finite() || at <= previous {
                let found = format!("it is {at} after {previous}");
                return Err(self.refuse(
                    key,
                    place.span().start,
                    found,
                    "order the control points by increasing 'at'",
                ));
            }
            previous = at;
        }
        Ok(())
    }

    fn refuse(&self, key: &str, byte: usize, found: String, fix: &str) -> Problem {
        anyhow!(
            "transfer line {}, key '{key}': {found}; {fix}",
            line_at(self.text, byte)
        )
    }
}

fn syntax_error(text: &str, error: &toml::de::Error) -> Problem {
    let line = line_at(text, error.span().map_or(0, |span| span.start));
    let shown = text.lines().nth(line - 1).unwrap_or_default().trim();
    anyhow!(
        "transfer line {line}, '{shown}': {}; correct the line; docs/files.md lists the keys",
        error.message().replace('\n', " ")
    )
}
