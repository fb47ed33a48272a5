//! `splatline render`: one picture.

use super::args::RenderOptions;
use super::frames;
use super::maps::write_maps;
use super::output::{Outputs, is_stream, write};
use super::resolve::{COMPARED, DRAWN, PlanRequest, room_for_picture};
use super::say::{Failure, print_error, print_result, warn};
use super::summary::{if_layers_were_merged, if_nothing_is_seen, of_drawing};
use crate::picture::{Depth, EXTENSIONS, Picture, PictureFormat};
use crate::plan::draw::on_threads;
use crate::plan::measure::draw_alone;
use crate::plan::{Engine, Prepared, Technique};
use crate::progress::ProgressMeter;
use std::path::Path;

pub fn run(options: &RenderOptions) -> Result<(), Failure> {
    let drawing = &options.drawing;
    let mut outputs = Outputs::default()
        .file(&options.output, &EXTENSIONS)?
        .json(drawing.json.as_ref())?;
    if is_stream(&options.output) && !options.maps.is_empty() {
        let message = "--maps are written beside the picture: name a file with -o";
        return Err(Failure::Usage(message.to_owned()));
    }
    for map in &options.maps {
        outputs = outputs.file(&map.file(&options.output), &EXTENSIONS)?;
    }
    if drawing.engine != Engine::Fixed && drawing.work.traversal.is_some() {
        let engine = drawing.engine.name();
        return Err(Failure::Usage(format!(
            "--traversal has no meaning for --engine {engine}"
        )));
    }
    if options.path.camera_path.is_some() {
        return frames::render(options);
    }
    let prepared = PlanRequest::drawing(&options.view, drawing).prepare()?;
    outputs.spare_inputs()?;
    check_room(&prepared)?;
    let progress = ProgressMeter::new(1);
    progress.doing(format!("drawing {}", prepared.scene.name()));
    let (measured, report) = draw_alone(&prepared, &drawing.effort(), &progress)?;
    let picture = &measured.drawing.picture;
    write_picture(options, picture, &options.output)?;
    if let Some(path) = &drawing.json {
        write(path, report.to_json()?.as_bytes())?;
    }
    if !options.maps.is_empty() {
        progress.doing("maps");
        on_threads(drawing.effort().threads, || {
            write_maps(&prepared, &options.maps, &options.output)
        })??;
    }
    drop(progress);
    warn(&report.warnings);
    print_error(&if_layers_were_merged(measured.drawing.merged));
    print_error(&if_nothing_is_seen(
        picture,
        &report,
        steps(&options.output, drawing.depth),
        drawing.backdrop(),
    ));
    print_result(&of_drawing(&report))
}

/// Steps of a channel in the file; none if it holds numbers.
fn steps(path: &Path, depth: Depth) -> Option<f64> {
    match PictureFormat::of(path) {
        Some(PictureFormat::Npy | PictureFormat::Exr) => None,
        _ => Some(depth.steps()),
    }
}

/// Writes a picture in the format that its name says.
pub fn write_picture(
    options: &RenderOptions,
    picture: &Picture,
    path: &Path,
) -> Result<(), Failure> {
    let drawing = &options.drawing;
    let format = PictureFormat::of(path).unwrap_or(PictureFormat::Png);
    let bytes = picture.encode(format, drawing.depth, drawing.backdrop())?;
    write(path, &bytes)
}

/// Refuses a picture that does not fit into memory.
pub fn check_room(prepared: &Prepared) -> Result<(), Failure> {
    let bytes = match (&prepared.plan.technique, prepared.plan.engine) {
        // The reference of surfaces keeps every fragment.
        (Technique::Surface(_), Engine::Float) => COMPARED,
        _ => DRAWN,
    };
    room_for_picture(&prepared.plan.camera, bytes)
}
