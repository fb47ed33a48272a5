//! The circuits against the kernel. Without Verilator these tests are ignored; the packages are compared all the same.

use splatline_rtl::circuit::{DESIGNS, packages};
use splatline_rtl::setup::program::{ProgramKind, SetupProgram};
use splatline_rtl::tools::rtl;
use splatline_rtl::{harmonics, tables};
use splatline_sim::design::DesignChoice;
use std::path::Path;

fn assert_committed(path: &Path, text: &str) {
    let committed = std::fs::read_to_string(path).unwrap();
    assert!(
        committed == text,
        "{} is stale; run `cargo run -p splatline-rtl --example rtl -- package` and commit the result",
        path.display()
    );
}

#[test]
fn committed_packages_are_the_generators() {
    let program = SetupProgram::new(ProgramKind::Filter);
    for design in DESIGNS {
        let folder = rtl().join(design);
        let choice = DesignChoice::load(design).unwrap();
        for (file, text) in packages(&choice, &program, 2).unwrap() {
            assert_committed(&folder.join(file), &text);
        }
    }
}

/// A core joins a table's answer with the right factor without asking for it.
#[test]
fn terms_with_tables_have_no_right_factor() {
    let programs = [
        SetupProgram::new(ProgramKind::Filter).with_direction(),
        SetupProgram::new(ProgramKind::DistanceScaling),
        SetupProgram::new(ProgramKind::Compensation),
        SetupProgram::new(ProgramKind::Units),
    ];
    for design in DESIGNS {
        let choice = DesignChoice::load(design).unwrap();
        for program in &programs {
            let operations = program.assembled(&choice.widths).unwrap().operations;
            let mut tables = 0;
            for term in operations.iter().flat_map(|operation| &operation.terms) {
                let is_set = |name| term.fields.get(name).is_some_and(|value| *value != 0);
                if is_set("lookup") {
                    tables += 1;
                    assert_eq!(term.b, Default::default(), "{design}: {term:?}");
                    assert!(!is_set("plain") || is_set("entry"), "{design}: {term:?}");
                }
            }
            assert!(tables > 0);
        }
    }
}

#[test]
fn committed_tables_are_the_generators() {
    assert_committed(&rtl().join(tables::FILE), &tables::text());
}

#[test]
fn the_committed_program_of_the_harmonics_unit_is_the_generators() {
    let text = harmonics::program::text().unwrap();
    assert_committed(&rtl().join(harmonics::program::FILE), &text);
}

#[cfg(has_rtl)]
mod with_verilator {
    use splatline::format::Lean18;
    use splatline::setup::Cull;
    use splatline_rtl::circuit::{Circuit, HARMONICS, MACHINE, ORDER, PRIMITIVE};
    use splatline_rtl::harmonics::unit::{HarmonicsLoad, MULTIPLIERS};
    use splatline_rtl::judges;
    use splatline_rtl::machine::MachineLoad;
    use splatline_rtl::machine::unit::{self as machine, with_harmonics};
    use splatline_rtl::mutation::{Mutation, mutations};
    use splatline_rtl::order::OrderLoad;
    use splatline_rtl::primitive::unit::{self as primitive, LANES, PrimitiveLoad};
    use splatline_rtl::setup::program::{ProgramKind, SetupProgram};
    use splatline_rtl::setup::unit as setup;
    use splatline_rtl::setup::{SetupLoad, enlarged};
    use splatline_rtl::tools::rtl;
    use splatline_rtl::unit::{Bench, Extent, Findings, Load};
    use splatline_sim::machine::primitive::Intervals;
    use std::process::Command;

    /// Compares a circuit's quick loads under every pressure; gives what was found of each load.
    fn agrees<L: Load>(circuit: &Circuit) -> Vec<(L, Findings)> {
        let library = circuit.library(Extent::Quick).unwrap();
        let mut missing = Vec::new();
        let loads = L::all(circuit, Extent::Quick, &mut missing).unwrap();
        println!("not at hand: {missing:?}");
        let mut all = Vec::new();
        for (seed, (name, load)) in (1..).zip(loads) {
            let mut sum = Findings::default();
            for pressure in 0..L::WAYS {
                let bench = Bench::new(&library, seed, 0).unwrap();
                let found = load.compare(circuit, bench, pressure);
                let found = found.unwrap_or_else(|error| panic!("{name}: {error:#}"));
                assert_eq!(found.first_difference, None, "{name}, {pressure}");
                sum += found;
            }
            println!("{name}: {sum:?}");
            all.push((load, sum));
        }
        all
    }

    fn total<L>(found: &[(L, Findings)]) -> Findings {
        let mut sum = Findings::default();
        found.iter().for_each(|(_, each)| sum += each.clone());
        sum
    }

    /// How many of this name were found.
    fn counted(findings: &Findings, name: &str) -> u64 {
        let known = findings.counts.iter().find(|known| known.0 == name);
        known.map_or(0, |(_, count)| *count)
    }

    /// Every word, and the cycle of every handshake where the lanes do not pause, for all rules.
    fn primitive_agrees(design: &str) {
        let agrees = |circuit: anyhow::Result<Circuit>| {
            let circuit = circuit.unwrap();
            for (_, found) in agrees::<PrimitiveLoad>(&circuit) {
                let counted = |name| counted(&found, name);
                assert!(
                    counted("visited") > 30_000,
                    "{found:?}: too little was drawn"
                );
                // In two of three passes.
                assert_eq!(3 * counted("splats timed"), 2 * counted("splats"));
            }
        };
        // Most of the time compiles circuits.
        std::thread::scope(|scope| {
            for lanes in LANES {
                scope.spawn(move || agrees(primitive::circuit(design, lanes, Intervals::USUAL)));
            }
            scope.spawn(move || agrees(primitive::few_multipliers(design)));
            agrees(primitive::small(design));
        });
    }

    #[test]
    fn lean18_agrees_with_the_kernel() {
        primitive_agrees("lean18");
    }

    #[test]
    fn standard24_agrees_with_the_kernel() {
        primitive_agrees("standard24");
    }

    /// Rounding, reciprocal, root and logarithm of the setup unit's cores, by a program that has nothing else.
    #[test]
    fn setup_units_equal_the_kernels() {
        let program = SetupProgram::new(ProgramKind::Units);
        agrees::<SetupLoad>(&setup::circuit("lean18", 2, program).unwrap());
    }

    /// Scenes, hard cases and arbitrary bits, among them culls of every kind.
    fn packets_are_the_kernels(design: &str, cores: u32, kind: ProgramKind) {
        let circuit = setup::circuit(design, cores, SetupProgram::new(kind)).unwrap();
        let found = total(&agrees::<SetupLoad>(&circuit));
        assert!(found.compared >= 4_000, "{found:?}");
        assert_eq!(found.counts.len(), Cull::ALL.len());
        for (cull, count) in &found.counts {
            assert!(*count > 0, "no {cull}: {found:?}");
        }
    }

    /// With as many cores as take a splat in eight cycles: phases have gone round when the last pair is told.
    #[test]
    fn setup_unit_gives_the_kernels_packets() {
        packets_are_the_kernels("lean18", 17, ProgramKind::Filter);
    }

    /// Positions in two words, and axes turned in the cores.
    #[test]
    fn wide_setup_unit_gives_the_kernels_packets() {
        packets_are_the_kernels("standard24", 3, ProgramKind::Filter);
    }

    #[test]
    fn setup_unit_compensates_opacities() {
        packets_are_the_kernels("lean18", 3, ProgramKind::Compensation);
    }

    /// Directions beside packets, from positions in one part and in two.
    #[test]
    fn setup_unit_gives_the_kernels_directions() {
        for design in ["lean18", "standard24"] {
            let program = SetupProgram::new(ProgramKind::Filter).with_direction();
            agrees::<SetupLoad>(&setup::circuit(design, 2, program).unwrap());
        }
    }

    /// The same with distance scaling, nearer than the distance k, there and beyond.
    #[test]
    fn setup_unit_enlarges_what_is_far() {
        let program = SetupProgram::new(ProgramKind::DistanceScaling);
        let circuit = setup::circuit("lean18", 3, program).unwrap();
        let (mut beyond, mut splats) = (0, 0);
        for (load, _) in agrees::<SetupLoad>(&circuit) {
            beyond += enlarged(&Lean18::WIDTHS, &load.view, &load.rules, &load.splats);
            splats += load.splats.len();
        }
        assert!(
            beyond > splats / 4 && beyond < splats * 3 / 4,
            "{beyond} of {splats}"
        );
    }

    /// Colours of a scene, of random splats, of corners and arbitrary bits (`rtl -- compare harmonics` takes thousands
    /// of each), with pauses at all ends and resets in mid-splat, by one multiplier and by two.
    #[test]
    fn harmonics_unit_gives_the_kernels_colours() {
        for multipliers in MULTIPLIERS {
            let circuit = Circuit::new(&HARMONICS, "lean18", multipliers).unwrap();
            let found = total(&agrees::<HarmonicsLoad>(&circuit));
            assert!(counted(&found, "resets") > 100, "{found:?}");
        }
    }

    /// Orders and lists with every memory, twice in one circuit, and without room for the lists.
    #[test]
    fn sorter_and_binning_give_the_kernels_order_and_the_models_lists() {
        agrees::<OrderLoad>(&Circuit::new(&ORDER, "lean18", 8).unwrap());
    }

    /// Frames from records in memory by the whole machine, with every memory, twice in one machine, and their cycles by
    /// the model; and frames without room for their lists. Of tiles without splats there are some before, between and
    /// behind the others, in the last column and the last row.
    #[test]
    fn the_machine_draws_the_kernels_frame() {
        let found = agrees::<MachineLoad>(&machine::circuit("lean18", 2, 4).unwrap());
        for (load, found) in &found {
            // Of one frame; five are drawn.
            assert!(counted(found, "painted") > 200, "{found:?}");
            if load.seen.name == "sparse" {
                let empty: Vec<bool> = load.lists.lists.iter().map(Vec::is_empty).collect();
                let first = empty.iter().position(|empty| !empty).unwrap();
                let last = empty.iter().rposition(|empty| !empty).unwrap();
                let [columns, rows] = load.lists.size.map(usize::from);
                assert!(first > 0 && last + 1 < columns * rows);
                assert!(empty[first..last].contains(&true));
                assert!(empty[(rows - 1) * columns..].contains(&true));
                assert!(empty.chunks(columns).any(|row| row[columns - 1]));
            }
        }
    }

    /// Scenes with the spacing of their samples, part of which then lies beyond k.
    #[test]
    #[ignore = "verilates and compiles a machine; also `cargo run -p splatline-rtl --example rtl -- compare frames-distance`"]
    fn the_machine_enlarges_what_is_far() {
        let circuit = machine::circuit("lean18", 2, 4).unwrap();
        let plain = MachineLoad::all(&circuit, Extent::Quick, &mut Vec::new()).unwrap();
        let program = SetupProgram::new(ProgramKind::DistanceScaling);
        let found = agrees::<MachineLoad>(&circuit.with_program(program));
        let (crowd, counts) = &found[0];
        let (beyond, splats) = (counted(counts, "beyond k"), counted(counts, "splats"));
        assert!(
            beyond > splats / 10 && beyond < splats,
            "{beyond} of {splats} splats"
        );
        assert_ne!(crowd.lists.entries(), plain[0].1.lists.entries());
    }

    /// Frames whose splats have colours of harmonics, of degree 0 to 4, by a machine that evaluates them. It has cores
    /// enough for many splats to be on their way behind one that waits for its colour.
    #[test]
    fn the_machine_draws_harmonics() {
        let circuit = machine::circuit("lean18", 6, 4).unwrap();
        agrees::<MachineLoad>(&with_harmonics(circuit, 1));
    }

    /// The same by a unit with two multipliers, and in either design.
    #[test]
    #[ignore = "verilates and compiles two machines; also `cargo run -p splatline-rtl --example rtl -- compare frames-harmonics`"]
    fn the_machine_draws_harmonics_by_two_multipliers() {
        for design in super::DESIGNS {
            let circuit = machine::circuit(design, 6, 4).unwrap();
            agrees::<MachineLoad>(&with_harmonics(circuit, 2));
        }
    }

    /// What Verilator says of a circuit, all warnings but those that lint.vlt gives a reason for.
    fn lint(circuit: &Circuit) -> (bool, String) {
        let folder = tempfile::tempdir().unwrap();
        let read = circuit.read_command(folder.path()).unwrap();
        let verilator = std::env::var("VERILATOR").unwrap_or_else(|_| "verilator".to_owned());
        let parameters = circuit.parameters.iter();
        let output = Command::new(verilator)
            .args(["--lint-only", "-Wall", "--top-module", circuit.unit.top])
            .args(parameters.map(|(name, value)| format!("-G{name}={value}")))
            .arg(rtl().join("lint.vlt"))
            .args(read.split(' ').filter(|word| word.ends_with(".sv")))
            .output()
            .unwrap();
        let words = String::from_utf8_lossy(&output.stderr).into_owned();
        (output.status.success(), words)
    }

    fn small_with_harmonics(design: &str) -> Circuit {
        with_harmonics(machine::circuit(design, 1, 1).unwrap(), 1)
    }

    fn queued(design: &str, lanes: u32, queue: u32) -> Circuit {
        let circuit = Circuit::new(&PRIMITIVE, design, lanes).unwrap();
        circuit.with("QUEUE", queue)
    }

    #[test]
    fn every_legal_circuit_elaborates_without_a_warning() {
        let mut circuits = Vec::new();
        for design in ["lean18", "standard24"] {
            for (lanes, queue) in [(1, 8), (2, 2), (4, 8), (8, 16), (16, 256)] {
                circuits.push(queued(design, lanes, queue));
            }
            circuits.push(primitive::few_multipliers(design).unwrap());
            circuits.push(Circuit::new(&MACHINE, design, 1).unwrap());
            circuits.push(small_with_harmonics(design));
        }
        for multipliers in MULTIPLIERS {
            circuits.push(Circuit::new(&HARMONICS, "lean18", multipliers).unwrap());
        }
        for circuit in circuits {
            let (accepted, words) = lint(&circuit);
            assert!(accepted && words.is_empty(), "{circuit}: {words}");
        }
    }

    #[test]
    fn illegal_circuits_do_not_elaborate() {
        let harmonics = Circuit::new(&HARMONICS, "lean18", 3).unwrap();
        let undirected =
            small_with_harmonics("lean18").with_program(SetupProgram::new(ProgramKind::Filter));
        for (circuit, words) in [
            (undirected, "needs a program of setup with directions"),
            (harmonics, "MULTIPLIERS must be 1 or 2"),
            (queued("lean18", 3, 8), "LANES must be 1, 2, 4, 8 or 16"),
            (queued("lean18", 32, 8), "LANES must be 1, 2, 4, 8 or 16"),
            (queued("lean18", 4, 6), "QUEUE must be a power of two"),
            (queued("lean18", 4, 1), "QUEUE must be a power of two"),
            (
                queued("standard24", 4, 8).with("WIDE_MULTIPLIERS", 2),
                "WIDE_MULTIPLIERS must be 3 or 4",
            ),
        ] {
            let (accepted, said) = lint(&circuit);
            assert!(!accepted && said.contains(words), "{circuit}: {said}");
        }
    }

    /// A number from the environment.
    fn number(name: &str) -> Option<usize> {
        let asked = std::env::var(name).ok();
        asked.map(|text| text.parse().expect("a number"))
    }

    /// SPLATLINE_MUTANTS=N takes about N mutations, spread over the list from a place that SPLATLINE_SEED chooses;
    /// otherwise all.
    fn some(all: Vec<Mutation>) -> Vec<Mutation> {
        let count = number("SPLATLINE_MUTANTS").unwrap_or(all.len()).max(1);
        let step = all.len().div_ceil(count);
        let first = number("SPLATLINE_SEED").unwrap_or(0) % step;
        all.into_iter().skip(first).step_by(step).collect()
    }

    /// Every mutation is noticed.
    fn every(judge: &str) {
        let mutations = some(mutations(judge).unwrap());
        let mut judged = 0;
        let verdict = judges::judge(judge, &mutations, |mutation, noticed| {
            println!("{}: {noticed:?}", mutation.name);
            assert!(noticed.is_some(), "{mutation:?} survives");
            judged += 1;
        });
        verdict.unwrap();
        assert_eq!(judged, mutations.len());
    }

    #[test]
    #[ignore = "verilates and compiles circuits and draws by them: minutes; also `cargo run -p splatline-rtl --example rtl -- mutations`"]
    fn every_mutation_of_the_primitive_is_noticed() {
        every("primitive");
    }

    #[test]
    #[ignore = "verilates and compiles setup units: minutes; also `cargo run -p splatline-rtl --example rtl -- mutations`"]
    fn every_mutation_of_the_setup_unit_is_noticed() {
        every("setup");
    }

    #[test]
    #[ignore = "draws every argument: a minute; also `cargo run -p splatline-rtl --example rtl -- mutations`"]
    fn mutations_without_effect_have_none() {
        every("setup without effect");
    }

    #[test]
    #[ignore = "verilates and compiles fourteen setup units; also `cargo run -p splatline-rtl --example rtl -- mutations`"]
    fn every_mutation_of_programs_is_noticed() {
        every("programs");
    }

    #[test]
    #[ignore = "verilates and compiles a sorter; also `cargo run -p splatline-rtl --example rtl -- mutations`"]
    fn every_mutation_of_the_sorter_is_noticed() {
        every("order");
    }

    #[test]
    #[ignore = "verilates and compiles a harmonics unit and draws by it; also `cargo run -p splatline-rtl --example rtl -- mutations`"]
    fn every_mutation_of_the_harmonics_unit_is_noticed() {
        every("harmonics");
    }

    #[test]
    #[ignore = "verilates and compiles machines: minutes; also `cargo run -p splatline-rtl --example rtl -- mutations`"]
    fn every_mutation_of_the_machine_is_noticed() {
        every("machine");
    }
}

#[cfg(not(has_rtl))]
#[test]
#[ignore = "verilator was not found when this was built: install it (apt-get install verilator) and build again"]
fn circuits_agree_with_the_kernel() {}
