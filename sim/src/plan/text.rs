//! A plan's parts as text: what reports record in full, and what a plan file may leave out.

use super::DesignVariant;
use crate::design::{DesignChoice, some_traversal};
use crate::rules::{Kernel, Rules};
use serde::de::Error as _;
use serde::{Deserialize, Deserializer};
use splatline::format::Traversal;

/// What a plan file may say of rules.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RulesChanges {
    name: String,
    kernel: Option<Kernel>,
    normalised: Option<bool>,
    low_pass: Option<f64>,
    compensated: Option<bool>,
    spacing: Option<f64>,
    cutoff: Option<f64>,
    alpha_max: Option<f64>,
    alpha_min: Option<f64>,
    minimum_transmittance: Option<f64>,
    omit_finishing: Option<bool>,
    clamp_jacobian: Option<bool>,
}

/// Rules as a report states them: the named ones with every number its own. A plan file names them and gives what
/// differs.
pub(super) fn rules<'de, D: Deserializer<'de>>(from: D) -> Result<Rules, D::Error> {
    let changes = RulesChanges::deserialize(from)?;
    let named: Rules = changes.name.parse().map_err(D::Error::custom)?;
    let named = named.with_kernel(changes.kernel.unwrap_or(named.kernel));
    let number = |key, given: Option<f64>, usual, most: f64| match given {
        Some(value) if !(0.0..=most).contains(&value) => Err(D::Error::custom(format!(
            "{key} = {value}: allowed is 0 to {most:?}"
        ))),
        _ => Ok(given.unwrap_or(usual)),
    };
    Ok(Rules {
        name: named.name,
        kernel: named.kernel,
        normalised: changes.normalised.unwrap_or(named.normalised),
        low_pass: number("low_pass", changes.low_pass, named.low_pass, f64::MAX)?,
        compensated: changes.compensated.unwrap_or(named.compensated),
        spacing: number("spacing", changes.spacing, named.spacing, f64::MAX)?,
        // A report writes an infinite cut-off as null; no named rules with a finite one can have it.
        cutoff: number("cutoff", changes.cutoff, named.cutoff, f64::INFINITY)?,
        alpha_max: number("alpha_max", changes.alpha_max, named.alpha_max, 1.0)?,
        alpha_min: number("alpha_min", changes.alpha_min, named.alpha_min, 1.0)?,
        minimum_transmittance: number(
            "minimum_transmittance",
            changes.minimum_transmittance,
            named.minimum_transmittance,
            1.0,
        )?,
        omit_finishing: changes.omit_finishing.unwrap_or(named.omit_finishing),
        clamp_jacobian: changes.clamp_jacobian.unwrap_or(named.clamp_jacobian),
    })
}

/// A design in full or by its name, and the traversal if it is not the design's own.
#[derive(Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct VariantText {
    design: DesignText,
    #[serde(deserialize_with = "some_traversal")]
    traversal: Option<Traversal>,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum DesignText {
    Name(String),
    Full(DesignChoice),
}

impl Default for VariantText {
    fn default() -> Self {
        VariantText {
            design: DesignText::Name("standard24".to_owned()),
            traversal: None,
        }
    }
}

impl TryFrom<VariantText> for DesignVariant {
    type Error = String;

    fn try_from(text: VariantText) -> Result<DesignVariant, String> {
        let design = match text.design {
            DesignText::Full(design) => design,
            DesignText::Name(name) => {
                DesignChoice::named(&name).ok_or_else(|| format!("no design is named '{name}'"))?
            }
        };
        Ok(DesignVariant::new(design, text.traversal))
    }
}
