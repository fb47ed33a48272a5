//! A scene's records in a memory image, through the machine, and the frame that it leaves there against the kernel's.

use super::circuit::MachineSpec;
use super::model::{ConstantWords, MachineFrame, MachineModel, MachineOutcome, TableWords};
use crate::order::loads::Seen;
use crate::package::table;
use crate::setup::bench::record;
use crate::setup::constants::constants;
use crate::workload::{TILE, split_mix};
use anyhow::{Context, Result, ensure};
use splatline::LentList;
use splatline::Renderer;
use splatline::blend::{Blend, Pixel};
use splatline::footprint::Footprint;
use splatline::footprint::packet::Layout;
use splatline::format::{RuntimeWidths, Widths};
use splatline::kernel::{entries, fill_gaussian};
use splatline::rules::Rules;
use splatline_sim::fixed::QuantisedScene;

/// Words of a record.
const RECORD: usize = 5;

/// How the memory behaves.
#[derive(Clone, Copy, Debug)]
pub struct MemoryTiming {
    /// Cycles from a request to its word.
    pub latency: u32,
    /// How many of 8 cycles it holds a request back.
    pub pauses: u32,
    /// Bytes that it moves in a cycle in each direction: 4, 8 or 16.
    pub bytes: u32,
}

/// Memories that frames are drawn with: usual latency at full speed; slow and narrow; and one with pauses, whose cycles no model counts.
pub const MEMORIES: [MemoryTiming; 3] = [
    MemoryTiming {
        latency: 60,
        pauses: 0,
        bytes: 16,
    },
    MemoryTiming {
        latency: 300,
        pauses: 0,
        bytes: 4,
    },
    MemoryTiming {
        latency: 13,
        pauses: 3,
        bytes: 16,
    },
];

/// What came of a frame.
#[derive(Clone, Copy, Debug)]
pub struct MachineFindings {
    /// Pixels.
    pub pixels: usize,
    /// Of them with a word that is not the kernel's.
    pub mismatches: usize,
    /// Pixels of the kernel's frame on which something was drawn.
    pub painted: usize,
    /// Splats.
    pub splats: usize,
    /// Cycles and words.
    pub outcome: MachineOutcome,
}

impl MachineFindings {
    /// Is the frame the kernel's, and did nothing go astray?
    pub fn agree(&self) -> bool {
        self.mismatches == 0 && self.outcome.full == 0 && self.outcome.beyond == 0
    }
}

/// A memory image, and what the machine has to be told.
struct Image {
    words: Vec<[u32; 4]>,
    frame: MachineFrame,
    constants: Vec<ConstantWords>,
    table: Vec<TableWords>,
}

/// Draws `seen` by the machine that `spec` describes and by the kernel; `room` is the number of list entries for which there is room.
pub fn draw(
    model: &MachineModel,
    spec: &MachineSpec,
    seen: &Seen,
    timing: MemoryTiming,
    room: usize,
    rounds: u32,
) -> Result<MachineFindings> {
    let rules = seen.scene.natural_rules;
    let quantised = QuantisedScene::new(&seen.scene, &seen.camera, &rules);
    let rules = quantised.rules(&rules);
    let mut image = image(spec, &quantised, &rules, timing, room)?;
    let outcome = model.run(
        &image.frame,
        &image.constants,
        &image.table,
        &mut image.words,
        rounds,
    )?;
    let expected = kernel_frame(spec.widths, &quantised, &rules)?;
    let viewport = quantised.view.viewport.map(usize::from);
    let got = &image.words[image.frame.base_frame as usize..];
    let same = places(viewport)
        .zip(got)
        .filter(|(place, word)| words(&expected[*place]) == **word);
    let clear = Pixel::clear(spec.widths);
    Ok(MachineFindings {
        pixels: expected.len(),
        mismatches: expected.len() - same.count(),
        painted: expected.iter().filter(|pixel| **pixel != clear).count(),
        splats: quantised.splats.len(),
        outcome,
    })
}

/// The frame by the kernel's own renderer.
fn kernel_frame(widths: &Widths, scene: &QuantisedScene, rules: &Rules) -> Result<Vec<Pixel>> {
    let design = RuntimeWidths::new(*widths)
        .ok()
        .context("widths out of range")?;
    let mut memory = vec![0; entries(widths)];
    fill_gaussian(&mut memory, widths, rules.table_range);
    let renderer = Renderer::with_table(design, *rules, &memory)
        .map_err(|error| anyhow::anyhow!("{error:?}"))?;
    let mut footprints = vec![Footprint::EMPTY; scene.splats.len()];
    let mut order = vec![0; scene.splats.len()];
    let mut list = LentList::new(&mut footprints, &mut order);
    let [columns, rows] = scene.view.viewport.map(usize::from);
    let mut pixels = vec![Pixel::clear(widths); columns * rows];
    renderer
        .render(&scene.view, &scene.splats, &mut list, &mut pixels)
        .map_err(|error| anyhow::anyhow!("{error}"))?;
    Ok(pixels)
}

/// Places of the frame's pixels in the order in which the machine writes them: tile by tile, each row by row.
fn places([columns, rows]: [usize; 2]) -> impl Iterator<Item = usize> {
    let tile = TILE.map(usize::from);
    let tiles = (0..rows)
        .step_by(tile[1])
        .flat_map(move |y| (0..columns).step_by(tile[0]).map(move |x| [x, y]));
    tiles.flat_map(move |[left, top]| {
        let bottom = rows.min(top + tile[1]);
        let right = columns.min(left + tile[0]);
        (top..bottom).flat_map(move |y| (left..right).map(move |x| y * columns + x))
    })
}

/// A pixel's word.
fn words(pixel: &Pixel) -> [u32; 4] {
    let [red, green, blue] = pixel.colour;
    [pixel.transmittance, red, green, blue]
}

/// Records at the beginning, bits of nothing in all places that the machine is to write, and a word between any two regions.
fn image(
    spec: &MachineSpec,
    scene: &QuantisedScene,
    rules: &Rules,
    timing: MemoryTiming,
    room: usize,
) -> Result<Image> {
    let widths = spec.widths;
    let mut words: Vec<[u32; 4]> = Vec::new();
    for splat in &scene.splats {
        let record = record(splat).context("a splat without a place in a record")?;
        let mut padded = [0; 4 * RECORD];
        padded[..record.len()].copy_from_slice(&record);
        words.extend(padded.as_chunks::<4>().0);
    }
    let count = scene.splats.len();
    let packet = Layout::new(widths).words().div_ceil(4);
    let [columns, rows] = scene.view.viewport;
    let pixels = usize::from(columns) * usize::from(rows);
    let sizes = [packet * count, count, count, room.div_ceil(4), pixels];
    let mut bases = [0; 5];
    let mut next = words.len() + 1;
    for (base, size) in bases.iter_mut().zip(sizes) {
        *base = u32::try_from(next)?;
        next += size + 1;
    }
    let mut state = 1;
    words.resize_with(next, || [(); 4].map(|()| split_mix(&mut state) as u32));
    let blend = Blend::new(widths, rules).constants();
    let known = constants(
        &(spec.program)(widths)?.constants,
        widths,
        &scene.view,
        rules,
    )?;
    let constant = |(index, value, exponent): &(u8, i64, i32)| ConstantWords {
        value: *value as u64,
        exponent: *exponent as u32,
        index: (*index).into(),
    };
    let [base_packets, base_a, base_b, base_lists, base_frame] = bases;
    ensure!(room < 1 << 24, "more list entries than the machine counts");
    let frame = MachineFrame {
        least: blend.opacity_min,
        alpha_max: blend.alpha_max,
        minimum_transmittance: blend.minimum_transmittance,
        omit_finishing: blend.omit_finishing.into(),
        wide_table: (rules.table_range == 4).into(),
        records: count as u32,
        base_records: 0,
        base_packets,
        bases: [base_a, base_b],
        base_lists,
        base_frame,
        most: room as u32,
        columns: columns.into(),
        rows: rows.into(),
        latency: timing.latency,
        pauses: timing.pauses,
        bytes: timing.bytes,
    };
    let entry = |entry: &crate::package::TableEntry| TableWords {
        low: entry.low,
        step: entry.step,
    };
    Ok(Image {
        words,
        frame,
        constants: known.iter().map(constant).collect(),
        table: table(widths, rules).iter().map(entry).collect(),
    })
}
