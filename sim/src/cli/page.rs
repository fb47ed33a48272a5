//! `splatline page`: the live page of a scene.

use super::output::{self, Outputs};
use super::resolve::PlanRequest;
use super::say::{print_result, usage, warn};
use super::values::{TraversalChoice, design_name};
use super::view_args::{ViewOptions, of_volumes};
use crate::camera::Camera;
use crate::framing::FramingInput;
use crate::page::{Shown, html};
use crate::plan::{AnyScene, Prepared, Subject};
use crate::scene::Scene;
use anyhow::{Result, ensure};
use clap::Args;
use splatline::format::Traversal;
use std::path::{Path, PathBuf};

/// Largest side of a page's picture: all of it is drawn anew for every change.
const LARGEST_SIDE: usize = 2048;

/// Which scene, how it is seen first, and where the page goes.
#[derive(Debug, Args)]
#[command(mut_args(of_volumes))]
pub struct PageOptions {
    #[command(flatten)]
    pub view: ViewOptions,
    /// First widths: classic8, micro16, lean18, standard24, deep32 or a TOML file
    #[arg(
        long,
        value_name = "NAME|file.toml",
        help_heading = "Drawing",
        default_value = "standard24",
        value_parser = design_name
    )]
    pub design: String,
    /// First traversal: box or spans [default: the design's own]
    #[arg(long, value_enum, help_heading = "Drawing")]
    pub traversal: Option<TraversalChoice>,
    /// Page to write; - is stdout
    #[arg(short, long, value_name = "page.html", help_heading = "Output")]
    pub output: PathBuf,
}

/// Why a surface is refused.
const VOLUME_SPLATS_ALONE: &str =
    "the live page draws volume splats; surfaces are drawn by `splatline render`";

pub fn run(options: &PageOptions) -> Result<()> {
    let outputs = Outputs::default().file(Some(&options.output), &["html", "htm"])?;
    ensure!(
        options.traversal != Some(TraversalChoice::Stamp),
        usage("the live page walks box or spans; stamps are drawn by `splatline render`")
    );
    let surface = &options.view.surface;
    ensure!(
        surface.kind.is_none() || surface.flatten.is_some(),
        usage(VOLUME_SPLATS_ALONE)
    );
    // Before anything is loaded or said; a camera's file has its own size, which is looked at when it is there.
    if let Some(size) = options.view.camera.size {
        check_size(size)?;
    }
    let mut prepared = PlanRequest::by_design(&options.view, &options.design).prepare()?;
    outputs.spare_inputs()?;
    if let Some(traversal) = options.traversal {
        prepared.plan.entry.traversal = Traversal::from(traversal);
    }
    let camera = &prepared.plan.camera;
    check_size([camera.width, camera.height])?;
    warn(&prepared.warnings);
    let bytes = write_page(&prepared, options.view.camera.up, &options.output)?;
    let AnyScene::Splats(scene) = &*prepared.scene else {
        return Ok(());
    };
    print_result(&format!(
        "{}: {} splats, {:.1} MB\n{}\n",
        scene.name,
        scene.splats.len(),
        bytes as f64 / 1e6,
        options.output.display()
    ))
}

fn check_size([width, height]: [usize; 2]) -> Result<()> {
    let message =
        format!("a live page draws at most {LARGEST_SIDE} pixels a side: give a smaller --size");
    ensure!(width.max(height) <= LARGEST_SIDE, usage(message));
    Ok(())
}

/// Writes the page of a view; how many bytes it has.
pub fn write_page(prepared: &Prepared, up: Option<[f64; 3]>, path: &Path) -> Result<usize> {
    let Subject::Splats(splats) = prepared.subject()? else {
        return Err(usage(VOLUME_SPLATS_ALONE));
    };
    ensure!(
        splats.are_composited(),
        usage(
            "the live page composites affine footprints one by one; other techniques are drawn by `splatline render`"
        )
    );
    let frame = FramingInput::of_scene(splats.scene, up);
    let page = html(&Shown {
        scene: splats.scene,
        camera: splats.camera,
        options: splats.options(&prepared.plan.entry),
        target: pivot(splats.camera, &frame, splats.scene),
        up: frame.up,
    })?;
    output::write(path, &page)?;
    Ok(page.len())
}

/// What the camera turns around: the point in the middle of the picture that is as far away as the middle of the scene.
fn pivot(camera: &Camera, frame: &FramingInput, scene: &Scene) -> [f64; 3] {
    let depth = camera.to_camera(frame.ball.centre)[2];
    let depth = if depth > camera.near && !scene.splats.is_empty() {
        depth
    } else {
        frame.ball.radius
    };
    let (eye, forward) = (camera.eye(), camera.rotation[2]);
    [0, 1, 2].map(|axis| eye[axis] + depth * forward[axis])
}
