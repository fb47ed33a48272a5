//! The memory of the machine before a frame, where it is told to put the rest, and the frame that it is to leave there.

use super::loads::MachineLoad;
use crate::memory::noise;
use crate::package::TILE;
use crate::setup::record;
use anyhow::{Context, Result, anyhow, ensure};
use splatline::LentList;
use splatline::Renderer;
use splatline::blend::Pixel;
use splatline::footprint::Footprint;
use splatline::footprint::packet::Layout;
use splatline::format::{Traversal, Widths};
use splatline_sim::design::DesignChoice;
use splatline_sim::fixed::TableMemory;
use splatline_sim::scene::synthetic::Random;

/// Records and harmonics at the beginning, bits of nothing in all places that the machine is to write, and a word
/// between any two regions.
pub struct MemoryImage {
    pub words: Vec<[u32; 4]>,
    /// The machine's inputs that say where all of it lies, and how much it is.
    pub places: Vec<(&'static str, u64)>,
    /// The word at which the frame begins.
    pub frame: usize,
}

impl MemoryImage {
    /// With room for so many entries of the lists.
    pub fn new(widths: &Widths, load: &MachineLoad, room: usize) -> Result<MemoryImage> {
        ensure!(room < 1 << 24, "more list entries than the machine counts");
        let scene = &load.scene;
        let mut words: Vec<[u32; 4]> = Vec::new();
        for splat in &scene.splats {
            let record = record(splat).context("a splat without a place in a record")?;
            words.extend(record.as_chunks::<4>().0);
        }
        let count = scene.splats.len();
        let packet = Layout::new(widths, Traversal::Spans).words().div_ceil(4);
        let [columns, rows] = scene.view.viewport;
        let pixels = usize::from(columns) * usize::from(rows);
        let mut places = vec![
            ("records", count as u64),
            ("base_records", 0),
            ("most", room as u64),
            ("columns", columns.into()),
            ("rows", rows.into()),
        ];
        if let Some(harmonics) = &load.harmonics {
            words.push([!0; 4]);
            places.push(("base_harmonics", words.len() as u64));
            places.push(("degree", harmonics[0].degree.into()));
            // The last quarter of each word is anything.
            let mut random = Random(7);
            let colours = harmonics.iter().flat_map(|splat| &splat.colours);
            words.extend(colours.map(|colour| {
                let [red, green, blue] = colour.map(|channel| channel.to_bits() as u32);
                [red, green, blue, random.next() as u32]
            }));
        }
        let mut next = words.len() + 1;
        for (base, size) in [
            ("base_packets", packet * count),
            ("base_a", count),
            ("base_b", count),
            ("base_lists", room.div_ceil(4)),
            ("base_frame", pixels),
        ] {
            places.push((base, next as u64));
            next += size + 1;
        }
        let mut random = Random(1);
        words.resize_with(next, || noise(&mut random));
        let frame = next - pixels - 1;
        Ok(MemoryImage {
            words,
            places,
            frame,
        })
    }
}

/// The frame by the kernel's own renderer, in the order in which the machine writes it.
pub fn kernel_frame(design: &DesignChoice, load: &MachineLoad) -> Result<Vec<[u32; 4]>> {
    let widths = &design.widths;
    let (view, mut splats) = (&load.scene.view, load.scene.splats.clone());
    for (splat, harmonics) in splats.iter_mut().zip(load.harmonics.iter().flatten()) {
        splat.colour = harmonics.colour();
    }
    let rules = load.scene.rules;
    let memory = TableMemory::new(widths, &rules).entries;
    let renderer = Renderer::with_table(design.in_fields(), rules, &memory);
    let renderer = renderer.map_err(|error| anyhow!("{error:?}"))?;
    let mut footprints = vec![Footprint::EMPTY; splats.len()];
    let mut order = vec![0; splats.len()];
    let mut list = LentList::new(&mut footprints, &mut order);
    let size = view.viewport.map(usize::from);
    let mut pixels = vec![Pixel::clear(widths); size[0] * size[1]];
    renderer.render(view, &splats, &mut list, &mut pixels)?;
    let words = places(size).map(|place| pixel_word(&pixels[place]));
    Ok(words.collect())
}

/// A pixel's word in the memory.
pub fn pixel_word(pixel: &Pixel) -> [u32; 4] {
    let [red, green, blue] = pixel.colour;
    [pixel.transmittance, red, green, blue]
}

/// Places of the frame's pixels in the order in which the machine writes them: tile by tile, each row by row.
pub fn places([columns, rows]: [usize; 2]) -> impl Iterator<Item = usize> {
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
