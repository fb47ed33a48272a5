//! What a drawing and a comparison tell on a terminal.

use crate::picture::Picture;
use crate::report::facts::ReasonCounts;
use crate::report::formats::formats_text;
use crate::report::table::{decibels, scientific, signed, throughput_text};
use crate::report::{ChannelFacts, Report};
use std::path::Path;

/// Why a picture is empty, for the standard error: an empty picture and exit code 0 look like success. Nothing if it is not.
pub fn if_nothing_is_seen(picture: &Picture, report: &Report) -> String {
    let scene = &report.scene;
    let clear = |pixel: &[f64; 4]| *pixel == [0.0; 4];
    if !picture.pixels.iter().all(clear) {
        return String::new();
    }
    let all = scene.splats;
    let culled = scene.culled.values().sum::<u64>();
    let why = match culled {
        _ if all == 0 => "the scene has no splats".to_owned(),
        0 => "all splats are transparent or smaller than a pixel".to_owned(),
        _ => format!(
            "of {all} splats{}; the rest is transparent or smaller than a pixel",
            reasons("are culled", &scene.culled)
        ),
    };
    format!("{}: the picture is empty: {why}\n", scene.name)
}

/// Says that surfaces were merged, which the layers asked for could not keep apart; nothing if none were.
pub fn if_layers_were_merged(pixels: usize) -> String {
    match pixels {
        0 => String::new(),
        _ => format!("{pixels} pixels had more layers than --layers keeps\n"),
    }
}

/// What was drawn, what was left out and how long it took.
pub fn of_drawing(report: &Report) -> String {
    let scene = &report.scene;
    let clamped = if scene.clamped > 0 {
        format!(", {} clamped", scene.clamped)
    } else {
        String::new()
    };
    format!(
        "{}: {} splats{}{}{clamped}\n{}\n",
        scene.name,
        scene.splats,
        reasons("skipped", &scene.skipped),
        reasons("culled", &scene.culled),
        times(report),
    )
}

/// Only the kernel's host side tells its stages apart.
fn times(report: &Report) -> String {
    let host = &report.host;
    let runs = if host.repeat > 1 {
        format!(", median of {} runs", host.repeat)
    } else {
        String::new()
    };
    let total = format!("{:.1} ms{runs}", host.total_s * 1e3);
    let before = if host.prepare_s > 0.0 {
        format!(
            ", after {:.1} ms of loading and preparing",
            host.prepare_s * 1e3
        )
    } else {
        String::new()
    };
    if report.traversal.is_none() {
        return total + &before;
    }
    let stages = [
        ("setup", host.setup_s),
        ("sort", host.sort_s),
        ("raster", host.raster_s),
        ("convert", host.convert_s),
    ];
    let stages = stages.map(|(name, seconds)| format!("{name} {:.1}", seconds * 1e3));
    format!("{total} ({}){before}", stages.join(", "))
}

/// `, 7 culled (near 3, outside 4)`; nothing where nothing was left out.
fn reasons(what: &str, counts: &ReasonCounts) -> String {
    let named: Vec<String> = counts
        .iter()
        .filter(|(_, count)| **count > 0)
        .map(|(reason, count)| format!("{reason} {count}"))
        .collect();
    if named.is_empty() {
        return String::new();
    }
    let total = counts
        .values()
        .fold(0u64, |sum, count| sum.saturating_add(*count));
    format!(", {total} {what} ({})", named.join(", "))
}

/// The chosen design's errors.
pub fn of_comparison(report: &Report, folder: &Path) -> String {
    let line = |name: &str, error: &ChannelFacts| {
        let covered = &error.covered;
        format!(
            "{name:<6} PSNR {} dB, max error {}, bias {}, SSIM {:.6}; over the {} covered pixels PSNR {} dB, bias {}, SSIM {:.6}\n",
            decibels(error.psnr_db),
            scientific(error.max_abs),
            signed(error.bias),
            error.ssim,
            covered.pixels,
            decibels(covered.psnr_db),
            signed(covered.bias),
            covered.ssim,
        )
    };
    let errors = report
        .error
        .iter()
        .map(|error| line("RGB", &error.rgb) + &line("alpha", &error.alpha));
    format!(
        "{}, design {} by {}, against {}\n{}{}{}{}\n",
        report.scene.name,
        report.design_name(),
        report.traversal.as_deref().unwrap_or("-"),
        report.reference.as_deref().unwrap_or("-"),
        errors.collect::<String>(),
        throughput_text(report),
        formats_text(report),
        folder.join("report.html").display(),
    )
}
