use super::*;
use crate::tests::workload;
use crate::workload::WorkloadRow;
use proptest::prelude::*;

/// Pixels of a pair as a grid of the tile, naively: `true` where the machine tests.
fn grid(
    rows: &[WorkloadRow],
    first_row: usize,
    of: impl Fn(&WorkloadRow, u32) -> bool,
) -> Vec<Vec<bool>> {
    let mut grid = vec![vec![false; 16]; 8];
    for (place, row) in grid.iter_mut().skip(first_row).zip(rows) {
        for (x, pixel) in place.iter_mut().enumerate() {
            *pixel = of(row, x as u32);
        }
    }
    grid
}

fn visited(row: &WorkloadRow, x: u32) -> bool {
    row.visited() >> x & 1 == 1
}

fn inside(row: &WorkloadRow, x: u32) -> bool {
    row.covered >> x & 1 == 1
}

/// What the module's table says, pixel by pixel.
fn wanted(how: Tested, inside: &[Vec<bool>], x: usize, y: usize) -> bool {
    match how {
        Tested::Own => unreachable!("it is the workload's own"),
        Tested::Tiles => true,
        Tested::SubTiles(side) => {
            let side = side as usize;
            let square = |x: usize| x / side;
            let met = |column: usize| {
                (0..8).any(|row| {
                    square(row) == square(y)
                        && (0..16).any(|c| square(c) == column && inside[row][c])
                })
            };
            // Squares between two that are met are tested as well; a convex footprint has none.
            (0..=square(x)).any(met) && (square(x)..16usize.div_ceil(side)).any(met)
        }
        Tested::Rows => {
            let first = inside[y].iter().position(|pixel| *pixel);
            let last = inside[y].iter().rposition(|pixel| *pixel);
            matches!((first, last), (Some(first), Some(last)) if (first..=last + 1).contains(&x))
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn machines_test_the_pixels_that_their_papers_say(workload in workload(), side in prop_oneof![Just(4u32), Just(8)]) {
        for how in [Tested::Tiles, Tested::SubTiles(side), Tested::Rows] {
            let changed = tested(&workload, how);
            let (mut before, mut after) = (0, 0);
            for (pair, other) in workload.pairs.iter().zip(&changed.pairs) {
                let own = &workload.rows[before..pair.rows_end as usize];
                let rows = &changed.rows[after..other.rows_end as usize];
                (before, after) = (pair.rows_end as usize, other.rows_end as usize);
                let there = grid(own, pair.first_row.into(), inside);
                let found = grid(rows, other.first_row.into(), visited);
                prop_assert_eq!(&grid(rows, other.first_row.into(), inside), &there, "what is inside stays");
                for (y, row) in found.iter().enumerate().take(8) {
                    for (x, found) in row.iter().enumerate().take(16) {
                        prop_assert_eq!(*found, wanted(how, &there, x, y), "{:?} at {}, {}", how, x, y);
                    }
                }
            }
            prop_assert_eq!(changed.totals().live, workload.totals().live);
        }
    }
}

/// All machines blend the same pixels; tests fall from tiles to sub-tiles to rows, and what a blended pixel takes with
/// them.
#[test]
fn machines_differ_in_what_they_test_and_not_in_what_they_draw() {
    use crate::scene::synthetic;
    let scene = synthetic::random_gaussians(2000, 4, 2.0);
    let camera = synthetic::camera(160, 120);
    let design = DesignChoice::named("standard24").unwrap();
    let options = Options::front_to_back(&scene.natural_rules, &design);
    let outcomes = run_all(&scene, &camera, &options, &EnergyTable::default()).unwrap();
    let [tiles, sub, rows, shared, _, _, ours] = &outcomes[..] else {
        panic!("seven machines")
    };
    let visited = [tiles, sub, rows].map(|outcome| outcome.timing.pixels.visited);
    assert!(visited.is_sorted_by(|a, b| a > b), "{visited:?}");
    assert_eq!(shared.timing.pixels.visited, tiles.timing.pixels.visited);
    assert!(shared.products < tiles.products && rows.products < sub.products);
    for outcome in [sub, rows, shared] {
        assert_eq!(outcome.timing.pixels.live, tiles.timing.pixels.live);
        assert!(outcome.energy.attojoules < tiles.energy.attojoules);
    }
    assert_eq!(tiles.timing.pixels.visited, 256 * tiles.timing.pixels.pairs);
    assert!(ours.timing.pixels.visited < rows.timing.pixels.visited + rows.timing.pixels.rows);
    let text = table_of(&outcomes);
    assert_eq!(text.lines().count(), 2 + PRESETS.len());
    assert!(note().contains("reimplemented from the paper"));
}
