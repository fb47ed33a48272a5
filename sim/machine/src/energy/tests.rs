use super::*;
use crate::simulate_alone;
use crate::tests::{covered_row, machine, small_tiles, workload};
use crate::workload::{SurfaceCounts, SurfaceWork, Workload};
use proptest::prelude::*;
use splatline::format::{Classic8, Lean18, Standard24};

fn estimated(workload: &Workload, config: &Config, table: &EnergyTable) -> Energy {
    estimated_of(&Standard24::WIDTHS, workload, config, table)
}

fn estimated_of(
    widths: &Widths,
    workload: &Workload,
    config: &Config,
    table: &EnergyTable,
) -> Energy {
    let timing = simulate_alone(workload, config);
    estimate(None, widths, Traversal::Spans, config, &timing, table)
}

/// The same work as if it were a surface's.
fn with_surfaces(
    workload: Workload,
    config: Config,
    (surface_layers, surface_light, resolve_interval): (u32, u32, u32),
) -> (Workload, Config) {
    let covered = workload.totals().covered;
    let counts = SurfaceCounts {
        samples: covered,
        begun: covered / 3,
        accumulated: covered - covered / 3,
        merges: covered / 7,
        fragments: covered / 4,
        pixels: covered / 8,
        ..SurfaceCounts::default()
    };
    let resolved = workload.tiles.iter().map(|tile| 2 * tile.pixels).collect();
    let workload = Workload {
        surface: Some(SurfaceWork { counts, resolved }),
        ..workload
    };
    let config = Config {
        surface_layers,
        surface_light,
        resolve_interval,
        ..config
    };
    (workload, config)
}

/// Counts of an action over all components of a unit.
fn count(energy: &Energy, unit: &str, component: &str, action: &str) -> u64 {
    let mut units = energy.units.iter();
    let unit = units.find(|found| found.unit == unit).unwrap();
    let wanted = |found: &&Action| (found.component, found.action) == (component, action);
    let found = unit.actions.iter().filter(wanted);
    found.map(|found| found.count).sum()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// The picture is the sum of its units, a unit of its actions, and the bytes of DRAM those of the accounts, to the
    /// last digit.
    #[test]
    fn energies_sum_exactly(workload in workload(), config in machine(), surface in proptest::option::of((1u32..9, 0u32..2, 1u32..9))) {
        let (workload, config) = match surface {
            Some(unit) => with_surfaces(workload, config, unit),
            None => (workload, config),
        };
        let table = EnergyTable::default();
        let energy = estimated(&workload, &config, &table);
        let mut all = 0u128;
        for unit in &energy.units {
            let actions: u128 = unit.actions.iter().map(|a| u128::from(a.count) * u128::from(a.attojoules_each)).sum();
            prop_assert_eq!(u128::from(unit.attojoules), actions, "{}", unit.unit);
            all += actions;
        }
        prop_assert_eq!(u128::from(energy.attojoules), all);
        let bytes = simulate_alone(&workload, &config).bytes;
        let moved = bytes.splats_read + bytes.harmonics_read + bytes.packets_written + bytes.sort_moved + bytes.sorted_read + bytes.packets_read + bytes.pixels_written;
        let dram: u64 = energy.units.iter().map(|unit| unit.dram_attojoules).sum();
        prop_assert_eq!(dram, moved * table.dram_byte());
    }

    /// Behind a part every byte of every burst is charged.
    #[test]
    fn a_part_is_charged_whole_bursts(workload in workload(), config in machine(), memory_part in 1u32..=3) {
        let table = EnergyTable::default();
        let config = Config { memory_part, clock_mhz: 100, ..config };
        let timing = simulate_alone(&workload, &config);
        let energy = estimated(&workload, &config, &table);
        let dram: u64 = energy.units.iter().map(|unit| unit.dram_attojoules).sum();
        let moved = timing.memory.unwrap().bytes_moved.max(timing.bytes.all());
        prop_assert_eq!(dram, moved * table.dram_byte());
    }

    /// What the pixel path is charged, counted naively over the workload's rows where nothing is left out.
    #[test]
    fn pixels_and_rows_are_those_of_the_workload(workload in workload()) {
        let config = Config { tile_termination: 0, ..small_tiles() };
        let energy = estimated(&workload, &config, &EnergyTable::default());
        let totals = workload.totals();
        let runs = workload.rows.iter().filter(|row| row.length > 0).count() as u64;
        prop_assert_eq!(count(&energy, "lanes", "table", "read"), totals.covered);
        prop_assert_eq!(count(&energy, "lanes", "adder", "add"), 3 * totals.visited + totals.covered);
        prop_assert_eq!(count(&energy, "blend", "multiplier", "multiply"), 4 * totals.live);
        prop_assert_eq!(count(&energy, "blend", "tile_buffer", "write"), 2 * totals.live);
        prop_assert_eq!(count(&energy, "row_generator", "multiplier", "multiply"), 4 * totals.rows);
        prop_assert_eq!(count(&energy, "row_generator", "queue", "write"), runs);
        prop_assert_eq!(count(&energy, "splat_setup", "multiplier", "multiply"), 3 * workload.pairs.len() as u64);
        let pixels: u64 = workload.tiles.iter().map(|tile| u64::from(tile.pixels)).sum();
        prop_assert_eq!(count(&energy, "write_back", "tile_buffer", "read"), 2 * pixels);
    }
}

/// A workload of one tile of 16 x 8 pixels with one splat of two rows.
fn one_splat() -> Workload {
    use crate::workload::{Pair, SplatWork, Tile};
    Workload {
        tile: [16, 8],
        packet_bytes: 48,
        splats: vec![
            SplatWork {
                tiles: 1,
                visited_tiles: 1,
            },
            SplatWork::default(),
        ],
        tiles: vec![Tile {
            pairs_end: 1,
            finished_after: u32::MAX,
            pixels: 128,
        }],
        pairs: vec![Pair {
            splat: 0,
            rows_end: 2,
            first_row: 3,
            visits: true,
        }],
        rows: vec![covered_row(2, 4, true), covered_row(3, 2, true)],
        ..Workload::default()
    }
}

#[test]
fn narrow_designs_take_less_and_a_table_of_ones_own_is_said_to_be_so() {
    let (workload, config) = (one_splat(), small_tiles());
    let table = EnergyTable::default();
    let energies = [Classic8::WIDTHS, Lean18::WIDTHS, Standard24::WIDTHS]
        .map(|widths| estimated_of(&widths, &workload, &config, &table).attojoules);
    assert!(energies.is_sorted(), "{energies:?}");
    let own = EnergyTable::from_toml("e.toml", &SHIPPED.replace("pj = 1950", "pj = 195")).unwrap();
    let cheaper = estimated(&workload, &config, &own);
    assert!(cheaper.attojoules < energies[2] && cheaper.text().contains("a table of your own"));
}

/// Two readers of the export: the one here takes it apart line by line and must find every action again.
#[test]
fn the_action_counts_hold_every_action() {
    let energy = estimated(&one_splat(), &small_tiles(), &EnergyTable::default());
    let text = action_counts(&energy);
    assert!(text.starts_with(
        "action_counts:\n  version: 0.4\n  local:\n    - name: splatline.fetch.dram_8x8\n"
    ));
    let mut names = std::collections::BTreeSet::new();
    let mut components = (text.lines()).filter_map(|line| line.strip_prefix("    - name: "));
    let once = components.all(|name| names.insert(name));
    assert!(once, "a component twice: {text}");
    let lines = text.lines().map(str::trim);
    let counts = lines.filter_map(|line| line.strip_prefix("counts: "));
    let sum: u64 = counts.map(|count| count.parse::<u64>().unwrap()).sum();
    let actions = energy.units.iter().flat_map(|unit| &unit.actions);
    assert_eq!(sum, actions.map(|action| action.count).sum::<u64>());
}
