//! `splatline optimize`: the cheapest design and machine that hold them.

use super::output::{Outputs, settings, write, write_json};
use super::resolve::{NamedFrame, prices};
use super::say::print_result;
use super::search_args::{OptimizeOptions, draw_references, limits_given};
use crate::explore::answer::{self, Answer, usual_space};
use crate::explore::answer_page;
use crate::explore::detail::detail;
use crate::explore::evaluator::Evaluator;
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
    let shown = title(&frames);
    let mut subject = search.subject(frames)?;
    subject.formats.clone_from(formats);
    let space = match &options.space {
        Some(file) => settings(file, Space::without_points)?,
        None => usual_space(&subject.design, &subject.machine, errors)?,
    };
    outputs.spare_inputs()?;
    let progress = ProgressMeter::spinner("searching");
    let doing = |what: &str| progress.doing(what);
    let mut evaluator = Evaluator::within(subject, &limits);
    let answer = match answer::refusal(&evaluator, &limits, &space, &doing)? {
        Some(refusal) => refusal,
        None => {
            if measured {
                draw_references(&mut evaluator.subject)?;
            }
            answer::optimize(&mut evaluator, &limits, &space, &doing)?
        }
    };
    drop(progress);
    let subject = &evaluator.subject;
    let note = synthesis::statement_of(&subject.calibration, &subject.machine);
    let clock = answer.found.first().map(|found| &found.reached.pace.clock);
    let of = clock.map_or(String::new(), |clock| {
        format!("  {} MHz: {}\n", clock.mhz, clock.of)
    });
    let (seconds, text) = (started.elapsed().as_secs_f64(), answer.text());
    print_result(&format!("{shown}: {seconds:.1} s\n{text}{of}  {note}\n"))?;
    if let Some(folder) = &options.output {
        let progress = ProgressMeter::spinner("simulating what a change of each setting would do");
        let detail = detail(&evaluator, &limits, &space, &answer)?;
        drop(progress);
        let page = answer_page::page(&shown, &answer, detail.as_ref(), &note);
        write_answer(&answer, &note, folder, &page)?;
    }
    ensure!(answer.holds, "no point holds all limits");
    Ok(())
}

/// The frames by their names and their size.
fn title(frames: &[NamedFrame]) -> String {
    let names = frames.iter().map(|frame| frame.name.as_str()).take(3);
    let names = names.collect::<Vec<_>>().join(", ");
    let more = if frames.len() > 3 { ", ..." } else { "" };
    let camera = &frames[0].prepared.plan.camera;
    format!("{names}{more} at {}x{}", camera.width, camera.height)
}

/// The options' limits and the part's.
fn limits(options: &OptimizeOptions) -> Result<Vec<Limit>> {
    let asked = &options.limits;
    let [lut, dsp, bram] = [asked.lut, asked.dsp, asked.bram].map(|most| most.map(f64::from));
    let (bandwidth, energy) = (asked.bandwidth.map(|most| most * 1e6), asked.max_energy);
    let rate = [(Quantity::FramesPerSecond, asked.fps, "--fps")].into_iter();
    let errors = asked.errors.asked(Quantity::LargestError);
    let mut limits = limits_given(rate.chain(errors).chain([
        (Quantity::Luts, lut, "--lut"),
        (Quantity::Dsps, dsp, "--dsp"),
        (Quantity::MemoryKbit, bram, "--bram"),
        (Quantity::BytesPerSecond, bandwidth, "--bandwidth"),
        (Quantity::MillijoulesPerFrame, energy, "--max-energy"),
    ]));
    if let Some((name, part)) = prices(&options.search)?.part {
        let mut of_part = limits_of_part(&name, &part);
        // Who names a bandwidth has another memory on the board.
        of_part.retain(|limit| bandwidth.is_none() || limit.quantity != Quantity::BytesPerSecond);
        limits.extend(of_part);
    }
    Ok(tightest(limits))
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
