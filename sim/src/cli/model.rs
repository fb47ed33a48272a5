//! `splatline simulate`: cycles of a scene, or of other people's footprints, on a machine.
//!
//! ```text
//! options -> plan -> work of a picture -> simulation -> record -> page and files
//! ```

use super::machine_args::ModelOptions;
use super::order_reuse::{self, OrderReuse, ReusedOrderFrame};
use super::output::{self, Outputs, write, write_json};
use super::resolve::{NamedFrame, PlannedFrame, energy_table, machine, prices, refuse_kept_order};
use super::say::{print_result, usage, warn};
use crate::design::DesignChoice;
use crate::machine::clock::Throughput;
use crate::machine::lanes::{LaneShape, LaneWork};
use crate::machine::record::{AreaRecord, CostedMachine, Prices};
use crate::machine::summary::OverFrames;
use crate::machine::timing::Timing;
use crate::machine::workload::{TableOptions, Workload, read_table};
use crate::machine::{Config, config, energy, others, simulate_alone};
use crate::plan::{DesignVariant, Subject};
use crate::progress::ProgressMeter;
use crate::report::machine::{page, watch};
use anyhow::{Result, anyhow, ensure};
use serde::Serialize;
use splatline::format::Traversal;
use std::path::Path;
use std::time::Instant;

/// The files that may be written.
const FILES: [&str; 5] = [
    "timing.json",
    "timing.html",
    "machine.toml",
    "action_counts.yaml",
    "machines.json",
];

/// Format of timing.json.
const TIMING: &str = "splatline-timing/1";

/// Frames that are printed one by one; of more than these only the summary is.
const FEW_FRAMES: usize = 8;

/// A result with its format's name.
#[derive(Serialize)]
struct Versioned<T> {
    format: &'static str,
    #[serde(flatten)]
    result: T,
}

/// One of several pictures.
#[derive(Serialize)]
struct FrameRecord {
    name: String,
    visible: usize,
    cycles: Timing,
    pace: Throughput,
    #[serde(rename = "kept")]
    order_reuse: Option<ReusedOrderFrame>,
}

/// Several pictures.
#[derive(Serialize)]
struct FramesRecord {
    frames: Vec<FrameRecord>,
    over_frames: OverFrames,
    area: AreaRecord,
    host: AllSeconds,
}

#[derive(Serialize)]
struct AllSeconds {
    all_s: f64,
}

/// Machines of others on a scene.
#[derive(Serialize)]
struct MachinesRecord {
    scene: String,
    machines: Vec<others::Outcome>,
}

pub fn run(options: &ModelOptions) -> Result<()> {
    let outputs = Outputs::default().folder(options.output.as_deref(), &FILES)?;
    if options.machines {
        return others_beside_ours(options, &outputs);
    }
    let simulation = &options.simulation;
    let prices = prices(simulation)?;
    if let Some(table) = &options.footprints {
        let (workload, variant, config) = from_table(table, options)?;
        outputs.spare_inputs()?;
        let costed = costed(&variant, &config, &prices);
        return one(&table.display().to_string(), &workload, &costed, options);
    }
    let view = &simulation.frames.view;
    ensure!(
        view.scene.is_some() || view.from.is_some(),
        usage("name a scene, a report with --from, or a table with --footprints")
    );
    let request = simulation.request().keeping_order();
    let mut frames = request.planned_frames()?;
    outputs.spare_inputs()?;
    if !simulation.frames.path.is_path() {
        refuse_kept_order(&frames[0].plan().machine)?;
    }
    match frames.len() {
        1 => {
            let frame = frames.remove(0).prepare();
            announce(&frame)?;
            let progress = ProgressMeter::spinner("walking the rows of every tile");
            let workload = frame.prepared.workload()?;
            drop(progress);
            let plan = &frame.prepared.plan;
            let costed = costed(&plan.entry, &plan.machine, &prices);
            one(&frame.name, &workload, &costed, options)
        }
        _ => several(frames, &prices, options),
    }
}

/// All machines of the presets on the scene's splats.
fn others_beside_ours(options: &ModelOptions, outputs: &Outputs) -> Result<()> {
    let prepared = options.simulation.request().prepare()?;
    outputs.spare_inputs()?;
    warn(&prepared.setup_warnings()?);
    let splats = prepared.splats()?;
    let drawn = splats.options(&prepared.plan.entry);
    let energy = energy_table(options.simulation.energy.as_ref())?;
    let machines = others::run_all(splats.scene, splats.camera, &drawn, &energy)?;
    let (table, note) = (others::table_of(&machines), others::note());
    print_result(&format!("{table}\n{note}"))?;
    let Some(folder) = &options.output else {
        return Ok(());
    };
    let scene = prepared.scene.name().to_owned();
    let result = MachinesRecord { scene, machines };
    let format = "splatline-machines/1";
    write_json(&folder.join("machines.json"), &Versioned { format, result })
}

fn costed<'a>(
    variant: &'a DesignVariant,
    config: &'a Config,
    prices: &'a Prices,
) -> CostedMachine<'a> {
    CostedMachine {
        widths: &variant.design.widths,
        traversal: variant.traversal,
        config,
        prices,
    }
}

/// One picture, with all accounts.
fn one(
    name: &str,
    workload: &Workload,
    costed: &CostedMachine,
    options: &ModelOptions,
) -> Result<()> {
    let config = costed.config;
    let record = costed.picture(name, workload);
    print_result(&costed.text(&record))?;
    let Some(folder) = &options.output else {
        return Ok(());
    };
    let work = LaneWork::new(workload, LaneShape::from(config));
    let watched = watch(workload, &work, config, &record.cycles);
    let page = page(&record.scene, &record.cycles, &watched, config);
    write(&folder.join("timing.html"), page)?;
    write(
        &folder.join("action_counts.yaml"),
        energy::action_counts(&record.energy),
    )?;
    write_machine(folder, config)?;
    write_timing(folder, record)
}

fn write_timing(folder: &Path, result: impl Serialize) -> Result<()> {
    let format = TIMING;
    write_json(&folder.join("timing.json"), &Versioned { format, result })
}

fn write_machine(folder: &Path, config: &Config) -> Result<()> {
    write(&folder.join("machine.toml"), config::to_toml(config))
}

/// Several pictures: the worst of them, the 95th percentile and the mean.
fn several(frames: Vec<PlannedFrame>, prices: &Prices, options: &ModelOptions) -> Result<()> {
    let started = Instant::now();
    let (count, plan) = (frames.len(), frames[0].plan().clone());
    let records = simulated(frames, prices)?;
    let costed = costed(&plan.entry, &plan.machine, prices);
    let named: Vec<(&str, &Throughput)> = records
        .iter()
        .map(|record| (record.name.as_str(), &record.pace))
        .collect();
    let over_frames = OverFrames::new(&named);
    if count <= FEW_FRAMES {
        for (name, pace) in &named {
            let (ms, fps) = (pace.ms_per_frame, pace.frames_per_s);
            print_result(&format!("{name}: {ms:.3} ms, {fps:.2} frames a second\n"))?;
        }
    }
    let reused: Vec<&ReusedOrderFrame> = records
        .iter()
        .flat_map(|record| &record.order_reuse)
        .collect();
    let (pace, area) = (&records[0].pace, costed.area());
    let all_s = started.elapsed().as_secs_f64();
    print_result(&format!(
        "{}{}clock: {} MHz ({})\n{}host: {count} frames in {all_s:.1} s\n",
        over_frames.text(),
        order_reuse::text(&reused, count),
        pace.clock.mhz,
        pace.clock.of,
        costed.area_text(&area, pace.channel_bytes_per_s),
    ))?;
    let Some(folder) = &options.output else {
        return Ok(());
    };
    write_machine(folder, &plan.machine)?;
    let record = FramesRecord {
        frames: records,
        over_frames,
        area,
        host: AllSeconds { all_s },
    };
    write_timing(folder, record)
}

/// All pictures one after the other, since one may keep the order of the one before.
fn simulated(frames: Vec<PlannedFrame>, prices: &Prices) -> Result<Vec<FrameRecord>> {
    let progress = ProgressMeter::new(frames.len());
    let mut order = OrderReuse::default();
    let mut records = Vec::with_capacity(frames.len());
    for frame in frames {
        let frame = frame.prepare();
        progress.doing(&frame.name);
        announce(&frame)?;
        let plan = &frame.prepared.plan;
        let keeps_order = plan.machine.sort_every > 1;
        let (workload, order_reuse) = if keeps_order {
            order.next(&frame)?
        } else {
            (frame.prepared.workload()?, None)
        };
        let cycles = simulate_alone(&workload, &plan.machine);
        records.push(FrameRecord {
            name: frame.name,
            visible: workload.visible(),
            pace: costed(&plan.entry, &plan.machine, prices).throughput(&cycles),
            cycles,
            order_reuse,
        });
        if keeps_order {
            order.keep(workload);
        }
        progress.advance();
    }
    Ok(records)
}

/// Says what of a frame the kernel does not take as it is, and what the machine reads for its harmonics.
fn announce(frame: &NamedFrame) -> Result<()> {
    let prepared = &frame.prepared;
    warn(&prepared.setup_warnings()?);
    if let Subject::Splats(splats) = prepared.subject()?
        && let Some(harmonics) = &splats.scene.harmonics
    {
        let (degree, bytes) = (harmonics.degree, prepared.plan.machine.harmonics_bytes);
        print_result(&format!(
            "harmonics of degree {degree}: {bytes} bytes are read for each splat that is seen (harmonics_bytes)\n"
        ))?;
    }
    Ok(())
}

/// Work of a table, and the design and the machine that it is timed on.
fn from_table(path: &Path, options: &ModelOptions) -> Result<(Workload, DesignVariant, Config)> {
    let work = &options.simulation.frames.work;
    let machine = machine(&options.simulation.machine)?;
    refuse_kept_order(&machine)?;
    let text = output::read_text(path)?;
    let design = DesignChoice::load(&work.design)?;
    let entry = DesignVariant::new(design, work.traversal.map(Traversal::from));
    if options.screen.is_none() {
        print_result(
            "screen: up to the largest x1 and y1 of the table; --screen WxH gives another\n",
        )?;
    }
    let size = options.screen.unwrap_or_default();
    let layout = splatline::footprint::packet::Layout::new(&entry.design.widths, entry.traversal);
    let table = TableOptions {
        viewport: size.map(|side| side as u16),
        tile: [machine.tile_width, machine.tile_height],
        traversal: entry.traversal,
        cutoff: options.cutoff,
        packet_bytes: 4 * layout.words() as u32,
    };
    let workload =
        read_table(&text, &table).map_err(|error| anyhow!("{}: {error}", path.display()))?;
    Ok((workload, entry, machine))
}
