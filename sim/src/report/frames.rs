//! Many frames as one table and two curves: error and cycles over the path.

use super::Report;
use super::chart::{Axis, Chart};
use super::html::{Column, escape, table_of};
use super::labels::Rectangle;
use super::shell::Shell;
use super::table::{decibels, psnr_of_rms};
use crate::machine::summary::Spread;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Version of the reports over frames.
pub const FORMAT: &str = "splatline-frames/1";

/// What `compare` writes over frames.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FramesReport<'a> {
    pub format: &'static str,
    pub frames: &'a [FrameRow],
    pub over_frames: &'a OverRows,
}

/// What `render` writes over frames.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DrawnFrames {
    pub format: &'static str,
    pub frames: Vec<DrawnFrame>,
    /// Seconds of drawing one.
    pub total_s: Spread,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DrawnFrame {
    pub name: String,
    pub file: PathBuf,
    pub report: Report,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FrameRow {
    pub name: String,
    /// The folder of its pictures and report.
    pub folder: String,
    /// PSNR of the colours; null for equal pictures.
    pub psnr_db: Option<f64>,
    pub max_abs: f64,
    /// 99 % of the samples of colours differ by no more.
    pub p99: f64,
    pub flip: f64,
    /// Mean of fixed minus float.
    pub bias: f64,
    pub ssim: f64,
    /// Cycles of the machine; null where it does not draw the scene.
    pub cycles: Option<u64>,
    /// Milliseconds a frame by the machine's clock; null without cycles.
    pub ms_per_frame: Option<f64>,
    /// Bytes a second at that rate; null without cycles.
    pub bytes_per_s: Option<f64>,
}

/// The worst frame, the 95th percentile and the mean.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OverRows {
    pub frames: usize,
    pub max_abs: Spread,
    pub p99: Spread,
    pub flip: Spread,
    /// Root mean square errors, from the PSNR.
    pub rms: Spread,
    /// Signed bias, by size.
    pub bias: Spread,
    pub cycles: Spread,
    /// Milliseconds a frame by the machine's clock.
    pub ms_per_frame: Spread,
    /// Bytes a second.
    pub bytes_per_s: Spread,
    /// Pictures a second if every frame took as long as the worst; null without cycles.
    pub frames_per_s_at_worst: Option<f64>,
    /// PSNR of the worst frame; null for equal pictures.
    pub worst_psnr_db: Option<f64>,
    pub worst_frame: String,
}

impl FrameRow {
    pub fn new(name: &str, folder: &Path, report: &Report) -> FrameRow {
        let folder = folder.file_name().unwrap_or_default().to_string_lossy();
        let rgb = report.error.map(|error| error.rgb);
        let pace = report.pace.as_ref();
        FrameRow {
            ms_per_frame: pace.map(|pace| pace.ms_per_frame),
            bytes_per_s: pace.map(|pace| pace.bytes_per_s),
            name: name.to_owned(),
            folder: folder.into_owned(),
            psnr_db: rgb.map(|rgb| rgb.psnr_db).filter(|psnr| psnr.is_finite()),
            max_abs: rgb.map_or(0.0, |rgb| rgb.max_abs),
            p99: rgb.map_or(0.0, |rgb| rgb.percentiles.p99),
            flip: report.error.map_or(0.0, |error| error.flip),
            bias: rgb.map_or(0.0, |rgb| rgb.bias),
            ssim: rgb.map_or(1.0, |rgb| rgb.ssim),
            cycles: report.cycles.as_ref().map(|cycles| cycles.total),
        }
    }

    fn rms(&self) -> f64 {
        self.psnr_db.map_or(0.0, |psnr| 10f64.powf(-psnr / 20.0))
    }

    pub fn over(rows: &[FrameRow]) -> OverRows {
        let spread = |of: fn(&FrameRow) -> f64| Spread::of(rows.iter().map(of));
        let worst = rows.iter().max_by(|a, b| a.rms().total_cmp(&b.rms()));
        let ms_per_frame = spread(|row| row.ms_per_frame.unwrap_or(0.0));
        OverRows {
            frames_per_s_at_worst: Some(1e3 / ms_per_frame.worst).filter(|rate| rate.is_finite()),
            ms_per_frame,
            bytes_per_s: spread(|row| row.bytes_per_s.unwrap_or(0.0)),
            frames: rows.len(),
            max_abs: spread(|row| row.max_abs),
            p99: spread(|row| row.p99),
            flip: spread(|row| row.flip),
            rms: spread(FrameRow::rms),
            bias: spread(|row| row.bias.abs()),
            cycles: spread(|row| row.cycles.unwrap_or(0) as f64),
            worst_psnr_db: worst.and_then(|row| row.psnr_db),
            worst_frame: worst.map_or(String::new(), |row| row.name.clone()),
        }
    }
}

impl OverRows {
    pub fn text(&self) -> String {
        type Line<'a> = (&'a str, &'a Spread, &'a dyn Fn(f64) -> String);
        let exponent = |value: f64| format!("{value:.3e}");
        let millions = |value: f64| format!("{:.3}", value / 1e6);
        let lines: [Line; 8] = [
            ("PSNR", &self.rms, &psnr_of_rms),
            ("largest error", &self.max_abs, &exponent),
            ("99th percentile", &self.p99, &exponent),
            ("FLIP", &self.flip, &exponent),
            ("|bias|", &self.bias, &|bias| format!("{bias:.2e}")),
            ("Mcycles", &self.cycles, &millions),
            ("ms a frame", &self.ms_per_frame, &|ms| format!("{ms:.3}")),
            ("MB a second", &self.bytes_per_s, &|bytes| {
                format!("{:.1}", bytes / 1e6)
            }),
        ];
        let mut text = format!(
            "{} frames, the one with the lowest PSNR is {}\n{:<16} {:>12} {:>12} {:>12}\n",
            self.frames, self.worst_frame, "", "worst", "95 %", "mean"
        );
        for (name, spread, show) in lines {
            let [worst, p95, mean] = [spread.worst, spread.percentile_95, spread.mean].map(show);
            text += &format!("{name:<16} {worst:>12} {p95:>12} {mean:>12}\n");
        }
        if let Some(rate) = self.frames_per_s_at_worst {
            text +=
                &format!("{rate:.2} frames a second if every frame took as long as the worst\n");
        }
        text
    }
}

pub fn page(title: &str, rows: &[FrameRow], over: &OverRows) -> String {
    let link = |row: &&FrameRow| {
        let (folder, name) = (escape(&row.folder), escape(&row.name));
        format!("<a href=\"{folder}/report.html\">{name}</a>")
    };
    let cycles = |cycles: u64| cycles.to_string();
    let columns: [Column<&FrameRow>; 9] = [
        ("frame", &link),
        ("PSNR, dB", &|row| {
            decibels(row.psnr_db.unwrap_or(f64::INFINITY))
        }),
        ("largest error", &|row| format!("{:.3e}", row.max_abs)),
        ("p99", &|row| format!("{:.3e}", row.p99)),
        ("bias", &|row| format!("{:+.2e}", row.bias)),
        ("SSIM", &|row| format!("{:.6}", row.ssim)),
        ("FLIP", &|row| format!("{:.3e}", row.flip)),
        ("cycles", &|row| row.cycles.map_or_else(String::new, cycles)),
        ("ms", &|row| {
            row.ms_per_frame
                .map_or_else(String::new, |ms| format!("{ms:.3}"))
        }),
    ];
    let table = table_of("", &[0], &columns, rows);
    let curves = [
        curve("Largest error", rows, &|row| row.max_abs),
        curve("Mcycles", rows, &|row| row.cycles.unwrap_or(0) as f64 / 1e6),
    ];
    let body = format!(
        "<section>\n<pre>{}</pre>\n</section>\n<section class=\"charts\">\n{}</section>\n\
         <section>\n<h2>Frame by frame</h2>\n{table}\n</section>\n",
        escape(&over.text()),
        curves.concat()
    );
    let product = "splatline: many frames, fixed point against float";
    Shell::still(product, title, "", &body).html()
}

/// A value over the frames, from 0 to its largest.
fn curve(name: &str, rows: &[FrameRow], of: &dyn Fn(&FrameRow) -> f64) -> String {
    let frame = Rectangle::new([70.0, 34.0], [680.0, 180.0]);
    let most = rows.iter().map(of).fold(0.0, f64::max);
    let last = rows.len().max(2) as f64;
    let across = Axis::linear([1.0, last], frame.across());
    let up = Axis::linear([0.0, most], frame.upwards());
    let mut chart = Chart::new(760.0, 264.0, &format!("{name} over the frames"));
    chart.rows(&frame, &up, &up.ticks(5));
    let numbers = across.ticks(12).into_iter();
    let numbers: Vec<f64> = numbers.filter(|number| number.fract() == 0.0).collect();
    chart.columns(&frame, &across, &numbers);
    chart.names(&frame, "frame", name);
    let places: Vec<(f64, f64)> = (1..)
        .zip(rows)
        .map(|(number, row)| (across.at(f64::from(number)), up.at(of(row))))
        .collect();
    chart.curve(places.iter().copied(), "s3", name);
    for (place, row) in places.iter().zip(rows) {
        let words = format!("{}: {:.4e}", row.name, of(row));
        chart.disc(*place, 3.0, "class=\"mark s3\"", &words);
    }
    chart.finish()
}
