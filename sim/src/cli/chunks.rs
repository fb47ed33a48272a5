//! `splatline render --chunks`: a picture of a scene that is larger than memory.

use super::args::RenderOptions;
use super::output::Outputs;
use super::render::write_picture;
use super::resolve::{Chunked, DRAWN, PlanRequest, room_for_picture, scene_of};
use super::say::{Failure, print_result, warn};
use crate::fixed::chunks::{BYTES, ChunkDrawing, draw_in_chunks};
use crate::fixed::{Options, PaintEngine, best_engine};
use crate::memory;
use crate::progress::ProgressMeter;
use crate::scene::GaussianFile;
use crate::threads;
use std::time::Instant;

/// Draws the picture with so many footprints at a time in memory.
pub fn render(options: &RenderOptions, outputs: &Outputs, size: usize) -> Result<(), Failure> {
    let drawing = &options.drawing;
    let file = GaussianFile::open(scene_of(&options.view)?)?;
    let asked = PlanRequest::drawing(&options.view, drawing).in_chunks(&file)?;
    outputs.spare_inputs()?;
    room_for_picture(&asked.camera, DRAWN)?;
    let footprints = (size as u64).min(file.count());
    let what = format!("a chunk of {footprints} footprints");
    memory::room_for(footprints * BYTES, &what, "give --chunks a smaller number")?;
    let started = Instant::now();
    let drawn = draw(options, &file, &asked, size)?;
    write_picture(options, &drawn.picture, &options.output)?;
    warn(&asked.warnings);
    print_result(&summary(&file, &drawn, started.elapsed().as_secs_f64()))
}

fn draw(
    options: &RenderOptions,
    file: &GaussianFile,
    asked: &Chunked,
    size: usize,
) -> Result<ChunkDrawing, Failure> {
    let progress = ProgressMeter::spinner(format!("reading {}", file.name()));
    let doing = |chunk: usize| progress.doing(format!("drawing {}, chunk {chunk}", file.name()));
    let effort = options.drawing.effort();
    let engine = effort.vectors.map_or(best_engine(), PaintEngine::Vectors);
    let how = Options {
        rules: &asked.rules,
        compositing: asked.compositing,
        design: &asked.entry.design,
        traversal: asked.entry.traversal,
    };
    let pool = threads::pool(effort.threads)?;
    let draw = || draw_in_chunks(file, &asked.camera, &how, engine, size, &doing);
    Ok(pool.install(draw)?)
}

/// What was drawn, and what was not.
fn summary(file: &GaussianFile, drawn: &ChunkDrawing, seconds: f64) -> String {
    let ChunkDrawing {
        splats,
        painted,
        chunks,
        culled,
        skipped,
        clamped,
        ..
    } = drawn;
    let culled: usize = culled.iter().sum();
    let left_out = skipped.non_finite + skipped.zero_rotation;
    format!(
        "{}: {splats} splats, {culled} culled, {left_out} records left out, {clamped} clamped\n{painted} footprints in {chunks} chunks, {seconds:.1} s with reading\n",
        file.name(),
    )
}
