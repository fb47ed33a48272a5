//! The golden table: one small plan for each of the papers' systems, with the figures and the bits of its picture.
//!
//! Every change is held against it: errors against the reference, what was drawn and culled, pixels walked, and a
//! checksum of the picture, into which the kernel's words go without further rounding.

use super::{Engine, Prepared};
use crate::metrics::{Errors, compare};
use crate::picture::Picture;
use anyhow::{Context, Result, ensure};
use flate2::Crc;
use std::fs;
use std::path::{Path, PathBuf};

/// Least PSNR and largest bias of a system's plan.
pub const BARS: (f64, f64) = (60.0, 5e-4);

/// The table's columns.
const HEADING: &str = "plan,psnr_db,max_abs,bias,items,culled,covered,visited,crc32\n";

/// One plan's figures.
#[derive(Clone, Debug, PartialEq)]
pub struct GoldenLine {
    /// Name of its file, without extension.
    pub plan: String,
    /// The worse of colour and alpha against the reference.
    pub psnr_db: f64,
    /// The larger of both.
    pub max_abs: f64,
    /// The farther from 0 of both.
    pub bias: f64,
    /// Splats or points.
    pub items: usize,
    /// How many of them were not drawn.
    pub culled: u64,
    /// Pixels covered and visited, counted once per footprint; nothing if they are not counted.
    pub pixels: Option<[u64; 2]>,
    /// Of the picture's doubles, little-endian.
    pub crc32: u32,
}

impl GoldenLine {
    /// Draws a plan in the kernel and in the reference.
    pub fn new(name: &str, prepared: &Prepared) -> Result<GoldenLine> {
        let drawing = prepared.draw_fixed(&prepared.plan.entry)?;
        let engine = prepared.plan.reference.unwrap_or(Engine::Float);
        let reference = prepared.draw_reference(engine, &|_, _| ())?;
        let errors = compare(&drawing.picture, &reference.picture)?;
        let (psnr_db, max_abs, bias) = worst(&errors);
        Ok(GoldenLine {
            plan: name.to_owned(),
            psnr_db,
            max_abs,
            bias,
            items: prepared.scene.len(),
            culled: drawing.culled.values().sum(),
            pixels: drawing
                .pixels
                .map(|pixels| [pixels.covered, pixels.visited]),
            crc32: checksum(&drawing.picture),
        })
    }

    /// Number of the system that the plan is of: its name begins with it.
    pub fn system(&self) -> Option<u8> {
        self.plan.split('-').next()?.parse().ok()
    }

    /// Does the picture meet the bars?
    pub fn meets_bars(&self) -> bool {
        let (psnr, bias) = BARS;
        self.psnr_db >= psnr && self.bias.abs() <= bias
    }

    fn csv(&self) -> String {
        let [covered, visited] = self.pixels.map_or_else(Default::default, |pixels| {
            pixels.map(|count| count.to_string())
        });
        let (plan, items, culled, crc32) = (&self.plan, self.items, self.culled, self.crc32);
        format!(
            "{plan},{:.1},{:.1e},{:+.1e},{items},{culled},{covered},{visited},{crc32:08x}\n",
            self.psnr_db, self.max_abs, self.bias
        )
    }
}

/// PSNR, largest error and bias: the worse of colour and alpha in each respect.
pub fn worst(Errors { colour, alpha }: &Errors) -> (f64, f64, f64) {
    let by_alpha = alpha.bias.abs() > colour.bias.abs();
    let bias = if by_alpha { alpha.bias } else { colour.bias };
    let max_abs = colour.max_abs.max(alpha.max_abs);
    (colour.psnr_db.min(alpha.psnr_db), max_abs, bias)
}

fn checksum(picture: &Picture) -> u32 {
    let mut crc = Crc::new();
    for sample in picture.pixels.iter().flatten() {
        crc.update(&sample.to_le_bytes());
    }
    crc.sum()
}

/// The plans of a folder by name.
pub fn plans(folder: &Path) -> Result<Vec<(String, PathBuf)>> {
    let shown = folder.display();
    let entries = fs::read_dir(folder).with_context(|| format!("cannot read '{shown}'"))?;
    let mut plans = Vec::new();
    for entry in entries {
        let entry = entry.with_context(|| format!("cannot read '{shown}'"))?;
        let (path, name) = (entry.path(), entry.file_name());
        if let Some(name) = name.to_string_lossy().strip_suffix(".toml") {
            plans.push((name.to_owned(), path));
        }
    }
    plans.sort();
    ensure!(
        !plans.is_empty(),
        "'{shown}' holds no plan: name a folder of .toml files"
    );
    Ok(plans)
}

/// The lines of all plans of a folder.
pub fn lines(folder: &Path) -> Result<Vec<GoldenLine>> {
    let mut lines = Vec::new();
    for (name, path) in plans(folder)? {
        let prepared = Prepared::from_file(&path, &|_| ())?;
        lines.push(GoldenLine::new(&name, &prepared).with_context(|| name)?);
    }
    Ok(lines)
}

/// The table as CSV.
pub fn table(lines: &[GoldenLine]) -> String {
    let lines: String = lines.iter().map(GoldenLine::csv).collect();
    format!("{HEADING}{lines}")
}
