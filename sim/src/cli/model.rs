//! `splatline model`: cycles of a scene, or of other people's footprints, on a machine.

use super::compare::create_folder;
use super::engines;
use super::explore::calibration;
use super::machine_args::{MachineOptions, ModelOptions, WorkOptions};
use super::output::{self, write};
use super::progress::Progress;
use super::setup::View;
use super::{Failure, say, warn};
use crate::design::DesignChoice;
use crate::fixed;
use crate::machine::area::{self, synthesis};
use crate::machine::config::{self, Config};
use crate::machine::histogram::Histograms;
use crate::machine::lanes::{LaneShape, LaneWork};
use crate::machine::timing::Timing;
use crate::machine::workload::{TableOptions, Workload, extract_if_room, read_table};
use crate::machine::{simulate, summary};
use anyhow::anyhow;
use serde_json::json;
use splatline::format::Traversal;
use std::path::Path;
use std::time::Instant;

pub fn run(options: &ModelOptions) -> Result<(), Failure> {
    if let Some(folder) = &options.output {
        let files = [&options.machine.machine, &options.footprints];
        let mut inputs = output::files(files.map(Option::as_ref));
        inputs.extend(
            options
                .view
                .as_ref()
                .map(|view| view.inputs())
                .unwrap_or_default(),
        );
        output::check_folder(folder, &["timing.json", "machine.toml"], &inputs)?;
        create_folder(folder)?;
    }
    let config = machine(&options.machine)?;
    let (name, workload) = match (&options.view, &options.footprints) {
        (_, Some(table)) => (
            table.display().to_string(),
            from_table(table, options, &config)?,
        ),
        (Some(view), None) => {
            let view_of = View::from_options(view)?;
            let design = DesignChoice::load(&options.work.design.0)?;
            warn(&engines::warnings(&view_of, &design));
            let progress = Progress::spinner("walking the rows of every tile");
            let workload = from_scene(&view_of, &options.work, &config)?;
            drop(progress);
            (view_of.scene.name, workload)
        }
        (None, None) => {
            return Err(Failure::Usage(
                "name a scene, or a table with --footprints".to_owned(),
            ));
        }
    };
    let work = LaneWork::new(&workload, LaneShape::from(&config));
    let (timing, seconds) = timed(&workload, &work, &config, options.repeat);
    let speed = timing.total as f64 / seconds / 1e6;
    say(&summary::text(&name, &timing))?;
    let area = estimate_area(options, &config)?;
    say(&format!(
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
    }
    Ok(())
}

/// The machine's area, which is also said.
fn estimate_area(options: &ModelOptions, config: &Config) -> Result<serde_json::Value, Failure> {
    let design = DesignChoice::load(&options.work.design.0)?;
    let traversal = options
        .work
        .traversal
        .map_or(design.traversal, Traversal::from);
    let prices = calibration(&options.area)?;
    let area = area::estimate(&design.widths, traversal, config, &prices);
    let statement = synthesis::statement(&prices);
    say(&format!(
        "area: raster units {}; around them {}\n{statement}\n",
        area.raster, area.around
    ))?;
    Ok(
        json!({ "raster": area.raster, "around": area.around, "luts_in_all": area.weight, "of": statement }),
    )
}

/// The machine that the options describe.
pub fn machine(options: &MachineOptions) -> Result<Config, Failure> {
    let mut config = match &options.machine {
        Some(path) => match path.to_str().and_then(Config::named) {
            Some(config) => config,
            None => config::from_file(path)?,
        },
        None => Config::default(),
    };
    config
        .set_words(&options.set)
        .map_err(|error| Failure::Usage(error.to_string()))?;
    Ok(config)
}

/// The work of a scene on a machine's tiles.
pub fn from_scene(view: &View, work: &WorkOptions, config: &Config) -> Result<Workload, Failure> {
    let design = DesignChoice::load(&work.design.0)?;
    let traversal = work.traversal.map_or(design.traversal, Traversal::from);
    let options = fixed::Options {
        rules: &view.rules,
        compositing: work.compositing.into(),
        design: &design,
        traversal,
    };
    Ok(extract_if_room(
        &view.scene,
        &view.camera,
        &options,
        [config.tile_width, config.tile_height],
    )?)
}

fn from_table(path: &Path, options: &ModelOptions, config: &Config) -> Result<Workload, Failure> {
    let shown = path.display();
    let text = output::read_text(path)?;
    let design = DesignChoice::load(&options.work.design.0)?;
    let traversal = options
        .work
        .traversal
        .map_or(design.traversal, Traversal::from);
    if options.screen.is_none() {
        say("screen: up to the largest x1 and y1 of the table; --screen WxH gives another\n")?;
    }
    let size = options
        .screen
        .map_or([0, 0], |size| [size.width as u16, size.height as u16]);
    let layout = splatline::footprint::packet::Layout::new(&design.widths);
    let table = TableOptions {
        viewport: size,
        tile: [config.tile_width, config.tile_height],
        traversal,
        cutoff: options.cutoff,
        packet_bytes: 4 * layout.words() as u32,
    };
    Ok(read_table(&text, &table).map_err(|error| anyhow!("{shown}: {error}"))?)
}

/// The timing and the median of the seconds that simulating it took.
fn timed(workload: &Workload, work: &LaneWork, config: &Config, repeat: u32) -> (Timing, f64) {
    let mut seconds = Vec::new();
    loop {
        let started = Instant::now();
        let timing = simulate(workload, work, config);
        seconds.push(started.elapsed().as_secs_f64());
        if seconds.len() >= repeat as usize {
            seconds.sort_by(f64::total_cmp);
            return (timing, seconds[seconds.len() / 2]);
        }
    }
}
