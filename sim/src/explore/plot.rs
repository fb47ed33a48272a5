//! The sweep as one HTML file: cycles against error and cycles against area, every point labelled under the pointer.
//!
//! No script and nothing from the network: labels are SVG titles.

use super::front::{Candidate, front};
use crate::report::html::escape;
use crate::report::plot::multiples;
use std::fmt::Write;

const WIDTH: f64 = 760.0;
const HEIGHT: f64 = 420.0;
const LEFT: f64 = 84.0;
const BOTTOM: f64 = 52.0;
const TOP: f64 = 18.0;
const RIGHT: f64 = 18.0;

/// A logarithmic axis over the values' range.
struct Scale {
    low: f64,
    high: f64,
    from: f64,
    to: f64,
}

impl Scale {
    /// Values at or below 0 are drawn where the smallest positive one is.
    fn new(values: impl Iterator<Item = f64>, from: f64, to: f64) -> Scale {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for value in values.filter(|value| *value > 0.0) {
            low = low.min(value.log10());
            high = high.max(value.log10());
        }
        if low > high {
            (low, high) = (0.0, 1.0);
        }
        let margin = ((high - low) * 0.06).max(0.05);
        Scale {
            low: low - margin,
            high: high + margin,
            from,
            to,
        }
    }

    fn at(&self, value: f64) -> f64 {
        let log = if value > 0.0 { value.log10() } else { self.low };
        self.from + (log - self.low) / (self.high - self.low) * (self.to - self.from)
    }

    /// 1, 2 and 5 times powers of ten within the range; only the powers if that is too many, all digits if too few.
    fn ticks(&self) -> Vec<f64> {
        let within = |digits: &[f64]| multiples(digits, self.low, self.high);
        let usual = within(&[1.0, 2.0, 5.0]);
        match usual.len() {
            0..4 => within(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]),
            4..=12 => usual,
            _ => within(&[1.0]),
        }
    }
}

/// The page; `note` says what the area is an estimate of.
pub fn page(title: &str, note: &str, candidates: &[Candidate]) -> String {
    let kept = front(candidates);
    let (title, note) = (escape(title), escape(note));
    let count = format!(
        "{} points, {} on the front of error, cycles and area (filled).",
        candidates.len(),
        kept.len()
    );
    let mut page = format!(
        "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><title>{title}</title><style>\
         body{{font:15px/1.5 system-ui,sans-serif;max-width:820px;margin:2em auto;color:#222;background:#fff}}\
         svg text{{font:12px system-ui,sans-serif;fill:#444}}circle{{stroke-width:1.2}}circle:hover{{stroke:#000;stroke-width:3}}\
         table{{border-collapse:collapse;font-size:12px}}td{{border-top:1px solid #ddd;padding:3px 8px}}</style></head><body>\
         <h1>{title}</h1><p>{count} Point at a circle for its settings and results.</p>\n<p>Estimate of {note}.</p>\n"
    );
    match candidates {
        // A sweep that measures no error leaves its column empty, which reads as 0.
        all if all.iter().all(|c| c.rms == 0.0) => page.push_str("<p>No errors to show.</p>\n"),
        [first, others @ ..] if others.iter().all(|other| other.rms == first.rms) => {
            let _ = writeln!(
                page,
                "<p>All points have the same error, {:.3e} rms in units of 1.0.</p>",
                first.rms
            );
        }
        _ => page.push_str(&chart(
            candidates,
            &kept,
            "error (rms, units of 1.0)",
            |c| c.rms,
        )),
    }
    page.push_str(&chart(
        candidates,
        &kept,
        "area (all resources, in LUTs)",
        |c| c.area,
    ));
    page.push_str("<h2>The front, fastest first</h2><table>\n");
    for candidate in &kept {
        // Writing to a String cannot fail.
        let _ = writeln!(page, "<tr><td>{}</td></tr>", escape(&candidate.label));
    }
    page.push_str("</table></body></html>\n");
    page
}

fn chart(
    candidates: &[Candidate],
    kept: &[&Candidate],
    name: &str,
    of: fn(&Candidate) -> f64,
) -> String {
    let x = Scale::new(candidates.iter().map(|c| c.cycles), LEFT, WIDTH - RIGHT);
    let y = Scale::new(candidates.iter().map(of), HEIGHT - BOTTOM, TOP);
    let mut svg = format!(
        "<svg viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" aria-label=\"cycles against {}\">\n",
        escape(name)
    );
    for tick in x.ticks() {
        let at = x.at(tick);
        let _ = writeln!(
            svg,
            "<line x1=\"{at:.1}\" x2=\"{at:.1}\" y1=\"{TOP}\" y2=\"{:.1}\" stroke=\"#e4e4e4\"/><text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
            HEIGHT - BOTTOM,
            HEIGHT - BOTTOM + 18.0,
            short(tick)
        );
    }
    for tick in y.ticks() {
        let at = y.at(tick);
        let _ = writeln!(
            svg,
            "<line x1=\"{LEFT}\" x2=\"{:.1}\" y1=\"{at:.1}\" y2=\"{at:.1}\" stroke=\"#e4e4e4\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
            WIDTH - RIGHT,
            LEFT - 8.0,
            at + 4.0,
            short(tick)
        );
    }
    let _ = writeln!(
        svg,
        "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">simulated cycles</text><text transform=\"translate(16 {:.1}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
        (LEFT + WIDTH - RIGHT) / 2.0,
        HEIGHT - 10.0,
        (TOP + HEIGHT - BOTTOM) / 2.0,
        escape(name)
    );
    let on_front = |candidate: &Candidate| kept.iter().any(|other| other.point == candidate.point);
    let (mut below, mut above) = (String::new(), String::new());
    for candidate in candidates {
        let front = on_front(candidate);
        let (fill, stroke, radius) = if front {
            ("#c2410c", "#7c2d12", 5.0)
        } else {
            ("#ffffff", "#4b78a8", 3.5)
        };
        let target = if front { &mut above } else { &mut below };
        let _ = writeln!(
            target,
            "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"{radius}\" fill=\"{fill}\" stroke=\"{stroke}\"><title>{}</title></circle>",
            x.at(candidate.cycles),
            y.at(of(candidate)),
            escape(&candidate.label.replace(", ", "\n"))
        );
    }
    svg + &below + &above + "</svg>\n"
}

/// `20000000` as `20M`, `0.0005` as `5e-4`.
fn short(value: f64) -> String {
    match value {
        v if v >= 1e9 => format!("{:.0}G", v / 1e9),
        v if v >= 1e6 => format!("{:.0}M", v / 1e6),
        v if v >= 1e3 => format!("{:.0}k", v / 1e3),
        v if v >= 1.0 => format!("{v:.0}"),
        v => format!("{v:.0e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_point_has_its_label_and_text_is_escaped() {
        let candidate = |point, rms, cycles, area| Candidate {
            point,
            rms,
            cycles,
            area,
            label: format!("p <{point}>"),
        };
        let all = [
            candidate(0, 1e-3, 1e6, 5e3),
            candidate(1, 0.0, 2e6, 9e3),
            candidate(2, 1e-2, 3e6, 9e3),
        ];
        let page = page("a & b", "area < all", &all);
        assert_eq!(page.matches("<circle").count(), 6);
        assert!(
            page.contains("p &lt;2&gt;")
                && page.contains("a &amp; b")
                && page.contains("Estimate of area &lt; all.")
                && !page.contains("NaN")
        );
        assert!(page.contains("3 points, 2 on the front"));
        assert_eq!(page.matches("<svg").count(), 2);
    }

    #[test]
    fn an_error_that_all_points_share_is_a_sentence() {
        let all = [(1, 2e6), (2, 3e6)].map(|(point, cycles)| Candidate {
            point,
            rms: 2e-6,
            cycles,
            area: 7e4 * point as f64,
            label: String::new(),
        });
        let page = page("t", "", &all);
        assert!(page.contains("same error, 2.000e-6"));
        assert_eq!(page.matches("<svg").count(), 1);
        assert!(page.contains(">90k<"), "a short axis has all its digits");
    }
}
