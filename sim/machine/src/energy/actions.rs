//! The actions of a picture by unit: every one that the machine's accounts count, with its energy.
//!
//! Operands are those of the circuit (`area::circuit`), so that area and energy are about the same thing. What a unit
//! does is charged by what passed through it: geometry setup by splats, splat setup by pairs, the row generator by
//! rows, lanes and blend by pixels, queues by entries, the memory interface by bytes.

use super::super::area::circuit::{Bits, GeometryCircuit, Product, SetupStage};
use super::super::area::lane::{FloatLane, OPERATIONS};
use super::super::area::packet_bits;
use super::super::area::surface::SurfaceBits;
use super::super::config::{Config, Overlap};
use super::super::timing::Timing;
use super::super::workload::SurfaceCounts;
use super::EnergyTable;
use serde::Serialize;
use splatline::format::{Traversal, Widths};

/// What is done, so often, for so much each.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Action {
    /// The part of the unit that does it.
    pub component: &'static str,
    /// What it does.
    pub action: &'static str,
    /// Operands or word, bits.
    pub bits: [u64; 2],
    /// How often.
    pub count: u64,
    /// Energy of one, attojoules.
    pub attojoules_each: u64,
}

/// All actions of one unit.
#[derive(Clone, Debug, PartialEq)]
pub struct UnitActions<'a> {
    pub name: &'static str,
    pub actions: Vec<Action>,
    table: &'a EnergyTable,
}

impl<'a> UnitActions<'a> {
    pub fn new(name: &'static str, table: &'a EnergyTable) -> UnitActions<'a> {
        UnitActions {
            name,
            actions: Vec::new(),
            table,
        }
    }

    /// One action; the same one with the same operands again is counted on.
    pub fn add(
        &mut self,
        component: &'static str,
        action: &'static str,
        bits: [u64; 2],
        count: u64,
        attojoules_each: u64,
    ) {
        let key = |known: &Action| (known.component, known.action, known.bits);
        let mut known = self.actions.iter_mut();
        match known.find(|known| key(known) == (component, action, bits)) {
            Some(known) => known.count += count,
            None if count > 0 => self.actions.push(Action {
                component,
                action,
                bits,
                count,
                attojoules_each,
            }),
            None => {}
        }
    }

    pub fn adders(&mut self, bits: u64, count: u64) {
        self.add("adder", "add", [bits, bits], count, self.table.adder(bits));
    }

    /// So many bits of adders of any widths, as adders of 32 bits.
    fn adder_bits(&mut self, bits: u64, count: u64) {
        self.adders(32, bits.div_ceil(32) * count);
    }

    fn products(&mut self, products: &[[u64; 2]], count: u64) {
        for operands in products {
            let energy = self.table.multiplier(*operands);
            self.add("multiplier", "multiply", *operands, count, energy);
        }
    }

    /// So many times sums and products in floating point, each for so many attojoules.
    fn operations(&mut self, bits: u64, counts: [u64; 2], times: u64, energies: [u64; 2]) {
        let [sums, products] = counts.map(|count| count * times);
        let (bits, [add, multiply]) = ([bits; 2], energies);
        self.add("float_adder", "add", bits, sums, add);
        self.add("float_multiplier", "multiply", bits, products, multiply);
    }

    pub fn float(&mut self, bits: u64, counts: [u64; 2], times: u64) {
        let table = self.table;
        let energies = [table.float_adder(bits), table.float_multiplier(bits)];
        self.operations(bits, counts, times, energies);
    }

    /// A stage of a lane in floating point, so often.
    fn stage_of(&mut self, lane: &FloatLane, stage: usize, count: u64) {
        let energies = self.table.float_operations(lane.stages[stage]);
        self.operations(lane.bits, OPERATIONS[stage], count, energies);
    }

    /// Reads and writes of a memory of so many words.
    pub fn memory(
        &mut self,
        component: &'static str,
        words: u64,
        bits: u64,
        [reads, writes]: [u64; 2],
    ) {
        let energy = self.table.memory((words * bits).div_ceil(8), bits);
        self.add(component, "read", [bits, words], reads, energy);
        self.add(component, "write", [bits, words], writes, energy);
    }

    /// A queue: every entry is written once and read once.
    fn queue(&mut self, depth: u32, bits: u64, entries: u64) {
        self.memory("queue", depth.into(), bits, [entries; 2]);
    }

    pub fn dram(&mut self, action: &'static str, bytes: u64) {
        self.add("dram", action, [8, 8], bytes, self.table.dram_byte());
    }

    fn stage(&mut self, stage: &SetupStage, tables: [u64; 2], count: u64) {
        self.products(&stage.products, count);
        self.adder_bits(stage.operators.adder_bits, count);
        let [words, bits] = tables;
        self.memory("table", words, bits, [stage.lookups * count, 0]);
    }
}

/// All units of a machine with their actions in this picture.
pub fn of<'a>(
    widths: &Widths,
    traversal: Traversal,
    config: &Config,
    timing: &Timing,
    table: &'a EnergyTable,
) -> Vec<UnitActions<'a>> {
    let picture = CountedPicture {
        widths,
        bits: Bits::new(widths),
        packet: packet_bits(widths, traversal, config),
        surface: SurfaceBits::of(widths, config).zip(timing.surface),
        traversal,
        config,
        timing,
        table,
    };
    let mut units = vec![
        picture.fetch(),
        picture.setup(),
        picture.binning(),
        picture.sort(),
        picture.packet_fetch(),
        picture.splat_setup(),
        picture.row_generator(),
        picture.lanes(),
    ];
    match &picture.surface {
        Some((bits, counts)) => {
            units.extend([picture.gather(bits, counts), picture.resolve(bits, counts)])
        }
        None => units.extend([picture.blend(), picture.write_back()]),
    }
    if let Some(memory) = &timing.memory {
        // Bursts are moved whole: what nobody wanted of them takes as much.
        let mut unit = UnitActions::new("port", table);
        let wanted = timing.bytes.all();
        unit.dram("fill", memory.bytes_moved.saturating_sub(wanted));
        units.push(unit);
    }
    units
}

/// Puts a lane in floating point into the place of the kernel's. Its exponential is a table of 256 entries with their
/// steps.
pub fn put_lane(units: &mut [UnitActions], lane: &FloatLane, config: &Config, timing: &Timing) {
    let (pixels, bits) = (&timing.pixels, lane.bits);
    for unit in units {
        match unit.name {
            "lanes" => {
                unit.actions.clear();
                unit.stage_of(lane, 0, pixels.visited);
                unit.stage_of(lane, 1, pixels.covered);
                unit.memory("table", 256, 2 * bits, [pixels.covered, 0]);
            }
            "blend" => {
                unit.actions.clear();
                unit.stage_of(lane, 2, pixels.live);
                let words = config.bank_words();
                unit.memory("tile_buffer", words, bits, [pixels.covered, pixels.live]);
                unit.memory("tile_buffer", words, 3 * bits, [pixels.live; 2]);
            }
            _ => {}
        }
    }
}

fn operands<const N: usize>(products: [Product; N]) -> [[u64; 2]; N] {
    products.map(|product| product.operands)
}

/// What all units need.
struct CountedPicture<'a, 't> {
    widths: &'a Widths,
    bits: Bits,
    /// Bits of a packet.
    packet: u64,
    /// A surface unit, and what it did.
    surface: Option<(SurfaceBits, SurfaceCounts)>,
    traversal: Traversal,
    config: &'a Config,
    timing: &'a Timing,
    table: &'t EnergyTable,
}

impl<'t> CountedPicture<'_, 't> {
    fn unit(&self, name: &'static str) -> UnitActions<'t> {
        UnitActions::new(name, self.table)
    }

    fn fetch(&self) -> UnitActions<'t> {
        let mut unit = self.unit("fetch");
        let bytes = &self.timing.bytes;
        unit.dram("read", bytes.splats_read + bytes.harmonics_read);
        let bits = 8 * u64::from(self.config.splat_bytes);
        unit.queue(self.config.setup_fifo, bits, self.timing.splats.fetched);
        unit
    }

    /// Every splat is brought before the eye; only those that are seen go on.
    fn setup(&self) -> UnitActions<'t> {
        let geometry = GeometryCircuit::new(self.widths);
        let tables = [GeometryCircuit::TABLE_WORDS, geometry.table_bits];
        let mut unit = self.unit("setup");
        unit.stage(&geometry.rotation, tables, self.timing.splats.fetched);
        unit.stage(&geometry.footprint, tables, self.timing.splats.visible);
        unit
    }

    /// Two comparisons a tile, a counter an entry.
    fn binning(&self) -> UnitActions<'t> {
        let splats = &self.timing.splats;
        let mut unit = self.unit("binning");
        unit.queue(self.config.bin_fifo, self.packet, splats.visible);
        unit.adders(16, 2 * splats.tiles + splats.entries);
        unit.dram("write", self.timing.bytes.packets_written);
        unit
    }

    /// A pass reads every entry, counts it in a table of its digit and writes it.
    fn sort(&self) -> UnitActions<'t> {
        let moves = self.timing.splats.sorted;
        let mut unit = self.unit("sort");
        unit.adders(32, moves);
        unit.memory("digits", 256, 32, [moves; 2]);
        let bytes = self.timing.bytes;
        unit.dram("read", bytes.sort_moved / 2 + bytes.sorted_read);
        unit.dram("write", self.timing.bytes.sort_moved / 2);
        unit
    }

    fn packet_fetch(&self) -> UnitActions<'t> {
        let mut unit = self.unit("packet_fetch");
        unit.dram("read", self.timing.bytes.packets_read);
        let pairs = self.timing.pixels.pairs;
        unit.queue(self.config.packet_fifo, self.packet, pairs);
        unit
    }

    fn splat_setup(&self) -> UnitActions<'t> {
        let pairs = self.timing.pixels.pairs;
        let mut unit = self.unit("splat_setup");
        let m = self.bits.mantissa;
        match self.traversal {
            Traversal::Spans => unit.products(&operands(self.bits.setup_products()), pairs),
            Traversal::Box => unit.products(&[[m + 1, m + 1]; 7], pairs),
        }
        let [setup, _] = self.bits.operators();
        unit.adder_bits(setup.adder_bits, pairs);
        if self.config.overlap != Overlap::Primitive {
            unit.queue(self.config.splat_fifo, self.packet, pairs);
        }
        unit
    }

    fn row_generator(&self) -> UnitActions<'t> {
        let pixels = &self.timing.pixels;
        let mut unit = self.unit("row_generator");
        match self.traversal {
            Traversal::Spans => {
                let [_, row] = self.bits.operators();
                unit.products(&operands(self.bits.row_products()), pixels.rows);
                unit.adder_bits(row.adder_bits, pixels.rows);
                let (words, bits) = (GeometryCircuit::TABLE_WORDS, self.widths.mantissa.min(18));
                unit.memory("table", words, bits.into(), [pixels.rows, 0]);
            }
            Traversal::Box => unit.adders(63, 4 * pixels.rows),
        }
        unit.queue(self.config.row_fifo, self.bits.run, pixels.runs);
        unit
    }

    /// Two additions and the comparison with the cut-off a visited pixel; table and opacity where it is inside.
    fn lanes(&self) -> UnitActions<'t> {
        let pixels = &self.timing.pixels;
        let mut unit = self.unit("lanes");
        unit.adders(self.bits.radial + 5, 3 * pixels.visited);
        let [words, entry] = self.bits.table;
        unit.memory("table", words, entry, [pixels.covered, 0]);
        if let Some(product) = self.bits.interpolation_product() {
            unit.products(&[product.operands], pixels.covered);
            unit.adders(self.bits.weight + 1, pixels.covered);
        }
        let [opacity, ..] = operands(self.bits.blend_products());
        unit.products(&[opacity], pixels.covered);
        unit
    }

    /// Transmittance is read where a pixel is inside; what has not finished is blended and written.
    fn blend(&self) -> UnitActions<'t> {
        let pixels = &self.timing.pixels;
        let mut unit = self.unit("blend");
        let [_, share, colour] = operands(self.bits.blend_products());
        unit.products(&[share, colour, colour, colour], pixels.live);
        unit.adders(self.bits.transmittance + 2, pixels.live);
        unit.adders(self.bits.accumulator + self.bits.range + 1, 3 * pixels.live);
        let [transmittance, sums] = self.bits.pixel;
        let words = self.config.bank_words();
        let looks = [pixels.covered, pixels.live];
        unit.memory("tile_buffer", words, transmittance, looks);
        unit.memory("tile_buffer", words, sums, [pixels.live; 2]);
        unit
    }

    /// Each sample's depth, and a look at its pixel; what is not discarded is multiplied, added and written.
    fn gather(&self, bits: &SurfaceBits, counts: &SurfaceCounts) -> UnitActions<'t> {
        let gathered = counts.begun + counts.accumulated;
        let mut unit = self.unit("gather");
        unit.adders(SurfaceBits::DEPTH, self.timing.pixels.visited);
        unit.adder_bits(bits.gather_adders(), counts.samples);
        unit.products(&bits.gathered(), gathered);
        let (words, pixel) = (self.config.bank_words(), bits.layers * bits.fragment);
        unit.memory("tile_buffer", words, pixel, [counts.samples, gathered]);
        unit
    }

    /// Every pixel is read, and cleared for the next tile; every fragment is divided, shaded and composed.
    fn resolve(&self, bits: &SurfaceBits, counts: &SurfaceCounts) -> UnitActions<'t> {
        let (written, resolved) = (self.written(), counts.fragments + 2 * counts.merges);
        let mut unit = self.unit("resolve");
        unit.products(&bits.resolved(), resolved);
        unit.adder_bits(bits.resolve_adders(), resolved);
        let (words, pixel) = (self.config.bank_words(), bits.layers * bits.fragment);
        unit.memory("tile_buffer", words, pixel, [written; 2]);
        unit.dram("write", self.timing.bytes.pixels_written);
        unit
    }

    /// Pixels written back.
    fn written(&self) -> u64 {
        self.timing.bytes.pixels_written / u64::from(self.config.pixel_bytes)
    }

    /// Every pixel is read, and cleared for the next tile.
    fn write_back(&self) -> UnitActions<'t> {
        let written = self.written();
        let mut unit = self.unit("write_back");
        for bits in self.bits.pixel {
            unit.memory("tile_buffer", self.config.bank_words(), bits, [written; 2]);
        }
        unit.dram("write", self.timing.bytes.pixels_written);
        unit
    }
}
