//! The circuits against the kernel. Without Verilator these tests are ignored; the packages are compared all the same.

use splatline::format::{Lean18, Standard24};
use splatline_rtl::package::{path, text};
use splatline_rtl::{harmonics, setup, tables};
#[cfg(has_rtl)]
use splatline_rtl::{machine, order};

#[test]
fn committed_packages_are_the_generators() {
    for (design, widths) in [
        ("lean18", Lean18::WIDTHS),
        ("standard24", Standard24::WIDTHS),
    ] {
        let committed = std::fs::read_to_string(path(design)).unwrap();
        let stale =
            "run `cargo run -p splatline-rtl --example rtl -- package` and commit the result";
        assert!(
            committed == text(design, &widths).unwrap(),
            "{design}: splatline_pkg.sv is stale; {stale}"
        );
    }
}

#[test]
fn committed_setup_packages_are_the_generators() {
    for (design, widths) in [
        ("lean18", Lean18::WIDTHS),
        ("standard24", Standard24::WIDTHS),
    ] {
        let committed = std::fs::read_to_string(setup::text::path(design).unwrap()).unwrap();
        let stale =
            "run `cargo run -p splatline-rtl --example rtl -- package` and commit the result";
        assert!(
            committed == setup::text::text(design, &widths).unwrap(),
            "{design}: splatline_setup_pkg.sv is stale; {stale}"
        );
    }
}

#[test]
fn committed_tables_are_the_generators() {
    let committed = std::fs::read_to_string(tables::path()).unwrap();
    assert!(
        committed == tables::text(),
        "splatline_tables.sv is stale; run `cargo run -p splatline-rtl --example rtl -- package` and commit the result"
    );
}

#[test]
fn the_committed_program_of_the_harmonics_unit_is_the_generators() {
    let committed = std::fs::read_to_string(harmonics::text::path()).unwrap();
    assert!(
        committed == harmonics::text::text().unwrap(),
        "harmonics_program.sv is stale; run `cargo run -p splatline-rtl --example rtl -- package` and commit the result"
    );
}

#[test]
fn the_committed_page_of_the_setup_unit_is_the_commands() {
    let committed = std::fs::read_to_string(setup::area::REPORT).unwrap();
    assert!(
        committed == setup::area::page_text().unwrap(),
        "docs/setup-unit.md is stale; run `cargo run -p splatline-rtl --example rtl -- setup area page` and commit the result"
    );
}

#[cfg(has_rtl)]
mod with_verilator {
    use super::{harmonics, machine, order, setup};
    use splatline::footprint::packet::VERSION;
    use splatline::format::Lean18;
    use splatline::rules::Rules as KernelRules;
    use splatline_rtl::bench::{Bench, Pauses};
    use splatline_rtl::model::{Inputs, Missing, Model};
    use splatline_rtl::mutants::Mutant;
    use splatline_rtl::suite::{Extent, LANES, Loads};
    use splatline_rtl::workload::{self, BenchTile};
    use splatline_sim::design::DesignChoice;

    /// Every word, the cycle of every handshake where the lanes do not pause, and the cycles of pictures, for all rules.
    fn agrees(design: &'static str) {
        for loads in Loads::all(design, Extent::Quick).unwrap() {
            for missing in &loads.missing {
                println!(
                    "{design} {}: no {missing}, its data is not at hand",
                    loads.rules_name
                );
            }
            for lanes in LANES {
                let mut bench = loads.bench(lanes).unwrap();
                for line in loads.check(&mut bench, lanes) {
                    let findings = &line.findings;
                    assert!(findings.agree(), "{line:?}");
                    assert!(findings.visited > 10_000, "{line:?}: too little was drawn");
                    let timed = if line.pauses.lanes == 0 {
                        findings.splats
                    } else {
                        0
                    };
                    assert_eq!(findings.timed, timed, "{line:?}");
                }
                for line in loads.pictures(&mut bench, lanes).unwrap() {
                    assert_eq!(line.cycles.mismatches, 0, "{line:?}");
                    assert!(line.cycles.deviation().abs() <= 0.01, "{line:?}");
                }
            }
        }
    }

    /// Rounding, reciprocal, root and logarithm of the setup unit's cores, by a program that has nothing else.
    #[test]
    fn setup_units_equal_the_kernels() {
        let difference = setup::vectors::first_difference("lean18", &Lean18::WIDTHS, 37).unwrap();
        assert_eq!(difference, None);
    }

    /// What comes of these loads in a setup unit of three cores with this program, with pauses at both ends: the kernel's packets and reasons.
    fn set_up(
        program: setup::program::SetupProgram,
        loads: &[setup::bench::SetupLoad],
    ) -> setup::bench::SetupFindings {
        let widths = Lean18::WIDTHS;
        let design = splatline::format::RuntimeWidths::new(widths).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let spec = setup::circuit::SetupSpec {
            program,
            ..setup::circuit::SetupSpec::new("lean18", &widths, 3)
        };
        let library = setup::circuit::library(folder.path(), &spec).unwrap();
        let mut seen = setup::bench::SetupFindings::default();
        for (index, load) in loads.iter().enumerate() {
            let mut model = setup::model::SetupModel::new(&library, index as u32 + 1).unwrap();
            let pauses = 3 * index as u64 % 11;
            let findings = setup::bench::run(&mut model, design, program, load, pauses).unwrap();
            assert_eq!(findings.mismatches, 0, "{}: {findings:?}", load.name);
            assert_eq!(findings.unfit, 0, "{}", load.name);
            seen = seen.and(&findings);
        }
        seen
    }

    /// Scenes, hard cases and arbitrary bits.
    #[test]
    fn setup_unit_gives_the_kernels_packets() {
        let (scenes, missing) = setup::loads::captured(1000).unwrap();
        println!("not at hand: {missing:?}");
        let synthetic = setup::loads::synthetic(400, 1);
        let loads = [synthetic, setup::exact::exact(300, 1), scenes].concat();
        let seen = set_up(setup::program::program, &loads);
        assert!(seen.splats >= 4_000, "{seen:?}");
        assert!(
            seen.culled.iter().all(|count| *count > 0),
            "not every reason: {seen:?}"
        );
    }

    /// The same with distance scaling, nearer than the distance k, there and beyond.
    #[test]
    fn setup_unit_enlarges_what_is_far() {
        let loads = setup::distant::distant(300, 1);
        let enlarged = |load: &setup::bench::SetupLoad| {
            let setup::bench::SetupLoad {
                view,
                rules,
                splats,
                ..
            } = load;
            setup::distant::enlarged(&Lean18::WIDTHS, view, rules, splats)
        };
        let beyond: usize = loads.iter().map(enlarged).sum();
        let seen = set_up(setup::program::with_distance_scaling, &loads);
        assert!(
            beyond > seen.splats / 4 && beyond < seen.splats * 3 / 4,
            "{beyond} of {seen:?}"
        );
    }

    /// Colours of a scene, of random splats, of corners and arbitrary bits (`rtl -- harmonics` takes thousands of each), with pauses at all ends and
    /// resets in mid-splat, by one multiplier and by two.
    #[test]
    fn harmonics_unit_gives_the_kernels_colours() {
        let loads = harmonics::mistakes::judges().unwrap();
        for multipliers in harmonics::circuit::MULTIPLIERS {
            let folder = tempfile::tempdir().unwrap();
            let spec = harmonics::circuit::HarmonicsSpec::new(multipliers);
            let library = harmonics::circuit::library(folder.path(), &spec).unwrap();
            for (seed, load) in (1..).zip(&loads) {
                for pauses in &harmonics::bench::PAUSES {
                    let mut model = harmonics::model::HarmonicsModel::new(&library, seed).unwrap();
                    let found =
                        harmonics::bench::run(&mut model, load, pauses, seed.into()).unwrap();
                    let first = &found.first_difference;
                    assert_eq!(found.mismatches, 0, "{}, {pauses:?}: {first:?}", load.name);
                    assert_eq!(found.splats, load.splats.len() as u64);
                    assert_eq!(found.resets > 0, pauses.resets > 0, "{}", load.name);
                }
            }
        }
    }

    /// Order and lists of a scene and of hard keys (`rtl -- order` takes five scenes), with pauses of the memory, twice in one circuit; and lists for which there is no room.
    #[test]
    fn sorter_and_binning_give_the_kernels_order_and_the_models_lists() {
        let folder = tempfile::tempdir().unwrap();
        let library = order::circuit::library(folder.path(), 8, None, "-O1").unwrap();
        let model = order::model::OrderModel::new(&library).unwrap();
        let (seen, missing) = order::loads::scenes(&["playbot"], 128).unwrap();
        println!("not at hand: {missing:?}");
        let design = DesignChoice::load("lean18").unwrap();
        let scenes = seen
            .iter()
            .map(|seen| order::loads::ordered(seen, &design).1);
        let loads: Vec<_> = scenes.chain(order::loads::hard()).collect();
        for load in &loads {
            for timing in order::bench::MEMORIES {
                let found = order::bench::run(&model, load, timing, 5).unwrap();
                assert!(found.agree(), "{}, {timing:?}: {found:?}", load.name);
            }
        }
        let last = loads.last().unwrap();
        let entries: usize = last.lists.iter().map(Vec::len).sum();
        let found =
            order::bench::run_with_room(&model, last, order::bench::MEMORIES[0], 1, entries - 1)
                .unwrap();
        assert_eq!((found.outcome.full, found.outcome.beyond), (1, 0));
    }

    /// Frames from records in memory by the whole machine, with every memory, twice in one machine, and their cycles by the model; and frames without room for
    /// their lists.
    #[test]
    fn the_machine_draws_the_kernels_frame() {
        let design = DesignChoice::load("lean18").unwrap();
        let spec = machine::circuit::MachineSpec::new("lean18", &design.widths, 2, 4);
        let folder = tempfile::tempdir().unwrap();
        let library = machine::circuit::library(folder.path(), &spec).unwrap();
        let model = machine::model::MachineModel::new(&library).unwrap();
        for case in machine::mistakes::judges().unwrap() {
            for timing in machine::bench::MEMORIES {
                let config = machine::report::machine(&spec, &timing).unwrap();
                let (modelled, room) = machine::report::modelled(&case.seen, &design, &config);
                let found =
                    machine::bench::draw(&model, &spec, &case.seen, timing, room, 2).unwrap();
                assert!(found.agree() && found.painted > 200, "{found:?}");
                // What happens once in a frame is not modelled; nothing else may be apart.
                let apart = modelled.total.abs_diff(found.outcome.cycles());
                let model = [modelled.geometry, modelled.sort, modelled.raster];
                println!("{timing:?}: {:?}, model {model:?}", found.outcome);
                assert!(
                    timing.pauses > 0 || apart < 1_200,
                    "{apart}: {found:?}, {model:?}"
                );
            }
            // Once, and without room for its lists.
            let judged = machine::mistakes::judged_once(&model, &spec, &case);
            assert_eq!(judged.unwrap(), None, "{}", case.seen.name);
        }
    }

    /// What the frames above are to show of tiles without splats: before, between and behind the others, in the last column and the last row.
    #[test]
    fn tiles_without_splats_are_everywhere() {
        let cases = machine::mistakes::judges().unwrap();
        let empty = &cases[1].empty;
        let drawn = |index: &usize| !empty[*index];
        let first = (0..28).find(drawn).unwrap();
        let last = (0..28).rev().find(drawn).unwrap();
        println!("{empty:?}");
        assert_eq!(empty.len(), 28);
        assert!(first > 0 && last < 27 && (first..last).any(|index| empty[index]));
        assert!((0..4).any(|row| empty[7 * row + 6]) && (21..28).any(|index| empty[index]));
    }

    #[test]
    fn lean18_agrees_with_the_kernel() {
        agrees("lean18");
    }

    #[test]
    fn standard24_agrees_with_the_kernel() {
        agrees("standard24");
    }

    /// Packets of arbitrary bits leave no splat stuck and the next tile untouched.
    #[test]
    fn hostile_packets_neither_hang_nor_linger() {
        let widths = Lean18::WIDTHS;
        let load = workload::random(&widths, 20, 20, 5);
        let mut hostile = load.footprints.clone();
        let mut state = 17;
        for footprint in &mut hostile {
            let mut bits = || workload::split_mix(&mut state) as i64;
            footprint.centre = [bits(), bits()];
            footprint.ldl.shear.mantissa = bits() as i32;
            footprint.ldl.shear.exponent = bits() as i32 % 512;
            footprint.ldl.vertical.exponent = bits() as i32 % 512;
            footprint.ldl.horizontal.exponent = bits() as i32 % 512;
            footprint.ldl.squared_width.exponent = bits() as i32 % 512;
            footprint.first = [bits() as u16, bits() as u16];
            footprint.end = [bits() as u16, bits() as u16];
            footprint.cutoff = bits() as u32;
        }
        for lanes in LANES {
            let mut bench = Bench::new("lean18", &widths, lanes, &KernelRules::EWA, 3).unwrap();
            let tile = &load.tiles[0];
            let before = bench
                .draw(tile, &load.footprints, Pauses::default())
                .unwrap();
            bench.draw(tile, &hostile, Pauses::default()).unwrap();
            let after = bench
                .draw(tile, &load.footprints, Pauses::default())
                .unwrap();
            let cycles = [&before, &after].map(|tile| tile.stamps.raster_cycles());
            assert_eq!(cycles[0], cycles[1], "the tiles' cycles");
            assert!(before.pixels == after.pixels, "the tiles' pixels");
        }
    }

    #[test]
    fn packets_of_another_version_are_dropped_and_counted() {
        let mut model = Model::new("lean18", 1, 1).unwrap();
        let tile = Inputs {
            tile_valid: 1,
            end_column: 64,
            end_row: 16,
            lanes_enable: 1,
            ..Inputs::default()
        };
        while model.tick(&tile).tile_ready == 0 {}
        let mut packet = Inputs {
            packet_valid: 1,
            lanes_enable: 1,
            ..Inputs::default()
        };
        packet.packet[0] = VERSION + 1;
        while model.tick(&packet).packet_ready == 0 {}
        let out = model.tick(&Inputs::default());
        assert_eq!((out.foreign_packets, out.raster_idle), (1, 1));
    }

    #[test]
    fn an_empty_tile_is_transparent_black() {
        let load = workload::random(&Lean18::WIDTHS, 1, 1, 1);
        let tile = BenchTile {
            list: Vec::new(),
            ..load.tiles[0].clone()
        };
        let mut bench = Bench::new("lean18", &Lean18::WIDTHS, 4, &KernelRules::EWA, 3).unwrap();
        let got = bench
            .draw(&tile, &load.footprints, Pauses::default())
            .unwrap();
        let clear = splatline::blend::Pixel::clear(&Lean18::WIDTHS);
        assert!(got.pixels.iter().all(|pixel| *pixel == clear));
    }

    /// What Verilator says of the units of a list with these packages before them, all warnings but those that lint.vlt gives a reason for.
    fn lint(list: &str, top: &str, packages: &[String], parameters: &[String]) -> (bool, String) {
        let rtl = harmonics::text::path();
        let rtl = rtl.parent().unwrap();
        let units = std::fs::read_to_string(rtl.join(list)).unwrap();
        let verilator = std::env::var("VERILATOR").unwrap_or_else(|_| "verilator".to_owned());
        let output = std::process::Command::new(verilator)
            .current_dir(rtl)
            .args(["--lint-only", "-Wall", "--top-module", top])
            .args(parameters.iter().map(|given| format!("-G{given}")))
            .arg("lint.vlt")
            .args(packages)
            .args(units.lines())
            .output()
            .unwrap();
        let words = String::from_utf8_lossy(&output.stderr).into_owned();
        (output.status.success(), words)
    }

    fn lint_primitive(design: &str, lanes: u32, queue: u32) -> (bool, String) {
        let parameters = [format!("LANES={lanes}"), format!("QUEUE={queue}")];
        let package = format!("{design}/splatline_pkg.sv");
        lint("files.txt", "splat_primitive", &[package], &parameters)
    }

    fn lint_harmonics(multipliers: u32) -> (bool, String) {
        let parameters = [format!("MULTIPLIERS={multipliers}")];
        lint("harmonics_files.txt", "harmonics_unit", &[], &parameters)
    }

    #[test]
    fn every_legal_circuit_elaborates_without_a_warning() {
        for design in ["lean18", "standard24"] {
            for (lanes, queue) in [(1, 8), (2, 2), (4, 8), (8, 16), (16, 256)] {
                let (accepted, words) = lint_primitive(design, lanes, queue);
                assert!(accepted && words.is_empty(), "{lanes}, {queue}: {words}");
            }
        }
    }

    /// The machine, with the setup unit and what stands between.
    #[test]
    fn the_machine_elaborates_without_a_warning() {
        for design in ["lean18", "standard24"] {
            let packages = ["splatline_pkg.sv", "splatline_setup_pkg.sv"];
            let packages = packages.map(|package| format!("{design}/{package}"));
            let (accepted, words) = lint("machine_files.txt", "splat_machine", &packages, &[]);
            assert!(accepted && words.is_empty(), "{design}: {words}");
        }
    }

    #[test]
    fn the_harmonics_unit_elaborates_without_a_warning() {
        for multipliers in harmonics::circuit::MULTIPLIERS {
            let (accepted, words) = lint_harmonics(multipliers);
            assert!(accepted && words.is_empty(), "{multipliers}: {words}");
        }
        let (accepted, words) = lint_harmonics(3);
        assert!(!accepted && words.contains("MULTIPLIERS must be 1 or 2"));
    }

    #[test]
    fn illegal_circuits_do_not_elaborate() {
        for (lanes, queue, words) in [
            (3, 8, "LANES must be 1, 2, 4, 8 or 16"),
            (32, 8, "LANES must be 1, 2, 4, 8 or 16"),
            (4, 6, "QUEUE must be a power of two"),
            (4, 1, "QUEUE must be a power of two"),
        ] {
            let (accepted, said) = lint_primitive("lean18", lanes, queue);
            assert!(
                !accepted && said.contains(words),
                "{lanes}, {queue}: {said}"
            );
        }
    }

    #[test]
    fn there_is_no_circuit_with_three_lanes() {
        let error = Model::new("lean18", 3, 1).err();
        assert_eq!(error, Some(Missing::Model("lean18".to_owned(), 3)));
    }

    #[test]
    #[ignore = "verilates and compiles two setup units: a minute; also `cargo run -p splatline-rtl --example rtl -- setup mutants`"]
    fn every_mistake_of_the_setup_unit_is_noticed() {
        let judge = setup::mistakes::SetupJudge::new().unwrap();
        every(&setup::mistakes::MISTAKES, |mistake| judge.verdict(mistake));
    }

    /// A scene without a spacing, and the same with that of its samples, part of which then lies beyond k.
    #[test]
    #[ignore = "verilates and compiles a machine; also `cargo run -p splatline-rtl --example rtl -- machine distance`"]
    fn the_machine_enlarges_what_is_far() {
        let design = DesignChoice::load("lean18").unwrap();
        let spec = machine::circuit::MachineSpec {
            program: setup::program::with_distance_scaling,
            ..machine::circuit::MachineSpec::new("lean18", &design.widths, 2, 4)
        };
        let folder = tempfile::tempdir().unwrap();
        let library = machine::circuit::library(folder.path(), &spec).unwrap();
        let model = machine::model::MachineModel::new(&library).unwrap();
        let mut painted = Vec::new();
        for spaced in [false, true] {
            let mut seen = machine::mistakes::judges().unwrap().swap_remove(0).seen;
            if spaced {
                seen.scene.natural_rules = machine::report::spaced(&seen);
                let (beyond, all) = machine::report::beyond(&seen).unwrap();
                assert!(
                    beyond > all / 10 && beyond < all,
                    "{beyond} of {all} splats"
                );
            }
            for timing in machine::bench::MEMORIES {
                let config = machine::report::machine(&spec, &timing).unwrap();
                let room = machine::report::modelled(&seen, &design, &config).1;
                let found = machine::bench::draw(&model, &spec, &seen, timing, room, 2).unwrap();
                assert!(found.agree() && found.painted > 200, "{found:?}");
                painted.push(found.outcome.entries);
            }
        }
        assert_ne!(painted[0], painted[3], "distance scaling changes no list");
    }

    #[test]
    #[ignore = "verilates and compiles seven setup units; also `cargo run -p splatline-rtl --example rtl -- setup distance mutants`"]
    fn every_mistake_of_distance_scaling_is_noticed() {
        use setup::program_mistakes::{PROGRAM_MISTAKES, verdict};
        for mistake in some(&PROGRAM_MISTAKES) {
            let word = verdict(mistake.program).unwrap();
            assert!(word.is_some(), "{} survives", mistake.name);
        }
    }

    #[test]
    #[ignore = "verilates and compiles a harmonics unit and draws by it; also `cargo run -p splatline-rtl --example rtl -- harmonics mutants`"]
    fn every_mistake_of_the_harmonics_unit_is_noticed() {
        let judge = harmonics::mistakes::HarmonicsJudge::new().unwrap();
        every(&harmonics::mistakes::MISTAKES, |mistake| {
            judge.verdict(mistake)
        });
    }

    #[test]
    #[ignore = "verilates and compiles three machines: minutes; also `cargo run -p splatline-rtl --example rtl -- machine mutants`"]
    fn every_mistake_of_the_machine_is_noticed() {
        let judge = machine::mistakes::MachineJudge::new().unwrap();
        every(&machine::mistakes::MISTAKES, |mistake| {
            judge.verdict(mistake)
        });
    }

    #[test]
    #[ignore = "verilates and compiles two circuits and draws by them: minutes; also `cargo run -p splatline-rtl --example rtl -- mutants`"]
    fn every_mutant_is_noticed() {
        let judge = splatline_rtl::mutants::MutantJudge::new().unwrap();
        every(&splatline_rtl::mutants::MUTANTS, |mutant| {
            judge.verdict(mutant)
        });
    }

    /// A number from the environment.
    fn number(name: &str) -> Option<usize> {
        let asked = std::env::var(name).ok();
        asked.map(|text| text.parse().expect("a number"))
    }

    /// SPLATLINE_MUTANTS=N takes about N mistakes, spread over the list from a place that SPLATLINE_SEED chooses; otherwise all.
    fn some<T>(all: &[T]) -> impl Iterator<Item = &T> {
        let count = number("SPLATLINE_MUTANTS").unwrap_or(all.len()).max(1);
        let step = all.len().div_ceil(count);
        let first = number("SPLATLINE_SEED").unwrap_or(0) % step;
        all.iter().skip(first).step_by(step)
    }

    /// Every mistake is noticed.
    fn every(all: &[Mutant], verdict: impl Fn(&Mutant) -> anyhow::Result<Option<String>>) {
        for mutant in some(all) {
            assert!(verdict(mutant).unwrap().is_some(), "{mutant:?} survives");
        }
    }
}

#[cfg(not(has_rtl))]
#[test]
#[ignore = "verilator was not found when this was built: install it (apt-get install verilator) and build again"]
fn circuits_agree_with_the_kernel() {}
