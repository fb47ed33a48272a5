//! Transfer functions as TOML; errors name the key and the line.

use super::super::error::Problem;
use super::Transfer;
use crate::input::{line_at, line_of};
use anyhow::{anyhow, bail, ensure};

impl Transfer {
    /// Reads a transfer function from TOML text.
    pub fn from_toml(text: &str) -> Result<Transfer, Problem> {
        let transfer: Transfer =
            toml::from_str(text).map_err(|error| syntax_error(text, &error))?;
        ensure!(
            !transfer.values.is_empty(),
            "transfer, key 'value': it is missing; add [[value]] control points"
        );
        increasing(text, "value", transfer.values.iter().map(|point| point.at))?;
        increasing(
            text,
            "gradient",
            transfer.gradients.iter().map(|point| point.at),
        )?;
        for (index, point) in transfer.values.iter().enumerate() {
            let (place, colour) = (index.to_string(), point.colour);
            if !colour.iter().all(|channel| (0.0..=1.0).contains(channel)) {
                let keys = ["value", &place, "colour"];
                bail!(
                    "{}: it is {colour:?}; write RGB from 0 to 1",
                    field(text, &keys)
                );
            }
            not_negative(text, &["value", &place, "extinction"], point.extinction)?;
        }
        for (index, point) in transfer.gradients.iter().enumerate() {
            let keys = ["gradient", &index.to_string(), "multiplier"];
            not_negative(text, &keys, point.multiplier)?;
        }
        let shading = &transfer.shading;
        for (key, number) in [
            ("ambient", shading.ambient),
            ("diffuse", shading.diffuse),
            ("specular", shading.specular),
            ("exponent", shading.exponent),
            ("surface", shading.surface),
        ] {
            not_negative(text, &["shading", key], number)?;
        }
        Ok(transfer)
    }
}

fn not_negative(text: &str, keys: &[&str], number: f64) -> Result<(), Problem> {
    // The upper bound keeps every later product finite.
    ensure!(
        (0.0..=1e12).contains(&number),
        "{}: it is {number}; write a number from 0 to 1e12",
        field(text, keys)
    );
    Ok(())
}

fn increasing(text: &str, list: &str, places: impl Iterator<Item = f64>) -> Result<(), Problem> {
    let mut previous = f64::NEG_INFINITY;
    for (index, at) in places.enumerate() {
        ensure!(
            at.is_finite() && at > previous,
            "{}: it is {at} after {previous}; order the control points by increasing 'at'",
            field(text, &[list, &index.to_string(), "at"])
        );
        previous = at;
    }
    Ok(())
}

/// A key with its line; what is between its first and last name is its place in a list.
fn field(text: &str, keys: &[&str]) -> String {
    let (first, last) = (keys[0], keys[keys.len() - 1]);
    format!(
        "transfer line {}, key '{first}.{last}'",
        line_of(text, keys)
    )
}

fn syntax_error(text: &str, error: &toml::de::Error) -> Problem {
    let line = line_at(text, error.span().map_or(0, |span| span.start));
    let shown = text.lines().nth(line - 1).unwrap_or_default().trim();
    anyhow!(
        "transfer line {line}, '{shown}': {}; correct the line; docs/files.md lists the keys",
        error.message().replace('\n', " ")
    )
}
