//! `splatline model`: cycles of a scene, or of other people's footprints, on a machine.

use super::kept::{self, OrderReuse, ReusedOrderFrame};
use super::machine_args::{AreaOptions, ModelOptions};
use super::output::{self, Outputs, write};
use super::resolve::{
    NamedFrame, PlanRequest, calibration, energy_table, machine, part, refuse_kept_order,
};
use super::say::{Failure, print_result, warn};
use crate::design::DesignChoice;
use crate::machine::area::{self, Calibration, synthesis};
use crate::machine::clock::{Clock, Throughput};
use crate::machine::config;
use crate::machine::energy;
use crate::machine::histogram::Histograms;
use crate::machine::lanes::{LaneShape, LaneWork};
use crate::machine::parts::Part;
use crate::machine::summary::{self, OverFrames};
use crate::machine::timing::Timing;
use crate::machine::workload::{TableOptions, Workload, read_table};
use crate::machine::{Config, others, simulate, simulate_alone};
use crate::metrics::median;
use crate::plan::DesignVariant;
use crate::progress::ProgressMeter;
use crate::report::machine::{page, watch};
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
    entry: DesignVariant,
    machine: Config,
}

/// What a folder of results may hold.
const FILES: [&str; 5] = [
    "timing.json",
    "timing.html",
    "machine.toml",
    "action_counts.yaml",
    "machines.json",
];

/// Frames that are told one by one; of more than these only the summary is.
const FEW_FRAMES: usize = 8;

pub fn run(options: &ModelOptions) -> Result<(), Failure> {
    let mut outputs = Outputs::default();
    if let Some(folder) = &options.output {
        outputs = outputs.folder(folder, &FILES)?;
    }
    if options.machines {
        return others_beside_ours(options, &outputs);
    }
    let priced = Priced::new(&options.area)?;
    if let Some(table) = &options.footprints {
        let modelled = from_table(table, options)?;
        outputs.spare_inputs()?;
        return one(&modelled, &priced, options);
    }
    if options.view.scene.is_none() && options.view.from.is_none() {
        let message = "name a scene, a report with --from, or a table with --footprints";
        return Err(Failure::Usage(message.to_owned()));
    }
    let asked = PlanRequest::work(&options.view, &options.work)
        .on(&options.machine)
        .keeping_order();
    let mut frames = asked.frames(&options.path, &options.more)?;
    outputs.spare_inputs()?;
    if options.path.camera_path.is_none() {
        refuse_kept_order(&frames[0].prepared.plan.machine)?;
    }
    match frames.len() {
        1 => one(&from_scene(&frames.remove(0))?, &priced, options),
        _ => several(&frames, &priced, options),
    }
}

/// All machines of the presets on the scene's splats.
fn others_beside_ours(options: &ModelOptions, outputs: &Outputs) -> Result<(), Failure> {
    let prepared = PlanRequest::work(&options.view, &options.work)
        .on(&options.machine)
        .prepare()?;
    outputs.spare_inputs()?;
    warn(&prepared.setup_warnings()?);
    let splats = prepared.splats()?;
    let outcomes = others::run_all(&splats.without_points(), &energy_table(&options.energy)?)?;
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

/// What area and clock are counted by.
struct Priced {
    prices: Calibration,
    part: Option<(String, Part)>,
}

impl Priced {
    fn new(options: &AreaOptions) -> Result<Priced, Failure> {
        let named = options.part.clone().unwrap_or_default();
        Ok(Priced {
            prices: calibration(options)?,
            part: part(options)?.map(|part| (named, part)),
        })
    }

    fn pace(&self, timing: &Timing, entry: &DesignVariant, config: &Config) -> Throughput {
        let clock = Clock::of(config, &entry.design.widths, self.prices.family);
        Throughput::new(timing, config, clock)
    }
}

/// One picture, with all accounts.
fn one(modelled: &Modelled, priced: &Priced, options: &ModelOptions) -> Result<(), Failure> {
    let Modelled {
        name,
        workload,
        entry,
        machine: config,
    } = modelled;
    let work = LaneWork::new(workload, LaneShape::from(config));
    let (timing, seconds) = timed(workload, &work, config, options.repeat);
    let speed = timing.total as f64 / seconds / 1e6;
    print_result(&summary::text(name, &timing))?;
    let pace = priced.pace(&timing, entry, config);
    print_result(&pace.text())?;
    let area = estimate_area(priced, entry, config, &pace)?;
    let energy = energy::estimate(
        &entry.design.widths,
        entry.traversal,
        config,
        &timing,
        &energy_table(&options.energy)?,
    );
    print_result(&energy.text())?;
    print_result(&format!(
        "host: {:.1} ms for {} cycles: {speed:.0} million simulated cycles per second on one core\n",
        seconds * 1e3,
        timing.total
    ))?;
    let Some(folder) = &options.output else {
        return Ok(());
    };
    let histograms = Histograms::new(&work, config, workload.splats.len());
    let watched = watch(workload, &work, config, &timing);
    let page = page(name, &timing, &watched, workload.columns, config);
    write(&folder.join("timing.html"), page.as_bytes())?;
    write(
        &folder.join("action_counts.yaml"),
        energy::action_counts(&energy).as_bytes(),
    )?;
    let result = json!({
        "format": "splatline-timing/1",
        "scene": name,
        "splats": workload.splats.len(),
        "visible": workload.visible(),
        "cycles": timing,
        "pace": pace,
        "area": area,
        "energy": energy,
        "histograms": histograms,
        "host": { "simulation_s": seconds, "cycles_per_s": timing.total as f64 / seconds },
    });
    write_results(folder, &result, config)
}

/// Several pictures: the worst of them, the 95th percentile and the mean.
fn several(frames: &[NamedFrame], priced: &Priced, options: &ModelOptions) -> Result<(), Failure> {
    let started = Instant::now();
    let progress = ProgressMeter::new(frames.len());
    let mut paces = Vec::with_capacity(frames.len());
    let mut records = Vec::with_capacity(frames.len());
    let mut kept: Vec<ReusedOrderFrame> = Vec::new();
    let mut order = OrderReuse::default();
    for frame in frames {
        progress.doing(&frame.name);
        let plan = &frame.prepared.plan;
        let (workload, of_kept) = match plan.machine.sort_every {
            1 => (from_scene(frame)?.workload, None),
            _ => {
                announce(frame)?;
                order.next(frame)?
            }
        };
        let timing = simulate_alone(&workload, &plan.machine);
        let pace = priced.pace(&timing, &plan.entry, &plan.machine);
        records.push(json!({ "name": frame.name, "visible": workload.visible(), "cycles": timing, "pace": pace, "kept": of_kept }));
        kept.extend(of_kept);
        if plan.machine.sort_every > 1 {
            order.keep(workload);
        }
        paces.push(pace);
        progress.advance();
    }
    drop(progress);
    let plan = &frames[0].prepared.plan;
    let (entry, config) = (&plan.entry, &plan.machine);
    let named: Vec<(&str, &Throughput)> = frames
        .iter()
        .map(|frame| frame.name.as_str())
        .zip(&paces)
        .collect();
    let over = OverFrames::new(&named);
    if frames.len() <= FEW_FRAMES {
        for (name, pace) in &named {
            let (ms, fps) = (pace.ms_per_frame, pace.frames_per_s);
            print_result(&format!("{name}: {ms:.3} ms, {fps:.2} frames a second\n"))?;
        }
    }
    print_result(&over.text())?;
    print_result(&kept::text(&kept, frames.len()))?;
    let clock = &paces[0].clock;
    print_result(&format!("clock: {} MHz ({})\n", clock.mhz, clock.of))?;
    let area = estimate_area(priced, entry, config, &paces[0])?;
    let seconds = started.elapsed().as_secs_f64();
    print_result(&format!(
        "host: {} frames in {seconds:.1} s\n",
        frames.len()
    ))?;
    let Some(folder) = &options.output else {
        return Ok(());
    };
    let result = json!({
        "format": "splatline-timing/1",
        "frames": records,
        "over_frames": over,
        "area": area,
        "host": { "all_s": seconds },
    });
    write_results(folder, &result, config)
}

fn write_results(
    folder: &Path,
    result: &serde_json::Value,
    config: &Config,
) -> Result<(), Failure> {
    write(
        &folder.join("timing.json"),
        format!("{result:#}\n").as_bytes(),
    )?;
    write(
        &folder.join("machine.toml"),
        config::to_toml(config).as_bytes(),
    )
}

/// The machine's area, and how much of the part it takes, which are also said.
fn estimate_area(
    priced: &Priced,
    entry: &DesignVariant,
    config: &Config,
    pace: &Throughput,
) -> Result<serde_json::Value, Failure> {
    let prices = &priced.prices;
    let area = area::estimate(&entry.design.widths, entry.traversal, config, prices);
    let statement = synthesis::statement(prices);
    print_result(&format!(
        "area: raster units {}; around them {}\n{statement}\n",
        area.raster, area.around
    ))?;
    if let Some((name, part)) = &priced.part {
        print_result(&part.text(name, &area, pace.channel_bytes_per_s))?;
    }
    let part = priced.part.as_ref().map(|(_, part)| part);
    Ok(
        json!({ "raster": area.raster, "around": area.around, "luts_in_all": area.weight, "of": statement, "part": part }),
    )
}

/// Says what of a frame the kernel does not take as it is, and what the machine reads nothing for.
fn announce(frame: &NamedFrame) -> Result<(), Failure> {
    let prepared = &frame.prepared;
    warn(&prepared.setup_warnings()?);
    let scene = prepared.splats()?.scene;
    print_result(&uncharged(scene, &prepared.plan.machine))
}

fn from_scene(frame: &NamedFrame) -> Result<Modelled, Failure> {
    let prepared = &frame.prepared;
    announce(frame)?;
    let progress = ProgressMeter::spinner("walking the rows of every tile");
    let workload = prepared.workload()?;
    drop(progress);
    Ok(Modelled {
        name: frame.name.clone(),
        workload,
        entry: prepared.plan.entry.clone(),
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
    refuse_kept_order(&machine)?;
    let name = path.display().to_string();
    let text = output::read_text(path)?;
    let design = DesignChoice::load(&options.work.design.0)?;
    let entry = DesignVariant::new(design, options.work.traversal.map(Traversal::from));
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
