//! `splatline optimize`: the cheapest design and machine that hold them.

use super::output::{Outputs, settings, write, write_json};
use super::resolve::{NamedFrame, part};
use super::say::print_result;
use super::search_args::{LimitOptions, OptimizeOptions, draw_references, limits_given};
use crate::explore::answer::{self, Answer, usual_space};
use crate::explore::answer_page;
use crate::explore::detail::detail;
use crate::explore::limits::{Limit, Quantity, limits_of_part, tightest};
use crate::explore::space::Space;
use crate::machine::area::synthesis;
use crate::machine::config;
use crate::progress::ProgressMeter;
use anyhow::{Result, ensure};
use serde_json::json;
use std::path::Path;
use std::time::Instant;

/// What an answer writes into its folder.
const FILES: [&str; 4] = ["answer.json", "design.toml", "machine.toml", "answer.html"];

/// The limits of the options themselves.
fn own_limits(options: &LimitOptions) -> Vec<Limit> {
    let bandwidth = options.bandwidth.map(|megabytes| megabytes * 1e6);
    let [lut, dsp, bram] = [options.lut, options.dsp, options.bram].map(|most| most.map(f64::from));
    let energy = options.max_energy;
    let rate = limits_given(&[(Quantity::FramesPerSecond, options.fps, "--fps")]);
    let errors = options.errors.given(Quantity::LargestError);
    let machine = limits_given(&[
        (Quantity::Luts, lut, "--lut"),
        (Quantity::Dsps, dsp, "--dsp"),
        (Quantity::MemoryKbit, bram, "--bram"),
        (Quantity::BytesPerSecond, bandwidth, "--bandwidth"),
        (Quantity::MillijoulesPerFrame, energy, "--max-energy"),
    ]);
    [rate, errors, machine].concat()
}

pub fn run(options: &OptimizeOptions) -> Result<()> {
    let search = &options.search;
    let outputs = Outputs::default().folder(options.output.as_deref(), &FILES)?;
    let started = Instant::now();
    let limits = limits(options)?;
    let frames = search.request().frames()?;
    let errors = limits.iter().any(|limit| limit.quantity.is_error());
    // Without a limit on errors the error of one picture is reported, those of many are not worth their memory.
    let formats = &options.formats.formats;
    let measured = errors || frames.len() == 1 || !formats.is_empty();
    let mut subject = search.subject(&frames, false)?;
    subject.formats.clone_from(formats);
    let space = match &options.space {
        Some(file) => settings(file, Space::without_points)?,
        None => usual_space(&subject.design, &subject.machine, errors)?,
    };
    outputs.spare_inputs()?;
    let progress = ProgressMeter::spinner("searching");
    let doing = |what: &str| progress.doing(what);
    let answer = match answer::refusal(&subject, &limits, &space, &doing)? {
        Some(refusal) => refusal,
        None => {
            draw_references(&mut subject, &frames, measured)?;
            answer::optimize(&subject, &limits, &space, &doing)?
        }
    };
    drop(progress);
    let shown = title(&frames);
    print_result(&format!(
        "{shown}: {:.1} s\n",
        started.elapsed().as_secs_f64()
    ))?;
    print_result(&answer.text())?;
    let note = synthesis::statement_of(&subject.calibration, &subject.machine);
    let clock = answer.found.first().map(|found| &found.reached.pace.clock);
    let of = clock.map_or(String::new(), |clock| {
        format!("  {} MHz: {}\n", clock.mhz, clock.of)
    });
    print_result(&format!("{of}  {note}\n"))?;
    if let Some(folder) = &options.output {
        let progress = ProgressMeter::spinner("simulating what a change of each setting would do");
        let detail = detail(&subject, &limits, &space, &answer)?;
        drop(progress);
        let page = answer_page::page(&shown, &answer, detail.as_ref(), &note);
        write_answer(&answer, &note, folder, &page)?;
    }
    ensure!(answer.holds, "no point holds all limits");
    Ok(())
}

/// The frames by their names and their size.
fn title(frames: &[NamedFrame]) -> String {
    let names: Vec<&str> = frames
        .iter()
        .map(|frame| frame.name.as_str())
        .take(3)
        .collect();
    let more = if frames.len() > 3 { ", ..." } else { "" };
    let camera = &frames[0].prepared.plan.camera;
    format!(
        "{}{more} at {}x{}",
        names.join(", "),
        camera.width,
        camera.height
    )
}

/// The options' limits and the part's.
fn limits(options: &OptimizeOptions) -> Result<Vec<Limit>> {
    let own = own_limits(&options.limits);
    let named = options.search.area.part.clone().unwrap_or_default();
    let of_part = part(&options.search.area)?.map(|part| limits_of_part(&named, &part));
    let mut of_part = of_part.unwrap_or_default();
    // Who names a bandwidth has another memory on the board.
    if options.limits.bandwidth.is_some() {
        of_part.retain(|limit| limit.quantity != Quantity::BytesPerSecond);
    }
    Ok(tightest([own, of_part].concat()))
}

fn write_answer(answer: &Answer, note: &str, folder: &Path, page: &str) -> Result<()> {
    write(&folder.join(FILES[3]), page)?;
    let result = json!({ "format": "splatline-answer/1", "answer": answer, "area_of": note });
    write_json(&folder.join(FILES[0]), &result)?;
    let Some(first) = answer.found.first() else {
        return Ok(());
    };
    write(&folder.join(FILES[1]), first.design.to_toml())?;
    write(&folder.join(FILES[2]), config::to_toml(&first.machine))
}
