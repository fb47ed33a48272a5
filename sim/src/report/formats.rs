//! What floating-point datapaths make of the report's picture, as a table of its page and as lines on a terminal.

use super::html::{Column, table_of};
use super::table::{decibels, psnr_text, scientific, signed};
use super::{FormatRow, Report};

/// A section of the page; nothing if nobody asked.
pub(super) fn formats_section(report: &Report) -> String {
    if report.formats.is_empty() {
        return String::new();
    }
    let columns: [Column<&FormatRow>; 9] = [
        ("engine", &|row| row.engine.clone()),
        ("PSNR dB", &|row| decibels(row.error.rgb.psnr_db)),
        ("max error", &|row| scientific(row.error.rgb.max_abs)),
        ("p99", &|row| scientific(row.error.rgb.percentiles.p99)),
        ("bias", &|row| signed(row.error.rgb.bias)),
        ("SSIM", &|row| format!("{:.5}", row.error.rgb.ssim)),
        ("FLIP", &|row| scientific(row.error.flip)),
        ("transistors a lane", &|row| row.transistors.to_string()),
        ("pJ a pixel", &|row| format!("{:.1}", row.pj_per_pixel)),
    ];
    format!(
        "<section>\n<h2>Floating-point datapaths</h2>\n<p class=\"read\">The usual formulas, every operation rounded. fp16 and bfloat16 have setup \
         in single precision and a centre relative to its tile. Transistors \
         and energy are estimates of a lane's arithmetic.</p>\n{}\n</section>\n",
        table_of("", &[], &columns, &report.formats)
    )
}

/// The same, a line each.
pub fn formats_text(report: &Report) -> String {
    let line = |row: &FormatRow| {
        let error = &row.error.rgb;
        format!(
            "{:<9} PSNR {}, max error {}, p99 {}, bias {}, SSIM {:.6}, FLIP {}, {} transistors a lane, {:.1} pJ a pixel\n",
            row.engine,
            psnr_text(error.psnr_db),
            scientific(error.max_abs),
            scientific(error.percentiles.p99),
            signed(error.bias),
            error.ssim,
            scientific(row.error.flip),
            row.transistors,
            row.pj_per_pixel
        )
    };
    report.formats.iter().map(line).collect()
}
