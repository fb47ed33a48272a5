//! Commands around the RTL: `cargo run --release -p splatline-rtl --example rtl -- COMMAND`.

use anyhow::{Context, Result, ensure};
use splatline::format::Traversal;
use splatline_rtl::circuit::{self, Spec};
use splatline_rtl::model::Model;
use splatline_rtl::setup::program::{SetupProgram, program, with_distance_scaling};
use splatline_rtl::stamps::{Distances, STAGES};
use splatline_rtl::suite::{DESIGNS, Extent, LANES, Line, Loads, PASSES, PictureLine};
use splatline_rtl::{
    area, bitstream, fmax, formal, harmonics, machine, mutants, order, package, setup, tables,
};
use splatline_sim::design::DesignChoice;
use splatline_sim::machine::Config;
use splatline_sim::machine::area::{Family, raster_unit, synthesis};
use splatline_sim::machine::primitive::SETUP_INTERVAL;
use splatline_sim::machine::summary::Spread;
use splatline_sim::metrics::median;
use std::path::Path;
use std::process::ExitCode;

const USAGE: &str = "usage: rtl COMMAND
  package       write sim/rtl/<design>/splatline_pkg.sv from the kernel's widths and tables
  package FILE.toml FOLDER   the package of a design of your own into a folder
  package FILE.toml FOLDER distance   the same with distance scaling in the setup unit's program
  cosim         every tile-buffer word and every raster cycle of all circuits against the kernel
  cosim quick   the part of it that `cargo test` runs
  cosim shapes  the quick part for 1 to 16 lanes, a packet in every cycle, and a third design: circuits that are built for it (a quarter of an hour)
  area          LUT, FF, DSP and memory of all circuits by Yosys (18 minutes): calibrates the estimate, writes docs/area.md
  area DESIGN   the same for one design alone, as 'of fit'
  area page     docs/area.md again without synthesis, and the model's clocks
  area fmax     Fmax by nextpnr on the ECP5, of what was not placed yet (some minutes a seed), into docs/area.md
  area fmax WORDS [SEED]  circuits whose name contains WORDS, as `lean18 splat_primitive 1`, `setup_unit` or `splat_order`, with five seeds or with one
  area flat WORDS  what these circuits take on the ECP5, flattened between registers as they would be placed, without placing them
  bitstream DESIGN LANES FILE   the primitive between registers as a bitstream for the ECP5 LFE5U-85F, by Yosys, nextpnr and ecppack
  estimate DESIGN LANES   the model's estimate of area, without synthesis
  mutants       circuits with one mistake each: is it noticed?
  mutants PART  those whose name contains PART
  formal        what the units promise, by a solver (yosys-smtbmc, z3), each seen to fail on a mistake
  setup         the setup unit's packets and culls against the kernel's, a million splats for each design
  setup exact   the same with splats of few bits: a minute
  setup distance   the same of the unit with distance scaling, under rules with a spacing
  setup distance mutants   programs with one mistake each in distance scaling
  setup units   reciprocal, root and logarithm of its cores for every mantissa of a design's width
  setup area    LUT, FF, DSP and memory of the setup unit by Yosys (an hour): calibrates the estimate, writes docs/setup-unit.md
  setup area DESIGN CORES FAMILY   the same for one unit alone, as 'of fit' 1 'Xilinx 7'
  setup area page   docs/setup-unit.md again without synthesis
  order         sorter and binning against the kernel's order and the model's lists, five scenes and hard keys
  order ways    what the ways of sorting cost on five scenes, for docs/decisions/depth-order.md
  order area    LUT, FF, DSP and memory of sorter and binning by Yosys
  order mutants [PART]   sorters with one mistake each: is it noticed?
  harmonics     the harmonics unit's colours against the kernel's, and its cycles a splat
  harmonics area   LUT, FF, DSP and memory of the harmonics unit by Yosys
  harmonics mutants [PART]   harmonics units with one mistake each: is it noticed?
  machine [SCENE]   whole frames of the whole machine against the kernel's and the model's cycles, five scenes or one
  machine distance [SCENE]   the same with distance scaling, each scene with the spacing of its samples
  machine mutants [PART]   machines with one mistake each between their units: is it noticed?
  setup mutants [PART]   setup units with one mistake each: is it noticed?
";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let result = match words.as_slice() {
        ["package"] => write_packages(),
        ["package", design, folder] => write_package(design, Path::new(folder), program),
        ["package", design, folder, "distance"] => {
            write_package(design, Path::new(folder), with_distance_scaling)
        }
        ["cosim"] => cosim(Extent::Full),
        ["cosim", "quick"] => cosim(Extent::Quick),
        ["cosim", "shapes"] => cosim_shapes(),
        ["area"] => area::report(),
        ["area", "page"] => area::page(),
        ["area", "fmax"] => fmax::report(),
        ["area", "flat", words] => fmax::counts_of(words),
        ["area", "fmax", words] => fmax::part(words, None),
        ["area", "fmax", words, seed] => seed
            .parse()
            .context("a seed")
            .and_then(|seed| fmax::part(words, Some(seed))),
        ["bitstream", design, lanes, file] => lanes
            .parse()
            .context("a number of lanes")
            .and_then(|lanes| bitstream::write(design, lanes, Path::new(file)))
            .map(|line| println!("{line}")),
        ["estimate", design, lanes] => print_estimate(design, lanes),
        ["area", design] => area::design(design),
        ["formal"] => formal::report(),
        ["mutants"] => judge_mutants(""),
        ["mutants", part] => judge_mutants(part),
        ["setup"] => setup::report::full(),
        ["setup", "exact"] => setup::report::few(),
        ["setup", "distance"] => setup::report::with_spacing(),
        ["setup", "distance", "mutants"] => judge_programs(),
        ["setup", "units"] => setup_units(),
        ["setup", "area"] => setup::area::report(),
        ["setup", "area", "page"] => setup::area::page(),
        ["setup", "area", design, cores, family] => cores
            .parse()
            .context("a number of cores")
            .and_then(|cores| setup::area::one(design, cores, family)),
        ["machine"] => machine::report::print(128, None),
        ["machine", "distance"] => machine::report::print_distance(128, None),
        ["machine", "distance", scene] => machine::report::print_distance(128, Some(scene)),
        ["machine", "mutants"] => judge_machine_mutants(""),
        ["machine", "mutants", part] => judge_machine_mutants(part),
        ["machine", scene] => machine::report::print(128, Some(scene)),
        ["order"] => order(),
        ["order", "ways"] => order::study::print(512),
        ["harmonics"] => harmonics::report::full(),
        ["harmonics", "area"] => harmonics_area(),
        ["harmonics", "mutants"] => judge_harmonics_mutants(""),
        ["harmonics", "mutants", part] => judge_harmonics_mutants(part),
        ["order", "area"] => {
            area::print_values("order_files.txt", "splat_order", "DIGIT", &[8, 12])
        }
        ["order", "mutants"] => judge_order_mutants(""),
        ["order", "mutants", part] => judge_order_mutants(part),
        ["setup", "mutants"] => judge_setup_mutants(""),
        ["setup", "mutants", part] => judge_setup_mutants(part),
        _ => {
            eprint!("{USAGE}");
            return ExitCode::from(2);
        }
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::from(1)
        }
    }
}

fn write_packages() -> Result<()> {
    for design in DESIGNS {
        let path = package::path(design);
        write_package(design, path.parent().unwrap_or(Path::new(".")), program)?;
    }
    write_whole(&tables::path(), &tables::text())?;
    write_whole(&harmonics::text::path(), &harmonics::text::text()?)
}

fn print_estimate(design: &str, lanes: &str) -> Result<()> {
    let design = DesignChoice::load(design)?;
    let machine = Config::primitive(lanes.parse()?);
    for family in Family::ALL {
        let prices = family.calibration();
        let area = raster_unit(&design.widths, Traversal::Spans, &machine, &prices);
        println!(
            "{}: {area}\n  ({})",
            family.name(),
            synthesis::statement(&prices)
        );
    }
    Ok(())
}

fn write_package(design: &str, folder: &Path, program: SetupProgram) -> Result<()> {
    let choice = DesignChoice::load(design)?;
    std::fs::create_dir_all(folder)?;
    let text = package::text(choice.name.as_str(), &choice.widths)?;
    write_whole(&folder.join("splatline_pkg.sv"), &text)?;
    let setup = setup::text::with_program(choice.name.as_str(), &choice.widths, program)?;
    write_whole(&folder.join("splatline_setup_pkg.sv"), &setup)
}

/// A file under its name is always a whole one.
fn write_whole(path: &Path, text: &str) -> Result<()> {
    Ok(splatline_sim::atomic::write(path, text.as_bytes())?)
}

/// Words, cycles of every splat, and cycles of whole pictures, for all circuits.
fn cosim(extent: Extent) -> Result<()> {
    println!(
        "| design | lanes | rules | workload | tiles | splats | pixels, three times | mismatches | splats timed | in another cycle | raster cycles | covered per cycle and lane |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|");
    let (mut lines, mut pictures) = (Vec::new(), Vec::new());
    for design in DESIGNS {
        for loads in Loads::all(design, extent)? {
            for lanes in LANES {
                let mut bench = loads.bench(lanes)?;
                let found: Vec<Line> = loads.check(&mut bench, lanes).collect();
                for passes in found.chunks(PASSES) {
                    print_line(passes);
                    lines.extend_from_slice(passes);
                }
                pictures.extend(loads.pictures(&mut bench, lanes)?);
            }
            for missing in &loads.missing {
                println!("(no {missing}: its data is not at hand)");
            }
        }
    }
    print_pictures(&pictures);
    print_errors(&lines, &pictures);
    summary(&lines, &pictures)
}

/// How far model and circuit are apart, by scene and stage, over all circuits: cycles of each event, and parts of a picture's raster phase.
fn print_errors(lines: &[Line], pictures: &[PictureLine]) {
    println!("\n| scene | stage | events | median | 95 % | worst |\n|---|---|---:|---:|---:|---:|");
    let mut scenes: Vec<&str> = Vec::new();
    for line in lines {
        if !scenes.contains(&line.workload) {
            scenes.push(line.workload);
        }
    }
    for scene in scenes {
        for (stage, name) in STAGES.iter().enumerate() {
            let mut all = Distances::default();
            for line in lines.iter().filter(|line| line.workload == scene) {
                all.add(&line.findings.distances[stage]);
            }
            let cycles = |percent| match all.percentile(percent) {
                u64::MAX => "never".to_owned(),
                apart => format!("{apart} cycles"),
            };
            let [median, p95, worst] = [50, 95, 100].map(cycles);
            println!(
                "| {scene} | {name} | {} | {median} | {p95} | {worst} |",
                all.events()
            );
        }
        let of_scene = pictures.iter().filter(|line| line.workload == scene);
        let mut parts: Vec<f64> = of_scene.map(|line| line.cycles.deviation().abs()).collect();
        if parts.is_empty() {
            continue;
        }
        let middle = median(&mut parts).unwrap_or(0.0);
        let spread = Spread::of(parts.iter().copied());
        println!(
            "| {scene} | picture | {} | {:.4} % | {:.4} % | {:.4} % |",
            parts.len(),
            100.0 * middle,
            100.0 * spread.percentile_95,
            100.0 * spread.worst
        );
    }
}

/// Shapes that are not linked in: design, lanes, cycles between two packets.
const SHAPES: [(&str, usize, u32); 11] = [
    ("lean18", 2, 4),
    ("lean18", 8, 4),
    ("lean18", 16, 4),
    ("lean18", 4, 1),
    ("standard24", 2, 4),
    ("standard24", 8, 4),
    ("standard24", 16, 4),
    ("standard24", 1, 1),
    (THIRD, 1, 4),
    (THIRD, 4, 4),
    (THIRD, 16, 4),
];

/// Widths between the two designs, of `rtl -- area`.
const THIRD: &str = "24-bit mantissa";

/// The same for other numbers of lanes, for setup in every cycle, and for a third design, each built for it.
fn cosim_shapes() -> Result<()> {
    println!(
        "| design | lanes | cycles between packets | pixels, three times | mismatches | splats timed | in another cycle | pictures: model / circuit - 1, at most |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    let (mut lines, mut pictures) = (Vec::new(), Vec::new());
    for (design, lanes, interval) in SHAPES {
        let (found, drawn) = shape(design, lanes, interval)?;
        let sum = |of: fn(&Line) -> u64| found.iter().map(of).sum::<u64>();
        let worst = drawn.iter().map(|line| line.cycles.deviation().abs());
        let worst = match worst.reduce(f64::max) {
            Some(worst) => format!("{:.4} %", 100.0 * worst),
            None => "-".to_owned(),
        };
        println!(
            "| {design} | {lanes} | {interval} | {} | {} | {} | {} | {worst} |",
            sum(|line| line.findings.visited),
            sum(|line| line.findings.mismatches),
            sum(|line| line.findings.timed),
            sum(|line| line.findings.wrong_cycles),
        );
        lines.extend(found);
        pictures.extend(drawn);
    }
    summary(&lines, &pictures)
}

fn shape(
    design: &'static str,
    lanes: usize,
    interval: u32,
) -> Result<(Vec<Line>, Vec<PictureLine>)> {
    let subject = synthesis::subjects()
        .into_iter()
        .find(|subject| subject.name == design)
        .context("no such design")?;
    let mut choice = DesignChoice::load("standard24")?.at_run_time();
    choice.name = design.to_owned();
    choice.widths = subject.widths;
    let folder = tempfile::tempdir()?;
    let spec = Spec {
        setup_interval: interval,
        effort: "-O2",
        ..Spec::new(design, &subject.widths, lanes)
    };
    let library = spec.library(folder.path())?;
    let (mut lines, mut pictures) = (Vec::new(), Vec::new());
    for loads in Loads::all_of(design, &choice, Extent::Quick)? {
        let mut bench = loads.bench_around(Model::from_library(&library, circuit::NAME, 1)?);
        bench.setup_interval = interval;
        lines.extend(loads.check(&mut bench, lanes));
        if interval == SETUP_INTERVAL {
            pictures.extend(loads.pictures(&mut bench, lanes)?);
        }
    }
    Ok((lines, pictures))
}

/// One workload's passes: at full speed, with late packets, with back-pressure everywhere.
fn print_line(passes: &[Line]) {
    let Some(Line {
        design,
        lanes,
        rules,
        workload,
        findings,
        ..
    }) = passes.first()
    else {
        return;
    };
    let sum = |of: fn(&Line) -> u64| passes.iter().map(of).sum::<u64>();
    let rate = findings.covered as f64 / findings.raster_cycles as f64 / *lanes as f64;
    println!(
        "| {design} | {lanes} | {rules} | {workload} | {} | {} | {} | {} | {} | {} | {} | {rate:.3} |",
        findings.tiles,
        findings.splats,
        sum(|line| line.findings.visited),
        sum(|line| line.findings.mismatches),
        sum(|line| line.findings.timed),
        sum(|line| line.findings.wrong_cycles),
        findings.raster_cycles,
    );
}

fn print_pictures(pictures: &[PictureLine]) {
    println!(
        "\n| design | lanes | rules | picture | memory's limits | cycles by the model | by the circuit | model / circuit - 1 | mismatches |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    for line in pictures {
        let PictureLine {
            design,
            lanes,
            rules,
            workload,
            limits,
            cycles,
        } = line;
        println!(
            "| {design} | {lanes} | {rules} | {workload} | {limits} | {} | {} | {:+.4} % | {} |",
            cycles.model,
            cycles.circuit,
            100.0 * cycles.deviation(),
            cycles.mismatches
        );
    }
}

fn summary(lines: &[Line], pictures: &[PictureLine]) -> Result<()> {
    let sum = |of: fn(&Line) -> u64| lines.iter().map(of).sum::<u64>();
    let worst = pictures
        .iter()
        .map(|line| line.cycles.deviation().abs())
        .fold(0.0, f64::max);
    println!(
        "\n{} pixels, {} mismatches; {} roots of rows; handshakes of {} splats, {} of them in another cycle; pictures within {:.4} %",
        sum(|line| line.findings.visited),
        sum(|line| line.findings.mismatches)
            + pictures
                .iter()
                .map(|line| line.cycles.mismatches)
                .sum::<u64>(),
        sum(|line| line.findings.roots),
        sum(|line| line.findings.timed),
        sum(|line| line.findings.wrong_cycles),
        100.0 * worst,
    );
    let difference = lines
        .iter()
        .find_map(|line| line.findings.first_difference.as_ref());
    ensure!(
        difference.is_none(),
        "{}",
        difference.map_or("", |text| text)
    );
    ensure!(worst <= 0.01, "a picture's cycles differ by more than 1 %");
    Ok(())
}

/// What the harmonics unit takes by each number of its multipliers.
fn harmonics_area() -> Result<()> {
    let values = &harmonics::circuit::MULTIPLIERS;
    area::print_values(
        "harmonics_files.txt",
        "harmonics_unit",
        "MULTIPLIERS",
        values,
    )
}

/// Judges the primitive's mistakes whose name contains `part`.
fn judge_mutants(part: &str) -> Result<()> {
    let judge = mutants::MutantJudge::new()?;
    let all = &mutants::MUTANTS;
    survivors(&judge_mistakes(all, part, |mutant| judge.verdict(mutant))?)
}

/// The same for the harmonics unit.
fn judge_harmonics_mutants(part: &str) -> Result<()> {
    let judge = harmonics::mistakes::HarmonicsJudge::new()?;
    let all = &harmonics::mistakes::MISTAKES;
    survivors(&judge_mistakes(all, part, |mutant| judge.verdict(mutant))?)
}

fn setup_units() -> Result<()> {
    for (design, widths, _) in setup::report::SUBJECTS {
        // standard24 has too many mantissas for all of them.
        let step = 1 << (widths.mantissa - 18);
        let difference = setup::vectors::first_difference(design, &widths, step)?;
        ensure!(
            difference.is_none(),
            "{design}: {}",
            difference.unwrap_or_default()
        );
        println!("{design}: every {step}. mantissa agrees");
    }
    Ok(())
}

/// Five scenes and hard keys through sorters of two digits.
fn order() -> Result<()> {
    println!(
        "| digit | splats of | splats | entries | cycles | latency | pauses | out of order | entries wrong |"
    );
    println!("|---|---|---:|---:|---:|---:|---:|---:|---:|");
    let design = DesignChoice::load("lean18")?;
    let (seen, missing) = order::loads::scenes(&order::loads::SCENES, 512)?;
    for name in missing {
        println!("(no {name}: its data is not at hand)");
    }
    let scenes = seen
        .iter()
        .map(|seen| order::loads::ordered(seen, &design).1);
    let loads: Vec<_> = scenes.chain(order::loads::hard()).collect();
    let mut wrong = 0;
    for digit in [8, 12] {
        let folder = tempfile::tempdir()?;
        let library = order::circuit::library(folder.path(), digit, None, "-O2")?;
        let model = order::model::OrderModel::new(&library)?;
        for load in &loads {
            for timing in order::bench::MEMORIES {
                let found = order::bench::run(&model, load, timing, 1)?;
                wrong += usize::from(!found.agree());
                let outcome = found.outcome;
                println!(
                    "| {digit} | {} | {} | {} | {} | {} | {} | {} | {} |",
                    load.name,
                    outcome.splats,
                    outcome.entries,
                    outcome.done,
                    timing.latency,
                    timing.pauses,
                    found.out_of_order,
                    found.listed_wrong
                );
            }
        }
    }
    ensure!(wrong == 0, "{wrong} runs differ");
    Ok(())
}

/// The mutation check of sorter and binning; the circuit without a mistake must pass.
fn judge_order_mutants(part: &str) -> Result<()> {
    let loads = order::mistakes::judges();
    let clean = order::mistakes::verdict(None, &loads)?;
    ensure!(
        clean.is_none(),
        "without a mistake: {}",
        clean.unwrap_or_default()
    );
    let table = judge_mistakes(&order::mistakes::MISTAKES, part, |mutant| {
        order::mistakes::verdict(Some(mutant), &loads)
    })?;
    survivors(&table)
}

/// The mutation check of the whole machine; the circuit without a mistake must pass.
fn judge_machine_mutants(part: &str) -> Result<()> {
    let judge = machine::mistakes::MachineJudge::new()?;
    let all = &machine::mistakes::MISTAKES;
    survivors(&judge_mistakes(all, part, |mutant| judge.verdict(mutant))?)
}

/// The same for the setup unit.
fn judge_setup_mutants(part: &str) -> Result<()> {
    let judge = setup::mistakes::SetupJudge::new()?;
    let all = &setup::mistakes::MISTAKES;
    let table = judge_mistakes(all, part, |mutant| judge.verdict(mutant))?;
    if part.is_empty() {
        write_whole(setup::area::JUDGED.as_ref(), &table)?;
    }
    survivors(&table)
}

/// Judges the programs with a mistake in distance scaling, and that without.
fn judge_programs() -> Result<()> {
    use setup::program_mistakes::{PROGRAM_MISTAKES, verdict};
    splatline_rtl::switch::expect_no_difference(verdict(with_distance_scaling)?)?;
    let judged = PROGRAM_MISTAKES
        .iter()
        .map(|mistake| (mistake.name.to_owned(), verdict(mistake.program)));
    let table = judged_table(
        "| mistake in the program | noticed as |\n|---|---|\n",
        judged,
    )?;
    write_whole(setup::area::JUDGED_PROGRAMS.as_ref(), &table)?;
    survivors(&table)
}

/// Prints how each mistake was noticed whose name contains `part`; gives the table.
fn judge_mistakes(
    mistakes: &[mutants::Mutant],
    part: &str,
    verdict: impl Fn(&mutants::Mutant) -> Result<Option<String>>,
) -> Result<String> {
    let named = mistakes.iter().filter(|mutant| mutant.name.contains(part));
    let judged = named.map(|mutant| {
        (
            format!("{} | {}", mutant.name, mutant.file),
            verdict(mutant),
        )
    });
    judged_table("| mistake | unit | noticed as |\n|---|---|---|\n", judged)
}

/// Prints a table of mistakes line by line, as a judgement takes a while, and gives it.
fn judged_table(
    heading: &str,
    judged: impl Iterator<Item = (String, Result<Option<String>>)>,
) -> Result<String> {
    let mut table = heading.to_owned();
    print!("{table}");
    for (mistake, verdict) in judged {
        let noticed = verdict?.unwrap_or_else(|| NOT_NOTICED.to_owned());
        let line = format!("| {mistake} | {noticed} |\n");
        print!("{line}");
        table += &line;
    }
    Ok(table)
}

const NOT_NOTICED: &str = "**not noticed**";

/// An error if the table has a mistake that was not noticed.
fn survivors(table: &str) -> Result<()> {
    let survivors = table.matches(NOT_NOTICED).count();
    ensure!(survivors == 0, "{survivors} mutants survive");
    Ok(())
}
