//! Commands around the RTL: `cargo run --release -p splatline-rtl --example rtl -- COMMAND`.

use anyhow::{Result, ensure};
use splatline_rtl::suite::{DESIGNS, Extent, LANES, Line, Loads, rules};
use splatline_rtl::{area, layouts, mutants, package};
use splatline_sim::design::DesignChoice;
use std::path::Path;
use std::process::ExitCode;
use std::time::Duration;

const USAGE: &str = "usage: rtl COMMAND
  package       write sim/rtl/<design>/splatline_pkg.sv from the kernel's widths and tables
  cosim         every tile-buffer word and every raster cycle of all circuits against the kernel
  cosim quick   the part of it that `cargo test` runs
  area          LUT, FF, DSP and memory of all circuits by Yosys, written to docs/area.md
  area DESIGN   one design's lines of it
  layouts       arrangements of four lanes compared on guitar, written to docs/lanes.md
  mutants       circuits with one mistake each: is it noticed?
  mutants PART  those whose name contains PART
";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let result = match words.as_slice() {
        ["package"] => write_packages(),
        ["cosim"] => cosim(Extent::Full),
        ["cosim", "quick"] => cosim(Extent::Quick),
        ["area"] => area::report().and_then(|text| Ok(std::fs::write(area::REPORT, text)?)),
        ["layouts"] => {
            layouts::report().and_then(|text| Ok(std::fs::write(layouts::REPORT, text)?))
        }
        ["area", design] => area::table(design).map(|text| print!("{text}")),
        ["mutants"] => judge_mutants(""),
        ["mutants", part] => judge_mutants(part),
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
        let widths = DesignChoice::load(design)?.widths;
        let path = package::path(design);
        std::fs::create_dir_all(path.parent().unwrap_or(Path::new(".")))?;
        std::fs::write(&path, package::text(design, &widths))?;
    }
    Ok(())
}

fn cosim(extent: Extent) -> Result<()> {
    println!(
        "| design | lanes | rules | workload | paused | tiles | splats | pixels | mismatches | raster cycles | wrong | covered per cycle and lane |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|");
    let mut lines = Vec::new();
    for design in DESIGNS {
        for (name, rules) in rules() {
            let loads = Loads::new(design, name, &rules, extent)?;
            for lanes in LANES {
                let mut bench = loads.bench(lanes)?;
                for line in loads.check(&mut bench, lanes) {
                    print_line(&line);
                    lines.push(line);
                }
            }
            for missing in &loads.missing {
                println!("(no {missing}: its data is not at hand)");
            }
        }
    }
    summary(&lines)
}

fn print_line(line: &Line) {
    let Line {
        design,
        lanes,
        rules,
        workload,
        paused,
        findings,
    } = line;
    let paused = if *paused { "yes" } else { "" };
    let cycles = if findings.raster_cycles == 0 {
        "| | ".to_owned()
    } else {
        let rate = findings.covered as f64 / findings.raster_cycles as f64 / *lanes as f64;
        format!(
            "{} | {} | {rate:.3}",
            findings.raster_cycles, findings.wrong_cycles
        )
    };
    println!(
        "| {design} | {lanes} | {rules} | {workload} | {paused} | {} | {} | {} | {} | {cycles} |",
        findings.tiles, findings.splats, findings.visited, findings.mismatches
    );
}

fn summary(lines: &[Line]) -> Result<()> {
    let pixels: u64 = lines.iter().map(|line| line.findings.visited).sum();
    let mismatches: u64 = lines.iter().map(|line| line.findings.mismatches).sum();
    let wrong: u64 = lines.iter().map(|line| line.findings.wrong_cycles).sum();
    println!("\n{pixels} pixels, {mismatches} mismatches; {wrong} tiles with wrong cycles");
    let seconds =
        |time: fn(&Line) -> Duration| lines.iter().map(time).sum::<Duration>().as_secs_f64();
    let kernel = seconds(|line| line.findings.kernel_time);
    let circuit = seconds(|line| line.findings.circuit_time);
    let ratio = circuit / kernel;
    println!(
        "kernel and closed form {kernel:.1} s, verilated circuits {circuit:.1} s: {ratio:.1} times as long"
    );
    let difference = lines
        .iter()
        .find_map(|line| line.findings.first_difference.as_ref());
    ensure!(
        difference.is_none(),
        "{}",
        difference.map_or("", |text| text)
    );
    Ok(())
}

/// Judges the mutants whose name contains `part`.
fn judge_mutants(part: &str) -> Result<()> {
    let judge = mutants::Judge::new()?;
    println!("| mistake | unit | noticed as |\n|---|---|---|");
    let mut survivors = 0;
    for mutant in mutants::MUTANTS
        .iter()
        .filter(|mutant| mutant.name.contains(part))
    {
        let verdict = judge.verdict(mutant)?;
        survivors += usize::from(verdict.is_none());
        let noticed = verdict.unwrap_or_else(|| "**not noticed**".to_owned());
        println!("| {} | {} | {noticed} |", mutant.name, mutant.file);
    }
    ensure!(survivors == 0, "{survivors} mutants survive");
    Ok(())
}
