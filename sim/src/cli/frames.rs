//! `--camera-path` of `render` and `compare`: a picture a frame, and one report over all.

use super::args::{CompareOptions, RenderOptions};
use super::compare::against_reference;
use super::output::{self, Outputs, create_folder, write, write_json, write_json_if};
use super::render::{check_room, write_picture};
use super::resolve::{NamedFrame, PlanRequest, PlannedFrame};
use super::say::{print_result, usage, warn};
use crate::machine::summary::Spread;
use crate::picture::EXTENSIONS;
use crate::picture::png::animated;
use crate::plan::compare_all;
use crate::plan::measure::draw_alone;
use crate::progress::ProgressMeter;
use crate::report::frames::{DrawnFrame, DrawnFrames, FORMAT, FrameRow, FramesReport, page};
use anyhow::{Result, ensure};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// A picture a frame, numbered behind the output's name.
pub fn render(options: &RenderOptions) -> Result<()> {
    ensure!(
        !output::is_stream(&options.output),
        usage(
            "--camera-path draws many pictures, and stdout takes one: name a file with -o, frames are numbered behind its name"
        )
    );
    let drawing = &options.drawing;
    let frames = PlanRequest::drawing(&options.view, drawing)
        .along(&options.path)
        .planned_frames()?;
    let count = frames.len();
    let files = files(&options.output, &frames);
    let [first, last] = [files.first(), files.last()].map(|file| file.cloned().unwrap_or_default());
    let outputs = Outputs::default()
        .json(drawing.json.as_ref())?
        .file(options.animation.as_deref(), &["png", "apng"])?;
    let extensions = if options.animation.is_some() {
        &EXTENSIONS[..1]
    } else {
        &EXTENSIONS[..]
    };
    outputs
        .files(files.iter().cloned(), extensions)?
        .spare_inputs()?;
    let (progress, mut warnings) = (ProgressMeter::new(count), BTreeSet::new());
    let (mut rows, mut seconds) = (Vec::new(), Vec::new());
    for (file, frame) in files.iter().zip(frames) {
        let NamedFrame { name, prepared } = frame.prepare();
        check_room(&prepared)?;
        progress.doing(&name);
        let effort = drawing.effort_of_pictures();
        let (measured, report) = draw_alone(&prepared, None, &effort, &progress)?;
        write_picture(options, &measured.picture, file)?;
        seconds.push(report.host.total_s);
        warnings.extend(report.warnings.iter().cloned());
        if drawing.json.is_some() {
            let file = file.clone();
            rows.push(DrawnFrame { name, file, report });
        }
        progress.advance();
    }
    if let Some(animation) = &options.animation {
        progress.doing("writing the animation");
        write(animation, animated(&files, FRAMES_PER_SECOND)?)?;
    }
    drop(progress);
    let spread = Spread::of(seconds);
    let all = DrawnFrames {
        format: FORMAT,
        frames: rows,
        total_s: spread,
    };
    write_json_if(drawing.json.as_ref(), &all)?;
    warn(&warnings.into_iter().collect::<Vec<_>>());
    print_result(&format!(
        "{count} frames, {} to {}: worst {:.1} ms, 95 % {:.1} ms, mean {:.1} ms\n",
        first.display(),
        last.display(),
        spread.worst * 1e3,
        spread.percentile_95 * 1e3,
        spread.mean * 1e3
    ))
}

/// Every frame's pictures and report in a folder of its own.
pub fn compare(options: &CompareOptions, outputs: Outputs) -> Result<()> {
    let drawing = &options.drawing;
    let request = PlanRequest::drawing(&options.view, drawing).on(&options.machine);
    let frames = request.along(&options.path).planned_frames()?;
    outputs
        .folder(Some(&options.output), &["frames.json", "frames.html"])?
        .spare_inputs()?;
    let (progress, mut warnings) = (ProgressMeter::new(frames.len()), BTreeSet::new());
    let mut rows = Vec::with_capacity(frames.len());
    for (number, frame) in (1..).zip(frames) {
        let NamedFrame { name, mut prepared } = frame.prepare();
        progress.doing(&name);
        against_reference(&mut prepared)?;
        let comparison = compare_all(&prepared, &drawing.effort(), &[])?;
        let folder = options.output.join(format!("frame-{number:04}"));
        create_folder(&folder)?;
        comparison.write(&folder, drawing.depth, drawing.backdrop())?;
        rows.push(FrameRow::new(&name, &folder, &comparison.report));
        warnings.extend(comparison.report.warnings);
        progress.advance();
    }
    drop(progress);
    let over = FrameRow::over(&rows);
    let result = FramesReport {
        format: FORMAT,
        frames: &rows,
        over_frames: &over,
    };
    write_json(&options.output.join("frames.json"), &result)?;
    write_json_if(drawing.json.as_ref(), &result)?;
    let first = rows.first().map_or("", |row| row.name.as_str());
    let html = options.output.join("frames.html");
    write(&html, page(&format!("Frames: {first}"), &rows, &over))?;
    warn(&warnings.into_iter().collect::<Vec<_>>());
    print_result(&format!("{}{}\n", over.text(), html.display()))
}

/// Speed of animations.
const FRAMES_PER_SECOND: u16 = 15;

/// The pictures of frames: called after the photographs of their cameras if those have names of their own, numbered
/// otherwise.
fn files(output: &Path, frames: &[PlannedFrame]) -> Vec<PathBuf> {
    let named = frames
        .iter()
        .map(|frame| Some(behind(output, &plain(frame.picture.as_ref()?))));
    let numbered = (1..=frames.len()).map(|number| behind(output, &format!("{number:04}")));
    let all_differ =
        |files: &Vec<PathBuf>| files.iter().collect::<BTreeSet<_>>().len() == files.len();
    let named: Option<Vec<PathBuf>> = named.collect();
    named
        .filter(all_differ)
        .unwrap_or_else(|| numbered.collect())
}

/// The name of a picture without its extension and its folders' slashes.
fn plain(picture: &str) -> String {
    let ends = |extension: &&str| picture.strip_suffix(&format!(".{extension}"));
    let stem = super::photos::EXTENSIONS.iter().find_map(ends);
    let allowed = |c: char| {
        if c.is_alphanumeric() || "-_.".contains(c) {
            c
        } else {
            '-'
        }
    };
    stem.unwrap_or(picture).chars().map(allowed).collect()
}

/// `x.png` becomes `x-0001.png`.
fn behind(path: &Path, name: &str) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let extension = path.extension().unwrap_or_default().to_string_lossy();
    path.with_file_name(format!("{stem}-{name}.{extension}"))
}
