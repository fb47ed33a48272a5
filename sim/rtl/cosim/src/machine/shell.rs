//! A frame for the bench of the machine behind buses (`sim/rtl/shell/machine_axi.sv`): what a driver writes into
//! registers, the memory before, and the kernel's frame.

use super::image::{MemoryImage, kernel_frame};
use super::loads::MachineLoad;
use super::unit::circuit;
use crate::rules::rule_writes;
use crate::setup::constants::constants;
use crate::unit::{Circuit, Extent, Load};
use anyhow::{Context, Result};
use serde::Serialize;
use splatline_sim::atomic;
use std::path::Path;

/// What the file has.
#[derive(Serialize)]
struct ShellFrame {
    /// Registers and words, in the order in which they are written.
    writes: Vec<(&'static str, u32)>,
    /// The memory.
    memory: Vec<[u32; 4]>,
    /// The word at which the frame begins, and its words.
    first: usize,
    frame: Vec<[u32; 4]>,
    /// Entries of the lists.
    entries: usize,
}

/// Writes the first of the small frames, whose tiles are cut by the edge and of whose splats some are culled, for a
/// machine of this design into a file.
pub fn write_frame(design: &str, file: &Path) -> Result<()> {
    let circuit = circuit(design, 2, 1)?;
    let loads = MachineLoad::all(&circuit, Extent::Quick, &mut Vec::new())?;
    let (_, load) = loads.first().context("no frames")?;
    let frame = serde_json::to_string(&shell_frame(&circuit, load)?)?;
    Ok(atomic::write(file, frame.as_bytes())?)
}

fn shell_frame(circuit: &Circuit, load: &MachineLoad) -> Result<ShellFrame> {
    let scene = &load.scene;
    let entries = load.lists.entries();
    let image = MemoryImage::new(&circuit.design.widths, load, entries)?;
    let mut writes = Vec::new();
    for (index, value, exponent) in constants(circuit, &scene.view, &scene.rules)? {
        writes.extend([
            ("constant_index", index.into()),
            ("constant_low", value as u32),
            ("constant_high", (value >> 32) as u32),
            ("constant_exponent", exponent as u32),
        ]);
    }
    writes.extend(rule_writes(&circuit.design.widths, &scene.rules));
    let [columns, rows] = scene.view.viewport.map(u32::from);
    writes.push(("size", rows << 16 | columns));
    let places_in_memory = image.places.iter();
    let of_registers = places_in_memory.filter(|(name, _)| !["columns", "rows"].contains(name));
    writes.extend(of_registers.map(|(name, value)| (*name, *value as u32)));
    Ok(ShellFrame {
        writes,
        memory: image.words,
        first: image.frame,
        frame: kernel_frame(&circuit.design, load)?,
        entries,
    })
}
