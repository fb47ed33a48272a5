//! Many frames as one table and two curves: error and cycles over the path.

use super::Report;
use super::html::escape;
use crate::machine::summary::Spread;
use serde::Serialize;
use std::fmt::Write;
use std::path::Path;

/// A frame's line.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FrameRow {
    /// The camera's name.
    pub name: String,
    /// The folder of its pictures and report.
    pub folder: String,
    /// PSNR of the colours; null for equal pictures.
    pub psnr_db: Option<f64>,
    /// Largest error of a colour.
    pub max_abs: f64,
    /// Mean of fixed minus float.
    pub bias: f64,
    /// Structural similarity.
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
    /// Frames.
    pub frames: usize,
    /// Largest errors.
    pub max_abs: Spread,
    /// Root mean square errors, from the PSNR.
    pub rms: Spread,
    /// Signed bias, by size.
    pub bias: Spread,
    /// Cycles.
    pub cycles: Spread,
    /// Milliseconds a frame by the machine's clock.
    pub ms_per_frame: Spread,
    /// Bytes a second.
    pub bytes_per_s: Spread,
    /// Pictures a second if every frame took as long as the worst; null without cycles.
    pub frames_per_s_at_worst: Option<f64>,
    /// PSNR of the worst frame; null for equal pictures.
    pub worst_psnr_db: Option<f64>,
    /// Which frame that is.
    pub worst_frame: String,
}

impl FrameRow {
    /// From a frame's report.
    pub fn new(name: &str, folder: &Path, report: &Report) -> FrameRow {
        let folder = folder.file_name().unwrap_or_default().to_string_lossy();
        let rgb = report.error.map(|error| error.rgb);
        let total =
            |cycles: &serde_json::Value| cycles.get("total").and_then(|total| total.as_u64());
        let pace = |key: &str| report.pace.as_ref()?.get(key)?.as_f64();
        FrameRow {
            ms_per_frame: pace("ms_per_frame"),
            bytes_per_s: pace("bytes_per_s"),
            name: name.to_owned(),
            folder: folder.into_owned(),
            psnr_db: rgb.and_then(|rgb| rgb.psnr_db),
            max_abs: rgb.map_or(0.0, |rgb| rgb.max_abs),
            bias: rgb.map_or(0.0, |rgb| rgb.bias),
            ssim: rgb.map_or(1.0, |rgb| rgb.ssim),
            cycles: report.cycles.as_ref().and_then(total),
        }
    }

    fn rms(&self) -> f64 {
        self.psnr_db.map_or(0.0, |psnr| 10f64.powf(-psnr / 20.0))
    }

    /// Over all rows.
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
            rms: spread(FrameRow::rms),
            bias: spread(|row| row.bias.abs()),
            cycles: spread(|row| row.cycles.unwrap_or(0) as f64),
            worst_psnr_db: worst.and_then(|row| row.psnr_db),
            worst_frame: worst.map_or(String::new(), |row| row.name.clone()),
        }
    }
}

impl OverRows {
    /// For people.
    pub fn text(&self) -> String {
        let psnr = |rms: f64| {
            if rms > 0.0 {
                format!("{:.2} dB", -20.0 * rms.log10())
            } else {
                "equal".to_owned()
            }
        };
        let three = |show: &dyn Fn(f64) -> String, spread: &Spread| {
            [spread.worst, spread.percentile_95, spread.mean].map(show)
        };
        let lines = [
            ("PSNR", three(&psnr, &self.rms)),
            (
                "largest error",
                three(&|error| format!("{error:.3e}"), &self.max_abs),
            ),
            ("|bias|", three(&|bias| format!("{bias:.2e}"), &self.bias)),
            (
                "Mcycles",
                three(&|cycles| format!("{:.3}", cycles / 1e6), &self.cycles),
            ),
            (
                "ms a frame",
                three(&|ms| format!("{ms:.3}"), &self.ms_per_frame),
            ),
            (
                "MB a second",
                three(&|bytes| format!("{:.1}", bytes / 1e6), &self.bytes_per_s),
            ),
        ];
        let mut text = format!(
            "{} frames, the one with the lowest PSNR is {}\n{:<16} {:>12} {:>12} {:>12}\n",
            self.frames, self.worst_frame, "", "worst", "95 %", "mean"
        );
        for (name, [worst, p95, mean]) in lines {
            // Writing to a String cannot fail.
            let _ = writeln!(text, "{name:<16} {worst:>12} {p95:>12} {mean:>12}");
        }
        if let Some(rate) = self.frames_per_s_at_worst {
            let _ = writeln!(
                text,
                "{rate:.2} frames a second if every frame took as long as the worst"
            );
        }
        text
    }
}

pub(super) const STYLE: &str = "body{font:15px/1.5 system-ui,sans-serif;max-width:64rem;margin:1.5rem auto;padding:0 1rem;color:#1b1f24;background:#fff}\
table{border-collapse:collapse}td,th{padding:.15rem .6rem;text-align:right}td:first-child,th:first-child{text-align:left}\
.scroll{overflow-x:auto}svg{max-width:100%;height:auto}pre{overflow-x:auto}text{fill:currentColor;font:12px system-ui,sans-serif}\
@media(prefers-color-scheme:dark){body{color:#e6e8eb;background:#14171a}a{color:#8ab4f8}}";

/// One page that stands alone.
pub fn page(title: &str, rows: &[FrameRow], over: &OverRows) -> String {
    let title = escape(title);
    let mut table = String::from(
        "<table><tr><th>frame</th><th>PSNR, dB</th><th>largest error</th><th>bias</th><th>SSIM</th><th>cycles</th><th>ms</th></tr>\n",
    );
    for row in rows {
        let psnr = row
            .psnr_db
            .map_or("equal".to_owned(), |psnr| format!("{psnr:.2}"));
        let cycles = row
            .cycles
            .map_or(String::new(), |cycles| cycles.to_string());
        let ms = row.ms_per_frame;
        let ms = ms.map_or(String::new(), |ms| format!("{ms:.3}"));
        // Writing to a String cannot fail.
        let _ = writeln!(
            table,
            "<tr><td><a href=\"{}/report.html\">{}</a></td><td>{psnr}</td><td>{:.3e}</td><td>{:+.2e}</td><td>{:.6}</td><td>{cycles}</td><td>{ms}</td></tr>",
            escape(&row.folder),
            escape(&row.name),
            row.max_abs,
            row.bias,
            row.ssim
        );
    }
    let curves = [
        curve("Largest error", rows, &|row| row.max_abs),
        curve("Mcycles", rows, &|row| row.cycles.unwrap_or(0) as f64 / 1e6),
    ];
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>{title}</title>\n<style>{STYLE}</style>\n</head>\n<body>\n<h1>{title}</h1>\n<pre>{}</pre>\n{}\n<div class=\"scroll\">{table}</table></div>\n</body>\n</html>\n",
        escape(&over.text()),
        curves.concat()
    )
}

/// A value over the frames, from 0 to its largest.
fn curve(name: &str, rows: &[FrameRow], of: &dyn Fn(&FrameRow) -> f64) -> String {
    let [width, height, left, top] = [760.0, 180.0, 70.0, 24.0];
    let most = rows.iter().map(of).fold(0.0, f64::max);
    let unit = if most > 0.0 { most } else { 1.0 };
    let across = (width - left - 10.0) / (rows.len().max(2) - 1) as f64;
    let place = |(number, row): (usize, &FrameRow)| {
        let y = top + (height - top - 24.0) * (1.0 - of(row) / unit);
        (left + across * number as f64, y)
    };
    let mut points = String::new();
    let mut dots = String::new();
    for (number, row) in rows.iter().enumerate() {
        let (x, y) = place((number, row));
        // Writing to a String cannot fail.
        let _ = write!(points, "{x:.1},{y:.1} ");
        let title = escape(&format!("{}: {:.4e}", row.name, of(row)));
        let _ = write!(
            dots,
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3\" fill=\"#2f6fde\"><title>{title}</title></circle>"
        );
    }
    let base = height - 24.0;
    format!(
        "<svg viewBox=\"0 0 {width} {height}\" width=\"{width}\" role=\"img\" aria-label=\"{name} over the frames\">\
         <text x=\"{left}\" y=\"14\">{name} over the frames</text>\
         <text x=\"{0}\" y=\"{1}\" text-anchor=\"end\">{most:.3e}</text><text x=\"{0}\" y=\"{base}\" text-anchor=\"end\">0</text>\
         <path d=\"M{left} {top}V{base}H{2}\" fill=\"none\" stroke=\"currentColor\" stroke-opacity=\".4\"/>\
         <polyline points=\"{points}\" fill=\"none\" stroke=\"#2f6fde\" stroke-width=\"1.5\"/>{dots}</svg>\n",
        left - 6.0,
        top + 6.0,
        width - 10.0
    )
}
