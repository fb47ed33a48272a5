//! `splatline bake`: a scene for a microcontroller's flash.

use super::output::{Outputs, write, write_json_if};
use super::resolve::PlanRequest;
use super::say::{print_result, usage, warn};
use super::view_args::{PathOptions, ViewOptions};
use crate::bake::{BakedScene, contributions, error, most_visible};
use crate::fixed::QuantisedScene;
use crate::metrics::ChannelError;
use crate::plan::Subject;
use crate::progress::ProgressMeter;
use crate::report::table::psnr_text;
use anyhow::{Result, ensure};
use clap::{Arg, Args};
use std::path::PathBuf;

/// Why a surface is refused.
const GAUSSIANS_ALONE: &str =
    "only scenes of 3D Gaussians are baked; surfaces are drawn by `splatline render`";

/// Volumes and surfaces are not baked.
fn of_gaussians(arg: Arg) -> Arg {
    let is_surfaces = arg.get_help_heading() == Some("Surfaces");
    let others = ["flatten", "depth_image_from", "transfer", "light"];
    let is_other = others.contains(&arg.get_id().as_str());
    arg.hide(is_surfaces || is_other)
}

/// Which scene, seen from where, how much of it, and where it goes.
#[derive(Debug, Args)]
#[command(mut_args(of_gaussians))]
pub struct BakeOptions {
    #[command(flatten)]
    pub view: ViewOptions,
    #[command(flatten)]
    pub path: PathOptions,
    /// Keep the N splats that contribute most to the views [default: all that are visible]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub keep: Option<u32>,
    /// Also write splats, bytes and the error of every view as JSON
    #[arg(long, value_name = "bake.json", help_heading = "Output")]
    pub json: Option<PathBuf>,
    /// Scene to write: .rs or .bin
    #[arg(short, long, value_name = "scene.rs", help_heading = "Output")]
    pub output: PathBuf,
}

pub fn run(options: &BakeOptions) -> Result<()> {
    let outputs = Outputs::default()
        .file(Some(&options.output), &["rs", "bin"])?
        .json(options.json.as_ref())?;
    ensure!(options.view.surface.kind.is_none(), usage(GAUSSIANS_ALONE));
    let request = PlanRequest::by_design(&options.view, "standard24").along(&options.path);
    let frames = request.frames()?;
    outputs.spare_inputs()?;
    let first = &frames[0].prepared;
    warn(&first.warnings);
    let Subject::Splats(splats) = first.subject()? else {
        return Err(usage(GAUSSIANS_ALONE));
    };
    let (scene, rules) = (splats.scene, splats.rules);
    let cameras: Vec<_> = frames
        .iter()
        .map(|frame| frame.prepared.plan.camera.clone())
        .collect();
    let progress = ProgressMeter::spinner(format!("baking {}", scene.name));
    let shares = contributions(scene, &cameras, rules);
    let keep = options.keep.map_or(usize::MAX, |keep| keep as usize);
    let kept = most_visible(&shares, keep);
    let baked = BakedScene::new(scene, &kept, &cameras)?;
    let mut views = Vec::new();
    for (frame, camera) in frames.iter().zip(&cameras) {
        progress.doing(format!("comparing {}", frame.name));
        let colour = error(scene, &baked, camera, rules)?.colour;
        views.push((frame.name.as_str(), colour));
    }
    drop(progress);
    let extension = options.output.extension();
    let is_rust = extension.is_some_and(|end| end.eq_ignore_ascii_case("rs"));
    let bytes = if is_rust {
        let path = cameras.iter().filter(|_| options.path.is_path());
        let path = path.map(|camera| QuantisedScene::new(scene, camera, rules).view);
        let path: Vec<_> = path.collect();
        baked.to_rust(&scene.name, &path).into_bytes()
    } else {
        baked.to_bytes()
    };
    write(&options.output, bytes)?;
    let (all, count) = (scene.splats.len(), kept.len());
    let share = kept.iter().map(|number| shares[*number]).sum::<f64>() / shares.iter().sum::<f64>();
    let colours = || views.iter().map(|(_, colour)| colour);
    let worst = colours().fold(f64::INFINITY, |worst, colour| worst.min(colour.psnr_db));
    let largest = colours().fold(0.0, |most: f64, colour| most.max(colour.max_abs));
    let bias = colours().map(|colour| colour.bias);
    let bias = bias.max_by(|a, b| a.abs().total_cmp(&b.abs()));
    let of_view = |(name, colour): &(&str, ChannelError)| {
        let (psnr, largest, bias) = (colour.psnr_db, colour.max_abs, colour.bias);
        serde_json::json!({ "view": name, "psnr_db": psnr, "max_abs": largest, "bias": bias })
    };
    let report = serde_json::json!({
        "format": "splatline-bake/1", "scene": scene.name, "splats": all, "kept": count, "bytes": 24 * count,
        "share_of_light": share,
        "views": views.iter().map(of_view).collect::<Vec<_>>(),
    });
    write_json_if(options.json.as_ref(), &report)?;
    print_result(&format!(
        "{}: {count} of {all} splats, {} bytes in flash, {:.1} % of the light of {} view(s)\n\
         against the whole scene, worst of the views: PSNR {}, largest error {:.1}/255, bias {:+.2}/255\n{}\n",
        scene.name,
        24 * count,
        100.0 * share,
        views.len(),
        psnr_text(worst),
        255.0 * largest,
        255.0 * bias.unwrap_or(0.0),
        options.output.display()
    ))
}
