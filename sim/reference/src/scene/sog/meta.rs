//! `meta.json` of both versions: ranges of version 1 become codebooks of equal steps, so that the pictures are decoded
//! in one way.

use super::super::error::Problem;
use super::super::gaussian::opacity_from_logit;
use super::META;
use anyhow::{anyhow, bail, ensure};
use serde::{Deserialize, Deserializer};

/// Entries of a palette: one per 16-bit label.
pub(super) const MAX_ENTRIES: usize = 1 << 16;
/// Entries of a codebook: one per byte.
const CODES: usize = 256;

/// What both versions come to, as version 2 states it.
#[derive(Deserialize)]
pub(super) struct Meta {
    pub(super) count: u64,
    /// `antialiased` or `2dgs`; nothing for the usual model.
    pub(super) model: Option<String>,
    pub(super) means: Means,
    pub(super) scales: Coded,
    pub(super) quats: Plain,
    /// Opacity of each byte.
    #[serde(skip, default = "plain_opacity")]
    pub(super) opacity: Vec<f64>,
    pub(super) sh0: Coded,
    #[serde(rename = "shN")]
    pub(super) rest: Option<HarmonicsPalette>,
}

/// A codebook for each of three channels, or one for all.
#[derive(Deserialize)]
pub(super) struct Coded {
    #[serde(rename = "codebook", deserialize_with = "one_for_all")]
    pub(super) books: [Vec<f64>; 3],
    pub(super) files: [String; 1],
}

/// Harmonics that Gaussians share.
#[derive(Deserialize)]
#[serde(from = "Palette2")]
pub(super) struct HarmonicsPalette {
    /// Entries and bands; version 1 leaves both to the picture of the entries.
    pub(super) size: Option<(usize, u8)>,
    pub(super) codebook: Vec<f64>,
    pub(super) files: [String; 2],
}

/// A range per channel, or one for all.
#[derive(Deserialize)]
pub(super) struct Ranged<N, Files = [String; 1]> {
    pub(super) mins: N,
    pub(super) maxs: N,
    pub(super) files: Files,
}

pub(super) type Means = Ranged<[f64; 3], [String; 2]>;

#[derive(Deserialize)]
pub(super) struct Plain {
    pub(super) files: [String; 1],
}

/// The palette of version 2.
#[derive(Deserialize)]
struct Palette2 {
    count: usize,
    bands: u8,
    codebook: Vec<f64>,
    files: [String; 2],
}

impl Coded {
    fn of_ranges(mins: &[f64], maxs: &[f64], files: [String; 1]) -> Coded {
        let books = [0, 1, 2].map(|k| steps(mins[k], maxs[k]));
        Coded { books, files }
    }
}

fn one_for_all<'de, D: Deserializer<'de>>(from: D) -> Result<[Vec<f64>; 3], D::Error> {
    let book = Vec::deserialize(from)?;
    Ok([book.clone(), book.clone(), book])
}

fn plain_opacity() -> Vec<f64> {
    steps(0.0, 1.0)
}

impl From<Palette2> for HarmonicsPalette {
    fn from(palette: Palette2) -> HarmonicsPalette {
        HarmonicsPalette {
            size: Some((palette.count, palette.bands)),
            codebook: palette.codebook,
            files: palette.files,
        }
    }
}

/// What tells the versions apart before the rest is looked at.
#[derive(Deserialize)]
struct Version {
    version: Option<u32>,
}

/// Version 1, which says no version: ranges in the place of codebooks, and the count in the shape of the means.
#[derive(Deserialize)]
struct Meta1 {
    means: Means1,
    scales: Ranged<[f64; 3]>,
    quats: Plain,
    sh0: Ranged<[f64; 4]>,
    #[serde(rename = "shN")]
    rest: Option<Ranged<f64, [String; 2]>>,
}

#[derive(Deserialize)]
struct Means1 {
    shape: Vec<u64>,
    #[serde(flatten)]
    means: Means,
}

/// A codebook of equal steps, which is what a range is.
fn steps(least: f64, greatest: f64) -> Vec<f64> {
    let step = |code: usize| least + (greatest - least) * code as f64 / (CODES - 1) as f64;
    (0..CODES).map(step).collect()
}

impl From<Meta1> for Meta {
    fn from(meta: Meta1) -> Meta {
        let (scales, sh0) = (meta.scales, meta.sh0);
        let logits = steps(sh0.mins[3], sh0.maxs[3]).into_iter();
        Meta {
            count: meta.means.shape.first().copied().unwrap_or(0),
            model: None,
            means: meta.means.means,
            scales: Coded::of_ranges(&scales.mins, &scales.maxs, scales.files),
            quats: meta.quats,
            opacity: logits.map(opacity_from_logit).collect(),
            sh0: Coded::of_ranges(&sh0.mins, &sh0.maxs, sh0.files),
            rest: meta.rest.map(|rest| HarmonicsPalette {
                size: None,
                codebook: steps(rest.mins, rest.maxs),
                files: rest.files,
            }),
        }
    }
}

impl Meta {
    pub(super) fn parse(text: &[u8]) -> Result<Meta, Problem> {
        let wrong = |error: serde_json::Error| {
            anyhow!(
                "{META}: it is not understood: {error}; export the scene again as SOG version 2"
            )
        };
        let Version { version } = serde_json::from_slice(text).map_err(wrong)?;
        let meta: Meta = match version {
            None | Some(1) => serde_json::from_slice::<Meta1>(text).map_err(wrong)?.into(),
            Some(2) => serde_json::from_slice(text).map_err(wrong)?,
            Some(other) => bail!(
                "{META}, version: it is {other}; versions 1 and 2 are read; \
                 convert the scene with a current tool"
            ),
        };
        meta.check()?;
        Ok(meta)
    }

    fn check(&self) -> Result<(), Problem> {
        ensure!(
            self.count != 0,
            "{META}, count: it is 0; export a scene with splats in it"
        );
        let rest = self.rest.as_ref().map(|rest| ("shN", &rest.codebook));
        let books = [
            ("scales", &self.scales.books[0]),
            ("sh0", &self.sh0.books[0]),
        ];
        for (name, book) in books.into_iter().chain(rest) {
            ensure!(
                book.len() == CODES,
                "{META}, {name}.codebook: it has {} entries; {CODES} are needed, one per byte; \
                 export the scene again",
                book.len()
            );
        }
        match self.rest.as_ref().and_then(|rest| rest.size) {
            Some((_, bands)) if !(1..=3).contains(&bands) => {
                bail!("{META}, shN.bands: it is {bands}; 1 to 3 are read; export the scene again")
            }
            Some((entries, _)) if entries == 0 || entries > MAX_ENTRIES => bail!(
                "{META}, shN.count: the palette has {entries} entries; 1 to 65536 have a label; \
                 export the scene again"
            ),
            _ => Ok(()),
        }
    }

    pub(super) fn files(&self) -> impl Iterator<Item = &String> {
        let rest = self.rest.iter().flat_map(|rest| &rest.files);
        let single = [&self.scales.files, &self.sh0.files, &self.quats.files];
        let single = single.into_iter().flatten();
        self.means.files.iter().chain(single).chain(rest)
    }
}
