//! `splatline render`: one picture.

use super::args::RenderOptions;
use super::frames;
use super::maps::{self, write_maps};
use super::output::{Outputs, is_stream, write, write_json_if};
use super::resolve::{COMPARED, DRAWN, PlanRequest, pose_of, room_for_picture};
use super::say::{print_error, print_result, usage, warn};
use super::summary::{if_layers_were_merged, if_nothing_is_seen, of_drawing};
use crate::camera::Camera;
use crate::cameras::lens::Lens;
use crate::picture::{Depth, EXTENSIONS, Picture, PictureFormat};
use crate::plan::draw::on_threads;
use crate::plan::measure::{draw_alone, draw_last};
use crate::plan::{Engine, Prepared, Technique};
use crate::progress::ProgressMeter;
use crate::texture::image::distorted;
use anyhow::{Context, Result, ensure};
use std::path::Path;

pub fn run(options: &RenderOptions) -> Result<()> {
    let drawing = &options.drawing;
    let mut outputs = Outputs::default()
        .file(Some(&options.output), &EXTENSIONS)?
        .json(drawing.json.as_ref())?;
    ensure!(
        options.maps.is_empty() || !is_stream(&options.output),
        usage("--maps are written beside the picture: name a file with -o")
    );
    for map in &options.maps {
        outputs = outputs.file(Some(&map.file(&options.output)), &EXTENSIONS)?;
    }
    let engine = drawing.engine.name();
    ensure!(
        drawing.engine == Engine::Fixed || drawing.work.traversal.is_none(),
        usage(format!("--traversal has no meaning for --engine {engine}"))
    );
    if options.path.is_path() {
        return frames::render(options);
    }
    let mut prepared = PlanRequest::drawing(&options.view, drawing).prepare()?;
    outputs.spare_inputs()?;
    if !options.maps.is_empty() {
        maps::check(&prepared)?;
    }
    let lens = if options.distort {
        let (lens, pinhole) = behind_lens(options, &prepared)?;
        prepared = prepared.seen_by(pinhole);
        Some(lens)
    } else {
        None
    };
    check_room(&prepared)?;
    // The second step is writing, which of large pictures takes as long.
    let progress = ProgressMeter::new(2);
    progress.doing(format!("drawing {}", prepared.scene.name()));
    let effort = drawing.effort_of_pictures();
    let (measured, report) = if options.maps.is_empty() {
        draw_last(&mut prepared, &effort, &progress)?
    } else {
        draw_alone(&prepared, None, &effort, &progress)?
    };
    progress.advance();
    progress.doing(format!("writing {}", options.output.display()));
    let bent = lens.map(|lens| distorted(&measured.picture, &prepared.plan.camera, &lens));
    let picture = bent.as_ref().unwrap_or(&measured.picture);
    write_picture(options, picture, &options.output)?;
    write_json_if(drawing.json.as_ref(), &report)?;
    if !options.maps.is_empty() {
        progress.doing("maps");
        on_threads(drawing.effort().threads, || {
            write_maps(&prepared, &options.maps, &options.output)
        })??;
    }
    progress.advance();
    drop(progress);
    warn(&report.warnings);
    print_error(&if_layers_were_merged(measured.merged));
    print_error(&if_nothing_is_seen(
        picture,
        &report,
        steps(&options.output, drawing.depth),
        drawing.backdrop(),
    ));
    print_result(&of_drawing(&report))
}

/// The lens of the camera's file in the size of the picture, and the pinhole that sees as much.
fn behind_lens(options: &RenderOptions, prepared: &Prepared) -> Result<(Lens, Camera)> {
    let (file, image) = (&options.view.camera.file, &options.view.camera.image);
    let file = file.as_deref().context("--distort needs --camera")?;
    let pose = pose_of(file, None, image.as_deref())?;
    let camera = &prepared.plan.camera;
    let lens = pose
        .lens
        .context("--distort: the file of --camera knows no lens")?
        .resized([camera.width, camera.height]);
    let pinhole = lens
        .pinhole(camera)
        .context("--distort: this lens sees more than a pinhole can")?;
    Ok((lens, pinhole))
}

/// Steps of a channel in the file; none if it holds numbers.
fn steps(path: &Path, depth: Depth) -> Option<f64> {
    match PictureFormat::of(path) {
        Some(PictureFormat::Npy | PictureFormat::Exr) => None,
        _ => Some(depth.steps()),
    }
}

/// Writes a picture in the format that its name says.
pub fn write_picture(options: &RenderOptions, picture: &Picture, path: &Path) -> Result<()> {
    let drawing = &options.drawing;
    let format = PictureFormat::of(path).unwrap_or(PictureFormat::Png);
    let bytes = picture.encode(format, drawing.depth, drawing.backdrop())?;
    write(path, bytes)
}

/// Refuses a picture that does not fit into memory.
pub fn check_room(prepared: &Prepared) -> Result<()> {
    let bytes = match (&prepared.plan.technique, prepared.plan.engine) {
        // The reference of surfaces keeps every fragment.
        (Technique::Surface(_), Engine::Float) => COMPARED,
        _ => DRAWN,
    };
    room_for_picture(&prepared.plan.camera, bytes)
}
