//! `splatline trace`: the raster phase of some splats for a trace viewer.

use super::machine_args::{TraceFormat, TraceOptions};
use super::output::{Outputs, write};
use super::resolve::PlanRequest;
use super::say::{print_result, usage, warn};
use crate::machine::Config;
use crate::machine::lanes::{LaneShape, LaneWork};
use crate::machine::simulate_observed;
use crate::machine::timing::accesses;
use crate::machine::workload::Workload;
use crate::trace::{Recorder, kanata, perfetto, requests, vcd};
use anyhow::{Result, ensure};

/// Splats recorded unless the options say otherwise.
const USUAL_COUNT: u32 = 256;

/// Names that the viewers know the formats by; a name without extension is as good, since --format says what it holds.
fn extensions(format: TraceFormat) -> &'static [&'static str] {
    match format {
        TraceFormat::Kanata => &["kanata", "log", "txt", ""],
        TraceFormat::Vcd => &["vcd", ""],
        TraceFormat::Perfetto => &["json", ""],
        TraceFormat::Ramulator2 | TraceFormat::Dramsim3 => &["trace", "txt", ""],
    }
}

pub fn run(options: &TraceOptions) -> Result<()> {
    let outputs = Outputs::default().file(Some(&options.output), extensions(options.format))?;
    let last = options
        .last
        .unwrap_or(options.first.saturating_add(USUAL_COUNT - 1));
    ensure!(
        last >= options.first,
        usage(format!(
            "--last {last} is smaller than --first {}",
            options.first
        ))
    );
    let request = PlanRequest::work(&options.view, &options.work)
        .on(&options.machine)
        .by_units();
    let prepared = request.prepare()?;
    outputs.spare_inputs()?;
    warn(&prepared.setup_warnings()?);
    let (workload, config) = (prepared.workload()?, &prepared.plan.machine);
    let work = LaneWork::new(&workload, LaneShape::from(config));
    if let TraceFormat::Ramulator2 | TraceFormat::Dramsim3 = options.format {
        return requests_of(options, &workload, &work, config);
    }
    let mut recorder = Recorder::new(options.first, last);
    let timing = simulate_observed(&workload, &work, config, &mut recorder);
    let events = recorder.into_events();
    let bytes = match options.format {
        TraceFormat::Kanata => kanata::log(&events).into_bytes(),
        TraceFormat::Vcd => vcd::dump(&events)?,
        _ => perfetto::trace(&events).into_bytes(),
    };
    write(&options.output, bytes)?;
    let (first, count, path) = (options.first, events.len(), options.output.display());
    print_result(&format!(
        "{path}: splats {first} to {last}, {count} events in {} raster cycles\n",
        timing.raster
    ))
}

/// Everything that the machine's memory part is asked for.
fn requests_of(
    options: &TraceOptions,
    workload: &Workload,
    work: &LaneWork,
    config: &Config,
) -> Result<()> {
    let (Some(part), Some(all)) = (config.memory_part(), accesses(workload, work, config)) else {
        let message = "the machine has two channels and no memory part, so there are no requests to one: choose a part, for example with \
                       --set memory_part=ddr3-1600-x16 --set clock_mhz=100";
        return Err(usage(message));
    };
    let text = match options.format {
        TraceFormat::Ramulator2 => requests::ramulator2(&all),
        _ => requests::dramsim3(&all, part, config.clock_mhz),
    };
    write(&options.output, text)?;
    let (count, path) = (all.len(), options.output.display());
    print_result(&format!("{path}: {count} requests to {}\n", part.name))
}
