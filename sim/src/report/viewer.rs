//! What the report's script works on: the numbers behind the pictures' pixels, the colours of the error scale, and the
//! controls around them.
//!
//! A picture of eight bits shows no error of 1e-7. For every pixel and channel the page holds the kernel's value in 16
//! bits and the error as the upper half of a single-precision number, which keeps two digits of it at any size. Each
//! half is a plane of bytes, which packs well.

use super::error_map::{ErrorMap, colour};
use super::scale::{ErrorScale, PERCENTILE};
use crate::metrics::stored;
use crate::picture::Picture;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::GzEncoder;
use serde::Serialize;
use std::io::Write;

/// Pictures of more pixels are shown without their numbers, which would make a file of tens of megabytes.
pub const MOST_PIXELS: usize = 1 << 21;

/// Percentiles at which a reader may end the error's scale.
const PERCENTILES: [f64; 8] = [50.0, 75.0, 90.0, 95.0, 99.0, 99.9, 99.99, 100.0];

/// Shades of the error scale that the script chooses from.
const SHADES: usize = 257;

/// What the script reads.
#[derive(Serialize)]
struct ViewerSettings<'a> {
    width: usize,
    height: usize,
    engine: &'a str,
    reference: &'a str,
    percentile: f64,
    percentiles: [f64; PERCENTILES.len()],
    /// Counted here: the page's own errors have two digits, so that a few too many or too few of them would lie beyond.
    outliers: [usize; PERCENTILES.len()],
    colours: Vec<[u8; 3]>,
    most: usize,
}

/// The page's data and script; `engine` drew `fixed`, `reference` drew `float`.
pub fn script(
    fixed: &Picture,
    float: &Picture,
    engine: &str,
    reference: &str,
) -> anyhow::Result<String> {
    let differences = ErrorMap::new(fixed, float).differences;
    let shade = |index: usize| colour(2.0 * index as f64 / (SHADES - 1) as f64 - 1.0);
    let outliers = |percentile| ErrorScale::of(&differences, percentile).outliers;
    let settings = serde_json::to_string(&ViewerSettings {
        width: fixed.width,
        height: fixed.height,
        engine,
        reference,
        percentile: PERCENTILE,
        percentiles: PERCENTILES,
        outliers: PERCENTILES.map(outliers),
        colours: (0..SHADES).map(shade).collect(),
        most: MOST_PIXELS,
    })?;
    let values = if fixed.pixels.len() <= MOST_PIXELS {
        format!(
            "<script type=\"text/plain\" id=\"values\">{}</script>\n",
            packed(&planes(fixed, float))?
        )
    } else {
        String::new()
    };
    Ok(format!(
        "<script type=\"application/json\" id=\"settings\">{}</script>\n{values}<script>\n{}</script>\n",
        settings.replace('<', "\\u003c"),
        include_str!("report.js")
    ))
}

/// Per channel four planes: the kernel's value (low byte, high byte) and the error (third byte of a single, highest
/// byte).
fn planes(fixed: &Picture, float: &Picture) -> Vec<u8> {
    let pairs = || fixed.pixels.iter().zip(&float.pixels);
    let mut bytes = Vec::with_capacity(fixed.pixels.len() * 16);
    for channel in 0..4 {
        let value = |pixel: &[f64; 4]| (stored(pixel[channel]) * 65535.0).round() as u16;
        let error =
            |a: &[f64; 4], b: &[f64; 4]| upper_half(stored(a[channel]) - stored(b[channel]));
        for part in 0..2 {
            bytes.extend(pairs().map(|(a, _)| value(a).to_le_bytes()[part]));
        }
        for part in 0..2 {
            bytes.extend(pairs().map(|(a, b)| error(a, b).to_le_bytes()[part]));
        }
    }
    bytes
}

/// The upper 16 bits of a number in single precision, rounded to nearest.
fn upper_half(value: f64) -> u16 {
    let bits = (value as f32).to_bits();
    (bits.saturating_add(0x8000) >> 16) as u16
}

/// Bytes compressed and as text.
pub fn packed(bytes: &[u8]) -> std::io::Result<String> {
    let mut packer = GzEncoder::new(Vec::new(), Compression::default());
    packer.write_all(bytes)?;
    Ok(STANDARD.encode(packer.finish()?))
}

/// The buttons over the pictures, hidden until the script is there.
pub const CONTROLS: &str = include_str!("controls.html");

/// What stands under the pictures: the pixel under the pointer, the percentile, the histogram.
pub fn readings(map: &ErrorMap) -> String {
    if map.differences.is_empty() {
        return String::new();
    }
    let last = (PERCENTILES.len() - 1).to_string();
    include_str!("readings.html").replace("{last}", &last)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_keeps_two_digits_at_any_size() {
        for error in [1e-9, -3.7e-7, 0.42, -1.0, 5.5e-30] {
            let back = f64::from(f32::from_bits(u32::from(upper_half(error)) << 16));
            assert!((back / error - 1.0).abs() < 0.004, "{error}: {back}");
        }
        assert_eq!(upper_half(0.0), 0);
    }
}
