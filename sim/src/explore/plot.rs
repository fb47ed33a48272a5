//! The sweep as one HTML file: cycles against error and cycles against area, every point labelled under the pointer, and by a script a table to
//! sort, filters, a scatter of any two columns and parallel axes.
//!
//! Nothing comes from the network. The two charts and the list of the front stand without the script; labels are SVG titles. Axes lie as in
//! the report: faster is left and better is up, so that less error and less area are up.

use super::front::{Candidate, front};
use super::table::{RESULTS, ResultTable};
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
struct PlotScale {
    low: f64,
    high: f64,
    from: f64,
    to: f64,
}

impl PlotScale {
    /// Values at or below 0 are drawn where the smallest positive one is.
    fn new(values: impl Iterator<Item = f64>, from: f64, to: f64) -> PlotScale {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for value in values.filter(|value| *value > 0.0) {
            low = low.min(value.log10());
            high = high.max(value.log10());
        }
        if low > high {
            (low, high) = (0.0, 1.0);
        }
        let margin = ((high - low) * 0.06).max(0.05);
        PlotScale {
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

    /// 1, 2 and 5 times powers of ten among the data; only the powers if that is too many, all digits if too few, and even steps where the
    /// range is so narrow that no round number lies in it.
    fn ticks(&self) -> Vec<f64> {
        let usual = self.multiples(&[1.0, 2.0, 5.0]);
        let all = self.multiples(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]);
        match (usual.len(), all.len()) {
            (4..=12, _) => usual,
            (13.., _) => self.multiples(&[1.0]),
            (_, 4..) => all,
            _ => self.even_steps(),
        }
    }

    /// Multiples of 1, 2 or 5 times a power of ten that cut the range into about six parts.
    fn even_steps(&self) -> Vec<f64> {
        let (low, high) = (10f64.powf(self.low), 10f64.powf(self.high));
        let rough = (high - low) / 6.0;
        let decade = 10f64.powf(rough.log10().floor());
        let step = [1.0, 2.0, 5.0].map(|digit| digit * decade);
        let step = step
            .into_iter()
            .find(|step| *step >= rough)
            .unwrap_or(10.0 * decade);
        let first = (low / step).ceil() as i64;
        let last = (high / step).floor() as i64;
        (first..=last.min(first + 20))
            .map(|multiple| multiple as f64 * step)
            .collect()
    }

    /// These digits times powers of ten within the range.
    fn multiples(&self, digits: &[f64]) -> Vec<f64> {
        multiples(digits, self.low, self.high)
    }
}

/// What the page shows.
pub struct Sweep<'a> {
    /// Heading of the page.
    pub title: &'a str,
    /// What the area is an estimate of.
    pub note: &'a str,
    /// All points.
    pub table: &'a ResultTable,
    /// Those with results.
    pub candidates: &'a [Candidate],
}

/// The page.
pub fn page(sweep: &Sweep) -> String {
    let Sweep {
        title,
        note,
        candidates,
        ..
    } = *sweep;
    let kept = front(candidates);
    let (title, note) = (escape(title), escape(note));
    let count = format!(
        "{} points, {} on the front of error, cycles, area and energy (filled).",
        candidates.len(),
        kept.len()
    );
    let mut charts = String::new();
    match candidates {
        // A sweep that measures no error leaves its column empty, which reads as 0.
        all if all.iter().all(|c| c.rms == 0.0) => charts.push_str("<p>No errors to show.</p>\n"),
        [first, others @ ..] if others.iter().all(|other| other.rms == first.rms) => {
            let _ = writeln!(
                charts,
                "<p>All points have the same error, {:.3e} rms in units of 1.0.</p>",
                first.rms
            );
        }
        _ => charts.push_str(&chart(
            candidates,
            &kept,
            "error (rms, units of 1.0), less is up",
            |c| c.rms,
        )),
    }
    charts.push_str(&chart(
        candidates,
        &kept,
        "area (all resources, in LUTs), less is up",
        |c| c.area,
    ));
    let mut plain = String::new();
    for candidate in &kept {
        // Writing to a String cannot fail.
        let _ = writeln!(plain, "<tr><td>{}</td></tr>", escape(&candidate.label));
    }
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'\">\n\
         <title>{title}</title>\n<style>\n{style}{own}</style>\n</head>\n<body>\n<header>\n<p class=\"product\">splatline: a sweep over designs and machines</p>\n\
         <h1>{title}</h1>\n<p class=\"facts\">{count} As in the report, up is better and left is faster: the best corner is the upper left. Point at a mark for its \
         settings and results.</p>\n<p class=\"facts\">Estimate of {note}.</p>\n</header>\n<main>\n<section class=\"charts still\">\n{charts}</section>\n{controls}\
         <section id=\"plain\"><h2>The front, fastest first</h2><div class=\"scroll\"><table>\n{plain}</table></div></section>\n</main>\n<footer></footer>\n\
         <script type=\"application/json\" id=\"points\">{points}</script>\n<script>\n{script}</script>\n</body>\n</html>\n",
        style = include_str!("../report/page.css"),
        own = include_str!("front.css"),
        controls = include_str!("front.html"),
        points = points(sweep, &kept),
        script = include_str!("front.js"),
    )
}

/// The table as the page's script reads it, without the rows' digests.
fn points(sweep: &Sweep, kept: &[&Candidate]) -> String {
    let shown = sweep.table.heading.len().saturating_sub(1);
    let columns = &sweep.table.heading[..shown];
    let axes: Vec<&str> = columns
        .iter()
        .map(String::as_str)
        .filter(|name| *name != "point" && !RESULTS.contains(name))
        .collect();
    let rows: Vec<&[String]> = sweep
        .candidates
        .iter()
        .filter_map(|candidate| sweep.table.rows.get(&candidate.point))
        .filter_map(|row| row.get(..shown))
        .collect();
    let front: Vec<usize> = kept.iter().map(|candidate| candidate.point).collect();
    serde_json::json!({"columns": columns, "axes": axes, "rows": rows, "front": front})
        .to_string()
        .replace('<', "\\u003c")
}

fn chart(
    candidates: &[Candidate],
    kept: &[&Candidate],
    name: &str,
    of: fn(&Candidate) -> f64,
) -> String {
    let x = PlotScale::new(candidates.iter().map(|c| c.cycles), LEFT, WIDTH - RIGHT);
    // Less is better: up, as in the report.
    let y = PlotScale::new(candidates.iter().map(of), TOP, HEIGHT - BOTTOM);
    let mut svg = format!(
        "<svg viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" aria-label=\"cycles against {}\">\n",
        escape(name)
    );
    for tick in x.ticks() {
        let at = x.at(tick);
        let _ = writeln!(
            svg,
            "<line x1=\"{at:.1}\" x2=\"{at:.1}\" y1=\"{TOP}\" y2=\"{:.1}\"/><text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
            HEIGHT - BOTTOM,
            HEIGHT - BOTTOM + 18.0,
            short(tick)
        );
    }
    for tick in y.ticks() {
        let at = y.at(tick);
        let _ = writeln!(
            svg,
            "<line x1=\"{LEFT}\" x2=\"{:.1}\" y1=\"{at:.1}\" y2=\"{at:.1}\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
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
        let (class, radius) = if front { ("front", 5.0) } else { ("", 3.5) };
        let target = if front { &mut above } else { &mut below };
        let _ = writeln!(
            target,
            "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"{radius}\" class=\"{class}\" data-point=\"{}\"><title>{}</title></circle>",
            x.at(candidate.cycles),
            y.at(of(candidate)),
            candidate.point,
            escape(&candidate.label.replace(", ", "\n"))
        );
    }
    svg + &below + &above + "</svg>\n"
}

/// `20000000` as `20M`, `1250000` as `1.25M`, `0.0005` as `5e-4`.
fn short(value: f64) -> String {
    let digits = |value: f64| {
        let text = format!("{value:.3}");
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    };
    match value {
        v if v >= 1e9 => format!("{}G", digits(v / 1e9)),
        v if v >= 1e6 => format!("{}M", digits(v / 1e6)),
        v if v >= 1e3 => format!("{}k", digits(v / 1e3)),
        v if v >= 0.01 => digits(v),
        v => format!("{v:.1e}").replace(".0e", "e"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(title: &str, note: &str, candidates: &[Candidate]) -> String {
        let table = ResultTable::default();
        page(&Sweep {
            title,
            note,
            table: &table,
            candidates,
        })
    }

    /// What the page shows without its script.
    fn still(page: &str) -> &str {
        page.split_once("</section>").map_or(page, |parts| parts.0)
    }

    #[test]
    fn ticks_label_the_data_however_narrow_their_range() {
        for (low, high) in [
            (1.1e6, 1.4e6),
            (9.1e-5, 9.3e-5),
            (1e3, 1e9),
            (4.0, 4.0),
            (2e5, 8e5),
        ] {
            let axis = PlotScale::new([low, high].into_iter(), 0.0, 100.0);
            let ticks = axis.ticks();
            let (first, last) = (axis.low, axis.high);
            assert!(
                (3..=12).contains(&ticks.len()),
                "{low} to {high}: {ticks:?}"
            );
            assert!(
                ticks
                    .iter()
                    .all(|tick| (first..=last).contains(&tick.log10()))
            );
            let texts: std::collections::BTreeSet<String> =
                ticks.iter().map(|tick| short(*tick)).collect();
            assert_eq!(texts.len(), ticks.len(), "{texts:?}");
        }
    }

    #[test]
    fn less_is_up() {
        let candidate = |point, rms| Candidate {
            point,
            rms,
            cycles: 1e6,
            area: 1e4,
            energy: 1.0,
            label: String::new(),
        };
        let page = shown("t", "", &[candidate(0, 1e-5), candidate(1, 1e-2)]);
        let height = |point: &str| -> f64 {
            let circle = page
                .split("<circle")
                .find(|part| part.contains(point))
                .unwrap();
            let (_, rest) = circle.split_once("cy=\"").unwrap();
            rest.split_once('"').unwrap().0.parse().unwrap()
        };
        assert!(height("data-point=\"0\"") < height("data-point=\"1\""));
    }

    #[test]
    fn every_point_has_its_label_and_text_is_escaped() {
        let candidate = |point, rms, cycles, area| Candidate {
            point,
            rms,
            cycles,
            area,
            energy: 1.0,
            label: format!("p <{point}>"),
        };
        let all = [
            candidate(0, 1e-3, 1e6, 5e3),
            candidate(1, 0.0, 2e6, 9e3),
            candidate(2, 1e-2, 3e6, 9e3),
        ];
        let page = shown("a & b", "area < all", &all);
        assert_eq!(still(&page).matches("<circle").count(), 6);
        assert!(
            page.contains("p &lt;2&gt;")
                && page.contains("a &amp; b")
                && page.contains("Estimate of area &lt; all.")
                && !still(&page).contains("NaN")
        );
        assert!(page.contains("3 points, 2 on the front"));
        assert_eq!(still(&page).matches("<svg").count(), 2);
    }

    #[test]
    fn an_error_that_all_points_share_is_a_sentence() {
        let all = [(1, 2e6), (2, 3e6)].map(|(point, cycles)| Candidate {
            point,
            rms: 2e-6,
            cycles,
            area: 7e4 * point as f64,
            energy: 1.0,
            label: String::new(),
        });
        let page = shown("t", "", &all);
        assert!(page.contains("same error, 2.000e-6"));
        assert_eq!(still(&page).matches("<svg").count(), 1);
        assert!(page.contains(">90k<"), "a short axis has all its digits");
    }
}
