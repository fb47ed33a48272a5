//! `splatline model`: cycles of a scene, or of other people's footprints, on a machine.

use super::machine_args::ModelOptions;
use super::output::{self, create_folder, write};
use super::resolve::{Asked, calibration, energy_table, machine};
use super::say::{Failure, print_result, warn};
use crate::design::DesignChoice;
use crate::machine::area::{self, synthesis};
use crate::machine::config;
use crate::machine::energy;
use crate::machine::histogram::Histograms;
use crate::machine::lanes::{LaneShape, LaneWork};
use crate::machine::timing::Timing;
use crate::machine::workload::{TableOptions, Workload, read_table};
use crate::machine::{Config, others, simulate, summary};
use crate::metrics::median;
use crate::plan::Entry;
use crate::progress::Progress;
use crate::scene::Scene;
use anyhow::anyhow;
use serde_json::json;
use splatline::format::Traversal;
use std::path::Path;
use std::time::Instant;

/// What is timed, and what it is timed on.
struct Modelled {
    name: String,
    workload: Workload,
    entry: Entry,
    machine: Config,
}

pub fn run(options: &ModelOptions) -> Result<(), Failure> {
    if let Some(folder) = &options.output {
        let files = [&options.machine.machine, &options.footprints];
        let mut inputs = output::files(files.map(Option::as_ref));
        inputs.extend(options.view.inputs());
        output::check_folder(
            folder,
            &[
                "timing.json",
                "machine.toml",
                "action_counts.yaml",
                "machines.json",
            ],
            &inputs,
        )?;
        create_folder(folder)?;
    }
    if options.machines {
        return others_beside_ours(options);
    }
    let Modelled {
        name,
        workload,
        entry,
        machine: config,
    } = match &options.footprints {
        Some(table) => from_table(table, options)?,
        None => from_scene(options)?,
    };
    let work = LaneWork::new(&workload, LaneShape::from(&config));
    let (timing, seconds) = timed(&workload, &work, &config, options.repeat);
    let speed = timing.total as f64 / seconds / 1e6;
    print_result(&summary::text(&name, &timing))?;
    let area = estimate_area(options, &entry, &config)?;
    let energy = energy::estimate(
        &entry.design.widths,
        entry.traversal,
        &config,
        &timing,
        &energy_table(&options.energy)?,
    );
    print_result(&energy.text())?;
    print_result(&format!(
        "host: {:.1} ms for {} cycles: {speed:.0} million simulated cycles per second on one core\n",
        seconds * 1e3,
        timing.total
    ))?;
    if let Some(folder) = &options.output {
        let histograms = Histograms::new(&work, &config, workload.splats.len());
        let result = json!({
            "format": "splatline-timing/1",
            "scene": name,
            "splats": workload.splats.len(),
            "visible": workload.visible(),
            "cycles": timing,
            "area": area,
            "energy": energy,
            "histograms": histograms,
            "host": { "simulation_s": seconds, "cycles_per_s": timing.total as f64 / seconds },
        });
        write(
            &folder.join("timing.json"),
            format!("{result:#}\n").as_bytes(),
        )?;
        write(
            &folder.join("machine.toml"),
            config::to_toml(&config).as_bytes(),
        )?;
        write(
            &folder.join("action_counts.yaml"),
            energy::action_counts(&energy).as_bytes(),
        )?;
    }
    Ok(())
}

/// All machines of the presets on the scene's splats.
fn others_beside_ours(options: &ModelOptions) -> Result<(), Failure> {
    let prepared = Asked::work(&options.view, &options.work)
        .on(&options.machine)
        .prepare()?;
    warn(&prepared.setup_warnings()?);
    let splats = prepared.splats()?;
    let outcomes = others::run_all(&splats, &energy_table(&options.energy)?)?;
    let (table, note) = (others::table_of(&outcomes), others::note());
    print_result(&format!("{table}\n{note}"))?;
    if let Some(folder) = &options.output {
        let line = |outcome: &others::Outcome| {
            json!({
                "machine": outcome.preset.name,
                "source": outcome.preset.source,
                "products": outcome.products,
                "cycles": outcome.timing,
                "energy": outcome.energy,
            })
        };
        let lines: Vec<_> = outcomes.iter().map(line).collect();
        let result = json!({ "format": "splatline-machines/1", "scene": prepared.scene.name(), "machines": lines });
        write(
            &folder.join("machines.json"),
            format!("{result:#}\n").as_bytes(),
        )?;
    }
    Ok(())
}

/// The machine's area, which is also said.
fn estimate_area(
    options: &ModelOptions,
    entry: &Entry,
    config: &Config,
) -> Result<serde_json::Value, Failure> {
    let prices = calibration(&options.area)?;
    let area = area::estimate(&entry.design.widths, entry.traversal, config, &prices);
    let statement = synthesis::statement(&prices);
    print_result(&format!(
        "area: raster units {}; around them {}\n{statement}\n",
        area.raster, area.around
    ))?;
    Ok(
        json!({ "raster": area.raster, "around": area.around, "luts_in_all": area.weight, "of": statement }),
    )
}

fn from_scene(options: &ModelOptions) -> Result<Modelled, Failure> {
    if options.view.scene.is_none() && options.view.from.is_none() {
        let message = "name a scene, a report with --from, or a table with --footprints";
        return Err(Failure::Usage(message.to_owned()));
    }
    let asked = Asked::work(&options.view, &options.work).on(&options.machine);
    let prepared = asked.prepare()?;
    warn(&prepared.setup_warnings()?);
    let progress = Progress::spinner("walking the rows of every tile");
    let workload = prepared.workload()?;
    drop(progress);
    print_result(&uncharged(prepared.splats()?.scene, &prepared.plan.machine))?;
    Ok(Modelled {
        name: prepared.scene.name().to_owned(),
        workload,
        entry: prepared.plan.entry,
        machine: prepared.plan.machine,
    })
}

/// Says what the machine reads nothing for; nothing if there is nothing.
fn uncharged(scene: &Scene, machine: &Config) -> String {
    match &scene.harmonics {
        Some(harmonics) if machine.harmonics_bytes == 0 => {
            let degree = u32::from(harmonics.degree);
            let values = 3 * ((degree + 1) * (degree + 1) - 1);
            format!(
                "harmonics of degree {degree} are not charged: --set harmonics_bytes={} reads {values} numbers of 16 bits for each splat that is seen\n",
                2 * values
            )
        }
        _ => String::new(),
    }
}

fn from_table(path: &Path, options: &ModelOptions) -> Result<Modelled, Failure> {
    let machine = machine(&options.machine)?;
    let name = path.display().to_string();
    let text = output::read_text(path)?;
    let design = DesignChoice::load(&options.work.design.0)?;
    let entry = Entry::new(design, options.work.traversal.map(Traversal::from));
    if options.screen.is_none() {
        print_result(
            "screen: up to the largest x1 and y1 of the table; --screen WxH gives another\n",
        )?;
    }
    let size = options
        .screen
        .map_or([0, 0], |size| [size.width as u16, size.height as u16]);
    let layout = splatline::footprint::packet::Layout::new(&entry.design.widths);
    let table = TableOptions {
        viewport: size,
        tile: [machine.tile_width, machine.tile_height],
        traversal: entry.traversal,
        cutoff: options.cutoff,
        packet_bytes: 4 * layout.words() as u32,
    };
    Ok(Modelled {
        workload: read_table(&text, &table).map_err(|error| anyhow!("{name}: {error}"))?,
        name,
        entry,
        machine,
    })
}

/// The timing and the median of the seconds that simulating it took.
fn timed(workload: &Workload, work: &LaneWork, config: &Config, repeat: u32) -> (Timing, f64) {
    let mut seconds = Vec::new();
    loop {
        let started = Instant::now();
        let timing = simulate(workload, work, config);
        seconds.push(started.elapsed().as_secs_f64());
        if seconds.len() >= repeat as usize {
            return (timing, median(&mut seconds).unwrap_or(0.0));
        }
    }
}
